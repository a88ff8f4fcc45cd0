//! Contact with things that do not move, and of the wall with itself.

mod friction;
mod plane;
mod plane_terms;
mod planes;
pub(super) mod self_contact;
#[cfg(test)]
mod tests;

pub use friction::Friction;
pub(in crate::model) use plane::Samples;
pub use plane::{PlaneContact, PlaneSettings};
pub(in crate::model) use plane_terms::PlaneTerms;
pub use planes::PlaneState;
pub use self_contact::SelfContactSettings;
