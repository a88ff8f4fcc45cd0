//! SNES over our callbacks: Newton's method with one direct solve per iteration and our line search.

use std::any::Any;
use std::ffi::c_void;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::ptr;

use petsc_sys as sys;

use super::arrays::{ReadArray, WriteArray};
use super::session::{Session, check, failure, in_session, petsc_int};
use crate::solve::{NewtonEnding, SolverFailure};

/// What SNES asks at each stage of `x <- x - step * correction`, `correction = K(x)^-1 R(x)`.
///
/// `false` ends the solve.
pub(in crate::solve::petsc) trait Newton {
    /// Writes the residual at `x [n]`; `false` where it is not defined.
    fn residual(&mut self, x: &[f64], residual: &mut [f64]) -> bool;

    /// Is a residual of this norm small enough?
    fn converged(&mut self, residual_norm: f64) -> bool;

    /// Makes the tangent at `x [n]`, if it is defined there.
    ///
    /// Where it is not, the correction cannot be done. (SNES has a mark for that case, but 3.18 never takes
    /// it off again: the next solve would end with it.)
    fn tangent(&mut self, x: &[f64]) -> Result<(), SolverFailure>;

    /// Solves with the last tangent; `b [n]` is overwritten by the solution. `false` when it cannot be done.
    fn correction(&mut self, b: &mut [f64]) -> Result<bool, SolverFailure>;

    /// Moves `x [n]` and `residual [n]` along minus the `correction [n]`; `false` when no step is accepted.
    fn step(&mut self, x: &mut [f64], residual: &mut [f64], correction: &[f64]) -> bool;
}

/// SNES with Newton's method, one direct solve per iteration, and our line search.
#[derive(Debug)]
pub(in crate::solve::petsc) struct Driver {
    snes: sys::SNES,
    /// What SNES takes for the tangent: the identity. It asks where a line search failed, for what to call that, and nowhere else.
    tangent: sys::Mat,
    x: sys::Vec,
    residual: sys::Vec,
}

// SAFETY: as for `Factor`.
unsafe impl Send for Driver {}

impl Driver {
    /// A driver for `order` unknowns.
    pub(in crate::solve::petsc) fn new(_: &Session, order: usize) -> Result<Self, SolverFailure> {
        let order = petsc_int(order)?;
        let mut made = Self {
            snes: ptr::null_mut(),
            tangent: ptr::null_mut(),
            x: ptr::null_mut(),
            residual: ptr::null_mut(),
        };
        // SAFETY: the session's lock is held; handles are written before they are read.
        unsafe {
            let this = sys::petsc_sys_comm_self();
            check(sys::VecCreateSeq(this, order, &mut made.x))?;
            check(sys::VecCreateSeq(this, order, &mut made.residual))?;
            check(sys::MatCreateConstantDiagonal(
                this,
                order,
                order,
                order,
                order,
                1.0,
                &mut made.tangent,
            ))?;
            check(sys::SNESCreate(this, &mut made.snes))?;
            check(sys::SNESSetJacobian(
                made.snes,
                made.tangent,
                made.tangent,
                None,
                ptr::null_mut(),
            ))?;
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
    pub(in crate::solve::petsc) fn solve(
        &mut self,
        session: &Session,
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
                ptr::null_mut(),
                ptr::null_mut(),
                Some(on_tangent),
                context,
            ))?;
            check(sys::SNESSetConvergenceTest(self.snes, Some(on_convergence), context, None))?;
            check(sys::petsc_sys_line_search_shell(self.line_search()?, Some(on_step), context))?;
            check(sys::PCShellSetContext(self.pc()?, context))?;
            check(sys::PCSetFailedReason(self.pc()?, sys::PC_NOERROR))?;
            check(sys::SNESSetTolerances(self.snes, 0.0, 0.0, 0.0, limit, many))?;
            let code = sys::SNESSolve(self.snes, ptr::null_mut(), self.x);
            sys::SNESGetConvergedReason(self.snes, &mut reason);
            code
        };
        // A callback's error leaves SNES at once, whatever it was doing: in PETSc 3.22.5 (not in 3.18.5) `x` then
        // stays locked for reading, and no later solve could write it. So nothing of a stopped solve is used again.
        let renewed = match code {
            0 => Ok(()),
            _ => Self::new(session, x.len()).map(|new| *self = new),
        };
        if let Some(payload) = call.panic {
            resume_unwind(payload);
        }
        if let Some(failure) = call.failure {
            return Err(failure);
        }
        check(code)?;
        renewed?;
        x.copy_from_slice(&ReadArray::of(self.x)?);
        match reason {
            sys::SNES_CONVERGED_FNORM_ABS => Ok(NewtonEnding::Converged),
            sys::SNES_DIVERGED_MAX_IT => Ok(NewtonEnding::IterationLimit),
            sys::SNES_DIVERGED_LINEAR_SOLVE => Ok(NewtonEnding::Singular),
            sys::SNES_DIVERGED_LINE_SEARCH | sys::SNES_DIVERGED_LOCAL_MIN => {
                Ok(NewtonEnding::LineSearchFailed)
            }
            sys::SNES_DIVERGED_FUNCTION_DOMAIN | sys::SNES_DIVERGED_FNORM_NAN => {
                Ok(NewtonEnding::Inadmissible)
            }
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
                sys::MatDestroy(&mut self.tangent);
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
    unsafe { guarded(context, |newton| newton.tangent(&ReadArray::of(x)?)) }
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

/// The code that a callback returns to stop SNES: `PETSC_ERR_USER`, of whatever type codes have.
const STOPPED: sys::PetscErrorCode = 83;
