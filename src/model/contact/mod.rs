//! Contact with things that do not move, and of the wall with itself.

mod plane;
pub(super) mod self_contact;

pub use plane::{PlaneContact, PlaneSettings};
pub use self_contact::SelfContactSettings;
