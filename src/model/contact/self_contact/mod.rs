//! Frictionless contact of the wall with itself, by a barrier between the points, edges and facets of its surface.
//!
//! ```text
//! energy   sum over points i and facets f  kappa A_i / 2 b(D_if - xi_i)  +  sum over edges  kappa A_ef m b(D_ef - xi_ef)
//! xi = min(thickness, 0.9 distance at rest)        b begins at min(activation, half of the gap at rest)
//! ```
//!
//! The barrier is infinite where a gap closes, so no fold passes another. Parts that are neighbours at rest do not see each
//! other, and nothing is stored at rest, however near parts stand. The surface is that of the limit points of
//! vertices and edge midpoints; it keeps its thickness while the wall stretches, so `xi` is constant and the energy has a
//! potential. See [`pair`] for the barrier, [`wall_surface`] for what is compared, [`step`] for how far one may go.
//!
//! A part that is cut by planes of symmetry does not see its images: neither do its folds see the planes.
//!
//! Sources: Li et al. (2020), incremental potential contact; Li, Kaufman, Jiang (2021), its thickness and step limit.

mod distance;
mod folds;
mod near_at_rest;
mod pair;
mod pair_term;
mod step;
#[cfg(test)]
mod tests;
mod wall_contact;
mod wall_surface;

use serde::{Deserialize, Serialize};

pub(in crate::model) use folds::FoldWatch;
pub(in crate::model) use wall_contact::WallContact;

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
