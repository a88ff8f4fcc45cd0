//! How much rubber a design takes: its mass, up to the density.
//!
//! ```text
//! V = t A        wall's thickness times the mid-surface's area at rest, cm^3
//! ```
//!
//! What it rewards is small parts, down to buds that hardly move: the front keeps those that nothing else is as light as.

use super::{FurtherObjective, Reading, Sense};

/// Little wall is good. A wall of 100 cm^3 would fill most of the paper's design box.
pub(super) const OBJECTIVE: FurtherObjective = FurtherObjective {
    name: "wall_volume",
    unit: "cm^3",
    sense: Sense::Least,
    worst: 100.0,
    value: wall_volume,
};

fn wall_volume(reading: &Reading<'_>) -> f64 {
    1e-3 * reading.shell.thickness * reading.shell.surface.area()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use approx::assert_relative_eq;

    use super::*;
    use crate::mesh::{ShellMesh, ShellSettings};
    use crate::surface::TriangleMesh;

    /// A sphere of radius 10 mm with a wall of 2 mm: 2 * 4 pi 100 mm^3.
    #[test]
    fn a_sphere_takes_thickness_times_area() {
        let settings = ShellSettings { thickness: 2.0, ..ShellSettings::default() };
        let shell = ShellMesh::new(TriangleMesh::sphere(10.0, 4), &settings).unwrap();
        let volume = wall_volume(&Reading { shell: &shell, free: &[], blocked: &[] });
        // 5,120 facets lie inside the sphere: their area is some 0.2 % less.
        assert_relative_eq!(volume, 0.8 * PI, max_relative = 4e-3);
    }
}
