//! The Mooney-Rivlin law.
//!
//! ```text
//! psi = c1 (I1 - 3) + c2 (I2 - 3),    I1 = T + 1/J,    I2 = T/J + J
//! ```
//!
//! Source: Mooney (1940), Rivlin (1948).

use super::OfInvariants;
use super::neo_hookean::first_invariant;
use super::rubber::IncompressibleLaw;

/// Incompressible Mooney-Rivlin rubber; its shear modulus at rest is `2 (c1 + c2)`.
#[derive(Clone, Debug, PartialEq)]
pub struct MooneyRivlin {
    /// Coefficient of the first invariant, MPa.
    pub c1: f64,
    /// Coefficient of the second invariant, MPa.
    pub c2: f64,
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
    use super::*;
    use crate::model::material::Material;
    use crate::model::material::test_laws::check_nominal_stresses;

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
