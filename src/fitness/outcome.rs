//! What became of a candidate: an evaluation or a reason, and what it cost.

use serde::{Deserialize, Serialize};

use super::Evaluation;
use crate::math::{Rejected, Room};

/// CPU seconds of one candidate by stage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StageSeconds {
    /// Isosurface, checks, remeshing.
    pub meshing: f64,
    /// Energies, residuals, tangents.
    pub assembly: f64,
    /// Factorising and solving.
    pub factorization: f64,
    /// Everything else: element tables, sparsity, observations.
    pub rest: f64,
}

impl StageSeconds {
    /// All stages together.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.meshing + self.assembly + self.factorization + self.rest
    }
}

/// The result of evaluating a candidate.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "status", rename_all = "snake_case")]
pub enum Outcome {
    /// Both scenarios were walked to the largest pressure.
    Evaluated(Evaluation),
    /// The design failed.
    Rejected(Rejected),
}

impl Outcome {
    /// How far the candidate is from acceptable; 0 when it was evaluated.
    ///
    /// The later the room, the smaller: a path that ends early gives less than 1, a shell that cannot be
    /// computed 1 to 2, a surface that is no chamber 2 to 3.
    #[must_use]
    pub fn constraint_violation(&self) -> f64 {
        match self {
            Self::Evaluated(_) => 0.0,
            Self::Rejected(rejected) => {
                let graded = rejected.violation / (1.0 + rejected.violation);
                match rejected.room {
                    Room::Solve | Room::Fitness => rejected.violation.clamp(f64::MIN_POSITIVE, 1.0),
                    Room::Mesh | Room::Model => 1.0 + graded,
                    Room::Genome | Room::Field | Room::Surface => 2.0 + graded,
                }
            }
        }
    }
}
