//! Where on the base is room for an inlet? The largest disc of low wall with the chamber right above it.
//!
//! The base is looked at from below on a grid. The middle of the disc is the grid point farthest from all that is no base: the pole
//! of inaccessibility of a region (Garcia-Castellanos and Lombardo, 2007, Scottish Geographical Journal 123:227-233).

use crate::math::{Reason, Rejected, Room};
use crate::mesh::WallSurfaces;
use crate::surface::TriangleMesh;

use super::opening::{facing_down, lowest};

/// The wall that is clamped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Base {
    /// Thickness of the wall, mm.
    pub thickness: f64,
    /// Of the base above the lowest point of the part, mm.
    pub height: f64,
}

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

impl Base {
    /// The largest disc on the base of `wall`.
    ///
    /// # Errors
    /// [`Rejected`] with the reason `no_base` when the chamber is nowhere right above wall that low.
    pub(super) fn disc(&self, wall: &WallSurfaces) -> Result<BaseDisc, Rejected> {
        let (lower, upper) = wall.outer.bounding_box().unwrap_or_default();
        let most_through = self.thickness / LEAST_FACING * (1.0 + SLACK);
        let top = lower.z + self.height;
        let outer = low_triangles(&wall.outer, top);
        let chamber = low_triangles(&wall.chamber, top + most_through);
        let is_base = |p: [f64; 2]| {
            let (Some(below), Some(above)) =
                (lowest(&wall.outer, &outer, p), lowest(&wall.chamber, &chamber, p))
            else {
                return false;
            };
            let is_level = facing_down(&wall.outer, below.0) > LEAST_FACING
                && facing_down(&wall.chamber, above.0) > LEAST_FACING;
            is_level && below.1 < top && above.1 - below.1 < most_through
        };
        // One row of grid points beyond the part on either side is no base.
        let counts = [0, 1].map(|axis| ((upper[axis] - lower[axis]) / STEP).ceil() as usize + 3);
        let place = |k: usize| {
            let (i, j) = (k / counts[1], k % counts[1]);
            [lower.x + (i as f64 - 1.0) * STEP, lower.y + (j as f64 - 1.0) * STEP]
        };
        let base: Vec<bool> = (0..counts[0] * counts[1]).map(|k| is_base(place(k))).collect();
        let is_border = |k: usize| {
            let (before, after) = (k.checked_sub(counts[1]), k + counts[1]);
            let beside = [k.checked_sub(1), Some(k + 1), before, Some(after)];
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
            let detail = format!(
                "nowhere within {:.1} mm of its lowest point is the wall level, with the chamber right above it",
                self.height
            );
            return Err(Rejected::new(Room::Printing, Reason::NoBase, detail, 1.0));
        };
        Ok(BaseDisc { centre, radius, bottom: lower.z })
    }
}

/// The triangles that begin below z = `top`, mm.
fn low_triangles(mesh: &TriangleMesh, top: f64) -> Vec<usize> {
    let is_low = |t: &usize| mesh.corners(*t).iter().any(|corner| corner.z < top);
    (0..mesh.triangles.len()).filter(is_low).collect()
}

/// Of the grid, mm.
const STEP: f64 = 0.25;
/// The least cosine between the base and the horizontal: 60 degrees.
const LEAST_FACING: f64 = 0.5;
/// What chords and fillets may add to the way through the wall, as a share.
const SLACK: f64 = 0.1;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;
    use crate::mesh::{WallSettings, wall_surfaces};
    use crate::printing::test_shapes::{ball, cylinder};
    use crate::surface::MidSurface;
    use crate::surface::isosurface;
    use crate::surface::test_fields::Analytic;

    fn disc(mid: &TriangleMesh) -> Result<BaseDisc, Rejected> {
        let wall = wall_surfaces(
            &MidSurface::uniform(mid.clone(), 1.6).unwrap(),
            &WallSettings { edge: 1.5, ..WallSettings::default() },
        );
        Base { thickness: 1.6, height: 2.4 }.disc(&wall.unwrap())
    }

    /// The middle's rim is rounded within an edge of 1.5 mm, where the base becomes steep.
    #[test]
    fn a_cylinder_has_its_base_about_the_axis() {
        let disc = disc(&cylinder(10.0, 20.0, 1.5)).unwrap();
        assert!(disc.centre[0].hypot(disc.centre[1]) < 0.5, "{disc:?}");
        assert!((7.5..10.0).contains(&disc.radius), "{disc:?}");
        // Remeshed caps are flat to 1e-6 of an edge; their wall is projected to 1e-6 of its own.
        assert!((disc.bottom + 0.8).abs() < 1e-4, "{disc:?}");
    }

    /// The outer face of radius 8.8 mm is lower than 2.4 mm up to sqrt(2.4 (17.6 - 2.4)) = 6.04 mm, the chamber of 7.2 mm is steep
    /// from 7.2 sin 60 = 6.2 mm on; a disc is known to the diagonal of a step, and facets of 1.5 mm decide.
    #[test]
    fn a_ball_has_a_round_base() {
        let disc = disc(&ball([0.0, 0.0, 0.0], 8.0)).unwrap();
        assert!(disc.centre[0].hypot(disc.centre[1]) < 0.5, "{disc:?}");
        assert!((5.0..6.4).contains(&disc.radius), "{disc:?}");
    }

    /// A cone whose sides rise by 75 degrees has its chamber 1.6 mm / cos 75 above the wall's tip.
    #[test]
    fn a_tip_has_no_base() {
        let (sin, cos) = 75.0_f64.to_radians().sin_cos();
        let field = Analytic(move |p: Vec3| (p.x.hypot(p.y) * sin - p.z * cos).max(p.z - 30.0));
        let (lower, upper) = (Vec3::new(-10.0, -10.0, -1.0), Vec3::new(10.0, 10.0, 31.0));
        let rejection = disc(&isosurface(&field, lower, upper, 0.8)).unwrap_err();
        assert_eq!(rejection.reason, Reason::NoBase, "{rejection}");
    }
}
