//! Levels beside the middle of a wall: its faces, and what is farther from the middle by a constant.
//!
//! Where the surface folds tighter than the distance, or folds meet, the level has creases; it never passes through itself.

use crate::field::ScalarField;
use crate::math::Vec3;

use super::{MidSurface, SignedDistance, WallFace};

/// The signed distance to a face of a wall, or to the level beyond it, where it is smaller than `band` (mm); elsewhere the band, with
/// its sign. What the level encloses is negative.
#[derive(Clone, Copy, Debug)]
pub struct Offset<'a> {
    /// The middle of the wall.
    pub middle: &'a MidSurface,
    /// On which side of it.
    pub face: WallFace,
    /// How much farther from the middle than the face, mm.
    pub beyond: f64,
    /// The largest value, mm.
    pub band: f64,
}

impl Offset<'_> {
    fn banded(&self, value: f64) -> f64 {
        value.clamp(-self.band, self.band)
    }
}

impl ScalarField for Offset<'_> {
    fn value(&self, point: Vec3) -> f64 {
        self.value_and_gradient(point).0
    }

    /// The gradient is the distance's everywhere, of unit length: it points to the level from beyond the band too.
    fn value_and_gradient(&self, point: Vec3) -> (f64, Vec3) {
        let level = self.middle.to_level(self.face, self.beyond, point, f64::INFINITY);
        (self.banded(level.value), level.gradient)
    }

    /// A distance changes by no more than the way: what it was bounds what it is, and beyond the band it need not be known.
    fn values_along_z(&self, origin: Vec3, step: f64, values: &mut [f64]) {
        let (mut from_middle, mut from_level) = (f64::INFINITY, f64::INFINITY);
        let mut last = 0;
        for i in 0..values.len() {
            let way = (i - last) as f64 * step;
            values[i] = if from_level.is_finite() && from_level.abs() - way > self.band + ROUNDING {
                values[last]
            } else {
                let point = origin + Vec3::new(0.0, 0.0, i as f64 * step);
                let bound = from_middle.abs() + way;
                let level = self.middle.to_level(self.face, self.beyond, point, bound);
                (from_middle, from_level) = (level.from_middle, level.value);
                last = i;
                self.banded(from_level)
            };
        }
    }
}

/// An offset surface whose gaps and creases are filled with wall as far as a ball does not enter them.
///
/// ```text
/// outside  (offset > 0):  min(d - offset, c + r)      c: signed distance to the surface at offset + r
/// inside   (offset < 0):  max(d - offset, c - r)      c: signed distance to the surface at offset - r
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Filleted<'a> {
    /// The surface without fillets.
    pub offset: Offset<'a>,
    /// The distance to the triangles of the surface farther away by the radius.
    pub core: &'a SignedDistance,
    /// The radius of the ball, mm.
    pub radius: f64,
    /// How far the core's chords may be from its surface, mm; fillets begin only there.
    pub chord_error: f64,
}

impl Filleted<'_> {
    /// Whether the ball that touches the level straight below or above a point, `height` (mm) over it, has room: then there is no
    /// fillet, whatever the core.
    fn is_open(&self, point: Vec3, side: f64, height: f64, away: Vec3) -> bool {
        let Offset { middle, face, beyond, .. } = self.offset;
        let centre = point + (self.radius - height) * away;
        // The ball's centre is that far from what it touches.
        let bound = 0.5 * middle.thickness_range()[1] + beyond + self.radius;
        let level = middle.to_level(face, beyond, centre, bound);
        side * level.value > self.radius - self.chord_error
    }
}

