//! How many directions a tangent has lost that was not factorised: Lanczos' method on its inverse.
//!
//! ```text
//! T = [1 0] K^-1 [1 0]^T        K = [ A  B^T ]        T has as many negative eigenvalues as A + B^T C^-1 B,
//!                                   [ B  -C  ]        and K as many and one for each multiplier (Haynsworth 1968)
//! ```
//!
//! The softest directions have the largest eigenvalues of `T`, of either sign, and a few steps find them: a direction that
//! has just been lost is the first. What a count of pivots is sure of, this is not: a lost direction that is many times stiffer than the
//! softest ones may be missed. Source: Lanczos (1950), with full reorthogonalisation.

use std::ops::Range;

use nalgebra::DMatrix;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::vectors::dot;

/// The number of negative eigenvalues of `T` that are found, for a tangent of this `order` with these `multipliers`.
///
/// `solve(b)` overwrites `b [n]` by `K^-1 b`, to [`TOLERANCE`] of its size; what goes wrong in it ends the count.
pub(super) fn lost_directions<E>(
    order: usize,
    multipliers: &Range<usize>,
    mut solve: impl FnMut(&mut [f64]) -> Result<(), E>,
) -> Result<usize, E> {
    let mut chance = ChaCha8Rng::seed_from_u64(0);
    let mut next: Vec<f64> = (0..order).map(|_| chance.random_range(-1.0..1.0)).collect();
    let steps = STEPS.min(order - multipliers.len());
    let mut directions: Vec<Vec<f64>> = Vec::with_capacity(steps);
    let mut projected = DMatrix::zeros(steps, steps);
    for step in 0..steps {
        next[multipliers.clone()].fill(0.0);
        let before = dot(&next, &next).sqrt();
        // Twice: once leaves what rounding makes of it.
        for direction in directions.iter().chain(&directions) {
            let share = dot(&next, direction);
            next.iter_mut().zip(direction).for_each(|(next, d)| *next -= share * d);
        }
        let length = dot(&next, &next).sqrt();
        if length <= f64::EPSILON * before || are_told(&projected, step, length) {
            break;
        }
        next.iter_mut().for_each(|next| *next /= length);
        directions.push(next.clone());
        solve(&mut next)?;
        for (i, direction) in directions.iter().enumerate() {
            projected[(i, step)] = dot(direction, &next);
            projected[(step, i)] = projected[(i, step)];
        }
    }
    let values = projected.symmetric_eigenvalues();
    Ok(values.iter().filter(|value| **value < -10.0 * TOLERANCE * values.amax()).count())
}

/// Whether the softest direction of the `steps` so far is known to a percent, and the sign of each that is not much stiffer: what the
/// method has not seen of each is `rest` times its share in the last step (Parlett 1998, section 13.2).
fn are_told(projected: &DMatrix<f64>, steps: usize, rest: f64) -> bool {
    if steps < 2 {
        return false;
    }
    let known = projected.view((0, 0), (steps, steps)).into_owned().symmetric_eigen();
    let softest = known.eigenvalues.amax();
    let is_told = |(value, last): (&f64, &f64)| {
        let size = value.abs();
        let allowed = if size < softest { 0.3 } else { 0.01 };
        size < STIFF * softest || rest * last.abs() < allowed * size
    };
    known.eigenvalues.iter().zip(&known.eigenvectors.row(steps - 1)).all(is_told)
}

/// How well a solution is wanted: the steps converge to what is softest within it.
pub(super) const TOLERANCE: f64 = 1e-3;
const STEPS: usize = 12;
/// Shares of the largest value of `T` that are not waited for: what is lost by more than 25 times the stiffness of what is softest may be missed.
const STIFF: f64 = 0.04;

#[cfg(test)]
mod tests {
    use nalgebra::DVector;

    use super::*;

    /// Of a saddle with `stiffness` on the diagonal of its displacements, and two constraints on neighbours.
    fn lost(stiffness: &[f64], compliance: f64) -> usize {
        let n = stiffness.len();
        let mut k = DMatrix::zeros(n + 2, n + 2);
        for (i, stiffness) in stiffness.iter().enumerate() {
            k[(i, i)] = *stiffness;
        }
        for (row, [i, j]) in [[n - 2, n - 1], [n - 4, n - 3]].into_iter().enumerate() {
            for (column, value) in [(i, 1.0), (j, -1.0), (n + row, -compliance)] {
                k[(n + row, column)] = value;
                k[(column, n + row)] = value;
            }
        }
        let factor = k.lu();
        let solve = |b: &mut [f64]| {
            let solution = factor.solve(&DVector::from_column_slice(b)).ok_or(())?;
            b.copy_from_slice(solution.as_slice());
            Ok::<(), ()>(())
        };
        lost_directions(n + 2, &(n..n + 2), solve).unwrap()
    }

    /// Spectra over four decades, as those of walls are; the constraints tie stiff unknowns.
    fn spectrum(n: usize) -> Vec<f64> {
        (0..n).map(|i| 10f64.powf(4.0 * i as f64 / n as f64)).collect()
    }

    #[test]
    fn lost_directions_are_counted() {
        for compliance in [0.0, 1e-3] {
            let mut stiffness = spectrum(60);
            assert_eq!(lost(&stiffness, compliance), 0);
            // Just lost; lost by as much as the softest holds; lost by twenty times as much.
            for value in [-1e-6, -1.0, -20.0] {
                stiffness[7] = value;
                assert_eq!(lost(&stiffness, compliance), 1, "{value}");
            }
            stiffness[3] = -0.3;
            assert_eq!(lost(&stiffness, compliance), 2);
        }
    }

    #[test]
    fn a_constraint_may_hold_what_is_lost_without_it() {
        let mut stiffness = spectrum(12);
        stiffness[10] = -5.0;
        assert_eq!(lost(&stiffness, 0.0), 0);
        stiffness[11] = 4.0;
        assert_eq!(lost(&stiffness, 0.0), 1);
    }

    #[test]
    fn what_goes_wrong_is_passed_on() {
        assert_eq!(lost_directions(3, &(3..3), |_| Err("stopped")), Err("stopped"));
    }
}
