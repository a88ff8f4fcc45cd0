//! Shapes with closed forms, for the tests of this room.

use crate::math::Vec3;
use crate::surface::test_fields::{Analytic, capped};
use crate::surface::{RemeshSettings, TriangleMesh, isosurface, remesh};

use super::opening::SEGMENTS;
use super::part::turned;

/// A box of twelve triangles.
pub(super) fn brick(lower: [f64; 3], upper: [f64; 3]) -> TriangleMesh {
    let corner = |i: usize| {
        Vec3::from_fn(|axis, _| if i >> axis & 1 == 1 { upper[axis] } else { lower[axis] })
    };
    let quads =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    TriangleMesh {
        positions: (0..8).map(corner).collect(),
        triangles: quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
    }
}

/// `outer` with the voids `inner`, which do not touch.
pub(super) fn hollow(outer: &TriangleMesh, inner: &[TriangleMesh]) -> TriangleMesh {
    inner.iter().fold(outer.clone(), |solid, void| solid.joined(&turned(void)))
}

/// A sphere about `centre`.
pub(super) fn ball(centre: [f64; 3], radius: f64) -> TriangleMesh {
    let mut mesh = TriangleMesh::sphere(radius, 4);
    mesh.positions.iter_mut().for_each(|p| *p += Vec3::from(centre));
    mesh
}

/// A cylinder about the z axis between z = 0 and `height`, remeshed: its rims are rounded within an edge.
pub(super) fn cylinder(radius: f64, height: f64, edge: f64) -> TriangleMesh {
    let side = Analytic(move |p: Vec3| p.x.hypot(p.y) - radius);
    let half = radius + 2.0;
    let (lower, upper) = (Vec3::new(-half, -half, 0.0), Vec3::new(half, half, height));
    let field = capped(side, lower, upper);
    let rough = isosurface(&field, lower, upper, 0.6 * edge);
    remesh(&rough, Some(&field), &RemeshSettings { edge, iterations: 10 }).unwrap()
}

/// The area of the polygon that stands for a circle of `radius`, mm^2.
pub(super) fn polygon_area(radius: f64) -> f64 {
    let n = SEGMENTS as f64;
    0.5 * n * radius * radius * (std::f64::consts::TAU / n).sin()
}
