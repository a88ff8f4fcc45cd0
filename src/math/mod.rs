//! The floor: words that any room may use.

mod cpu_time;
pub mod random;
mod reason;
mod rejected;

pub use cpu_time::cpu_seconds;
pub use reason::Reason;
pub use rejected::{Rejected, Room, Stage};

/// A point or vector in space, mm.
pub type Vec3 = nalgebra::Vector3<f64>;
