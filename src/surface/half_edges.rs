//! Who is beside whom on a closed triangle surface.
//!
//! Half-edge `3 t + c` runs from corner `c` of triangle `t` to the next corner, with the triangle on
//! its left seen from outside; its twin runs back in the neighbouring triangle.

use super::{MeshDefect, TriangleMesh};

/// The half-edges of a closed, consistently oriented 2-manifold of triangles.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HalfEdges {
    /// The vertex where each half-edge starts, `[3 triangles]`.
    pub(super) origins: Vec<u32>,
    /// The half-edge back along the same edge, `[3 triangles]`.
    pub(super) twins: Vec<u32>,
    /// One half-edge that starts at each vertex, `[vertices]`.
    pub(super) outgoing: Vec<u32>,
}

/// No half-edge or vertex.
pub(super) const NONE: u32 = u32::MAX;

impl HalfEdges {
    /// The adjacency of `triangles` over the vertices `0..vertices`.
    ///
    /// # Errors
    /// [`MeshDefect`] unless the triangles form closed, consistently oriented 2-manifolds.
    ///
    /// # Panics
    /// When there are 2^32 half-edges or more.
    pub fn new(vertices: usize, triangles: &[[u32; 3]]) -> Result<Self, MeshDefect> {
        check_indices(vertices, triangles)?;
        let origins: Vec<u32> = triangles.iter().flatten().copied().collect();
        let half_edges = u32::try_from(origins.len()).expect("fewer than 2^32 half-edges");
        let mut outgoing = vec![NONE; vertices];
        for h in (0..half_edges).rev() {
            outgoing[origins[h as usize] as usize] = h;
        }
        let unreferenced = outgoing.iter().filter(|&&h| h == NONE).count();
        if unreferenced > 0 {
            return Err(MeshDefect::Unreferenced { vertices: unreferenced });
        }
        let twins = paired(&origins)?;
        let surface = Self { origins, twins, outgoing };
        surface.check_fans()?;
        Ok(surface)
    }

    /// The vertex where half-edge `h` starts.
    #[must_use]
    pub fn origin(&self, h: u32) -> u32 {
        self.origins[h as usize]
    }

    /// The vertex where half-edge `h` ends.
    #[must_use]
    pub fn destination(&self, h: u32) -> u32 {
        self.origin(next(h))
    }

    /// The half-edge back along the edge of `h`, in the neighbouring triangle.
    #[must_use]
    pub fn twin(&self, h: u32) -> u32 {
        self.twins[h as usize]
    }

    /// The half-edges that start at vertex `v`, counter-clockwise seen from outside.
    pub fn spokes(&self, v: u32) -> impl Iterator<Item = u32> + '_ {
        let first = self.outgoing[v as usize];
        std::iter::successors(Some(first), move |&h| {
            let left = self.twin(previous(h));
            (left != first).then_some(left)
        })
    }

    /// The neighbours of vertex `v`, counter-clockwise seen from outside.
    pub fn ring(&self, v: u32) -> impl Iterator<Item = u32> + '_ {
        self.spokes(v).map(|h| self.destination(h))
    }

    /// The number of edges that meet at vertex `v`.
    #[must_use]
    pub fn valence(&self, v: u32) -> usize {
        self.spokes(v).count()
    }

    /// The number of vertices that are neighbours of both ends of the edge of `h`; the apexes of its two
    /// triangles always are.
    #[must_use]
    pub fn shared_neighbours(&self, h: u32) -> usize {
        let (a, b) = (self.origin(h), self.destination(h));
        self.ring(a).filter(|&v| self.ring(b).any(|w| w == v)).count()
    }

    /// One half-edge of each edge, in ascending order.
    pub fn edges(&self) -> impl Iterator<Item = u32> + '_ {
        (0u32..).zip(&self.twins).filter(|&(h, &twin)| h < twin).map(|(h, _)| h)
    }

    fn check_fans(&self) -> Result<(), MeshDefect> {
        let mut corners = vec![0usize; self.outgoing.len()];
        for &v in &self.origins {
            corners[v as usize] += 1;
        }
        let pinched = (0u32..).zip(&corners).filter(|&(v, &n)| self.valence(v) != n).count();
        if pinched > 0 {
            return Err(MeshDefect::PinchedVertices { vertices: pinched });
        }
        Ok(())
    }
}

impl TryFrom<&TriangleMesh> for HalfEdges {
    type Error = MeshDefect;

    fn try_from(mesh: &TriangleMesh) -> Result<Self, MeshDefect> {
        Self::new(mesh.positions.len(), &mesh.triangles)
    }
}

/// The half-edge after `h` in its triangle.
pub(super) fn next(h: u32) -> u32 {
    if h % 3 == 2 { h - 2 } else { h + 1 }
}

