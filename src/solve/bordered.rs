//! Newton's method for state and load together, bound by one more equation.
//!
//! ```text
//! R(x, load) = 0                 K dx - a dload = -R           a = dC/dx
//! g(x, load) = 0                 g_x . dx + g_load dload = -g
//!
//! dx = y + dload z,   K y = -R,  K z = a,   dload = -(g + g_x . y) / (g_load + g_x . z)
//! ```
//!
//! One factorisation of the symmetric `K` serves both right-hand sides (behind `krylov.rs` where loads have no potential), and the answer stays accurate up to a hair of
//! a limit point, where `K` is singular and the bordered matrix is not. There is no energy to lower: a step is cut while the state
//! is not admissible or the residual grows out of bounds. Source: Batoz & Dhatt (1979); Keller (1977) for the arc.

use super::krylov::{KrylovReport, solve_unsymmetric};
use super::line_search::{self, RESIDUAL_GROWTH};
use super::path::PathPoint;
use super::supply::Supply;
use super::vectors::{all_finite, dot};
use super::{EquilibriumSolver, NewtonEnding, NewtonReport, NewtonSettings, SolverFailure};
use crate::model::system::LoadedSystem;

/// The equation that binds state and load.
pub(super) enum Constraint<'a> {
    /// A supply at a drive, the supply's equation being small against `scale`.
    Supplied { supply: &'a Supply, drive: f64, scale: f64 },
    /// The plane across the tangent of `from`, `length` ahead.
    Arc { from: &'a PathPoint, metric: Metric, length: f64 },
}

/// How displacements and loads are measured together: `ds^2 = |dx|^2 / state^2 + dload^2 / load^2`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Metric {
    pub state: f64,
    pub load: f64,
}

impl Metric {
    /// The product of two directions.
    pub(super) fn product(&self, (x, load): (&[f64], f64), (y, other): (&[f64], f64)) -> f64 {
        dot(x, y) / (self.state * self.state) + load * other / (self.load * self.load)
    }

    pub(super) fn norm(&self, x: &[f64], load: f64) -> f64 {
        self.product((x, load), (x, load)).sqrt()
    }
}

/// Solves for `x [n]` and `load` together; they receive the last iterate.
pub(super) fn solve(
    system: &mut dyn LoadedSystem,
    solver: &mut dyn EquilibriumSolver,
    constraint: &Constraint<'_>,
    x: &mut [f64],
    load: &mut f64,
    settings: &NewtonSettings,
) -> Result<NewtonReport, SolverFailure> {
    let mut report = NewtonReport {
        ending: NewtonEnding::Inadmissible,
        iterations: 0,
        residual_norm: f64::INFINITY,
        shifted: 0,
    };
    let threshold = settings.tolerance * system.force_scale();
    let n = x.len();
    let (mut residual, mut trial_residual) = (vec![0.0; n], vec![0.0; n]);
    let mut trial = vec![0.0; n];
    system.set_load(*load);
    if system.residual(x, &mut residual).is_err() || !all_finite(&residual) {
        return Ok(report);
    }
    loop {
        report.residual_norm = dot(&residual, &residual).sqrt();
        let gap = constraint.value(system, x, *load);
        if report.residual_norm <= threshold && gap.abs() <= constraint.tolerance() {
            report.ending = NewtonEnding::Converged;
            return Ok(report);
        }
        if report.iterations == settings.max_iterations {
            report.ending = NewtonEnding::IterationLimit;
            return Ok(report);
        }
        report.iterations += 1;
        let negative = solver.linearize(system, x)?;
        if !solver.is_invertible() {
            report.ending = NewtonEnding::Singular;
            return Ok(report);
        }
        let mut direction = vec![0.0; n];
        system.load_direction(x, &mut direction);
        let mut by_load = direction.clone();
        let solved = solve_unsymmetric(system, solver, x, &mut by_load)?;
        let mut dx: Vec<f64> = residual.iter().map(|residual| -residual).collect();
        let solved = [solved, solve_unsymmetric(system, solver, x, &mut dx)?];
        if !solved.iter().all(KrylovReport::has_converged) {
            report.ending = NewtonEnding::Singular;
            return Ok(report);
        }
        let row = constraint.row(system, x, *load, direction);
        let conjugate_rate = dot(&row.direction, &by_load);
        let surplus = negative.saturating_sub(system.stable_negative_pivots());
        if system.is_conservative()
            && let Some(cured) = row.cures(conjugate_rate)
            && surplus > cured
        {
            report.shifted += 1;
            if report.shifted > settings.most_shifted {
                report.ending = NewtonEnding::Indefinite;
                return Ok(report);
            }
        }
        let (along_dx, along_rate) = row.along(&dx, &by_load);
        let dload = -(gap + along_dx) / (row.by_load + along_rate);
        for (dx, by_load) in dx.iter_mut().zip(&by_load) {
            *dx += dload * by_load;
        }
        if !dload.is_finite() || !all_finite(&dx) {
            report.ending = NewtonEnding::Singular;
            return Ok(report);
        }
        let longest = system.longest_step(x, &dx);
        let (mut length, mut admissible) = (longest, false);
        for cut in line_search::cuts(longest) {
            length = cut;
            for ((trial, x), dx) in trial.iter_mut().zip(&*x).zip(&dx) {
                *trial = x + length * dx;
            }
            system.set_load(*load + length * dload);
            if system.residual(&trial, &mut trial_residual).is_ok() && all_finite(&trial_residual) {
                admissible = true;
                if dot(&trial_residual, &trial_residual).sqrt()
                    <= RESIDUAL_GROWTH * report.residual_norm.max(threshold)
                {
                    break;
                }
            }
        }
        if !admissible {
            system.set_load(*load);
            report.ending = NewtonEnding::Inadmissible;
            return Ok(report);
        }
        // What is left after the last cut may be too far; the next residual tells.
        if system.residual(&trial, &mut trial_residual).is_err() {
            report.ending = NewtonEnding::LineSearchFailed;
            return Ok(report);
        }
        x.copy_from_slice(&trial);
        *load += length * dload;
        std::mem::swap(&mut residual, &mut trial_residual);
    }
}

