//! Points of the surface that carry pressure, contact, loads and output: corners and edge midpoints of the triangles.

use std::collections::BTreeMap;
use std::rc::Rc;

use super::loop_patch::LoopBasis;
use crate::math::Vec3;
use crate::mesh::{FACE_EDGES, Section, Stencil};
use crate::surface::TriangleMesh;

/// One point of the surface: its weights on the nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// Nodes, ascending.
    pub nodes: Vec<u32>,
    /// Their weights, summing to one.
    pub weights: Vec<f64>,
}

impl Sample {
    /// The node with the largest weight.
    ///
    /// # Panics
    /// When the sample has no node.
    #[must_use]
    pub fn heaviest(&self) -> u32 {
        let largest =
            (0..self.nodes.len()).max_by(|&a, &b| self.weights[a].total_cmp(&self.weights[b]));
        self.nodes[largest.expect("a sample has nodes")]
    }

    /// The point on the surface, mm; of displacements, the displacement there.
    #[must_use]
    pub fn point(&self, positions: &[Vec3]) -> Vec3 {
        self.nodes.iter().zip(&self.weights).map(|(&v, w)| *w * positions[v as usize]).sum()
    }
}

/// The corners (0, 1, 2) of a triangle of the surface and the midpoints of the edges opposite to them (3, 4, 5).
#[derive(Clone, Debug, PartialEq)]
pub struct ElementPoints {
    /// Nodes, ascending.
    pub nodes: Vec<u32>,
    /// Weights of each node on the six points.
    pub weights: Vec<[f64; 6]>,
}

/// The four facets of a triangle over its corners (0, 1, 2) and edge midpoints (3, 4, 5).
const SUBTRIANGLES: [[usize; 3]; 4] = [[0, 5, 4], [1, 3, 5], [2, 4, 3], [3, 4, 5]];

impl ElementPoints {
    /// The points of a Loop triangle, on its limit surface.
    #[must_use]
    pub fn of_loop(stencil: &Stencil, basis: &LoopBasis) -> Self {
        let (nodes, weights) = ascending(&stencil.nodes, &basis.limit);
        Self { nodes, weights }
    }

    /// The points of a flat triangle.
    #[must_use]
    pub fn of_facet(triangle: [u32; 3]) -> Self {
        let weights: [[f64; 6]; 3] = std::array::from_fn(|corner| {
            let mut weights = [0.0, 0.0, 0.0, 0.5, 0.5, 0.5];
            weights[corner] = 1.0;
            weights[3 + corner] = 0.0;
            weights
        });
        let (nodes, weights) = ascending(&triangle, &weights);
        Self { nodes, weights }
    }

    /// The points of a quadratic face, which are its nodes: corners, then midpoints of the edges opposite to them.
    #[must_use]
    pub fn of_quadratic(nodes: [u32; 6]) -> Self {
        let weights: [[f64; 6]; 6] = std::array::from_fn(|node| {
            std::array::from_fn(|point| f64::from(u8::from(point == node)))
        });
        let (nodes, weights) = ascending(&nodes, &weights);
        Self { nodes, weights }
    }

    /// The points of all Loop triangles.
    #[must_use]
    pub fn of_stencils(stencils: &[Stencil], bases: &[Rc<LoopBasis>]) -> Vec<Self> {
        stencils.iter().zip(bases).map(|(stencil, basis)| Self::of_loop(stencil, basis)).collect()
    }

    /// The six points where the nodes are at `x`, in the order of the nodes.
    pub(in crate::model) fn at<'a>(&self, x: impl IntoIterator<Item = &'a Vec3>) -> [Vec3; 6] {
        let mut points = [Vec3::zeros(); 6];
        for (x, weights) in x.into_iter().zip(&self.weights) {
            for (point, weight) in points.iter_mut().zip(weights) {
                *point += *weight * x;
            }
        }
        points
    }

    /// One of the six points as a sample.
    #[must_use]
    pub fn sample(&self, point: usize) -> Sample {
        let nonzero = |(node, weights): (&u32, &[f64; 6])| {
            (weights[point] != 0.0).then_some((*node, weights[point]))
        };
        let (nodes, weights) = self.nodes.iter().zip(&self.weights).filter_map(nonzero).unzip();
        Sample { nodes, weights }
    }
}

/// `nodes` in ascending order without repetition, and their weights, added up where a node is repeated.
pub(in crate::model) fn ascending<const N: usize>(
    nodes: &[u32],
    weights: &[[f64; N]],
) -> (Vec<u32>, Vec<[f64; N]>) {
    let mut merged = BTreeMap::new();
    for (&node, weights) in nodes.iter().zip(weights) {
        let sums = merged.entry(node).or_insert([0.0; N]);
        sums.iter_mut().zip(weights).for_each(|(sum, weight)| *sum += weight);
    }
    merged.into_iter().unzip()
}

/// The surface that carries pressure and contact, and is shown: points, and the facets between them.
#[derive(Clone, Debug, Default)]
pub struct SampledSurface {
    /// The points of all vertices, then of all edge midpoints.
    pub samples: Vec<Sample>,
    /// Four facets for each triangle.
    pub facets: Vec<[u32; 3]>,
    /// How many of the samples are vertices.
    pub vertices: usize,
    /// Of each sample how thick the wall is there at rest, mm.
    pub thickness: Vec<f64>,
}

