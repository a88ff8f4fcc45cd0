//! The sparse factorisation `P K P^T = L D L^T` of `faer`, planned once for each pattern.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::ldlt::factor::LdltRegularization;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LdltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
    supernodal::{SupernodalLdltRef, SymbolicSupernodalCholesky},
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side, Spec};

use super::SolverFailure;
use crate::model::system::SparsityPattern;

/// Below every ratio of operations to entries; faer's own `FORCE_SUPERNODAL`, 0, leaves out diagonal matrices.
const ALWAYS_SUPERNODAL: SupernodalThreshold = SupernodalThreshold(-1.0);

/// A factorisation that can be repeated for new values in the same pattern.
pub(super) struct LdlFactor {
    pattern: SparsityPattern,
    symbolic: SymbolicCholesky<u32>,
    values: Vec<f64>,
    memory: MemBuffer,
    solve_memory: MemBuffer,
}

impl LdlFactor {
    pub(super) fn new(pattern: &SparsityPattern) -> Result<Self, SolverFailure> {
        let symbolic = factorize_symbolic_cholesky(
            view(pattern),
            Side::Lower,
            SymmetricOrdering::Amd,
            CholeskySymbolicParams {
                supernodal_flop_ratio_threshold: ALWAYS_SUPERNODAL,
                ..Default::default()
            },
        )
        .map_err(|error| SolverFailure { library: "faer", message: error.to_string() })?;
        let scratch = symbolic.factorize_numeric_ldlt_scratch::<f64>(Par::Seq, Spec::default());
        let solve_scratch = symbolic.solve_in_place_scratch::<f64>(1, Par::Seq);
        Ok(Self {
            pattern: pattern.clone(),
            values: vec![0.0; symbolic.len_val()],
            memory: MemBuffer::new(scratch),
            solve_memory: MemBuffer::new(solve_scratch),
            symbolic,
        })
    }

    pub(super) fn pattern(&self) -> &SparsityPattern {
        &self.pattern
    }

    /// Factorises `values [stored]`; the number of negative pivots, `None` when a pivot is zero.
    pub(super) fn factorize(&mut self, values: &[f64]) -> Option<usize> {
        let matrix = SparseColMatRef::new(view(&self.pattern), values);
        let no_regularization = LdltRegularization::default();
        self.symbolic
            .factorize_numeric_ldlt(
                &mut self.values,
                matrix,
                Side::Lower,
                no_regularization,
                Par::Seq,
                MemStack::new(&mut self.memory),
                Spec::default(),
            )
            .ok()?;
        let symbolic = self.supernodes();
        let factor = SupernodalLdltRef::new(symbolic, &self.values);
        let mut negative = 0;
        for s in 0..symbolic.n_supernodes() {
            let block = factor.supernode(s).val();
            for k in 0..block.ncols() {
                let pivot: f64 = block[(k, k)];
                if pivot == 0.0 || !pivot.is_finite() {
                    return None;
                }
                negative += usize::from(pivot < 0.0);
            }
        }
        Some(negative)
    }

    /// Additions and multiplications of a factorisation: for each column the square of what is stored below its pivot.
    pub(super) fn operations(&self) -> f64 {
        let symbolic = self.supernodes();
        let columns = (0..symbolic.n_supernodes()).flat_map(|s| {
            let width = symbolic.supernode_end()[s] - symbolic.supernode_begin()[s];
            let below = symbolic.supernode(s).pattern().len();
            (0..width as usize).map(move |k| (below + k) as f64)
        });
        columns.map(|below| below * below).sum()
    }

    fn supernodes(&self) -> &SymbolicSupernodalCholesky<u32> {
        let SymbolicCholeskyRaw::Supernodal(symbolic) = self.symbolic.raw() else {
            unreachable!("the supernodal factorisation is asked for");
        };
        symbolic
    }

    /// Solves with the last factor; `b [n]` is overwritten.
    pub(super) fn solve(&mut self, b: &mut [f64]) {
        let rows = b.len();
        LdltRef::new(&self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(b, rows, 1),
            Par::Seq,
            MemStack::new(&mut self.solve_memory),
        );
    }
}

fn view(pattern: &SparsityPattern) -> SymbolicSparseColMatRef<'_, u32> {
    let n = pattern.order();
    SymbolicSparseColMatRef::new_checked(n, n, &pattern.column_starts, None, &pattern.row_indices)
}

impl std::fmt::Debug for LdlFactor {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("LdlFactor").field("order", &self.pattern.order()).finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A full matrix of order n: the sum of the squares below n, `(n - 1) n (2 n - 1) / 6`.
    #[test]
    fn operations_of_a_full_matrix() {
        let n = 30_u32;
        let pattern = SparsityPattern {
            column_starts: (0..=n).map(|column| column * n).collect(),
            row_indices: (0..n).flat_map(|_| 0..n).collect(),
        };
        let exact = f64::from((n - 1) * n * (2 * n - 1) / 6);
        assert_eq!(LdlFactor::new(&pattern).unwrap().operations(), exact);
    }
}
