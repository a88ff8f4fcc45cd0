//! This process among those that `mpirun` started together.

use super::SolverFailure;

/// The processes that solve one problem together, all of them running the same program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Job {
    /// The number of this process, from 0.
    pub rank: usize,
    /// How many there are.
    pub ranks: usize,
}

impl Job {
    /// The job of this process; starts MPI if a launcher says that there are several processes.
    ///
    /// # Errors
    /// [`SolverFailure`] when PETSc or MPI cannot be started, or is not built in where a launcher wants it.
    pub fn join() -> Result<Self, SolverFailure> {
        let several = |name| std::env::var(name).is_ok_and(|size| size != "1");
        if !SIZES.into_iter().any(several) {
            return Ok(Self { rank: 0, ranks: 1 });
        }
        #[cfg(feature = "petsc")]
        {
            let (rank, ranks) = super::petsc::rank()?;
            Ok(Self { rank, ranks })
        }
        #[cfg(not(feature = "petsc"))]
        Err(SolverFailure {
            library: "PETSc",
            message:
                "several processes solve together by it, and this program was built without it"
                    .to_owned(),
        })
    }

    /// Ends all its processes where there are several: one that only left would be waited for.
    pub fn abort(self) {
        #[cfg(feature = "petsc")]
        if self.ranks > 1 {
            super::petsc::abort();
        }
    }

    /// Whether this is the process that writes and prints.
    #[must_use]
    pub fn is_first(self) -> bool {
        self.rank == 0
    }
}

/// How many processes there are, in the environment that Open MPI's launcher sets, and in that of MPICH's.
const SIZES: [&str; 2] = ["OMPI_COMM_WORLD_SIZE", "PMI_SIZE"];
