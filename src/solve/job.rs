//! This process among those that `mpirun` started together.

use super::equilibrium_solver::SolverFailure;
use super::message::Message;
#[cfg(feature = "petsc")]
use super::petsc::{Session, abort_job};

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
            let (rank, ranks) = Session::open()?.rank();
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

    /// Whether any of its processes says yes; all must ask.
    ///
    /// # Errors
    /// [`SolverFailure`] when MPI fails.
    pub fn any(self, mine: bool) -> Result<bool, SolverFailure> {
        #[cfg(feature = "petsc")]
        if self.ranks > 1 {
            return Ok(Session::open()?.any(mine));
        }
        Ok(mine)
    }

    /// Ends all its processes where there are several: one that only left would be waited for.
    pub fn abort(self) {
        #[cfg(feature = "petsc")]
        if self.ranks > 1 {
            abort_job();
        }
    }

    /// Whether this is the process that writes and prints.
    #[must_use]
    pub fn is_first(self) -> bool {
        self.rank == 0
    }
}

/// Sending and receiving do not block for short messages; those between two processes stay in order.
impl Job {
    /// Sends a message to another process.
    ///
    /// # Errors
    /// [`SolverFailure`] when MPI fails.
    pub fn send(self, message: &Message) -> Result<(), SolverFailure> {
        #[cfg(feature = "petsc")]
        return Session::open()?.send(message);
        #[cfg(not(feature = "petsc"))]
        unreachable!("there is no process to send {message:?} to");
    }

    /// The next message from another process, if one waits.
    ///
    /// # Errors
    /// [`SolverFailure`] when MPI fails.
    pub fn receive(self) -> Result<Option<Message>, SolverFailure> {
        #[cfg(feature = "petsc")]
        return Session::open()?.receive();
        #[cfg(not(feature = "petsc"))]
        Ok(None)
    }
}

/// How many processes there are, in the environment that Open MPI's launcher sets, and in that of MPICH's.
const SIZES: [&str; 2] = ["OMPI_COMM_WORLD_SIZE", "PMI_SIZE"];
