//! Solutions with a symmetric saddle by an iteration of PETSc that needs no factorisation.
//!
//! ```text
//! [ A  B^T ] [u]   [f]        GMRES from the right behind   P = [ A~  B^T ]      A~: algebraic multigrid, knowing rigid motions
//! [ B  -C  ] [p] = [g]                                          [     -S~ ]      S~: the diagonal that the multipliers come with
//! ```
//!
//! Source: Silvester & Wathen (1994); Elman, Silvester & Wathen (2014), chapter 4. Multigrid: PETSc's GAMG, smoothed aggregation with the
//! rigid motions as its near-null space (Vanek, Mandel & Brezina 1996; Adams 2002).

use std::ffi::CStr;
use std::ptr;

use petsc_sys as sys;

use super::arrays::WriteArray;
use super::matrix::Matrix;
use super::session::{Session, check, count, in_session, petsc_int};
use crate::math::Vec3;
use crate::solve::SolverFailure;
use crate::solve::petsc::rows::Rows;

/// The iteration over a spread matrix, set up once and again for new values.
#[derive(Debug)]
pub(in crate::solve::petsc) struct Iteration {
    matrix: Matrix,
    krylov: sys::KSP,
    complement: sys::Mat,
    rigid: sys::MatNullSpace,
    fields: [sys::IS; 2],
    /// Iterations since it was made.
    pub iterations: usize,
}

// SAFETY: the handles have no thread of their own, and every use holds the session's lock.
unsafe impl Send for Iteration {}

impl Iteration {
    /// For `matrix`, of these `rows`; of the own rows: `places` of the nodes (mm), `complements` of the multipliers.
    pub(in crate::solve::petsc) fn new(
        _: &Session,
        matrix: Matrix,
        rows: &Rows,
        places: &[Vec3],
        complements: &[f64],
    ) -> Result<Self, SolverFailure> {
        let mut made = Self {
            matrix,
            krylov: ptr::null_mut(),
            complement: ptr::null_mut(),
            rigid: ptr::null_mut(),
            fields: [ptr::null_mut(); 2],
            iterations: 0,
        };
        let start = petsc_int(rows.own.start)?;
        let sizes = [petsc_int(rows.displacements)?, petsc_int(complements.len())?];
        // SAFETY: the session's lock is held; handles are written before they are read.
        unsafe {
            let world = sys::petsc_sys_comm_world();
            let [displacements, multipliers] = &mut made.fields;
            check(sys::ISCreateStride(world, sizes[0], start, 1, displacements))?;
            check(sys::ISSetBlockSize(*displacements, 3))?;
            check(sys::ISCreateStride(world, sizes[1], start + sizes[0], 1, multipliers))?;
        }
        made.set_rigid_motions(places)?;
        made.set_complement(complements)?;
        made.set_up()?;
        Ok(made)
    }

    /// Hangs the rigid motions of `places` on the field of displacements, where multigrid finds them.
    fn set_rigid_motions(&mut self, places: &[Vec3]) -> Result<(), SolverFailure> {
        let own = petsc_int(3 * places.len())?;
        let mut coordinates = ptr::null_mut();
        // SAFETY: the session's lock is held; handles are written before they are read, and the vector is destroyed once.
        unsafe {
            let world = sys::petsc_sys_comm_world();
            check(sys::VecCreateMPI(world, own, DETERMINE, &mut coordinates))?;
            check(sys::VecSetBlockSize(coordinates, 3))?;
            let flat = places.iter().flat_map(|place| place.iter());
            let mut array = WriteArray::of(coordinates)?;
            array.iter_mut().zip(flat).for_each(|(to, from)| *to = *from);
            drop(array);
            check(sys::MatNullSpaceCreateRigidBody(coordinates, &mut self.rigid))?;
            check(sys::VecDestroy(&mut coordinates))?;
            check(sys::PetscObjectCompose(
                self.fields[0].cast(),
                c"nearnullspace".as_ptr(),
                self.rigid.cast(),
            ))
        }
    }

    /// Makes the diagonal matrix `-S~`.
    fn set_complement(&mut self, complements: &[f64]) -> Result<(), SolverFailure> {
        let own = petsc_int(complements.len())?;
        let (mut first, mut end) = (0, 0);
        // SAFETY: as in `set_rigid_motions`; the arrays are a valid pattern and are copied.
        unsafe {
            let world = sys::petsc_sys_comm_world();
            check(sys::MatCreate(world, &mut self.complement))?;
            check(sys::MatSetSizes(self.complement, own, own, DETERMINE, DETERMINE))?;
            check(sys::MatSetType(self.complement, sys::MATMPIAIJ.as_ptr()))?;
            check(sys::MatSetUp(self.complement))?;
            check(sys::MatGetOwnershipRange(self.complement, &mut first, &mut end))?;
            let starts: Vec<sys::PetscInt> = (0..=own).collect();
            let columns: Vec<sys::PetscInt> = (first..end).collect();
            let values: Vec<f64> = complements.iter().map(|complement| -complement).collect();
            check(sys::MatMPIAIJSetPreallocationCSR(
                self.complement,
                starts.as_ptr(),
                columns.as_ptr(),
                values.as_ptr(),
            ))
        }
    }

