//! A closed surface as cubes: solid where their middles are inside.
//!
//! A line through the middles of a column crosses the triangles above and below it; between an entry and the exit after it is
//! material. Which of two triangles a line through their common edge crosses is decided by the edge alone, the same way for both.
//!
//! Source: Nooruddin and Turk (2003), Simplification and repair of polygonal models using volumetric techniques, IEEE Trans. Vis.
//! Comput. Graph. 9:191-205, for the parity along lines.

use crate::math::Vec3;
use crate::surface::TriangleMesh;

/// Cubes about a surface, with a layer of air around it.
#[derive(Clone, Debug)]
pub struct Voxels {
    /// The middle of the first cube, mm.
    origin: Vec3,
    /// Edge of a cube, mm.
    pub size: f64,
    /// Cubes along x, y, z.
    pub counts: [usize; 3],
    /// Whether each cube is solid, `[x][y][z]` with z fastest.
    pub solid: Vec<bool>,
}

impl Voxels {
    /// The cubes of edge `size` (mm) inside the closed `surface`.
    ///
    /// # Panics
    /// When `size` is not a positive number, or the surface has no vertices.
    #[must_use]
    pub fn of(surface: &TriangleMesh, size: f64) -> Self {
        assert!(size > 0.0 && size.is_finite(), "the size must be a positive number, not {size}");
        let (lower, upper) = surface.bounding_box().expect("a closed surface has vertices");
        let counts = [0, 1, 2].map(|axis| ((upper - lower)[axis] / size).ceil() as usize + 2);
        let aside = Vec3::new(ASIDE[0], ASIDE[1], 0.0);
        let origin = lower + size * (aside - Vec3::repeat(0.5));
        let solid = vec![false; counts.iter().product()];
        let mut voxels = Self { origin, size, counts, solid };
        for (column, mut crossings) in voxels.crossings(surface).into_iter().enumerate() {
            crossings.sort_by(|a, b| a.0.total_cmp(&b.0));
            let mut depth = 0;
            for pair in crossings.windows(2) {
                depth += pair[0].1;
                if depth > 0 {
                    voxels.fill(column, pair[0].0, pair[1].0);
                }
            }
        }
        voxels
    }

    /// For each column its crossings: height (mm), and 1 where the line enters the material, -1 where it leaves.
    fn crossings(&self, surface: &TriangleMesh) -> Vec<Vec<(f64, i32)>> {
        let mut crossings = vec![Vec::new(); self.counts[0] * self.counts[1]];
        for t in 0..surface.triangles.len() {
            let corners = surface.corners(t);
            let [a, b, c] = corners;
            let (lower, upper) = (a.inf(&b).inf(&c), a.sup(&b).sup(&c));
            let normal = (b - a).cross(&(c - a));
            let range = |axis: usize| {
                let place = |x: f64| (x - self.origin[axis]) / self.size;
                let first = place(lower[axis]).ceil().max(0.0) as usize;
                let last = place(upper[axis]).floor().max(-1.0) + 1.0;
                first..self.counts[axis].min(last as usize)
            };
            for i in range(0) {
                for j in range(1) {
                    let p = self.origin + self.size * Vec3::new(i as f64, j as f64, 0.0);
                    let left = [0, 1, 2].map(|k| is_left(corners[k], corners[(k + 1) % 3], p));
                    if left.iter().any(|side| *side != left[0]) {
                        continue;
                    }
                    let z = a.z - (normal.x * (p.x - a.x) + normal.y * (p.y - a.y)) / normal.z;
                    let z = if z.is_finite() { z.clamp(lower.z, upper.z) } else { lower.z };
                    let turn = if left[0] { -1 } else { 1 };
                    crossings[i * self.counts[1] + j].push((z, turn));
                }
            }
        }
        crossings
    }

    fn fill(&mut self, column: usize, from: f64, to: f64) {
        let place = |z: f64| (z - self.origin.z) / self.size;
        let first = place(from).ceil().max(0.0) as usize;
        let last = ((place(to).floor() + 1.0).max(0.0) as usize).min(self.counts[2]);
        let start = column * self.counts[2];
        if first < last {
            self.solid[start + first..start + last].fill(true);
        }
    }

    /// The same cubes, those whose middles lie where `is_filled` says solid as well.
    #[must_use]
    pub fn filled(&self, is_filled: impl Fn(Vec3) -> bool) -> Self {
        let solid =
            (0..self.solid.len()).map(|k| self.solid[k] || is_filled(self.middle(k))).collect();
        Self { solid, ..self.clone() }
    }

