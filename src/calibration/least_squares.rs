//! Nonlinear least squares of few unknowns.
//!
//! ```text
//! min |r(x)|^2 :    (J^T J + lambda D) d = -J^T r,    D = diag(J^T J)
//! ```
//!
//! Source: Levenberg (1944), Marquardt (1963); Nielsen (1999) for how the damping changes. The Jacobian is by central differences, whose
//! error of some 1e-10 bends the path and not its end.

use nalgebra::{DMatrix, DVector};

/// Where the residuals are least.
#[derive(Clone, Debug)]
pub(super) struct Minimum {
    pub(super) x: Vec<f64>,
    /// `|r|^2`.
    pub(super) cost: f64,
}

/// Steps that are tried at most; a well-posed fit takes some tens.
const MOST_STEPS: usize = 400;
/// A step below this share of each unknown (or of 1) ends the search.
const LAST_STEP: f64 = 1e-11;
/// Of central differences: the cube root of the rounding.
const DIFFERENCE: f64 = 6e-6;
/// Residuals that change faster with an unknown get shorter differences.
const STEEP: f64 = 30.0;
/// Where no step lowers the cost any more.
const MOST_DAMPING: f64 = 1e14;

/// A minimum of `|residuals(x)|^2` near `start`; none where the residuals are none or no numbers at `start`.
pub(super) fn minimum(
    residuals: impl Fn(&[f64]) -> Option<DVector<f64>>,
    start: &[f64],
) -> Option<Minimum> {
    let finite = |x: &[f64]| residuals(x).filter(|r| r.iter().all(|value| value.is_finite()));
    let mut x = start.to_vec();
    let mut r = finite(&x)?;
    let (mut damping, mut growth) = (1e-3, 2.0);
    let mut jacobian = differences(&finite, &x, r.len())?;
    for _ in 0..MOST_STEPS {
        let step = damped_step(&jacobian, &r, damping);
        let next: Vec<f64> = x.iter().zip(step.iter()).map(|(x, d)| x + d).collect();
        let is_last =
            x.iter().zip(step.iter()).all(|(x, d)| d.abs() <= LAST_STEP * x.abs().max(1.0));
        let found = finite(&next).filter(|next| next.norm_squared() < r.norm_squared());
        let Some(found) = found else {
            if is_last || damping > MOST_DAMPING {
                break;
            }
            damping *= growth;
            growth *= 2.0;
            continue;
        };
        let predicted = r.norm_squared() - (&r + &jacobian * &step).norm_squared();
        let gain = (r.norm_squared() - found.norm_squared()) / predicted;
        damping *= (1.0 - (2.0 * gain - 1.0).powi(3)).clamp(1.0 / 3.0, 2.0);
        growth = 2.0;
        (x, r) = (next, found);
        if is_last {
            break;
        }
        match differences(&finite, &x, r.len()) {
            Some(next) => jacobian = next,
            None => break,
        }
    }
    Some(Minimum { cost: r.norm_squared(), x })
}

/// The Jacobian at `x` `[rows, unknowns]`.
fn differences(
    residuals: &impl Fn(&[f64]) -> Option<DVector<f64>>,
    x: &[f64],
    rows: usize,
) -> Option<DMatrix<f64>> {
    let mut jacobian = DMatrix::zeros(rows, x.len());
    for k in 0..x.len() {
        let at = |value: f64| {
            let mut beside = x.to_vec();
            beside[k] = value;
            residuals(&beside)
        };
        let slope = |h: f64| Some((at(x[k] + h)? - at(x[k] - h)?) / (2.0 * h));
        let h = DIFFERENCE * x[k].abs().max(1.0);
        let coarse = slope(h)?;
        // Where residuals have a corner a step should be no longer than the way to it.
        let steep = coarse.norm();
        jacobian.set_column(k, &if steep > STEEP { slope(h * STEEP / steep)? } else { coarse });
    }
    Some(jacobian)
}

/// The step that is a least-squares solution of `J d = -r` and `sqrt(lambda D) d = 0`; by reflections, for the normal equations lose half
/// of the figures.
fn damped_step(jacobian: &DMatrix<f64>, r: &DVector<f64>, damping: f64) -> DVector<f64> {
    let (rows, unknowns) = jacobian.shape();
    let mut matrix = DMatrix::zeros(rows + unknowns, unknowns);
    matrix.rows_mut(0, rows).copy_from(jacobian);
    let largest = jacobian.column_iter().map(|column| column.norm()).fold(0.0, f64::max);
    for k in 0..unknowns {
        // An unknown that does nothing is held.
        let norm = jacobian.column(k).norm().max(1e-9 * largest).max(f64::MIN_POSITIVE);
        matrix[(rows + k, k)] = damping.sqrt() * norm;
    }
    let mut side = DVector::zeros(rows + unknowns);
    side.rows_mut(0, rows).copy_from(&-r);
    let qr = matrix.qr();
    qr.q_tr_mul(&mut side);
    let step = qr.r().solve_upper_triangular(&side.rows(0, unknowns).into_owned());
    step.unwrap_or_else(|| DVector::zeros(unknowns))
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    /// Rosenbrock's valley as residuals `10 (y - x^2), 1 - x`: its end is (1, 1).
    #[test]
    fn a_curved_valley_is_followed_to_its_end() {
        let valley =
            |x: &[f64]| Some(DVector::from_vec(vec![10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0]]));
        let found = minimum(valley, &[-1.2, 1.0]).unwrap();
        assert_relative_eq!(found.x[0], 1.0, epsilon = 1e-9);
        assert_relative_eq!(found.x[1], 1.0, epsilon = 1e-9);
        assert!(found.cost < 1e-18);
    }

    /// A line through three points that lie on none: slope 1.5 and intercept 1/6 by the normal equations.
    #[test]
    fn linear_residuals_have_their_closed_form() {
        let points = [(0.0, 0.0), (1.0, 2.0), (2.0, 3.0)];
        let line = |x: &[f64]| {
            Some(DVector::from_iterator(3, points.iter().map(|(t, y)| x[0] * t + x[1] - y)))
        };
        let found = minimum(line, &[0.0, 0.0]).unwrap();
        assert_relative_eq!(found.x[0], 1.5, epsilon = 1e-9);
        assert_relative_eq!(found.x[1], 1.0 / 6.0, epsilon = 1e-9);
        assert_relative_eq!(found.cost, 1.0 / 6.0, epsilon = 1e-9);
    }

    /// Steps into what is no law are shortened, and a start there is none.
    #[test]
    fn what_is_none_is_not_entered() {
        let logarithm = |x: &[f64]| (x[0] > 0.0).then(|| DVector::from_vec(vec![x[0].ln() + 3.0]));
        let found = minimum(logarithm, &[5.0]).unwrap();
        assert_relative_eq!(found.x[0], (-3.0_f64).exp(), max_relative = 1e-8);
        assert!(minimum(logarithm, &[-1.0]).is_none());
    }
}
