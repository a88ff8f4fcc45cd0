//! Closed shapes whose area and volume are known, to check computations against.

use std::collections::BTreeMap;

use super::TriangleMesh;
use crate::math::Vec3;

impl TriangleMesh {
    /// A sphere about the origin: an icosahedron whose triangles are quartered `subdivisions` times.
    #[must_use]
    pub fn sphere(radius: f64, subdivisions: usize) -> Self {
        let golden = f64::midpoint(1.0, 5.0_f64.sqrt());
        let mut mesh = Self {
            positions: [[-1.0, golden], [1.0, golden], [-1.0, -golden], [1.0, -golden]]
                .into_iter()
                .flat_map(|[a, b]| [[a, b, 0.0], [0.0, a, b], [b, 0.0, a]])
                .map(Vec3::from)
                .collect(),
            triangles: Vec::new(),
        };
        // Vertices at distance 2 are neighbours; each neighbouring triple is a face, turned outward.
        let near = |a: usize, b: usize| (mesh.positions[a] - mesh.positions[b]).norm() < 2.1;
        for a in 0..12 {
            for b in a + 1..12 {
                for c in b + 1..12 {
                    if near(a, b) && near(b, c) && near(a, c) {
                        let [pa, pb, pc] = [a, b, c].map(|v| mesh.positions[v]);
                        let outward = pa.dot(&pb.cross(&pc)) > 0.0;
                        let [b, c] = if outward { [b, c] } else { [c, b] };
                        mesh.triangles.push([a, b, c].map(|v| v as u32));
                    }
                }
            }
        }
        for _ in 0..subdivisions {
            mesh = mesh.quartered();
        }
        for position in &mut mesh.positions {
            *position *= radius / position.norm();
        }
        mesh
    }

    /// Every triangle split in four at its edge midpoints.
    #[must_use]
    pub fn quartered(&self) -> Self {
        let mut fine = Self { positions: self.positions.clone(), triangles: Vec::new() };
        let mut midpoints = BTreeMap::new();
        for &[a, b, c] in &self.triangles {
            let [ab, bc, ca] = [[a, b], [b, c], [c, a]].map(|[a, b]| {
                *midpoints.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                    let [a, b] = [a, b].map(|v| self.positions[v as usize]);
                    fine.positions.push((a + b) / 2.0);
                    fine.positions.len() as u32 - 1
                })
            });
            fine.triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        fine
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use approx::assert_relative_eq;

    use super::*;

    /// A fine sphere has its volume to second order in the edge (here 0.07 of the radius).
    #[test]
    fn sphere_is_closed_and_has_its_volume() {
        let mesh = TriangleMesh::sphere(10.0, 4);
        assert_eq!(mesh.positions.len(), 2562);
        assert_eq!(mesh.triangles.len(), 5120);
        assert_relative_eq!(mesh.volume(), 4000.0 * PI / 3.0, max_relative = 4e-3);
    }
}
