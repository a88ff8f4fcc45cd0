//! What a part stands among: its planes, its own folds, the bounds of its model.

use super::contact::{PlaneSettings, SelfContactSettings};
use super::material_limits::MaterialLimits;
use super::stretch_bound::DEFAULT_STRETCH_BOUND;
use crate::math::Vec3;

/// What a model has besides its wall, its supports and its loads.
#[derive(Clone, Debug, PartialEq)]
pub struct PartSetup {
    /// Rigid planes that the part may touch.
    pub planes: Vec<PlaneSettings>,
    /// What folds of the wall do when they meet; `None`: those of closed shells end the path, others pass through each other.
    pub folds: Option<FoldContact>,
    /// The stretch beyond which the part is said to balloon.
    pub stretch_bound: f64,
    /// What each material may bear, in the order of the list that the model is given; none of those that are left out.
    pub limits: Vec<MaterialLimits>,
    /// Force per volume of the wall at rest, N/mm^3: its weight. It acts whole, whatever the load.
    pub body_force: Vec3,
}

impl Default for PartSetup {
    fn default() -> Self {
        Self {
            planes: Vec::new(),
            folds: None,
            stretch_bound: DEFAULT_STRETCH_BOUND,
            limits: Vec::new(),
            body_force: Vec3::zeros(),
        }
    }
}

impl From<Vec<PlaneSettings>> for PartSetup {
    fn from(planes: Vec<PlaneSettings>) -> Self {
        Self { planes, ..Self::default() }
    }
}

/// What folds of a wall do when they meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FoldContact {
    /// They pass through each other.
    Unseen,
    /// They end the path: beyond, the model says nothing.
    Ends,
    /// Barriers keep them apart.
    Barrier(SelfContactSettings),
}

/// What a model of a closed part holds fixed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Support {
    /// The mesh's clamp: its vertices and their tangent planes do not move, because their rings are held too.
    Clamp,
    /// Single unknowns, `3 node + axis`; for free bodies in tests.
    Unknowns(Vec<u32>),
}
