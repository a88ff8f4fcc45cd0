//! A round opening cut into a surface from below, its rim a polygon on the surface.
//!
//! The triangles about the opening are taken out, and a Delaunay triangulation of the ring between the rim and what is left takes
//! their place, seen from below. All other triangles keep their bits.
//!
//! Source: Chew (1989), Constrained Delaunay triangulations, Algorithmica 4:97-108.

use std::collections::BTreeMap;

use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

use crate::math::{Reason, Rejected, Room, Vec3};
use crate::surface::{HalfEdges, TriangleMesh, over_used_vertices};

/// A circle about a vertical axis, as a polygon.
#[derive(Clone, Copy, Debug)]
pub(super) struct Circle {
    /// x and y of the axis, mm.
    pub centre: [f64; 2],
    /// Of the polygon's corners, mm.
    pub radius: f64,
}

impl Circle {
    /// The corners, counter-clockwise seen from above, mm.
    pub(super) fn corners(self) -> impl Iterator<Item = [f64; 2]> {
        let Self { centre: [x, y], radius } = self;
        (0..SEGMENTS).map(move |k| {
            let angle = std::f64::consts::TAU * k as f64 / SEGMENTS as f64;
            [x + radius * angle.cos(), y + radius * angle.sin()]
        })
    }
}

/// Corners of a circle: chords of a radius of 3 mm are 6 micrometres from it.
pub(super) const SEGMENTS: usize = 48;

/// A surface with an opening.
#[derive(Clone, Debug)]
pub(super) struct Opened {
    /// Open at the rim alone.
    pub mesh: TriangleMesh,
    /// The vertices of the rim, counter-clockwise seen from above.
    pub rim: Vec<u32>,
}

/// `mesh`, a closed surface, without the disc of `circle` in its lowest sheet, which faces down there.
///
/// # Errors
/// [`Rejected`] with the reason `base_uneven` when the sheet is steep or ends about the circle.
pub(super) fn opened(mesh: &TriangleMesh, circle: &Circle) -> Result<Opened, Rejected> {
    let surface = HalfEdges::try_from(mesh)?;
    let patch = patch(mesh, &surface, circle)?;
    let hem = hem(&surface, &patch)?;
    let taken: Vec<usize> = (0..patch.len()).filter(|&t| patch[t]).collect();
    let flat = |v: u32| [mesh.positions[v as usize].x, mesh.positions[v as usize].y];
    let hem_corners: Vec<[f64; 2]> = hem.iter().map(|&v| flat(v)).collect();
    let rim_corners: Vec<[f64; 2]> = circle.corners().collect();
    let height =
        |p: [f64; 2]| lowest(mesh, &taken, p).map(|(_, z)| z).ok_or_else(|| uneven("has a gap"));

    let first = mesh.positions.len() as u32;
    let mut positions = mesh.positions.clone();
    for &[x, y] in &rim_corners {
        positions.push(Vec3::new(x, y, height([x, y])?));
    }
    let numbers: Vec<u32> = (first..first + SEGMENTS as u32).chain(hem.iter().copied()).collect();
    let kept = mesh.triangles.iter().zip(&patch).filter(|(_, in_patch)| !**in_patch);
    let mut triangles: Vec<[u32; 3]> = kept.map(|(triangle, _)| *triangle).collect();
    for [a, b, c] in ring(&rim_corners, &hem_corners)? {
        // Counter-clockwise from above; the sheet faces down.
        triangles.push([a, c, b].map(|k| numbers[k]));
    }
    let (mesh, numbers) = over_used_vertices(&positions, &triangles);
    let rim = (first..first + SEGMENTS as u32).map(|v| numbers[v as usize]).collect();
    Ok(Opened { mesh, rim })
}

