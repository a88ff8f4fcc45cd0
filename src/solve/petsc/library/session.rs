//! The right to call PETSc, and how it starts, fails and ends.
//!
//! # Threads
//!
//! PETSc is not thread-safe, but its objects on `PETSC_COMM_SELF` belong to no thread. Every method wants
//! a [`Session`], the process-wide lock, taken for one public call and not for the life of an object:
//! several solvers coexist, move between threads and take turns. MPI is asked for the level at which
//! different threads may call it in turn (`MPI_THREAD_SERIALIZED`).
//!
//! # Start and end
//!
//! The library is started by the first session, which costs some tenths of a second; a program that uses
//! MPI itself initialises it before. It is finalised when the process exits: it may have started MPI, and
//! `mpirun` takes a rank that leaves without `MPI_Finalize` for a crash. Objects that outlive that moment
//! (in a static) are left alone.
//!
//! PETSc reads neither the arguments nor `.petscrc`, catches no signals and prints nothing; the
//! environment's `PETSC_OPTIONS` is still obeyed (`-log_view`).

use std::cell::{Cell, RefCell};
use std::ffi::{CStr, c_char, c_int, c_void};
use std::ptr;
use std::sync::{Mutex, MutexGuard, PoisonError};

use petsc_sys as sys;

use crate::solve::SolverFailure;
use crate::solve::confined::is_confined;

/// The right to call PETSc: the process-wide lock, with the library started.
pub(in crate::solve) struct Session {
    _library: MutexGuard<'static, Library>,
}

impl Session {
    /// Waits for the lock; starts PETSc if nobody did.
    ///
    /// # Panics
    /// When this thread has a session open: a `System` must not use a PETSc solver inside its own evaluation.
    pub(in crate::solve) fn open() -> Result<Self, SolverFailure> {
        assert!(!INSIDE.get(), "a PETSc solver was called from within a PETSc solve");
        // A panic cannot leave the library half called: callbacks catch theirs.
        let mut library = LIBRARY.lock().unwrap_or_else(PoisonError::into_inner);
        if matches!(*library, Library::Untouched) {
            *library = match start() {
                Ok(()) => Library::Ready,
                Err(failure) => Library::Broken(failure.message),
            };
        }
        if matches!(*library, Library::Ready) && mpi_is_finalized() {
            *library = Library::Finalized;
        }
        match &*library {
            Library::Ready => {}
            Library::Broken(message) => return Err(failure(message.clone())),
            _ => return Err(failure("called after MPI was finalised".to_owned())),
        }
        INSIDE.set(true);
        Ok(Self { _library: library })
    }
}

impl Session {
    /// The number of this process among those of its job, and how many these are.
    pub(in crate::solve) fn rank(&self) -> (usize, usize) {
        let (mut rank, mut ranks) = (0, 1);
        // SAFETY: the lock is held, and MPI is running.
        unsafe {
            sys::MPI_Comm_rank(sys::petsc_sys_comm_world(), &mut rank);
            sys::MPI_Comm_size(sys::petsc_sys_comm_world(), &mut ranks);
        }
        (count(rank), count(ranks))
    }

    /// Whether any rank says yes.
    pub(in crate::solve) fn any(&self, mine: bool) -> bool {
        // SAFETY: the lock is held, and MPI is running.
        unsafe { sys::petsc_sys_all(sys::petsc_sys_comm_world(), i32::from(!mine)) == 0 }
    }

    /// Whether all ranks have the same `digest`.
    pub(in crate::solve::petsc) fn is_same(&self, digest: u32) -> bool {
        // SAFETY: the lock is held, and MPI is running.
        unsafe { sys::petsc_sys_same(sys::petsc_sys_comm_world(), digest.into()) != 0 }
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        INSIDE.set(false);
    }
}

/// What the process-wide lock guards.
enum Library {
    Untouched,
    Ready,
    Broken(String),
    Finalized,
}

static LIBRARY: Mutex<Library> = Mutex::new(Library::Untouched);

thread_local! {
    /// This thread has a session open.
    static INSIDE: Cell<bool> = const { Cell::new(false) };
    /// What PETSc said about its last error on this thread.
    static SAID: RefCell<String> = const { RefCell::new(String::new()) };
}

