//! Loads with a potential.

mod chamber_pressure;
mod dead_load;
mod edge_moment;

pub use chamber_pressure::{ChamberPressure, Fan};
pub use dead_load::DeadLoad;
pub(in crate::model) use dead_load::Loaded;
pub use edge_moment::{EdgeMoment, MomentEdge};
