//! Equilibria by PETSc: SNES drives Newton's method, MUMPS factorises, our line search chooses the step.
//!
//! ```text
//! (K(x) + sigma I) dx = -R(x)      x <- x + a dx,  a by `line_search`
//! sigma = 0, or the first of  1e-5 mean|diag K| * 4^k  that leaves no more negative pivots than stable
//! ```
//!
//! The energy is the line search's objective. Alone, the matrix is SBAIJ (upper triangle) with an `L D L^T` whose
//! analysis is made once per pattern; there is one numeric factorisation per tangent and shift. SNES never sees
//! it, so where the pattern grows in the midst of a solve it is made anew.

#[cfg(test)]
mod together_tests;

use std::hash::{DefaultHasher, Hash, Hasher};
use std::ops::Range;

use super::library::{Driver, Newton, Session};
use super::shared::Shared;
use super::tangent::{Plan, Tangent};
use crate::math::cpu_seconds;
use crate::model::system::{SparsityPattern, System};
use crate::solve::line_search::RESIDUAL_GROWTH;
use crate::solve::observed::Observed;
use crate::solve::vectors::all_finite;
use crate::solve::{
    EquilibriumSolver, LinearMethod, NewtonEnding, NewtonReport, NewtonSettings, SolveTimes,
    SolverFailure, line_search,
};

/// Solver by PETSc's SNES with MUMPS.
///
/// Any number may exist and be used from any threads, but PETSc is not thread-safe: each call holds a
/// process-wide lock, so calls from several threads take turns. Work in parallel by processes.
///
/// After a [`SolverFailure`] make a new solver; after a panic of the system it may be used again.
#[derive(Debug)]
pub struct Snes {
    order: usize,
    method: LinearMethod,
    /// None where the system must be seen first.
    plan: Option<Plan>,
    tangent: Option<Tangent>,
    driver: Driver,
    linearized: bool,
    times: SolveTimes,
    /// Of tangents that are no more.
    iterations: usize,
}

impl Snes {
    /// A solver for systems with this `pattern`; starts PETSc (and MPI) if this is the first in the process.
    ///
    /// # Errors
    /// [`SolverFailure`] when PETSc cannot start, or was built without MUMPS.
    ///
    /// # Panics
    /// When a column has no diagonal entry, or its rows are not sorted or out of range.
    pub fn new(pattern: &SparsityPattern) -> Result<Self, SolverFailure> {
        Self::with_method(pattern, LinearMethod::Automatic)
    }

    /// As [`Self::new`], with linear systems solved by `method`.
    ///
    /// # Errors
    /// As [`Self::new`].
    ///
    /// # Panics
    /// As [`Self::new`].
    pub fn with_method(
        pattern: &SparsityPattern,
        method: LinearMethod,
    ) -> Result<Self, SolverFailure> {
        let session = Session::open()?;
        let start = cpu_seconds();
        let order = pattern.order();
        if session.rank().1 > 1 && !session.is_same(digest(pattern)) {
            let message = "the ranks of the job do not have the same system".to_owned();
            return Err(SolverFailure { library: "PETSc", message });
        }
        let plan = Plan::of_order(&session, order, method);
        let tangent =
            plan.as_ref().map(|plan| Tangent::new(&session, pattern, plan)).transpose()?;
        let driver = Driver::new(&session, order)?;
        let times = SolveTimes { assembly: 0.0, factorization: cpu_seconds() - start };
        Ok(Self { order, method, plan, tangent, driver, linearized: false, times, iterations: 0 })
    }

    /// Iterations of linear solutions since it was made; 0 where tangents are factorised.
    #[must_use]
    pub fn linear_iterations(&self) -> usize {
        self.iterations + self.tangent.as_ref().map_or(0, Tangent::iterations)
    }

    /// Plans for the system where nobody did, or anew where its pattern is another.
    fn follow(&mut self, session: &Session, system: &dyn System) -> Result<(), SolverFailure> {
        let pattern = system.pattern();
        if self.tangent.as_ref().is_some_and(|tangent| tangent.pattern == *pattern) {
            return Ok(());
        }
        let start = cpu_seconds();
        self.iterations = self.linear_iterations();
        let factorizations = self.factorizations();
        self.tangent = None;
        let plan = match self.plan.take() {
            Some(plan) => plan,
            None => Plan::new(session, system, self.method)?,
        };
        let mut tangent = Tangent::new(session, pattern, &plan)?;
        tangent.factorizations = factorizations;
        self.tangent = Some(tangent);
        self.plan = Some(plan);
        self.times.factorization += cpu_seconds() - start;
        Ok(())
    }

