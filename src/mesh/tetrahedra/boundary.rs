//! From bare tetrahedra to a [`TetMesh`]: turned the right way, without unused vertices, with their boundary.

use super::TetDefect;
use crate::math::Vec3;
use crate::mesh::{SolidMesh, TetMesh};
use crate::surface::TriangleMesh;

/// A mesh whose vertices were numbered anew.
#[derive(Clone, Debug, PartialEq)]
pub struct Numbered {
    /// The mesh.
    pub mesh: TetMesh,
    /// The former number of each vertex, ascending, `[vertices]`.
    pub former: Vec<u32>,
}

impl TetMesh {
    /// The mesh of `tetrahedra` (turned either way) over some of the `positions`.
    ///
    /// A face of the boundary is the chamber's when `is_chamber` says so of its former vertex numbers, in ascending order.
    ///
    /// # Errors
    /// [`TetDefect`] when the tetrahedra are flat, name no vertex, or share faces by more than two. Whether they overlap is
    /// not looked at.
    pub fn of_tetrahedra(
        positions: &[Vec3],
        tetrahedra: &[[u32; 4]],
        is_chamber: impl Fn([u32; 3]) -> bool,
    ) -> Result<Numbered, TetDefect> {
        check_vertices(positions, tetrahedra)?;
        let turned: Vec<[u32; 4]> = tetrahedra
            .iter()
            .map(|&[a, b, c, d]| {
                let corners = [a, b, c, d].map(|v| positions[v as usize]);
                if volume(corners) < 0.0 { [b, a, c, d] } else { [a, b, c, d] }
            })
            .collect();
        let flat = turned
            .iter()
            .filter(|tetrahedron| is_flat(tetrahedron.map(|v| positions[v as usize])))
            .count();
        if flat > 0 {
            return Err(TetDefect::Flat { tetrahedra: flat });
        }
        let (chamber, outer): (Vec<_>, Vec<_>) =
            boundary(&turned)?.faces.into_iter().partition(|&face| is_chamber(sorted(face)));

        let mut used = vec![false; positions.len()];
        turned.iter().flatten().for_each(|&v| used[v as usize] = true);
        let former: Vec<u32> = (0..positions.len() as u32).filter(|&v| used[v as usize]).collect();
        let mut now = vec![0; positions.len()];
        former.iter().zip(0..).for_each(|(&v, number)| now[v as usize] = number);
        let now = |v: u32| now[v as usize];
        let mesh = Self {
            positions: former.iter().map(|&v| positions[v as usize]).collect(),
            tetrahedra: turned.iter().map(|tetrahedron| tetrahedron.map(now)).collect(),
            chamber: chamber.iter().map(|&[a, b, c]| [a, c, b].map(now)).collect(),
            outer: outer.iter().map(|face| face.map(now)).collect(),
        };
        Ok(Numbered { mesh, former })
    }

    /// The same tetrahedra with the chamber found by itself: each closed piece of the boundary that the wall surrounds.
    #[must_use]
    pub fn with_chamber_found(mut self) -> Self {
        let mut faces = std::mem::take(&mut self.outer);
        faces.extend(self.chamber.drain(..).map(|[a, b, c]| [a, c, b]));
        faces.sort_unstable();
        let pieces = self.pieces(&faces);
        let volumes = self.volumes_within(&faces, &pieces);
        for ([a, b, c], piece) in faces.into_iter().zip(pieces) {
            // Seen from the wall, an inner surface is inside out.
            if volumes[piece as usize] < 0.0 {
                self.chamber.push([a, c, b]);
            } else {
                self.outer.push([a, b, c]);
            }
        }
        self
    }

    /// The signed volume within each of the `pieces` of `faces`, mm^3.
    #[must_use]
    pub fn volumes_within(&self, faces: &[[u32; 3]], pieces: &[u32]) -> Vec<f64> {
        let mut volumes = vec![0.0; pieces.iter().max().map_or(0, |&last| last as usize + 1)];
        for (face, &piece) in faces.iter().zip(pieces) {
            // Seen from near by: a part far from the origin keeps its digits.
            let [a, b, c] = face.map(|v| self.positions[v as usize] - self.positions[0]);
            volumes[piece as usize] += a.dot(&b.cross(&c)) / 6.0;
        }
        volumes
    }

    /// The corners of tetrahedron `t`, mm.
    #[must_use]
    pub fn corners(&self, t: usize) -> [Vec3; 4] {
        self.tetrahedra[t].map(|v| self.positions[v as usize])
    }

    /// The volume of the wall, mm^3.
    #[must_use]
    pub fn volume(&self) -> f64 {
        (0..self.tetrahedra.len()).map(|t| volume(self.corners(t))).sum()
    }

    /// The outside by itself, closed, with normals out of the wall.
    #[must_use]
    pub fn outer_surface(&self) -> TriangleMesh {
        surface(&self.positions, &self.outer)
    }

    /// The chamber by itself, closed, with normals out of the chamber.
    #[must_use]
    pub fn chamber_surface(&self) -> TriangleMesh {
        surface(&self.positions, &self.chamber)
    }
}

