//! Ogden's law through the principal stretches.
//!
//! ```text
//! F = sum_a l_a n_a (x) N_a        e_a = ln l_a - ln(J) / 3
//! psi_iso = sum_k 2 mu_k / alpha_k^2 sum_a expm1(alpha_k e_a)
//! P = sum_a tau_a / l_a n_a (x) N_a,    tau = s - mean(s),    s_a = sum_k 2 mu_k / alpha_k expm1(alpha_k e_a)
//! A = sum_ab w_ab (n_a N_a) (x) (n_b N_b)
//!   + sum_(a /= b) p_ab (n_a N_b) (x) (n_a N_b) + q_ab (n_a N_b) (x) (n_b N_a)
//! w_ab = (d_ab (t_a - tau_a) - (t_a + t_b) / 3 + sum(t) / 9) / (l_a l_b),    t_a = sum_k 2 mu_k exp(alpha_k e_a)
//! p_ab = (s_a - s_b) / (l_a^2 - l_b^2)
//! q_ab = (p_ab (l_a^2 + l_b^2) - tau_a - tau_b) / (2 l_a l_b)
//! ```
//!
//! The quotient `p_ab` is smooth: with `h = ln(l_a / l_b)` it is
//! `sum_k 2 mu_k / (l_a l_b) exp(alpha_k (e_a + e_b) / 2) sinh(alpha_k h / 2) / (alpha_k sinh h)`, in which nothing
//! cancels where stretches are nearly equal.
//!
//! Source: Ogden (1984), Non-linear Elastic Deformations, 6.1.

use nalgebra::{Matrix3, SymmetricEigen, Vector3};

use super::response::{LOWER, SolidResponse, mirror};
use crate::model::material::ogden_term::OgdenTerm;

/// `psi_iso` at `f`, MPa, of these terms.
pub(in crate::model::material) fn energy(
    f: &Matrix3<f64>,
    terms: impl Iterator<Item = OgdenTerm>,
) -> f64 {
    let squares = f.tr_mul(f).symmetric_eigenvalues();
    let e = deviatoric(squares.map(|square| 0.5 * square.ln()));
    let of_term = |OgdenTerm { mu, alpha }| {
        2.0 * mu / (alpha * alpha) * e.map(|e| (alpha * e).exp_m1()).sum()
    };
    terms.map(of_term).sum()
}

/// The same with its derivatives by `f`.
pub(in crate::model::material) fn response(
    f: &Matrix3<f64>,
    with_moduli: bool,
    terms: impl Iterator<Item = OgdenTerm> + Clone,
) -> SolidResponse {
    let SymmetricEigen { eigenvalues, eigenvectors: rest } = SymmetricEigen::new(f.tr_mul(f));
    let stretches = eigenvalues.map(f64::sqrt);
    let logarithms = stretches.map(f64::ln);
    let e = deviatoric(logarithms);
    let mut energy = 0.0;
    let mut s = Vector3::zeros();
    for OgdenTerm { mu, alpha } in terms.clone() {
        let modulus = 2.0 * mu;
        let excess = e.map(|e| (alpha * e).exp_m1());
        energy += modulus / (alpha * alpha) * excess.sum();
        s += modulus / alpha * excess;
    }
    let tau = deviatoric(s);
    let mut now = f * rest;
    for (mut direction, stretch) in now.column_iter_mut().zip(&stretches) {
        direction /= *stretch;
    }
    let principal = Matrix3::from_diagonal(&tau.component_div(&stretches));
    let stress = now * principal * rest.transpose();
    let moduli = if with_moduli {
        principal_moduli(terms, &stretches, &logarithms, &tau).in_space(&now, &rest)
    } else {
        Default::default()
    };
    SolidResponse { energy, stress, moduli }
}

fn principal_moduli(
    terms: impl Iterator<Item = OgdenTerm>,
    stretches: &Vector3<f64>,
    logarithms: &Vector3<f64>,
    tau: &Vector3<f64>,
) -> PrincipalModuli {
    let halves = 0.5 * deviatoric(*logarithms);
    let mut t = Vector3::zeros();
    let mut quotients = [0.0; 3];
    let gaps = PAIRS.map(|[a, b]| logarithms[a] - logarithms[b]);
    let sinh_gaps = gaps.map(f64::sinh);
    for OgdenTerm { mu, alpha } in terms {
        let modulus = 2.0 * mu;
        let roots = halves.map(|half| (alpha * half).exp());
        t += modulus * roots.component_mul(&roots);
        for (k, [a, b]) in PAIRS.into_iter().enumerate() {
            let ratio = if gaps[k] == 0.0 {
                0.5
            } else {
                (0.5 * alpha * gaps[k]).sinh() / (alpha * sinh_gaps[k])
            };
            quotients[k] += modulus * roots[a] * roots[b] * ratio;
        }
    }
    let outer = stretches * stretches.transpose();
    let sum = t.sum() / 9.0;
    let mut along = Matrix3::from_fn(|a, b| (sum - (t[a] + t[b]) / 3.0) / outer[(a, b)]);
    let mut across = Matrix3::zeros();
    let mut swapped = Matrix3::zeros();
    for a in 0..3 {
        along[(a, a)] += (t[a] - tau[a]) / outer[(a, a)];
        across[(a, a)] = along[(a, a)];
    }
    for (quotient, [a, b]) in quotients.into_iter().zip(PAIRS) {
        let p = quotient / outer[(a, b)];
        let q = (p * (outer[(a, a)] + outer[(b, b)]) - tau[a] - tau[b]) / (2.0 * outer[(a, b)]);
        (across[(a, b)], across[(b, a)]) = (p, p);
        (swapped[(a, b)], swapped[(b, a)]) = (q, q);
    }
    PrincipalModuli { along, across, swapped }
}

/// The pairs of principal directions.
const PAIRS: [[usize; 2]; 3] = [[0, 1], [1, 2], [2, 0]];

/// The moduli in the principal frame, MPa.
struct PrincipalModuli {
    /// `w_ab`.
    along: Matrix3<f64>,
    /// `p_ab`, with `w_aa` on the diagonal.
    across: Matrix3<f64>,
    /// `q_ab`, with zeros on the diagonal.
    swapped: Matrix3<f64>,
}

impl PrincipalModuli {
    /// In the layout of [`SolidResponse::moduli`], for principal directions `now` and at `rest` (columns).
    fn in_space(&self, now: &Matrix3<f64>, rest: &Matrix3<f64>) -> [[Matrix3<f64>; 3]; 3] {
        let mut moduli = [[Matrix3::zeros(); 3]; 3];
        for [j, l] in LOWER {
            let weight = |a: usize, b: usize| rest[(j, a)] * rest[(l, b)];
            let squares = self.across * Vector3::from_fn(|b, _| weight(b, b));
            let principal = Matrix3::from_fn(|a, b| {
                if a == b {
                    squares[a]
                } else {
                    self.along[(a, b)] * weight(a, b) + self.swapped[(a, b)] * weight(b, a)
                }
            });
            moduli[j][l] = now * principal * now.transpose();
        }
        mirror(&mut moduli);
        moduli
    }
}

/// Without their mean.
#[inline]
fn deviatoric(values: Vector3<f64>) -> Vector3<f64> {
    values.add_scalar(-values.mean())
}
