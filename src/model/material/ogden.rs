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

use nalgebra::Matrix3;

use super::fit_form::{FitForm, FittedLaw};
use super::incompressible_law::IncompressibleLaw;
use super::keys::{InvalidMaterial, Key, KeyKind, KeyValue, LawKeys, positive};
use super::named_law::NamedLaw;
use super::of_invariants::OfInvariants;
use super::ogden_term::OgdenTerm;
use super::rubber::Rubber;
use super::solid::{SolidResponse, of_stretches};

/// Measured laws have exponents up to some 25; far beyond, the powers of the stretches overflow.
const LARGEST_EXPONENT: f64 = 100.0;

/// The largest exponent that a fit tries.
const LARGEST_FITTED: f64 = 40.0;
/// The least: nearer to 0 a term is Hencky's law of the logarithms, and its numbers lose their figures.
const LEAST_FITTED: f64 = 1e-3;

/// Below this `y` the series is used, or below `STEEP / a^2`: it converges like `(y/2)^k`, but only after terms that grow like
/// `(2 a^2 y)^k / (2k)!`. With 14 of them less than 1e-16 is left either way.
const SERIES_LIMIT: f64 = 0.1;
const STEEP: f64 = 4.5;
const SERIES_TERMS: usize = 14;

/// Incompressible Ogden rubber with any number of terms.
#[derive(Clone, Debug, PartialEq)]
pub struct Ogden {
    terms: Vec<PreparedTerm>,
    /// The least of the terms' limits.
    series_limit: f64,
}

/// A term with what depends on its exponent alone.
#[derive(Clone, Debug, PartialEq)]
struct PreparedTerm {
    term: OgdenTerm,
    /// `2 mu / alpha^2`.
    factor: f64,
    /// Half the exponent.
    a: f64,
    /// Coefficients of `C_a` about 0.
    series: [f64; SERIES_TERMS],
    /// The `y` below which they are used.
    series_limit: f64,
}

impl Ogden {
    /// The law with these terms, whose exponents are not 0; their `mu` sum to the shear modulus at rest.
    #[must_use]
    pub fn new(terms: &[OgdenTerm]) -> Self {
        let terms: Vec<_> = terms.iter().map(|&term| PreparedTerm::new(term)).collect();
        let series_limit = terms.iter().map(|term| term.series_limit).fold(SERIES_LIMIT, f64::min);
        Self { terms, series_limit }
    }

    /// NinjaFlex as in the public Abaqus decks of the 2022 work, taken as incompressible: mu 5.212 MPa.
    #[must_use]
    pub fn ninjaflex_c2s() -> Self {
        Self::of([(0.108866, 3.20735), (2.1565, -1.89042), (2.94629, 1.33796)])
    }

    /// NinjaFlex by Yap et al. (2016): mu 6.212 MPa; stable at every stretch in spite of its negative first term.
    #[must_use]
    pub fn ninjaflex_yap2016() -> Self {
        Self::of([(-30.921, 0.508), (10.342, 1.375), (26.791, -0.482)])
    }

    /// The terms.
    pub fn terms(&self) -> impl Iterator<Item = OgdenTerm> + Clone {
        self.terms.iter().map(|prepared| prepared.term)
    }

    fn of(terms: [(f64, f64); 3]) -> Self {
        Self::new(&terms.map(|(mu, alpha)| OgdenTerm { mu, alpha }))
    }
}

