//! How thick is the material below each triangle?
//!
//! ```text
//! thickness(t) = the way from the middle of t against its normal to where the material ends
//! ```
//! The way is marched by the distance to the surface, which nothing is nearer than (sphere tracing). Where the faces of a wall are
//! parallel it is their distance; elsewhere it is larger. Ways that end on a face leaning by more than 30 degrees cut off an edge, not a
//! wall, and are left out: at the rim of a bore through a slope they would be as short as one likes.
//!
//! Source: Shapira, Shamir and Cohen-Or (2008), Consistent mesh partitioning and skeletonisation using the shape diameter function,
//! The Visual Computer 24:249-259, with one ray; Hart (1996), Sphere tracing, The Visual Computer 12:527-545.

use rayon::prelude::*;

use crate::field::ScalarField;
use crate::math::Vec3;
use crate::surface::{MeshDefect, SignedDistance, TriangleMesh};

/// How thick a body is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thickness {
    /// The least, mm.
    pub least: f64,
    /// The middle of the material there, mm.
    pub place: Vec3,
    /// The share of the area below which the material is thinner than asked for.
    pub thin_share: f64,
}

/// The thickness of the body in the closed `surface`; `wanted` (mm) is what counts as thin.
///
/// # Errors
/// [`MeshDefect`] unless the surface is a closed, outward-oriented 2-manifold.
pub fn thickness(surface: &TriangleMesh, wanted: f64) -> Result<Thickness, MeshDefect> {
    let distance = SignedDistance::new(surface)?;
    let (lower, upper) = distance.bounds();
    let longest = (upper - lower).norm();
    let facets: Vec<Option<(f64, Vec3, f64)>> = (0..surface.triangles.len())
        .into_par_iter()
        .map(|t| {
            let [a, b, c] = surface.corners(t);
            let area = surface.area_vector(t);
            let inward = -area.try_normalize(0.0)?;
            let start = (a + b + c) / 3.0;
            let way = marched(&distance, start, inward, longest)?;
            Some((way, start + 0.5 * way * inward, area.norm()))
        })
        .collect();
    let known = || facets.iter().flatten();
    let (least, place) = known()
        .map(|(way, place, _)| (*way, *place))
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .unwrap_or((longest, 0.5 * (lower + upper)));
    let thin: f64 = known().filter(|(way, ..)| *way < wanted).map(|(.., area)| area).sum();
    Ok(Thickness { least, place, thin_share: thin / surface.area() })
}

/// The way from `start`, a point of the surface, along `inward` to where the material ends, mm; none when that is not found, or at an
/// edge.
fn marched(distance: &SignedDistance, start: Vec3, inward: Vec3, longest: f64) -> Option<f64> {
    let mut way = DEPARTURE;
    for _ in 0..MOST_STEPS {
        let (value, outward) = distance.value_and_gradient(start + way * inward);
        let depth = -value;
        if depth < ARRIVAL {
            return (outward.dot(&inward) > LEAST_FACING).then_some(way + depth);
        }
        way += depth;
        if way > longest {
            return None;
        }
    }
    None
}

/// The first step, mm: far enough from the triangle itself.
const DEPARTURE: f64 = 0.01;
/// What counts as the surface, mm; printers resolve hundredths.
const ARRIVAL: f64 = 1e-3;
/// Between the way and the normal where it ends: 30 degrees.
const LEAST_FACING: f64 = 0.866;
/// Along an edge the distance is a small constant: 50 mm at 0.1 mm.
const MOST_STEPS: usize = 500;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::printing::test_shapes::{ball, brick, hollow};

    /// A void of radius 7 mm, 0.5 mm aside in a ball of 10 mm, leaves 2.5 mm on one side and 3.5 mm on the other.
    #[test]
    fn the_thinnest_place_is_found() {
        let solid = hollow(&ball([0.0; 3], 10.0), &[ball([0.5, 0.0, 0.0], 7.0)]);
        let found = thickness(&solid, 3.0).unwrap();
        // Facets of 10 mm / 16 sag by 0.01 mm on either side, and the nearest middle of one is half an edge from the axis.
        assert!((found.least - 2.5).abs() < 0.03, "{found:?}");
        // The wall is thinner than 3 mm on the half towards x, up to where the ways lean.
        assert!((found.place - Vec3::new(8.75, 0.0, 0.0)).norm() < 0.6, "{found:?}");
        assert!((0.45..0.55).contains(&found.thin_share), "{found:?}");
        assert_eq!(thickness(&solid, 2.0).unwrap().thin_share, 0.0);
    }

    /// A roof whose eaves are edges of 45 degrees, 4 mm high: ways from its slopes end on the floor, which leans from them by 45 degrees,
    /// and so do those from the floor on the slopes; only the gables face each other.
    #[test]
    fn edges_are_no_walls() {
        let gable = |y: f64| [[-4.0, y, 0.0], [4.0, y, 0.0], [0.0, y, 4.0]].map(Vec3::from);
        let roof = TriangleMesh {
            positions: [gable(0.0), gable(9.0)].concat(),
            triangles: vec![
                [0, 1, 2],
                [3, 5, 4],
                [0, 3, 4],
                [0, 4, 1],
                [1, 4, 5],
                [1, 5, 2],
                [2, 5, 3],
                [2, 3, 0],
            ],
        };
        assert_eq!(roof.check_closed_manifold(), Ok(()));
        let found = thickness(&roof, 1.0).unwrap();
        // The march ends within 1e-3 mm.
        assert!((found.least - 9.0).abs() < 1e-3 && found.thin_share == 0.0, "{found:?}");
    }

    #[test]
    fn walls_of_a_box_have_their_thickness() {
        let solid = hollow(
            &brick([0.0; 3], [20.0, 30.0, 10.0]),
            &[brick([2.0, 1.5, 3.0], [18.0, 28.0, 9.0])],
        );
        let found = thickness(&solid, 1.2).unwrap();
        // The roof is 1 mm; the march ends within 1e-3 mm.
        assert!((found.least - 1.0).abs() < 1e-3, "{found:?}");
        assert!((found.place.z - 9.5).abs() < 1e-3, "{found:?}");
    }
}