/// The constraint is met to this share of its scale, or to as many roundings of its drive.
const GAP: f64 = 1e-10;
const ROUNDINGS: f64 = 64.0;

impl Constraint<'_> {
    fn value(&self, system: &dyn LoadedSystem, x: &[f64], load: f64) -> f64 {
        match self {
            Self::Supplied { supply, drive, .. } => {
                supply.equation(load, system.conjugate(x), *drive).value
            }
            Self::Arc { from, metric, length } => {
                let moved: Vec<f64> = x.iter().zip(&from.x).map(|(x, from)| x - from).collect();
                metric.product((&moved, load - from.load), (&from.rate, from.load_rate)) - length
            }
        }
    }

    /// How well it is to be met.
    fn tolerance(&self) -> f64 {
        match self {
            Self::Supplied { drive, scale, .. } => {
                (GAP * scale).max(ROUNDINGS * f64::EPSILON * drive.abs())
            }
            Self::Arc { length, .. } => GAP * length,
        }
    }

    /// The derivatives of the constraint at a state whose load direction is `direction`.
    fn row(&self, system: &dyn LoadedSystem, x: &[f64], load: f64, direction: Vec<f64>) -> Row<'_> {
        match self {
            Self::Supplied { supply, drive, .. } => {
                let equation = supply.equation(load, system.conjugate(x), *drive);
                Row {
                    direction,
                    arc: None,
                    by_conjugate: equation.by_conjugate,
                    by_load: equation.by_load,
                }
            }
            Self::Arc { from, metric, .. } => Row {
                direction,
                arc: Some((&from.rate, metric.state * metric.state)),
                by_conjugate: 0.0,
                by_load: from.load_rate / (metric.load * metric.load),
            },
        }
    }
}

/// The derivative of a constraint: by the load, and by the state along the load direction or along an arc.
struct Row<'a> {
    direction: Vec<f64>,
    arc: Option<(&'a [f64], f64)>,
    by_conjugate: f64,
    by_load: f64,
}

impl Row<'_> {
    /// The derivative along two directions.
    fn along(&self, dx: &[f64], rate: &[f64]) -> (f64, f64) {
        match self.arc {
            Some((tangent, square)) => (dot(tangent, dx) / square, dot(tangent, rate) / square),
            None => {
                let along = |x| self.by_conjugate * dot(&self.direction, x);
                (along(dx), along(rate))
            }
        }
    }

    /// How many negative pivots the constraint cures; none is asked for along an arc.
    fn cures(&self, conjugate_rate: f64) -> Option<usize> {
        let total = self.by_load + self.by_conjugate * conjugate_rate;
        self.arc.is_none().then_some(usize::from(total < 0.0))
    }
}
