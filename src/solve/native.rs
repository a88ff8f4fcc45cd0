//! Newton's method in pure Rust, with `faer`'s sparse LDL^T.
//!
//! ```text
//! (K(x) + sigma I) dx = -R(x)      x <- x + a dx,  a by `line_search`
//! sigma = 0, or the first of  1e-5 mean|diag K| * 4^k  that leaves no more negative pivots than stable
//! ```
//!
//! With the shift the step is a direction of descent: a minimiser does not walk to a saddle.

use std::mem;
use std::ops::Range;

use super::factor::LdlFactor;
use super::line_search;
use super::observed::Observed;
use super::shift::shifts;
use super::{
    EquilibriumSolver, NewtonEnding, NewtonReport, NewtonSettings, SolveTimes, SolverFailure,
};
use crate::math::cpu_seconds;
use crate::model::system::{SparsityPattern, System};

/// Our Newton solver over `faer`.
#[derive(Debug)]
pub struct NativeSolver {
    factor: LdlFactor,
    /// Of each column, the stored entries that are read: the diagonal, then what is below it.
    lower: Vec<Range<usize>>,
    entries: Vec<f64>,
    diagonal: Vec<f64>,
    residual: Vec<f64>,
    direction: Vec<f64>,
    trial: Vec<f64>,
    trial_residual: Vec<f64>,
    /// Where the last solve converged, while `entries` still holds the tangent there.
    solution: Option<Vec<f64>>,
    linearized: bool,
    times: SolveTimes,
}

impl NativeSolver {
    /// A solver for systems with `pattern`; orders the unknowns and plans the factorisation once.
    ///
    /// # Errors
    /// [`SolverFailure`] when the pattern cannot be factorised (out of memory).
    ///
    /// # Panics
    /// When a column has no diagonal entry, or its rows are not sorted or out of range.
    pub fn new(pattern: &SparsityPattern) -> Result<Self, SolverFailure> {
        let start = cpu_seconds();
        let n = pattern.order();
        let lower = |column: usize| {
            let stored =
                pattern.column_starts[column] as usize..pattern.column_starts[column + 1] as usize;
            let rows = &pattern.row_indices[stored.clone()];
            assert!(rows.is_sorted_by(|one, next| one < next), "column {column} is not sorted");
            let diagonal = rows.binary_search(&(column as u32)).expect("the diagonal is stored");
            stored.start + diagonal..stored.end
        };
        Ok(Self {
            lower: (0..n).map(lower).collect(),
            factor: LdlFactor::new(pattern)?,
            entries: vec![0.0; pattern.stored()],
            diagonal: vec![0.0; n],
            residual: vec![0.0; n],
            direction: vec![0.0; n],
            trial: vec![0.0; n],
            trial_residual: vec![0.0; n],
            solution: None,
            linearized: false,
            times: SolveTimes { assembly: 0.0, factorization: cpu_seconds() - start },
        })
    }

    fn iterate(
        &mut self,
        system: &mut Observed<'_>,
        x: &mut [f64],
        settings: &NewtonSettings,
        report: &mut NewtonReport,
    ) -> NewtonEnding {
        let threshold = settings.tolerance * system.force_scale();
        let stable = system.stable_negative_pivots();
        let Some(mut energy) = self.assemble(system, x) else {
            return NewtonEnding::Inadmissible;
        };
        mem::swap(&mut self.residual, &mut self.trial_residual);
        loop {
            report.residual_norm = dot(&self.residual, &self.residual).sqrt();
            if report.residual_norm <= threshold {
                self.solution = Some(x.to_vec());
                return NewtonEnding::Converged;
            }
            if report.iterations == settings.max_iterations {
                return NewtonEnding::IterationLimit;
            }
            report.iterations += 1;
            let shift = self.find_direction(stable, settings.stops_when_indefinite);
            report.shifted += usize::from(shift != Some(0.0));
            if shift.is_none() {
                return if settings.stops_when_indefinite {
                    NewtonEnding::Indefinite
                } else {
                    NewtonEnding::Singular
                };
            }

            let slope = dot(&self.residual, &self.direction);
            system.forget_admissible();
            let step =
                line_search::search(system, x, &self.direction, energy, slope, &mut self.trial);
            if step.is_none() {
                return if system.met_only_inadmissible() {
                    NewtonEnding::Inadmissible
                } else {
                    NewtonEnding::LineSearchFailed
                };
            }
            let trial = mem::take(&mut self.trial);
            let assembled = self.assemble(system, &trial);
            self.trial = trial;
            let Some(trial_energy) = assembled else {
                return NewtonEnding::Inadmissible;
            };
            energy = trial_energy;
            x.copy_from_slice(&self.trial);
            mem::swap(&mut self.residual, &mut self.trial_residual);
        }
    }

