//! Meshes of solid walls: tetrahedra between the chamber and the outside.
//!
//! ```text
//! edge midpoints of a tetrahedron   4: 0-1   5: 1-2   6: 2-0   7: 0-3   8: 1-3   9: 2-3
//! edge midpoints of a face          3: 1-2   4: 2-0   5: 0-1        (opposite to the corners 0, 1, 2)
//! ```

use std::collections::HashMap;

use super::Lid;
use crate::math::Vec3;
use crate::surface::TriangleMesh;

/// The two faces of a wall: closed surfaces, each with normals that leave the volume it encloses.
#[derive(Clone, Debug)]
pub struct WallSurfaces {
    /// The outside of the part.
    pub outer: TriangleMesh,
    /// The wall of the chamber.
    pub chamber: TriangleMesh,
}

/// Straight tetrahedra that fill a wall.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TetMesh {
    /// Vertices, mm.
    pub positions: Vec<Vec3>,
    /// Corners of each tetrahedron; its volume `(b - a) . (c - a) x (d - a) / 6` is positive.
    pub tetrahedra: Vec<[u32; 4]>,
    /// Faces on the chamber, with normals out of the chamber, into the wall.
    pub chamber: Vec<[u32; 3]>,
    /// All other faces of the boundary, with normals out of the wall.
    pub outer: Vec<[u32; 3]>,
}

/// Quadratic tetrahedra that fill a wall.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SolidMesh {
    /// Corners of tetrahedra, then edge midpoints, mm.
    pub positions: Vec<Vec3>,
    /// How many of them are corners.
    pub corners: usize,
    /// Nodes of each tetrahedron: four corners, six edge midpoints.
    pub tetrahedra: Vec<[u32; 10]>,
    /// Faces on the chamber: three corners, three edge midpoints; with normals out of the chamber, into the wall.
    pub chamber: Vec<[u32; 6]>,
    /// All other faces of the boundary, with normals out of the wall.
    pub outer: Vec<[u32; 6]>,
    /// What closes the chamber where its faces do not.
    pub lids: Vec<Lid>,
    /// The material of each tetrahedron, by its place in a list; empty where all are of the first.
    pub materials: Vec<u16>,
}

/// The corners between which each edge midpoint of a tetrahedron lies.
pub const TET_EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];
/// The corners between which each edge midpoint of a face lies.
pub const FACE_EDGES: [[usize; 2]; 3] = [[1, 2], [2, 0], [0, 1]];

/// Values of the shape functions of a quadratic tetrahedron at the barycentric coordinates `l`: `l (2 l - 1)` of corners, `4 l_a l_b` of
/// edge midpoints.
#[must_use]
pub fn quadratic_shapes(l: &[f64; 4]) -> [f64; 10] {
    std::array::from_fn(|k| match k.checked_sub(4) {
        None => l[k] * (2.0 * l[k] - 1.0),
        Some(edge) => {
            let [a, b] = TET_EDGES[edge];
            4.0 * l[a] * l[b]
        }
    })
}

/// Their slopes with respect to the last three barycentric coordinates.
#[must_use]
pub fn quadratic_slopes(l: &[f64; 4]) -> [Vec3; 10] {
    let rates = [Vec3::repeat(-1.0), Vec3::x(), Vec3::y(), Vec3::z()];
    std::array::from_fn(|k| match k.checked_sub(4) {
        None => (4.0 * l[k] - 1.0) * rates[k],
        Some(edge) => {
            let [a, b] = TET_EDGES[edge];
            4.0 * (l[a] * rates[b] + l[b] * rates[a])
        }
    })
}

