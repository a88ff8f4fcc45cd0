//! The surface at a constant distance from another: a level of its signed distance.
//!
//! Where the surface folds tighter than the distance, or folds meet, the level has creases; it never passes through itself.

use crate::field::ScalarField;
use crate::math::Vec3;

use super::SignedDistance;

/// The signed distance to the surface at `offset` (mm, positive outside) from another, where it is smaller than `band` (mm);
/// elsewhere the band, with its sign.
#[derive(Clone, Copy, Debug)]
pub struct Offset<'a> {
    /// The distance to the other surface.
    pub distance: &'a SignedDistance,
    /// Where the level is, mm.
    pub offset: f64,
    /// The largest value, mm.
    pub band: f64,
}

impl Offset<'_> {
    fn banded(&self, distance: f64) -> f64 {
        (distance - self.offset).clamp(-self.band, self.band)
    }
}

impl ScalarField for Offset<'_> {
    fn value(&self, point: Vec3) -> f64 {
        self.banded(self.distance.value(point))
    }

    /// The gradient is the distance's everywhere, of unit length: it points to the level from beyond the band too.
    fn value_and_gradient(&self, point: Vec3) -> (f64, Vec3) {
        let (distance, gradient) = self.distance.value_and_gradient(point);
        (self.banded(distance), gradient)
    }

    /// A distance changes by no more than the way: what it was bounds what it is, and beyond the band it need not be known.
    fn values_along_z(&self, origin: Vec3, step: f64, values: &mut [f64]) {
        let mut known = f64::INFINITY;
        let mut last = 0;
        for i in 0..values.len() {
            let way = (i - last) as f64 * step;
            let to_level = (known - self.offset).abs() - way;
            values[i] = if known.is_finite() && to_level > self.band + ROUNDING {
                values[last]
            } else {
                let point = origin + Vec3::new(0.0, 0.0, i as f64 * step);
                known = self.distance.within(point, known.abs() + way).0;
                last = i;
                self.banded(known)
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
        let (distance, core_gradient) = self.core.value_and_gradient(point);
        let side = self.offset.offset.signum();
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
