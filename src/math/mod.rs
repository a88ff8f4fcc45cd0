//! The floor: words that any room may use.

mod box3;
mod box_tree;
mod cpu_time;
mod disjoint_sets;
mod geometry;
pub mod random;
mod reason;
mod rejected;

pub use box_tree::{BoxTree, Node};
pub use box3::Box3;
pub use cpu_time::cpu_seconds;
pub use disjoint_sets::DisjointSets;
pub use geometry::{angle_between, area_vector, cofactor};
pub use reason::Reason;
pub use rejected::{Rejected, Room, Stage};

/// A point or vector in space, mm.
pub type Vec3 = nalgebra::Vector3<f64>;