impl SolidMesh {
    /// The quadratic tetrahedra with the same straight edges.
    ///
    /// # Panics
    /// When a face's edge belongs to no tetrahedron.
    #[must_use]
    pub fn straight(mesh: &TetMesh) -> Self {
        let mut positions = mesh.positions.clone();
        let mut midpoints: HashMap<[u32; 2], u32> = HashMap::new();
        let tetrahedron = |corners: &[u32; 4]| {
            let mut nodes = [0; 10];
            nodes[..4].copy_from_slice(corners);
            for (k, [a, b]) in TET_EDGES.into_iter().enumerate() {
                let [a, b] = [corners[a], corners[b]];
                nodes[4 + k] = *midpoints.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                    positions.push(0.5 * (positions[a as usize] + positions[b as usize]));
                    positions.len() as u32 - 1
                });
            }
            nodes
        };
        let tetrahedra = mesh.tetrahedra.iter().map(tetrahedron).collect();
        let face = |corners: &[u32; 3]| {
            let mut nodes = [0; 6];
            nodes[..3].copy_from_slice(corners);
            for (k, [a, b]) in FACE_EDGES.into_iter().enumerate() {
                let [a, b] = [corners[a], corners[b]];
                nodes[3 + k] = midpoints[&[a.min(b), a.max(b)]];
            }
            nodes
        };
        Self {
            corners: mesh.positions.len(),
            tetrahedra,
            chamber: mesh.chamber.iter().map(face).collect(),
            outer: mesh.outer.iter().map(face).collect(),
            positions,
            lids: Vec::new(),
            materials: Vec::new(),
        }
    }

    /// The mean of the corners of each tetrahedron at rest, mm.
    pub fn centres(&self) -> impl Iterator<Item = Vec3> {
        let centre = |nodes: &[u32; 10]| {
            nodes[..4].iter().map(|&node| self.positions[node as usize]).sum::<Vec3>() / 4.0
        };
        self.tetrahedra.iter().map(centre)
    }

    /// All unknowns of `nodes`, `3 node + axis`.
    #[must_use]
    pub fn unknowns_of(nodes: &[u32]) -> Vec<u32> {
        nodes.iter().flat_map(|node| [3 * node, 3 * node + 1, 3 * node + 2]).collect()
    }

    /// All faces of the boundary, with normals out of the body.
    pub fn faces(&self) -> impl Iterator<Item = [u32; 6]> {
        let reversed = |&[a, b, c, bc, ca, ab]: &[u32; 6]| [a, c, b, bc, ab, ca];
        self.outer.iter().copied().chain(self.chamber.iter().map(reversed))
    }

    /// The triangles between the corners of the boundary, and the node of each of their vertices `[vertices]`, ascending.
    #[must_use]
    pub fn boundary(&self) -> (TriangleMesh, Vec<u32>) {
        let corners = |face: [u32; 6]| [face[0], face[1], face[2]];
        let mut nodes: Vec<u32> = self.faces().flat_map(corners).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let vertex = |node: u32| nodes.partition_point(|&before| before < node) as u32;
        let triangles = self.faces().map(|face| corners(face).map(vertex)).collect();
        let positions = nodes.iter().map(|&node| self.positions[node as usize]).collect();
        (TriangleMesh { positions, triangles }, nodes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two tetrahedra that share a face share its midpoints, and their faces find theirs.
    #[test]
    fn midpoints_are_shared() {
        let positions = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.], [1., 1., 1.]];
        let mesh = TetMesh {
            positions: positions.map(Vec3::from).to_vec(),
            tetrahedra: vec![[0, 1, 2, 3], [1, 2, 3, 4]],
            chamber: vec![[0, 1, 2]],
            outer: vec![[1, 4, 2]],
        };
        let solid = SolidMesh::straight(&mesh);
        // 6 + 6 edges less the 3 of the shared face.
        assert_eq!((solid.corners, solid.positions.len()), (5, 14));
        for nodes in &solid.tetrahedra {
            for (k, [a, b]) in TET_EDGES.into_iter().enumerate() {
                let [a, b, middle] =
                    [nodes[a], nodes[b], nodes[4 + k]].map(|v| solid.positions[v as usize]);
                assert_eq!(0.5 * (a + b), middle);
            }
        }
        for nodes in solid.chamber.iter().chain(&solid.outer) {
            for (k, [a, b]) in FACE_EDGES.into_iter().enumerate() {
                let [a, b, middle] =
                    [nodes[a], nodes[b], nodes[3 + k]].map(|v| solid.positions[v as usize]);
                assert_eq!(0.5 * (a + b), middle);
            }
        }
    }
}
