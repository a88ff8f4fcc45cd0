//! Newton's method in pure Rust, with `faer`'s sparse LDL^T.
//!
//! ```text
//! (K(x) + sigma I) dx = -R(x)      x <- x + a dx,  a by `line_search`
//! sigma = 0, or the first of  1e-5 mean|diag K| * 4^k  that leaves no more negative pivots than stable
//! ```
//!
//! With the shift the step is a direction of descent: a minimiser does not walk to a saddle. Multipliers are not shifted.
//!
//! Where [`NewtonSettings::chord_contraction`] allows it, the factor at hand corrects the state before another tangent is made: that of
//! the last stable state on a path, or of the last step. It learns from each correction by BFGS' update (`secants.rs`):
//!
//! ```text
//! x <- x - a H R(x)     while of three corrections in a row the last is shorter than the first by that factor
//! ```

use std::convert::Infallible;
use std::mem;
use std::ops::Range;

use super::factor::LdlFactor;
use super::line_search;
use super::line_search::RESIDUAL_GROWTH;
use super::observed::Observed;
use super::secants::Secants;
use super::shift::{LastShift, mean_diagonal};
use super::vectors::{all_finite, dot, norm};
use super::{
    EquilibriumSolver, NewtonEnding, NewtonReport, NewtonSettings, SolveTimes, SolverFailure,
};
use crate::math::cpu_seconds;
use crate::model::system::{SparsityPattern, System};

