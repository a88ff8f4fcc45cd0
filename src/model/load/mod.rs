//! Loads: with a potential, but for [`FollowerLoads`].

mod chamber_pressure;
mod dead_forces;
mod dead_load;
mod edge_moment;
mod follower;
mod lid;

pub use chamber_pressure::{ChamberPressure, Fan};
pub use dead_forces::DeadForces;
pub use dead_load::DeadLoad;
pub(in crate::model) use dead_load::Loaded;
pub use edge_moment::{EdgeMoment, MomentEdge};
pub use follower::{CarriedForce, Follower, FollowerForce, FollowerLoads, OpenEdge};
pub use lid::LidFan;