/// Which triangles reach into the circle or near it: `[triangles]`.
fn patch(mesh: &TriangleMesh, surface: &HalfEdges, circle: &Circle) -> Result<Vec<bool>, Rejected> {
    let everywhere: Vec<usize> = (0..mesh.triangles.len()).collect();
    let (seed, _) = lowest(mesh, &everywhere, circle.centre).ok_or_else(|| uneven("has a gap"))?;
    let reach = circle.radius + CLEARANCE;
    let mut patch = vec![false; mesh.triangles.len()];
    let mut queue = vec![seed];
    patch[seed] = true;
    let beside = |t: usize| [0, 1, 2].map(|k| surface.twin((3 * t + k) as u32) as usize / 3);
    while let Some(t) = queue.pop() {
        for other in beside(t) {
            if !patch[other] && distance_to(mesh.corners(other), circle.centre) < reach {
                patch[other] = true;
                queue.push(other);
            }
        }
    }
    // Notches of one triangle, which would make slivers.
    for t in 0..patch.len() {
        patch[t] |= beside(t).iter().filter(|&&other| patch[other]).count() > 1;
    }
    if (0..patch.len()).any(|t| patch[t] && facing_down(mesh, t) < LEAST_FACING) {
        return Err(uneven("is steep"));
    }
    Ok(patch)
}

/// The vertices around the `patch`, in order.
fn hem(surface: &HalfEdges, patch: &[bool]) -> Result<Vec<u32>, Rejected> {
    let mut following = BTreeMap::new();
    for h in 0..3 * patch.len() as u32 {
        let is_border = patch[h as usize / 3] && !patch[surface.twin(h) as usize / 3];
        if is_border && following.insert(surface.origin(h), surface.destination(h)).is_some() {
            return Err(uneven("is pinched"));
        }
    }
    let first = following.keys().next().copied().ok_or_else(|| uneven("has no end"))?;
    let around = std::iter::successors(Some(first), |v| {
        following.get(v).copied().filter(|next| *next != first)
    });
    let hem: Vec<u32> = around.take(following.len()).collect();
    if hem.len() < following.len() {
        return Err(uneven("has holes"));
    }
    Ok(hem)
}

/// The triangles between two polygons, one within the other, over the corners of `inner` and then `outer`, counter-clockwise.
fn ring(inner: &[[f64; 2]], outer: &[[f64; 2]]) -> Result<Vec<[usize; 3]>, Rejected> {
    let mut plane = ConstrainedDelaunayTriangulation::<Point2<f64>>::new();
    for polygon in [inner, outer] {
        let mut handles = Vec::with_capacity(polygon.len());
        for &[x, y] in polygon {
            handles.push(plane.insert(Point2::new(x, y)).map_err(|_| uneven("has no place"))?);
        }
        for (k, &from) in handles.iter().enumerate() {
            let to = handles[(k + 1) % handles.len()];
            if !plane.can_add_constraint(from, to) {
                return Err(uneven("is folded"));
            }
            plane.add_constraint(from, to);
        }
    }
    if plane.num_vertices() != inner.len() + outer.len() {
        return Err(uneven("has corners at one place"));
    }
    let mut triangles = Vec::new();
    for face in plane.inner_faces() {
        let corners = face.vertices();
        let triangle = corners.map(|corner| corner.fix().index());
        let is_hole = triangle.iter().all(|&k| k < inner.len());
        let centre = face.center();
        if !is_hole && is_within([centre.x, centre.y], outer) {
            triangles.push(triangle);
        }
    }
    Ok(triangles)
}

/// Whether a polygon surrounds `p`, by the parity of its crossings with a ray.
fn is_within([x, y]: [f64; 2], polygon: &[[f64; 2]]) -> bool {
    let crosses = |k: usize| {
        let ([ax, ay], [bx, by]) = (polygon[k], polygon[(k + 1) % polygon.len()]);
        (ay > y) != (by > y) && x < ax + (y - ay) / (by - ay) * (bx - ax)
    };
    (0..polygon.len()).filter(|&k| crosses(k)).count() % 2 == 1
}

