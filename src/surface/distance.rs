//! The signed distance to a closed triangle surface.
//!
//! ```text
//! d(x) = s |x - c|,   c: the nearest point of the surface,   s = -1 where (x - c) . n < 0, else 1
//! ```
//! `n` belongs to what `c` lies on: the normal of a triangle, the sum of the two normals at an edge, or the sum of the normals
//! around a vertex weighted by their angles, which tell the inside from the outside without exception. The nearest triangle is
//! found in a tree of boxes ([`FacetTree`](super::facet_tree)). A surface that passes through itself has no inside: the sign means nothing there.
//!
//! Source: Baerentzen and Aanaes (2005), Signed distance computation using the angle weighted pseudonormal, IEEE Trans. Vis.
//! Comput. Graph. 11:243-253; Ericson (2005), Real-time collision detection, section 5.1.5, for the nearest point.

use crate::field::ScalarField;
use crate::math::{Vec3, angle_between};

use super::facet_tree::{Facet, FacetTree, Nearest};
use super::half_edges::{next, previous};
use super::{HalfEdges, MeshDefect, TriangleMesh};

/// A closed surface that can be asked for its distance, mm, negative inside.
#[derive(Clone, Debug)]
pub struct SignedDistance {
    tree: FacetTree,
}

impl SignedDistance {
    /// The distance to `mesh`.
    ///
    /// # Errors
    /// [`MeshDefect`] unless the mesh is a closed, outward-oriented 2-manifold.
    pub fn new(mesh: &TriangleMesh) -> Result<Self, MeshDefect> {
        mesh.check_closed_manifold()?;
        Ok(Self { tree: FacetTree::new(facets(mesh)?) })
    }

    /// The lower and upper corner of the box around the surface, mm.
    #[must_use]
    pub fn bounds(&self) -> (Vec3, Vec3) {
        let around = self.tree.bounds();
        (around.low, around.high)
    }

    /// The triangle nearest to `point`.
    #[must_use]
    pub fn nearest_triangle(&self, point: Vec3) -> usize {
        self.tree.numbers[self.tree.nearest(point, f64::INFINITY).facet] as usize
    }

    /// The triangles in the order of the facets of the tree.
    pub(super) fn triangles(&self) -> impl Iterator<Item = usize> {
        self.tree.numbers.iter().map(|&triangle| triangle as usize)
    }

    pub(super) fn tree(&self) -> &FacetTree {
        &self.tree
    }

    /// The distance at `point`, known to be at most `bound` in size, its gradient, and the nearest point of the surface.
    pub(super) fn nearest(&self, point: Vec3, bound: f64) -> (f64, Vec3, Nearest) {
        let nearest = self.tree.nearest(point, bound);
        let normal = self.tree.normals[nearest.facet][nearest.feature];
        let away = point - nearest.point;
        let sign = if away.dot(&normal) < 0.0 { -1.0 } else { 1.0 };
        let distance = nearest.squared_distance.sqrt();
        let unit = if distance > ON_SURFACE { sign * away / distance } else { normal.normalize() };
        (sign * distance, unit, nearest)
    }
}

impl ScalarField for SignedDistance {
    fn value(&self, point: Vec3) -> f64 {
        self.value_and_gradient(point).0
    }

    fn value_and_gradient(&self, point: Vec3) -> (f64, Vec3) {
        let (distance, gradient, _) = self.nearest(point, f64::INFINITY);
        (distance, gradient)
    }
}

fn facets(mesh: &TriangleMesh) -> Result<Vec<Facet>, MeshDefect> {
    let surface = HalfEdges::try_from(mesh)?;
    let face_normals: Vec<Vec3> = (0..mesh.triangles.len())
        .map(|t| mesh.area_vector(t).try_normalize(0.0).unwrap_or_default())
        .collect();
    let normal_left_of = |h: u32| face_normals[h as usize / 3];
    let position = |h: u32| mesh.positions[surface.origin(h) as usize];
    let angle_at = |h: u32| {
        let [a, b] = [next(h), previous(h)].map(|g| position(g) - position(h));
        angle_between(a, b)
    };
    let corner_normals: Vec<Vec3> = (0..mesh.positions.len() as u32)
        .map(|v| surface.spokes(v).map(|h| angle_at(h) * normal_left_of(h)).sum())
        .collect();
    let facet = |(t, &triangle): (usize, &[u32; 3])| {
        let half_edges = [0, 1, 2].map(|k| 3 * t as u32 + k);
        let [ab, bc, ca] = half_edges.map(|h| face_normals[t] + normal_left_of(surface.twin(h)));
        let [a, b, c] = triangle.map(|v| corner_normals[v as usize]);
        Facet {
            number: t as u32,
            corners: mesh.corners(t),
            normals: [face_normals[t], ab, bc, ca, a, b, c],
        }
    };
    Ok(mesh.triangles.iter().enumerate().map(facet).collect())
}