/// Corrections by one factor at most: an update costs two vectors and their products.
const MOST_CORRECTIONS: usize = 30;

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
    /// Whether the factor at hand is that of a stable tangent of this system, not shifted.
    is_stable: bool,
    secants: Secants,
    last_shift: LastShift,
    factorizations: usize,
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
        Ok(Self {
            lower: lower_columns(pattern),
            factor: LdlFactor::new(pattern)?,
            entries: vec![0.0; pattern.stored()],
            diagonal: vec![0.0; n],
            residual: vec![0.0; n],
            direction: vec![0.0; n],
            trial: vec![0.0; n],
            trial_residual: vec![0.0; n],
            solution: None,
            linearized: false,
            is_stable: false,
            secants: Secants::default(),
            last_shift: LastShift::default(),
            factorizations: 0,
            times: SolveTimes { assembly: 0.0, factorization: cpu_seconds() - start },
        })
    }

    /// Additions and multiplications of one factorisation.
    #[must_use]
    pub fn factor_operations(&self) -> f64 {
        self.factor.operations()
    }

    fn iterate(
        &mut self,
        system: &mut Observed<'_>,
        x: &mut [f64],
        settings: &NewtonSettings,
        report: &mut NewtonReport,
    ) -> Result<NewtonEnding, SolverFailure> {
        let threshold = settings.tolerance * system.force_scale();
        let stable = system.stable_negative_pivots();
        let corrects = settings.chord_contraction > 0.0;
        if corrects && self.is_stable {
            let Ok(energy) = system.residual(x, &mut self.residual) else {
                return Ok(NewtonEnding::Inadmissible);
            };
            self.secants.clear();
            self.correct(system, x, energy, f64::INFINITY, settings);
        }
        loop {
            let Some(energy) = self.assemble(system, x)? else {
                return Ok(NewtonEnding::Inadmissible);
            };
            mem::swap(&mut self.residual, &mut self.trial_residual);
            report.residual_norm = norm(&self.residual);
            if report.residual_norm <= threshold {
                self.solution = Some(x.to_vec());
                return Ok(NewtonEnding::Converged);
            }
            if report.iterations == settings.max_iterations {
                return Ok(NewtonEnding::IterationLimit);
            }
            report.iterations += 1;
            let unshifted = report.shifted == settings.most_shifted;
            let shift = self.find_direction(stable, unshifted, system.multipliers());
            report.shifted += usize::from(shift != Some(0.0));
            if shift.is_none() {
                return Ok(if unshifted {
                    NewtonEnding::Indefinite
                } else {
                    NewtonEnding::Singular
                });
            }

            let corrects = corrects && shift == Some(0.0);
            let energy = match self.step(system, x, energy, corrects, threshold) {
                Ok(energy) => energy,
                Err(ending) => return Ok(ending),
            };
            if corrects {
                self.step_to_trial(system, x);
                let length = norm(&self.direction);
                self.correct(system, x, energy, length, settings);
            } else {
                x.copy_from_slice(&self.trial);
            }
        }
    }

    /// Corrects `x`, where `residual` and `energy` are known, with the factor at hand until the residual is below the tolerance, as long
    /// as two corrections contract; the first two are measured against the step `before`, of this length.
    fn correct(
        &mut self,
        system: &mut Observed<'_>,
        x: &mut [f64],
        mut energy: f64,
        before: f64,
        settings: &NewtonSettings,
    ) {
        let threshold = settings.tolerance * system.force_scale();
        let mut lengths = [f64::INFINITY, before];
        for _ in 0..MOST_CORRECTIONS {
            if norm(&self.residual) <= threshold {
                return;
            }
            self.solve_for_direction();
            let length = norm(&self.direction);
            let contracts = length <= settings.chord_contraction * lengths[0];
            if !contracts {
                return;
            }
            let Ok(there) = self.step(system, x, energy, true, threshold) else { return };
            energy = there;
            self.step_to_trial(system, x);
            lengths = [lengths[1], length];
        }
    }

    /// Makes a step into `trial`, `with_residual` the residual there into `trial_residual`; the energy there.
    fn step(
        &mut self,
        system: &mut Observed<'_>,
        x: &[f64],
        energy: f64,
        with_residual: bool,
        threshold: f64,
    ) -> Result<f64, NewtonEnding> {
        if system.multipliers().is_empty() {
            self.lower_energy(system, x, energy, with_residual)
        } else {
            let bound = RESIDUAL_GROWTH * norm(&self.residual).max(threshold);
            self.bound_residual(system, x, bound)
        }
    }

    /// Moves `x` to `trial`, where `trial_residual` is known, and learns from that; the step is left in `direction`.
    fn step_to_trial(&mut self, system: &Observed<'_>, x: &mut [f64]) {
        for ((direction, trial), x) in self.direction.iter_mut().zip(&self.trial).zip(&*x) {
            *direction = trial - x;
        }
        // What a saddle has of curvature is no measure of its tangent.
        if system.multipliers().is_empty() {
            self.secants.learn(&self.direction, &self.residual, &self.trial_residual);
        }
        x.swap_with_slice(&mut self.trial);
        mem::swap(&mut self.residual, &mut self.trial_residual);
    }

    /// Makes a step that lowers the `energy` into `trial`; `with_residual` the one there into `trial_residual`.
    fn lower_energy(
        &mut self,
        system: &mut Observed<'_>,
        x: &[f64],
        energy: f64,
        with_residual: bool,
    ) -> Result<f64, NewtonEnding> {
        let slope = dot(&self.residual, &self.direction);
        system.forget_admissible();
        let evaluate = |system: &mut dyn System, trial: &[f64]| {
            if with_residual {
                system.residual(trial, &mut self.trial_residual)
            } else {
                system.energy(trial)
            }
        };
        let step = line_search::search(
            system,
            x,
            &self.direction,
            energy,
            slope,
            &mut self.trial,
            evaluate,
        );
        if let Some(step) = step {
            Ok(step.energy)
        } else if system.met_only_inadmissible() {
            Err(NewtonEnding::Inadmissible)
        } else {
            Err(NewtonEnding::LineSearchFailed)
        }
    }

    /// Makes a step whose residual stays below `bound` into `trial`, and its residual into `trial_residual`.
    fn bound_residual(
        &mut self,
        system: &mut Observed<'_>,
        x: &[f64],
        bound: f64,
    ) -> Result<f64, NewtonEnding> {
        let mut ending = NewtonEnding::Inadmissible;
        for length in line_search::cuts(system.longest_step(x, &self.direction)) {
            for ((trial, x), dx) in self.trial.iter_mut().zip(x).zip(&self.direction) {
                *trial = x + length * dx;
            }
            let evaluated = system.residual(&self.trial, &mut self.trial_residual);
            if let Ok(energy) = evaluated
                && all_finite(&self.trial_residual)
            {
                if norm(&self.trial_residual) <= bound {
                    return Ok(energy);
                }
                ending = NewtonEnding::LineSearchFailed;
            }
        }
        Err(ending)
    }

    /// Puts the tangent at `x` into `entries` and the residual into `trial_residual`; the energy, where all are finite.
    ///
    /// One evaluation serves the convergence check, the next step, and [`EquilibriumSolver::linearize`].
    fn assemble(
        &mut self,
        system: &mut Observed<'_>,
        x: &[f64],
    ) -> Result<Option<f64>, SolverFailure> {
        if system.make_room(x) {
            self.plan(system.pattern())?;
        }
        let Ok(energy) = system.tangent(x, &mut self.trial_residual, &mut self.entries) else {
            return Ok(None);
        };
        Ok((all_finite(&self.trial_residual) && self.tangent_is_finite()).then_some(energy))
    }

    /// Plans the factorisation for another `pattern`.
    fn plan(&mut self, pattern: &SparsityPattern) -> Result<(), SolverFailure> {
        let start = cpu_seconds();
        self.lower = lower_columns(pattern);
        self.factor = LdlFactor::new(pattern)?;
        self.is_stable = false;
        self.entries = vec![0.0; pattern.stored()];
        self.times.factorization += cpu_seconds() - start;
        Ok(())
    }

    /// Plans anew where the system's pattern is not the one that was planned for.
    fn follow_pattern(&mut self, pattern: &SparsityPattern) -> Result<(), SolverFailure> {
        let order = self.factor.pattern().order();
        assert!(order == pattern.order(), "the system's order is not the solver's");
        if self.factor.pattern() == pattern { Ok(()) } else { self.plan(pattern) }
    }

    /// Solves for the direction with the smallest shift, or `unshifted`, that leaves at most `stable` negative pivots;
    /// returns that shift.
    fn find_direction(
        &mut self,
        stable: usize,
        unshifted: bool,
        multipliers: Range<usize>,
    ) -> Option<f64> {
        let start = cpu_seconds();
        let shift = self.factorize_stable(stable, unshifted, multipliers);
        self.times.factorization += cpu_seconds() - start;
        if shift.is_some() {
            self.solve_for_direction();
        }
        shift
    }

    /// Solves for the direction with the factor at hand.
    fn solve_for_direction(&mut self) {
        let start = cpu_seconds();
        for (direction, residual) in self.direction.iter_mut().zip(&self.residual) {
            *direction = -residual;
        }
        self.secants.solve(&mut self.direction, |b| self.factor.solve(b));
        self.times.factorization += cpu_seconds() - start;
    }

    fn factorize_stable(
        &mut self,
        stable: usize,
        unshifted: bool,
        multipliers: Range<usize>,
    ) -> Option<f64> {
        for (diagonal, column) in self.diagonal.iter_mut().zip(&self.lower) {
            *diagonal = self.entries[column.start];
        }
        let mean = mean_diagonal(self.diagonal.iter().copied(), &multipliers);
        let mut last = self.last_shift;
        let found: Result<_, Infallible> = last.smallest(mean, unshifted, |shift| {
            for (i, (diagonal, column)) in self.diagonal.iter().zip(&self.lower).enumerate() {
                if !multipliers.contains(&i) {
                    self.entries[column.start] = diagonal + shift;
                }
            }
            Ok(self.factorize().is_some_and(|negative| negative <= stable))
        });
        self.last_shift = last;
        self.secants.clear();
        let Ok(shift) = found;
        self.is_stable = false;
        shift
    }

    /// Factorises `entries`; the number of negative pivots, `None` when a pivot is zero.
    fn factorize(&mut self) -> Option<usize> {
        self.factorizations += 1;
        self.factor.factorize(&self.entries)
    }

    fn tangent_is_finite(&self) -> bool {
        self.lower.iter().all(|column| all_finite(&self.entries[column.clone()]))
    }
}

