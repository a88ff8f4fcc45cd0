//! Checks of what scene and run files have in common: solver, wall, load, mesh and planes.

use anyhow::{Context, ensure};

use super::material::{positive, within};
use crate::field::{CappedField, DesignBox};
use crate::fitness::LoadSettings;
use crate::mesh::{MeshSettings, ShellSettings};
use crate::solve::Backend;

/// Refuses a solver that is not built in.
pub(crate) fn check_solver(backend: Backend) -> anyhow::Result<()> {
    ensure!(
        backend.is_built_in(),
        "this program was built without PETSc; use --solver native, or build it with the feature `petsc`"
    );
    Ok(())
}

/// Checks the keys of `[wall]` and `[load]`.
pub(crate) fn check_shell(wall: &ShellSettings, load: &LoadSettings) -> anyhow::Result<()> {
    positive("[wall] thickness", wall.thickness)?;
    positive("[wall] clamp_height", wall.clamp_height)?;
    within("[wall] tip_fraction", wall.tip_fraction, 1e-3, 0.9)?;
    let steps = load.path.steps;
    ensure!(
        (1..=MOST_STEPS).contains(&steps),
        "[load.path] steps is {steps}, but it must lie between 1 and {MOST_STEPS}"
    );
    within("[load] stretch_bound", load.stretch_bound, 1.01, 1e3)?;
    within("[load.path] largest_step", load.path.largest_step, 1e-3, 1e3)?;
    ensure!(
        load.path.iteration_budget > 0,
        "[load.path] iteration_budget is 0, but a step takes iterations"
    );
    ensure!(
        load.path.halvings <= 30,
        "[load.path] halvings is {}, more than 30",
        load.path.halvings
    );
    within("[load.path] work_tolerance", load.path.work_tolerance, 1e-9, 1.0)?;
    let newton = &load.path.newton;
    within("[load.path.newton] tolerance", newton.tolerance, 1e-13, 1e-3)?;
    within("[load.path.newton] chord_contraction", newton.chord_contraction, 0.0, 0.9)?;
    ensure!(
        newton.max_iterations > 0,
        "[load.path.newton] max_iterations is 0, but at least 1 is needed"
    );
    Ok(())
}

/// Every step is kept in memory with all its unknowns.
const MOST_STEPS: usize = 1000;

/// Checks that the box can be meshed with these settings, in a memory of about a gigabyte.
pub(crate) fn check_mesh(design_box: DesignBox, mesh: &MeshSettings) -> anyhow::Result<()> {
    positive("[mesh] edge", mesh.edge)?;
    let sides = design_box.sides();
    ensure!(
        mesh.edge < 0.5 * sides.min(),
        "[mesh] edge is {:?} mm, but a box {:?} mm wide needs one below half of that",
        mesh.edge,
        sides.min()
    );
    let cubes = sides.iter().map(|side| side / mesh.edge).product::<f64>();
    ensure!(
        cubes <= MOST_CUBES,
        "[mesh] edge is {:?} mm, too fine for a box of {:?} x {:?} x {:?} mm; {:.2} mm is the finest",
        mesh.edge,
        sides.x,
        sides.y,
        sides.z,
        mesh.edge * (cubes / MOST_CUBES).cbrt() + 0.005
    );
    CappedField::check_rim(design_box, mesh.rim_radius).context("[mesh]")
}

/// Cubes of one edge in the box: 3.4 points of the isosurface's grid each, of some 72 bytes.
const MOST_CUBES: f64 = 4e6;

/// Checks the distance of a plane, mm: the barrier begins half way to it, or a tenth of the wall's
/// thickness before it.
pub(crate) fn check_distance(what: &str, distance: f64) -> anyhow::Result<()> {
    positive(what, distance)?;
    within(what, distance, LEAST_DISTANCE, 1e12)?;
    Ok(())
}

/// Below, the rounding of positions is a share of the gap.
const LEAST_DISTANCE: f64 = 1e-6;

/// Checks that `normal` is a direction.
pub(crate) fn check_normal(what: &str, normal: [f64; 3]) -> anyhow::Result<()> {
    let length = normal.iter().map(|n| n * n).sum::<f64>().sqrt();
    ensure!(length > 1e-12 && length.is_finite(), "{what} must be a direction, not {normal:?}");
    Ok(())
}
