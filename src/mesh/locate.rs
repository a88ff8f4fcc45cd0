//! Where points lie in a body of tetrahedra.
//!
//! A point belongs to the cell in which its least barycentric coordinate is largest: inside to the one that holds it, a little outside
//! to the nearest. Cells count as straight.

use std::collections::HashMap;

use super::SolidMesh;
use crate::math::Vec3;

/// A point in a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Location {
    /// The tetrahedron.
    pub cell: usize,
    /// Barycentric coordinates; one is below 0 outside.
    pub barycentric: [f64; 4],
}

impl Location {
    fn least(&self) -> f64 {
        self.barycentric.into_iter().fold(f64::INFINITY, f64::min)
    }
}

impl SolidMesh {
    /// The cells of `points` (mm), in their order; none for a point further outside than about the longest edge of the cells there.
    #[must_use]
    pub fn locate(&self, points: &[Vec3]) -> Vec<Option<Location>> {
        let corners = |cell: &[u32; 10]| [0, 1, 2, 3].map(|k| self.positions[cell[k] as usize]);
        let extent = |cell: &[u32; 10]| {
            let [a, rest @ ..] = corners(cell);
            rest.iter().fold((a, a), |(low, high), x| (low.inf(x), high.sup(x)))
        };
        let widest = self.tetrahedra.iter().map(|cell| {
            let (low, high) = extent(cell);
            (high - low).amax()
        });
        let width = widest.fold(f64::MIN_POSITIVE, f64::max);
        let box_of = |x: &Vec3| (x / width).map(|x| x.floor() as i64);
        // A cell is no wider than a box: those near a point start in one of the 27 about it.
        let mut boxes: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
        for (k, cell) in self.tetrahedra.iter().enumerate() {
            boxes.entry(box_of(&extent(cell).0).into()).or_default().push(k);
        }
        let locate = |point: &Vec3| {
            let middle = box_of(point);
            let near = (0..27).filter_map(|k| {
                boxes.get(&[middle.x + k % 3 - 1, middle.y + k / 3 % 3 - 1, middle.z + k / 9 - 1])
            });
            near.flatten()
                .filter_map(|&cell| {
                    let barycentric = barycentric(&corners(&self.tetrahedra[cell]), point)?;
                    Some(Location { cell, barycentric })
                })
                .max_by(|a, b| a.least().total_cmp(&b.least()))
        };
        points.iter().map(locate).collect()
    }
}

fn barycentric([a, b, c, d]: &[Vec3; 4], x: &Vec3) -> Option<[f64; 4]> {
    let volume = |a: Vec3, b: Vec3, c: Vec3| a.dot(&b.cross(&c));
    let [p, q, r, s] = [a - x, b - x, c - x, d - x];
    let whole = volume(b - a, c - a, d - a);
    let parts = [volume(q, r, s), -volume(p, r, s), volume(p, q, s), -volume(p, q, r)];
    (whole > 0.0).then(|| parts.map(|part| part / whole))
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::mesh::TetMesh;

    /// Points are found in the cell from which they were drawn, and give themselves back.
    #[test]
    fn points_are_found_where_they_are() {
        let cube: Vec<Vec3> = (0..8)
            .map(|k| Vec3::new(f64::from(k & 1), f64::from(k >> 1 & 1), 3.0 * f64::from(k >> 2)))
            .collect();
        let tetrahedra = vec![[0, 1, 2, 4], [3, 2, 1, 7], [5, 1, 4, 7], [6, 4, 2, 7], [1, 2, 4, 7]];
        let mesh =
            SolidMesh::straight(&TetMesh { positions: cube, tetrahedra, ..TetMesh::default() });
        let mut chance = ChaCha8Rng::seed_from_u64(1);
        for cell in 0..5 {
            let mut weights: [f64; 4] = std::array::from_fn(|_| chance.random_range(0.01..1.0));
            let sum: f64 = weights.iter().sum();
            weights.iter_mut().for_each(|weight| *weight /= sum);
            let at = |weights: [f64; 4], cell: usize| -> Vec3 {
                let corners = mesh.tetrahedra[cell].iter().zip(weights);
                corners.map(|(&v, w)| w * mesh.positions[v as usize]).sum()
            };
            let found = mesh.locate(&[at(weights, cell)])[0].unwrap();
            assert_eq!(found.cell, cell);
            for (found, weight) in found.barycentric.iter().zip(weights) {
                assert_relative_eq!(*found, weight, epsilon = 1e-12);
            }
        }
        // A little outside, and nowhere near.
        let found = mesh.locate(&[Vec3::new(-0.01, 0.1, 0.1), Vec3::repeat(50.0)]);
        assert_eq!(found[0].map(|found| found.cell), Some(0));
        assert_eq!(found[1], None);
    }
}
