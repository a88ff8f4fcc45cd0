//! The only file that calls PETSc: a factorisation of our symmetric matrix, and SNES over our callbacks.
//!
//! It wraps what [`super::Snes`] needs, not PETSc. No type of PETSc leaves this file.
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

#![expect(unsafe_code, reason = "the one boundary with PETSc")]

use std::any::Any;
use std::cell::{Cell, RefCell};
use std::ffi::{CStr, c_char, c_int, c_void};
use std::ops::{Deref, DerefMut};
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::{ptr, slice};

use petsc_sys as sys;

use crate::solve::{NewtonEnding, SolverFailure};

/// The right to call PETSc: the process-wide lock, with the library started.
pub(super) struct Session {
    _library: MutexGuard<'static, Library>,
}

impl Session {
    /// Waits for the lock; starts PETSc if nobody did.
    ///
    /// # Panics
    /// When this thread has a session open: a `System` must not use a PETSc solver inside its own evaluation.
    pub(super) fn open() -> Result<Self, SolverFailure> {
        assert!(!INSIDE.get(), "a PETSc solver was called from within a PETSc solve");
        // A panic cannot leave the library half called: callbacks catch theirs.
        let mut library = LIBRARY.lock().unwrap_or_else(PoisonError::into_inner);
        if matches!(*library, Library::Untouched) {
            *library = match start() {
                Ok(()) => Library::Ready,
                Err(failure) => Library::Broken(failure.message),
            };
        }
        match &*library {
            Library::Ready => {}
            Library::Broken(message) => return Err(failure(message.clone())),
            _ => return Err(failure("called while the process exits".to_owned())),
        }
        INSIDE.set(true);
        Ok(Self { _library: library })
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        INSIDE.set(false);
    }
}

/// Numbers of negative and zero pivots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Inertia {
    pub negative: usize,
    pub zero: usize,
}

/// A symmetric matrix (upper triangle by rows) and its `L D L^T` by MUMPS, analysed once.
#[derive(Debug)]
pub(super) struct Factor {
    matrix: sys::Mat,
    factor: sys::Mat,
    settings: sys::MatFactorInfo,
    right: sys::Vec,
    left: sys::Vec,
    stored: usize,
}

// SAFETY: the handles have no thread of their own, and every use holds the session's lock.
unsafe impl Send for Factor {}

impl Factor {
    /// Analyses the pattern: entries of row `i` in `columns[starts[i]..starts[i + 1]]`, sorted, diagonal first.
    pub(super) fn new(
        _: &Session,
        starts: &[usize],
        columns: &[usize],
    ) -> Result<Self, SolverFailure> {
        let order = petsc_int(starts.len() - 1)?;
        let starts = starts.iter().copied().map(petsc_int).collect::<Result<Vec<_>, _>>()?;
        let columns = columns.iter().copied().map(petsc_int).collect::<Result<Vec<_>, _>>()?;
        let mut made = Self {
            matrix: ptr::null_mut(),
            factor: ptr::null_mut(),
            // SAFETY: plain numbers, for which zero is a value.
            settings: unsafe { std::mem::zeroed() },
            right: ptr::null_mut(),
            left: ptr::null_mut(),
            stored: columns.len(),
        };
        // SAFETY: the session's lock is held; the arrays are a valid pattern and are copied; handles are
        // written before they are read.
        unsafe {
            let this = sys::petsc_sys_comm_self();
            check(sys::MatCreate(this, &mut made.matrix))?;
            check(sys::MatSetSizes(made.matrix, order, order, order, order))?;
            check(sys::MatSetType(made.matrix, sys::MATSEQSBAIJ.as_ptr()))?;
            check(sys::MatSeqSBAIJSetPreallocationCSR(
                made.matrix,
                1,
                starts.as_ptr(),
                columns.as_ptr(),
                ptr::null(),
            ))?;
            check(sys::VecCreateSeq(this, order, &mut made.right))?;
            check(sys::VecCreateSeq(this, order, &mut made.left))?;
            check(sys::MatGetFactor(
                made.matrix,
                sys::MATSOLVERMUMPS.as_ptr(),
                sys::MAT_FACTOR_CHOLESKY,
                &mut made.factor,
            ))?;
            check(sys::MatMumpsSetIcntl(made.factor, DETECT_NULL_PIVOTS, 1))?;
            check(sys::MatFactorInfoInitialize(&mut made.settings))?;
            check(sys::MatCholeskyFactorSymbolic(
                made.factor,
                made.matrix,
                ptr::null_mut(),
                &made.settings,
            ))?;
        }
        Ok(made)
    }