impl NamedLaw for Ogden {
    const NAME: &'static str = "ogden";
    const KEYS: &'static [Key] = &[Key {
        name: "terms",
        kind: KeyKind::Terms,
        meaning: "a list of { mu = .., alpha = .. }: shares of the shear modulus at rest, MPa, and exponents",
    }];
    const WANTS: &'static str =
        "`terms = [{ mu, alpha }]`, with `bulk_modulus` if it is compressible";

    fn read(keys: &LawKeys<'_>) -> Result<Self, InvalidMaterial> {
        let terms = keys.terms("terms")?;
        if terms.is_empty() {
            let line =
                "[material] terms is empty; an Ogden law has at least one { mu, alpha }".to_owned();
            return Err(line.into());
        }
        let is_exponent = |alpha: f64| alpha != 0.0 && alpha.abs() <= LARGEST_EXPONENT;
        if let Some(OgdenTerm { alpha, .. }) = terms.iter().find(|term| !is_exponent(term.alpha)) {
            return Err(format!(
                "[material] terms: alpha is {alpha:?}, but it must be a number other than 0 and at most {LARGEST_EXPONENT} in size"
            )
            .into());
        }
        let modulus: f64 = terms.iter().map(|term| term.mu).sum();
        positive("the sum of mu over the [material] terms", modulus)?;
        Ok(Self::new(terms))
    }
}

/// With a positive `mu` each term is convex in the logarithms of the stretches, so that their sum is stable everywhere.
impl FittedLaw for Ogden {
    const FORMS: &'static [FitForm] = &[
        FitForm {
            name: "ogden (1 term)",
            starts: &[&[0.0, 2.0], &[0.0, -2.0], &[0.0, 6.0]],
            is_always_stable: true,
            is_of_first_invariant: false,
            rubber: fitted,
        },
        FitForm {
            name: "ogden (2 terms)",
            starts: &[
                &[-0.1, 1.5, -4.0, 5.0],
                &[-0.1, 2.0, -3.0, -2.0],
                &[-0.7, 1.0, -0.7, 4.0],
                &[-0.1, 1.0, -6.0, 9.0],
                &[-0.7, -4.0, -0.7, 2.0],
            ],
            is_always_stable: true,
            is_of_first_invariant: false,
            rubber: fitted,
        },
        FitForm {
            name: "ogden (3 terms)",
            starts: &[
                &[-0.1, 1.3, -4.0, 5.0, -4.0, -2.0],
                &[-0.7, 1.5, -2.0, 3.5, -2.0, -2.0],
                &[-0.1, 1.0, -3.0, 4.0, -7.0, 9.0],
                &[-1.0, 1.0, -1.0, 3.0, -1.0, -2.0],
            ],
            is_always_stable: true,
            is_of_first_invariant: false,
            rubber: fitted,
        },
    ];

    fn values(&self) -> Vec<(&'static str, KeyValue)> {
        vec![("terms", KeyValue::Terms(self.terms().collect()))]
    }
}

/// The law whose terms have the logarithms of `mu` over `modulus` and the exponents `x`, by turns.
fn fitted(x: &[f64], modulus: f64) -> Option<Rubber> {
    let term = |pair: &[f64]| OgdenTerm { mu: modulus * pair[0].exp(), alpha: pair[1] };
    let terms: Vec<OgdenTerm> = x.chunks(2).map(term).collect();
    let is_sought = |term: &OgdenTerm| (LEAST_FITTED..=LARGEST_FITTED).contains(&term.alpha.abs());
    terms.iter().all(is_sought).then(|| Ogden::new(&terms).into())
}

impl IncompressibleLaw for Ogden {
    fn density(&self, t: f64, j: f64) -> OfInvariants {
        let state = State::new(t, j, self.series_limit);
        let sum = |sum, term: &PreparedTerm| sum + term.density(&state);
        self.terms.iter().fold(OfInvariants::default(), sum)
    }

    fn energy(&self, t: f64, j: f64) -> f64 {
        let state = State::new(t, j, self.series_limit);
        self.terms.iter().map(|term| term.energy(&state)).sum()
    }

    fn dilation_rate(&self, t: f64, j: f64) -> OfInvariants {
        let state = State::new(t, j, self.series_limit);
        let sum = |sum, term: &PreparedTerm| sum + term.dilation_rate(&state);
        self.terms.iter().fold(OfInvariants::default(), sum)
    }

