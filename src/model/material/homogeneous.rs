//! Homogeneous tests of incompressible rubber: how the specimen is stretched, and the force that it takes.
//!
//! ```text
//! uniaxial      l, 1/sqrt l, 1/sqrt l        planar (pure shear)   l, 1, 1/l        equibiaxial   l, l, 1/l^2
//! nominal stress  P = d psi / d l1 = 2 (psi_T l1 + psi_J J / l1),   no stress across the sheet
//! ```
//!
//! Source: Treloar (1975), The Physics of Rubber Elasticity, chapter 5.

use super::incompressible_law::IncompressibleLaw;
use super::rubber::Rubber;

/// A homogeneous deformation of a sheet, led by one stretch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Loading {
    /// Pulled in one direction, free in the other.
    Uniaxial,
    /// Pulled alike in both directions.
    Equibiaxial,
    /// Pulled in one direction, held in the other.
    Planar,
}

impl Loading {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Uniaxial, Self::Equibiaxial, Self::Planar];

    /// Its name in tables of tests.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Uniaxial => "uniaxial",
            Self::Equibiaxial => "equibiaxial",
            Self::Planar => "planar",
        }
    }

    /// The squares of both stretches in the plane of an incompressible sheet whose first one is `l1`.
    pub(super) fn squares(self, l1: f64) -> [f64; 2] {
        let l2 = match self {
            Self::Uniaxial => 1.0 / l1.sqrt(),
            Self::Equibiaxial => l1,
            Self::Planar => 1.0,
        };
        [l1 * l1, l2 * l2]
    }
}

impl Rubber {
    /// The nominal stress at the stretch `l1`, MPa: force by the area at rest.
    #[must_use]
    pub fn nominal_stress(&self, loading: Loading, l1: f64) -> f64 {
        let [a, b] = loading.squares(l1);
        let (t, j) = (a + b, a * b);
        let [psi_t, psi_j] = self.density(t, j).first;
        2.0 * (psi_t * l1 + psi_j * j / l1)
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::model::material::{MooneyRivlin, Ogden, OgdenTerm, Yeoh};

    /// The formulas of textbooks, written out; the two sides round differently by some 1e-15 of terms that cancel little.
    #[test]
    fn nominal_stresses_are_those_of_the_books() {
        let mooney = Rubber::from(MooneyRivlin { c1: 0.4, c2: 0.15 });
        let yeoh = Rubber::from(Yeoh { c: [0.6, -0.05, 0.01] });
        let ogden = Rubber::from(Ogden::new(&[OgdenTerm { mu: 2.0, alpha: 3.0 }]));
        for l in [0.6_f64, 0.9, 1.2, 2.0, 3.5] {
            let near = |found: f64, exact: f64| {
                assert_relative_eq!(found, exact, max_relative = 1e-12, epsilon = 1e-13);
            };
            let uniaxial = |law: &Rubber| law.nominal_stress(Loading::Uniaxial, l);
            let planar = |law: &Rubber| law.nominal_stress(Loading::Planar, l);
            let equibiaxial = |law: &Rubber| law.nominal_stress(Loading::Equibiaxial, l);
            near(uniaxial(&mooney), 2.0 * (0.4 + 0.15 / l) * (l - l.powi(-2)));
            near(planar(&mooney), 2.0 * 0.55 * (l - l.powi(-3)));
            near(equibiaxial(&mooney), 2.0 * (0.4 + 0.15 * l * l) * (l - l.powi(-5)));
            let slope = |x: f64| 0.6 - 0.1 * x + 0.03 * x * x;
            near(uniaxial(&yeoh), 2.0 * slope(l * l + 2.0 / l - 3.0) * (l - l.powi(-2)));
            near(uniaxial(&ogden), 4.0 / 3.0 * (l.powi(2) - l.powf(-2.5)));
            near(planar(&ogden), 4.0 / 3.0 * (l.powi(2) - l.powi(-4)));
            near(equibiaxial(&ogden), 4.0 / 3.0 * (l.powi(2) - l.powi(-7)));
        }
    }
}