    /// Factorises the matrix whose entries `fill` writes, in the pattern's order; `None` when MUMPS cannot.
    pub(super) fn factorize(
        &mut self,
        _: &Session,
        fill: impl FnOnce(&mut [f64]),
    ) -> Result<Option<Inertia>, SolverFailure> {
        let mut values = ptr::null_mut();
        // SAFETY: the session's lock is held and the handles live; the matrix has `stored` entries, which
        // nobody else reads while they are written.
        unsafe {
            check(sys::MatSeqSBAIJGetArray(self.matrix, &mut values))?;
            fill(slice::from_raw_parts_mut(values, self.stored));
            check(sys::MatSeqSBAIJRestoreArray(self.matrix, &mut values))?;
            // Tells PETSc that the values are new.
            check(sys::MatAssemblyBegin(self.matrix, sys::MAT_FINAL_ASSEMBLY))?;
            check(sys::MatAssemblyEnd(self.matrix, sys::MAT_FINAL_ASSEMBLY))?;
        }
        for relaxation in WORKSPACE_RELAXATIONS {
            let mut error = sys::MAT_FACTOR_NOERROR;
            // SAFETY: the session's lock is held and the handles live.
            unsafe {
                check(sys::MatMumpsSetIcntl(self.factor, WORKSPACE_RELAXATION, relaxation))?;
                check(sys::MatFactorClearError(self.factor))?;
                check(sys::MatCholeskyFactorNumeric(self.factor, self.matrix, &self.settings))?;
                check(sys::MatFactorGetError(self.factor, &mut error))?;
            }
            match error {
                sys::MAT_FACTOR_NOERROR => return self.inertia().map(Some),
                sys::MAT_FACTOR_OUTMEMORY => {}
                sys::MAT_FACTOR_NUMERIC_ZEROPIVOT | sys::MAT_FACTOR_STRUCT_ZEROPIVOT => {
                    return Ok(None);
                }
                other => return Err(failure(format!("factorisation error {other} in MUMPS"))),
            }
        }
        Err(failure("MUMPS is out of memory".to_owned()))
    }

    /// Solves with the last factor; `b [n]` is overwritten by the solution.
    pub(super) fn solve(&self, _: &Session, b: &mut [f64]) -> Result<(), SolverFailure> {
        WriteArray::of(self.right)?.copy_from_slice(b);
        // SAFETY: the session's lock is held and the handles live.
        check(unsafe { sys::MatSolve(self.factor, self.right, self.left) })?;
        b.copy_from_slice(&ReadArray::of(self.left)?);
        Ok(())
    }

    fn inertia(&self) -> Result<Inertia, SolverFailure> {
        let (mut negative, mut zero, mut positive) = (0, 0, 0);
        // SAFETY: the factor is numeric and belongs to MUMPS, which counts its pivots.
        check(unsafe { sys::MatGetInertia(self.factor, &mut negative, &mut zero, &mut positive) })?;
        Ok(Inertia { negative: count(negative), zero: count(zero) })
    }
}

impl Drop for Factor {
    fn drop(&mut self) {
        in_session(|| {
            // SAFETY: the session's lock is held; each handle is null or ours and is destroyed once.
            unsafe {
                sys::MatDestroy(&mut self.factor);
                sys::MatDestroy(&mut self.matrix);
                sys::VecDestroy(&mut self.right);
                sys::VecDestroy(&mut self.left);
            }
        });
    }
}

