//! Ordered neighbourhoods of a closed triangle mesh, listed once because every element asks for them.

use crate::surface::{HalfEdges, MeshDefect};

/// The neighbours of every vertex, counter-clockwise seen from outside.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Rings {
    rings: Vec<Vec<u32>>,
}

impl Rings {
    /// The rings of `triangles` over the vertices `0..vertices`.
    ///
    /// # Errors
    /// [`MeshDefect`] unless the triangles form closed, consistently oriented 2-manifolds.
    pub fn new(vertices: usize, triangles: &[[u32; 3]]) -> Result<Self, MeshDefect> {
        let adjacency = HalfEdges::new(vertices, triangles)?;
        Ok(Self { rings: (0..vertices as u32).map(|v| adjacency.ring(v).collect()).collect() })
    }

    /// Rings already in order.
    pub(super) fn from_ordered(rings: Vec<Vec<u32>>) -> Self {
        Self { rings }
    }

    /// The number of vertices.
    #[must_use]
    pub fn len(&self) -> usize {
        self.rings.len()
    }

    /// Whether there are no vertices.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.rings.is_empty()
    }

    /// The neighbours of `vertex`, in order.
    #[must_use]
    pub fn ring(&self, vertex: u32) -> &[u32] {
        &self.rings[vertex as usize]
    }

    /// The ring of `vertex`, beginning at its neighbour `first`.
    fn ring_from(&self, vertex: u32, first: u32) -> impl Iterator<Item = u32> {
        let ring = self.ring(vertex);
        let start = ring.iter().position(|&v| v == first).expect("the neighbour is in the ring");
        ring[start..].iter().chain(&ring[..start]).copied()
    }
}

/// The control points of one triangle: its corners and their rings.
///
/// In order: the three corners; the ring of corner 0 beyond corners 1 and 2; then what the rings of
/// corners 1 and 2 add. Around a corner of valence 3, or on a very coarse mesh, a node may appear twice.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stencil {
    /// Valences of the corners.
    pub valences: [usize; 3],
    /// Control points.
    pub nodes: Vec<u32>,
}

impl Stencil {
    /// The stencil of `triangle`.
    #[must_use]
    pub fn new(triangle: [u32; 3], rings: &Rings) -> Self {
        let valences = triangle.map(|v| rings.ring(v).len());
        let local = Self::local_rings(valences);
        let mut nodes = vec![u32::MAX; Self::local_size(valences)];
        nodes[..3].copy_from_slice(&triangle);
        for i in 0..3 {
            let ring = rings.ring_from(triangle[i], triangle[(i + 1) % 3]);
            for (&index, node) in local[i].iter().zip(ring) {
                nodes[index] = node;
            }
        }
        Self { valences, nodes }
    }

    /// The corners of the triangle.
    #[must_use]
    pub fn corners(&self) -> [u32; 3] {
        [self.nodes[0], self.nodes[1], self.nodes[2]]
    }

    /// The number of control points of a triangle whose corners have these valences.
    #[must_use]
    pub fn local_size([n0, n1, n2]: [usize; 3]) -> usize {
        n0 + n1 - 2 + n2.max(4) - 4
    }

    /// The rings of the three corners as positions in a stencil; ring `i` begins with corners `i + 1`, `i + 2`.
    #[must_use]
    pub fn local_rings([n0, n1, n2]: [usize; 3]) -> [Vec<usize>; 3] {
        // Opposite corners of the neighbouring triangles: a1 across (2, 0), a2 across (0, 1), a0 across (1, 2).
        let a1 = 3;
        let a2 = n0;
        let a0 = n0 + n1 - 3;
        let ring0 = [1, 2].into_iter().chain(a1..=a2).collect();
        let ring1 = [2, 0, a2].into_iter().chain(a2 + 1..=a0).collect();
        let closing = (n2 > 3).then_some(a1);
        let ring2 =
            [0, 1, a0].into_iter().chain(a0 + 1..a0 + n2.max(4) - 3).chain(closing).collect();
        [ring0, ring1, ring2]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn local_rings_have_the_lengths_of_the_valences() {
        for valences in
            [[6, 6, 6], [4, 5, 7], [4, 4, 4], [9, 8, 4], [3, 5, 6], [5, 3, 4], [6, 7, 3]]
        {
            let rings = Stencil::local_rings(valences);
            let largest = rings.iter().flatten().max();
            assert_eq!(largest, Some(&(Stencil::local_size(valences) - 1)));
            assert_eq!(rings.map(|ring| ring.len()), valences);
        }
    }

    /// On an octahedron every stencil is the whole mesh.
    #[test]
    fn stencils_of_an_octahedron_hold_every_vertex() {
        let triangles = [
            [0, 2, 4],
            [2, 1, 4],
            [1, 3, 4],
            [3, 0, 4],
            [2, 0, 5],
            [1, 2, 5],
            [3, 1, 5],
            [0, 3, 5],
        ];
        let rings = Rings::new(6, &triangles).unwrap();
        let around_4: Vec<u32> = rings.ring_from(4, 0).collect();
        assert_eq!(around_4, [0, 2, 1, 3]);
        for triangle in triangles {
            let mut nodes = Stencil::new(triangle, &rings).nodes;
            nodes.sort_unstable();
            assert_eq!(nodes, [0, 1, 2, 3, 4, 5]);
        }
    }
}
