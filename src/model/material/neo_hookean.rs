//! The neo-Hookean law.
//!
//! ```text
//! psi = mu/2 (I1 - 3),    I1 = T + 1/J
//! ```

use nalgebra::Matrix3;

use super::fit_form::{FitForm, FittedLaw};
use super::incompressible_law::IncompressibleLaw;
use super::keys::{InvalidMaterial, Key, KeyValue, LawKeys, POISSON_RATIO, YOUNG_MODULUS};
use super::named_law::{NamedLaw, bulk_modulus};
use super::of_invariants::{OfInvariants, first_invariant};
use super::solid::{SolidResponse, of_invariants};

/// Incompressible neo-Hookean rubber. Source: Treloar (1943).
#[derive(Clone, Debug, PartialEq)]
pub struct NeoHookean {
    /// Shear modulus, MPa.
    pub mu: f64,
}

impl NamedLaw for NeoHookean {
    const NAME: &'static str = "neo-hookean";
    const KEYS: &'static [Key] =
        &[Key::number("mu", "shear modulus at rest, MPa"), YOUNG_MODULUS, POISSON_RATIO];
    const WANTS: &'static str =
        "`mu`, with `bulk_modulus` if it is compressible, or `young_modulus` and `poisson_ratio`";

    fn read(keys: &LawKeys<'_>) -> Result<Self, InvalidMaterial> {
        keys.allow(&["mu", "bulk_modulus"])?;
        Ok(Self { mu: keys.positive("mu")? })
    }

    /// By its shear modulus, or by both moduli of Hooke's law at rest.
    fn read_with_bulk_modulus(keys: &LawKeys<'_>) -> Result<(Self, Option<f64>), InvalidMaterial> {
        if keys.has("mu") || !keys.has("young_modulus") {
            let law = Self::read(keys)?;
            let bulk_modulus = bulk_modulus(&law, keys)?;
            return Ok((law, bulk_modulus));
        }
        keys.allow(&["young_modulus", "poisson_ratio"])?;
        let young_modulus = keys.positive("young_modulus")?;
        let poisson_ratio = keys.within("poisson_ratio", 0.0, 0.5)?;
        let law = Self { mu: 0.5 * young_modulus / (1.0 + poisson_ratio) };
        let is_compressible = poisson_ratio != 0.5;
        let bulk_modulus =
            is_compressible.then(|| young_modulus / (3.0 * (1.0 - 2.0 * poisson_ratio)));
        Ok((law, bulk_modulus))
    }
}

impl FittedLaw for NeoHookean {
    const FORMS: &'static [FitForm] = &[FitForm {
        name: Self::NAME,
        starts: &[&[0.0]],
        is_always_stable: true,
        is_of_first_invariant: true,
        rubber: |x, modulus| Some(Self { mu: modulus * x[0].exp() }.into()),
    }];

    fn values(&self) -> Vec<(&'static str, KeyValue)> {
        vec![("mu", KeyValue::Number(self.mu))]
    }
}

impl IncompressibleLaw for NeoHookean {
    #[inline]
    fn density(&self, t: f64, j: f64) -> OfInvariants {
        let half_mu = 0.5 * self.mu;
        OfInvariants { value: self.energy(t, j), ..first_invariant(t, j, [half_mu, half_mu]) }
    }

    #[inline]
    fn energy(&self, t: f64, j: f64) -> f64 {
        0.5 * self.mu * (t + 1.0 / j - 3.0)
    }

    fn dilation_rate(&self, t: f64, j: f64) -> OfInvariants {
        first_invariant(t, j, [-self.mu / 3.0, 2.0 * self.mu / 3.0])
    }

    fn shear_modulus(&self) -> f64 {
        self.mu
    }

    fn solid_energy(&self, f: &Matrix3<f64>) -> f64 {
        of_invariants::energy(f, |x| 0.5 * self.mu * x, 0.0)
    }

    fn solid_response(&self, f: &Matrix3<f64>, with_moduli: bool) -> SolidResponse {
        let half_mu = 0.5 * self.mu;
        of_invariants::response(f, with_moduli, |x| [half_mu * x, half_mu, 0.0], 0.0)
    }
}

#[cfg(test)]
mod tests {
    use num_dual::DualNum;

    use super::*;
    use crate::model::material::Material;
    use crate::model::material::test_laws::{Example, check_nominal_stresses, power_sum};

    impl Example for NeoHookean {
        fn examples() -> Vec<Self> {
            vec![Self { mu: 1.3 }]
        }

        fn energy_of_stretches<D: DualNum<Primitive = f64> + Copy>(&self, l: [D; 3]) -> D {
            power_sum(l, 2.0) * (0.5 * self.mu)
        }
    }

    #[test]
    fn nominal_stresses_are_those_of_the_books() {
        let mu = 1.3;
        check_nominal_stresses(
            &Material::NeoHookean(NeoHookean { mu }),
            |l| mu * (l - l.powi(-2)),
            |l| mu * (l - l.powi(-5)),
            |l| mu * (l - l.powi(-3)),
        );
    }
}
