//! Points that make a mesher put several elements through the wall.
//!
//! Where one element reaches through the wall, its edges from chamber to outside do, and the points that divide them evenly
//! lie on the surfaces between the layers. Of these a set with a least distance is kept, short edges first: they go
//! straight through.

use std::collections::HashMap;

use super::boundary::edge_lengths;
use crate::math::Vec3;
use crate::mesh::{TET_EDGES, TetMesh};

/// Least distance of two points of one layer, as a share of the edge. Points as dense as possible at this distance have
/// about the density of a surface of that edge.
const SPACING: f64 = 0.75;

/// The vertices between `layers` layers of a wall that `mesh` fills with one, about an `edge` (mm) apart, mm.
pub(super) fn interior_points(mesh: &TetMesh, layers: usize, edge: f64) -> Vec<Vec3> {
    let through = edges_through(mesh);
    let spacing = SPACING * edge;
    (1..layers)
        .flat_map(|layer| {
            let share = layer as f64 / layers as f64;
            let point = |&(chamber, outer): &(u32, u32)| {
                let [from, to] = [chamber, outer].map(|v| mesh.positions[v as usize]);
                from + share * (to - from)
            };
            spaced(through.iter().map(point), spacing)
        })
        .collect()
}

/// The edges from a vertex of the chamber to one of the outside, by length.
fn edges_through(mesh: &TetMesh) -> Vec<(u32, u32)> {
    let on = |faces: &[[u32; 3]]| {
        let mut on = vec![false; mesh.positions.len()];
        faces.iter().flatten().for_each(|&v| on[v as usize] = true);
        on
    };
    let (chamber, outer) = (on(&mesh.chamber), on(&mesh.outer));
    let mut through: Vec<(f64, u32, u32)> = Vec::new();
    for (t, corners) in mesh.tetrahedra.iter().enumerate() {
        let lengths = edge_lengths(mesh.corners(t));
        for ([i, j], length) in TET_EDGES.into_iter().zip(lengths) {
            for (v, w) in [(corners[i], corners[j]), (corners[j], corners[i])] {
                if chamber[v as usize] && outer[w as usize] {
                    through.push((length, v, w));
                }
            }
        }
    }
    through.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    through.dedup_by_key(|&mut (_, v, w)| (v, w));
    through.into_iter().map(|(_, v, w)| (v, w)).collect()
}

/// The first of the `points`, and each that is no nearer than `spacing` to those kept before.
fn spaced(points: impl Iterator<Item = Vec3>, spacing: f64) -> Vec<Vec3> {
    let cell = |point: Vec3| -> [i64; 3] { (point / spacing).map(|x| x.floor() as i64).into() };
    let mut kept: Vec<Vec3> = Vec::new();
    let mut cells: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
    for point in points {
        let [i, j, k] = cell(point);
        let mut near =
            (0..27).filter_map(|n| cells.get(&[i - 1 + n % 3, j - 1 + n / 3 % 3, k - 1 + n / 9]));
        if !near.any(|near| near.iter().any(|&p| (kept[p] - point).norm() < spacing)) {
            cells.entry([i, j, k]).or_default().push(kept.len());
            kept.push(point);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One tetrahedron with one corner on the chamber side: each of its three other edges goes through.
    #[test]
    fn points_divide_the_edges_through_the_wall() {
        let mesh = TetMesh {
            positions: [[0., 0., 3.], [0., 0., 0.], [6., 0., 0.], [0., 6., 0.]]
                .map(Vec3::from)
                .to_vec(),
            tetrahedra: vec![[1, 2, 3, 0]],
            chamber: vec![[0, 0, 0]],
            outer: vec![[1, 2, 3]],
        };
        let points = interior_points(&mesh, 3, 0.1);
        let expected =
            [[0., 0., 2.], [2., 0., 2.], [0., 2., 2.], [0., 0., 1.], [4., 0., 1.], [0., 4., 1.]];
        for (point, expected) in points.iter().zip(expected.map(Vec3::from)) {
            assert!((point - expected).norm() < 1e-14);
        }
        assert_eq!(points.len(), expected.len());
        // The second layer's points are within 3 mm of that of the shortest edge, the first layer's 4 mm and more.
        assert_eq!(interior_points(&mesh, 3, 4.0).len(), 1 + 3);
        assert_eq!(interior_points(&mesh, 1, 4.0).len(), 0);
    }
}