fn start() -> Result<(), SolverFailure> {
    if mpi_is_finalized() {
        return Err(failure("MPI was finalised before PETSc was first used".to_owned()));
    }
    let (mut threads, mut started) = (0, sys::PETSC_FALSE);
    // SAFETY: the lock is held. The arguments are leaked, because PETSc keeps their address.
    unsafe {
        check(sys::PetscInitialized(&mut started))?;
        let ours = started == sys::PETSC_FALSE;
        if ours {
            sys::PETSC_MPI_THREAD_REQUIRED = sys::petsc_sys_thread_serialized();
            let words =
                ARGUMENTS.map(|word| word.map_or(ptr::null_mut(), |w| w.as_ptr().cast_mut()));
            let mut length = 3;
            let mut words = Box::leak(Box::new(words)).as_mut_ptr();
            check(sys::PetscInitialize(&mut length, &mut words, ptr::null(), ptr::null()))?;
        }
        check(sys::PetscPushErrorHandler(Some(remember), ptr::null_mut()))?;
        sys::MPI_Query_thread(&mut threads);
        if threads < sys::petsc_sys_thread_serialized() {
            return Err(failure(
                "MPI was initialised below MPI_THREAD_SERIALIZED, which PETSc solvers need"
                    .to_owned(),
            ));
        }
        // More would compete with the candidates evaluated side by side. OpenBLAS reads its environment when
        // it is loaded, before `main`, so it is told here.
        sys::petsc_sys_blas_threads(1);
        if ours {
            atexit(finish);
        }
        let mut ranks = 1;
        sys::MPI_Comm_size(sys::petsc_sys_comm_world(), &mut ranks);
        if ranks > 1 {
            abort_on_panic();
        }
    }
    Ok(())
}

/// Ends all ranks where one panics, unless the panic is confined: the others would wait for it for ever.
fn abort_on_panic() {
    let say = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        say(panic);
        if !is_confined() {
            abort_job();
        }
    }));
}

/// Ends all ranks at once, this one too.
pub(in crate::solve) fn abort_job() {
    // SAFETY: MPI allows this call from any thread while it runs.
    unsafe { sys::MPI_Abort(sys::petsc_sys_comm_world(), 1) };
}

extern "C" fn finish() {
    // A thread still inside PETSc while another one exits: too late for good manners.
    let Ok(mut library) = LIBRARY.try_lock() else { return };
    if matches!(*library, Library::Ready) && !mpi_is_finalized() {
        // SAFETY: the lock is held, the library was started by us, and MPI still runs.
        unsafe { sys::PetscFinalize() };
    }
    *library = Library::Finalized;
}

/// Has the owner of MPI ended it? Nothing of PETSc may be called then, not even to destroy.
fn mpi_is_finalized() -> bool {
    let mut finalized = 0;
    // SAFETY: MPI allows this call at any time.
    unsafe { sys::MPI_Finalized(&mut finalized) };
    finalized != 0
}

unsafe extern "C" {
    safe fn atexit(function: extern "C" fn()) -> c_int;
}

/// PETSc's error handler: keeps the first message and prints nothing.
unsafe extern "C" fn remember(
    _: sys::MPI_Comm,
    _: c_int,
    function: *const c_char,
    _: *const c_char,
    code: sys::PetscErrorCode,
    kind: sys::PetscErrorType,
    message: *const c_char,
    _: *mut c_void,
) -> sys::PetscErrorCode {
    if kind == sys::PETSC_ERROR_INITIAL {
        // SAFETY: PETSc passes C strings or null.
        let [function, message] = unsafe { [text(function), text(message)] };
        // A thread that is being torn down loses the message.
        let _ = SAID.try_with(|said| *said.borrow_mut() = format!("{message} (in {function})"));
    }
    code
}

/// # Safety
/// `string` must be null or a C string.
unsafe fn text(string: *const c_char) -> String {
    if string.is_null() {
        return String::new();
    }
    // SAFETY: as the caller promises.
    unsafe { CStr::from_ptr(string) }.to_string_lossy().into_owned()
}

pub(super) fn check(code: sys::PetscErrorCode) -> Result<(), SolverFailure> {
    if code == 0 {
        return Ok(());
    }
    let said = SAID.try_with(RefCell::take).unwrap_or_default();
    Err(failure(format!("error {code}: {said}")))
}

pub(super) fn failure(message: String) -> SolverFailure {
    SolverFailure { library: "PETSc", message }
}

/// Runs `body` with the lock: the one this thread holds, or a new one. Not at all once PETSc is gone.
pub(super) fn in_session(body: impl FnOnce()) {
    if INSIDE.get() {
        body();
    } else if let Ok(_session) = Session::open() {
        body();
    }
}

pub(super) fn petsc_int(number: usize) -> Result<sys::PetscInt, SolverFailure> {
    number.try_into().map_err(|_| failure(format!("{number} is more than PETSc's integers hold")))
}

pub(super) fn count(number: sys::PetscInt) -> usize {
    number.try_into().expect("PETSc's counts are not negative")
}

/// What PETSc takes for the command line, with C's null at the end.
const ARGUMENTS: [Option<&CStr>; 4] =
    [Some(c"pneumorph"), Some(c"-skip_petscrc"), Some(c"-no_signal_handler"), None];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mpi_lets_threads_take_turns() {
        let _session = Session::open().unwrap();
        let mut level = 0;
        // SAFETY: the session's lock is held, and MPI is running.
        unsafe {
            sys::MPI_Query_thread(&mut level);
            assert!(level >= sys::petsc_sys_thread_serialized());
        }
    }
}