/// Nearer than this, mm, the direction to the nearest point is rounding.
const ON_SURFACE: f64 = 1e-9;

#[cfg(test)]
mod tests {
    use approx::{assert_abs_diff_eq, assert_relative_eq};
    use proptest::prelude::*;

    use super::*;
    use crate::surface::facet_tree::nearest_on_triangle;
    use crate::surface::test_fields::Analytic;

    const HALF: Vec3 = Vec3::new(3.0, 2.0, 1.0);

    fn brick() -> TriangleMesh {
        let corner = |i: u32| Vec3::from_fn(|axis, _| if i >> axis & 1 == 1 { 1.0 } else { -1.0 });
        let quads =
            [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        TriangleMesh {
            positions: (0..8).map(|i| corner(i).component_mul(&HALF)).collect(),
            triangles: quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
        }
    }

    fn distance_to_brick(p: Vec3) -> f64 {
        let q = p.abs() - HALF;
        q.sup(&Vec3::zeros()).norm() + q.max().min(0.0)
    }

    proptest! {
        /// Nearest to faces, edges and corners alike; the tolerance is a few roundings.
        #[test]
        fn brick_has_its_closed_form(x in -6.0..6.0, y in -4.0..4.0, z in -3.0..3.0) {
            let point = Vec3::new(x, y, z);
            let (value, gradient) = SignedDistance::new(&brick()).unwrap().value_and_gradient(point);
            assert_abs_diff_eq!(value, distance_to_brick(point), epsilon = 1e-14);
            assert_relative_eq!(gradient.norm(), 1.0, max_relative = 1e-12);
            // A step of 1e-6 mm from a kink mixes two slopes: looked at elsewhere.
            let slopes = Analytic(distance_to_brick).value_and_gradient(point).1;
            if (slopes.norm() - 1.0).abs() < 1e-6 {
                // Differences of 1e-6 mm lose ten digits.
                assert_abs_diff_eq!(gradient, slopes, epsilon = 1e-5);
            }
        }

        /// The tree finds what a search of all triangles finds.
        #[test]
        fn tree_misses_nothing(x in -15.0..15.0, y in -15.0..15.0, z in -15.0..15.0) {
            let (mesh, point) = (TriangleMesh::sphere(10.0, 3), Vec3::new(x, y, z));
            let distance = SignedDistance::new(&mesh).unwrap();
            let all = (0..mesh.triangles.len())
                .map(|t| (point - nearest_on_triangle(point, mesh.corners(t)).0).norm())
                .fold(f64::INFINITY, f64::min);
            prop_assert_eq!(distance.value(point).abs(), all);
            prop_assert_eq!(distance.nearest(point, all).0, distance.value(point));
        }
    }

    /// Beyond the tip of a needle, a point is behind the plane of one of its faces: only the mean of the normals tells.
    #[test]
    fn tip_of_a_needle_is_inside_on_one_side_only() {
        let base = |angle: f64| Vec3::new(angle.cos(), angle.sin(), 0.0);
        let needle = TriangleMesh {
            positions: vec![base(0.0), base(2.0), base(4.0), Vec3::new(4.0, 0.0, 9.0)],
            triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
        };
        let distance = SignedDistance::new(&needle).unwrap();
        let tip = needle.positions[3];
        let inward = (Vec3::zeros() - tip).normalize();
        let is_behind = |point: Vec3, t: usize| {
            needle.area_vector(t).dot(&(point - needle.corners(t)[0])) < 0.0
        };
        let mut behind_one = 0;
        for i in 0..400 {
            let angle = 0.1 * f64::from(i);
            let direction =
                Vec3::new(angle.cos(), (1.7 * angle).sin(), (0.6 * angle).cos()).normalize();
            let point = tip + 0.2 * direction + 0.05 * inward;
            let planes = (0..4).filter(|&t| is_behind(point, t)).count();
            assert_eq!(distance.value(point) < 0.0, planes == 4, "{point}");
            behind_one += usize::from((1..4).contains(&planes));
        }
        assert!(behind_one > 100, "{behind_one}");
    }

    #[test]
    fn open_surfaces_have_no_inside() {
        let mut mesh = brick();
        mesh.triangles.pop();
        assert_eq!(SignedDistance::new(&mesh).unwrap_err(), MeshDefect::OpenEdges { edges: 3 });
    }
}
