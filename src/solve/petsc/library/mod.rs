//! The only folder that calls PETSc: a factorisation of our symmetric matrix, and SNES over our callbacks.
//!
//! It wraps what [`super::Snes`] needs, not PETSc. No type of PETSc leaves this folder.

#![expect(unsafe_code, reason = "the one boundary with PETSc")]

mod arrays;
mod driver;
mod exchange;
mod factor;
mod iteration;
mod matrix;
mod messages;
mod session;

pub(super) use self::driver::{Driver, Newton};
pub(super) use self::exchange::Exchange;
pub(super) use self::factor::{Factor, Inertia};
pub(super) use self::iteration::Iteration;
pub(super) use self::matrix::Matrix;
pub(in crate::solve) use self::session::{Session, abort_job};
