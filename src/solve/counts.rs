//! What is counted of a solver's work.

use std::ops::AddAssign;

use serde::{Deserialize, Serialize};

/// What walking asked of a solver, counted: the same on every machine, where CPU seconds are not.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SolveCounts {
    /// Newton iterations, all of them.
    pub newton_iterations: usize,
    /// Those among them whose attempt gave no state of the path: steps cut, falls without an end, looks past a limit point.
    pub failed_iterations: usize,
    /// Numerical factorisations: one for each iteration and each state, and more where tangents are shifted.
    pub factorizations: usize,
}

impl AddAssign for SolveCounts {
    fn add_assign(&mut self, other: Self) {
        self.newton_iterations += other.newton_iterations;
        self.failed_iterations += other.failed_iterations;
        self.factorizations += other.factorizations;
    }
}
