//! Incompressible laws in the form in which inflated bodies have closed solutions.
//!
//! ```text
//! W = sum_k 2 mu_k / alpha_k^2 (l1^alpha_k + l2^alpha_k + l3^alpha_k - 3),    l3 = 1 / (l1 l2)
//! ```
//!
//! The neo-Hookean law is the term of exponent 2; Mooney and Rivlin's adds one of -2.

use pneumorph::model::material::{Material, MooneyRivlin, NeoHookean, Ogden, OgdenTerm};

/// A law, and the terms that it consists of.
pub(crate) struct Rubber {
    pub(crate) name: &'static str,
    pub(crate) material: Material,
    /// `mu` (MPa) and `alpha`.
    terms: Vec<[f64; 2]>,
}

impl Rubber {
    pub(crate) fn neo_hookean() -> Self {
        Self {
            name: "neo-Hookean",
            material: Material::NeoHookean(NeoHookean { mu: 1.0 }),
            terms: vec![[1.0, 2.0]],
        }
    }

    /// `c2 / c1 = 0.1`.
    pub(crate) fn mooney_rivlin() -> Self {
        let c1 = 0.5 / 1.1;
        let c2 = 0.1 * c1;
        Self {
            name: "Mooney-Rivlin",
            material: Material::MooneyRivlin(MooneyRivlin { c1, c2 }),
            terms: vec![[2.0 * c1, 2.0], [2.0 * c2, -2.0]],
        }
    }

    /// Vulcanised rubber: Ogden (1972), who writes `mu / alpha` where this law has `2 mu / alpha^2`.
    pub(crate) fn ogden() -> Self {
        let terms = [[0.63, 1.3], [0.0012, 5.0], [-0.01, -2.0]];
        let terms = terms.map(|[mu, alpha]| [0.5 * mu * alpha, alpha]);
        Self {
            name: "Ogden",
            material: Material::Ogden(Ogden::new(
                &terms.map(|[mu, alpha]| OgdenTerm { mu, alpha }),
            )),
            terms: terms.to_vec(),
        }
    }

    pub(crate) fn all() -> [Self; 3] {
        [Self::neo_hookean(), Self::mooney_rivlin(), Self::ogden()]
    }

    /// `dW/dl` at stretches `l, l, 1/l^2`, MPa.
    pub(crate) fn equibiaxial_rate(&self, l: f64) -> f64 {
        self.rate(|alpha| 2.0 * (l.powf(alpha - 1.0) - l.powf(-2.0 * alpha - 1.0)))
    }

    /// `dW/dl` at stretches `l, 1, 1/l`, MPa.
    pub(crate) fn plane_strain_rate(&self, l: f64) -> f64 {
        self.rate(|alpha| l.powf(alpha - 1.0) - l.powf(-alpha - 1.0))
    }

    fn rate(&self, of_power: impl Fn(f64) -> f64) -> f64 {
        self.terms.iter().map(|&[mu, alpha]| 2.0 * mu / alpha * of_power(alpha)).sum()
    }
}
