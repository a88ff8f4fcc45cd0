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

int petsc_sys_send(MPI_Comm comm, const void *bytes, int length, int to, int tag) {
  return MPI_Send(bytes, length, MPI_BYTE, to, tag, comm);
}

int petsc_sys_probe(MPI_Comm comm, int *from, int *tag, int *length) {
  int waits = 0;
  MPI_Status status;
  if (MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, comm, &waits, &status) != MPI_SUCCESS || !waits) return 0;
  *from = status.MPI_SOURCE;
  *tag = status.MPI_TAG;
  return MPI_Get_count(&status, MPI_BYTE, length) == MPI_SUCCESS;
}

int petsc_sys_receive(MPI_Comm comm, void *bytes, int length, int from, int tag) {
  return MPI_Recv(bytes, length, MPI_BYTE, from, tag, comm, MPI_STATUS_IGNORE);
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
