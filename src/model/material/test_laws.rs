//! What every law must be: equal to its formula in stretches, with true derivatives, and Hookean at rest.

use approx::assert_relative_eq;
use num_dual::{DualNum, first_derivative, second_derivative};

use super::file_laws::LAWS;
use super::incompressible_law::IncompressibleLaw;
use super::{
    Compressible, KeyValue, Material, NeoHookean, Ogden, OgdenTerm, Rubber, StVenantKirchhoff, keys,
};

/// What the file of a rubber says of it to the shared tests.
pub(super) trait Example: Sized {
    /// Laws with numbers that are easy to tell apart.
    fn examples() -> Vec<Self>;

    /// The energy density in principal stretches whose product is 1, as the books write it, MPa; not a number where the
    /// law ends.
    fn energy_of_stretches<D: DualNum<Primitive = f64> + Copy>(&self, l: [D; 3]) -> D;
}

macro_rules! examples {
    ($($Law:ident),+) => {
        /// The rubbers of the shared tests, as the file of each law has them.
        pub(crate) fn example_rubbers() -> Vec<Rubber> {
            let mut rubbers = Vec::new();
            $(rubbers.extend(super::$Law::examples().into_iter().map(Rubber::$Law));)+
            rubbers
        }

        /// An incompressible law in stretches whose product is 1, as the books write it, MPa.
        pub(super) fn energy_of_shape<D: DualNum<Primitive = f64> + Copy>(law: &Rubber, l: [D; 3]) -> D {
            match law {
                $(Rubber::$Law(law) => law.energy_of_stretches(l),)+
            }
        }
    };
}
for_rubbers!(examples);

/// `l1^alpha + l2^alpha + l3^alpha - 3`.
pub(super) fn power_sum<D: DualNum<Primitive = f64> + Copy>(l: [D; 3], alpha: f64) -> D {
    l[0].powf(alpha) + l[1].powf(alpha) + l[2].powf(alpha) - 3.0
}

/// Checks the nominal stress `d psi / d l1` of an incompressible law, given in closed form for uniaxial, equibiaxial
/// and planar stretch, and that a side free to narrow is free of stress.
pub(super) fn check_nominal_stresses(
    law: &Material,
    uniaxial: impl Fn(f64) -> f64,
    equibiaxial: impl Fn(f64) -> f64,
    planar: impl Fn(f64) -> f64,
) {
    for l in [0.6, 0.95, 1.0, 1.001, 1.3, 2.2, 3.5] {
        let [pulled, free] = nominal_stress(law, [l, 1.0 / f64::sqrt(l)]);
        let [first, second] = nominal_stress(law, [l, l]);
        let [held, _] = nominal_stress(law, [l, 1.0]);
        // Yap's terms cancel to a hundredth: 1e-11 is rounding of the largest.
        for (stress, exact) in [
            (pulled, uniaxial(l)),
            (free, 0.0),
            (first, equibiaxial(l)),
            (second, equibiaxial(l)),
            (held, planar(l)),
        ] {
            assert_relative_eq!(stress, exact, epsilon = 1e-11, max_relative = 1e-11);
        }
    }
}

/// `d psi / d l1` and `d psi / d l2`, MPa.
pub(super) fn nominal_stress(law: &Material, [l1, l2]: [f64; 2]) -> [f64; 2] {
    let (t, j) = invariants([l1, l2]);
    let [psi_t, psi_j] = law.density(t, j).first;
    [2.0 * l1 * (psi_t + psi_j * l2 * l2), 2.0 * l2 * (psi_t + psi_j * l1 * l1)]
}

pub(super) fn compressible(law: &Rubber, bulk_over_shear: f64) -> Compressible {
    let bulk_modulus = bulk_over_shear * law.shear_modulus();
    Compressible { law: law.clone(), bulk_modulus }
}

/// Every kind of law; the compressible ones have Poisson's ratios of -0.29 to 0.495.
fn laws() -> Vec<Material> {
    let plate = StVenantKirchhoff { young_modulus: 2.0, poisson_ratio: 0.3 };
    let mut laws = vec![Material::StVenantKirchhoff(plate)];
    for rubber in example_rubbers() {
        for bulk_over_shear in [0.3, 3.0, 100.0] {
            laws.push(Material::Compressible(compressible(&rubber, bulk_over_shear)));
        }
        laws.push(rubber.into());
    }
    laws
}

