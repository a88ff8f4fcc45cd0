//! What is the value at a point? Scalar fields whose zero level is the mid-surface of the wall.
//!
//! [`CompiledNetwork`] evaluates a genome's network; [`CappedField`] closes it inside a [`DesignBox`].

mod capped;
#[cfg(test)]
mod chamber_share;
mod compile;
mod design_box;
mod evaluate;
mod grid;
mod quantity;

pub use capped::{CappedField, RimError};
pub use compile::CompiledNetwork;
pub use design_box::{DesignBox, DesignBoxError};
pub use grid::GridSamples;

use crate::math::Vec3;

/// A scalar field; the solid cavity is where `value < 0`.
pub trait ScalarField: Sync {
    /// The field at `point` (mm).
    fn value(&self, point: Vec3) -> f64;

    /// The field at `point` (mm) and its gradient (per mm).
    fn value_and_gradient(&self, point: Vec3) -> (f64, Vec3);

    /// Writes the field at every point of one grid line: `points[i] = origin + i * step * e_z`.
    ///
    /// The same bits as [`Self::value`] at each point.
    fn values_along_z(&self, origin: Vec3, step: f64, values: &mut [f64]) {
        for (i, value) in values.iter_mut().enumerate() {
            *value = self.value(origin + Vec3::new(0.0, 0.0, i as f64 * step));
        }
    }
}
