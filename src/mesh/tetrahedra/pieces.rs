//! The pieces of a boundary, told apart by the air in front of them, and the bodies behind it.
//!
//! Where two cavities, or a cavity and the outside, share an edge, four faces meet there. Around the edge, wall and air
//! take turns; the two faces on either side of the same air belong to one piece. Pieces that share a vertex alone are two.

use super::boundary::{faces, sorted};
use crate::math::{DisjointSets, Vec3};
use crate::mesh::TetMesh;

impl TetMesh {
    /// The piece of each face, numbered in the order of the `faces`, whose normals leave the wall.
    #[must_use]
    pub fn pieces(&self, faces: &[[u32; 3]]) -> Vec<u32> {
        let mut joined = DisjointSets::new(faces.len());
        for same in half_edges(faces).chunk_by(|a, b| a.edge == b.edge) {
            match air_mates(&self.positions, faces, same) {
                Some(mates) => mates.into_iter().for_each(|[f, g]| joined.join(f, g)),
                None => same.windows(2).for_each(|pair| joined.join(pair[0].face, pair[1].face)),
            }
        }
        joined.numbers(0..faces.len() as u32)
    }

    /// The faces of the chamber, with normals out of the wall.
    #[must_use]
    pub fn chamber_from_wall(&self) -> Vec<[u32; 3]> {
        self.chamber.iter().map(|&[a, b, c]| [a, c, b]).collect()
    }

    /// How many bodies there are that share no face.
    #[must_use]
    pub fn bodies(&self) -> usize {
        let of = |(&corners, t)| faces(corners).map(|face| (sorted(face), t));
        let mut all: Vec<([u32; 3], u32)> = self.tetrahedra.iter().zip(0..).flat_map(of).collect();
        all.sort_unstable();
        let mut joined = DisjointSets::new(self.tetrahedra.len());
        for pair in all.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
            joined.join(pair[0].1, pair[1].1);
        }
        let bodies = joined.numbers(0..self.tetrahedra.len() as u32);
        bodies.into_iter().max().map_or(0, |last| last as usize + 1)
    }
}

/// An edge of a face; its ends ascending.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct HalfEdge {
    edge: [u32; 2],
    face: u32,
    /// Whether the face turns from the lower end to the higher one.
    ascends: bool,
}

/// The edges of `faces`, those of the same ends one after another.
fn half_edges(faces: &[[u32; 3]]) -> Vec<HalfEdge> {
    let of = |(&[a, b, c], face): (&[u32; 3], u32)| {
        [[a, b], [b, c], [c, a]].map(|[v, w]| HalfEdge {
            edge: [v.min(w), v.max(w)],
            face,
            ascends: v < w,
        })
    };
    let mut all: Vec<HalfEdge> = faces.iter().zip(0..).flat_map(of).collect();
    all.sort_unstable();
    all
}

/// The edges that `faces` run along one way more often than the other, that way, as often as they do more; a closed surface has none.
#[must_use]
pub fn net_edges(faces: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let mut net = Vec::new();
    for same in half_edges(faces).chunk_by(|a, b| a.edge == b.edge) {
        let [low, high] = same[0].edge;
        let ascending = same.iter().filter(|half| half.ascends).count();
        let descending = same.len() - ascending;
        net.extend((descending..ascending).map(|_| [low, high]));
        net.extend((ascending..descending).map(|_| [high, low]));
    }
    net
}

/// How often a closed surface goes around `point`, from what each of its triangles covers of the sphere; 1 inside, 0 outside.
///
/// Source: van Oosterom and Strackee (1983).
pub fn turns_around(point: Vec3, corners: impl Iterator<Item = [Vec3; 3]>) -> f64 {
    let covered = |corners: [Vec3; 3]| {
        let [a, b, c] = corners.map(|corner| corner - point);
        let [x, y, z] = [a, b, c].map(|way| way.norm());
        let cosine = x * y * z + a.dot(&b) * z + b.dot(&c) * x + c.dot(&a) * y;
        a.dot(&b.cross(&c)).atan2(cosine)
    };
    corners.map(covered).sum::<f64>() / std::f64::consts::TAU
}