    fn check_order(&self, system: &dyn System) {
        let order = system.pattern().order();
        assert!(order == self.order, "the system's order is not the solver's");
    }
}

/// A number that another `pattern` is unlikely to have.
fn digest(pattern: &SparsityPattern) -> u32 {
    let mut hasher = DefaultHasher::new();
    pattern.column_starts.hash(&mut hasher);
    pattern.row_indices.hash(&mut hasher);
    hasher.finish() as u32
}

impl EquilibriumSolver for Snes {
    /// # Panics
    /// When the system's order is not the solver's, when the system panics, or calls a PETSc solver itself.
    fn solve(
        &mut self,
        system: &mut dyn System,
        x: &mut [f64],
        settings: &NewtonSettings,
    ) -> Result<NewtonReport, SolverFailure> {
        self.check_order(system);
        self.linearized = false;
        let session = Session::open()?;
        self.follow(&session, system)?;
        let (Some(tangent), Some(plan)) = (&mut self.tangent, &self.plan) else {
            unreachable!("a tangent was planned");
        };
        let mut shared;
        let system: &mut dyn System = match plan.exchange() {
            None => system,
            Some(exchange) => {
                shared = Shared::new(system, exchange, &session);
                &mut shared
            }
        };
        let order = x.len();
        let mut drive = Drive {
            session: &session,
            threshold: settings.tolerance * system.force_scale(),
            stable_negative_pivots: system.stable_negative_pivots(),
            most_shifted: settings.most_shifted,
            multipliers: system.multipliers(),
            system: Observed::new(system),
            plan,
            tangent,
            energy: f64::INFINITY,
            direction: vec![0.0; order],
            trial: vec![0.0; order],
            trial_residual: vec![0.0; order],
            inadmissible: false,
            factorization: 0.0,
            iterations: 0,
            residual_norm: f64::INFINITY,
            contraction: 0.0,
            shifted: 0,
            replaced: 0,
        };
        let ended = self.driver.solve(&session, &mut drive, x, settings.max_iterations);
        self.times.assembly += drive.system.seconds();
        self.times.factorization += drive.factorization;
        self.iterations += drive.replaced;
        let ended = ended?;
        let ending = match ended {
            _ if drive.inadmissible => NewtonEnding::Inadmissible,
            NewtonEnding::Singular if drive.shifted > settings.most_shifted => {
                NewtonEnding::Indefinite
            }
            ended => ended,
        };
        Ok(NewtonReport {
            ending,
            iterations: drive.iterations,
            residual_norm: drive.residual_norm,
            shifted: drive.shifted,
        })
    }

    fn linearize(&mut self, system: &mut dyn System, x: &[f64]) -> Result<usize, SolverFailure> {
        self.check_order(system);
        self.linearized = false;
        let start = cpu_seconds();
        system.make_room(x);
        self.times.assembly += cpu_seconds() - start;
        let session = Session::open()?;
        self.follow(&session, system)?;
        let (Some(tangent), Some(plan)) = (&mut self.tangent, &self.plan) else {
            unreachable!("a tangent was planned");
        };
        let start = cpu_seconds();
        let mut residual = vec![0.0; x.len()];
        let made = match plan.exchange() {
            None => system.tangent(x, &mut residual, &mut tangent.entries),
            Some(exchange) => Shared::new(system, exchange, &session).tangent(
                x,
                &mut residual,
                &mut tangent.entries,
            ),
        };
        made.expect("linearize is called at an admissible state");
        let assembled = cpu_seconds();
        self.times.assembly += assembled - start;
        let inertia = tangent.inertia(&session, &system.multipliers())?;
        self.times.factorization += cpu_seconds() - assembled;
        self.linearized = inertia.is_some_and(|inertia| inertia.zero == 0);
        let lost = inertia.map(|inertia| inertia.negative + inertia.zero);
        Ok(lost.unwrap_or(system.stable_negative_pivots() + 1))
    }

