//! The Saint-Venant-Kirchhoff law in plane stress: Hooke's law in Green's strains `e = (C - 1) / 2`.
//!
//! ```text
//! psi = E / (2 (1 - nu^2)) ((1 - nu) tr(e^2) + nu tr(e)^2)
//!     = E / (2 (1 - nu^2)) (tr(e)^2 - 2 (1 - nu) det(e)),    tr e = (T - 2) / 2,    det e = (J - T + 1) / 4
//! ```
//!
//! It is the law of the textbook cases of thin shells (Koiter), for small strains and any rotations; it gives way
//! under compression and is no law for rubber.
//!
//! # Decisions
//! The thickness stretch is 1, although plane stress has `-nu / (1 - nu) tr e` as the strain across the wall: the
//! textbook cases bend a wall of constant thickness, and where strains are small the two agree.
//!
//! Source: Koiter (1966), On the nonlinear theory of thin elastic shells.

use super::keys::{InvalidMaterial, Key, LawKeys, POISSON_RATIO, YOUNG_MODULUS};
use super::of_invariants::OfInvariants;

/// A linear elastic wall at small strains and large rotations.
#[derive(Clone, Debug, PartialEq)]
pub struct StVenantKirchhoff {
    /// Young's modulus, MPa.
    pub young_modulus: f64,
    /// Poisson's ratio, above -1 and at most 0.5.
    pub poisson_ratio: f64,
}

/// Its name in files, its keys there, and what it wants, in words.
pub(super) const NAME: &str = "st-venant-kirchhoff";
pub(super) const KEYS: &[Key] = &[YOUNG_MODULUS, POISSON_RATIO];
pub(super) const WANTS: &str = "`young_modulus` and `poisson_ratio`";

impl StVenantKirchhoff {
    /// The law with the numbers of a file.
    ///
    /// # Errors
    /// [`InvalidMaterial`] when a number is missing or surplus, or can be none of this law.
    pub(super) fn read(keys: &LawKeys<'_>) -> Result<Self, InvalidMaterial> {
        keys.allow(&["young_modulus", "poisson_ratio"])?;
        let young_modulus = keys.positive("young_modulus")?;
        let poisson_ratio = keys.within("poisson_ratio", -0.99, 0.5)?;
        Ok(Self { young_modulus, poisson_ratio })
    }

    #[inline]
    pub(super) fn density(&self, t: f64, j: f64) -> OfInvariants {
        let factor = self.factor();
        let shear = 0.5 * factor * (1.0 - self.poisson_ratio);
        let trace = 0.5 * (t - 2.0);
        OfInvariants {
            value: self.energy(t, j),
            first: [factor * trace + shear, -shear],
            second: [0.5 * factor, 0.0, 0.0],
        }
    }

    #[inline]
    pub(super) fn energy(&self, t: f64, j: f64) -> f64 {
        let trace = 0.5 * (t - 2.0);
        let det = 0.25 * (j - t + 1.0);
        self.factor() * (trace * trace - 2.0 * (1.0 - self.poisson_ratio) * det)
    }

    pub(super) fn shear_modulus(&self) -> f64 {
        0.5 * self.young_modulus / (1.0 + self.poisson_ratio)
    }

    fn factor(&self) -> f64 {
        self.young_modulus / (2.0 * (1.0 - self.poisson_ratio * self.poisson_ratio))
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::model::material::Material;
    use crate::model::material::test_laws::nominal_stress;

    /// Second Piola-Kirchhoff stresses are linear in `(l^2 - 1) / 2`, and a nominal stress is `l` times those.
    #[test]
    fn nominal_stresses_are_those_of_the_books() {
        for (e, nu) in [(2.0, 0.3), (2.0, -0.6), (2.0, 0.0), (2.0, 0.5)] {
            let law = Material::StVenantKirchhoff(StVenantKirchhoff {
                young_modulus: e,
                poisson_ratio: nu,
            });
            for l in [0.8_f64, 0.99, 1.0, 1.05, 1.4] {
                let strain = 0.5 * (l * l - 1.0);
                let narrow = (1.0 - 2.0 * nu * strain).sqrt();
                for ([l1, l2], exact) in [
                    ([l, narrow], [e * l * strain, 0.0]),
                    ([l, l], [e / (1.0 - nu) * l * strain; 2]),
                    (
                        [l, 1.0],
                        [e / (1.0 - nu * nu) * l * strain, nu * e / (1.0 - nu * nu) * strain],
                    ),
                ] {
                    let stress = nominal_stress(&law, [l1, l2]);
                    for (stress, exact) in stress.iter().zip(exact) {
                        assert_relative_eq!(*stress, exact, epsilon = 1e-14, max_relative = 1e-13);
                    }
                }
            }
        }
    }
}
