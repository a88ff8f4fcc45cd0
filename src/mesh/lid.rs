//! Lids: flat openings of a chamber, as an air inlet, closed by what holds air and has no stiffness.

use std::collections::HashMap;

use super::tetrahedra::net_edges;
use super::{FACE_EDGES, SolidMesh};
use crate::math::Vec3;

/// A lid over an opening of a chamber, within its rim.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lid {
    /// Corners and the midpoints between them in turn, beginning with a corner; the normal leaves the chamber.
    pub rim: Vec<u32>,
}

/// Why an opening of a chamber gets no lid.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum RimDefect {
    /// Rims touch each other.
    #[error(
        "two rims of the chamber's openings meet at ({x:.3}, {y:.3}, {z:.3}) mm; give the chamber's triangles so that they do not"
    )]
    Meeting {
        /// Where, mm.
        x: f64,
        /// mm.
        y: f64,
        /// mm.
        z: f64,
    },
    /// The rim does not lie in a plane.
    #[error(
        "the chamber's opening at ({x:.3}, {y:.3}, {z:.3}) mm is not flat: its rim of {across:.3} mm across leaves its plane by {out:.3} mm; let the chamber's triangles end in a plane"
    )]
    NotFlat {
        /// Its middle, mm.
        x: f64,
        /// mm.
        y: f64,
        /// mm.
        z: f64,
        /// Largest distance from the middle, twice, mm.
        across: f64,
        /// Largest distance from the plane, mm.
        out: f64,
    },
}

/// How far a rim may leave its plane, as a share of its width: files with four digits are flat.
const FLAT: f64 = 1e-3;

impl SolidMesh {
    /// The same wall, whose chamber lids close over its openings.
    ///
    /// # Errors
    /// [`RimDefect`] when an opening is not flat, or meets another.
    pub fn with_lids(mut self) -> Result<Self, RimDefect> {
        let corners: Vec<[u32; 3]> = self.chamber.iter().map(|f| [f[0], f[1], f[2]]).collect();
        let mut next: HashMap<u32, u32> = HashMap::new();
        let open = net_edges(&corners);
        for &[from, to] in &open {
            // A lid turns against its neighbours.
            if next.insert(to, from).is_some() {
                let at = self.positions[to as usize];
                return Err(RimDefect::Meeting { x: at.x, y: at.y, z: at.z });
            }
        }
        let mut midpoints: HashMap<[u32; 2], u32> = HashMap::new();
        for face in &self.chamber {
            for (k, [a, b]) in FACE_EDGES.into_iter().enumerate() {
                midpoints.insert(ordered(face[a], face[b]), face[3 + k]);
            }
        }
        for &[start, _] in &open {
            let (mut rim, mut at) = (Vec::new(), start);
            while let Some(to) = next.remove(&at) {
                rim.extend([at, midpoints[&ordered(at, to)]]);
                at = to;
            }
            if rim.is_empty() {
                continue;
            }
            let places: Vec<Vec3> = rim.iter().map(|&v| self.positions[v as usize]).collect();
            check_flat(&places)?;
            self.lids.push(Lid { rim });
        }
        Ok(self)
    }

    /// Triangles of the corners of the chamber and of fans over its lids, with normals out of the chamber.
    #[must_use]
    pub fn chamber_and_lids(&self) -> Vec<[u32; 3]> {
        let faces = self.chamber.iter().map(|face| [face[0], face[1], face[2]]);
        let fan = |lid: &Lid| {
            let corners: Vec<u32> = lid.rim.iter().step_by(2).copied().collect();
            let turn: Vec<[u32; 3]> =
                corners[1..].windows(2).map(|pair| [corners[0], pair[0], pair[1]]).collect();
            turn
        };
        faces.chain(self.lids.iter().flat_map(fan)).collect()
    }
}

fn ordered(v: u32, w: u32) -> [u32; 2] {
    [v.min(w), v.max(w)]
}

fn check_flat(rim: &[Vec3]) -> Result<(), RimDefect> {
    let middle = rim.iter().sum::<Vec3>() / rim.len() as f64;
    let from = |k: usize| rim[k % rim.len()] - middle;
    let normal = (0..rim.len()).map(|k| from(k).cross(&from(k + 1))).sum::<Vec3>();
    let across = (0..rim.len()).map(|k| 2.0 * from(k).norm()).fold(0.0, f64::max);
    let normal = normal.try_normalize(FLAT * across * across);
    let out = match normal {
        Some(normal) => (0..rim.len()).map(|k| from(k).dot(&normal).abs()).fold(0.0, f64::max),
        None => across,
    };
    if out > FLAT * across {
        return Err(RimDefect::NotFlat { x: middle.x, y: middle.y, z: middle.z, across, out });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::TetMesh;
    use crate::mesh::tetrahedra::test_walls::grid;

    /// A block of 3 x 3 x 2 cells without its middle column: a tube with two square openings, its faces inside the chamber.
    fn tube(place: &dyn Fn(Vec3) -> Vec3) -> SolidMesh {
        let mut mesh = grid([3, 3, 2], 1.0, |[i, j, _]| [i, j] != [1, 1]);
        let inside = |x: Vec3| (x.x - 1.5).abs() < 0.6 && (x.y - 1.5).abs() < 0.6;
        let (chamber, outer) = mesh.outer.iter().partition(|face| {
            inside(face.iter().map(|&v| mesh.positions[v as usize]).sum::<Vec3>() / 3.0)
        });
        let turned: Vec<[u32; 3]> = chamber;
        let chamber = turned.into_iter().map(|[a, b, c]| [a, c, b]).collect();
        mesh = TetMesh { chamber, outer, ..mesh };
        mesh.positions.iter_mut().for_each(|x| *x = place(*x));
        SolidMesh::straight(&mesh)
    }

    fn volume(mesh: &SolidMesh) -> f64 {
        let corners = |face: [u32; 3]| face.map(|v| mesh.positions[v as usize]);
        let of = |[a, b, c]: [Vec3; 3]| a.dot(&b.cross(&c)) / 6.0;
        mesh.chamber_and_lids().into_iter().map(corners).map(of).sum()
    }

    /// Both ends of a tube of 1 x 1 x 2 mm get a lid of four corners and four midpoints, wherever the tube stands: exact but for rounding.
    #[test]
    fn a_tube_gets_two_lids() {
        for shift in [Vec3::zeros(), Vec3::new(7.0, -3.0, 11.0)] {
            let mesh = tube(&|x| x + shift).with_lids().unwrap();
            assert_eq!(mesh.lids.iter().map(|lid| lid.rim.len()).collect::<Vec<_>>(), [8, 8]);
            assert!((volume(&mesh) - 2.0).abs() < 1e-12, "{}", volume(&mesh));
        }
    }

    #[test]
    fn a_bent_rim_is_refused() {
        let bent = tube(&|x| x + 0.01 * x.x * x.y * Vec3::z()).with_lids().unwrap_err();
        assert!(matches!(bent, RimDefect::NotFlat { .. }), "{bent}");
        // A tilted rim is flat.
        assert_eq!(tube(&|x| x + 0.3 * x.x * Vec3::z()).with_lids().unwrap().lids.len(), 2);
    }
}