/// Of the triangles `among` above or below `p`, the lowest and its height there, mm.
pub(super) fn lowest(mesh: &TriangleMesh, among: &[usize], p: [f64; 2]) -> Option<(usize, f64)> {
    let height = |t: usize| {
        let [a, b, c] = mesh.corners(t);
        let turn = |u: Vec3, v: Vec3| (u.x - p[0]) * (v.y - p[1]) - (u.y - p[1]) * (v.x - p[0]);
        let weights = [turn(b, c), turn(c, a), turn(a, b)];
        let is_above = weights.iter().all(|w| *w >= 0.0) || weights.iter().all(|w| *w <= 0.0);
        let sum: f64 = weights.iter().sum();
        let z = (weights[0] * a.z + weights[1] * b.z + weights[2] * c.z) / sum;
        (is_above && sum != 0.0).then_some((t, z))
    };
    among.iter().copied().filter_map(height).min_by(|a, b| a.1.total_cmp(&b.1))
}

/// The share of triangle `t` that faces down: the cosine of its slope.
pub(super) fn facing_down(mesh: &TriangleMesh, t: usize) -> f64 {
    let area = mesh.area_vector(t);
    -area.z / area.norm()
}

/// The horizontal distance of a triangle from a vertical axis, mm.
fn distance_to([a, b, c]: [Vec3; 3], axis: [f64; 2]) -> f64 {
    let [a, b, c] = [a, b, c].map(|v| [v.x - axis[0], v.y - axis[1]]);
    let turn = |u: [f64; 2], v: [f64; 2]| u[0] * v[1] - u[1] * v[0];
    let turns = [turn(a, b), turn(b, c), turn(c, a)];
    if turns.iter().all(|t| *t >= 0.0) || turns.iter().all(|t| *t <= 0.0) {
        return 0.0;
    }
    let to_segment = |[ux, uy]: [f64; 2], [vx, vy]: [f64; 2]| {
        let (dx, dy) = (vx - ux, vy - uy);
        let share = (-(ux * dx + uy * dy) / (dx * dx + dy * dy)).clamp(0.0, 1.0);
        let share = if share.is_finite() { share } else { 0.0 };
        (ux + share * dx).hypot(uy + share * dy)
    };
    to_segment(a, b).min(to_segment(b, c)).min(to_segment(c, a))
}

fn uneven(what: &str) -> Rejected {
    let detail = format!("the base {what} where the inlet should stand");
    Rejected::new(Room::Printing, Reason::BaseUneven, detail, 1.0)
}

/// Triangles nearer to the rim than this, mm, are made anew: they would be slivers.
const CLEARANCE: f64 = 0.3;
/// Of the triangles that are made anew: 75 degrees. Those about the opening may reach the rounded edge of the base.
const LEAST_FACING: f64 = 0.25;

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::printing::test_shapes::{cylinder, polygon_area};

    /// What is left is the cylinder without the disc, its rim in the plane of the base.
    #[test]
    fn a_disc_is_cut_out_of_the_base() {
        let mesh = cylinder(10.0, 20.0, 1.5);
        let circle = Circle { centre: [2.0, -1.0], radius: 2.5 };
        let opened = opened(&mesh, &circle).unwrap();
        assert_eq!(opened.rim.len(), SEGMENTS);
        let base = mesh.bounding_box().unwrap().0.z;
        for (&v, [x, y]) in opened.rim.iter().zip(circle.corners()) {
            let rim = opened.mesh.positions[v as usize];
            // The remeshed base is flat to 1e-6 of an edge.
            assert!((rim - Vec3::new(x, y, base)).norm() < 1e-5, "{rim}");
        }
        let taken = mesh.area() - opened.mesh.area();
        // As flat as the base.
        assert_relative_eq!(taken, polygon_area(2.5), max_relative = 1e-6);
        // A lid of triangles that face down closes it again.
        let mut closed = opened.mesh.clone();
        let rim = |k: usize| opened.rim[k % SEGMENTS];
        closed.triangles.extend((1..SEGMENTS - 1).map(|k| [rim(0), rim(k + 1), rim(k)]));
        assert_eq!(closed.check_closed_manifold(), Ok(()));
        assert_relative_eq!(closed.volume(), mesh.volume(), max_relative = 1e-6);
    }

    #[test]
    fn what_is_steep_is_refused() {
        let ball = TriangleMesh::sphere(3.0, 3);
        let rejection = opened(&ball, &Circle { centre: [0.0, 0.0], radius: 2.95 }).unwrap_err();
        assert_eq!(rejection.reason, Reason::BaseUneven, "{rejection}");
    }
}
