//! The Yeoh law.
//!
//! ```text
//! psi = c_1 (I1 - 3) + c_2 (I1 - 3)^2 + c_3 (I1 - 3)^3,    I1 = T + 1/J
//! ```
//!
//! Source: Yeoh (1993).

use super::fit_form::{FitForm, FittedLaw};
use super::incompressible_law::FirstInvariantLaw;
use super::keys::{InvalidMaterial, Key, KeyKind, KeyValue, LawKeys, coefficient, positive};
use super::named_law::NamedLaw;

/// Incompressible Yeoh rubber; its shear modulus at rest is twice the first coefficient.
#[derive(Clone, Debug, PartialEq)]
pub struct Yeoh {
    /// Coefficients of the powers 1, 2 and 3 of `I1 - 3`, MPa.
    pub c: [f64; 3],
}

impl NamedLaw for Yeoh {
    const NAME: &'static str = "yeoh";
    const KEYS: &'static [Key] = &[Key {
        name: "c",
        kind: KeyKind::Triple,
        meaning: "factors of the first invariant less 3, of its square and of its cube, MPa",
    }];
    const WANTS: &'static str = "`c = [c1, c2, c3]`, with `bulk_modulus` if it is compressible";

    fn read(keys: &LawKeys<'_>) -> Result<Self, InvalidMaterial> {
        let c = keys.triple("c")?;
        positive("the first of [material] c", c[0])?;
        coefficient("the second of [material] c", c[1])?;
        coefficient("the third of [material] c", c[2])?;
        Ok(Self { c })
    }
}

impl FittedLaw for Yeoh {
    const FORMS: &'static [FitForm] = &[FitForm {
        name: Self::NAME,
        starts: &[&[0.5, 0.0, 0.0]],
        is_always_stable: false,
        is_of_first_invariant: true,
        rubber: |x, modulus| Some(Self { c: [0, 1, 2].map(|k| modulus * x[k]) }.into()),
    }];

    fn values(&self) -> Vec<(&'static str, KeyValue)> {
        vec![("c", KeyValue::Triple(self.c))]
    }
}

impl FirstInvariantLaw for Yeoh {
    fn of_first(&self, x: f64) -> [f64; 4] {
        let [c1, c2, c3] = self.c;
        [
            x * (c1 + x * (c2 + x * c3)),
            c1 + x * (2.0 * c2 + x * 3.0 * c3),
            2.0 * c2 + x * 6.0 * c3,
            6.0 * c3,
        ]
    }
}

#[cfg(test)]
mod tests {
    use num_dual::DualNum;

    use super::*;
    use crate::model::material::Material;
    use crate::model::material::test_laws::{Example, check_nominal_stresses, power_sum};

    impl Example for Yeoh {
        fn examples() -> Vec<Self> {
            vec![Self { c: [0.6, -0.05, 0.01] }]
        }

        fn energy_of_stretches<D: DualNum<Primitive = f64> + Copy>(&self, l: [D; 3]) -> D {
            let x = power_sum(l, 2.0);
            x * self.c[0] + x.powi(2) * self.c[1] + x.powi(3) * self.c[2]
        }
    }

    #[test]
    fn nominal_stresses_are_those_of_the_books() {
        let c = [0.6, -0.05, 0.01];
        let slope = |x: f64| c[0] + 2.0 * c[1] * x + 3.0 * c[2] * x * x;
        check_nominal_stresses(
            &Material::Yeoh(Yeoh { c }),
            |l| 2.0 * slope(l * l + 2.0 / l - 3.0) * (l - l.powi(-2)),
            |l| 2.0 * slope(2.0 * l * l + l.powi(-4) - 3.0) * (l - l.powi(-5)),
            |l| 2.0 * slope(l * l + 1.0 + l.powi(-2) - 3.0) * (l - l.powi(-3)),
        );
    }
}
