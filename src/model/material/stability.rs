//! Drucker's stability: in which stretches a law does work against every further strain.
//!
//! ```text
//! d tau : d ln(l) > 0    <=>    d2 psi / d ln(l_a) d ln(l_b) is positive definite,  a, b in {1, 2}
//! ```
//!
//! Source: Drucker (1959); the modes are those that Abaqus checks.

use super::incompressible_law::IncompressibleLaw;
use super::material::Material;
use super::of_invariants::OfInvariants;

/// A homogeneous deformation of a sheet, led by one stretch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Loading {
    /// Pulled in one direction, free in the other.
    Uniaxial,
    /// Pulled alike in both directions.
    Equibiaxial,
    /// Pulled in one direction, held in the other.
    Planar,
}

/// The stretches within which stability is looked for.
const LIMITS: [f64; 2] = [0.3, 4.0];
/// Steps from rest to either limit; a stable gap of less than 0.7 % in stretch may be passed over.
const STEPS: usize = 200;
/// Bisections of a step to rounding.
const BISECTIONS: usize = 50;

impl Material {
    /// The stretches `[least, greatest]` within 0.3 to 4 between which the law is stable in this loading.
    ///
    /// A compressible law is judged by its incompressible part. Both are 1 where the law is unstable at rest.
    #[must_use]
    pub fn stable_stretches(&self, loading: Loading) -> [f64; 2] {
        LIMITS.map(|limit| {
            let stretch = |step: f64| limit.powf(step / STEPS as f64);
            let is_stable = |step: f64| self.is_stable(loading, stretch(step));
            let Some(unstable) = (0..=STEPS).find(|&step| !is_stable(step as f64)) else {
                return limit;
            };
            let (mut stable, mut unstable) = (unstable.saturating_sub(1) as f64, unstable as f64);
            for _ in 0..BISECTIONS {
                let middle = 0.5 * (stable + unstable);
                *(if is_stable(middle) { &mut stable } else { &mut unstable }) = middle;
            }
            stretch(stable)
        })
    }

    fn is_stable(&self, loading: Loading, l1: f64) -> bool {
        let l2 = match (loading, self) {
            (Loading::Planar, _) => 1.0,
            (Loading::Equibiaxial, _) => l1,
            (Loading::Uniaxial, Self::StVenantKirchhoff(law)) => {
                (1.0 - law.poisson_ratio * (l1 * l1 - 1.0)).sqrt()
            }
            (Loading::Uniaxial, _) => 1.0 / l1.sqrt(),
        };
        let squares = [l1 * l1, l2 * l2];
        let (t, j) = (squares[0] + squares[1], squares[0] * squares[1]);
        let density = match self {
            Self::Compressible(law) => law.law.density(t, j),
            _ => self.density(t, j),
        };
        let [[h11, h12], [_, h22]] = hessian_by_log_stretches(&density, squares);
        h11 > 0.0 && h11 * h22 > h12 * h12
    }
}

/// `T` grows by `2 l_a^2` and `J` by `2 J` with `ln l_a`.
fn hessian_by_log_stretches(psi: &OfInvariants, squares: [f64; 2]) -> [[f64; 2]; 2] {
    let j = squares[0] * squares[1];
    let [psi_t, psi_j] = psi.first;
    let [tt, tj, jj] = psi.second;
    let entry = |a: usize, b: usize| {
        let own = if a == b { psi_t * squares[a] } else { 0.0 };
        let second = tt * squares[a] * squares[b] + tj * j * (squares[a] + squares[b]) + jj * j * j;
        4.0 * (second + own + psi_j * j)
    };
    [[entry(0, 0), entry(0, 1)], [entry(1, 0), entry(1, 1)]]
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::model::material::{
        Compressible, MooneyRivlin, Ogden, OgdenTerm, Rubber, StVenantKirchhoff,
    };

    const LOADINGS: [Loading; 3] = [Loading::Uniaxial, Loading::Equibiaxial, Loading::Planar];

    /// Its tangent is `l^2 (2 l^2 - 1)` uniaxially; `(1 - nu) l^2 + (1 + nu) (l^2 - 1)` against a change of shape
    /// when compressed equibiaxially. Uniaxially, a width is left while `nu (l^2 - 1) < 1`.
    #[test]
    fn st_venant_kirchhoff_gives_way_under_compression() {
        let (young_modulus, poisson_ratio) = (2.0, 0.3);
        let law = Material::StVenantKirchhoff(StVenantKirchhoff { young_modulus, poisson_ratio });
        let [least, greatest] = law.stable_stretches(Loading::Uniaxial);
        assert_relative_eq!(least, 0.5_f64.sqrt(), max_relative = 1e-12);
        assert_relative_eq!(greatest, (1.0 + 1.0 / 0.3_f64).sqrt(), max_relative = 1e-12);
        let [least, greatest] = law.stable_stretches(Loading::Equibiaxial);
        assert_relative_eq!(least, 0.65_f64.sqrt(), max_relative = 1e-12);
        assert_eq!(greatest, LIMITS[1]);
    }

    /// `2 l^2 - l^4`, the Hessian's part of one direction, vanishes at `sqrt 2`.
    #[test]
    fn a_negative_term_can_make_ogden_unstable() {
        let terms = [OgdenTerm { mu: 2.0, alpha: 2.0 }, OgdenTerm { mu: -1.0, alpha: 4.0 }];
        let law = Ogden::new(&terms);
        let [least, greatest] = Material::Ogden(law.clone()).stable_stretches(Loading::Equibiaxial);
        assert_relative_eq!(greatest, 2.0_f64.sqrt(), max_relative = 1e-12);
        assert!(LIMITS[0] < least && least < 1.0);
        let law = Compressible { law: Rubber::Ogden(law), bulk_modulus: 50.0 };
        let stable = Material::Compressible(law).stable_stretches(Loading::Equibiaxial);
        assert_eq!(stable, [least, greatest]);
    }

    #[test]
    fn both_measured_laws_are_stable() {
        for law in [Ogden::ninjaflex_c2s(), Ogden::ninjaflex_yap2016()] {
            for loading in LOADINGS {
                assert_eq!(Material::Ogden(law.clone()).stable_stretches(loading), LIMITS);
            }
        }
    }

    #[test]
    fn a_law_unstable_at_rest_has_no_range() {
        let law = Material::MooneyRivlin(MooneyRivlin { c1: 0.1, c2: -0.2 });
        for loading in LOADINGS {
            assert_eq!(law.stable_stretches(loading), [1.0, 1.0]);
        }
    }
}
