//! One candidate: its name, its genome, and how good it was found.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// The name of an individual within a run: the generation that made it and its place there.
///
/// Printed, parsed and stored as `g003-017`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct IndividualId {
    /// The generation, 0 for the random one.
    pub generation: usize,
    /// The place in that generation, from 0.
    pub index: usize,
}

/// A text that is no [`IndividualId`].
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` does not name an individual: expected generation and index, such as `g003-017`")]
pub struct InvalidId(String);

impl fmt::Display for IndividualId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "g{:03}-{:03}", self.generation, self.index)
    }
}

impl FromStr for IndividualId {
    type Err = InvalidId;

    fn from_str(text: &str) -> Result<Self, InvalidId> {
        text.strip_prefix('g')
            .and_then(|numbers| numbers.split_once('-'))
            .and_then(|(generation, index)| {
                Some(Self { generation: generation.parse().ok()?, index: index.parse().ok()? })
            })
            .ok_or_else(|| InvalidId(text.to_owned()))
    }
}

impl From<IndividualId> for String {
    fn from(id: IndividualId) -> Self {
        id.to_string()
    }
}

impl TryFrom<String> for IndividualId {
    type Error = InvalidId;

    fn try_from(text: String) -> Result<Self, InvalidId> {
        text.parse()
    }
}

/// An individual that waits for its evaluation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Candidate<G> {
    /// Its name.
    pub id: IndividualId,
    /// What it has inherited.
    pub genome: G,
}

/// How good an individual was found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Evaluation {
    /// The values to be made small `[objective]`; may be empty when the violation is positive.
    pub objectives: Vec<f64>,
    /// How far the individual is from acceptable: 0 when feasible, else positive.
    pub constraint_violation: f64,
}

impl Evaluation {
    /// A feasible evaluation with these objectives `[objective]`.
    #[must_use]
    pub fn feasible(objectives: Vec<f64>) -> Self {
        Self { objectives, constraint_violation: 0.0 }
    }

    /// An evaluation that gave no objectives, `constraint_violation` away from being acceptable.
    #[must_use]
    pub fn infeasible(constraint_violation: f64) -> Self {
        Self { objectives: vec![], constraint_violation }
    }

    /// The worst evaluation there is: of a candidate about which nothing was learned.
    #[must_use]
    pub fn failed() -> Self {
        Self::infeasible(f64::MAX)
    }

    /// Whether no constraint is violated.
    #[must_use]
    pub fn is_feasible(&self) -> bool {
        self.constraint_violation == 0.0
    }

    /// Whether this has the right number of objectives: `objectives`, or none where a constraint is violated.
    pub(super) fn is_of(&self, objectives: usize) -> bool {
        self.objectives.len() == objectives || (self.objectives.is_empty() && !self.is_feasible())
    }

    /// This evaluation, or [`Self::failed`] when one of its numbers is not finite; a negative violation counts as 0.
    ///
    /// The largest finite number stands in for infinity, which JSON cannot write.
    #[must_use]
    pub(super) fn made_finite(self) -> Self {
        let numbers_are_finite = self.constraint_violation.is_finite()
            && self.objectives.iter().all(|objective| objective.is_finite());
        if !numbers_are_finite {
            return Self::failed();
        }
        Self { constraint_violation: self.constraint_violation.max(0.0), ..self }
    }
}

/// An evaluated individual.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Individual<G> {
    /// Its name.
    pub id: IndividualId,
    /// What it has inherited.
    pub genome: G,
    /// How good it is.
    pub evaluation: Evaluation,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_id_reads_as_it_is_written() {
        let id = IndividualId { generation: 3, index: 17 };
        assert_eq!(id.to_string(), "g003-017");
        assert_eq!("g003-017".parse(), Ok(id));
        assert_eq!(serde_json::to_string(&id).unwrap(), "\"g003-017\"");
        assert_eq!(serde_json::from_str::<IndividualId>("\"g1234-5\"").unwrap().generation, 1234);
        for wrong in ["", "g3", "3-17", "g-1", "g1-2-3", "gx-1"] {
            assert!(wrong.parse::<IndividualId>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn numbers_that_are_not_finite_make_an_evaluation_the_worst() {
        for wrong in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!(Evaluation::feasible(vec![1.0, wrong]).made_finite(), Evaluation::failed());
            assert_eq!(Evaluation::infeasible(wrong).made_finite(), Evaluation::failed());
        }
        assert!(Evaluation::infeasible(-1.0).made_finite().is_feasible());
        let good = Evaluation { objectives: vec![-1.0, 2.0], constraint_violation: 3.0 };
        assert_eq!(good.clone().made_finite(), good);
    }
}
