//! Does the program agree with published numbers?
//!
//! Textbook shells, curves beyond the loss of stability, and scenes on which solvers come to grief,
//! all built in. An [`Observer`] is told the table as it grows; a run that is too far from its
//! reference is an error.

pub mod benchmarks;
mod cases;
#[cfg(test)]
mod curves;
mod deviations;
mod files;
mod observer;
pub mod stability;
mod stability_case;

pub use self::cases::{CURVES, SHELLS};
pub use self::files::SceneFolder;
pub use self::observer::Observer;