    fn solve_linearized(&mut self, b: &mut [f64]) -> Result<(), SolverFailure> {
        assert!(self.linearized, "solve_linearized without linearize before it");
        let session = Session::open()?;
        let start = cpu_seconds();
        let solved = match &mut self.tangent {
            Some(tangent) => tangent.solve(&session, b, LINEARIZED_TOLERANCE)?,
            None => unreachable!("a tangent was linearized"),
        };
        self.times.factorization += cpu_seconds() - start;
        if solved {
            return Ok(());
        }
        let message = "the iteration with the tangent did not converge".to_owned();
        Err(SolverFailure { library: "PETSc", message })
    }

    fn is_invertible(&self) -> bool {
        self.linearized
    }

    fn times(&self) -> SolveTimes {
        self.times
    }

    fn factorizations(&self) -> usize {
        self.tangent.as_ref().map_or(0, |tangent| tangent.factorizations)
    }
}

/// One solve: the system's answers to what SNES asks.
struct Drive<'a> {
    session: &'a Session,
    threshold: f64,
    stable_negative_pivots: usize,
    most_shifted: usize,
    multipliers: Range<usize>,
    system: Observed<'a>,
    plan: &'a Plan,
    tangent: &'a mut Tangent,
    /// The energy at the iterate, mJ.
    energy: f64,
    direction: Vec<f64>,
    trial: Vec<f64>,
    trial_residual: Vec<f64>,
    /// The solve cannot go on, because what it needs next is not defined.
    inadmissible: bool,
    factorization: f64,
    iterations: usize,
    residual_norm: f64,
    /// The residual's norm over that before, 1 where it grew; 0 at the start.
    contraction: f64,
    shifted: usize,
    /// Linear iterations of tangents that are no more.
    replaced: usize,
}

impl Newton for Drive<'_> {
    fn residual(&mut self, x: &[f64], residual: &mut [f64]) -> bool {
        match self.system.residual(x, residual) {
            Ok(energy) if all_finite(residual) => self.energy = energy,
            _ => self.inadmissible = true,
        }
        !self.inadmissible
    }

    fn converged(&mut self, residual_norm: f64) -> bool {
        self.contraction = residual_norm / self.residual_norm.max(residual_norm);
        self.residual_norm = residual_norm;
        residual_norm <= self.threshold
    }

    fn tangent(&mut self, x: &[f64]) -> Result<(), SolverFailure> {
        if self.system.make_room(x) {
            let start = cpu_seconds();
            self.replaced += self.tangent.iterations();
            let factorizations = self.tangent.factorizations;
            *self.tangent = Tangent::new(self.session, self.system.pattern(), self.plan)?;
            self.tangent.factorizations = factorizations;
            self.factorization += cpu_seconds() - start;
        }
        let made = self.system.tangent(x, &mut self.trial_residual, &mut self.tangent.entries);
        self.inadmissible = made.is_err() || !self.tangent.is_finite(self.session);
        Ok(())
    }

    fn correction(&mut self, b: &mut [f64]) -> Result<bool, SolverFailure> {
        if self.inadmissible {
            return Ok(false);
        }
        let start = cpu_seconds();
        let shift = self.tangent.factorize_stable(
            self.session,
            self.stable_negative_pivots,
            self.shifted == self.most_shifted,
            &self.multipliers,
        )?;
        let solved = shift.is_some() && self.tangent.solve(self.session, b, self.forcing())?;
        self.factorization += cpu_seconds() - start;
        self.iterations += 1;
        self.shifted += usize::from(shift != Some(0.0));
        Ok(solved)
    }

    fn step(&mut self, x: &mut [f64], residual: &mut [f64], correction: &[f64]) -> bool {
        for (direction, correction) in self.direction.iter_mut().zip(correction) {
            *direction = -correction;
        }
        if !self.multipliers.is_empty() {
            return self.step_within_bound(x, residual);
        }
        let slope = residual.iter().zip(&self.direction).map(|(r, d)| r * d).sum();
        self.system.forget_admissible();
        let step = line_search::search(
            &mut self.system,
            x,
            &self.direction,
            self.energy,
            slope,
            &mut self.trial,
            |system, trial| system.energy(trial),
        );
        if step.is_none() {
            self.inadmissible = self.system.met_only_inadmissible();
            return false;
        }
        match self.system.residual(&self.trial, &mut self.trial_residual) {
            Ok(energy) if all_finite(&self.trial_residual) => {
                self.energy = energy;
                x.copy_from_slice(&self.trial);
                residual.copy_from_slice(&self.trial_residual);
            }
            _ => self.inadmissible = true,
        }
        !self.inadmissible
    }
}

