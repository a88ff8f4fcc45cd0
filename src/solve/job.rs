//! This process among those that `mpirun` started together.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::thread;

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

    /// Whether any of its processes says yes; all must ask.
    ///
    /// # Errors
    /// [`SolverFailure`] when MPI fails.
    pub fn any(self, mine: bool) -> Result<bool, SolverFailure> {
        #[cfg(feature = "petsc")]
        if self.ranks > 1 {
            return super::petsc::any(mine);
        }
        Ok(mine)
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

/// Bytes that one process tells another.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    /// To whom it goes, or from whom it came.
    pub rank: usize,
    /// What the bytes are; not negative.
    pub kind: i32,
    /// As they were sent.
    pub bytes: Vec<u8>,
}

/// Sending and receiving do not block for short messages; those between two processes stay in order.
impl Job {
    /// Sends a message to another process.
    ///
    /// # Errors
    /// [`SolverFailure`] when MPI fails.
    pub fn send(self, message: &Message) -> Result<(), SolverFailure> {
        #[cfg(feature = "petsc")]
        return super::petsc::send(message);
        #[cfg(not(feature = "petsc"))]
        unreachable!("there is no process to send {message:?} to");
    }

    /// The next message from another process, if one waits.
    ///
    /// # Errors
    /// [`SolverFailure`] when MPI fails.
    pub fn receive(self) -> Result<Option<Message>, SolverFailure> {
        #[cfg(feature = "petsc")]
        return super::petsc::receive();
        #[cfg(not(feature = "petsc"))]
        Ok(None)
    }
}

thread_local! {
    /// A panic of this thread is caught, and no other process waits for it.
    static CONFINED: Cell<bool> = const { Cell::new(false) };
}

/// Runs `body` so that a panic in it ends neither this process nor the others of its job.
///
/// # Errors
/// The panic's payload.
pub fn confined<Output>(body: impl FnOnce() -> Output) -> thread::Result<Output> {
    let before = CONFINED.replace(true);
    // The caller drops what the body has left half done.
    let outcome = catch_unwind(AssertUnwindSafe(body));
    CONFINED.set(before);
    outcome
}

/// Whether a panic of this thread is caught by [`confined`].
#[cfg(feature = "petsc")]
pub(super) fn is_confined() -> bool {
    CONFINED.get()
}

/// How many processes there are, in the environment that Open MPI's launcher sets, and in that of MPICH's.
const SIZES: [&str; 2] = ["OMPI_COMM_WORLD_SIZE", "PMI_SIZE"];
