//! Linear systems of forces without a potential: GMRES behind the factorised tangent.
//!
//! ```text
//! (K + N) y = b      as      (1 + N K^-1) z = b,   y = K^-1 z
//! ```
//!
//! `K` is symmetric and factorised, `N` is what a system adds where it is not conservative. Each iteration costs one solution
//! with the factor and one product with `N`, and there are at most rank N + 1 of them. The residual that is minimised is that of
//! the system itself, not one seen through `K`. Source: Saad & Schultz (1986), SIAM J. Sci. Stat. Comput. 7:856, algorithm 4,
//! without restarts: `faer`'s matrix-free solvers have no GMRES, and BiCGSTAB's residual may grow and break down.

use std::cmp::Ordering;

use super::vectors::dot;
use super::{EquilibriumSolver, SolverFailure};
use crate::model::system::System;

/// What an iteration reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KrylovReport {
    /// Products with `N`.
    pub iterations: usize,
    /// Norm of the residual over that of the right-hand side.
    pub residual: f64,
}

impl KrylovReport {
    /// Whether the residual is as small as was asked for.
    #[must_use]
    pub fn has_converged(&self) -> bool {
        self.residual <= TOLERANCE
    }
}

/// Solves `(K + N) y = b` with the tangent `K` that `solver` last linearized, at `x [n]`; `b [n]` is overwritten by `y`.
///
/// # Errors
/// [`SolverFailure`] when the library of the factor fails; an iteration that does not converge is a value.
///
/// # Panics
/// As [`EquilibriumSolver::solve_linearized`].
pub fn solve_unsymmetric(
    system: &dyn System,
    solver: &mut dyn EquilibriumSolver,
    x: &[f64],
    b: &mut [f64],
) -> Result<KrylovReport, SolverFailure> {
    let size = dot(b, b).sqrt();
    let mut report = KrylovReport { iterations: 0, residual: 0.0 };
    if system.is_conservative() || size == 0.0 {
        solver.solve_linearized(b)?;
        return Ok(report);
    }
    report.residual = 1.0;
    // Orthonormal directions, the columns of the rotated Hessenberg matrix (upper triangular), and the rotated right-hand side.
    let mut directions = vec![b.iter().map(|b| b / size).collect::<Vec<f64>>()];
    let (mut upper, mut rotations) = (Vec::<Vec<f64>>::new(), Vec::<[f64; 2]>::new());
    let mut rotated = vec![size];
    while !report.has_converged() && report.iterations < MOST_ITERATIONS {
        let k = report.iterations;
        let mut y = directions[k].clone();
        solver.solve_linearized(&mut y)?;
        let mut next = directions[k].clone();
        system.add_circulatory_tangent(x, &y, &mut next);
        let reach = dot(&next, &next).sqrt();
        let mut column = Vec::with_capacity(k + 1);
        for direction in &directions {
            let share = dot(&next, direction);
            add(&mut next, -share, direction);
            column.push(share);
        }
        let rest = dot(&next, &next).sqrt();
        for (i, &[c, s]) in rotations.iter().enumerate() {
            (column[i], column[i + 1]) =
                (c * column[i] + s * column[i + 1], c * column[i + 1] - s * column[i]);
        }
        let length = column[k].hypot(rest);
        // Nothing of what is left lies in the range of the matrix, which is singular; or there is a number no more.
        if length.partial_cmp(&(f64::EPSILON * reach)) != Some(Ordering::Greater) {
            break;
        }
        let [c, s] = [column[k] / length, rest / length];
        column[k] = length;
        rotated.push(-s * rotated[k]);
        rotated[k] *= c;
        rotations.push([c, s]);
        upper.push(column);
        report.iterations += 1;
        report.residual = rotated[k + 1].abs() / size;
        if rest <= f64::EPSILON * reach {
            break;
        }
        next.iter_mut().for_each(|next| *next /= rest);
        directions.push(next);
    }
    b.fill(0.0);
    for i in (0..upper.len()).rev() {
        let later = (i + 1..upper.len()).map(|j| upper[j][i] * rotated[j]).sum::<f64>();
        rotated[i] = (rotated[i] - later) / upper[i][i];
        add(b, rotated[i], &directions[i]);
    }
    solver.solve_linearized(b)?;
    Ok(report)
}

/// A Newton step wants no more, and the factor gives no less in a thin wall's worst direction.
const TOLERANCE: f64 = 1e-10;
/// Follower forces act on few nodes in much the same way: a dozen directions is usual.
const MOST_ITERATIONS: usize = 60;

