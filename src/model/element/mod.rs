//! Finite elements: the energy of a piece of wall.

mod box_spline;
mod facet_fit;
mod fit;
mod jet;
mod kinematics;
mod loop_patch;
mod loop_shell;
mod mid_edge;
mod mid_edge_shell;
mod wall_point;

pub use facet_fit::volume_matched;
pub use fit::fitted_control_points;
pub use loop_patch::{LoopBasis, Sample, samples};
pub(in crate::model) use loop_patch::{SUBTRIANGLES, ascending};
pub use loop_shell::LoopShell;
pub use mid_edge_shell::{MidEdgeShell, mid_edge_patches};
