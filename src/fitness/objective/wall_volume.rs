//! How much rubber a design takes: its mass, up to the density.
//!
//! ```text
//! V = t A        of a shell: wall's thickness times the mid-surface's area at rest, cm^3; of a solid: its cells'
//! ```
//!
//! What it rewards is small parts, down to buds that hardly move: the front keeps those that nothing else is as light as.

use super::{Asked, Objective, Sense, Value};

/// Little wall is good. A wall of 100 cm^3 would fill most of the paper's design box.
pub(super) const OBJECTIVE: Objective = Objective {
    name: "wall_volume",
    symbol: None,
    unit: "cm^3",
    is_unit_told: true,
    decimals: 3,
    sense: Sense::Least,
    worst: 100.0,
    asked: Asked::ByName,
    scenario: None,
    judged_by: |_| "the volume of the wall at rest".to_owned(),
    is_per_work: false,
    value: Value::Number(|reading| reading.part.wall_volume_cm3()),
};

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use approx::assert_relative_eq;

    use super::super::Reading;
    use super::*;
    use crate::fitness::{FitnessSettings, ShellPart};
    use crate::mesh::{ShellMesh, ShellSettings};
    use crate::model::material::{Material, Ogden};
    use crate::surface::TriangleMesh;

    /// A sphere of radius 10 mm with a wall of 2 mm: 2 * 4 pi 100 mm^3.
    #[test]
    fn a_sphere_takes_thickness_times_area() {
        let settings = ShellSettings { thickness: 2.0, ..ShellSettings::default() };
        let shell = ShellMesh::new(TriangleMesh::sphere(10.0, 4), &settings).unwrap();
        let material = Material::Ogden(Ogden::ninjaflex_c2s());
        let part = ShellPart { shell: &shell, materials: material.as_ref(), limits: &[] };
        let settings = FitnessSettings::default();
        let reading = Reading { part: &part, settings: &settings, walked: &[], at: None };
        let volume = OBJECTIVE.value(&reading);
        // 5,120 facets lie inside the sphere: their area is some 0.2 % less.
        assert_relative_eq!(volume, 0.8 * PI, max_relative = 4e-3);
    }
}
