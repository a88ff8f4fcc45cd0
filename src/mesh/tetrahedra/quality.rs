//! Figures of a mesh of tetrahedra.

use serde::{Deserialize, Serialize};

use super::boundary::{edge_lengths, faces, sorted, volume};
use crate::math::{Vec3, angle_between};
use crate::mesh::{TET_EDGES, TetMesh, WallSurfaces};

/// Number, shape and arrangement of the tetrahedra that fill a wall.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TetQuality {
    /// Number of tetrahedra.
    pub tetrahedra: usize,
    /// Number of corners.
    pub vertices: usize,
    /// Number of faces on the chamber.
    pub chamber_faces: usize,
    /// Number of all other faces of the boundary.
    pub outer_faces: usize,
    /// Smallest dihedral angle, degrees; 70.5 in a regular tetrahedron.
    pub dihedral_min: f64,
    /// The smallest dihedral angle of a tetrahedron: a hundredth of them have a smaller one, degrees.
    pub dihedral_1_percent: f64,
    /// As before, of a twentieth of them.
    pub dihedral_5_percent: f64,
    /// Largest dihedral angle, degrees.
    pub dihedral_max: f64,
    /// Circumscribed radius over shortest edge, in the median; 0.61 in a regular tetrahedron.
    pub radius_edge_median: f64,
    /// Largest circumscribed radius over shortest edge.
    pub radius_edge_max: f64,
    /// Smallest volume, mm^3.
    pub volume_min: f64,
    /// Largest volume, mm^3.
    pub volume_max: f64,
    /// Volume of all, mm^3.
    pub volume: f64,
    /// By which share the volume differs from that between the surfaces.
    pub volume_error: f64,
    /// Fewest edges on a way from the chamber to a vertex of the outside: elements through the wall where it has fewest.
    pub layers_min: usize,
    /// The mean of these numbers of edges over the vertices of the outside.
    pub layers_mean: f64,
    /// Tetrahedra with all corners on the boundary: none of their edge midpoints need be free of it, which matters where it is held.
    pub without_inner_corner: usize,
    /// Tetrahedra with all corners on one of the two surfaces: they bridge a fold of it.
    pub one_sided: usize,
    /// Tetrahedra with two faces or more on the boundary.
    pub cornered: usize,
}

impl TetQuality {
    /// The figures of `mesh`, which fills `wall`.
    ///
    /// # Panics
    /// When `mesh` has no tetrahedron.
    #[must_use]
    pub fn of(mesh: &TetMesh, wall: &WallSurfaces) -> Self {
        let count = mesh.tetrahedra.len();
        let corners = || (0..count).map(|t| mesh.corners(t));
        let (mut smallest, mut dihedral_max) = (Vec::with_capacity(count), 0.0f64);
        for angles in corners().map(dihedral_angles) {
            smallest.push(angles.into_iter().fold(f64::INFINITY, f64::min));
            dihedral_max = angles.into_iter().fold(dihedral_max, f64::max);
        }
        smallest.sort_unstable_by(f64::total_cmp);
        let mut radius_edge: Vec<f64> = corners().map(radius_edge).collect();
        radius_edge.sort_unstable_by(f64::total_cmp);
        let volumes: Vec<f64> = corners().map(volume).collect();
        let total: f64 = volumes.iter().sum();
        let asked = wall.outer.volume() - wall.chamber.volume();
        let layers = layers(mesh);
        let [without_inner_corner, one_sided, cornered] = on_the_boundary(mesh);
        Self {
            tetrahedra: count,
            vertices: mesh.positions.len(),
            chamber_faces: mesh.chamber.len(),
            outer_faces: mesh.outer.len(),
            dihedral_min: smallest[0],
            dihedral_1_percent: smallest[count / 100],
            dihedral_5_percent: smallest[count / 20],
            dihedral_max,
            radius_edge_median: radius_edge[count / 2],
            radius_edge_max: radius_edge[count - 1],
            volume_min: volumes.iter().copied().fold(f64::INFINITY, f64::min),
            volume_max: volumes.iter().copied().fold(0.0, f64::max),
            volume: total,
            volume_error: (total - asked).abs() / asked,
            layers_min: layers.iter().copied().min().unwrap_or(0),
            layers_mean: layers.iter().sum::<usize>() as f64 / layers.len().max(1) as f64,
            without_inner_corner,
            one_sided,
            cornered,
        }
    }
}

/// The angles between the faces at each edge, degrees, in the order of [`TET_EDGES`].
fn dihedral_angles(corners: [Vec3; 4]) -> [f64; 6] {
    TET_EDGES.map(|[i, j]| {
        let [k, l] = opposite(i, j);
        let edge = corners[j] - corners[i];
        let [m, n] = [k, l].map(|v| edge.cross(&(corners[v] - corners[i])));
        angle_between(m, n).to_degrees()
    })
}

/// The two corners that are not on an edge.
fn opposite(i: usize, j: usize) -> [usize; 2] {
    let mut others = (0..4).filter(|&v| v != i && v != j);
    [(); 2].map(|()| others.next().expect("four corners less two"))
}

/// The circumscribed radius over the shortest edge.
///
/// ```text
/// R = |a^2 (b x c) + b^2 (c x a) + c^2 (a x b)| / (2 |a . b x c|)        a, b, c: edges from one corner
/// ```
fn radius_edge(corners: [Vec3; 4]) -> f64 {
    let [a, b, c] = [1, 2, 3].map(|v| corners[v] - corners[0]);
    let (bc, ca, ab) = (b.cross(&c), c.cross(&a), a.cross(&b));
    let sum = a.norm_squared() * bc + b.norm_squared() * ca + c.norm_squared() * ab;
    let shortest = edge_lengths(corners).into_iter().fold(f64::INFINITY, f64::min);
    sum.norm() / (2.0 * a.dot(&bc).abs()) / shortest
}

