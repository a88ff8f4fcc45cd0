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

/* Sends `length` bytes to a rank of `comm`; an error code of MPI. */
int petsc_sys_send(MPI_Comm comm, const void *bytes, int length, int to, int tag);

/* Whether a message waits; if so, whose, with what tag and how many bytes. */
int petsc_sys_probe(MPI_Comm comm, int *from, int *tag, int *length);

/* Receives a message that waits; an error code of MPI. */
int petsc_sys_receive(MPI_Comm comm, void *bytes, int length, int from, int tag);

/* MPI_THREAD_SERIALIZED. */
int petsc_sys_thread_serialized(void);

/* SNESLineSearchShellSetUserFunc, or SNESLineSearchShellSetApply from 3.21 on. */
PetscErrorCode petsc_sys_line_search_shell(
    SNESLineSearch search, PetscErrorCode (*apply)(SNESLineSearch, void *), void *context);

/* Sets the number of threads of OpenBLAS, where the BLAS that PETSc uses is OpenBLAS. */
void petsc_sys_blas_threads(int threads);