/// What SNES asks at each stage of `x <- x - step * correction`, `correction = K(x)^-1 R(x)`.
///
/// `false` ends the solve.
pub(super) trait Newton {
    /// Writes the residual at `x [n]`; `false` where it is not defined.
    fn residual(&mut self, x: &[f64], residual: &mut [f64]) -> bool;

    /// Is a residual of this norm small enough?
    fn converged(&mut self, residual_norm: f64) -> bool;

    /// Makes the tangent at `x [n]`, if it is defined there.
    ///
    /// Where it is not, the correction cannot be done. (SNES has a mark for that case, but 3.18 never takes
    /// it off again: the next solve would end with it.)
    fn tangent(&mut self, x: &[f64]);

    /// Solves with the last tangent; `b [n]` is overwritten by the solution. `false` when it cannot be done.
    fn correction(&mut self, b: &mut [f64]) -> Result<bool, SolverFailure>;

    /// Moves `x [n]` and `residual [n]` along minus the `correction [n]`; `false` when no step is accepted.
    fn step(&mut self, x: &mut [f64], residual: &mut [f64], correction: &[f64]) -> bool;
}

/// SNES with Newton's method, one direct solve per iteration, and our line search.
#[derive(Debug)]
pub(super) struct Driver {
    snes: sys::SNES,
    x: sys::Vec,
    residual: sys::Vec,
    matrix: sys::Mat,
}

// SAFETY: as for `Factor`.
unsafe impl Send for Driver {}

impl Driver {
    /// A driver for `order` unknowns; SNES sees the tangent as the matrix of `factor`.
    pub(super) fn new(_: &Session, factor: &Factor, order: usize) -> Result<Self, SolverFailure> {
        let order = petsc_int(order)?;
        let mut made = Self {
            snes: ptr::null_mut(),
            x: ptr::null_mut(),
            residual: ptr::null_mut(),
            matrix: factor.matrix,
        };
        // SAFETY: the session's lock is held; handles are written before they are read.
        unsafe {
            let this = sys::petsc_sys_comm_self();
            check(sys::VecCreateSeq(this, order, &mut made.x))?;
            check(sys::VecCreateSeq(this, order, &mut made.residual))?;
            check(sys::SNESCreate(this, &mut made.snes))?;
            check(sys::SNESSetType(made.snes, sys::SNESNEWTONLS.as_ptr()))?;
            check(sys::KSPSetType(made.ksp()?, sys::KSPPREONLY.as_ptr()))?;
            check(sys::PCSetType(made.pc()?, sys::PCSHELL.as_ptr()))?;
            check(sys::PCShellSetApply(made.pc()?, Some(on_correction)))?;
            check(sys::SNESLineSearchSetType(
                made.line_search()?,
                sys::SNESLINESEARCHSHELL.as_ptr(),
            ))?;
        }
        Ok(made)
    }

