//! Contact with things that do not move.

mod plane;

pub use plane::{PlaneContact, PlaneSettings};