/// The number of edges on the shortest way from the chamber to each vertex of the outside that there is a way to.
fn layers(mesh: &TetMesh) -> Vec<usize> {
    let mut neighbours: Vec<[u32; 2]> = mesh
        .tetrahedra
        .iter()
        .flat_map(|corners| TET_EDGES.map(|[i, j]| [corners[i], corners[j]]))
        .flat_map(|[v, w]| [[v, w], [w, v]])
        .collect();
    neighbours.sort_unstable();
    neighbours.dedup();
    let mut distance: Vec<Option<usize>> = vec![None; mesh.positions.len()];
    let mut front: Vec<u32> = mesh.chamber.iter().flatten().copied().collect();
    let mut edges = 0;
    while !front.is_empty() {
        front.retain(|&v| distance[v as usize].is_none());
        front.iter().for_each(|&v| distance[v as usize] = Some(edges));
        let around = |v: u32| {
            let first = neighbours.partition_point(|&[from, _]| from < v);
            neighbours[first..].iter().take_while(move |&&[from, _]| from == v).map(|&[_, to]| to)
        };
        front = front.iter().flat_map(|&v| around(v)).collect();
        edges += 1;
    }
    let mut outer: Vec<u32> = mesh.outer.iter().flatten().copied().collect();
    outer.sort_unstable();
    outer.dedup();
    outer.iter().filter_map(|&v| distance[v as usize]).collect()
}

/// Tetrahedra with all corners on the boundary, with all on one surface, with two faces or more on the boundary.
fn on_the_boundary(mesh: &TetMesh) -> [usize; 3] {
    const CHAMBER: u8 = 1;
    const OUTER: u8 = 2;
    let mut sides = vec![0u8; mesh.positions.len()];
    mesh.chamber.iter().flatten().for_each(|&v| sides[v as usize] |= CHAMBER);
    mesh.outer.iter().flatten().for_each(|&v| sides[v as usize] |= OUTER);
    let mut boundary: Vec<[u32; 3]> =
        mesh.chamber.iter().chain(&mesh.outer).map(|&face| sorted(face)).collect();
    boundary.sort_unstable();
    let mut counts = [0; 3];
    for &corners in &mesh.tetrahedra {
        let common = corners.iter().fold(CHAMBER | OUTER, |common, &v| common & sides[v as usize]);
        let outside = faces(corners)
            .into_iter()
            .filter(|&face| boundary.binary_search(&sorted(face)).is_ok());
        counts[0] += usize::from(corners.iter().all(|&v| sides[v as usize] != 0));
        counts[1] += usize::from(common != 0);
        counts[2] += usize::from(outside.count() >= 2);
    }
    counts
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::mesh::tetrahedra::test_walls::{of_prisms, spheres};

    #[test]
    fn figures_of_two_known_tetrahedra() {
        let regular =
            [[1., 1., 1.], [-1., -1., 1.], [-1., 1., -1.], [1., -1., -1.]].map(Vec3::from);
        for angle in dihedral_angles(regular) {
            assert_relative_eq!(angle, (1.0f64 / 3.0).acos().to_degrees(), max_relative = 1e-14);
        }
        // R = sqrt(3), edges sqrt(8).
        assert_relative_eq!(radius_edge(regular), (3.0f64 / 8.0).sqrt(), max_relative = 1e-14);
        let corner = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]].map(Vec3::from);
        let slope = 2f64.sqrt().atan().to_degrees();
        let expected = [90.0, slope, 90.0, 90.0, slope, slope];
        for (angle, expected) in dihedral_angles(corner).into_iter().zip(expected) {
            assert_relative_eq!(angle, expected, max_relative = 1e-14);
        }
        assert_relative_eq!(radius_edge(corner), 0.75f64.sqrt(), max_relative = 1e-14);
    }

    /// One layer of prisms, then two: their middle vertices are a way of two edges from either side.
    #[test]
    fn layers_are_counted() {
        let (inner, outer) = (spheres(9.0, 8.0, 2), spheres(10.0, 9.0, 2));
        let one = TetQuality::of(&of_prisms(&inner), &inner);
        assert_eq!((one.layers_min, one.layers_mean), (1, 1.0));
        let count = one.tetrahedra;
        assert_eq!((one.without_inner_corner, one.one_sided, one.cornered), (count, 0, 0));
        assert!(one.volume_error < 1e-12);

        let [below, above] = [&inner, &outer].map(of_prisms);
        let n = inner.outer.positions.len() as u32;
        let positions = [&below.positions[..], &above.positions[n as usize..]].concat();
        let shifted = above.tetrahedra.iter().map(|t| t.map(|v| v + n));
        let tetrahedra: Vec<_> = below.tetrahedra.iter().copied().chain(shifted).collect();
        let mesh =
            TetMesh::of_tetrahedra(&positions, &tetrahedra, |face| face[2] < n).unwrap().mesh;
        let two = TetQuality::of(&mesh, &spheres(10.0, 8.0, 2));
        assert_eq!((two.layers_min, two.layers_mean), (2, 2.0));
        assert_eq!((two.tetrahedra, two.without_inner_corner, two.one_sided), (2 * count, 0, 0));
    }
}
