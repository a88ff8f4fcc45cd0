//! The Yeoh law.
//!
//! ```text
//! psi = c_1 (I1 - 3) + c_2 (I1 - 3)^2 + c_3 (I1 - 3)^3,    I1 = T + 1/J
//! ```
//!
//! Source: Yeoh (1993).

use super::OfInvariants;
use super::neo_hookean::first_invariant;
use super::rubber::IncompressibleLaw;

/// Incompressible Yeoh rubber; its shear modulus at rest is twice the first coefficient.
#[derive(Clone, Debug, PartialEq)]
pub struct Yeoh {
    /// Coefficients of the powers 1, 2 and 3 of `I1 - 3`, MPa.
    pub c: [f64; 3],
}

impl Yeoh {
    /// `psi` and its first three derivatives by `I1`, at `x = I1 - 3`.
    fn polynomial(&self, x: f64) -> [f64; 4] {
        let [c1, c2, c3] = self.c;
        [
            x * (c1 + x * (c2 + x * c3)),
            c1 + x * (2.0 * c2 + x * 3.0 * c3),
            2.0 * c2 + x * 6.0 * c3,
            6.0 * c3,
        ]
    }
}

impl IncompressibleLaw for Yeoh {
    fn density(&self, t: f64, j: f64) -> OfInvariants {
        let [psi, d, dd, _] = self.polynomial(t + 1.0 / j - 3.0);
        first_invariant(t, j, [1.0, 1.0]).chain([psi, d, dd])
    }

    fn energy(&self, t: f64, j: f64) -> f64 {
        self.polynomial(t + 1.0 / j - 3.0)[0]
    }

    fn dilation_rate(&self, t: f64, j: f64) -> OfInvariants {
        let [_, d, dd, ddd] = self.polynomial(t + 1.0 / j - 3.0);
        let slope = first_invariant(t, j, [1.0, 1.0]).chain([d, dd, ddd]);
        slope * first_invariant(t, j, [-2.0 / 3.0, 4.0 / 3.0])
    }

    fn shear_modulus(&self) -> f64 {
        2.0 * self.c[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::material::Material;
    use crate::model::material::test_laws::check_nominal_stresses;

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