impl SampledSurface {
    /// The points of `triangles` over the vertices `0..vertices` of a wall of `section`.
    ///
    /// # Panics
    /// When a vertex has no triangle.
    #[must_use]
    pub fn new(
        triangles: &[[u32; 3]],
        points: &[ElementPoints],
        vertices: usize,
        section: &Section,
    ) -> Self {
        let mut samples: Vec<Option<Sample>> = vec![None; vertices];
        let mut thickness: Vec<f64> = (0..vertices as u32).map(|v| section.thickness(v)).collect();
        let mut edges = BTreeMap::new();
        let mut facets = Vec::with_capacity(4 * triangles.len());
        for (corners, points) in triangles.iter().zip(points) {
            let local: [u32; 6] = std::array::from_fn(|point| {
                let index = if point < 3 {
                    corners[point] as usize
                } else {
                    let [a, b] = [corners[(point + 1) % 3], corners[(point + 2) % 3]];
                    *edges.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                        samples.push(None);
                        thickness.push(0.5 * (section.thickness(a) + section.thickness(b)));
                        samples.len() - 1
                    })
                };
                samples[index].get_or_insert_with(|| points.sample(point));
                index as u32
            });
            facets.extend(SUBTRIANGLES.map(|facet| facet.map(|point| local[point])));
        }
        let samples = samples.into_iter().map(|s| s.expect("every vertex has a triangle"));
        Self { samples: samples.collect(), facets, vertices, thickness }
    }

    /// The surface where the nodes are at `positions`, finer than its facets: over each triangle the quadratic through its six points,
    /// in `n x n` facets, one triangle after the other; and how thick the wall is at rest at each of its vertices, mm.
    ///
    /// # Panics
    /// When `n` is 0.
    #[must_use]
    pub fn quadratic(&self, positions: &[Vec3], n: usize) -> (TriangleMesh, Vec<f64>) {
        assert!(n > 0, "a triangle is at least one facet");
        let samples = self.at(positions);
        let mut fine = TriangleMesh { positions: Vec::new(), triangles: Vec::new() };
        let mut thickness = Vec::new();
        let mut known = BTreeMap::new();
        for facets in self.facets.as_chunks::<4>().0 {
            let [[p0, p5, p4], [p1, p3, _], [p2, ..], _] = *facets;
            let corners = [p0, p1, p2];
            let points = [p0, p1, p2, p3, p4, p5].map(|point| samples[point as usize]);
            // A point is known by the corners about it and its share of each.
            let mut vertex = |shares: [usize; 3]| {
                let mut key: Vec<(u32, usize)> =
                    corners.into_iter().zip(shares).filter(|(_, share)| *share > 0).collect();
                key.sort_unstable();
                *known.entry(key).or_insert_with(|| {
                    let l = shares.map(|share| share as f64 / n as f64);
                    let weights = [0, 1, 2].map(|k| l[k] * (2.0 * l[k] - 1.0));
                    let middle = FACE_EDGES.map(|[a, b]| 4.0 * l[a] * l[b]);
                    let weights = weights.into_iter().chain(middle);
                    fine.positions.push(points.iter().zip(weights).map(|(x, w)| w * x).sum());
                    let [first, second, third] = corners.map(|p| self.thickness[p as usize]);
                    // Where all are the same, so is their mean, to the bit.
                    thickness.push(first + l[1] * (second - first) + l[2] * (third - first));
                    fine.positions.len() as u32 - 1
                })
            };
            for i in 0..n {
                for j in 0..n - i {
                    let k = n - i - j;
                    let [a, b, c] =
                        [[k, i, j], [k - 1, i + 1, j], [k - 1, i, j + 1]].map(&mut vertex);
                    fine.triangles.push([a, b, c]);
                    if k > 1 {
                        fine.triangles.push([b, vertex([k - 2, i + 1, j + 1]), c]);
                    }
                }
            }
        }
        (fine, thickness)
    }

    /// Thickness of the wall where it is thickest, mm.
    #[must_use]
    pub fn thickest(&self) -> f64 {
        self.thickness.iter().copied().fold(0.0, f64::max)
    }

    /// The points where the nodes are at `positions`, mm.
    #[must_use]
    pub fn at(&self, positions: &[Vec3]) -> Vec<Vec3> {
        self.samples.iter().map(|sample| sample.point(positions)).collect()
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use crate::model::test_shells::TestShell;

    /// Halved triangles are the surface's own facets; finer ones stay closed, and their volumes converge with the square of the edge
    /// to one limit.
    #[test]
    fn quadratic_surface_is_closed_and_converges() {
        let shell = TestShell::new(1);
        let surface = shell.surface();
        let volume = |n: usize| {
            let (fine, _) = surface.quadratic(&shell.reference, n);
            assert_eq!(fine.check_closed_manifold(), Ok(()));
            assert_eq!(fine.triangles.len(), n * n * shell.mesh.surface.triangles.len());
            fine.volume()
        };
        let own = crate::surface::TriangleMesh {
            positions: surface.at(&shell.reference),
            triangles: surface.facets.clone(),
        };
        assert_relative_eq!(volume(2), own.volume(), max_relative = 1e-13);
        let limits = [4, 8].map(|n| (4.0 * volume(2 * n) - volume(n)) / 3.0);
        // Errors of fourth order: a volume is a polynomial, whose rest is (1/4)^4 of the whole at most.
        assert_relative_eq!(limits[0], limits[1], max_relative = 1e-4);
    }
}
