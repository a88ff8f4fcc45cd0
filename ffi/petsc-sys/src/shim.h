/* What bindgen reads: PETSc's headers, and functions for the macros that it cannot see. */
#include <petscsnes.h>

#if !defined(PETSC_USE_REAL_DOUBLE) || defined(PETSC_USE_COMPLEX)
#error "petsc-sys needs a PETSc with real double scalars (Debian: libpetsc-real-dev)"
#endif

/* PETSC_COMM_SELF. */
MPI_Comm petsc_sys_comm_self(void);

/* PETSC_COMM_WORLD. */
MPI_Comm petsc_sys_comm_world(void);

/* Whether `mine` is not 0 on every rank of `comm`; collective. */
int petsc_sys_all(MPI_Comm comm, int mine);

/* Whether `mine` is the same on every rank of `comm`; collective. */
int petsc_sys_same(MPI_Comm comm, long mine);

/* MPI_THREAD_SERIALIZED. */
int petsc_sys_thread_serialized(void);

/* SNESLineSearchShellSetUserFunc, or SNESLineSearchShellSetApply from 3.21 on. */
PetscErrorCode petsc_sys_line_search_shell(
    SNESLineSearch search, PetscErrorCode (*apply)(SNESLineSearch, void *), void *context);

/* Sets the number of threads of OpenBLAS, where the BLAS that PETSc uses is OpenBLAS. */
void petsc_sys_blas_threads(int threads);
