#![doc = include_str!("../README.md")]
//!
//! ## Threads
//!
//! PETSc is not thread-safe: one call at a time in the whole process, whatever the objects. Objects on
//! [`petsc_sys_comm_self`] have no thread of their own, so any thread may make that call, provided that
//! MPI was initialised with at least [`petsc_sys_thread_serialized`] (set [`PETSC_MPI_THREAD_REQUIRED`]
//! before [`PetscInitialize`]).

#[allow(
    missing_docs,
    non_camel_case_types,
    non_snake_case,
    non_upper_case_globals,
    clippy::all,
    clippy::undocumented_unsafe_blocks,
    reason = "generated: the names are PETSc's"
)]
mod bindings {
    include!(concat!(env!("OUT_DIR"), "/bindings.rs"));
}

pub use bindings::*;
