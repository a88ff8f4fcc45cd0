//! Energy terms on small stencils, the only thing that the assembler knows.

use nalgebra::Matrix3;

use super::block::Block;
use super::system::Inadmissible;
use crate::math::Vec3;

/// Gradient and Hessian of one stencil's energy with respect to its node positions.
#[derive(Clone, Debug, Default)]
pub struct LocalDerivatives {
    size: usize,
    gradient: Vec<Vec3>,
    /// The lower blocks `(i, j)`, `i >= j`, column by column.
    hessian: Vec<Block>,
    with_hessian: bool,
}

impl LocalDerivatives {
    /// Room for stencils of at most `nodes` nodes.
    #[must_use]
    pub fn with_capacity(nodes: usize) -> Self {
        Self {
            size: 0,
            gradient: Vec::with_capacity(nodes),
            hessian: Vec::with_capacity(nodes * (nodes + 1) / 2),
            with_hessian: true,
        }
    }

    /// Forgets everything and prepares for a stencil of `size` nodes.
    pub fn reset(&mut self, size: usize, with_hessian: bool) {
        self.size = size;
        self.with_hessian = with_hessian;
        self.gradient.clear();
        self.gradient.resize(size, Vec3::zeros());
        self.hessian.clear();
        if with_hessian {
            self.hessian.resize(size * (size + 1) / 2, Block::default());
        }
    }

    /// Whether the Hessian is wanted.
    #[must_use]
    pub fn with_hessian(&self) -> bool {
        self.with_hessian
    }

    /// The gradient, one vector for each node, N.
    #[must_use]
    pub fn gradient(&self) -> &[Vec3] {
        &self.gradient
    }

    /// The gradient, to be added to.
    pub fn gradient_mut(&mut self) -> &mut [Vec3] {
        &mut self.gradient
    }

    /// The Hessian block of nodes `i >= j`, N/mm.
    #[must_use]
    #[inline]
    pub fn block(&self, i: usize, j: usize) -> Matrix3<f64> {
        self.hessian[self.column_start(j) + i - j].matrix()
    }

    /// The Hessian block of nodes `i >= j`, to be added to.
    #[inline]
    pub fn block_mut(&mut self, i: usize, j: usize) -> &mut Block {
        let start = self.column_start(j);
        &mut self.hessian[start + i - j]
    }

    /// The Hessian blocks of node `j` with nodes `j, j + 1, ..`, N/mm.
    #[must_use]
    #[inline]
    pub fn column(&self, j: usize) -> &[Block] {
        &self.hessian[self.column_start(j)..self.column_start(j + 1)]
    }

    /// The Hessian blocks of node `j` with nodes `j, j + 1, ..`, to be added to.
    #[inline]
    pub fn column_mut(&mut self, j: usize) -> &mut [Block] {
        let range = self.column_start(j)..self.column_start(j + 1);
        &mut self.hessian[range]
    }

    /// Adds the derivatives of a function of the point `sum_i weights_i x_i`: its `gradient` and `hessian` there.
    pub fn add_of_point(&mut self, weights: &[f64], gradient: Vec3, hessian: &Matrix3<f64>) {
        for (sum, weight) in self.gradient.iter_mut().zip(weights) {
            *sum += *weight * gradient;
        }
        if self.with_hessian {
            for (j, wj) in weights.iter().enumerate() {
                for (i, wi) in weights.iter().enumerate().skip(j) {
                    *self.block_mut(i, j) += wi * wj * hessian;
                }
            }
        }
    }

    /// The number of lower blocks before those of column `j`.
    #[inline]
    pub(super) fn column_start(&self, j: usize) -> usize {
        j * self.size - j * j.saturating_sub(1) / 2
    }
}

/// A part of the potential energy that is a sum over stencils of nodes.
pub trait Term: Sync {
    /// The stencils: for each, its nodes in ascending order.
    fn stencils(&self) -> &[Vec<u32>];

    /// Whether stencil `s` contributes at all at `positions` (of all nodes); contact mostly does not.
    fn is_active(&self, s: usize, positions: &[Vec3]) -> bool {
        let _ = (s, positions);
        true
    }

    /// The energy of stencil `s` whose nodes are at `x`, mJ.
    ///
    /// # Errors
    /// [`Inadmissible`] where the energy is not defined.
    fn energy(&self, s: usize, x: &[Vec3]) -> Result<f64, Inadmissible>;

    /// Adds the derivatives of stencil `s` at `x` to `local`; returns its energy, mJ.
    ///
    /// # Errors
    /// [`Inadmissible`] where the energy is not defined.
    fn derivatives(
        &self,
        s: usize,
        x: &[Vec3],
        local: &mut LocalDerivatives,
    ) -> Result<f64, Inadmissible>;
}
