//! Why a path ended.

use serde::{Deserialize, Serialize};

use super::{NewtonEnding, NewtonReport};
use crate::math::Reason;
use crate::model::system::LimitKind;

/// Why a path ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Ending {
    /// The end of the programme was reached.
    Reached,
    /// The end of the programme was reached, over one snap or more.
    SnappedAndContinued,
    /// The wall is at the limit that its material was given: the part has come as far as it is to go.
    LimitReached,
    /// Beyond this load no stable equilibrium is near: the energy loses its minimum.
    LimitPoint,
    /// The equilibrium beyond this load exists but is not stable.
    Unstable,
    /// The wall is stretched beyond the bound that was set.
    Ballooning,
    /// The part touches itself, which is not modelled.
    SelfTouch,
    /// Elements invert or folds close.
    Inverted,
    /// Newton's method does not converge, for no reason of the above.
    Stalled,
    /// The budget of iterations was spent.
    BudgetSpent,
    /// Somebody wanted it to end: a signal, or a time limit.
    Interrupted,
}

impl Ending {
    /// The ending as tables write it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Reached => "reached",
            Self::SnappedAndContinued => "snapped_and_continued",
            Self::LimitReached => "limit_reached",
            Self::LimitPoint => "limit_point",
            Self::Unstable => "unstable",
            Self::Ballooning => "ballooning",
            Self::SelfTouch => "self_touch",
            Self::Inverted => "inverted",
            Self::Stalled => "stalled",
            Self::BudgetSpent => "budget_spent",
            Self::Interrupted => "interrupted",
        }
    }

    /// The reason of a rejection for it.
    #[must_use]
    pub fn reason(self) -> Reason {
        match self {
            Self::Reached => Reason::Reached,
            Self::SnappedAndContinued => Reason::SnappedAndContinued,
            Self::LimitReached => Reason::LimitReached,
            Self::LimitPoint => Reason::LimitPoint,
            Self::Unstable => Reason::Unstable,
            Self::Ballooning => Reason::Ballooning,
            Self::SelfTouch => Reason::SelfTouch,
            Self::Inverted => Reason::Inverted,
            Self::Stalled => Reason::Stalled,
            Self::BudgetSpent => Reason::BudgetSpent,
            Self::Interrupted => Reason::Interrupted,
        }
    }

    /// Whether the programme was walked to its end.
    #[must_use]
    pub fn is_complete(self) -> bool {
        matches!(self, Self::Reached | Self::SnappedAndContinued)
    }

    /// Whether what was reached before is the part's answer: the part itself ended the path, or the budget that every part has; not a
    /// method that failed.
    #[must_use]
    pub fn leaves_an_answer(self) -> bool {
        match self {
            Self::Reached
            | Self::SnappedAndContinued
            | Self::LimitReached
            | Self::LimitPoint
            | Self::Ballooning
            | Self::SelfTouch
            | Self::BudgetSpent => true,
            Self::Unstable | Self::Inverted | Self::Stalled | Self::Interrupted => false,
        }
    }

    /// Whether it is not for the part that the walk ends: no smaller step helps.
    pub(super) fn is_given_up(self) -> bool {
        matches!(self, Self::BudgetSpent | Self::Interrupted)
    }

    /// Whether the part itself ended the path in a state that was found: what was tried beyond is no failure.
    pub(super) fn is_of_part(self) -> bool {
        matches!(self, Self::Ballooning | Self::SelfTouch | Self::LimitReached)
    }

    /// The ending that a failed solve would be, were no smaller step to be tried; `None` where it converged.
    pub(super) fn of_failure(report: &NewtonReport) -> Option<Self> {
        match report.ending {
            NewtonEnding::Converged => None,
            _ if report.shifted > 0 => Some(Self::LimitPoint),
            NewtonEnding::Singular | NewtonEnding::Indefinite => Some(Self::LimitPoint),
            NewtonEnding::Inadmissible => Some(Self::Inverted),
            NewtonEnding::IterationLimit | NewtonEnding::LineSearchFailed => Some(Self::Stalled),
        }
    }
}

impl From<LimitKind> for Ending {
    fn from(kind: LimitKind) -> Self {
        match kind {
            LimitKind::Ballooning => Self::Ballooning,
            LimitKind::SelfTouch => Self::SelfTouch,
        }
    }
}
