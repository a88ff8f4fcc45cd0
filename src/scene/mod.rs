//! What is one part under load, and how is its path walked?
//!
//! A program reads a [`Scene`] and walks it: a [`Walk`] has the model, the path, and what is read
//! off each of its states. An [`Observer`] is told of warnings and of the states as they are found;
//! [`Unobserved`] is one that ignores them. The commands write a folder of what was walked, and
//! decks for other programs.

pub(crate) mod actuator;
pub(crate) mod checks;
pub(crate) mod deck;
pub(crate) mod error;
pub(crate) mod gravity;
pub(crate) mod keys;
pub(crate) mod limits;
pub(crate) mod material;
pub(crate) mod mesh_section;
mod observer;
pub(crate) mod part;
pub(crate) mod pattern;
pub(crate) mod presets;
pub(crate) mod region;
pub(crate) mod results;
pub(crate) mod scene_defaults;
pub(crate) mod scene_file;
pub(crate) mod shape;
pub(crate) mod simulate;
pub(crate) mod simulate_shape;
pub(crate) mod verify_section;
mod walk;
pub(crate) mod watch;
pub(crate) mod watch_curve;

pub use self::observer::{End, Observer, Unobserved};
pub use self::walk::{Scene, Walk};
