//! Unknowns that are held at their value.
//!
//! A held unknown keeps its row and column in the tangent: the residual is zero there, the row and column are
//! those of the identity. The pattern is unchanged and no pivot becomes negative.

use super::system::SparsityPattern;

/// Which unknowns are held, and which stored entries that touches.
#[derive(Clone, Debug, Default)]
pub(super) struct Dirichlet {
    held: Vec<u32>,
    coupled_entries: Vec<u32>,
    diagonal_entries: Vec<u32>,
}

impl Dirichlet {
    /// Holds the unknowns `held` of a system with `pattern`.
    #[must_use]
    pub(super) fn new(pattern: &SparsityPattern, mut held: Vec<u32>) -> Self {
        held.sort_unstable();
        held.dedup();
        let mut is_held = vec![false; pattern.order()];
        for &unknown in &held {
            is_held[unknown as usize] = true;
        }
        let mut dirichlet = Self { held, ..Self::default() };
        for column in 0..pattern.order() {
            let range = pattern.column_starts[column]..pattern.column_starts[column + 1];
            for entry in range {
                let row = pattern.row_indices[entry as usize] as usize;
                if is_held[column] && row == column {
                    dirichlet.diagonal_entries.push(entry);
                } else if is_held[column] || is_held[row] {
                    dirichlet.coupled_entries.push(entry);
                }
            }
        }
        dirichlet
    }

    /// Holds the same unknowns of a system with another `pattern`.
    #[must_use]
    pub(super) fn with_pattern(&self, pattern: &SparsityPattern) -> Self {
        Self::new(pattern, self.held.clone())
    }

    /// The unknowns that are held, ascending.
    #[must_use]
    pub(super) fn unknowns(&self) -> &[u32] {
        &self.held
    }

    /// How many unknowns are held.
    #[must_use]
    pub(super) fn held(&self) -> usize {
        self.held.len()
    }

    /// Zeroes the held entries of a gradient.
    pub(super) fn apply_to_residual(&self, residual: &mut [f64]) {
        for &unknown in &self.held {
            residual[unknown as usize] = 0.0;
        }
    }

    /// Makes the held rows and columns those of the identity.
    pub(super) fn apply_to_tangent(&self, tangent: &mut [f64]) {
        for &entry in &self.coupled_entries {
            tangent[entry as usize] = 0.0;
        }
        for &entry in &self.diagonal_entries {
            tangent[entry as usize] = 1.0;
        }
    }
}
