//! The numbers inside PETSc's vectors, as slices: those of this rank.

use std::ops::{Deref, DerefMut};
use std::{ptr, slice};

use petsc_sys as sys;

use super::session::{check, count};
use crate::solve::SolverFailure;

/// The own entries of a vector, to read.
pub(super) struct ReadArray {
    vector: sys::Vec,
    start: *const f64,
    length: usize,
}

impl ReadArray {
    /// `vector` must be alive and a session open.
    pub(super) fn of(vector: sys::Vec) -> Result<Self, SolverFailure> {
        let (mut start, mut length) = (ptr::null(), 0);
        // SAFETY: this folder passes live vectors under the session's lock.
        unsafe {
            check(sys::VecGetLocalSize(vector, &mut length))?;
            check(sys::VecGetArrayRead(vector, &mut start))?;
        }
        Ok(Self { vector, start, length: count(length) })
    }
}

impl Deref for ReadArray {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        if self.length == 0 {
            // PETSc has no address for no numbers.
            return &[];
        }
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

/// The own entries of a vector, to write.
pub(super) struct WriteArray {
    vector: sys::Vec,
    start: *mut f64,
    length: usize,
}

impl WriteArray {
    /// `vector` must be alive, a session open, and no other array of it in use.
    pub(super) fn of(vector: sys::Vec) -> Result<Self, SolverFailure> {
        let (mut start, mut length) = (ptr::null_mut(), 0);
        // SAFETY: as in `ReadArray::of`.
        unsafe {
            check(sys::VecGetLocalSize(vector, &mut length))?;
            check(sys::VecGetArray(vector, &mut start))?;
        }
        Ok(Self { vector, start, length: count(length) })
    }
}

impl Deref for WriteArray {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        if self.length == 0 {
            return &[];
        }
        // SAFETY: as in `ReadArray::deref`.
        unsafe { slice::from_raw_parts(self.start, self.length) }
    }
}

impl DerefMut for WriteArray {
    fn deref_mut(&mut self) -> &mut [f64] {
        if self.length == 0 {
            return &mut [];
        }
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
