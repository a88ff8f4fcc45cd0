//! Which cells carry the computation? The shell mesh: control points, stencils, clamp and tip.

mod rings;
mod shell;

pub use rings::{Rings, Stencil};
pub use shell::{ShellMesh, ShellSettings};
