//! Finite elements: the energy of a piece of wall.

mod box_spline;
mod jet;
mod loop_patch;
mod loop_shell;

pub use loop_patch::{LoopBasis, Sample, samples};
pub(in crate::model) use loop_patch::{SUBTRIANGLES, limit_weight};
pub use loop_shell::LoopShell;
pub(in crate::model) use loop_shell::ascending;
