//! `L D L^T` of a sparse symmetric matrix by MUMPS, which counts the signs of the pivots.

use std::ptr;

use petsc_sys as sys;

use super::matrix::Matrix;
use super::session::{Session, check, count, failure, in_session};
use crate::solve::SolverFailure;

/// Numbers of negative and zero pivots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::solve::petsc) struct Inertia {
    pub negative: usize,
    pub zero: usize,
}

/// A symmetric matrix and its `L D L^T` by MUMPS, analysed once.
#[derive(Debug)]
pub(in crate::solve::petsc) struct Factor {
    matrix: Matrix,
    factor: sys::Mat,
    settings: sys::MatFactorInfo,
    /// Room for more than the analysis foresees, %.
    workspace: sys::PetscInt,
}

// SAFETY: the handles have no thread of their own, and every use holds the session's lock.
unsafe impl Send for Factor {}

impl Factor {
    /// Analyses the pattern of `matrix`.
    pub(in crate::solve::petsc) fn new(_: &Session, matrix: Matrix) -> Result<Self, SolverFailure> {
        let mut made = Self {
            matrix,
            factor: ptr::null_mut(),
            // SAFETY: plain numbers, for which zero is a value.
            settings: unsafe { std::mem::zeroed() },
            workspace: FIRST_WORKSPACE,
        };
        // SAFETY: the session's lock is held.
        check(unsafe { sys::MatFactorInfoInitialize(&mut made.settings) })?;
        made.analyse()?;
        Ok(made)
    }

    /// Factorises the matrix whose entries `fill` writes, in the pattern's order; `None` when MUMPS cannot.
    pub(in crate::solve::petsc) fn factorize(
        &mut self,
        _: &Session,
        fill: impl FnOnce(&mut [f64]),
    ) -> Result<Option<Inertia>, SolverFailure> {
        self.matrix.update(fill)?;
        loop {
            let mut error = sys::MAT_FACTOR_NOERROR;
            // SAFETY: the session's lock is held and the handles live.
            unsafe {
                check(sys::MatCholeskyFactorNumeric(
                    self.factor,
                    self.matrix.handle,
                    &self.settings,
                ))?;
                check(sys::MatFactorGetError(self.factor, &mut error))?;
            }
            if error == sys::MAT_FACTOR_NOERROR {
                return self.inertia().map(Some);
            }
            // A factor that failed is useless: PETSc would skip the next factorisation, and answer for the last.
            if error == sys::MAT_FACTOR_OUTMEMORY {
                self.workspace *= 2;
            }
            self.analyse()?;
            match error {
                sys::MAT_FACTOR_OUTMEMORY if self.workspace <= LARGEST_WORKSPACE => {}
                sys::MAT_FACTOR_NUMERIC_ZEROPIVOT => return Ok(None),
                _ => {
                    return Err(failure(format!(
                        "MUMPS failed to factorise, by PETSc's code {error}"
                    )));
                }
            }
        }
    }

    /// Solves with the last factor; `b`, of the own rows, is overwritten by the solution.
    pub(in crate::solve::petsc) fn solve(
        &self,
        _: &Session,
        b: &mut [f64],
    ) -> Result<(), SolverFailure> {
        self.matrix.through_vectors(b, |right, left| {
            // SAFETY: the session's lock is held and the handles live.
            check(unsafe { sys::MatSolve(self.factor, right, left) })
        })
    }

