//! The choice between the two solvers.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{EquilibriumSolver, NativeSolver, SolverFailure};
use crate::model::system::SparsityPattern;

/// Which library finds the equilibria.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Backend {
    /// Our Newton with `faer`; runs on any number of threads at once.
    Native,
    /// PETSc's SNES with MUMPS; one solve at a time in each process.
    Petsc,
}

/// How linear systems are solved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum LinearMethod {
    /// By size: a factorisation while that is the faster.
    #[default]
    #[serde(rename = "auto")]
    Automatic,
    /// A sparse factorisation, which counts negative pivots.
    Direct,
    /// A preconditioned iteration, for solids (systems with multipliers that know their places) by PETSc; all else is factorised.
    Iterative,
}

impl Backend {
    /// Whether this program was built with the library.
    #[must_use]
    pub fn is_built_in(self) -> bool {
        self == Self::Native || cfg!(feature = "petsc")
    }

    /// A solver for systems with `pattern`.
    ///
    /// # Errors
    /// [`SolverFailure`] when the library cannot be started, or is not built in.
    pub fn solver(
        self,
        pattern: &SparsityPattern,
    ) -> Result<Box<dyn EquilibriumSolver>, SolverFailure> {
        self.solver_by(LinearMethod::Automatic, pattern)
    }

    /// A solver for systems with `pattern` that solves linear systems by `method`, if it has it.
    ///
    /// # Errors
    /// As [`Self::solver`].
    pub fn solver_by(
        self,
        method: LinearMethod,
        pattern: &SparsityPattern,
    ) -> Result<Box<dyn EquilibriumSolver>, SolverFailure> {
        match self {
            Self::Native if method == LinearMethod::Iterative => Err(SolverFailure {
                library: "faer",
                message: "it factorises, and has no iteration".to_owned(),
            }),
            Self::Native => Ok(Box::new(NativeSolver::new(pattern)?)),
            #[cfg(feature = "petsc")]
            Self::Petsc => Ok(Box::new(super::Snes::with_method(pattern, method)?)),
            #[cfg(not(feature = "petsc"))]
            Self::Petsc => Err(SolverFailure {
                library: "PETSc",
                message: "this program was built without it".to_owned(),
            }),
        }
    }
}
