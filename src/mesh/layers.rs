//! Solid meshes of bodies that a formula describes: layers of prisms over triangles, each cut into three tetrahedra.
//!
//! ```text
//!    a'---c'        base (a, b, c), seen from above counter-clockwise; a < b < c in the order of vertices:
//!    | \ /|          a b c c',  a b b' c',  a a' b' c'
//!    |  b' |
//!    a--|--c        On the side over an edge the diagonal rises from its lower vertex, so that neighbours fit.
//!     \ | /
//!       b           layer 0 .. n lifts a point of the base to the height 0 .. 1
//! ```
//!
//! The formula places corners and edge midpoints alike, so that curved bodies have curved cells.

use std::collections::HashMap;

use super::{SolidMesh, TET_EDGES, TetMesh};
use crate::math::Vec3;
use crate::surface::TriangleMesh;

impl SolidMesh {
    /// The body `place(x, height)` over the points `x` of `base`, open or closed, at heights of 0 to 1 in so many `layers`.
    ///
    /// The faces at a height of 0 are the chamber's, all others are outer ones.
    ///
    /// # Panics
    /// When there is no layer, or an edge of `base` belongs to two triangles in the same direction.
    #[must_use]
    pub fn layers(base: &TriangleMesh, layers: usize, place: &dyn Fn(Vec3, f64) -> Vec3) -> Self {
        assert!(layers > 0, "a body has layers");
        let vertices = base.positions.len() as u32;
        let lifted =
            |layer: usize| base.positions.iter().map(move |&x| (x, layer as f64 / layers as f64));
        let corners: Vec<(Vec3, f64)> = (0..=layers).flat_map(lifted).collect();
        let mut tetrahedra = Vec::with_capacity(3 * layers * base.triangles.len());
        let mut outer = Vec::new();
        for layer in 0..layers as u32 {
            let up = |v: u32| v + vertices;
            let level = |v: u32| v + layer * vertices;
            for triangle in &base.triangles {
                tetrahedra.extend(prism(triangle.map(level), up));
            }
            for [a, b] in open_edges(base).map(|edge| edge.map(level)) {
                outer.extend(if a < b {
                    [[a, b, up(b)], [a, up(b), up(a)]]
                } else {
                    [[a, b, up(a)], [b, up(b), up(a)]]
                });
            }
        }
        let top = layers as u32 * vertices;
        outer.extend(base.triangles.iter().map(|triangle| triangle.map(|v| v + top)));
        let straight = TetMesh {
            positions: corners.iter().map(|&(x, _)| x).collect(),
            tetrahedra,
            chamber: base.triangles.clone(),
            outer,
        };
        Self::straight(&straight).placed(&corners, place)
    }

    /// The body `place(x)` over the unit cube in so many cells along each axis, each of six tetrahedra about its diagonal;
    /// all faces are outer ones.
    ///
    /// # Panics
    /// When there is no cell.
    #[must_use]
    pub fn block(cells: [usize; 3], place: &dyn Fn(Vec3) -> Vec3) -> Self {
        let [n, m, layers] = cells;
        let base = unit_lattice([n, m]);
        let mut mesh = Self::layers(&base, layers, &|x, height| place(x + height * Vec3::z()));
        mesh.outer = mesh.faces().collect();
        mesh.chamber.clear();
        mesh
    }

    /// Nodes at rest where `is_wanted`, ascending.
    #[must_use]
    pub fn nodes_where(&self, is_wanted: impl Fn(&Vec3) -> bool) -> Vec<u32> {
        let nodes = (0u32..).zip(&self.positions);
        nodes.filter_map(|(node, x)| is_wanted(x).then_some(node)).collect()
    }

    /// Faces of the boundary whose nodes are all where `is_wanted`, with normals out of the body.
    #[must_use]
    pub fn faces_where(&self, is_wanted: impl Fn(&Vec3) -> bool) -> Vec<[u32; 6]> {
        let wanted =
            |face: &[u32; 6]| face.iter().all(|&node| is_wanted(&self.positions[node as usize]));
        self.faces().filter(wanted).collect()
    }