    fn shear_modulus(&self) -> f64 {
        self.terms().map(|term| term.mu).sum()
    }

    fn solid_energy(&self, f: &Matrix3<f64>) -> f64 {
        of_stretches::energy(f, self.terms())
    }

    fn solid_response(&self, f: &Matrix3<f64>, with_moduli: bool) -> SolidResponse {
        of_stretches::response(f, with_moduli, self.terms())
    }
}

/// The invariants as all terms need them.
struct State {
    j: f64,
    ln_j: f64,
    y: f64,
    /// `arcosh(1 + y)`; 0 where the series of every term stands for it.
    eta: f64,
    /// Derivatives of `y` by T, J, TJ, JJ.
    dy: [f64; 4],
}

impl State {
    fn new(t: f64, j: f64, series_limit: f64) -> Self {
        let sqrt_j = j.sqrt();
        let y = 0.5 * t / sqrt_j - 1.0;
        let eta = if y < series_limit { 0.0 } else { (1.0 + y).acosh() };
        let (y_t, y_j) = (0.5 / sqrt_j, -0.5 * (1.0 + y) / j);
        Self { j, ln_j: j.ln(), y, eta, dy: [y_t, y_j, -0.5 * y_t / j, -1.5 * y_j / j] }
    }
}

impl PreparedTerm {
    fn new(term: OgdenTerm) -> Self {
        let a = 0.5 * term.alpha;
        let mut series = [1.0; SERIES_TERMS];
        for k in 0..SERIES_TERMS - 1 {
            let n = k as f64;
            series[k + 1] = series[k] * (a * a - n * n) / ((2.0 * n + 1.0) * (n + 1.0));
        }
        let factor = 2.0 * term.mu / (term.alpha * term.alpha);
        Self { term, factor, a, series, series_limit: SERIES_LIMIT.min(STEEP / (a * a)) }
    }

    fn energy(&self, state: &State) -> f64 {
        let half_power = (0.5 * self.a * state.ln_j).exp();
        let third = 1.0 / (half_power * half_power);
        self.factor * (2.0 * half_power * self.cosh_multiple(state) + third - 3.0)
    }

    fn density(&self, state: &State) -> OfInvariants {
        let mut density = self.powers(state, [self.factor; 2]);
        density.value -= 3.0 * self.factor;
        density
    }

    /// At a volume ratio `e^s` the powers in the plane grow with `-alpha s / 3`, the third one with `2 alpha s / 3`.
    fn dilation_rate(&self, state: &State) -> OfInvariants {
        let rate = 2.0 / 3.0 * self.a * self.factor;
        self.powers(state, [-rate, 2.0 * rate])
    }

    /// `plane (l1^alpha + l2^alpha) + across l3^alpha`.
    fn powers(&self, state: &State, [plane, across]: [f64; 2]) -> OfInvariants {
        let (a, j) = (self.a, state.j);
        let [c, dc, ddc] = self.cosh_multiple_derivatives(state);
        let [y_t, y_j, y_tj, y_jj] = state.dy;
        // P = 2 J^(a/2), and l3^alpha = J^-a.
        let half_power = (0.5 * a * state.ln_j).exp();
        let p = 2.0 * plane * half_power;
        let dp = 0.5 * a * p / j;
        let ddp = (0.5 * a - 1.0) * dp / j;
        let third = across / (half_power * half_power);
        OfInvariants {
            value: p * c + third,
            first: [p * dc * y_t, dp * c + p * dc * y_j - a * third / j],
            second: [
                p * ddc * y_t * y_t,
                dp * dc * y_t + p * (ddc * y_j * y_t + dc * y_tj),
                ddp * c
                    + 2.0 * dp * dc * y_j
                    + p * (ddc * y_j * y_j + dc * y_jj)
                    + a * (a + 1.0) * third / (j * j),
            ],
        }
    }

