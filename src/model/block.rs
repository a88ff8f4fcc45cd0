//! 3x3 blocks of a Hessian as wide registers hold them, and sums of them.
//!
//! A kernel is a [`WithSimd`]: it is compiled for AVX2 with fused multiply-add beside the baseline, for NEON on ARM, and the
//! processor at hand decides which runs (`vectorize`). The last bits of sums depend on that choice, and on nothing else.

use std::ops::{AddAssign, Index, IndexMut};

use nalgebra::Matrix3;
use pulp::{Simd, WithSimd};

/// Runs `kernel` with the widest registers that hold whole columns of [`Block`]s: four numbers on x86-64.
#[inline]
pub(super) fn vectorize<K: WithSimd>(kernel: K) -> K::Output {
    #[cfg(target_arch = "x86_64")]
    if let Some(simd) = pulp::x86::V3::try_new() {
        return Simd::vectorize(simd, kernel);
    }
    pulp::Arch::new().dispatch(kernel)
}

/// With which instructions kernels run on this processor: `x86-64-v3` (AVX2, FMA), or the `baseline` of the target.
#[must_use]
pub fn instruction_set() -> &'static str {
    #[cfg(target_arch = "x86_64")]
    if pulp::x86::V3::try_new().is_some() {
        return "x86-64-v3";
    }
    "baseline"
}

/// Adds `sum_k weights_k rows_k` to `sum`.
#[inline(always)]
pub(super) fn add_combination<S: Simd, const M: usize, const N: usize>(
    simd: S,
    sum: &mut [f64; M],
    rows: [&[f64; M]; N],
    weights: &[f64; N],
) {
    let (sums, rest) = S::as_mut_simd_f64s(sum);
    debug_assert!(rest.is_empty());
    for (at, sum) in sums.iter_mut().enumerate() {
        let mut total = *sum;
        for (row, weight) in rows.iter().zip(weights) {
            let (row, _) = S::as_simd_f64s(*row);
            total = simd.mul_add_e_f64s(simd.splat_f64s(*weight), row[at], total);
        }
        *sum = total;
    }
}

/// Rows of a column as stored: three, and one that is never read.
const STRIDE: usize = 4;

/// A 3x3 matrix by columns, each one number longer than it has rows: its twelve numbers are three registers of four.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(32))]
pub struct Block([f64; 3 * STRIDE]);

impl Block {
    /// The columns.
    #[must_use]
    #[inline(always)]
    pub(super) fn columns(&self) -> &[[f64; STRIDE]; 3] {
        let (columns, _) = self.0.as_chunks::<STRIDE>();
        columns.first_chunk().expect("a block has three columns")
    }

    /// The 3x3 matrix.
    #[must_use]
    #[inline]
    pub fn matrix(&self) -> Matrix3<f64> {
        Matrix3::from_fn(|row, column| self[(row, column)])
    }

    /// Adds `sum_k weights_k blocks_k`.
    #[inline(always)]
    pub(super) fn add_combination<S: Simd, const N: usize>(
        &mut self,
        simd: S,
        blocks: &[Self; N],
        weights: &[f64; N],
    ) {
        add_combination(simd, &mut self.0, blocks.each_ref().map(|block| &block.0), weights);
    }

    /// Adds the matrix of the cross product with `[x, y, z, _]`.
    #[inline(always)]
    pub(super) fn add_cross(&mut self, [x, y, z, _]: [f64; 4]) {
        self[(1, 0)] += z;
        self[(0, 1)] -= z;
        self[(0, 2)] += y;
        self[(2, 0)] -= y;
        self[(2, 1)] += x;
        self[(1, 2)] -= x;
    }
}

impl From<&Matrix3<f64>> for Block {
    #[inline(always)]
    fn from(matrix: &Matrix3<f64>) -> Self {
        let [[a, b, c], [d, e, f], [g, h, i]] = matrix.data.0;
        Self([a, b, c, 0.0, d, e, f, 0.0, g, h, i, 0.0])
    }
}

impl Index<(usize, usize)> for Block {
    type Output = f64;

    #[inline(always)]
    fn index(&self, (row, column): (usize, usize)) -> &f64 {
        &self.0[STRIDE * column + row]
    }
}

impl IndexMut<(usize, usize)> for Block {
    #[inline(always)]
    fn index_mut(&mut self, (row, column): (usize, usize)) -> &mut f64 {
        &mut self.0[STRIDE * column + row]
    }
}

impl AddAssign for Block {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        for (sum, value) in self.0.iter_mut().zip(other.0) {
            *sum += value;
        }
    }
}

impl AddAssign<Matrix3<f64>> for Block {
    #[inline(always)]
    fn add_assign(&mut self, matrix: Matrix3<f64>) {
        *self += Self::from(&matrix);
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    struct Combine {
        start: Block,
        blocks: [Block; 5],
        weights: [f64; 5],
    }

    impl WithSimd for Combine {
        type Output = Block;

        #[inline(always)]
        fn with_simd<S: Simd>(mut self, simd: S) -> Block {
            self.start.add_combination(simd, &self.blocks, &self.weights);
            self.start
        }
    }

    /// By the definition, entry by entry; five products and sums of numbers below 1.
    #[test]
    fn combinations_are_sums_of_products_on_every_processor() {
        let mut chance = ChaCha8Rng::seed_from_u64(4);
        let mut matrix = || Matrix3::from_fn(|_, _| chance.random::<f64>());
        let matrices: [Matrix3<f64>; 6] = std::array::from_fn(|_| matrix());
        let weights = [0.5, -0.3, 0.9, 0.1, -0.7];
        let products = matrices[1..].iter().zip(weights).map(|(matrix, weight)| weight * matrix);
        let exact = matrices[0] + products.sum::<Matrix3<f64>>();
        let blocks = matrices.each_ref().map(Block::from);
        let [start, blocks @ ..] = blocks;
        let plain = Combine { start, blocks, weights }.with_simd(pulp::Scalar);
        for sum in [plain, vectorize(Combine { start, blocks, weights })] {
            assert!((sum.matrix() - exact).amax() < 6.0 * f64::EPSILON, "{sum:?}");
        }
    }

    #[test]
    fn cross_products_are_added() {
        let mut block = Block::default();
        block.add_cross([1.0, -2.0, 3.0, 0.0]);
        let (axis, v) =
            (crate::math::Vec3::new(1.0, -2.0, 3.0), crate::math::Vec3::new(5.0, 7.0, -4.0));
        assert_eq!(block.matrix() * v, axis.cross(&v));
    }
}
