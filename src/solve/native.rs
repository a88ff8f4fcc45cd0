//! Newton's method in pure Rust, with `faer`'s sparse LDL^T.
//!
//! ```text
//! K(x) dx = -R(x),   x <- x + a dx     a by backtracking on the energy
//! ```
//!
//! A tangent with more negative pivots than a stable equilibrium has is shifted, `K + sigma I`, until the
//! step is a direction of descent: a minimiser does not walk to a saddle.

use super::factor::LdlFactor;
use super::line_search;
use super::shift::{FIRST_SHIFT, MOST_SHIFTS, SHIFT_GROWTH};
use super::{
    EquilibriumSolver, NewtonEnding, NewtonReport, NewtonSettings, SolveTimes, SolverFailure,
};
use crate::math::cpu_seconds;
use crate::model::system::{SparsityPattern, System};

/// Our Newton solver over `faer`.
#[derive(Debug)]
pub struct NativeSolver {
    factor: LdlFactor,
    diagonal_entries: Vec<usize>,
    values: Vec<f64>,
    residual: Vec<f64>,
    step: Vec<f64>,
    trial: Vec<f64>,
    times: SolveTimes,
}

impl NativeSolver {
    /// A solver for systems with `pattern`; orders the unknowns and plans the factorisation once.
    ///
    /// # Errors
    /// [`SolverFailure`] when the pattern cannot be factorised (out of memory).
    pub fn new(pattern: &SparsityPattern) -> Result<Self, SolverFailure> {
        let start = cpu_seconds();
        let n = pattern.order();
        let factor = LdlFactor::new(pattern)?;
        let diagonal = |column: usize| {
            let range =
                pattern.column_starts[column] as usize..pattern.column_starts[column + 1] as usize;
            let place = pattern.row_indices[range.clone()].binary_search(&(column as u32));
            range.start + place.expect("the diagonal is stored")
        };
        Ok(Self {
            factor,
            diagonal_entries: (0..n).map(diagonal).collect(),
            values: vec![0.0; pattern.stored()],
            residual: vec![0.0; n],
            step: vec![0.0; n],
            trial: vec![0.0; n],
            times: SolveTimes { assembly: 0.0, factorization: cpu_seconds() - start },
        })
    }

    /// Factorises the tangent in `values`, shifted until it has the pivots of a stable equilibrium.
    ///
    /// Whether a shift was needed; `None` when no shift was large enough.
    fn factorize_stable(&mut self, negative_pivots: usize) -> Option<bool> {
        if self.factor.factorize(&self.values) == Some(negative_pivots) {
            return Some(false);
        }
        let n = self.diagonal_entries.len() as f64;
        let mean = self.diagonal_entries.iter().map(|&d| self.values[d].abs()).sum::<f64>() / n;
        let mut shift = 0.0;
        let mut next = FIRST_SHIFT * mean;
        for _ in 0..MOST_SHIFTS {
            for &entry in &self.diagonal_entries {
                self.values[entry] += next - shift;
            }
            shift = next;
            if self.factor.factorize(&self.values) == Some(negative_pivots) {
                return Some(true);
            }
            next *= SHIFT_GROWTH;
        }
        None
    }

    fn iterate(
        &mut self,
        system: &mut dyn System,
        x: &mut [f64],
        settings: &NewtonSettings,
        report: &mut NewtonReport,
    ) -> NewtonEnding {
        let target = settings.tolerance * system.force_scale();
        let start = cpu_seconds();
        let evaluated = system.residual(x, &mut self.residual);
        self.times.assembly += cpu_seconds() - start;
        if evaluated.is_err() {
            return NewtonEnding::Inadmissible;
        }
        loop {
            report.residual_norm = norm(&self.residual);
            if report.residual_norm <= target {
                return NewtonEnding::Converged;
            }
            if report.iterations == settings.max_iterations {
                return NewtonEnding::IterationLimit;
            }
            report.iterations += 1;

            let start = cpu_seconds();
            let evaluated = system.tangent(x, &mut self.residual, &mut self.values);
            let assembled = cpu_seconds();
            self.times.assembly += assembled - start;
            let Ok(energy) = evaluated else {
                return NewtonEnding::Inadmissible;
            };
            match self.factorize_stable(system.stable_negative_pivots()) {
                Some(shifted) => report.shifted += usize::from(shifted),
                None => return NewtonEnding::Singular,
            }
            self.step.copy_from_slice(&self.residual);
            self.factor.solve(&mut self.step);
            self.step.iter_mut().for_each(|dx| *dx = -*dx);
            let solved = cpu_seconds();
            self.times.factorization += solved - assembled;

            let slope = dot(&self.residual, &self.step);
            let found =
                line_search::search(system, x, &self.step, energy, slope, &mut self.trial);
            if found.is_none() {
                self.times.assembly += cpu_seconds() - solved;
                return NewtonEnding::LineSearchFailed;
            }
            x.copy_from_slice(&self.trial);
            let evaluated = system.residual(x, &mut self.residual);
            self.times.assembly += cpu_seconds() - solved;
            if evaluated.is_err() {
                return NewtonEnding::Inadmissible;
            }
        }
    }
}

impl EquilibriumSolver for NativeSolver {
    fn solve(
        &mut self,
        system: &mut dyn System,
        x: &mut [f64],
        settings: &NewtonSettings,
    ) -> Result<NewtonReport, SolverFailure> {
        assert_eq!(x.len(), self.residual.len());
        let mut report = NewtonReport {
            ending: NewtonEnding::Inadmissible,
            iterations: 0,
            residual_norm: f64::INFINITY,
            shifted: 0,
        };
        report.ending = self.iterate(system, x, settings, &mut report);
        Ok(report)
    }

    fn linearize(&mut self, system: &mut dyn System, x: &[f64]) -> Result<usize, SolverFailure> {
        let start = cpu_seconds();
        let evaluated = system.tangent(x, &mut self.residual, &mut self.values);
        let assembled = cpu_seconds();
        self.times.assembly += assembled - start;
        evaluated.expect("linearize is called at an equilibrium");
        let pivots = self.factor.factorize(&self.values);
        self.times.factorization += cpu_seconds() - assembled;
        // A tangent singular to the last digit is at a limit point: count one direction as lost.
        Ok(pivots.unwrap_or(system.stable_negative_pivots() + 1))
    }

    fn solve_linearized(&mut self, b: &mut [f64]) -> Result<(), SolverFailure> {
        let start = cpu_seconds();
        self.factor.solve(b);
        self.times.factorization += cpu_seconds() - start;
        Ok(())
    }

    fn times(&self) -> SolveTimes {
        self.times
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}