/// Files take every key that a law says it wants, and no two keys of a name hold different things.
#[test]
fn laws_want_the_keys_that_they_have() {
    for law in LAWS {
        for key in law.keys {
            let is_wanted = law.wants.contains(&format!("`{}`", key.name))
                || law.wants.contains(&format!("`{} = ", key.name));
            assert!(is_wanted, "{}: `{}` is not among {}", law.name, key.name, law.wants);
            assert!(keys().contains(key), "{}: `{}` holds something else", law.name, key.name);
        }
        assert_eq!(LAWS.iter().filter(|other| other.name == law.name).count(), 1, "{}", law.name);
        let nothing = Material::named(law.name, &[]).unwrap_err().to_string();
        assert!(nothing.contains(law.wants), "{nothing}");
        let surplus = Material::named(law.name, &[("surplus", KeyValue::Number(1.0))]);
        assert!(surplus.unwrap_err().to_string().contains(law.wants), "{}", law.name);
    }
}

#[rustfmt::skip]
const STRETCHES: [[f64; 2]; 8] = [
    [1.0, 1.0], [1.0 + 1e-9, 1.0], [1.05, 1.0], [1.2, 1.2], [1.21, 1.2], [0.7, 1.4], [2.5, 0.9], [3.0, 3.0],
];

pub(super) fn invariants([l1, l2]: [f64; 2]) -> (f64, f64) {
    (l1 * l1 + l2 * l2, (l1 * l2).powi(2))
}

/// A compressible law in stretches, whatever the third.
fn energy_in_space<D: DualNum<Primitive = f64> + Copy>(law: &Compressible, l: [D; 3]) -> D {
    let volume = l[0] * l[1] * l[2];
    let shape = volume.powf(-1.0 / 3.0);
    let excess = volume - 1.0;
    energy_of_shape(&law.law, l.map(|l| l * shape)) + excess * excess * (0.5 * law.bulk_modulus)
}

/// The energy in stretches, at the third stretch that the law itself gives.
fn energy_of_stretches(law: &Material, [l1, l2]: [f64; 2]) -> f64 {
    let (t, j) = invariants([l1, l2]);
    let l = [l1, l2, law.thickness_stretch(t, j).value];
    match (law.clone(), law.rubber()) {
        (Material::Compressible(law), _) => energy_in_space(&law, l),
        (Material::StVenantKirchhoff(StVenantKirchhoff { young_modulus, poisson_ratio }), _) => {
            let [e1, e2] = [l1, l2].map(|l| 0.5 * (l * l - 1.0));
            let factor = 0.5 * young_modulus / (1.0 - poisson_ratio * poisson_ratio);
            factor * (e1 * e1 + e2 * e2 + 2.0 * poisson_ratio * e1 * e2)
        }
        (_, rubber) => energy_of_shape(&rubber.expect("a rubber").0, l),
    }
}

#[test]
fn energy_equals_the_formula_in_stretches() {
    for law in laws() {
        for stretches in STRETCHES {
            let (t, j) = invariants(stretches);
            let exact = energy_of_stretches(&law, stretches);
            // Yap's coefficients of 240 MPa cancel: 2e-12 is eight roundings of each.
            let (epsilon, max_relative) = (2e-12, 1e-12);
            let energies = [law.density(t, j).value, law.energy(t, j)];
            if !exact.is_finite() {
                assert!(energies.iter().all(|energy| !energy.is_finite()), "{law:?} has ended");
                continue;
            }
            for energy in energies {
                assert_relative_eq!(energy, exact, epsilon = epsilon, max_relative = max_relative);
            }
        }
    }
}

/// Central differences of a function and of its first derivatives; the step balances truncation and rounding.
#[test]
fn derivatives_equal_differences() {
    let step = 1e-5;
    for law in laws() {
        let functions = [Material::density, Material::thickness_stretch];
        for (function, stretches) in functions.iter().flat_map(|f| STRETCHES.map(|l| (f, l))) {
            let (t, j) = invariants(stretches);
            // Between equal stretches T^2 = 4 J: a difference in J alone would leave the domain.
            let t = t + 0.01;
            let d = function(&law, t, j);
            let [tp, tm, jp, jm] = [(t + step, j), (t - step, j), (t, j + step), (t, j - step)]
                .map(|(t, j)| function(&law, t, j));
            let slope = |a: f64, b: f64| (a - b) / (2.0 * step);
            let pairs = [
                (d.first[0], slope(tp.value, tm.value)),
                (d.first[1], slope(jp.value, jm.value)),
                (d.second[0], slope(tp.first[0], tm.first[0])),
                (d.second[1], slope(tp.first[1], tm.first[1])),
                (d.second[1], slope(jp.first[0], jm.first[0])),
                (d.second[2], slope(jp.first[1], jm.first[1])),
            ];
            for (analytic, difference) in pairs {
                assert_relative_eq!(analytic, difference, epsilon = 1e-7, max_relative = 1e-6);
            }
        }
    }
}

