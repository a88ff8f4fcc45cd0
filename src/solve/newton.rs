//! Newton's method as all solvers report it: when it stops, and how it ended.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// When Newton's method stops.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct NewtonSettings {
    /// Converged when the residual's norm is below this times the system's force scale.
    pub tolerance: f64,
    /// Given up after this many iterations.
    pub max_iterations: usize,
    /// The native solver's factor at hand, with BFGS' updates, corrects the state again while of three corrections in a row the last is
    /// shorter than the first by this factor; 0: each correction has a tangent of its own, as always with PETSc.
    ///
    /// # Decisions
    /// 0 unless asked for, so that both solvers walk through the same iterates. Searches ask for 0.9. The 33 designs that were walked in
    /// a late generation (4,200 unknowns and less, both scenarios, tolerance 1e-7) took 1,580 factorisations and 60 CPU seconds with
    /// plain chords that had to divide the residual by three, and 794 and 45 so; with 0.3 and 0.6 instead of 0.9, 1,026 and 861
    /// factorisations. No objective moved by more than 2e-5. A tangent with its factor takes the time of nine corrections. Measuring
    /// the residual instead of the step, or starting without the factor of the last stable state, kept 1,100 to 1,500 factorisations:
    /// where a wall that bends by a linear step stretches by its square, the residual grows first.
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
    /// Iterations, each one tangent and one factorisation (more when shifted); corrections by a factor at hand are not counted.
    pub iterations: usize,
    /// Norm of the residual at the last iterate, N.
    pub residual_norm: f64,
    /// Iterations whose tangent had too many negative pivots and was shifted by a multiple of the identity.
    pub shifted: usize,
}
