//! An indexed triangle surface.

use crate::math::Vec3;

/// Triangles over shared vertices, counter-clockwise seen from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriangleMesh {
    /// Vertex positions, mm.
    pub positions: Vec<Vec3>,
    /// Vertex indices of each triangle.
    pub triangles: Vec<[u32; 3]>,
}

impl TriangleMesh {
    /// The three corners of triangle `t`, mm.
    #[must_use]
    pub fn corners(&self, t: usize) -> [Vec3; 3] {
        self.triangles[t].map(|v| self.positions[v as usize])
    }

    /// The enclosed volume, mm^3, positive when the triangles face outward.
    #[must_use]
    pub fn volume(&self) -> f64 {
        let corner_volume = |t| {
            let [a, b, c] = self.corners(t);
            a.dot(&b.cross(&c)) / 6.0
        };
        (0..self.triangles.len()).map(corner_volume).sum()
    }

    /// The surface area, mm^2.
    #[must_use]
    pub fn area(&self) -> f64 {
        let corner_area = |t| {
            let [a, b, c] = self.corners(t);
            (b - a).cross(&(c - a)).norm() / 2.0
        };
        (0..self.triangles.len()).map(corner_area).sum()
    }
}
