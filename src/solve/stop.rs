//! Whether a walk is to end before its programme does.

use std::fmt;

/// Somebody who may want a walk to end; asked between its solves, and never in one.
///
/// Who asks gets no wrong state for it: a path ends with what it has, as [`super::Ending::Interrupted`].
#[derive(Clone, Copy, Default)]
pub struct Stop<'a> {
    is_wanted: Option<&'a (dyn Fn() -> bool + Sync)>,
}

impl<'a> Stop<'a> {
    /// Nobody.
    pub const NEVER: Stop<'static> = Stop { is_wanted: None };

    /// Somebody who answers by `is_wanted`. The processes of a job that solve together must get one answer.
    #[must_use]
    pub fn when(is_wanted: &'a (dyn Fn() -> bool + Sync)) -> Self {
        Self { is_wanted: Some(is_wanted) }
    }

    /// Whether the walk is to end now.
    #[must_use]
    pub fn is_wanted(self) -> bool {
        self.is_wanted.is_some_and(|is_wanted| is_wanted())
    }
}

impl fmt::Debug for Stop<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.is_wanted.is_some() { "Stop::when(..)" } else { "Stop::NEVER" })
    }
}
