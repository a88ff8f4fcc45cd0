//! Contact with things that do not move.

mod friction;
mod plane;
mod planes;
#[cfg(test)]
mod tests;

pub use friction::Friction;
pub use plane::{PlaneContact, PlaneSettings};
pub use planes::PlaneState;
pub(in crate::model) use planes::Planes;
