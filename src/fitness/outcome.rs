//! What became of a candidate: an evaluation or a reason, and what it cost.

use serde::{Deserialize, Serialize};

use super::Evaluation;
use crate::math::{Rejected, Stage};
use crate::solve::SolverFailure;

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

/// Why a design has no outcome; it says nothing about the design.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unevaluated {
    /// A library failed.
    #[error(transparent)]
    Failed(#[from] SolverFailure),
    /// Somebody wanted the evaluation to end.
    #[error("the evaluation was stopped")]
    Stopped,
}

/// Why there are no objectives of a design.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NotEvaluated {
    /// The design fails: that is its outcome.
    #[error("{0}")]
    Rejected(Rejected),
    /// It has no outcome.
    #[error(transparent)]
    Unevaluated(#[from] Unevaluated),
}

impl From<Rejected> for NotEvaluated {
    fn from(rejected: Rejected) -> Self {
        Self::Rejected(rejected)
    }
}

impl From<SolverFailure> for NotEvaluated {
    fn from(failure: SolverFailure) -> Self {
        Self::Unevaluated(failure.into())
    }
}

/// The result of evaluating a candidate.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "status", rename_all = "snake_case")]
pub enum Outcome {
    /// All scenarios were walked, and the objectives read off.
    Evaluated(Evaluation),
    /// The design failed.
    Rejected(Rejected),
}

impl Outcome {
    /// How far the candidate is from acceptable; 0 when it was evaluated.
    ///
    /// The farther a candidate came, the smaller: nothing at all gives 4, a surface that is not one chamber from clamp
    /// to tip 3 to 4, one that cannot be meshed 2 to 3, a shell that cannot be computed 1 to 2, and a path that
    /// ends early the share of the pressure that is missing.
    #[must_use]
    pub fn constraint_violation(&self) -> f64 {
        match self {
            Self::Evaluated(_) => 0.0,
            Self::Rejected(rejected) => {
                let graded = rejected.violation / (1.0 + rejected.violation);
                match rejected.stage() {
                    Stage::Nothing => 4.0,
                    Stage::Chamber => 3.0 + graded,
                    Stage::Triangles => 2.0 + graded,
                    Stage::Shell => 1.0 + graded,
                    Stage::Path => rejected.violation.clamp(f64::MIN_POSITIVE, 1.0),
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Reason, Room};

    /// Whatever the size of its own violation, a candidate that came farther is nearer to acceptable.
    #[test]
    fn violations_are_ordered_by_how_far_a_candidate_came() {
        let stages = [
            (Room::Solve, Reason::LimitPoint),
            (Room::Model, Reason::FoldsTighterThanWall),
            (Room::Surface, Reason::UnresolvedSurface),
            (Room::Surface, Reason::Islands),
            (Room::Surface, Reason::NoSurface),
        ];
        let violations = stages.map(|(room, reason)| {
            [1e-3, 1.0, 169.0].map(|violation| {
                let rejected = Rejected::new(room, reason.clone(), String::new(), violation);
                Outcome::Rejected(rejected).constraint_violation()
            })
        });
        for pair in violations.windows(2) {
            assert!(pair[0].iter().all(|near| pair[1].iter().all(|far| near < far)), "{pair:?}");
        }
    }
}