impl Drive<'_> {
    /// What an iteration should leave of the residual, as a share: as much as the next step will find anyhow. Source: Eisenstat & Walker
    /// (1996), choice 2; bounded below by what the end of Newton's method asks for.
    fn forcing(&self) -> f64 {
        let expected = 0.9 * self.contraction * self.contraction;
        let enough = 0.01 * self.threshold / self.residual_norm;
        if expected == 0.0 { LOOSEST } else { expected.max(enough).clamp(TIGHTEST, LOOSEST) }
    }

    /// Makes a step whose residual stays within bounds.
    fn step_within_bound(&mut self, x: &mut [f64], residual: &mut [f64]) -> bool {
        let bound = RESIDUAL_GROWTH * self.residual_norm.max(self.threshold);
        self.inadmissible = true;
        for length in line_search::cuts(self.system.longest_step(x, &self.direction)) {
            for ((trial, x), dx) in self.trial.iter_mut().zip(&*x).zip(&self.direction) {
                *trial = x + length * dx;
            }
            let evaluated = self.system.residual(&self.trial, &mut self.trial_residual);
            let Ok(energy) = evaluated else { continue };
            if all_finite(&self.trial_residual) {
                self.inadmissible = false;
                let square: f64 = self.trial_residual.iter().map(|r| r * r).sum();
                if square.sqrt() <= bound {
                    self.energy = energy;
                    x.copy_from_slice(&self.trial);
                    residual.copy_from_slice(&self.trial_residual);
                    return true;
                }
            }
        }
        false
    }
}

/// Bounds of how well an iteration solves a Newton step.
const TIGHTEST: f64 = 1e-6;
const LOOSEST: f64 = 1e-2;
/// What solves with a linearized tangent ask of an iteration.
const LINEARIZED_TOLERANCE: f64 = 1e-10;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::system::Inadmissible;
    use crate::solve::petsc::library::Inertia;
    use crate::solve::solver_suite::solver_suite;

    solver_suite!(|pattern| Snes::new(pattern).unwrap());

    /// A system that uses a PETSc solver to evaluate itself.
    struct Nested(SparsityPattern);

    impl System for Nested {
        fn pattern(&self) -> &SparsityPattern {
            &self.0
        }

        fn energy(&mut self, _: &[f64]) -> Result<f64, Inadmissible> {
            Ok(Snes::new(&self.0).map_or(0.0, |solver| solver.times().assembly))
        }

        fn residual(&mut self, x: &[f64], _: &mut [f64]) -> Result<f64, Inadmissible> {
            self.energy(x)
        }

        fn tangent(
            &mut self,
            x: &[f64],
            _: &mut [f64],
            _: &mut [f64],
        ) -> Result<f64, Inadmissible> {
            self.energy(x)
        }

        fn force_scale(&self) -> f64 {
            1.0
        }
    }

    fn one() -> SparsityPattern {
        SparsityPattern { column_starts: vec![0, 1], row_indices: vec![0] }
    }

    #[test]
    #[should_panic(expected = "called from within a PETSc solve")]
    fn solver_inside_a_solve_panics_instead_of_waiting_for_itself() {
        let mut nested = Nested(one());
        let mut solver = Snes::new(nested.pattern()).unwrap();
        let _ = solver.solve(&mut nested, &mut [0.0], &NewtonSettings::default());
    }

    #[test]
    fn patterns_that_petsc_would_misread_are_refused() {
        for row_indices in [[1, 0, 1], [0, 1, 2], [0, 0, 1], [0, 1, 0]] {
            let column_starts = vec![0, 2, 3];
            let pattern = SparsityPattern { column_starts, row_indices: row_indices.to_vec() };
            assert!(std::panic::catch_unwind(|| Snes::new(&pattern)).is_err(), "{row_indices:?}");
        }
    }

    #[test]
    fn solver_made_here_works_in_another_thread() {
        let mut solver = Snes::new(&one()).unwrap();
        let thread = std::thread::spawn(move || {
            let inertia = {
                let session = Session::open().unwrap();
                let tangent = solver.tangent.as_mut().unwrap();
                tangent.entries[0] = -4.0;
                tangent.inertia(&session, &(0..0)).unwrap()
            };
            assert_eq!(inertia, Some(Inertia { negative: 1, zero: 0 }));
            solver
        });
        drop(thread.join().unwrap());
    }
}
