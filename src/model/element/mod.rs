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
mod points;
mod solid_state;
mod taylor_hood;
mod wall_point;
mod wall_state;

pub use facet_fit::volume_matched;
pub use fit::fitted_control_points;
pub use loop_patch::LoopBasis;
pub use loop_shell::LoopShell;
pub use mid_edge_shell::{MidEdgeShell, mid_edge_patches};
pub(in crate::model) use points::ascending;
pub use points::{ElementPoints, Sample, SampledSurface};
pub use solid_state::SolidState;
pub use taylor_hood::TaylorHood;
pub use wall_state::{Face, PeakState, ShellState};