    fn set_up(&mut self) -> Result<(), SolverFailure> {
        let mut outer = ptr::null_mut();
        // SAFETY: the session's lock is held and the handles live.
        unsafe {
            for [name, value] in OPTIONS {
                let mut is_set = sys::PETSC_FALSE;
                let none = ptr::null_mut();
                check(sys::PetscOptionsHasName(none, ptr::null(), name.as_ptr(), &mut is_set))?;
                if is_set == sys::PETSC_FALSE {
                    check(sys::PetscOptionsSetValue(none, name.as_ptr(), value.as_ptr()))?;
                }
            }
            let world = sys::petsc_sys_comm_world();
            check(sys::KSPCreate(world, &mut self.krylov))?;
            check(sys::KSPSetOptionsPrefix(self.krylov, c"solid_".as_ptr()))?;
            check(sys::KSPSetOperators(self.krylov, self.matrix.handle, self.matrix.handle))?;
            check(sys::KSPSetType(self.krylov, sys::KSPGMRES.as_ptr()))?;
            check(sys::KSPSetPCSide(self.krylov, sys::PC_RIGHT))?;
            check(sys::KSPGetPC(self.krylov, &mut outer))?;
            check(sys::PCSetType(outer, sys::PCFIELDSPLIT.as_ptr()))?;
            check(sys::PCFieldSplitSetIS(outer, c"u".as_ptr(), self.fields[0]))?;
            check(sys::PCFieldSplitSetIS(outer, c"p".as_ptr(), self.fields[1]))?;
            check(sys::PCFieldSplitSetType(outer, sys::PC_COMPOSITE_SCHUR))?;
            check(sys::PCFieldSplitSetSchurFactType(outer, sys::PC_FIELDSPLIT_SCHUR_FACT_UPPER))?;
            check(sys::PCFieldSplitSetSchurPre(
                outer,
                sys::PC_FIELDSPLIT_SCHUR_PRE_USER,
                self.complement,
            ))?;
            check(sys::KSPSetFromOptions(self.krylov))
        }
    }

    /// Takes the entries that `fill` writes, in the pattern's order.
    pub(in crate::solve::petsc) fn update(
        &mut self,
        _: &Session,
        fill: impl FnOnce(&mut [f64]),
    ) -> Result<(), SolverFailure> {
        self.matrix.update(fill)?;
        // SAFETY: the session's lock is held and the handles live.
        check(unsafe { sys::KSPSetOperators(self.krylov, self.matrix.handle, self.matrix.handle) })
    }

    /// Solves until the residual is `tolerance` of `b`, which is overwritten by the solution, both of the own rows; whether it got there.
    pub(in crate::solve::petsc) fn solve(
        &mut self,
        _: &Session,
        b: &mut [f64],
        tolerance: f64,
    ) -> Result<bool, SolverFailure> {
        let mut reason = sys::KSP_CONVERGED_ITERATING;
        let mut iterations = 0;
        let krylov = self.krylov;
        self.matrix.through_vectors(b, |right, left| {
            // SAFETY: the session's lock is held and the handles live.
            unsafe {
                check(sys::KSPSetTolerances(krylov, tolerance, 0.0, DIVERGED, MOST_ITERATIONS))?;
                check(sys::KSPSolve(krylov, right, left))?;
                check(sys::KSPGetConvergedReason(krylov, &mut reason))?;
                check(sys::KSPGetIterationNumber(krylov, &mut iterations))
            }
        })?;
        self.iterations += count(iterations);
        Ok(reason > 0)
    }
}

impl Drop for Iteration {
    fn drop(&mut self) {
        in_session(|| {
            // SAFETY: the session's lock is held; each handle is null or ours and is destroyed once.
            unsafe {
                sys::KSPDestroy(&mut self.krylov);
                sys::MatDestroy(&mut self.complement);
                sys::MatNullSpaceDestroy(&mut self.rigid);
                self.fields.iter_mut().for_each(|field| {
                    sys::ISDestroy(field);
                });
            }
        });
    }
}

/// `PETSC_DETERMINE`.
const DETERMINE: sys::PetscInt = -1;
/// Given up when the residual grows by this.
const DIVERGED: f64 = 1e6;
const MOST_ITERATIONS: sys::PetscInt = 600;

/// How the fields are preconditioned, where the environment's `PETSC_OPTIONS` say nothing else.
///
/// Measured on a box of 123,000 unknowns: a threshold of 0.05 takes as many iterations as 0.01, and five times as much of a cycle (operator
/// complexity 4.8 against 1.2); aggregates kept from the state at rest take four times as many iterations once it is bent.
const OPTIONS: [[&CStr; 2]; 7] = [
    [c"-solid_ksp_gmres_restart", c"150"],
    [c"-solid_fieldsplit_u_ksp_type", c"preonly"],
    [c"-solid_fieldsplit_u_pc_type", c"gamg"],
    [c"-solid_fieldsplit_u_pc_gamg_threshold", c"0.01"],
    [c"-solid_fieldsplit_u_mg_levels_ksp_max_it", c"4"],
    [c"-solid_fieldsplit_p_ksp_type", c"preonly"],
    [c"-solid_fieldsplit_p_pc_type", c"jacobi"],
];