    /// Puts the tangent at `x` into `entries` and the residual into `trial_residual`; the energy, where all are finite.
    ///
    /// One evaluation serves the convergence check, the next step, and [`EquilibriumSolver::linearize`].
    fn assemble(&mut self, system: &mut Observed<'_>, x: &[f64]) -> Option<f64> {
        let energy = system.tangent(x, &mut self.trial_residual, &mut self.entries).ok()?;
        (all_finite(&self.trial_residual) && self.tangent_is_finite()).then_some(energy)
    }

    /// Solves for the direction with the smallest shift, or `unshifted`, that leaves at most `stable` negative pivots;
    /// returns that shift.
    fn find_direction(&mut self, stable: usize, unshifted: bool) -> Option<f64> {
        let start = cpu_seconds();
        let shift = self.factorize_stable(stable, unshifted);
        if shift.is_some() {
            for (direction, residual) in self.direction.iter_mut().zip(&self.residual) {
                *direction = -residual;
            }
            self.factor.solve(&mut self.direction);
        }
        self.times.factorization += cpu_seconds() - start;
        shift
    }

    fn factorize_stable(&mut self, stable: usize, unshifted: bool) -> Option<f64> {
        for (diagonal, column) in self.diagonal.iter_mut().zip(&self.lower) {
            *diagonal = self.entries[column.start];
        }
        let sizes = self.diagonal.iter().map(|diagonal| diagonal.abs());
        let mean = sizes.sum::<f64>() / self.diagonal.len() as f64;
        let tried = if unshifted { 1 } else { usize::MAX };
        shifts(mean).take(tried).find(|shift| {
            for (diagonal, column) in self.diagonal.iter().zip(&self.lower) {
                self.entries[column.start] = diagonal + shift;
            }
            self.factor.factorize(&self.entries).is_some_and(|negative| negative <= stable)
        })
    }

    fn tangent_is_finite(&self) -> bool {
        self.lower.iter().all(|column| all_finite(&self.entries[column.clone()]))
    }

    fn check_pattern(&self, pattern: &SparsityPattern) {
        assert!(self.factor.pattern() == pattern, "the system's pattern is not the solver's");
    }
}

impl EquilibriumSolver for NativeSolver {
    /// # Panics
    /// When the system's pattern is not the solver's.
    fn solve(
        &mut self,
        system: &mut dyn System,
        x: &mut [f64],
        settings: &NewtonSettings,
    ) -> Result<NewtonReport, SolverFailure> {
        self.check_pattern(system.pattern());
        self.linearized = false;
        self.solution = None;
        let mut system = Observed::new(system);
        let mut report = NewtonReport {
            ending: NewtonEnding::Inadmissible,
            iterations: 0,
            residual_norm: f64::INFINITY,
            shifted: 0,
        };
        report.ending = self.iterate(&mut system, x, settings, &mut report);
        self.times.assembly += system.seconds();
        Ok(report)
    }

    fn linearize(&mut self, system: &mut dyn System, x: &[f64]) -> Result<usize, SolverFailure> {
        self.check_pattern(system.pattern());
        let start = cpu_seconds();
        if self.solution.take().is_none_or(|solution| solution != x) {
            system
                .tangent(x, &mut self.trial_residual, &mut self.entries)
                .expect("linearize is called at an admissible state");
        }
        let assembled = cpu_seconds();
        let negative = self.factor.factorize(&self.entries);
        self.times.assembly += assembled - start;
        self.times.factorization += cpu_seconds() - assembled;
        self.linearized = negative.is_some();
        Ok(negative.unwrap_or(system.stable_negative_pivots() + 1))
    }

    fn solve_linearized(&mut self, b: &mut [f64]) -> Result<(), SolverFailure> {
        assert!(self.linearized, "solve_linearized without linearize before it");
        let start = cpu_seconds();
        self.factor.solve(b);
        self.times.factorization += cpu_seconds() - start;
        Ok(())
    }

    fn is_invertible(&self) -> bool {
        self.linearized
    }

    fn times(&self) -> SolveTimes {
        self.times
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn all_finite(values: &[f64]) -> bool {
    values.iter().all(|value| value.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve::solver_suite::solver_suite;

    solver_suite!(|pattern| NativeSolver::new(pattern).unwrap());
}
