//! Loads that keep their direction, as forces on the nodes: `E = -f . u`.

use crate::math::Vec3;
use crate::mesh::{BoundaryEdge, Side};
use crate::model::element::{ElementPoints, SampledSurface};

/// A load that keeps its direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DeadLoad {
    /// On a vertex.
    Point {
        /// Which.
        vertex: u32,
        /// Force, N.
        force: Vec3,
    },
    /// Along a side of a patch.
    Edge {
        /// Which.
        side: Side,
        /// Force per length of the side at rest, N/mm.
        per_length: Vec3,
    },
    /// All over the surface.
    Area {
        /// Force per area at rest, MPa.
        per_area: Vec3,
    },
}

/// Where loads act: the surface at rest and its discretisation.
pub(in crate::model) struct Loaded<'a> {
    pub reference: &'a [Vec3],
    pub points: &'a [ElementPoints],
    pub surface: &'a SampledSurface,
    /// Reference area of each triangle, mm^2.
    pub areas: &'a [f64],
    pub edges: &'a [BoundaryEdge],
    pub triangles: &'a [[u32; 3]],
}

impl Loaded<'_> {
    /// The forces on all nodes that do the work of `loads`, N.
    pub(in crate::model) fn nodal_forces(&self, loads: &[DeadLoad]) -> Vec<Vec3> {
        let mut forces = vec![Vec3::zeros(); self.reference.len()];
        for load in loads {
            match *load {
                DeadLoad::Point { vertex, force } => {
                    let sample = &self.surface.samples[vertex as usize];
                    for (&node, weight) in sample.nodes.iter().zip(&sample.weights) {
                        forces[node as usize] += *weight * force;
                    }
                }
                DeadLoad::Edge { side, per_length } => {
                    for edge in self.edges.iter().filter(|edge| edge.side == side) {
                        // Simpson's rule over the edge's ends and middle.
                        let length = self.length(edge);
                        let [a, b, middle] = self.points_of(edge);
                        let share = |point| if point == middle { 4.0 / 6.0 } else { 1.0 / 6.0 };
                        for point in [a, b, middle] {
                            let force = share(point) * length * per_length;
                            self.add(edge.triangle, point, force, &mut forces);
                        }
                    }
                }
                DeadLoad::Area { per_area } => {
                    // The three edge midpoints integrate quadratics.
                    for (triangle, area) in self.areas.iter().enumerate() {
                        for point in 3..6 {
                            self.add(triangle, point, area / 3.0 * per_area, &mut forces);
                        }
                    }
                }
            }
        }
        forces
    }

    /// Length of an edge at rest, mm: its chords, extrapolated to the arc.
    pub(in crate::model) fn length(&self, edge: &BoundaryEdge) -> f64 {
        let points = self.points[edge.triangle]
            .at(self.points[edge.triangle].nodes.iter().map(|&v| &self.reference[v as usize]));
        let [a, b, middle] = self.points_of(edge).map(|point| points[point]);
        (4.0 * ((middle - a).norm() + (b - middle).norm()) - (b - a).norm()) / 3.0
    }

    /// The element's points at the ends and in the middle of an edge.
    pub(in crate::model) fn points_of(&self, edge: &BoundaryEdge) -> [usize; 3] {
        let triangle = self.triangles[edge.triangle];
        let corner = |node: u32| {
            triangle.iter().position(|&v| v == node).expect("the edge is its triangle's")
        };
        let [a, b] = edge.ends.map(corner);
        [a, b, 3 + (3 - a - b)]
    }

    fn add(&self, triangle: usize, point: usize, force: Vec3, forces: &mut [Vec3]) {
        let points = &self.points[triangle];
        for (&node, weights) in points.nodes.iter().zip(&points.weights) {
            forces[node as usize] += weights[point] * force;
        }
    }
}
