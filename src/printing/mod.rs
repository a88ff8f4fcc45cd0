//! Can it be printed? The wall with its air inlet as one closed surface, and what a printer of filament would say of it.
//!
//! ```text
//! faces of the wall -> PrintedPart: outer face, inlet, chamber face -> Printability
//! ```
//! Figures are of the triangles where these are exact (thickness, overhangs, volume) and of voxels where connections count (air, bridges).
//! What a slicer makes of them, and what the nozzle then does, is not judged here.

mod air;
mod base;
mod bodies;
mod bridge;
mod inlet;
mod opening;
mod overhang;
mod part;
mod printability;
#[cfg(test)]
mod test_shapes;
mod thickness;
mod voxels;

pub use air::AirPaths;
pub use bodies::{Bodies, LEAST_PIECE};
pub use bridge::longest_bridge;
pub use inlet::{Inlet, LEAST_WALL};
pub use overhang::{BuildDirection, Overhang, overhang};
pub use part::{Bore, PrintedPart};
pub use printability::{Orientation, PrintSettings, Printability};
pub use thickness::{Thickness, thickness};
pub use voxels::Voxels;
