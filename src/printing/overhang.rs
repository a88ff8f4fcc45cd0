//! What overhangs when a part is built along an axis?
//!
//! ```text
//! a triangle overhangs where -n . u > cos(limit)        n: outward normal, u: the way up; unless it lies on the bed
//! ```
//! Of a sphere away from the bed that is a cap, `(1 - cos(limit)) / 2` of its area. The limit of 45 degrees is the usual one of
//! printers of filament: each layer reaches out by no more than its height.

use std::f64::consts::FRAC_PI_4;
use std::ops::Range;

use crate::math::Vec3;
use crate::surface::TriangleMesh;

/// The way up of a print: an axis of the part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BuildDirection {
    /// 0, 1, 2 for x, y, z.
    pub axis: usize,
    /// Whether it is the axis itself, or the way against it.
    pub forward: bool,
}

impl BuildDirection {
    /// All six.
    pub const ALL: [Self; 6] = {
        const fn along(axis: usize, forward: bool) -> BuildDirection {
            BuildDirection { axis, forward }
        }
        [
            along(2, true),
            along(2, false),
            along(0, true),
            along(0, false),
            along(1, true),
            along(1, false),
        ]
    };

    /// The unit vector.
    #[must_use]
    pub fn vector(&self) -> Vec3 {
        let mut up = Vec3::zeros();
        up[self.axis] = if self.forward { 1.0 } else { -1.0 };
        up
    }

    /// `+z` and so on.
    #[must_use]
    pub fn name(&self) -> &'static str {
        [["+x", "-x"], ["+y", "-y"], ["+z", "-z"]][self.axis][usize::from(!self.forward)]
    }
}

/// What overhangs in one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overhang {
    /// Share of the area that overhangs.
    pub share: f64,
    /// Share of the area that overhangs in the chamber, where no support comes out again.
    pub chamber_share: f64,
    /// Area that overhangs outside of the chamber, seen from above, mm^2: what supports would carry.
    pub support_area: f64,
    /// Of the part, mm.
    pub height: f64,
}

/// What of `surface`, whose triangles `chamber` bound the chamber, overhangs when built `up`; triangles below `bed` (mm) over the
/// lowest point lie on the bed.
#[must_use]
pub fn overhang(
    surface: &TriangleMesh,
    chamber: &Range<usize>,
    up: BuildDirection,
    bed: f64,
) -> Overhang {
    let up = up.vector();
    let heights: Vec<f64> = surface.positions.iter().map(|p| p.dot(&up)).collect();
    let lowest = heights.iter().copied().fold(f64::INFINITY, f64::min);
    let highest = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let lies = |t: usize| surface.triangles[t].iter().all(|&v| heights[v as usize] < lowest + bed);
    let (mut whole, mut in_chamber, mut support_area) = (0.0, 0.0, 0.0);
    for t in 0..surface.triangles.len() {
        let area = surface.area_vector(t);
        let below = -area.dot(&up);
        if below <= LIMIT.cos() * area.norm() || lies(t) {
            continue;
        }
        whole += area.norm();
        if chamber.contains(&t) {
            in_chamber += area.norm();
        } else {
            support_area += below;
        }
    }
    let area = surface.area();
    let (share, chamber_share) = (whole / area, in_chamber / area);
    Overhang { share, chamber_share, support_area, height: highest - lowest }
}

/// From the vertical; 45 degrees.
const LIMIT: f64 = FRAC_PI_4;

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_1_SQRT_2, PI};

    use approx::assert_relative_eq;

    use super::*;
    use crate::printing::test_shapes::{ball, brick, hollow};

    /// A cap of the outer sphere, and one of the void that looks down at its top.
    #[test]
    fn caps_of_spheres_overhang() {
        let (outer, inner) = (ball([0.0; 3], 10.0), ball([0.0; 3], 8.0));
        let solid = hollow(&outer, std::slice::from_ref(&inner));
        let chamber = outer.triangles.len()..solid.triangles.len();
        let cap = 0.5 * (1.0 - FRAC_1_SQRT_2);
        for up in BuildDirection::ALL {
            let found = overhang(&solid, &chamber, up, 0.0);
            // Whole facets of some 4 degrees count where a cap of 45 degrees ends: by chance, half of them in 45 / 2.
            assert_relative_eq!(found.share, cap, max_relative = 0.02);
            let inside = cap * inner.area() / solid.area();
            assert_relative_eq!(found.chamber_share, inside, max_relative = 0.02);
            // Seen from above the cap is a disc of radius R sin 45.
            assert_relative_eq!(found.support_area, PI * 50.0, max_relative = 0.04);
            // Icosahedra have no vertex on the axes; the facets sag by 0.01 mm.
            assert!((found.height - 20.0).abs() < 0.03, "{found:?}");
        }
    }

    /// Two roofs of 10 x 20 mm, at 3 and 0 mm below: what lies on the bed needs no support.
    #[test]
    fn what_lies_on_the_bed_does_not_overhang() {
        let table = brick([0.0; 3], [10.0, 20.0, 2.0]);
        let upper = brick([0.0, 0.0, 5.0], [10.0, 20.0, 6.0]);
        let both = table.joined(&upper);
        let up = BuildDirection::ALL[0];
        let found = overhang(&both, &(0..0), up, 0.2);
        assert_eq!((found.support_area, found.chamber_share, found.height), (200.0, 0.0, 6.0));
        // 2 x (200 + 200) of the flat faces, 60 x (2 + 1) of the sides.
        assert_relative_eq!(found.share, 200.0 / 980.0, max_relative = 1e-12);
        assert_eq!(overhang(&both, &(0..0), BuildDirection::ALL[3], 0.2).support_area, 0.0);
        let names = BuildDirection::ALL.map(|up| up.name());
        assert_eq!(names, ["+z", "-z", "+x", "-x", "+y", "-y"]);
    }
}
