//! Where on the base is room for an inlet? The largest disc of flat wall with the chamber above it.
//!
//! The base is looked at from below on a grid. The middle of the disc is the grid point farthest from all that is no base: the pole
//! of inaccessibility of a region (Garcia-Castellanos and Lombardo, 2007, Scottish Geographical Journal 123:227-233).

use crate::field::ScalarField;
use crate::math::{Rejected, Room, Vec3};
use crate::mesh::WallSurfaces;
use crate::surface::SignedDistance;

/// The largest disc that fits on the base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BaseDisc {
    /// x and y of its middle, mm.
    pub centre: [f64; 2],
    /// Its radius, known to a grid step, mm.
    pub radius: f64,
    /// The lowest z of the part, mm.
    pub bottom: f64,
}

impl BaseDisc {
    /// The disc of `wall`, whose wall is `thickness` thick, mm.
    ///
    /// # Errors
    /// [`Rejected`] with the reason `no_base` when the wall is nowhere flat below the chamber; as [`SignedDistance::new`].
    pub(super) fn of(wall: &WallSurfaces, thickness: f64) -> Result<Self, Rejected> {
        let outer = SignedDistance::new(&wall.outer)?;
        let chamber = SignedDistance::new(&wall.chamber)?;
        let (lower, upper) = outer.bounds();
        let is_base = |x: f64, y: f64| {
            let below = Vec3::new(x, y, lower.z);
            let above = Vec3::new(x, y, lower.z + (1.0 + ABOVE) * thickness);
            outer.value(below).abs() < FLAT * thickness && chamber.value(above) < 0.0
        };
        // One row of grid points beyond the part on either side is no base.
        let counts = [0, 1].map(|axis| ((upper[axis] - lower[axis]) / STEP).ceil() as usize + 3);
        let place = |k: usize| {
            let (i, j) = (k / counts[1], k % counts[1]);
            [lower.x + (i as f64 - 1.0) * STEP, lower.y + (j as f64 - 1.0) * STEP]
        };
        let base: Vec<bool> =
            (0..counts[0] * counts[1]).map(|k| is_base(place(k)[0], place(k)[1])).collect();
        let is_border = |k: usize| {
            let beside =
                [k.checked_sub(1), Some(k + 1), k.checked_sub(counts[1]), Some(k + counts[1])];
            beside.iter().flatten().any(|&other| base.get(other) == Some(&true))
        };
        let borders: Vec<[f64; 2]> =
            (0..base.len()).filter(|&k| !base[k] && is_border(k)).map(place).collect();
        let room = |[x, y]: [f64; 2]| {
            let away = borders.iter().map(|[bx, by]| (bx - x).hypot(by - y));
            away.fold(f64::INFINITY, f64::min)
        };
        let points = (0..base.len()).filter(|&k| base[k]).map(place);
        let best = points.map(|p| (p, room(p))).max_by(|a, b| a.1.total_cmp(&b.1));
        let Some((centre, radius)) = best else {
            let detail = "the wall is nowhere flat at its lowest height with the chamber above it"
                .to_owned();
            return Err(Rejected::new(Room::Printing, "no_base", detail, 1.0));
        };
        Ok(Self { centre, radius: radius - STEP, bottom: lower.z })
    }
}

/// Of the grid, mm.
const STEP: f64 = 0.25;
/// The base is flat within this share of the thickness; the middle of a shell's base ripples by some hundredths of a millimetre.
const FLAT: f64 = 0.1;
/// The chamber must be open so many thicknesses above its floor.
const ABOVE: f64 = 0.25;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{WallSettings, wall_surfaces};
    use crate::printing::test_shapes::{ball, cylinder};

    fn disc(mid: &crate::surface::TriangleMesh) -> BaseDisc {
        let wall = wall_surfaces(mid, 1.6, &WallSettings { edge: 1.5, ..WallSettings::default() });
        BaseDisc::of(&wall.unwrap(), 1.6).unwrap()
    }

    /// The middle's rim is rounded within an edge of 1.5 mm; the flat ends there, or on the outer face up to 0.16 mm of height later.
    #[test]
    fn a_cylinder_has_its_base_about_the_axis() {
        let disc = disc(&cylinder(10.0, 20.0, 1.5));
        assert!(disc.centre[0].hypot(disc.centre[1]) < 0.5, "{disc:?}");
        assert!((7.5..10.0).contains(&disc.radius), "{disc:?}");
        // Remeshed caps are flat to 1e-6 of an edge; their wall is projected to 1e-6 of its own.
        assert!((disc.bottom + 0.8).abs() < 1e-4, "{disc:?}");
    }

    /// The outer face of radius 8.8 mm is within 0.16 mm of its lowest point up to r = sqrt(0.16 (17.6 - 0.16)) = 1.67 mm, known to
    /// a step of 0.25 mm, and its facets sag by some hundredths.
    #[test]
    fn a_ball_has_hardly_a_base() {
        let disc = disc(&ball([0.0, 0.0, 0.0], 8.0));
        assert!(disc.radius < 1.9 && disc.radius > 0.9, "{disc:?}");
    }
}