impl SolidMesh {
    /// The number of faces with both their tetrahedra on one side: the mesh overlaps itself there, and each tetrahedron counts in full.
    ///
    /// # Panics
    /// When a face belongs to more than two tetrahedra.
    #[must_use]
    pub fn overlapping_faces(&self) -> usize {
        let corners: Vec<[u32; 4]> =
            self.tetrahedra.iter().map(|nodes| [nodes[0], nodes[1], nodes[2], nodes[3]]).collect();
        boundary(&corners).expect("a face has two tetrahedra at most").overlapping
    }
}

/// The signed volume `(b - a) . (c - a) x (d - a) / 6` of a tetrahedron, mm^3.
pub(super) fn volume([a, b, c, d]: [Vec3; 4]) -> f64 {
    (b - a).dot(&(c - a).cross(&(d - a))) / 6.0
}

/// A tetrahedron of less than this share of the cube on its longest edge is flat by rounding alone.
const FLAT: f64 = 1e-13;

pub(super) fn is_flat(corners: [Vec3; 4]) -> bool {
    let longest = edge_lengths(corners).into_iter().fold(0.0, f64::max);
    volume(corners).abs() <= FLAT * longest.powi(3)
}

/// The lengths of the edges in the order of [`crate::mesh::TET_EDGES`], mm.
pub(super) fn edge_lengths(corners: [Vec3; 4]) -> [f64; 6] {
    crate::mesh::TET_EDGES.map(|[i, j]| (corners[j] - corners[i]).norm())
}

/// The faces of a tetrahedron of positive volume, with normals out of it, opposite to its corners 0, 1, 2, 3.
pub(super) fn faces([a, b, c, d]: [u32; 4]) -> [[u32; 3]; 4] {
    [[b, c, d], [a, d, c], [a, b, d], [a, c, b]]
}

/// Which faces tetrahedra of positive volume have alone.
pub(super) struct Boundary {
    /// The faces of one tetrahedron only, with normals out of it, in ascending order of their sorted corners.
    pub(super) faces: Vec<[u32; 3]>,
    /// How many faces have two tetrahedra, but both on one side.
    pub(super) overlapping: usize,
}

/// The boundary of `tetrahedra`.
///
/// # Errors
/// [`TetDefect::CrowdedFaces`] when faces belong to more than two of them.
pub(super) fn boundary(tetrahedra: &[[u32; 4]]) -> Result<Boundary, TetDefect> {
    let mut all: Vec<([u32; 3], [u32; 3])> = tetrahedra
        .iter()
        .flat_map(|&corners| faces(corners))
        .map(|face| (sorted(face), face))
        .collect();
    all.sort_unstable();
    let (mut alone, mut crowded, mut overlapping) = (Vec::new(), 0, 0);
    for same in all.chunk_by(|a, b| a.0 == b.0) {
        match same {
            [(_, face)] => alone.push(*face),
            [(_, one), (_, other)] => overlapping += usize::from(is_even(*one) == is_even(*other)),
            _ => crowded += 1,
        }
    }
    if crowded > 0 {
        return Err(TetDefect::CrowdedFaces { faces: crowded });
    }
    Ok(Boundary { faces: alone, overlapping })
}

/// Whether `face` is an even permutation of its sorted corners.
pub(super) fn is_even([a, b, c]: [u32; 3]) -> bool {
    (a < b) ^ (b < c) ^ (a < c)
}

pub(super) fn sorted(mut face: [u32; 3]) -> [u32; 3] {
    face.sort_unstable();
    face
}

/// # Errors
/// [`TetDefect`] unless there are tetrahedra, over finite vertices.
pub(super) fn check_vertices(positions: &[Vec3], tetrahedra: &[[u32; 4]]) -> Result<(), TetDefect> {
    if tetrahedra.is_empty() {
        return Err(TetDefect::Empty);
    }
    let beyond = |corners: &&[u32; 4]| corners.iter().any(|&v| v as usize >= positions.len());
    let tetrahedra = tetrahedra.iter().filter(beyond).count();
    if tetrahedra > 0 {
        return Err(TetDefect::IndexOutOfRange { tetrahedra });
    }
    let not_finite = |p: &&Vec3| !p.iter().all(|x| x.is_finite());
    let vertices = positions.iter().filter(not_finite).count();
    if vertices > 0 {
        return Err(TetDefect::NotFinite { vertices });
    }
    Ok(())
}

/// The triangles over their vertices alone.
fn surface(positions: &[Vec3], triangles: &[[u32; 3]]) -> TriangleMesh {
    let mut vertices: Vec<u32> = triangles.iter().flatten().copied().collect();
    vertices.sort_unstable();
    vertices.dedup();
    let mut now = vec![0; positions.len()];
    vertices.iter().zip(0..).for_each(|(&v, number)| now[v as usize] = number);
    TriangleMesh {
        positions: vertices.iter().map(|&v| positions[v as usize]).collect(),
        triangles: triangles.iter().map(|t| t.map(|v| now[v as usize])).collect(),
    }
}
