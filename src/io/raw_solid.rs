//! Tetrahedra as a file lists them, before anything is known of them.

use std::collections::{HashMap, HashSet};

use crate::math::Vec3;
use crate::mesh::tetrahedra::{Numbered, TetDefect};
use crate::mesh::{SolidMesh, TET_EDGES, TetMesh};
use crate::surface::turned_outward;

/// Vertices, tetrahedra and marked triangles of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct RawSolid {
    /// All nodes, used or not.
    pub(super) positions: Vec<Vec3>,
    /// Corners of each tetrahedron, turned either way.
    pub(super) tetrahedra: Vec<[u32; 4]>,
    /// Edge midpoints of each tetrahedron in the order of [`TET_EDGES`]; none at all for linear ones.
    pub(super) midpoints: Vec<[u32; 6]>,
    /// Sorted corners of the triangles marked as the chamber's; `None` when the file marks none.
    pub(super) chamber: Option<HashSet<[u32; 3]>>,
}

impl RawSolid {
    /// The mesh with straight edges, its chamber where the triangles are marked.
    ///
    /// # Errors
    /// [`TetDefect`] when the tetrahedra do not fit together.
    pub(super) fn numbered(&self) -> Result<Numbered, TetDefect> {
        let is_chamber =
            |face: [u32; 3]| self.chamber.as_ref().is_some_and(|chamber| chamber.contains(&face));
        TetMesh::of_tetrahedra(&self.positions, &self.tetrahedra, is_chamber)
    }

    /// The quadratic mesh, with the file's midpoints where it has them.
    ///
    /// Tetrahedra may overlap each other, as they do in walls made by moving nodes; the chamber is turned one way nonetheless, so that
    /// its pressure has a potential.
    ///
    /// # Errors
    /// One line when the tetrahedra do not fit together, or the chamber is not a closed part of their boundary.
    pub(super) fn solid(&self) -> Result<SolidMesh, String> {
        let Numbered { mesh, former } = self.with_chamber()?;
        let mut solid = SolidMesh::straight(&mesh);
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

    fn with_chamber(&self) -> Result<Numbered, String> {
        let Numbered { mut mesh, former } = self.numbered().map_err(|defect| defect.to_string())?;
        match &self.chamber {
            None => mesh = mesh.with_chamber_found(),
            Some(marked) if marked.len() != mesh.chamber.len() => {
                return Err(format!(
                    "{} of the {} triangles marked as the chamber are not on the boundary of the tetrahedra",
                    marked.len() - mesh.chamber.len(),
                    marked.len()
                ));
            }
            Some(_) => {}
        }
        let open = open_edges(&mesh.chamber);
        if open > 0 {
            return Err(format!(
                "the chamber is not closed: {open} of its edges have not two triangles"
            ));
        }
        mesh.chamber = turned_outward(&mesh.chamber, &mesh.positions)
            .ok_or_else(|| "the chamber has no inside: it is one-sided".to_owned())?;
        Ok(Numbered { mesh, former })
    }
}

/// The number of edges without exactly two of the `triangles`, whichever way these face.
fn open_edges(triangles: &[[u32; 3]]) -> usize {
    let edges = |&[a, b, c]: &[u32; 3]| [[a, b], [b, c], [c, a]];
    let mut edges: Vec<[u32; 2]> =
        triangles.iter().flat_map(edges).map(|[v, w]| [v.min(w), v.max(w)]).collect();
    edges.sort_unstable();
    edges.chunk_by(|a, b| a == b).filter(|same| same.len() != 2).count()
}
