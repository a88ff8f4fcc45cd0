//! The Mooney-Rivlin law.
//!
//! ```text
//! psi = c1 (I1 - 3) + c2 (I2 - 3),    I1 = T + 1/J,    I2 = T/J + J
//! ```
//!
//! Source: Mooney (1940), Rivlin (1948).

use nalgebra::Matrix3;

use super::fit_form::{FitForm, FittedLaw};
use super::incompressible_law::IncompressibleLaw;
use super::keys::{InvalidMaterial, Key, KeyValue, LawKeys, positive};
use super::named_law::NamedLaw;
use super::of_invariants::{OfInvariants, first_invariant};
use super::solid::{SolidResponse, of_invariants};

/// Incompressible Mooney-Rivlin rubber; its shear modulus at rest is `2 (c1 + c2)`.
#[derive(Clone, Debug, PartialEq)]
pub struct MooneyRivlin {
    /// Coefficient of the first invariant, MPa.
    pub c1: f64,
    /// Coefficient of the second invariant, MPa.
    pub c2: f64,
}

impl NamedLaw for MooneyRivlin {
    const NAME: &'static str = "mooney-rivlin";
    const KEYS: &'static [Key] = &[
        Key::number("c1", "factor of the first invariant, MPa"),
        Key::number("c2", "factor of the second invariant, MPa"),
    ];
    const WANTS: &'static str = "`c1` and `c2`, with `bulk_modulus` if it is compressible";

    fn read(keys: &LawKeys<'_>) -> Result<Self, InvalidMaterial> {
        let law = Self { c1: keys.coefficient("c1")?, c2: keys.coefficient("c2")? };
        positive("the shear modulus 2 (c1 + c2) of [material]", law.shear_modulus())?;
        Ok(law)
    }
}

impl FittedLaw for MooneyRivlin {
    const FORMS: &'static [FitForm] = &[FitForm {
        name: Self::NAME,
        starts: &[&[0.4, 0.1]],
        is_always_stable: false,
        is_of_first_invariant: false,
        rubber: |x, modulus| Some(Self { c1: modulus * x[0], c2: modulus * x[1] }.into()),
    }];

    fn values(&self) -> Vec<(&'static str, KeyValue)> {
        vec![("c1", KeyValue::Number(self.c1)), ("c2", KeyValue::Number(self.c2))]
    }
}

impl IncompressibleLaw for MooneyRivlin {
    fn density(&self, t: f64, j: f64) -> OfInvariants {
        let Self { c1, c2 } = *self;
        let sum = first_invariant(t, j, [c1, c1]) + second_invariant(t, j, [c2, c2]);
        OfInvariants { value: self.energy(t, j), ..sum }
    }

    fn energy(&self, t: f64, j: f64) -> f64 {
        self.c1 * (t + 1.0 / j - 3.0) + self.c2 * (t / j + j - 3.0)
    }

    fn dilation_rate(&self, t: f64, j: f64) -> OfInvariants {
        let (c1, c2) = (2.0 / 3.0 * self.c1, 2.0 / 3.0 * self.c2);
        first_invariant(t, j, [-c1, 2.0 * c1]) + second_invariant(t, j, [c2, -2.0 * c2])
    }

    fn shear_modulus(&self) -> f64 {
        2.0 * (self.c1 + self.c2)
    }

    fn solid_energy(&self, f: &Matrix3<f64>) -> f64 {
        of_invariants::energy(f, |x| self.c1 * x, self.c2)
    }

    fn solid_response(&self, f: &Matrix3<f64>, with_moduli: bool) -> SolidResponse {
        let Self { c1, c2 } = *self;
        of_invariants::response(f, with_moduli, |x| [c1 * x, c1, 0.0], c2)
    }
}

/// The two parts of `I2`, each with its own factor: `a T / J + b J`.
fn second_invariant(t: f64, j: f64, [a, b]: [f64; 2]) -> OfInvariants {
    let (by_t, mixed) = (a / j, a * t / j);
    OfInvariants {
        value: mixed + b * j,
        first: [by_t, b - mixed / j],
        second: [0.0, -by_t / j, 2.0 * mixed / (j * j)],
    }
}

#[cfg(test)]
mod tests {
    use num_dual::DualNum;

    use super::*;
    use crate::model::material::Material;
    use crate::model::material::test_laws::{Example, check_nominal_stresses, power_sum};

    impl Example for MooneyRivlin {
        fn examples() -> Vec<Self> {
            vec![Self { c1: 0.4, c2: 0.15 }]
        }

        fn energy_of_stretches<D: DualNum<Primitive = f64> + Copy>(&self, l: [D; 3]) -> D {
            power_sum(l, 2.0) * self.c1 + power_sum(l, -2.0) * self.c2
        }
    }

    #[test]
    fn nominal_stresses_are_those_of_the_books() {
        let (c1, c2) = (0.4, 0.15);
        check_nominal_stresses(
            &Material::MooneyRivlin(MooneyRivlin { c1, c2 }),
            |l| 2.0 * (c1 + c2 / l) * (l - l.powi(-2)),
            |l| 2.0 * (c1 + c2 * l * l) * (l - l.powi(-5)),
            |l| 2.0 * (c1 + c2) * (l - l.powi(-3)),
        );
    }
}
