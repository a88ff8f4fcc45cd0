//! From a field to a shell mesh: isosurface, chamber check, remeshing.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{ShellMesh, ShellSettings};
use crate::field::CappedField;
use crate::math::Rejected;
use crate::surface::{Chamber, RemeshSettings, TriangleMesh, isosurface, remesh};

/// How finely a field is meshed.
///
/// # Decisions
/// The edge is 3 mm, because a search needs the order of its designs more than their numbers: 3 mm orders 25 random
/// genomes by their bending objective as 2 mm does for a third of the time, and 4 mm no longer. Errors against edges of
/// 1 mm (tip displacement / volume growth; three parts of `verify shells`) and 1.5 mm (the genomes), CPU seconds as a
/// share of the default's:
///
/// | element, edge | basic_bend | paper | pneunet | angle, median | rank correlation | time |
/// |---|---|---|---|---|---|---|
/// | Loop, 4 mm | 1 / 3 % | 4 / 3 % | unresolved | 18 % | 0.79 | 0.5 |
/// | **Loop, 3 mm** | 0 / 2 % | 4 / 2 % | 11 / 12 % | 4 % | 0.978 | 1 |
/// | Loop, 2.5 mm | 3 / 2 % | 2 / 1 % | 1 / 1 % | 1 % | 0.978 | 1.7 |
/// | Loop, 2 mm | 2 / 1 % | 3 / 1 % | 1 / 2 % | 3 % | 0.981 | 2.9 |
/// | Loop, 1.5 mm | 1 / 1 % | 1 / 0 % | 2 / 3 % | - | - | 6.8 |
/// | mid-edge, 3 mm | 6 / 3 % | 7 / 1 % | 13 / 15 % | 16 % | 0.89 | 0.6 |
/// | mid-edge, 2 mm | 3 / 2 % | 4 / 1 % | 3 / 2 % | 2 % | 0.988 | 1.7 |
///
/// Angles are those of the genomes that bend by more than a degree. The errors do not fall evenly, because finer
/// triangles also follow the field into creases that coarser ones round. Sharp-edged parts such as `pneunet`, and the
/// designs of a front, deserve a second look at 2 mm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct MeshSettings {
    /// Edge length of the shell's triangles, mm.
    pub edge: f64,
    /// Radius to which the rims of the flat caps are rounded, mm.
    pub rim_radius: f64,
}

impl Default for MeshSettings {
    fn default() -> Self {
        Self { edge: 3.0, rim_radius: 2.0 }
    }
}

/// Grid step of the isosurface as a share of the edge; a finer grid only costs time.
pub(super) const GRID_SHARE: f64 = 2.0 / 3.0;
/// Passes of the remesher; more change the quality by less than a percent.
pub(super) const REMESH_ITERATIONS: usize = 10;
/// The isosurface may have this many triangles: 40 times those of the default box full of pleats.
const MOST_TRIANGLES: usize = 1_000_000;

/// The mid-surface of the chamber that `field` encloses, remeshed, mm.
///
/// # Errors
/// [`Rejected`] when there is not exactly one closed chamber from clamp to tip, or the edge cannot resolve it.
pub fn surface_of_field(
    field: &CappedField,
    settings: &MeshSettings,
) -> Result<TriangleMesh, Rejected> {
    let (lower, upper) = (field.design_box().min(), field.design_box().max());
    let step = GRID_SHARE * settings.edge;
    let coarse = isosurface(field, lower, upper, step);
    let chamber = Chamber {
        clamp_z: lower.z,
        tip_z: upper.z,
        tolerance: 0.5 * step,
        most_triangles: MOST_TRIANGLES,
    };
    chamber.check(&coarse)?;
    let settings = RemeshSettings { edge: settings.edge, iterations: REMESH_ITERATIONS };
    remesh(&coarse, Some(field), &settings)
}

/// The shell around the chamber that `field` encloses.
///
/// # Errors
/// As [`surface_of_field`] and [`ShellMesh::new`].
pub fn shell_of_field(
    field: &CappedField,
    mesh: &MeshSettings,
    shell: &ShellSettings,
) -> Result<ShellMesh, Rejected> {
    ShellMesh::new(surface_of_field(field, mesh)?, shell)
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::field::{CompiledNetwork, DesignBox};

    /// The shipped actuators can be meshed whatever the edge, and their volume settles: 5 % between edges of 4 and 2 mm
    /// is what chords of 4 mm cut off folds of some 5 mm radius.
    #[test]
    fn shipped_networks_are_meshed_at_any_edge() {
        for text in [
            include_str!("../../examples/networks/basic_bend.toml"),
            include_str!("../../examples/networks/paper.toml"),
        ] {
            let network = CompiledNetwork::new(&text.parse().unwrap());
            let field = CappedField::new(network, DesignBox::default(), 2.0).unwrap();
            let volumes = [4.0, 3.0, 2.0].map(|edge| {
                let settings = MeshSettings { edge, ..MeshSettings::default() };
                surface_of_field(&field, &settings).unwrap().volume()
            });
            assert_relative_eq!(volumes[0], volumes[2], max_relative = 0.05);
            assert!(volumes.is_sorted(), "finer edges cut off less: {volumes:?}");
        }
    }
}