    /// Runs Newton's method from `x [n]`, which receives the last iterate.
    ///
    /// # Panics
    /// When `newton` did: its panic is carried through PETSc and goes on here.
    pub(super) fn solve(
        &mut self,
        _: &Session,
        newton: &mut dyn Newton,
        x: &mut [f64],
        max_iterations: usize,
    ) -> Result<NewtonEnding, SolverFailure> {
        let mut call = Call { newton, panic: None, failure: None };
        let context: *mut c_void = (&raw mut call).cast();
        let limit = sys::PetscInt::try_from(max_iterations).unwrap_or(sys::PetscInt::MAX);
        let many = sys::PetscInt::MAX;
        WriteArray::of(self.x)?.copy_from_slice(x);
        let mut reason = sys::SNES_CONVERGED_ITERATING;
        // SAFETY: the session's lock is held and the handles live. `call` outlives the solve, and only the
        // callbacks use it meanwhile, one at a time; the stale context left behind is replaced by the next
        // solve before it could be used.
        let code = unsafe {
            check(sys::SNESSetFunction(self.snes, self.residual, Some(on_residual), context))?;
            check(sys::SNESSetJacobian(
                self.snes,
                self.matrix,
                self.matrix,
                Some(on_tangent),
                context,
            ))?;
            check(sys::SNESSetConvergenceTest(self.snes, Some(on_convergence), context, None))?;
            check(sys::petsc_sys_line_search_shell(self.line_search()?, Some(on_step), context))?;
            check(sys::PCShellSetContext(self.pc()?, context))?;
            check(sys::PCSetFailedReason(self.pc()?, sys::PC_NOERROR))?;
            check(sys::SNESSetTolerances(self.snes, 0.0, 0.0, 0.0, limit, many))?;
            let code = sys::SNESSolve(self.snes, ptr::null_mut(), self.x);
            check(sys::SNESGetConvergedReason(self.snes, &mut reason))?;
            code
        };
        if let Some(payload) = call.panic {
            resume_unwind(payload);
        }
        if let Some(failure) = call.failure {
            return Err(failure);
        }
        check(code)?;
        x.copy_from_slice(&ReadArray::of(self.x)?);
        match reason {
            sys::SNES_CONVERGED_FNORM_ABS => Ok(NewtonEnding::Converged),
            sys::SNES_DIVERGED_MAX_IT => Ok(NewtonEnding::IterationLimit),
            sys::SNES_DIVERGED_LINEAR_SOLVE => Ok(NewtonEnding::Singular),
            sys::SNES_DIVERGED_LINE_SEARCH | sys::SNES_DIVERGED_LOCAL_MIN => {
                Ok(NewtonEnding::LineSearchFailed)
            }
            sys::SNES_DIVERGED_FUNCTION_DOMAIN => Ok(NewtonEnding::Inadmissible),
            other => Err(failure(format!("SNES ended with the unexpected reason {other}"))),
        }
    }

    fn ksp(&self) -> Result<sys::KSP, SolverFailure> {
        let mut ksp = ptr::null_mut();
        // SAFETY: the caller holds a session; the handle lives, and keeps the one that it returns.
        check(unsafe { sys::SNESGetKSP(self.snes, &mut ksp) })?;
        Ok(ksp)
    }

    fn pc(&self) -> Result<sys::PC, SolverFailure> {
        let mut pc = ptr::null_mut();
        // SAFETY: as in `ksp`.
        check(unsafe { sys::KSPGetPC(self.ksp()?, &mut pc) })?;
        Ok(pc)
    }

    fn line_search(&self) -> Result<sys::SNESLineSearch, SolverFailure> {
        let mut search = ptr::null_mut();
        // SAFETY: as in `ksp`.
        check(unsafe { sys::SNESGetLineSearch(self.snes, &mut search) })?;
        Ok(search)
    }
}

impl Drop for Driver {
    fn drop(&mut self) {
        in_session(|| {
            // SAFETY: the session's lock is held; each handle is null or ours and is destroyed once.
            unsafe {
                sys::SNESDestroy(&mut self.snes);
                sys::VecDestroy(&mut self.x);
                sys::VecDestroy(&mut self.residual);
            }
        });
    }
}

/// One solve, as the callbacks see it.
struct Call<'a> {
    newton: &'a mut dyn Newton,
    panic: Option<Box<dyn Any + Send>>,
    failure: Option<SolverFailure>,
}

unsafe extern "C" fn on_residual(
    snes: sys::SNES,
    x: sys::Vec,
    residual: sys::Vec,
    context: *mut c_void,
) -> sys::PetscErrorCode {
    // SAFETY: `context` is the running solve's.
    unsafe {
        guarded(context, |newton| {
            if !newton.residual(&ReadArray::of(x)?, &mut WriteArray::of(residual)?) {
                check(sys::SNESSetFunctionDomainError(snes))?;
            }
            Ok(())
        })
    }
}