impl ScalarField for Filleted<'_> {
    fn value(&self, point: Vec3) -> f64 {
        self.value_and_gradient(point).0
    }

    fn value_and_gradient(&self, point: Vec3) -> (f64, Vec3) {
        let (plain, gradient) = self.offset.value_and_gradient(point);
        // Beyond the band no fillet reaches.
        if plain.abs() >= self.offset.band {
            return (plain, gradient);
        }
        let side = self.offset.face.sign();
        if self.is_open(point, side, side * plain, side * gradient) {
            return (plain, gradient);
        }
        let (distance, core_gradient) = self.core.value_and_gradient(point);
        let fillet = distance + side * (self.radius + self.chord_error);
        if side * fillet < side * plain { (fillet, core_gradient) } else { (plain, gradient) }
    }

    fn values_along_z(&self, origin: Vec3, step: f64, values: &mut [f64]) {
        self.offset.values_along_z(origin, step, values);
        for (i, value) in values.iter_mut().enumerate() {
            if value.abs() < self.offset.band {
                *value = self.value(origin + Vec3::new(0.0, 0.0, i as f64 * step));
            }
        }
    }
}

/// Of distances, mm.
const ROUNDING: f64 = 1e-9;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::{TriangleMesh, interpolated_isosurface};

    /// Two balls of radius 3 mm whose middles are 8 mm apart.
    fn two_balls(thickness: f64) -> MidSurface {
        let ball = TriangleMesh::sphere(3.0, 4);
        let moved = |x: f64| TriangleMesh {
            positions: ball.positions.iter().map(|p| p + Vec3::new(x, 0.0, 0.0)).collect(),
            triangles: ball.triangles.clone(),
        };
        MidSurface::uniform(moved(-4.0).joined(&moved(4.0)), thickness).unwrap()
    }

    #[test]
    fn lines_have_the_bits_of_points() {
        let middle = two_balls(1.6);
        for band in [0.3, 2.0] {
            let level = Offset { middle: &middle, face: WallFace::Outer, beyond: 0.0, band };
            for x in [-8.5, -3.0, 0.1, 4.0, 7.9] {
                let origin = Vec3::new(x, 0.3, -9.0);
                let mut line = [0.0; 60];
                level.values_along_z(origin, 0.31, &mut line);
                for (i, value) in line.iter().enumerate() {
                    let point = origin + Vec3::new(0.0, 0.0, i as f64 * 0.31);
                    assert_eq!(value.to_bits(), level.value(point).to_bits(), "{point}");
                }
            }
        }
    }

    /// Balls of 3.8 mm leave a gap of 0.4 mm. A ball of 0.4 mm that touches both is sqrt(4.2^2 - 4^2) mm from their axis, and
    /// reaches in to 0.4 mm less.
    #[test]
    fn gaps_are_filled_as_far_as_a_ball_does_not_enter() {
        let middle = two_balls(1.6);
        let (radius, step) = (0.4, 0.3);
        let level = |beyond| Offset { middle: &middle, face: WallFace::Outer, beyond, band: 2.0 };
        let half = Vec3::new(10.0, 6.0, 6.0);
        let core = interpolated_isosurface(&level(radius), -half, half, step);
        let core = SignedDistance::new(&core).unwrap();
        let filleted = Filleted { offset: level(0.0), core: &core, radius, chord_error: 0.01 };
        let reach = (4.2_f64.powi(2) - 16.0).sqrt() - radius;
        let between = |rho: f64| filleted.value(Vec3::new(0.0, 0.6 * rho, 0.8 * rho));
        // Chords of 0.3 mm in a groove of 0.4 mm cut off 0.03 mm; the gap's own wedge is 0.01 mm wide per 0.01 mm of chord error.
        assert!(between(0.0) < 0.0 && between(reach - 0.1) < 0.0 && between(reach + 0.1) > 0.0);
        assert!(level(0.0).value(Vec3::zeros()) > 0.0);
        for point in
            [Vec3::new(-8.0, 0.0, 0.2), Vec3::new(4.0, 3.0, -2.5), Vec3::new(5.0, 0.0, -3.6)]
        {
            assert_eq!(
                filleted.value(point),
                level(0.0).value(point),
                "no fillet far from the gap"
            );
        }
    }
}
