//! The linear theory: one linear solve at rest.
//!
//! ```text
//! K du = p dC/dx        C = conjugate of the load (volume)        work = 1/2 p^2 dC/dx . du/dp
//! ```

use super::{Ending, EquilibriumSolver, Path, PathPoint, SolveCounts, SolverFailure};
use crate::model::system::LoadedSystem;

/// Rest, and the state that the linear theory has at the load `largest`; no points, and
/// [`Ending::Unstable`], if the system is not stable at rest.
///
/// # Errors
/// [`SolverFailure`] when the solver's library fails.
pub fn linear_path(
    system: &mut dyn LoadedSystem,
    solver: &mut dyn EquilibriumSolver,
    largest: f64,
) -> Result<Path, SolverFailure> {
    let counts = SolveCounts { factorizations: 1, ..SolveCounts::default() };
    let walked = |points, ending| Path { points, ending, place: None, fell: false, counts };
    let rest = vec![0.0; system.pattern().order()];
    system.set_load(0.0);
    let negative_pivots = solver.linearize(system, &rest)?;
    if negative_pivots != system.stable_negative_pivots() {
        return Ok(walked(Vec::new(), Ending::Unstable));
    }
    let mut direction = rest.clone();
    system.load_direction(&rest, &mut direction);
    let mut rate = direction.clone();
    solver.solve_linearized(&mut rate)?;
    let conjugate_rate: f64 = direction.iter().zip(&rate).map(|(f, u)| f * u).sum();
    let at_rest = system.conjugate(&rest);
    let point = |load: f64| PathPoint {
        load,
        conjugate: at_rest + load * conjugate_rate,
        work: 0.5 * load * load * conjugate_rate,
        stored_energy: 0.5 * load * load * conjugate_rate,
        x: rate.iter().map(|rate| load * rate).collect(),
        rate: rate.clone(),
        conjugate_rate,
        ..PathPoint::at_rest(load, 0)
    };
    Ok(walked(vec![point(0.0), point(largest)], Ending::Reached))
}
