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
mod settings;
mod step;
#[cfg(test)]
mod tests;
mod wall_contact;
mod wall_surface;

pub(in crate::model) use folds::FoldWatch;
pub use settings::SelfContactSettings;
pub(in crate::model) use wall_contact::WallContact;
