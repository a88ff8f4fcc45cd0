//! Energy terms on small stencils, the only thing that the assembler knows.

use nalgebra::Matrix3;

use super::system::Inadmissible;
use crate::math::Vec3;

/// Gradient and Hessian of one stencil's energy with respect to its node positions.
#[derive(Clone, Debug)]
pub struct LocalDerivatives {
    size: usize,
    gradient: Vec<Vec3>,
    /// Row-major blocks `(i, j)`; only `i >= j` is used.
    hessian: Vec<Matrix3<f64>>,
    with_hessian: bool,
}

impl LocalDerivatives {
    /// Room for stencils of at most `nodes` nodes.
    #[must_use]
    pub fn with_capacity(nodes: usize) -> Self {
        Self {
            size: 0,
            gradient: vec![Vec3::zeros(); nodes],
            hessian: vec![Matrix3::zeros(); nodes * nodes],
            with_hessian: true,
        }
    }

    /// Forgets everything and prepares for a stencil of `size` nodes.
    pub fn reset(&mut self, size: usize, with_hessian: bool) {
        self.size = size;
        self.with_hessian = with_hessian;
        self.gradient[..size].fill(Vec3::zeros());
        if with_hessian {
            self.hessian[..size * size].fill(Matrix3::zeros());
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
        &self.gradient[..self.size]
    }

    /// The gradient, to be added to.
    pub fn gradient_mut(&mut self) -> &mut [Vec3] {
        &mut self.gradient[..self.size]
    }

    /// The Hessian block of nodes `i >= j`, N/mm.
    #[must_use]
    #[inline]
    pub fn block(&self, i: usize, j: usize) -> &Matrix3<f64> {
        &self.hessian[i * self.size + j]
    }

    /// The Hessian block of nodes `i >= j`, to be added to.
    #[inline]
    pub fn block_mut(&mut self, i: usize, j: usize) -> &mut Matrix3<f64> {
        &mut self.hessian[i * self.size + j]
    }
}

/// A part of the potential energy that is a sum over stencils of nodes.
pub trait Term {
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