/// At rest the wall is stress-free and its membrane stiffness is `E / (1 - nu^2)`, `4 mu` where incompressible.
#[test]
fn membrane_at_rest_is_hookean() {
    for law in laws() {
        let d = law.density(2.0, 1.0);
        assert_relative_eq!(d.first[0], -d.first[1], epsilon = 1e-12);
        // Second derivatives of psi(T = l1^2 + l2^2, J = l1^2 l2^2): along l1, and across.
        let [tt, tj, jj] = d.second;
        let second = 4.0 * (tt + 2.0 * tj + jj);
        let (along, across) = (second + 2.0 * (d.first[0] + d.first[1]), second + 4.0 * d.first[1]);
        let (e, nu) = (law.young_modulus(), law.poisson_ratio());
        let stiffness = e / (1.0 - nu * nu);
        assert_relative_eq!(along, stiffness, max_relative = 1e-10);
        assert_relative_eq!(across, nu * stiffness, epsilon = 1e-10 * stiffness);
        if !matches!(law, Material::Compressible(_) | Material::StVenantKirchhoff(_)) {
            assert_relative_eq!(stiffness, 4.0 * law.shear_modulus(), max_relative = 1e-12);
        }
        assert_relative_eq!(law.thickness_stretch(2.0, 1.0).value, 1.0, epsilon = 1e-15);
    }
}

/// At rest a compressible wall thins by `nu / (1 - nu)` of its in-plane strains.
#[test]
fn thinning_at_rest_is_hookean() {
    for law in laws().iter().filter(|law| !matches!(law, Material::StVenantKirchhoff(_))) {
        let [by_t, by_j] = law.thickness_stretch(2.0, 1.0).first;
        let nu = law.poisson_ratio();
        assert_relative_eq!(2.0 * (by_t + by_j), -nu / (1.0 - nu), epsilon = 1e-12);
    }
}

/// No force acts across the wall, to the rounding of the third stretch itself, up to stretches of 8 and whether
/// the volume is soft (nu = -0.29) or stiffer than a double can tell from rigid.
#[test]
fn local_solve_leaves_no_normal_stress() {
    let stretches = [0.125, 0.3, 0.7, 1.0, 1.0 + 1e-9, 1.4, 3.0, 8.0];
    for rubber in example_rubbers() {
        for bulk_over_shear in [0.3, 1.0, 4.0, 50.0, 1e3, 1e6, 1e12] {
            let law = compressible(&rubber, bulk_over_shear);
            for (l1, l2) in stretches.iter().flat_map(|&l1| stretches.map(|l2| (l1, l2))) {
                // Beyond its end a law has no force that could vanish.
                if !energy_of_shape(&rubber, [l1, l2, f64::recip(l1 * l2)]).is_finite() {
                    continue;
                }
                let (t, j) = invariants([l1, l2]);
                let l3 = Material::Compressible(law.clone()).thickness_stretch(t, j);
                let along = |l3| {
                    second_derivative(
                        |l3| energy_in_space(&law, [num_dual::Dual2_64::from(l1), l2.into(), l3]),
                        l3,
                    )
                };
                let (_, force, stiffness) = along(l3.value);
                let error = force / stiffness / l3.value;
                assert!(stiffness > 0.0 && error.abs() < 1e-13, "{law:?} {l1} {l2} {l3:?} {error}");
            }
        }
    }
}

/// Newton's steps on the logarithm of the volume would be hundreds; rounding of a stretch grows by the exponent.
#[test]
fn local_solve_of_steep_powers_ends() {
    let rubber = Rubber::Ogden(Ogden::new(&[OgdenTerm { mu: 1.0, alpha: 100.0 }]));
    for (bulk_over_shear, l) in [50.0, 1e6].into_iter().flat_map(|k| [0.125, 8.0].map(|l| (k, l))) {
        let law = compressible(&rubber, bulk_over_shear);
        let (t, j) = invariants([l, l]);
        let l3 = Material::Compressible(law.clone()).thickness_stretch(t, j).value;
        let across = |l3| energy_in_space(&law, [num_dual::Dual2_64::from(l), l.into(), l3]);
        let (_, force, stiffness) = second_derivative(across, l3);
        assert!((force / stiffness / l3).abs() < 1e-11, "{bulk_over_shear} {l} {l3}");
    }
}

