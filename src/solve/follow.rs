//! How a loading path is followed.
//!
//! A supply ([`Supply`]) drives the system: its load is given, or the load's conjugate (a volume), or an amount of gas.
//! Every accepted state is an equilibrium that is stable under its supply. States stand at fixed samples of the drive, so
//! that what is read off a path does not depend on how it was walked; between samples the step follows Newton's work and
//! the change of the path's direction, and it is halved when Newton's method fails, when it met an indefinite tangent, and
//! when the work done is not the energy stored. Where a given load met indefinite tangents, the walk looks past its limit point by
//! the conjugate (`past_limit.rs`). What is still so at the smallest step is a loss of stability: the
//! state falls to the next stable one (`snap.rs`), which is recorded. A step starts from a prediction: the cubic through the last
//! two states and their tangents, or between the last and one ahead that a longer step has found and nobody believed
//!
//! ```text
//! K dx/dload = dC/dx          dC/dload = dC/dx . dx/dload          C = conjugate of the load (volume)
//! work = int load dC          both by Hermite's cubics: their error is of fourth order
//! ```
//!
//! A [`Programme::Curve`] is the whole equilibrium curve, stable or not (`curve.rs`).

use super::counts::SolveCounts;
use super::curve;
use super::equilibrium_solver::{EquilibriumSolver, SolverFailure};
use super::path::{Path, PathPoint, PathSettings, Programme};
use super::stop::Stop;
use super::supply::Supply;
use super::walk::{Walk, fastest};
use crate::model::system::LoadedSystem;

/// Follows the equilibrium of `system` from the last of `points` (from rest where empty) through `programme`.
///
/// The samples stand at equal parts of the programme whatever the start.
///
/// # Errors
/// [`SolverFailure`] when a library fails; a path that ends early is a value.
pub fn follow(
    system: &mut dyn LoadedSystem,
    solver: &mut dyn EquilibriumSolver,
    programme: impl Into<Programme>,
    points: Vec<PathPoint>,
    settings: &PathSettings,
) -> Result<Path, SolverFailure> {
    follow_from(system, solver, programme, points, f64::INFINITY, settings, Stop::NEVER)
}

/// As [`follow`], with `step` of the drive, or less, as the first: one who goes on from another path knows how coarse it was. It ends
/// early where `stop` wants that.
///
/// # Errors
/// As [`follow`].
pub fn follow_from(
    system: &mut dyn LoadedSystem,
    solver: &mut dyn EquilibriumSolver,
    programme: impl Into<Programme>,
    points: Vec<PathPoint>,
    step: f64,
    settings: &PathSettings,
    stop: Stop<'_>,
) -> Result<Path, SolverFailure> {
    walk_on(system, solver, programme.into(), (points, step), settings, stop, &mut |_| {})
}

/// As [`follow`]; it ends early where `stop` wants that, and `watch` sees every state that is accepted, when it is.
///
/// # Errors
/// As [`follow`].
pub fn follow_watched(
    system: &mut dyn LoadedSystem,
    solver: &mut dyn EquilibriumSolver,
    programme: impl Into<Programme>,
    settings: &PathSettings,
    stop: Stop<'_>,
    watch: &mut dyn FnMut(&PathPoint),
) -> Result<Path, SolverFailure> {
    let start = (Vec::new(), f64::INFINITY);
    walk_on(system, solver, programme.into(), start, settings, stop, watch)
}

/// Walks from the last of the given points, the first step at most as long as given.
fn walk_on(
    system: &mut dyn LoadedSystem,
    solver: &mut dyn EquilibriumSolver,
    programme: Programme,
    (points, step): (Vec<PathPoint>, f64),
    settings: &PathSettings,
    stop: Stop<'_>,
    watch: &mut dyn FnMut(&PathPoint),
) -> Result<Path, SolverFailure> {
    let supply = match programme {
        Programme::Driven { supply, .. } => supply,
        Programme::Curve { .. } => Supply::Load,
    };
    let factorized = solver.factorizations();
    let mut walk = Walk {
        system,
        solver,
        settings,
        stop,
        supply,
        span: 1.0,
        step,
        points,
        ahead: Vec::new(),
        iterations: 0,
        cuts: 0,
        spent: 0,
        useful: 0,
        attempted: 0,
        looked_past: None,
        shifted: 0,
        fell: false,
        place: None,
        watch,
    };
    if let Some(last) = walk.points.last() {
        walk.system.recall(&last.x, &last.memory);
    }
    let ending = match programme {
        Programme::Driven { end, .. } => walk.drive_to(end)?,
        Programme::Curve { end } => curve::trace(&mut walk, end)?,
    };
    if !ending.is_complete() && walk.place.is_none() {
        let multipliers = walk.system.multipliers();
        walk.place = walk.points.last().and_then(|last| fastest(&last.rate, &multipliers));
    }
    let Walk { solver, points, place, spent, useful, fell, .. } = walk;
    let counts = SolveCounts {
        newton_iterations: spent,
        failed_iterations: spent - useful,
        factorizations: solver.factorizations() - factorized,
    };
    Ok(Path { points, ending, place, fell, counts })
}