unsafe extern "C" fn on_tangent(
    _: sys::SNES,
    x: sys::Vec,
    _: sys::Mat,
    _: sys::Mat,
    context: *mut c_void,
) -> sys::PetscErrorCode {
    // SAFETY: `context` is the running solve's.
    unsafe {
        guarded(context, |newton| {
            newton.tangent(&ReadArray::of(x)?);
            Ok(())
        })
    }
}

unsafe extern "C" fn on_correction(pc: sys::PC, b: sys::Vec, y: sys::Vec) -> sys::PetscErrorCode {
    let mut context: *mut c_void = ptr::null_mut();
    // SAFETY: the shell's context is the running solve's; `b` and `y` are different vectors.
    unsafe {
        let code = sys::PCShellGetContext(pc, (&raw mut context).cast());
        if code != 0 {
            return code;
        }
        guarded(context, |newton| {
            let mut y = WriteArray::of(y)?;
            y.copy_from_slice(&ReadArray::of(b)?);
            if !newton.correction(&mut y)? {
                check(sys::PCSetFailedReason(pc, sys::PC_FACTOR_OTHER))?;
            }
            Ok(())
        })
    }
}

unsafe extern "C" fn on_step(
    search: sys::SNESLineSearch,
    context: *mut c_void,
) -> sys::PetscErrorCode {
    // SAFETY: `context` is the running solve's; the search's five vectors are different ones.
    unsafe {
        guarded(context, |newton| {
            let [mut x, mut residual, mut correction, mut spare, mut other] = [ptr::null_mut(); 5];
            check(sys::SNESLineSearchGetVecs(
                search,
                &mut x,
                &mut residual,
                &mut correction,
                &mut spare,
                &mut other,
            ))?;
            let stepped = newton.step(
                &mut WriteArray::of(x)?,
                &mut WriteArray::of(residual)?,
                &ReadArray::of(correction)?,
            );
            let reason = if stepped {
                check(sys::SNESLineSearchComputeNorms(search))?;
                sys::SNES_LINESEARCH_SUCCEEDED
            } else {
                sys::SNES_LINESEARCH_FAILED_REDUCT
            };
            check(sys::SNESLineSearchSetReason(search, reason))
        })
    }
}

unsafe extern "C" fn on_convergence(
    _: sys::SNES,
    _: sys::PetscInt,
    _: sys::PetscReal,
    _: sys::PetscReal,
    residual_norm: sys::PetscReal,
    reason: *mut sys::SNESConvergedReason,
    context: *mut c_void,
) -> sys::PetscErrorCode {
    // SAFETY: `context` is the running solve's; `reason` is SNES' place for the answer.
    unsafe {
        guarded(context, |newton| {
            *reason = if newton.converged(residual_norm) {
                sys::SNES_CONVERGED_FNORM_ABS
            } else {
                sys::SNES_CONVERGED_ITERATING
            };
            Ok(())
        })
    }
}

/// Runs a callback's `body`; a panic or failure is kept for [`Driver::solve`] and ends SNES by an error code.
///
/// # Safety
/// `context` must be the address of the running solve's [`Call`].
unsafe fn guarded(
    context: *mut c_void,
    body: impl FnOnce(&mut dyn Newton) -> Result<(), SolverFailure>,
) -> sys::PetscErrorCode {
    // SAFETY: as the caller promises; callbacks do not nest, so this is the only reference.
    let call = unsafe { &mut *context.cast::<Call<'_>>() };
    match catch_unwind(AssertUnwindSafe(|| body(&mut *call.newton))) {
        Ok(Ok(())) => 0,
        Ok(Err(failure)) => {
            call.failure = Some(failure);
            STOPPED
        }
        Err(payload) => {
            call.panic = Some(payload);
            STOPPED
        }
    }
}

/// The entries of a vector, to read.
struct ReadArray {
    vector: sys::Vec,
    start: *const f64,
    length: usize,
}

impl ReadArray {
    /// `vector` must be alive and a session open.
    fn of(vector: sys::Vec) -> Result<Self, SolverFailure> {
        let (mut start, mut length) = (ptr::null(), 0);
        // SAFETY: this file passes live vectors under the session's lock.
        unsafe {
            check(sys::VecGetSize(vector, &mut length))?;
            check(sys::VecGetArrayRead(vector, &mut start))?;
        }
        Ok(Self { vector, start, length: count(length) })
    }
}

impl Deref for ReadArray {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        // SAFETY: the vector holds `length` numbers at `start` until it is restored.
        unsafe { slice::from_raw_parts(self.start, self.length) }
    }
}

