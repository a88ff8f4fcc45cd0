//! Problems with a known answer, one file each.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod basic_bend;
mod ellipsoid;
mod follower;
mod gravity;
mod inflated_sphere;
mod inflated_tube;
mod lids;
mod locking;
mod material_limits;
mod parts;
mod rubber;
mod sections;
mod self_contact;
mod solid_problems;
mod solids;
mod stiff_shell;
mod thick_wall;
