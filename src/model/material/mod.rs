//! Constitutive laws of an incompressible wall in plane stress.
//!
//! The two in-plane principal stretches `l1, l2` enter through two smooth invariants of the in-plane metrics
//! `G` (reference) and `g` (current); the third stretch is `1 / (l1 l2)` and the normal stress vanishes.
//!
//! ```text
//! T = tr(G^-1 g) = l1^2 + l2^2          J = det g / det G = (l1 l2)^2 = 1 / l3^2
//! ```

mod neo_hookean;
mod ogden;

pub use neo_hookean::NeoHookean;
pub use ogden::{Ogden, OgdenTerm};

/// The stored energy per reference volume (MPa) and its derivatives with respect to `T` and `J`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EnergyDensity {
    /// The density itself, MPa.
    pub value: f64,
    /// d/dT, d/dJ.
    pub first: [f64; 2],
    /// d2/dT2, d2/dTdJ, d2/dJ2.
    pub second: [f64; 3],
}

/// A hyperelastic law.
#[derive(Clone, Debug, PartialEq)]
pub enum Material {
    /// [`NeoHookean`].
    NeoHookean(NeoHookean),
    /// [`Ogden`].
    Ogden(Ogden),
}

impl Material {
    /// The energy density with derivatives at invariants `T` and `J`.
    #[must_use]
    #[inline]
    pub fn density(&self, t: f64, j: f64) -> EnergyDensity {
        match self {
            Self::NeoHookean(law) => law.density(t, j),
            Self::Ogden(law) => law.density(t, j),
        }
    }

    /// The energy density alone, MPa.
    #[must_use]
    #[inline]
    pub fn energy(&self, t: f64, j: f64) -> f64 {
        match self {
            Self::NeoHookean(law) => law.energy(t, j),
            Self::Ogden(law) => law.energy(t, j),
        }
    }

    /// The stretch of the wall's thickness, with derivatives, where the mid-surface has invariants `T` and `J`.
    #[must_use]
    #[inline]
    pub fn thickness_stretch(&self, _t: f64, j: f64) -> EnergyDensity {
        let value = 1.0 / j.sqrt();
        let slope = -0.5 * value / j;
        EnergyDensity { value, first: [0.0, slope], second: [0.0, 0.0, -1.5 * slope / j] }
    }

    /// The shear modulus at rest, MPa.
    #[must_use]
    pub fn shear_modulus(&self) -> f64 {
        match self {
            Self::NeoHookean(law) => law.mu,
            Self::Ogden(law) => law.terms().map(|term| term.mu).sum(),
        }
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    fn laws() -> [Material; 3] {
        [
            Material::NeoHookean(NeoHookean { mu: 1.3 }),
            Material::Ogden(Ogden::ninjaflex_c2s()),
            Material::Ogden(Ogden::ninjaflex_yap2016()),
        ]
    }

    /// `psi` written in stretches, as the books do.
    fn energy_of_stretches(law: &Material, [l1, l2]: [f64; 2]) -> f64 {
        let l3 = 1.0 / (l1 * l2);
        match law {
            Material::NeoHookean(law) => 0.5 * law.mu * (l1 * l1 + l2 * l2 + l3 * l3 - 3.0),
            Material::Ogden(law) => {
                let term = |t: OgdenTerm| {
                    let sum: f64 = [l1, l2, l3].iter().map(|l| l.powf(t.alpha)).sum();
                    2.0 * t.mu / (t.alpha * t.alpha) * (sum - 3.0)
                };
                law.terms().map(term).sum()
            }
        }
    }

    #[rustfmt::skip]
    const STRETCHES: [[f64; 2]; 8] = [
        [1.0, 1.0], [1.0 + 1e-9, 1.0], [1.05, 1.0], [1.2, 1.2], [1.21, 1.2], [0.7, 1.4], [2.5, 0.9], [3.0, 3.0],
    ];

    #[test]
    fn energy_equals_the_formula_in_stretches() {
        for law in laws() {
            for [l1, l2] in STRETCHES {
                let (t, j) = (l1 * l1 + l2 * l2, (l1 * l2).powi(2));
                let exact = energy_of_stretches(&law, [l1, l2]);
                // Yap's coefficients of 240 MPa cancel: 1e-12 is four roundings of each.
                assert_relative_eq!(
                    law.density(t, j).value,
                    exact,
                    epsilon = 1e-12,
                    max_relative = 1e-12
                );
                assert_relative_eq!(law.energy(t, j), exact, epsilon = 1e-12, max_relative = 1e-12);
            }
        }
    }

    /// Central differences of the energy and of the first derivatives; the step balances truncation and rounding.
    #[test]
    fn derivatives_equal_differences() {
        let step = 1e-5;
        for law in laws() {
            for [l1, l2] in STRETCHES {
                // Between equal stretches T^2 = 4 J: a difference in J alone would leave the domain.
                let (t, j) = (l1 * l1 + l2 * l2 + 0.01, (l1 * l2).powi(2));
                let d = law.density(t, j);
                let [tp, tm, jp, jm] = [(t + step, j), (t - step, j), (t, j + step), (t, j - step)]
                    .map(|(t, j)| law.density(t, j));
                let slope = |a: f64, b: f64| (a - b) / (2.0 * step);
                let pairs = [
                    (d.first[0], slope(tp.value, tm.value)),
                    (d.first[1], slope(jp.value, jm.value)),
                    (d.second[0], slope(tp.first[0], tm.first[0])),
                    (d.second[1], slope(tp.first[1], tm.first[1])),
                    (d.second[2], slope(jp.first[1], jm.first[1])),
                ];
                for (analytic, difference) in pairs {
                    assert_relative_eq!(analytic, difference, epsilon = 1e-7, max_relative = 1e-6);
                }
            }
        }
    }

    /// At rest the wall is stress-free and its membrane stiffness is `E / (1 - nu^2) = 4 mu`.
    #[test]
    fn membrane_stiffness_at_rest_is_four_mu() {
        for law in laws() {
            let d = law.density(2.0, 1.0);
            assert_relative_eq!(d.first[0], -d.first[1], epsilon = 1e-12);
            // Second derivative along l1 of psi(T = l1^2 + 1, J = l1^2).
            let [tt, tj, jj] = d.second;
            let stiffness = 2.0 * (d.first[0] + d.first[1]) + 4.0 * (tt + 2.0 * tj + jj);
            assert_relative_eq!(stiffness, 4.0 * law.shear_modulus(), max_relative = 1e-10);
        }
    }
}