    /// `C_a(y)`.
    fn cosh_multiple(&self, &State { y, eta, .. }: &State) -> f64 {
        if y < self.series_limit {
            return self.series.iter().rev().fold(0.0, |f, c| f * y + c);
        }
        (self.a * eta).cosh()
    }

    /// `C_a(y)` with its first and second derivative.
    fn cosh_multiple_derivatives(&self, &State { y, eta, .. }: &State) -> [f64; 3] {
        let a = self.a;
        if y < self.series_limit {
            // Horner's scheme for the value and both derivatives.
            return self
                .series
                .iter()
                .rev()
                .fold([0.0; 3], |[f, df, ddf], c| [f * y + c, df * y + f, ddf * y + 2.0 * df]);
        }
        let sinh = eta.sinh();
        let first = a * (a * eta).sinh() / sinh;
        let value = (a * eta).cosh();
        [value, first, (a * a * value - (1.0 + y) * first) / (sinh * sinh)]
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;
    use num_dual::{DualNum, second_derivative};

    use super::*;
    use crate::model::material::Material;
    use crate::model::material::test_laws::{Example, check_nominal_stresses, power_sum};

    impl Example for Ogden {
        fn examples() -> Vec<Self> {
            vec![Self::ninjaflex_c2s(), Self::ninjaflex_yap2016()]
        }

        fn energy_of_stretches<D: DualNum<Primitive = f64> + Copy>(&self, l: [D; 3]) -> D {
            let of_term =
                |OgdenTerm { mu, alpha }| power_sum(l, alpha) * (2.0 * mu / (alpha * alpha));
            self.terms().map(of_term).fold(D::from(0.0), |sum, energy| sum + energy)
        }
    }

    #[test]
    fn nominal_stresses_are_those_of_the_books() {
        for law in [Ogden::ninjaflex_c2s(), Ogden::ninjaflex_yap2016()] {
            let terms: Vec<OgdenTerm> = law.terms().collect();
            let sum = |l: f64, third: f64| {
                let of_term = |t: &OgdenTerm| {
                    2.0 * t.mu / t.alpha * (l.powf(t.alpha - 1.0) - l.powf(third * t.alpha - 1.0))
                };
                terms.iter().map(of_term).sum::<f64>()
            };
            check_nominal_stresses(
                &Material::Ogden(law),
                |l| sum(l, -0.5),
                |l| sum(l, -2.0),
                |l| sum(l, -1.0),
            );
        }
    }

    /// On both sides of where the series ends, of exponents for which 14 terms reach less far; rounding of a stretch grows by
    /// the exponent, of its square by another.
    #[test]
    fn steep_powers_keep_their_figures() {
        for (alpha, stretches) in [25.0, -60.0, 100.0].into_iter().flat_map(|alpha| {
            [[1.0, 1.05], [1.0, 1.2], [0.7, 1.0], [1.0, 1.45], [1.2, 0.7]].map(|l| (alpha, l))
        }) {
            let law = Ogden::new(&[OgdenTerm { mu: 1.0, alpha }]);
            let [l1, l2] = stretches;
            let along =
                |l: num_dual::Dual2_64| law.energy_of_stretches([l, l2.into(), (l * l2).recip()]);
            let (energy, stress, stiffness) = second_derivative(along, l1);
            let (square, j) = (l2 * l2, (l1 * l2).powi(2));
            let found = law.density(l1 * l1 + square, j);
            let ([t, j], [tt, tj, jj]) = (found.first, found.second);
            let slope = t + j * square;
            let bend =
                4.0 * l1 * l1 * (tt + 2.0 * tj * square + jj * square * square) + 2.0 * slope;
            // A derivative of a power is so many times the power.
            let scale = 1e-12 * energy;
            assert_relative_eq!(found.value, energy, epsilon = scale);
            assert_relative_eq!(2.0 * l1 * slope, stress, epsilon = 10.0 * alpha.abs() * scale);
            assert_relative_eq!(bend, stiffness, epsilon = 10.0 * alpha * alpha * scale);
        }
    }
}