fn add(sum: &mut [f64], factor: f64, vector: &[f64]) {
    sum.iter_mut().zip(vector).for_each(|(sum, vector)| *sum += factor * vector);
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::model::system::{Inadmissible, SparsityPattern};
    use crate::solve::NativeSolver;
    use crate::solve::test_systems::{Chain, nothing};

    const ORDER: usize = 24;

    /// A chain of springs of stiffness 1, and forces without a potential.
    struct Circulating {
        chain: Chain,
        circulation: DMatrix<f64>,
    }

    impl System for Circulating {
        fn pattern(&self) -> &SparsityPattern {
            self.chain.pattern()
        }

        fn energy(&mut self, x: &[f64]) -> Result<f64, Inadmissible> {
            self.chain.energy(x)
        }

        fn residual(&mut self, x: &[f64], residual: &mut [f64]) -> Result<f64, Inadmissible> {
            self.chain.residual(x, residual)
        }

        fn tangent(
            &mut self,
            x: &[f64],
            residual: &mut [f64],
            tangent: &mut [f64],
        ) -> Result<f64, Inadmissible> {
            self.chain.tangent(x, residual, tangent)
        }

        fn force_scale(&self) -> f64 {
            1.0
        }

        fn is_conservative(&self) -> bool {
            false
        }

        fn add_circulatory_tangent(&self, _: &[f64], v: &[f64], out: &mut [f64]) {
            let change = &self.circulation * DVector::from_column_slice(v);
            out.iter_mut().zip(&change).for_each(|(out, change)| *out += change);
        }
    }

    /// The report of a solution with a circulation of this rank, and its distance from a dense LU's.
    fn solved(rank: usize, size: f64, seed: u64) -> (KrylovReport, f64) {
        let mut chance = ChaCha8Rng::seed_from_u64(seed);
        let mut random = |n, m| DMatrix::from_fn(n, m, |_, _| chance.random_range(-1.0..1.0));
        let circulation = size * random(ORDER, rank) * random(rank, ORDER);
        let b: Vec<f64> = random(ORDER, 1).iter().copied().collect();
        let tangent = DMatrix::from_fn(ORDER, ORDER, |i, j| match i.abs_diff(j) {
            0 if i + 1 == ORDER => 1.0,
            0 => 2.0,
            1 => -1.0,
            _ => 0.0,
        });
        let exact = (tangent + &circulation).lu().solve(&DVector::from_column_slice(&b)).unwrap();
        let mut system = Circulating { chain: Chain::linear(ORDER, nothing), circulation };
        let mut solver = NativeSolver::new(system.pattern()).unwrap();
        let (x, mut y) = ([0.0; ORDER], b);
        solver.linearize(&mut system, &x).unwrap();
        let report = solve_unsymmetric(&system, &mut solver, &x, &mut y).unwrap();
        (report, (DVector::from_vec(y) - &exact).norm() / exact.norm())
    }

    /// As many directions as the rank, and one. The tolerance of 1e-10 times the condition of the sums, which is below 1e4.
    #[test]
    fn solution_is_that_of_a_dense_factorisation() {
        for (rank, size) in [(1, 1.0), (2, 0.3), (2, -5.0), (5, 1.0), (ORDER, 0.1)] {
            for seed in 0..4 {
                let (report, miss) = solved(rank, size, seed);
                assert!(report.has_converged() && miss < 1e-6, "rank {rank}: {report:?} {miss:e}");
                assert!(report.iterations <= rank + 1, "rank {rank}: {report:?}");
            }
        }
    }

    #[test]
    fn nothing_and_no_circulation_are_short_work() {
        let (report, miss) = solved(1, 0.0, 0);
        assert!(report.iterations <= 1 && miss < 1e-12, "{report:?} {miss:e}");
        let mut system = Chain::linear(3, nothing);
        let mut solver = NativeSolver::new(system.pattern()).unwrap();
        solver.linearize(&mut system, &[0.0; 3]).unwrap();
        let mut y = [0.0, 0.0, 1.0];
        let report = solve_unsymmetric(&system, &mut solver, &[0.0; 3], &mut y).unwrap();
        assert_eq!(report, KrylovReport { iterations: 0, residual: 0.0 });
        for (k, y) in y.iter().enumerate() {
            assert!((y - (k + 1) as f64).abs() < 1e-14);
        }
    }

    /// `K + N` without an inverse has no solution, and says so.
    #[test]
    fn a_singular_system_does_not_converge() {
        let mut chain = Chain::linear(2, nothing);
        let mut solver = NativeSolver::new(chain.pattern()).unwrap();
        solver.linearize(&mut chain, &[0.0; 2]).unwrap();
        // [[2, -1], [-1, 1]] less its own last row.
        let circulation = DMatrix::from_row_slice(2, 2, &[0.0, 0.0, 1.0, -1.0]);
        let system = Circulating { chain, circulation };
        let mut y = [0.0, 1.0];
        let report = solve_unsymmetric(&system, &mut solver, &[0.0; 2], &mut y).unwrap();
        assert!(!report.has_converged(), "{report:?} {y:?}");
    }
}
