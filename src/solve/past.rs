//! What lies past a limit point.

use super::ending::Ending;

/// What the equilibria under a given conjugate say of a load that was not reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Past {
    /// The path ends: a bound of validity is passed before the load is reached, and where `fell`, the load has a maximum before that
    /// bound and does not come back to it.
    Ended { ending: Ending, fell: bool },
    /// It has a maximum, and they do not tell what is beyond: it comes back, or they were lost.
    Returned,
    /// They were not found, or they have no maximum: they rise to the load behind a knee that its steps may be too coarse for.
    Unknown,
}

impl Past {
    pub(super) fn ended(ending: Ending, fell: bool) -> Self {
        Self::Ended { ending, fell }
    }
}
