//! Which state makes the residual vanish? Newton's method, linear solvers, and the loading path.
//!
//! Two solvers stand behind [`EquilibriumSolver`]: ours with `faer`, and PETSc's SNES with MUMPS.
//! Both run the same line search on the energy, so that they walk through the same iterates.

mod backend;
mod bordered;
mod curve;
mod damped;
mod decorator;
mod ending;
mod factor;
mod hermite;
mod job;
mod krylov;
#[cfg(feature = "petsc")]
mod lanczos;
mod line_search;
mod linear;
mod native;
mod observed;
mod past_limit;
mod path;
#[cfg(test)]
mod path_tests;
#[cfg(feature = "petsc")]
mod petsc;
mod shift;
mod snap;
#[cfg(test)]
mod solver_suite;
mod stability_loss;
mod stop;
mod supply;
#[cfg(test)]
mod test_systems;
mod vectors;
mod walk;

use std::ops::AddAssign;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::model::system::System;

pub use backend::{Backend, LinearMethod};
pub use ending::Ending;
pub use hermite::{Cubic, Segment, hermite_basis};
pub use job::{Job, Message, confined};
pub use krylov::{KrylovReport, solve_unsymmetric};
pub use linear::linear_path;
pub use native::NativeSolver;
pub use path::{Path, PathPoint, PathSettings, Programme, follow, follow_from, follow_watched};
#[cfg(feature = "petsc")]
pub use petsc::Snes;
pub use snap::Snap;
pub use stop::Stop;
pub use supply::Supply;

/// When Newton's method stops.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct NewtonSettings {
    /// Converged when the residual's norm is below this times the system's force scale.
    pub tolerance: f64,
    /// Given up after this many iterations.
    pub max_iterations: usize,
    /// The native solver's factor of a tangent corrects the state again while each time the residual contracts by this factor;
    /// 0: each correction has a tangent of its own, as always with PETSc.
    ///
    /// # Decisions
    /// 0 unless asked for, so that both solvers walk through the same iterates. Searches ask for 0.3: of seven designs of an evolved
    /// front, both scenarios, tolerance 1e-7, factors of 0, 0.03, 0.1, 0.3 and 0.5 took 615, 495, 447, 389 and 358 tangents, and moved
    /// no objective by more than 5e-6. The candidates of `examples/paper.toml` took 3,609 CPU seconds instead of 4,099: residuals cost
    /// nearly what their tangents save in assembly, as the wall's points compute both.
    pub chord_contraction: f64,
    /// Given up when more tangents than this were indefinite.
    #[serde(skip)]
    pub most_shifted: usize,
}

impl Default for NewtonSettings {
    fn default() -> Self {
        Self {
            tolerance: 1e-9,
            max_iterations: 25,
            chord_contraction: 0.0,
            most_shifted: usize::MAX,
        }
    }
}

/// How a Newton solve ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum NewtonEnding {
    /// The residual is below the tolerance.
    Converged,
    /// The iteration limit was reached.
    IterationLimit,
    /// No step along the Newton direction lowers the energy.
    LineSearchFailed,
    /// The start, or every step from an iterate, is inadmissible.
    Inadmissible,
    /// The tangent could not be made positive definite by a shift.
    Singular,
    /// More tangents were indefinite than may be.
    Indefinite,
}

/// What a Newton solve did.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct NewtonReport {
    /// Why it stopped.
    pub ending: NewtonEnding,
    /// Iterations, each one tangent and one factorisation (more when shifted); chords are not counted.
    pub iterations: usize,
    /// Norm of the residual at the last iterate, N.
    pub residual_norm: f64,
    /// Iterations whose tangent had too many negative pivots and was shifted by a multiple of the identity.
    pub shifted: usize,
}

/// The solver library itself failed (not the design).
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{library} failed: {message}")]
pub struct SolverFailure {
    /// Which library.
    pub library: &'static str,
    /// What it said.
    pub message: String,
}

/// What walking asked of a solver, counted: the same on every machine, where CPU seconds are not.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SolveCounts {
    /// Newton iterations, all of them.
    pub newton_iterations: usize,
    /// Those among them whose attempt gave no state of the path: steps cut, falls without an end, looks past a limit point.
    pub failed_iterations: usize,
    /// Numerical factorisations: one for each iteration and each state, and more where tangents are shifted.
    pub factorizations: usize,
}

impl AddAssign for SolveCounts {
    fn add_assign(&mut self, other: Self) {
        self.newton_iterations += other.newton_iterations;
        self.failed_iterations += other.failed_iterations;
        self.factorizations += other.factorizations;
    }
}

/// CPU seconds spent by a solver since it was made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SolveTimes {
    /// Evaluating energy, residual and tangent.
    pub assembly: f64,
    /// Factorising and solving linear systems.
    pub factorization: f64,
}

/// Finds equilibria of one [`System`], whose pattern may change ([`System::make_room`]).
///
/// The factorisation is planned for a pattern, and planned anew where the system's is another.
pub trait EquilibriumSolver {
    /// Solves `R(x) = 0` from the guess in `x [n]`, which receives the last iterate.
    ///
    /// # Errors
    /// [`SolverFailure`] when the library fails. Divergence is reported in [`NewtonReport`].
    fn solve(
        &mut self,
        system: &mut dyn System,
        x: &mut [f64],
        settings: &NewtonSettings,
    ) -> Result<NewtonReport, SolverFailure>;

    /// Factorises the unshifted tangent at `x [n]` and returns its number of negative pivots.
    ///
    /// A singular tangent, as at a limit point, has more than [`System::stable_negative_pivots`]: at least one
    /// direction is lost. Where `x` is the solution that [`Self::solve`] just found, its last tangent may be used again:
    /// the system must not have changed in between.
    ///
    /// # Errors
    /// [`SolverFailure`] when the library fails.
    ///
    /// # Panics
    /// May panic when `x` is not admissible: call it at an equilibrium found by [`Self::solve`].
    fn linearize(&mut self, system: &mut dyn System, x: &[f64]) -> Result<usize, SolverFailure>;

    /// Solves `K y = b` with the last [`Self::linearize`]d tangent; `b [n]` is overwritten by `y`.
    ///
    /// # Errors
    /// [`SolverFailure`] when the library fails.
    ///
    /// # Panics
    /// When no tangent that can be inverted was [`Self::linearize`]d since the last [`Self::solve`].
    fn solve_linearized(&mut self, b: &mut [f64]) -> Result<(), SolverFailure>;

    /// Whether the last [`Self::linearize`]d tangent can be inverted.
    fn is_invertible(&self) -> bool;

    /// CPU seconds so far.
    fn times(&self) -> SolveTimes;

    /// Numerical factorisations so far, those of shifted tangents too; where systems are solved by iteration, preconditioners.
    fn factorizations(&self) -> usize;
}
