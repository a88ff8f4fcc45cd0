//! Who is told how a walk goes, and how one ended: nothing here prints.

use crate::solve::{Ending, Path, PathPoint, Programme};

/// Is told what happens while a scene is read and walked; a method that is not written ignores it.
pub trait Observer: Sync {
    /// One line about something that may not be done as it is meant.
    fn warning(&self, line: &str) {
        let _ = line;
    }

    /// A path through `programme` begins.
    fn walk_begins(&self, programme: Programme) {
        let _ = programme;
    }

    /// A state of the path was accepted.
    fn state(&self, point: &PathPoint) {
        let _ = point;
    }
}

/// Ignores everything.
#[derive(Clone, Copy, Debug)]
pub struct Unobserved;

impl Observer for Unobserved {}

/// How work that may be stopped has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// It was done to its end.
    Finished,
    /// It was stopped; what it had is kept.
    Stopped,
}

impl End {
    /// [`Self::Stopped`] if the path was interrupted.
    #[must_use]
    pub fn of(walked: &Path) -> Self {
        if walked.ending == Ending::Interrupted { Self::Stopped } else { Self::Finished }
    }
}