    /// The middle of cube `k`, mm.
    #[must_use]
    pub fn middle(&self, k: usize) -> Vec3 {
        let [i, j, l] = self.indices(k).map(|i| i as f64);
        self.origin + self.size * Vec3::new(i, j, l)
    }

    /// The cube that holds `point` (mm), within those there are.
    #[must_use]
    pub fn at(&self, point: Vec3) -> usize {
        let place = (point - self.origin) / self.size;
        let [i, j, l] = std::array::from_fn(|axis| {
            (place[axis].round().max(0.0) as usize).min(self.counts[axis] - 1)
        });
        (i * self.counts[1] + j) * self.counts[2] + l
    }

    /// The places of cube `k` along x, y, z.
    pub(super) fn indices(&self, k: usize) -> [usize; 3] {
        let [_, ny, nz] = self.counts;
        [k / (ny * nz), k / nz % ny, k % nz]
    }

    /// How far apart neighbours along each axis are in the list.
    pub(super) fn strides(&self) -> [usize; 3] {
        [self.counts[1] * self.counts[2], self.counts[2], 1]
    }
}

/// Whether `p` is left of the way from `a` to `b`, seen from above; on it, whether the way goes back in x, or in y.
fn is_left(a: Vec3, b: Vec3, p: Vec3) -> bool {
    let is_turned = (b.x, b.y) < (a.x, a.y);
    let (a, b) = if is_turned { (b, a) } else { (a, b) };
    let is_left = (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x) >= 0.0;
    is_left != is_turned
}

/// In cubes: lines through columns avoid the vertices of surfaces that were made on a lattice.
const ASIDE: [f64; 2] = [0.71e-3, 0.53e-3];

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use approx::assert_relative_eq;

    use super::*;
    use crate::printing::test_shapes::{ball, brick, hollow};

    fn volume(voxels: &Voxels) -> f64 {
        voxels.solid.iter().filter(|solid| **solid).count() as f64 * voxels.size.powi(3)
    }

    #[test]
    fn a_brick_of_whole_cubes_is_exact() {
        let voxels = Voxels::of(&brick([1.0, 2.0, 3.0], [5.0, 7.0, 9.0]), 0.5);
        assert_eq!(voxels.counts, [10, 12, 14]);
        assert_eq!(volume(&voxels), 4.0 * 5.0 * 6.0);
        let k = voxels.at(Vec3::new(1.3, 2.3, 3.3));
        assert!(voxels.solid[k]);
        // The columns are 1e-3 of a cube aside.
        assert!((voxels.middle(k) - Vec3::new(1.25, 2.25, 3.25)).norm() < 1e-3);
    }

    /// A sphere with two voids: middles on a lattice err by less than the surface times a tenth of a cube, mostly far less.
    #[test]
    fn voids_are_air() {
        let voids = [ball([-4.0, 0.0, 0.0], 2.0), ball([4.0, 0.5, 1.0], 3.0)];
        let mesh = hollow(&ball([0.0; 3], 10.0), &voids);
        let voxels = Voxels::of(&mesh, 0.3);
        assert_relative_eq!(volume(&voxels), mesh.volume(), max_relative = 2e-3);
        assert_relative_eq!(
            mesh.volume(),
            4.0 / 3.0 * PI * (1000.0 - 8.0 - 27.0),
            max_relative = 5e-3
        );
        assert!(!voxels.solid[voxels.at(Vec3::new(-4.0, 0.0, 0.0))]);
        assert!(voxels.solid[voxels.at(Vec3::zeros())]);
    }

    #[test]
    fn lines_through_vertices_and_edges_cross_once() {
        // An octahedron whose vertex, edges and diagonals lie on the lines of columns.
        let positions = [Vec3::x(), -Vec3::x(), Vec3::y(), -Vec3::y(), Vec3::z(), -Vec3::z()];
        let at = |x: f64, y: f64| Vec3::new(x, y, 0.0);
        for (x, y) in [(0.0, 0.0), (0.25, 0.0), (0.0, -0.5), (0.25, 0.25)] {
            let mut turns = 0;
            for [i, j, k] in [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4]] {
                let corners = [i, j, k].map(|v: usize| positions[v]);
                let left = [0, 1, 2].map(|k| is_left(corners[k], corners[(k + 1) % 3], at(x, y)));
                turns += i32::from(left == [true; 3]);
            }
            assert_eq!(turns, 1, "upper faces over {x}, {y}");
        }
    }
}
