//! What a material may bear: limits on the principal stretches and nominal stresses of a wall's faces, or of a solid.
//!
//! ```text
//! share used = (l - 1) / (l_max - 1)    or    P / P_max          the largest, over both faces at all points of quadrature
//! l: largest principal stretch          P: largest principal nominal stress (first Piola and Kirchhoff), J sigma_i / l_i
//! ```
//!
//! At a face the stretch of the middle and that of bending add up. A limit is set by whoever uses the part; it is no bound of the model.

use super::element::{Face, PeakState};
use crate::math::Vec3;

/// What a material may bear; by default nothing is said.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MaterialLimits {
    /// The largest principal stretch, more than 1.
    pub stretch: Option<f64>,
    /// The largest principal nominal stress, MPa.
    pub nominal_stress: Option<f64>,
}

/// What is limited.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LimitedQuantity {
    /// The largest principal stretch.
    Stretch,
    /// The largest principal nominal stress.
    NominalStress,
}

impl LimitedQuantity {
    /// Its name in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Stretch => "stretch",
            Self::NominalStress => "nominal_stress",
        }
    }

    /// Its unit after a number: ` MPa`, or nothing.
    #[must_use]
    pub fn told_unit(self) -> &'static str {
        match self {
            Self::Stretch => "",
            Self::NominalStress => " MPa",
        }
    }
}

/// The limit that is used most, and where.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UsedLimit {
    /// What is limited.
    pub quantity: LimitedQuantity,
    /// What it may be; a stretch, or MPa.
    pub allowed: f64,
    /// What it is.
    pub value: f64,
    /// How much of the limit is used: 0 at rest, 1 at the limit.
    pub share: f64,
    /// The material, by its place in the list that the model was given.
    pub material: usize,
    /// The face of a shell.
    pub face: Option<Face>,
    /// The middle of the triangle or cell at rest, mm.
    pub at_rest: Vec3,
    /// A node beside it.
    pub(super) node: u32,
}

impl MaterialLimits {
    /// The limit of which `state` uses more, with the share that it uses.
    pub(super) fn used_by(&self, state: &PeakState) -> Option<(LimitedQuantity, [f64; 2], f64)> {
        let stretch = self.stretch.map(|allowed| {
            let share = (state.stretch - 1.0) / (allowed - 1.0);
            (LimitedQuantity::Stretch, [allowed, state.stretch], share)
        });
        let stress = self.nominal_stress.map(|allowed| {
            let share = state.nominal_stress / allowed;
            (LimitedQuantity::NominalStress, [allowed, state.nominal_stress], share)
        });
        stretch.into_iter().chain(stress).max_by(|a, b| a.2.total_cmp(&b.2))
    }
}
