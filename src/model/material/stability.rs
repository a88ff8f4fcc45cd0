//! Drucker's stability: in which stretches a law does work against every further strain.
//!
//! ```text
//! d tau : d ln(l) > 0    <=>    d2 psi / d ln(l_a) d ln(l_b) is positive definite,  a, b in {1, 2}
//! ```
//!
//! Source: Drucker (1959); the modes are those that Abaqus checks.

use super::homogeneous::Loading;
use super::incompressible_law::IncompressibleLaw;
use super::material::Material;
use super::of_invariants::OfInvariants;
use super::rubber::Rubber;

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
        stable_within(LIMITS, |stretch| self.is_stable(loading, stretch))
    }

    fn is_stable(&self, loading: Loading, l1: f64) -> bool {
        let squares = match (loading, self) {
            (Loading::Uniaxial, Self::StVenantKirchhoff(law)) => {
                // Not a number where no width is left.
                let l2 = (1.0 - law.poisson_ratio * (l1 * l1 - 1.0)).sqrt();
                [l1 * l1, l2 * l2]
            }
            _ => loading.squares(l1),
        };
        let (t, j) = (squares[0] + squares[1], squares[0] * squares[1]);
        let density = match self {
            Self::Compressible(law) => law.law.density(t, j),
            _ => self.density(t, j),
        };
        let [[h11, h12], [_, h22]] = hessian_by_log_stretches(&density, squares);
        h11 > 0.0 && h11 * h22 > h12 * h12
    }
}

impl Rubber {
    /// The stiffness against the softest further strain at the stretch `l1`, MPa: the shear modulus of the neo-Hookean law that is as
    /// stiff there against the same strain. It is positive where the law is stable.
    #[must_use]
    pub fn stiffness(&self, loading: Loading, l1: f64) -> f64 {
        let squares @ [a, b] = loading.squares(l1);
        let [[h11, h12], [_, h22]] = hessian_by_log_stretches(&self.density(a + b, a * b), squares);
        // The neo-Hookean Hessian of unit modulus; the smaller root of det(H - mu N) = 0.
        let c = 1.0 / (a * b);
        let [n11, n12, n22] = [2.0 * (a + c), 2.0 * c, 2.0 * (b + c)];
        let (square, constant) = (n11 * n22 - n12 * n12, h11 * h22 - h12 * h12);
        let mean = 0.5 * (h11 * n22 + h22 * n11 - 2.0 * h12 * n12);
        (mean - (mean * mean - square * constant).max(0.0).sqrt()) / square
    }

    /// The stretches `[least, greatest]` within `limits`, which hold 1, between which the law is stable in every [`Loading`].
    #[must_use]
    pub fn stable_stretches(&self, limits: [f64; 2]) -> [f64; 2] {
        let is_stable = |stretch| Loading::ALL.iter().all(|&it| self.stiffness(it, stretch) > 0.0);
        stable_within(limits, is_stable)
    }
}

/// The stretches `[least, greatest]` within `limits` between which `is_stable` holds, looked for from rest.
fn stable_within(limits: [f64; 2], is_stable: impl Fn(f64) -> bool) -> [f64; 2] {
    limits.map(|limit| {
        let stretch = |step: f64| limit.powf(step / STEPS as f64);
        let is_stable = |step: f64| is_stable(stretch(step));
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
        Compressible, MooneyRivlin, NeoHookean, Ogden, OgdenTerm, Rubber, StVenantKirchhoff,
    };

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
            for loading in Loading::ALL {
                assert_eq!(Material::Ogden(law.clone()).stable_stretches(loading), LIMITS);
            }
        }
    }

    #[test]
    fn a_law_unstable_at_rest_has_no_range() {
        let law = Material::MooneyRivlin(MooneyRivlin { c1: 0.1, c2: -0.2 });
        for loading in Loading::ALL {
            assert_eq!(law.stable_stretches(loading), [1.0, 1.0]);
        }
    }

    /// A neo-Hookean law is as stiff as itself. Pulled in one direction, a Mooney-Rivlin law is softest against a shear across it, with
    /// `2 (c1 + c2 l^2)`; pulled alike in two, against more of it: `c1 (l^2 + 2 l^-4) + c2 (l^-2 + 2 l^4)` vanishes.
    #[test]
    fn stiffness_is_a_modulus() {
        let law = Rubber::from(NeoHookean { mu: 0.3 });
        for (loading, l) in Loading::ALL.into_iter().flat_map(|it| [0.5, 1.0, 3.0].map(|l| (it, l)))
        {
            // A double root keeps half of the figures.
            assert_relative_eq!(law.stiffness(loading, l), 0.3, max_relative = 1e-7);
        }
        let (c2, l) = (-0.1, 2.0_f64);
        let c1 = -c2 * (l.powi(-2) + 2.0 * l.powi(4)) / (l * l + 2.0 * l.powi(-4));
        let law = Rubber::from(MooneyRivlin { c1, c2 });
        let stiffness = law.stiffness(Loading::Uniaxial, 1.5);
        assert_relative_eq!(stiffness, 2.0 * (c1 + c2 * 2.25), max_relative = 1e-9);
        assert_relative_eq!(law.stable_stretches([0.9, 9.0])[1], l, max_relative = 1e-9);
    }
}