    /// The same cells with all nodes placed, given base point and height of the corners.
    fn placed(mut self, corners: &[(Vec3, f64)], place: &dyn Fn(Vec3, f64) -> Vec3) -> Self {
        let mut parameters = corners.to_vec();
        parameters.resize(self.positions.len(), (Vec3::zeros(), 0.0));
        for nodes in &self.tetrahedra {
            for (middle, [a, b]) in nodes[4..].iter().zip(TET_EDGES) {
                let [(xa, ha), (xb, hb)] = [a, b].map(|k| corners[nodes[k] as usize]);
                parameters[*middle as usize] = (0.5 * (xa + xb), 0.5 * (ha + hb));
            }
        }
        for (position, (x, height)) in self.positions.iter_mut().zip(parameters) {
            *position = place(x, height);
        }
        self
    }
}

/// The unit square, seen from above, in so many cells along x and y, each cut into two triangles along its diagonal.
///
/// # Panics
/// When there is no cell.
#[must_use]
pub fn unit_lattice([n, m]: [usize; 2]) -> TriangleMesh {
    assert!(n > 0 && m > 0, "a lattice has cells");
    let at = |i: usize, j: usize| Vec3::new(i as f64 / n as f64, j as f64 / m as f64, 0.0);
    let vertex = |i: usize, j: usize| (i + j * (n + 1)) as u32;
    let cell = |i: usize, j: usize| {
        let [a, b, c, d] = [vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    TriangleMesh {
        positions: (0..=m).flat_map(|j| (0..=n).map(move |i| at(i, j))).collect(),
        triangles: (0..m).flat_map(|j| (0..n).flat_map(move |i| cell(i, j))).collect(),
    }
}

/// The three tetrahedra of the prism over a triangle.
fn prism(triangle: [u32; 3], up: impl Fn(u32) -> u32) -> [[u32; 4]; 3] {
    let [p, q, r] = triangle;
    let mut sorted = triangle;
    sorted.sort_unstable();
    let [a, b, c] = sorted;
    let is_even = [[p, q, r], [q, r, p], [r, p, q]].contains(&sorted);
    [[a, b, c, up(c)], [a, b, up(c), up(b)], [a, up(a), up(b), up(c)]]
        .map(|[a, b, c, d]| if is_even { [a, b, c, d] } else { [a, b, d, c] })
}

/// Edges of one triangle alone, in its order.
fn open_edges(base: &TriangleMesh) -> impl Iterator<Item = [u32; 2]> {
    let mut edges = HashMap::new();
    for (k, &[a, b, c]) in base.triangles.iter().enumerate() {
        for (l, edge) in [[a, b], [b, c], [c, a]].into_iter().enumerate() {
            let before = edges.insert(edge, 3 * k + l);
            assert!(before.is_none(), "the triangles of a base face the same way");
        }
    }
    let is_open = |&([a, b], _): &([u32; 2], usize)| !edges.contains_key(&[b, a]);
    let mut open: Vec<_> = edges.iter().map(|(&edge, &k)| (edge, k)).filter(is_open).collect();
    open.sort_unstable_by_key(|&(_, k)| k);
    open.into_iter().map(|(edge, _)| edge)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::f64::consts::PI;

    use approx::assert_relative_eq;

    use super::*;

    fn corner_volume(mesh: &SolidMesh, nodes: &[u32; 10]) -> f64 {
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| mesh.positions[nodes[k] as usize]);
        (b - a).dot(&(c - a).cross(&(d - a))) / 6.0
    }

    /// Every face of a cell is another cell's, turned round, or one of the boundary's as it is.
    fn check_conforming(mesh: &SolidMesh) {
        let key = |mut face: [u32; 3]| {
            let start = (0..3).min_by_key(|&k| face[k]).unwrap();
            face.rotate_left(start);
            face
        };
        let mut faces = BTreeMap::new();
        for nodes in &mesh.tetrahedra {
            // With normals out of a positive tetrahedron.
            for [a, b, c] in [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]] {
                *faces.entry(key([nodes[a], nodes[b], nodes[c]])).or_insert(0) += 1;
            }
            for (k, [a, b]) in TET_EDGES.into_iter().enumerate() {
                assert!(nodes[4 + k] as usize >= mesh.corners);
                assert!(nodes[a] != nodes[b]);
            }
        }
        assert!(faces.values().all(|&count| count == 1));
        let mut boundary: Vec<[u32; 3]> = mesh.faces().map(|f| key([f[0], f[1], f[2]])).collect();
        boundary.sort_unstable();
        let open: Vec<[u32; 3]> = faces
            .keys()
            .copied()
            .filter(|&[a, b, c]| !faces.contains_key(&key([a, c, b])))
            .collect();
        assert_eq!(open, boundary);
    }

    #[test]
    fn block_fills_its_box() {
        let sides = Vec3::new(3.0, 2.0, 5.0);
        let mesh = SolidMesh::block([3, 2, 4], &|x| x.component_mul(&sides));
        assert_eq!((mesh.tetrahedra.len(), mesh.corners), (6 * 24, 4 * 3 * 5));
        // All points of the lattice of half the cells.
        assert_eq!(mesh.positions.len(), 7 * 5 * 9);
        check_conforming(&mesh);
        let volumes = mesh.tetrahedra.iter().map(|nodes| corner_volume(&mesh, nodes));
        for volume in volumes {
            assert_relative_eq!(volume, 30.0 / 144.0, max_relative = 1e-13);
        }
        assert_eq!(mesh.nodes_where(|x| x.z == 5.0).len(), 7 * 5);
        let top = mesh.faces_where(|x| x.z == 5.0);
        assert_eq!(top.len(), 2 * 6);
        for face in top {
            let [a, b, c] = [0, 1, 2].map(|k| mesh.positions[face[k] as usize]);
            assert!((b - a).cross(&(c - a)).z > 0.0);
        }
    }

    /// Layers over a closed surface have no rim; all nodes lie on their spheres.
    #[test]
    fn layers_of_a_sphere_are_round() {
        let place = |x: Vec3, height: f64| (2.0 + height) * x.normalize();
        let mesh = SolidMesh::layers(&TriangleMesh::sphere(1.0, 1), 2, &place);
        check_conforming(&mesh);
        assert_eq!(mesh.tetrahedra.len(), 80 * 2 * 3);
        assert_eq!((mesh.chamber.len(), mesh.outer.len()), (80, 80));
        assert!(mesh.tetrahedra.iter().all(|nodes| corner_volume(&mesh, nodes) > 0.0));
        for radius in mesh.positions.iter().map(Vec3::norm) {
            let layer = 4.0 * (radius - 2.0);
            assert!((layer - layer.round()).abs() < 1e-12, "{radius}");
        }
        for (faces, radius) in [(&mesh.chamber, 2.0), (&mesh.outer, 3.0)] {
            for node in faces.iter().flatten() {
                let position = mesh.positions[*node as usize];
                assert_relative_eq!(position.norm(), radius, max_relative = 1e-14);
            }
            let corners = |f: &[u32; 6]| [f[0], f[1], f[2]];
            let surface = TriangleMesh {
                positions: mesh.positions.clone(),
                triangles: faces.iter().map(corners).collect(),
            };
            // Both face out of the chamber; chords of a quarter of the radius lose 9 % of the volume.
            let exact = 4.0 / 3.0 * PI * f64::powi(radius, 3);
            assert!(surface.volume() > 0.85 * exact && surface.volume() < exact);
        }
    }

    #[test]
    #[should_panic(expected = "face the same way")]
    fn a_base_that_is_not_oriented_is_refused() {
        let base = TriangleMesh {
            positions: vec![Vec3::zeros(), Vec3::x(), Vec3::y(), Vec3::new(1.0, 1.0, 0.0)],
            triangles: vec![[0, 1, 2], [1, 2, 3]],
        };
        let _ = SolidMesh::layers(&base, 1, &|x, height| x + height * Vec3::z());
    }
}