impl EquilibriumSolver for NativeSolver {
    /// # Panics
    /// When the system's order is not the solver's.
    fn solve(
        &mut self,
        system: &mut dyn System,
        x: &mut [f64],
        settings: &NewtonSettings,
    ) -> Result<NewtonReport, SolverFailure> {
        self.follow_pattern(system.pattern())?;
        self.linearized = false;
        self.solution = None;
        let mut system = Observed::new(system);
        let mut report = NewtonReport {
            ending: NewtonEnding::Inadmissible,
            iterations: 0,
            residual_norm: f64::INFINITY,
            shifted: 0,
        };
        let ending = self.iterate(&mut system, x, settings, &mut report);
        self.times.assembly += system.seconds();
        report.ending = ending?;
        Ok(report)
    }

    fn linearize(&mut self, system: &mut dyn System, x: &[f64]) -> Result<usize, SolverFailure> {
        let mut is_made = self.solution.take().is_some_and(|solution| solution == x);
        is_made &= self.factor.pattern() == system.pattern();
        if !is_made {
            system.make_room(x);
            self.follow_pattern(system.pattern())?;
        }
        let start = cpu_seconds();
        if !is_made {
            system
                .tangent(x, &mut self.trial_residual, &mut self.entries)
                .expect("linearize is called at an admissible state");
        }
        let assembled = cpu_seconds();
        let negative = self.factorize();
        self.times.assembly += assembled - start;
        self.times.factorization += cpu_seconds() - assembled;
        self.linearized = negative.is_some();
        self.is_stable =
            negative.is_some_and(|negative| negative <= system.stable_negative_pivots());
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

    fn factorizations(&self) -> usize {
        self.factorizations
    }
}

/// Of each column, the stored entries that are read: the diagonal, then what is below it.
fn lower_columns(pattern: &SparsityPattern) -> Vec<Range<usize>> {
    let lower = |column: usize| {
        let stored =
            pattern.column_starts[column] as usize..pattern.column_starts[column + 1] as usize;
        let rows = &pattern.row_indices[stored.clone()];
        assert!(rows.is_sorted_by(|one, next| one < next), "column {column} is not sorted");
        let diagonal = rows.binary_search(&(column as u32)).expect("the diagonal is stored");
        stored.start + diagonal..stored.end
    };
    (0..pattern.order()).map(lower).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve::solver_suite::solver_suite;
    use crate::solve::test_systems::Chain;

    fn walked(chain: &mut Chain, x: &mut [f64], chord_contraction: f64) -> NewtonReport {
        let settings = NewtonSettings { chord_contraction, ..NewtonSettings::default() };
        NativeSolver::new(chain.pattern()).unwrap().solve(chain, x, &settings).unwrap()
    }

    #[test]
    fn chords_reach_the_closed_form_with_fewer_tangents() {
        let mut chain = Chain::hardening(20, 0.625);
        let tangents = [0.0, 0.5].map(|contraction| {
            let mut x = [0.0; 20];
            let report = walked(&mut chain, &mut x, contraction);
            assert_eq!(report.ending, NewtonEnding::Converged);
            assert!(report.residual_norm <= 1e-9, "{report:?}");
            // |R| <= 1e-9, and the softest mode has stiffness 1.75 (pi / 41)^2 = 0.01.
            for (index, x) in x.iter().enumerate() {
                assert!((x - 0.5 * (index + 1) as f64).abs() <= 1e-7, "{x}");
            }
            report.iterations
        });
        assert!(tangents[1] < tangents[0], "{tangents:?}");
    }

    /// From one state to the next without a tangent between: the one of the last state serves.
    #[test]
    fn factor_of_the_last_state_reaches_the_next_one() {
        let mut chain = Chain::hardening(20, 0.625);
        let mut solver = NativeSolver::new(chain.pattern()).unwrap();
        let settings = NewtonSettings { chord_contraction: 0.9, ..NewtonSettings::default() };
        let mut x = [0.0; 20];
        assert_eq!(solver.linearize(&mut chain, &x).unwrap(), 0);
        let report = solver.solve(&mut chain, &mut x, &settings).unwrap();
        assert_eq!((report.ending, report.iterations), (NewtonEnding::Converged, 0));
        // As above.
        for (index, x) in x.iter().enumerate() {
            assert!((x - 0.5 * (index + 1) as f64).abs() <= 1e-7, "{x}");
        }
    }

    #[test]
    fn chords_do_not_lead_to_a_saddle() {
        // Each spring of the double well is stable at 1 and -1, and at rest, unstable, at 0.
        let mut chain = Chain::double_well(12);
        let mut x: [f64; 12] = std::array::from_fn(|index| 0.1 + 0.02 * index as f64);
        let report = walked(&mut chain, &mut x, 0.5);
        assert_eq!(report.ending, NewtonEnding::Converged);
        assert!(report.shifted > 0, "{report:?}");
        // |R| <= 1e-9 where the stiffness is 2.
        assert!(x.iter().all(|x| (x - 1.0).abs() <= 1e-9), "{x:?}");
    }

    solver_suite!(|pattern| NativeSolver::new(pattern).unwrap());
}