impl Drop for ReadArray {
    fn drop(&mut self) {
        // SAFETY: gives back what `of` took.
        unsafe { sys::VecRestoreArrayRead(self.vector, &mut self.start) };
    }
}

/// The entries of a vector, to write.
struct WriteArray {
    vector: sys::Vec,
    start: *mut f64,
    length: usize,
}

impl WriteArray {
    /// `vector` must be alive, a session open, and no other array of it in use.
    fn of(vector: sys::Vec) -> Result<Self, SolverFailure> {
        let (mut start, mut length) = (ptr::null_mut(), 0);
        // SAFETY: as in `ReadArray::of`.
        unsafe {
            check(sys::VecGetSize(vector, &mut length))?;
            check(sys::VecGetArray(vector, &mut start))?;
        }
        Ok(Self { vector, start, length: count(length) })
    }
}

impl Deref for WriteArray {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        // SAFETY: as in `ReadArray::deref`.
        unsafe { slice::from_raw_parts(self.start, self.length) }
    }
}

impl DerefMut for WriteArray {
    fn deref_mut(&mut self) -> &mut [f64] {
        // SAFETY: as in `ReadArray::deref`, and the exclusive borrow is ours.
        unsafe { slice::from_raw_parts_mut(self.start, self.length) }
    }
}