/// The half-edge before `h` in its triangle.
pub(super) fn previous(h: u32) -> u32 {
    if h.is_multiple_of(3) { h + 2 } else { h - 1 }
}

fn check_indices(vertices: usize, triangles: &[[u32; 3]]) -> Result<(), MeshDefect> {
    if triangles.is_empty() {
        return Err(MeshDefect::Empty);
    }
    let beyond = |t: &&[u32; 3]| t.iter().any(|&v| v as usize >= vertices);
    let out_of_range = triangles.iter().filter(beyond).count();
    if out_of_range > 0 {
        return Err(MeshDefect::IndexOutOfRange { triangles: out_of_range });
    }
    let repeated = |&&[a, b, c]: &&[u32; 3]| a == b || b == c || c == a;
    let degenerate = triangles.iter().filter(repeated).count();
    if degenerate > 0 {
        return Err(MeshDefect::DegenerateTriangles { triangles: degenerate });
    }
    Ok(())
}

/// The twin of each half-edge.
fn paired(origins: &[u32]) -> Result<Vec<u32>, MeshDefect> {
    let ends = |h: u32| (origins[h as usize], origins[next(h) as usize]);
    let mut sides: Vec<(u32, u32, u32)> = (0..origins.len() as u32)
        .map(|h| (ends(h).0.min(ends(h).1), ends(h).0.max(ends(h).1), h))
        .collect();
    sides.sort_unstable();

    let mut twins = vec![NONE; origins.len()];
    let (mut open, mut branching, mut opposed) = (0, 0, 0);
    for edge in sides.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        match *edge {
            [(_, _, h), (_, _, g)] if ends(h).0 == ends(g).1 => {
                twins[h as usize] = g;
                twins[g as usize] = h;
            }
            [_] => open += 1,
            [_, _] => opposed += 1,
            _ => branching += 1,
        }
    }
    match (branching, open, opposed) {
        (0, 0, 0) => Ok(twins),
        (0, 0, edges) => Err(MeshDefect::OpposedTriangles { edges }),
        (0, edges, _) => Err(MeshDefect::OpenEdges { edges }),
        (edges, _, _) => Err(MeshDefect::BranchingEdges { edges }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

    #[test]
    fn rings_go_round_counter_clockwise() {
        let surface = HalfEdges::new(4, &TETRAHEDRON).unwrap();
        for v in 0..4 {
            let ring: Vec<u32> = surface.ring(v).collect();
            assert_eq!(ring.len(), 3);
            for k in 0..3 {
                let triangle = [v, ring[k], ring[(k + 1) % 3]];
                let found = TETRAHEDRON
                    .iter()
                    .any(|t| (0..3).any(|r| [t[r], t[(r + 1) % 3], t[(r + 2) % 3]] == triangle));
                assert!(found, "{triangle:?} is no triangle of the surface");
            }
        }
        assert_eq!(surface.edges().count(), 6);
    }

    #[test]
    fn each_defect_has_its_name() {
        let defect = |vertices, triangles: &[[u32; 3]]| HalfEdges::new(vertices, triangles).err();
        assert_eq!(defect(4, &[]), Some(MeshDefect::Empty));
        assert_eq!(defect(3, &TETRAHEDRON), Some(MeshDefect::IndexOutOfRange { triangles: 3 }));
        assert_eq!(
            defect(4, &[[0, 2, 1], [1, 1, 3]]),
            Some(MeshDefect::DegenerateTriangles { triangles: 1 })
        );
        assert_eq!(defect(6, &TETRAHEDRON), Some(MeshDefect::Unreferenced { vertices: 2 }));
        assert_eq!(defect(4, &TETRAHEDRON[..3]), Some(MeshDefect::OpenEdges { edges: 3 }));
        let turned = [[0, 1, 2], TETRAHEDRON[1], TETRAHEDRON[2], TETRAHEDRON[3]];
        assert_eq!(defect(4, &turned), Some(MeshDefect::OpposedTriangles { edges: 3 }));
    }

    #[test]
    fn surfaces_that_touch_are_no_manifold() {
        let renamed = |names: [u32; 4]| TETRAHEDRON.map(|t| t.map(|v| names[v as usize]));
        let in_a_point = [renamed([0, 1, 2, 3]), renamed([0, 4, 5, 6])].concat();
        let touching = HalfEdges::new(7, &in_a_point);
        assert_eq!(touching, Err(MeshDefect::PinchedVertices { vertices: 1 }));
        let along_an_edge = [renamed([0, 1, 2, 3]), renamed([0, 1, 4, 5])].concat();
        let branching = HalfEdges::new(6, &along_an_edge);
        assert_eq!(branching, Err(MeshDefect::BranchingEdges { edges: 1 }));
    }
}
