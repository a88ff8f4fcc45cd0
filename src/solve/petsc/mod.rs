//! Equilibria by PETSc, on one rank or many.
//!
//! Under `mpirun` every rank runs the same program on the same state, and only what is dear is divided: each evaluates the stencils of its
//! own rows (`shared.rs`, `rows.rs`), and the ranks factorise or iterate together (`tangent.rs`). What a rank decides by is what was
//! gathered from all, the same bits everywhere, so all decide alike.

mod library;
mod rows;
mod shared;
mod snes;
mod tangent;

pub(super) use self::library::{Session, abort_job};
pub use self::snes::Snes;