impl Drop for WriteArray {
    fn drop(&mut self) {
        // SAFETY: gives back what `of` took.
        unsafe { sys::VecRestoreArray(self.vector, &mut self.start) };
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
    let (mut finalized, mut threads, mut ours) = (0, 0, sys::PETSC_FALSE);
    // SAFETY: the lock is held. The arguments are leaked, because PETSc keeps their address.
    unsafe {
        sys::MPI_Finalized(&mut finalized);
        if finalized != 0 {
            return Err(failure("MPI was finalised before PETSc was first used".to_owned()));
        }
        check(sys::PetscInitialized(&mut ours))?;
        let started = ours == sys::PETSC_TRUE;
        if !started {
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
        if !started {
            atexit(finish);
        }
    }
    Ok(())
}

extern "C" fn finish() {
    // A thread still inside PETSc while another one exits: too late for good manners.
    let Ok(mut library) = LIBRARY.try_lock() else { return };
    if matches!(*library, Library::Ready) {
        let mut finalized = 0;
        // SAFETY: the lock is held and the library was started by us; MPI may have been ended by its owner.
        unsafe {
            sys::MPI_Finalized(&mut finalized);
            if finalized == 0 {
                sys::PetscFinalize();
            }
        }
    }
    *library = Library::Finalized;
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

fn check(code: sys::PetscErrorCode) -> Result<(), SolverFailure> {
    if code == 0 {
        return Ok(());
    }
    let said = SAID.try_with(RefCell::take).unwrap_or_default();
    Err(failure(format!("error {code}: {said}")))
}

fn failure(message: String) -> SolverFailure {
    SolverFailure { library: "PETSc", message }
}

/// Runs `body` with the lock: the one this thread holds, or a new one. Not at all once PETSc is gone.
fn in_session(body: impl FnOnce()) {
    if INSIDE.get() {
        body();
    } else if let Ok(_session) = Session::open() {
        body();
    }
}

fn petsc_int(number: usize) -> Result<sys::PetscInt, SolverFailure> {
    number.try_into().map_err(|_| failure(format!("{number} is more than PETSc's integers hold")))
}

fn count(number: sys::PetscInt) -> usize {
    number.try_into().expect("PETSc's counts are not negative")
}

/// The code that a callback returns to stop SNES: `PETSC_ERR_USER`, of whatever type codes have.
const STOPPED: sys::PetscErrorCode = 83;
/// What PETSc takes for the command line, with C's null at the end.
const ARGUMENTS: [Option<&CStr>; 4] =
    [Some(c"pneumorph"), Some(c"-skip_petscrc"), Some(c"-no_signal_handler"), None];

/// MUMPS' ICNTL(24): without it zero pivots are divided by, and not counted.
const DETECT_NULL_PIVOTS: sys::PetscInt = 24;
/// MUMPS' ICNTL(14): workspace in addition to the analysis' estimate, %; an indefinite matrix may need more.
const WORKSPACE_RELAXATION: sys::PetscInt = 14;
/// MUMPS' default, then more.
const WORKSPACE_RELAXATIONS: [sys::PetscInt; 4] = [20, 50, 100, 400];

#[cfg(test)]
mod tests {
    use super::*;

    /// The matrix `diag(values)`.
    fn diagonal(session: &Session, values: &[f64]) -> (Factor, Option<Inertia>) {
        let starts: Vec<usize> = (0..=values.len()).collect();
        let mut factor = Factor::new(session, &starts, &starts[..values.len()]).unwrap();
        let inertia = factor.factorize(session, |entries| entries.copy_from_slice(values));
        (factor, inertia.unwrap())
    }

    #[test]
    fn signs_of_a_diagonal_are_counted() {
        let session = Session::open().unwrap();
        let (_factor, inertia) = diagonal(&session, &[3.0, -1.0, 0.0, 2.0, -5.0, 0.0]);
        assert_eq!(inertia, Some(Inertia { negative: 2, zero: 2 }));
        let (_factor, inertia) = diagonal(&session, &[0.0]);
        assert_eq!(inertia, Some(Inertia { negative: 0, zero: 1 }));
    }

    #[test]
    fn new_values_need_no_new_analysis() {
        // Other threads wait for the session, so PETSc's own counts are of this test only.
        let session = Session::open().unwrap();
        let events = |name: &CStr| {
            let mut event = 0;
            // SAFETY: the session's lock is held; a performance record is plain numbers.
            unsafe {
                let mut record: sys::PetscEventPerfInfo = std::mem::zeroed();
                check(sys::PetscLogEventGetId(name.as_ptr(), &mut event)).unwrap();
                check(sys::PetscLogEventGetPerfInfo(0, event, &mut record)).unwrap();
                record.count
            }
        };
        // SAFETY: the session's lock is held.
        check(unsafe { sys::PetscLogDefaultBegin() }).unwrap();
        let (mut factor, _) = diagonal(&session, &[1.0, 2.0]);
        let [analyses, factorizations] = [c"MatCholFctrSym", c"MatCholFctrNum"].map(events);
        assert!(analyses > 0);
        for value in [3.0, 4.0, 5.0] {
            factor.factorize(&session, |entries| entries.fill(value)).unwrap();
            let mut b = [value, 2.0 * value];
            factor.solve(&session, &mut b).unwrap();
            // Two roundings: MUMPS scales.
            assert!((b[0] - 1.0).abs() < 1e-15 && (b[1] - 2.0).abs() < 1e-15, "{b:?}");
        }
        assert_eq!(events(c"MatCholFctrSym"), analyses);
        assert_eq!(events(c"MatCholFctrNum"), factorizations + 3);
    }

    #[test]
    fn failure_repeats_what_petsc_said() {
        let session = Session::open().unwrap();
        let factor = Factor::new(&session, &[0, 1], &[0]).unwrap();
        // SAFETY: the session's lock is held and the handle lives; PETSc refuses a size that contradicts.
        let refused = check(unsafe { sys::MatSetSizes(factor.matrix, 7, 7, 7, 7) });
        let message = refused.unwrap_err().to_string();
        assert!(message.starts_with("PETSc failed: error 56: Cannot change"), "{message}");
        assert!(message.ends_with("(in MatSetSizes)"), "{message}");
    }

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
