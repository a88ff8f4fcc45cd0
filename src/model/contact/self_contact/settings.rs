//! How strongly folds keep each other away, and from where on.

use serde::{Deserialize, Serialize};

/// Where the barrier begins, in thicknesses.
const ACTIVATION: f64 = 0.2;

/// The barrier between folds of the wall.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SelfContactSettings {
    /// Gap at which the barrier begins to push, mm; at most a quarter of the thickness is used.
    pub activation: f64,
    /// Barrier stiffness, MPa/mm.
    pub stiffness: f64,
}

impl SelfContactSettings {
    /// A barrier for a wall of `thickness` (mm) whose folds press on each other with about `pressure` (MPa).
    ///
    /// # Decisions
    /// The barrier begins a fifth of the thickness before the folds touch, a tenth for each, which is the error of the
    /// contact's position; half that gap carries ten times the pressure.
    #[must_use]
    pub fn of_wall(thickness: f64, pressure: f64) -> Self {
        Self::beginning_at(ACTIVATION * thickness, pressure)
    }

    /// A barrier that begins at a gap of `activation` (mm), of which half carries ten times the `pressure` (MPa).
    #[must_use]
    pub fn beginning_at(activation: f64, pressure: f64) -> Self {
        // -b'(h / 2) = (ln 2 + 1/2) h.
        let stiffness = 10.0 * pressure / ((std::f64::consts::LN_2 + 0.5) * activation);
        Self { activation, stiffness }
    }
}
