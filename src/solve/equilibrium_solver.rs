//! What a solver does, and how it fails.

use serde::{Deserialize, Serialize};

use super::newton::{NewtonReport, NewtonSettings};
use crate::model::system::System;

/// The solver library itself failed (not the design).
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{library} failed: {message}")]
pub struct SolverFailure {
    /// Which library.
    pub library: &'static str,
    /// What it said.
    pub message: String,
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
