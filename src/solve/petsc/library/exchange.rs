//! What ranks tell each other besides matrices: every part of a vector, and whether all agree.

use std::ptr;

use petsc_sys as sys;

use super::arrays::{ReadArray, WriteArray};
use super::session::{Session, check, in_session, petsc_int};
use crate::solve::SolverFailure;
use crate::solve::petsc::rows::Rows;

/// Gathers vectors that are spread by rows.
#[derive(Debug)]
pub(in crate::solve::petsc) struct Exchange {
    rows: Rows,
    spread: sys::Vec,
    whole: sys::Vec,
    scatter: sys::VecScatter,
}

// SAFETY: the handles have no thread of their own, and every use holds the session's lock.
unsafe impl Send for Exchange {}
// SAFETY: as above; a shared use holds the lock too.
unsafe impl Sync for Exchange {}

impl Exchange {
    pub(in crate::solve::petsc) fn new(_: &Session, rows: Rows) -> Result<Self, SolverFailure> {
        let (own, order) = (petsc_int(rows.own.len())?, petsc_int(rows.unknowns.len())?);
        let (spread, whole, scatter) = (ptr::null_mut(), ptr::null_mut(), ptr::null_mut());
        let mut made = Self { rows, spread, whole, scatter };
        // SAFETY: the session's lock is held; handles are written before they are read.
        unsafe {
            let world = sys::petsc_sys_comm_world();
            check(sys::VecCreateMPI(world, own, order, &mut made.spread))?;
            check(sys::VecScatterCreateToAll(made.spread, &mut made.scatter, &mut made.whole))?;
        }
        Ok(made)
    }

    pub(in crate::solve::petsc) fn rows(&self) -> &Rows {
        &self.rows
    }

    /// The parts of `whole [n]` that belong to the own rows, in their order.
    pub(in crate::solve::petsc) fn own(&self, whole: &[f64]) -> Vec<f64> {
        self.rows.own_unknowns().iter().map(|&unknown| whole[unknown as usize]).collect()
    }

    /// Writes what every rank has in `own`, in the order of its rows, into `whole [n]`: the same numbers on all ranks.
    pub(in crate::solve::petsc) fn gather(
        &self,
        _: &Session,
        own: &[f64],
        whole: &mut [f64],
    ) -> Result<(), SolverFailure> {
        WriteArray::of(self.spread)?.copy_from_slice(own);
        // SAFETY: the session's lock is held and the handles live.
        unsafe {
            let (scatter, from, to) = (self.scatter, self.spread, self.whole);
            let [insert, forward] = [sys::INSERT_VALUES, sys::SCATTER_FORWARD];
            check(sys::VecScatterBegin(scatter, from, to, insert, forward))?;
            check(sys::VecScatterEnd(scatter, from, to, insert, forward))?;
        }
        let gathered = ReadArray::of(self.whole)?;
        for (&unknown, value) in self.rows.unknowns.iter().zip(&*gathered) {
            whole[unknown as usize] = *value;
        }
        Ok(())
    }

    /// Whether every rank says yes.
    pub(in crate::solve::petsc) fn all(&self, _: &Session, mine: bool) -> bool {
        // SAFETY: the session's lock is held, and MPI is running.
        unsafe { sys::petsc_sys_all(sys::petsc_sys_comm_world(), i32::from(mine)) != 0 }
    }
}

impl Drop for Exchange {
    fn drop(&mut self) {
        in_session(|| {
            // SAFETY: the session's lock is held; each handle is null or ours and is destroyed once.
            unsafe {
                sys::VecScatterDestroy(&mut self.scatter);
                sys::VecDestroy(&mut self.spread);
                sys::VecDestroy(&mut self.whole);
            }
        });
    }
}
