//! The floor: words that any room may use.

pub mod random;
mod rejected;

pub use rejected::{Rejected, Room};

/// A point or vector in space, mm.
pub type Vec3 = nalgebra::Vector3<f64>;
