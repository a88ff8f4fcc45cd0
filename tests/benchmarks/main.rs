//! Problems with a known answer, one file each.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod basic_bend;
mod ellipsoid;
mod inflated_sphere;
