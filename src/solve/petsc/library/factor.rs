//! `L D L^T` of a sparse symmetric matrix by MUMPS, which counts the signs of the pivots.

use std::{ptr, slice};

use petsc_sys as sys;

use super::arrays::{ReadArray, WriteArray};
use super::{Session, check, count, failure, in_session, petsc_int};
use crate::solve::SolverFailure;

/// Numbers of negative and zero pivots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::solve::petsc) struct Inertia {
    pub negative: usize,
    pub zero: usize,
}

/// A symmetric matrix (upper triangle by rows) and its `L D L^T` by MUMPS, analysed once.
#[derive(Debug)]
pub(in crate::solve::petsc) struct Factor {
    matrix: sys::Mat,
    factor: sys::Mat,
    settings: sys::MatFactorInfo,
    right: sys::Vec,
    left: sys::Vec,
    stored: usize,
    /// Room for more than the analysis foresees, %.
    workspace: sys::PetscInt,
}

// SAFETY: the handles have no thread of their own, and every use holds the session's lock.
unsafe impl Send for Factor {}

impl Factor {
    /// Analyses the pattern: entries of row `i` in `columns[starts[i]..starts[i + 1]]`, sorted, diagonal first.
    ///
    /// # Panics
    /// When the pattern is not of that kind: PETSc would store another number of entries.
    pub(in crate::solve::petsc) fn new(
        _: &Session,
        starts: &[usize],
        columns: &[usize],
    ) -> Result<Self, SolverFailure> {
        let order = starts.len() - 1;
        for (row, bounds) in starts.windows(2).enumerate() {
            let columns = &columns[bounds[0]..bounds[1]];
            assert!(columns.first() == Some(&row) && columns.last() < Some(&order), "row {row}");
            assert!(columns.is_sorted_by(|one, next| one < next), "row {row} is not sorted");
        }
        assert!((starts[0], starts[order]) == (0, columns.len()), "entries outside the rows");
        let order = petsc_int(order)?;
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
            workspace: FIRST_WORKSPACE,
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
            check(sys::MatFactorInfoInitialize(&mut made.settings))?;
        }
        made.analyse()?;
        Ok(made)
    }

    /// Factorises the matrix whose entries `fill` writes, in the pattern's order; `None` when MUMPS cannot.
    pub(in crate::solve::petsc) fn factorize(
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
        loop {
            let mut error = sys::MAT_FACTOR_NOERROR;
            // SAFETY: the session's lock is held and the handles live.
            unsafe {
                check(sys::MatCholeskyFactorNumeric(self.factor, self.matrix, &self.settings))?;
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

    /// Solves with the last factor; `b [n]` is overwritten by the solution.
    pub(in crate::solve::petsc) fn solve(
        &self,
        _: &Session,
        b: &mut [f64],
    ) -> Result<(), SolverFailure> {
        WriteArray::of(self.right)?.copy_from_slice(b);
        // SAFETY: the session's lock is held and the handles live.
        check(unsafe { sys::MatSolve(self.factor, self.right, self.left) })?;
        b.copy_from_slice(&ReadArray::of(self.left)?);
        Ok(())
    }

    /// The matrix, for SNES to hold (it does not look inside).
    pub(super) fn matrix(&self) -> sys::Mat {
        self.matrix
    }

    /// Makes a new factor for the matrix' pattern.
    fn analyse(&mut self) -> Result<(), SolverFailure> {
        // SAFETY: the caller holds a session; the handle is null or ours, and written before it is read.
        unsafe {
            check(sys::MatDestroy(&mut self.factor))?;
            check(sys::MatGetFactor(
                self.matrix,
                sys::MATSOLVERMUMPS.as_ptr(),
                sys::MAT_FACTOR_CHOLESKY,
                &mut self.factor,
            ))?;
            check(sys::MatMumpsSetIcntl(self.factor, PERMUTE_BY_VALUES, 0))?;
            check(sys::MatMumpsSetIcntl(self.factor, DETECT_NULL_PIVOTS, 1))?;
            check(sys::MatMumpsSetIcntl(self.factor, WORKSPACE, self.workspace))?;
            check(sys::MatCholeskyFactorSymbolic(
                self.factor,
                self.matrix,
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
        let mut factor = Factor::new(&session, &starts, &columns).unwrap();
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
        let factor = Factor::new(&session, &[0, 1], &[0]).unwrap();
        // SAFETY: the session's lock is held and the handle lives; PETSc refuses a size that contradicts.
        let refused = check(unsafe { sys::MatSetSizes(factor.matrix, 7, 7, 7, 7) });
        let message = refused.unwrap_err().to_string();
        assert!(message.starts_with("PETSc failed: error 56: Cannot change"), "{message}");
        assert!(message.ends_with("(in MatSetSizes)"), "{message}");
    }
}
