//! Backtracking, shared by every solver: on the energy, or where that is no function to lower, on the residual.
//!
//! ```text
//! accept a when  E(x + a dx) <= E(x) + c1 a R.dx + slack      a = a_max, a_max/2, a_max/4, ...
//! ```
//!
//! A mixed system's energy is a saddle ([`System::multipliers`]). There a step is accepted as soon as the residual stays within bounds:
//! a wall that bends by a linear step stretches by its square, and the next step takes that back.
//!
//! `a_max` is the system's own limit (no point crosses a contact). Source: Armijo (1966).

use std::iter;

use crate::model::system::{Inadmissible, System};

/// Armijo's fraction of the predicted decrease.
const SUFFICIENT_DECREASE: f64 = 1e-4;
/// Halvings before the search gives up: the last step tried is 1e-6 of the first.
const HALVINGS: usize = 20;
/// Rounding error allowed in an energy, relative to its size: sums of some thousand terms carry about 1e-13.
const ROUNDING: f64 = 1e-12;

/// How far a residual may grow in a step.
pub(super) const RESIDUAL_GROWTH: f64 = 1e3;
/// Lengths tried until the residual is within its bound.
const CUTS: usize = 8;

/// The lengths of a step to try in turn until the residual is within bounds, the `longest` first.
pub(super) fn cuts(longest: f64) -> impl Iterator<Item = f64> {
    iter::successors(Some(longest), |length| Some(0.5 * length)).take(CUTS)
}

/// A step that the search accepted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Step {
    /// The multiple of `dx` taken.
    pub length: f64,
    /// The energy there, mJ.
    pub energy: f64,
}

/// Finds a step along `dx [n]` from `x [n]` that lowers the energy; `trial [n]` receives `x + length dx`.
///
/// `evaluate` returns the energy of a trial, and is last called with the one that is accepted.
/// `slope` is `R . dx`, negative for a direction of descent. `None` when `dx` leads uphill or no
/// admissible step lowers the energy.
pub(super) fn search(
    system: &mut dyn System,
    x: &[f64],
    dx: &[f64],
    energy: f64,
    slope: f64,
    trial: &mut [f64],
    mut evaluate: impl FnMut(&mut dyn System, &[f64]) -> Result<f64, Inadmissible>,
) -> Option<Step> {
    if slope > 0.0 || slope.is_nan() {
        return None;
    }
    let slack = ROUNDING * energy.abs() + system.energy_rounding();
    let mut length = system.longest_step(x, dx);
    for _ in 0..=HALVINGS {
        for ((trial, x), dx) in trial.iter_mut().zip(x).zip(dx) {
            *trial = x + length * dx;
        }
        if let Ok(trial_energy) = evaluate(system, trial)
            && trial_energy <= energy + SUFFICIENT_DECREASE * length * slope + slack
        {
            return Some(Step { length, energy: trial_energy });
        }
        length *= 0.5;
    }
    None
}