    /// Makes a new factor for the matrix' pattern.
    fn analyse(&mut self) -> Result<(), SolverFailure> {
        // SAFETY: the caller holds a session; the handle is null or ours, and written before it is read.
        unsafe {
            check(sys::MatDestroy(&mut self.factor))?;
            check(sys::MatGetFactor(
                self.matrix.handle,
                sys::MATSOLVERMUMPS.as_ptr(),
                sys::MAT_FACTOR_CHOLESKY,
                &mut self.factor,
            ))?;
            check(sys::MatMumpsSetIcntl(self.factor, PERMUTE_BY_VALUES, 0))?;
            check(sys::MatMumpsSetIcntl(self.factor, DETECT_NULL_PIVOTS, 1))?;
            check(sys::MatMumpsSetIcntl(self.factor, WORKSPACE, self.workspace))?;
            check(sys::MatCholeskyFactorSymbolic(
                self.factor,
                self.matrix.handle,
                ptr::null_mut(),
                &self.settings,
            ))
        }
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
            // SAFETY: the session's lock is held; the handle is null or ours and is destroyed once.
            unsafe { sys::MatDestroy(&mut self.factor) };
        });
    }
}

/// MUMPS' ICNTL(6), which would also scale for good by the values present at the analysis: there are none yet.
///
/// Without it each factorisation scales by its own values, at 3 % of its time (10,800 unknowns).
const PERMUTE_BY_VALUES: sys::PetscInt = 6;
/// MUMPS' ICNTL(24): without it zero pivots are divided by, and not counted.
const DETECT_NULL_PIVOTS: sys::PetscInt = 24;
/// MUMPS' ICNTL(14): pivots that must wait in an indefinite matrix need more room than its analysis foresees.
const WORKSPACE: sys::PetscInt = 14;
/// MUMPS' default, %.
const FIRST_WORKSPACE: sys::PetscInt = 20;
const LARGEST_WORKSPACE: sys::PetscInt = 32 * FIRST_WORKSPACE;

#[cfg(test)]
mod tests {
    use std::ffi::CStr;

    use super::*;

    fn analysed(session: &Session, starts: &[usize], columns: &[usize]) -> Factor {
        Factor::new(session, Matrix::alone(session, starts, columns).unwrap()).unwrap()
    }

    /// The matrix `diag(values)`.
    fn diagonal(session: &Session, values: &[f64]) -> (Factor, Option<Inertia>) {
        let starts: Vec<usize> = (0..=values.len()).collect();
        let mut factor = analysed(session, &starts, &starts[..values.len()]);
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
    fn pivots_put_off_get_more_workspace() {
        // [D B; B^T 0] with D too small to pivot on: every pivot waits until its block row is eliminated,
        // more than the analysis of the pattern foresees. With B regular, half of the pivots are negative.
        let session = Session::open().unwrap();
        let half = 400;
        let (mut starts, mut columns, mut values) = (vec![0], Vec::new(), Vec::new());
        for row in 0..2 * half {
            columns.push(row);
            values.push(if row < half { 1e-9 } else { 0.0 });
            if row < half {
                let mut linked: Vec<_> =
                    [0, 1, 7, 31, 150].map(|step| half + (row * 7 + step * step) % half).into();
                linked.sort_unstable();
                linked.dedup();
                for column in linked {
                    columns.push(column);
                    values.push(if column == half + (row * 7) % half { 9.0 } else { 1.0 });
                }
            }
            starts.push(columns.len());
        }
        let mut factor = analysed(&session, &starts, &columns);
        for _ in 0..2 {
            let inertia = factor.factorize(&session, |entries| entries.copy_from_slice(&values));
            assert_eq!(inertia.unwrap(), Some(Inertia { negative: half, zero: 0 }));
        }
        assert!(factor.workspace > FIRST_WORKSPACE, "no pivot waited: the test tests nothing");
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
        let factor = analysed(&session, &[0, 1], &[0]);
        // SAFETY: the session's lock is held and the handle lives; PETSc refuses a size that contradicts.
        let refused = check(unsafe { sys::MatSetSizes(factor.matrix.handle, 7, 7, 7, 7) });
        let message = refused.unwrap_err().to_string();
        assert!(message.starts_with("PETSc failed: error 56: Cannot change"), "{message}");
        assert!(message.ends_with("(in MatSetSizes)"), "{message}");
    }
}
