//! How an open patch is held and loaded.

use super::edge_support::EdgeSupports;
use super::load::{DeadLoad, FollowerForce};
use crate::math::Vec3;
use crate::mesh::{Patch, Side};

/// How a patch is held and loaded; the load factor multiplies all loads.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PatchLoads {
    /// How each side is held, in the order of [`Side::ALL`].
    pub supports: EdgeSupports,
    /// Single components of the displacement (vertex, axis) held at 0, against rigid motions that the sides leave.
    pub pins: Vec<(u32, usize)>,
    /// Pressure on the side from which the normal `x,s cross x,t` points away, following the wall, MPa.
    pub pressure: f64,
    /// Loads that keep their direction.
    pub dead: Vec<DeadLoad>,
    /// Forces that keep their angle to the wall.
    pub followers: Vec<FollowerForce>,
    /// Moments per length (N mm / mm) along sides; the vector is the axis, to which the side is parallel and stays so.
    pub moments: Vec<(Side, Vec3)>,
}

impl PatchLoads {
    /// The sizes of all loads on `patch`, over its area: the scale of the pressure on a plane, MPa.
    ///
    /// A moment counts as the force that makes it over the patch's width, the root of its area.
    #[must_use]
    pub fn mean_pressure(&self, patch: &Patch) -> f64 {
        let area = patch.surface.area();
        let edges = patch.boundary_edges();
        let length = |side: Side| -> f64 {
            let ends = edges.iter().filter(|edge| edge.side == side).map(|edge| edge.ends);
            ends.map(|ends| {
                let [a, b] = ends.map(|v| patch.surface.positions[v as usize]);
                (b - a).norm()
            })
            .sum()
        };
        let force = |load: &DeadLoad| match *load {
            DeadLoad::Point { force, .. } => force.norm(),
            DeadLoad::Edge { side, per_length } => per_length.norm() * length(side),
            DeadLoad::Area { per_area } => per_area.norm() * area,
        };
        let moment = |(side, per_length): &(Side, Vec3)| per_length.norm() * length(*side);
        let forces = self.dead.iter().map(force).sum::<f64>();
        let moments = self.moments.iter().map(moment).sum::<f64>();
        self.pressure.abs() + (forces + moments / area.sqrt()) / area
    }
}
