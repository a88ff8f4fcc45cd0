//! The choice between the two solvers.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::equilibrium_solver::{EquilibriumSolver, SolverFailure};
use super::linear_method::LinearMethod;
use super::native::NativeSolver;
#[cfg(feature = "petsc")]
use super::petsc::Snes;
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
            Self::Petsc => Ok(Box::new(Snes::with_method(pattern, method)?)),
            #[cfg(not(feature = "petsc"))]
            Self::Petsc => Err(SolverFailure {
                library: "PETSc",
                message: "this program was built without it".to_owned(),
            }),
        }
    }
}
