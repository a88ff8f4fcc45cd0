#define _GNU_SOURCE /* RTLD_DEFAULT */
#include "shim.h"

#include <dlfcn.h>

MPI_Comm petsc_sys_comm_self(void) { return PETSC_COMM_SELF; }

MPI_Comm petsc_sys_comm_world(void) { return PETSC_COMM_WORLD; }

int petsc_sys_all(MPI_Comm comm, int mine) {
  int all = 0;
  return MPI_Allreduce(&mine, &all, 1, MPI_INT, MPI_LAND, comm) == MPI_SUCCESS && all;
}

int petsc_sys_same(MPI_Comm comm, long mine) {
  long both[2] = {mine, -mine}, largest[2] = {0, 0};
  return MPI_Allreduce(both, largest, 2, MPI_LONG, MPI_MAX, comm) == MPI_SUCCESS && largest[0] == -largest[1];
}

int petsc_sys_thread_serialized(void) { return MPI_THREAD_SERIALIZED; }

PetscErrorCode petsc_sys_line_search_shell(
    SNESLineSearch search, PetscErrorCode (*apply)(SNESLineSearch, void *), void *context) {
#if PETSC_VERSION_LT(3, 21, 0)
  return SNESLineSearchShellSetUserFunc(search, apply, context);
#else
  return SNESLineSearchShellSetApply(search, apply, context);
#endif
}

void petsc_sys_blas_threads(int threads) {
  void (*set)(int) = (void (*)(int))dlsym(RTLD_DEFAULT, "openblas_set_num_threads");
  if (set) set(threads);
}
