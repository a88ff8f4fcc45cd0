//! What one part under load is, as a scene file says it, and the walk along its path.
//!
//! A [`SceneFile`](scene_file::SceneFile) is read and checked, its part is made, loaded and walked, and the results are written.

pub(crate) mod actuator;
pub(crate) mod checks;
pub(crate) mod deck;
pub(crate) mod error;
pub(crate) mod gravity;
pub(crate) mod keys;
pub(crate) mod material;
pub(crate) mod mesh_section;
mod observer;
pub(crate) mod part;
pub(crate) mod results;
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
