//! A symmetric matrix of PETSc, whole on this process or spread by rows over all ranks.

use std::{ptr, slice};

use petsc_sys as sys;

use super::arrays::{ReadArray, WriteArray};
use super::session::{Session, check, in_session, petsc_int};
use crate::solve::SolverFailure;

/// A symmetric matrix, and a vector for each side of it.
#[derive(Debug)]
pub(in crate::solve::petsc) struct Matrix {
    pub(super) handle: sys::Mat,
    pub(super) right: sys::Vec,
    pub(super) left: sys::Vec,
    storage: Storage,
}

#[derive(Debug)]
enum Storage {
    /// The upper triangle by rows, so many entries.
    Alone(usize),
    /// This rank's rows, whose entries are handed over.
    Spread(Vec<f64>),
}

// SAFETY: the handles have no thread of their own, and every use holds the session's lock.
unsafe impl Send for Matrix {}

impl Matrix {
    /// On this process: the upper triangle, entries of row `i` in `columns[starts[i]..starts[i + 1]]`, sorted, diagonal first.
    ///
    /// # Panics
    /// When the pattern is not of that kind: PETSc would store another number of entries.
    pub(in crate::solve::petsc) fn alone(
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
        let mut made = Self::without_handles(Storage::Alone(columns.len()));
        // SAFETY: the session's lock is held; the arrays are a valid pattern and are copied; handles are
        // written before they are read.
        unsafe {
            let this = sys::petsc_sys_comm_self();
            check(sys::MatCreate(this, &mut made.handle))?;
            check(sys::MatSetSizes(made.handle, order, order, order, order))?;
            check(sys::MatSetType(made.handle, sys::MATSEQSBAIJ.as_ptr()))?;
            check(sys::MatSeqSBAIJSetPreallocationCSR(
                made.handle,
                1,
                starts.as_ptr(),
                columns.as_ptr(),
                ptr::null(),
            ))?;
            check(sys::VecCreateSeq(this, order, &mut made.right))?;
            check(sys::VecCreateSeq(this, order, &mut made.left))?;
        }
        Ok(made)
    }

    /// Over all ranks, of `order` rows: this rank's rows whole, row `i` in `columns[starts[i]..starts[i + 1]]`, sorted.
    pub(in crate::solve::petsc) fn spread(
        _: &Session,
        order: usize,
        starts: &[usize],
        columns: &[u32],
    ) -> Result<Self, SolverFailure> {
        let (own, order) = (petsc_int(starts.len() - 1)?, petsc_int(order)?);
        assert!(starts.last() == Some(&columns.len()), "entries outside the rows");
        assert!(columns.iter().all(|&column| i64::from(column) < i64::from(order)), "a column");
        let mut made = Self::without_handles(Storage::Spread(vec![0.0; columns.len()]));
        let starts = starts.iter().copied().map(petsc_int).collect::<Result<Vec<_>, _>>()?;
        // SAFETY: as in `alone`; a column is below `order`, so it has the same bits with a sign.
        unsafe {
            let world = sys::petsc_sys_comm_world();
            check(sys::MatCreate(world, &mut made.handle))?;
            check(sys::MatSetSizes(made.handle, own, own, order, order))?;
            check(sys::MatSetType(made.handle, sys::MATMPIAIJ.as_ptr()))?;
            check(sys::MatMPIAIJSetPreallocationCSR(
                made.handle,
                starts.as_ptr(),
                columns.as_ptr().cast(),
                ptr::null(),
            ))?;
            check(sys::MatSetOption(made.handle, sys::MAT_SYMMETRIC, sys::PETSC_TRUE))?;
            check(sys::MatSetOption(made.handle, sys::MAT_SYMMETRY_ETERNAL, sys::PETSC_TRUE))?;
            check(sys::VecCreateMPI(world, own, order, &mut made.right))?;
            check(sys::VecCreateMPI(world, own, order, &mut made.left))?;
        }
        Ok(made)
    }

    fn without_handles(storage: Storage) -> Self {
        let (handle, right, left) = (ptr::null_mut(), ptr::null_mut(), ptr::null_mut());
        Self { handle, right, left, storage }
    }

    /// Takes the entries that `fill` writes, in the pattern's order.
    pub(super) fn update(&mut self, fill: impl FnOnce(&mut [f64])) -> Result<(), SolverFailure> {
        match &mut self.storage {
            Storage::Alone(stored) => {
                let mut values = ptr::null_mut();
                // SAFETY: the session's lock is held and the handle lives; the matrix has `stored` entries, which
                // nobody else reads while they are written.
                unsafe {
                    check(sys::MatSeqSBAIJGetArray(self.handle, &mut values))?;
                    fill(slice::from_raw_parts_mut(values, *stored));
                    check(sys::MatSeqSBAIJRestoreArray(self.handle, &mut values))?;
                    // Tells PETSc that the values are new.
                    check(sys::MatAssemblyBegin(self.handle, sys::MAT_FINAL_ASSEMBLY))?;
                    check(sys::MatAssemblyEnd(self.handle, sys::MAT_FINAL_ASSEMBLY))
                }
            }
            Storage::Spread(values) => {
                fill(values);
                // SAFETY: as above; the entries are as many as the pattern's, and are copied.
                check(unsafe { sys::MatUpdateMPIAIJWithArray(self.handle, values.as_ptr()) })
            }
        }
    }

    /// Calls `solve` with the vectors of right and left side; this rank's part of `b` goes in and the solution's comes out.
    pub(super) fn through_vectors(
        &self,
        b: &mut [f64],
        solve: impl FnOnce(sys::Vec, sys::Vec) -> Result<(), SolverFailure>,
    ) -> Result<(), SolverFailure> {
        WriteArray::of(self.right)?.copy_from_slice(b);
        solve(self.right, self.left)?;
        b.copy_from_slice(&ReadArray::of(self.left)?);
        Ok(())
    }
}

impl Drop for Matrix {
    fn drop(&mut self) {
        in_session(|| {
            // SAFETY: the session's lock is held; each handle is null or ours and is destroyed once.
            unsafe {
                sys::MatDestroy(&mut self.handle);
                sys::VecDestroy(&mut self.right);
                sys::VecDestroy(&mut self.left);
            }
        });
    }
}