/// The condensed energy's slope is the partial slope in space: the third stretch does no work.
#[test]
fn condensed_stress_is_that_in_space() {
    for rubber in example_rubbers() {
        let law = compressible(&rubber, 3.0);
        let material = Material::Compressible(law.clone());
        for [l1, l2] in STRETCHES {
            let (t, j) = invariants([l1, l2]);
            let l3 = material.thickness_stretch(t, j).value;
            let along = |l| energy_in_space(&law, [l, l2.into(), l3.into()]);
            let (_, exact) = first_derivative(along, l1);
            let [stress, _] = nominal_stress(&material, [l1, l2]);
            assert_relative_eq!(stress, exact, epsilon = 1e-11, max_relative = 1e-11);
        }
    }
}

/// What is left of compressibility fades like `1 / kappa`.
#[test]
fn a_stiff_volume_leaves_the_incompressible_law() {
    for rubber in example_rubbers() {
        let limit = Material::from(rubber.clone());
        for [l1, l2] in [[1.05, 1.0], [1.21, 1.2], [0.7, 1.4], [2.5, 0.9]] {
            let (t, j) = invariants([l1, l2]);
            let errors = [1e4, 1e5, 1e6].map(|bulk_over_shear| {
                let law = Material::Compressible(compressible(&rubber, bulk_over_shear));
                let density = (law.density(t, j), limit.density(t, j));
                let l3 = (law.thickness_stretch(t, j), limit.thickness_stretch(t, j));
                [
                    density.0.value - density.1.value,
                    density.0.first[0] - density.1.first[0],
                    density.0.second[2] - density.1.second[2],
                    l3.0.value - l3.1.value,
                    l3.0.second[2] - l3.1.second[2],
                ]
            });
            for k in 0..errors[0].len() {
                for pair in errors.windows(2) {
                    // The next power of 1 / kappa bends the rate by 1e-3; 1e-10 is rounding (Yap's terms cancel).
                    let left = pair[0][k] - 10.0 * pair[1][k];
                    let tolerance = 5e-3 * pair[0][k].abs() + 1e-10;
                    assert!(left.abs() < tolerance, "{rubber:?} {l1} {l2} {k}: {errors:?}");
                }
            }
        }
    }
}

/// A neo-Hookean wall pulled without limit in every direction: `V` from its own equation.
#[test]
fn compressible_neo_hookean_has_its_closed_form() {
    // mu V^(-5/3) (l3^2 - l^2) 2/3 + kappa (V - 1) = 0 with l1 = l2 = l, V = l^2 l3, taken at V = 1.1, l3 = 0.8.
    let (volume, l3, mu) = (1.1_f64, 0.8_f64, 1.3);
    let l = (volume / l3).sqrt();
    let bulk_modulus =
        2.0 / 3.0 * mu * volume.powf(-5.0 / 3.0) * (l * l - l3 * l3) / (volume - 1.0);
    let law = Material::Compressible(Compressible {
        law: Rubber::NeoHookean(NeoHookean { mu }),
        bulk_modulus,
    });
    let (t, j) = invariants([l, l]);
    assert_relative_eq!(law.thickness_stretch(t, j).value, l3, max_relative = 1e-14);
    let in_plane = mu * volume.powf(-2.0 / 3.0) * (l - l3 * l3 / l);
    assert_relative_eq!(nominal_stress(&law, [l, l])[0], in_plane, max_relative = 1e-13);
}

/// Terms of both signs may pull a wall thin without end; that is no number, and the search for it ends.
#[test]
fn a_law_without_a_thickness_answers_nan() {
    let term = OgdenTerm { mu: -1.0, alpha: 20.0 };
    let law = Rubber::Ogden(Ogden::new(&[term, OgdenTerm { mu: 3.0, alpha: 2.0 }]));
    let law = Material::Compressible(compressible(&law, 1.0));
    let (t, j) = invariants([3.0, 3.0]);
    assert!(law.density(t, j).value.is_nan() && law.energy(t, j).is_nan());
    assert!(law.thickness_stretch(t, j).value.is_nan());
    assert!(law.energy(2.0, 1.0).abs() < 1e-15);
}
