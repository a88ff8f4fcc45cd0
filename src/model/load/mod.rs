//! Loads: with a potential, but for [`FollowerLoads`].

mod chamber_pressure;
mod dead_forces;
mod dead_load;
mod edge_moment;
mod follower;
mod lid;

pub(in crate::model) use chamber_pressure::{ChamberPressure, Fan};
pub(in crate::model) use dead_forces::DeadForces;
pub use dead_load::DeadLoad;
pub(in crate::model) use dead_load::Loaded;
pub(in crate::model) use edge_moment::{EdgeMoment, MomentEdge};
pub use follower::FollowerForce;
pub(in crate::model) use follower::{CarriedForce, Follower, FollowerLoads, OpenEdge};
pub(in crate::model) use lid::LidFan;
