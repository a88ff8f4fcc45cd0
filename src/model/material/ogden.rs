//! The Ogden law in smooth invariants.
//!
//! ```text
//! psi = sum_k 2 mu_k / alpha_k^2 (l1^alpha_k + l2^alpha_k + l3^alpha_k - 3)       (Abaqus' convention)
//! l1^alpha + l2^alpha = 2 J^(a/2) C_a(y),    a = alpha / 2,    y = T / (2 sqrt J) - 1 >= 0
//! C_a(y) = cosh(a arcosh(1 + y))
//! ```
//!
//! `C_a` is analytic at equal stretches (y = 0), where the principal directions are not: near 0 its series
//! is used, `c_0 = 1`, `c_(k+1) = c_k (a^2 - k^2) / ((2k + 1)(k + 1))`, a hypergeometric function 2F1.
//!
//! Source: Ogden (1972).

use serde::{Deserialize, Serialize};

use super::EnergyDensity;

/// Below this `y` the series is used; it converges like `(y/2)^k`, so 14 terms leave less than 1e-17.
const SERIES_LIMIT: f64 = 0.1;
const SERIES_TERMS: usize = 14;

/// One term of the Ogden law.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OgdenTerm {
    /// Contribution to the shear modulus at rest, MPa.
    pub mu: f64,
    /// Exponent.
    pub alpha: f64,
}

/// Incompressible Ogden rubber with any number of terms.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ogden {
    /// The terms; their `mu` sum to the shear modulus at rest.
    pub terms: Vec<OgdenTerm>,
}

impl Ogden {
    /// NinjaFlex as in the public Abaqus decks of the 2022 work, taken as incompressible: mu 5.212 MPa.
    #[must_use]
    pub fn ninjaflex_c2s() -> Self {
        Self::of([(0.108866, 3.20735), (2.1565, -1.89042), (2.94629, 1.33796)])
    }

    /// NinjaFlex by Yap et al. (2016): mu 6.212 MPa; its negative first term makes it unstable at some strains.
    #[must_use]
    pub fn ninjaflex_yap2016() -> Self {
        Self::of([(-30.921, 0.508), (10.342, 1.375), (26.791, -0.482)])
    }

    fn of(terms: [(f64, f64); 3]) -> Self {
        Self { terms: terms.map(|(mu, alpha)| OgdenTerm { mu, alpha }).to_vec() }
    }

    pub(super) fn density(&self, t: f64, j: f64) -> EnergyDensity {
        let mut sum = EnergyDensity::default();
        for term in &self.terms {
            let density = term.density(t, j);
            sum.value += density.value;
            for (sum, value) in sum.first.iter_mut().zip(density.first) {
                *sum += value;
            }
            for (sum, value) in sum.second.iter_mut().zip(density.second) {
                *sum += value;
            }
        }
        sum
    }

    pub(super) fn energy(&self, t: f64, j: f64) -> f64 {
        let y = y_of(t, j);
        let term = |term: &OgdenTerm| {
            let a = 0.5 * term.alpha;
            term.factor() * (2.0 * j.powf(0.5 * a) * cosh_multiple(a, y)[0] + j.powf(-a) - 3.0)
        };
        self.terms.iter().map(term).sum()
    }
}

impl OgdenTerm {
    fn factor(&self) -> f64 {
        2.0 * self.mu / (self.alpha * self.alpha)
    }

    fn density(&self, t: f64, j: f64) -> EnergyDensity {
        let a = 0.5 * self.alpha;
        let factor = self.factor();
        let y = y_of(t, j);
        let [c, dc, ddc] = cosh_multiple(a, y);
        // P = 2 J^(a/2);  y_T = 1 / (2 sqrt J);  y_J = -(1 + y) / (2 J).
        let p = 2.0 * j.powf(0.5 * a);
        let dp = 0.5 * a * p / j;
        let ddp = (0.5 * a - 1.0) * dp / j;
        let y_t = 0.5 / j.sqrt();
        let y_j = -0.5 * (1.0 + y) / j;
        let y_tj = -0.5 * y_t / j;
        let y_jj = 0.75 * (1.0 + y) / (j * j);
        let third = j.powf(-a);
        EnergyDensity {
            value: factor * (p * c + third - 3.0),
            first: [factor * p * dc * y_t, factor * (dp * c + p * dc * y_j - a * third / j)],
            second: [
                factor * p * ddc * y_t * y_t,
                factor * (dp * dc * y_t + p * (ddc * y_j * y_t + dc * y_tj)),
                factor
                    * (ddp * c
                        + 2.0 * dp * dc * y_j
                        + p * (ddc * y_j * y_j + dc * y_jj)
                        + a * (a + 1.0) * third / (j * j)),
            ],
        }
    }
}

fn y_of(t: f64, j: f64) -> f64 {
    0.5 * t / j.sqrt() - 1.0
}

/// `C_a(y)` with its first and second derivative.
fn cosh_multiple(a: f64, y: f64) -> [f64; 3] {
    if y < SERIES_LIMIT {
        return cosh_multiple_series(a, y);
    }
    let eta = (1.0 + y).acosh();
    let sinh = eta.sinh();
    let first = a * (a * eta).sinh() / sinh;
    let value = (a * eta).cosh();
    [value, first, (a * a * value - (1.0 + y) * first) / (sinh * sinh)]
}

fn cosh_multiple_series(a: f64, y: f64) -> [f64; 3] {
    let mut coefficients = [1.0; SERIES_TERMS];
    for k in 0..SERIES_TERMS - 1 {
        let n = k as f64;
        coefficients[k + 1] = coefficients[k] * (a * a - n * n) / ((2.0 * n + 1.0) * (n + 1.0));
    }
    // Horner's scheme for the value and both derivatives.
    coefficients
        .iter()
        .rev()
        .fold([0.0; 3], |[f, df, ddf], c| [f * y + c, df * y + f, ddf * y + 2.0 * df])
}
