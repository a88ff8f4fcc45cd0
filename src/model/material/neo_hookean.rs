//! The neo-Hookean law.
//!
//! ```text
//! psi = mu/2 (I1 - 3),    I1 = T + 1/J
//! ```

use super::OfInvariants;
use super::rubber::IncompressibleLaw;

/// Incompressible neo-Hookean rubber. Source: Treloar (1943).
#[derive(Clone, Debug, PartialEq)]
pub struct NeoHookean {
    /// Shear modulus, MPa.
    pub mu: f64,
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
}

/// The two parts of `I1`, each with its own factor: `a T + b / J`.
#[inline]
pub(super) fn first_invariant(t: f64, j: f64, [a, b]: [f64; 2]) -> OfInvariants {
    let third = b / j;
    OfInvariants {
        value: a * t + third,
        first: [a, -third / j],
        second: [0.0, 0.0, 2.0 * third / (j * j)],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::material::Material;
    use crate::model::material::test_laws::check_nominal_stresses;

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
