//! Tetrahedra as a file lists them, before anything is known of them.

use std::collections::HashMap;

use super::marks::Marks;
use crate::math::Vec3;
use crate::mesh::{SolidMesh, TET_EDGES, TetMesh};

/// Vertices, tetrahedra and triangles of a file, and their groups.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct RawSolid {
    /// All nodes, used or not.
    pub(super) positions: Vec<Vec3>,
    /// Corners of each tetrahedron, turned either way.
    pub(super) tetrahedra: Vec<[u32; 4]>,
    /// Edge midpoints of each tetrahedron in the order of [`TET_EDGES`]; none at all for linear ones.
    pub(super) midpoints: Vec<[u32; 6]>,
    /// Sorted corners of triangles, each with its set of [`Self::surfaces`].
    pub(super) triangles: Vec<([u32; 3], u32)>,
    /// Physical groups of triangles.
    pub(super) surfaces: Marks,
    /// Physical groups of tetrahedra.
    pub(super) volumes: Marks,
}

impl RawSolid {
    /// The quadratic tetrahedra of `mesh`, whose vertices have the `former` numbers, with the file's midpoints where it has them.
    ///
    /// # Errors
    /// One line when neighbours differ on a midpoint, or it has no place.
    pub(super) fn quadratic(&self, mesh: &TetMesh, former: &[u32]) -> Result<SolidMesh, String> {
        let mut solid = SolidMesh::straight(mesh);
        let ordered = |[v, w]: [u32; 2]| [v.min(w), v.max(w)];
        let mut given: HashMap<[u32; 2], u32> = HashMap::new();
        for (corners, midpoints) in self.tetrahedra.iter().zip(&self.midpoints) {
            for ([i, j], &midpoint) in TET_EDGES.into_iter().zip(midpoints) {
                let edge = ordered([corners[i], corners[j]]);
                if *given.entry(edge).or_insert(midpoint) != midpoint {
                    return Err(
                        "neighbouring tetrahedra have different nodes on a common edge".to_owned()
                    );
                }
            }
        }
        if !given.is_empty() {
            for nodes in &solid.tetrahedra {
                for (k, [i, j]) in TET_EDGES.into_iter().enumerate() {
                    let edge = [nodes[i], nodes[j]].map(|v| former[v as usize]);
                    let midpoint = given[&ordered(edge)];
                    solid.positions[nodes[4 + k] as usize] = self.position(midpoint)?;
                }
            }
        }
        Ok(solid)
    }

    fn position(&self, node: u32) -> Result<Vec3, String> {
        let position = self.positions.get(node as usize).copied();
        let position = position.filter(|x| x.iter().all(|x| x.is_finite()));
        position.ok_or_else(|| "a midpoint is not a node with finite coordinates".to_owned())
    }
}
