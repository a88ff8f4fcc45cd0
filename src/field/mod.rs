//! What is the value at a point? Scalar fields whose zero level is the mid-surface of the wall.

use crate::math::Vec3;

/// A scalar field; the solid cavity is where `value < 0`.
pub trait ScalarField: Sync {
    /// The field at `point` (mm).
    fn value(&self, point: Vec3) -> f64;

    /// The field at `point` (mm) and its gradient (per mm).
    fn value_and_gradient(&self, point: Vec3) -> (f64, Vec3);

    /// Writes the field at every point of one grid line: `points[i] = origin + i * step * e_z`.
    fn values_along_z(&self, origin: Vec3, step: f64, values: &mut [f64]) {
        for (i, value) in values.iter_mut().enumerate() {
            *value = self.value(origin + Vec3::new(0.0, 0.0, i as f64 * step));
        }
    }
}