/// The pairs of faces about one edge with the same air between them; `None` where the faces do not take turns, as where the wall overlaps itself.
fn air_mates(positions: &[Vec3], faces: &[[u32; 3]], about: &[HalfEdge]) -> Option<Vec<[u32; 2]>> {
    if let [one, other] = about {
        return Some(vec![[one.face, other.face]]);
    }
    let [from, to] = about[0].edge.map(|v| positions[v as usize]);
    let along = (to - from).normalize();
    let across = |half: &HalfEdge| {
        let third = faces[half.face as usize].into_iter().find(|v| !half.edge.contains(v))?;
        let way = positions[third as usize] - from;
        Some(way - along.dot(&way) * along)
    };
    let zero = across(&about[0])?;
    let quarter = along.cross(&zero);
    let mut turns: Vec<(f64, bool, u32)> = about
        .iter()
        .map(|half| {
            let way = across(half)?;
            // Air lies in the direction of growing angles from faces that ascend: of two in one place, these come first.
            Some((quarter.dot(&way).atan2(zero.dot(&way)), !half.ascends, half.face))
        })
        .collect::<Option<_>>()?;
    turns.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let next = |k: usize| turns[(k + 1) % turns.len()];
    let mut mates = Vec::new();
    for (k, &(_, descends, face)) in turns.iter().enumerate() {
        let (_, next_descends, mate) = next(k);
        if descends == next_descends {
            return None;
        }
        if !descends {
            mates.push([face, mate]);
        }
    }
    Some(mates)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::tetrahedra::test_walls::{grid, of_prisms, spheres};

    fn found(cavity: &[[usize; 3]]) -> TetMesh {
        grid([5, 5, 5], 1.0, |cell| !cavity.contains(&cell)).with_chamber_found()
    }

    fn volume(mesh: &TetMesh) -> f64 {
        mesh.chamber_surface().volume()
    }

    /// Cells of 1 mm^3 left out of a block: the volume is their number, whatever they share. Sums of some hundred exact sixths.
    #[test]
    fn cavities_that_share_an_edge_or_a_vertex_are_found() {
        let cases: [(&[[usize; 3]], usize); 4] = [
            (&[[2, 2, 2]], 1),
            (&[[1, 1, 2], [2, 1, 2]], 1),
            // An edge alone, and a vertex alone.
            (&[[1, 1, 2], [2, 2, 2]], 2),
            (&[[1, 1, 1], [2, 2, 2]], 2),
        ];
        for (cavity, voids) in cases {
            let mesh = found(cavity);
            assert!((volume(&mesh) - cavity.len() as f64).abs() < 1e-12, "{cavity:?}");
            let pieces =
                mesh.pieces(&mesh.chamber_from_wall()).into_iter().max().map_or(0, |last| last + 1);
            assert_eq!(pieces as usize, voids, "{cavity:?}");
        }
    }

    /// A cavity that meets a notch of the outside along an edge, or at a vertex, is a chamber still, and the notch is none.
    #[test]
    fn a_cavity_that_touches_the_outside_is_found() {
        for notch in [[0, 1, 2], [0, 0, 2], [0, 0, 1]] {
            let mesh = found(&[notch, [1, 1, 2]]);
            let wanted = if notch == [0, 1, 2] { 0.0 } else { 1.0 };
            assert!((volume(&mesh) - wanted).abs() < 1e-12, "{notch:?} {}", volume(&mesh));
        }
    }

    /// A point within a cube is gone around once, one outside not, whatever the distance: rounding of twelve angles.
    #[test]
    fn turns_tell_inside_from_outside() {
        let mesh = grid([1, 1, 1], 2.0, |_| true);
        let turns = |x: [f64; 3]| {
            let corners = mesh.outer.iter().map(|face| face.map(|v| mesh.positions[v as usize]));
            turns_around(Vec3::from(x), corners)
        };
        assert!((turns([0.1, 1.0, 1.9]) - 1.0).abs() < 1e-12);
        assert!(turns([2.1, 1.0, 1.0]).abs() < 1e-12 && turns([-40.0, 3.0, 1.0]).abs() < 1e-12);
        assert!(net_edges(&mesh.outer).is_empty());
        assert_eq!(net_edges(&mesh.outer[1..]).len(), 3);
    }

    /// Cubes that share a face are one body, those that share an edge or nothing are two.
    #[test]
    fn bodies_share_faces() {
        let bodies =
            |cells: &[[usize; 3]]| grid([3, 3, 3], 1.0, |cell| cells.contains(&cell)).bodies();
        assert_eq!(bodies(&[[0, 0, 0], [1, 0, 0]]), 1);
        assert_eq!(bodies(&[[0, 0, 0], [1, 1, 0]]), 2);
        assert_eq!(bodies(&[[0, 0, 0], [1, 1, 1], [2, 0, 2]]), 3);
        assert_eq!(of_prisms(&spheres(10.0, 8.0, 1)).bodies(), 1);
    }
}
