//! A solid's law against its formula in stretches, its own differences, and the shell's law.

use approx::assert_relative_eq;
use nalgebra::{Matrix3, Rotation3, Vector3};

use super::super::test_laws::{
    compressible, energy_of_shape, example_rubbers, invariants, nominal_stress,
};
use super::super::{Material, MooneyRivlin, Ogden, OgdenTerm, Rubber};
use super::*;

/// Equal, nearly equal and different stretches; with and without a change of volume.
#[rustfmt::skip]
const STRETCHES: [[f64; 3]; 12] = [
    [1.0, 1.0, 1.0], [1.3, 1.3, 1.3], [1.2, 1.2, 0.6], [0.8, 1.7, 0.8],
    [1.2, 1.2 + 1e-12, 0.7], [1.2, 1.2 + 1e-9, 0.7], [1.2, 1.2 + 1e-6, 1.2 - 1e-6], [1.2, 1.201, 0.7], [0.9, 0.89, 0.91],
    [1.5, 1.0, 0.5], [2.5, 0.9, 0.4], [3.0, 2.0, 0.2],
];

fn rotations() -> [Rotation3<f64>; 3] {
    [
        Rotation3::identity(),
        Rotation3::from_scaled_axis(Vector3::new(0.3, -1.1, 0.7)),
        Rotation3::from_scaled_axis(Vector3::new(-2.0, 0.4, 1.3)),
    ]
}

/// Gradients with these principal stretches, in the lattice's directions and in others.
fn gradients([a, b, c]: [f64; 3]) -> Vec<Matrix3<f64>> {
    let diagonal = Matrix3::from_diagonal(&Vector3::new(a, b, c));
    let [none, first, second] = rotations();
    [(none, none), (first, second), (second, first)]
        .map(|(now, rest)| now.matrix() * diagonal * rest.matrix().transpose())
        .to_vec()
}

fn laws() -> Vec<(Rubber, SolidLaw)> {
    example_rubbers()
        .into_iter()
        .map(|rubber| (rubber.clone(), SolidLaw::new(&rubber, None)))
        .collect()
}

/// `sum_kL A_iJkL first_kL`.
fn contraction(moduli: &[[Matrix3<f64>; 3]; 3], first: &Matrix3<f64>) -> Matrix3<f64> {
    let mut sum = Matrix3::zeros();
    for (j, row) in moduli.iter().enumerate() {
        for (l, block) in row.iter().enumerate() {
            let column = sum.column(j) + block * first.column(l);
            sum.set_column(j, &column);
        }
    }
    sum
}

/// What the largest entries are made of: Yap's terms of 240 MPa cancel to a hundredth.
fn size(law: &Rubber) -> f64 {
    if *law == Rubber::Ogden(Ogden::ninjaflex_yap2016()) { 300.0 } else { 3.0 }
}

#[test]
fn energy_equals_the_formula_in_stretches() {
    for (rubber, law) in laws() {
        for stretches in STRETCHES {
            let shape = stretches.iter().product::<f64>().cbrt();
            let exact = energy_of_shape(&rubber, stretches.map(|l| l / shape));
            for f in gradients(stretches) {
                // A stretch of 0.2 beside 3 is known to eps (3 / 0.2)^2; elsewhere some roundings.
                let epsilon = 2e-14 * size(&rubber);
                for energy in [law.energy(&f), law.response(&f, false).energy] {
                    assert_relative_eq!(energy, exact, epsilon = epsilon, max_relative = 2e-13);
                }
            }
        }
    }
}

/// Differences of fourth order, with a step of a thousandth of the shortest stretch: they leave `(h / l)^4` of the
/// fifth derivative, some 1e-11 of the largest modulus, and the roundings of the stress over the step.
#[test]
fn derivatives_equal_differences() {
    for (rubber, law) in laws() {
        let gradients = |l: [f64; 3]| {
            gradients(l).into_iter().map(move |f| (1e-3 * f64::min(l[0].min(l[1]), l[2]), f))
        };
        for (h, f) in STRETCHES.into_iter().flat_map(gradients) {
            let response = law.response(&f, true);
            let largest = response.moduli.iter().flatten().map(Matrix3::amax).fold(0.0, f64::max);
            for (j, i) in (0..3).flat_map(|j| (0..3).map(move |i| (j, i))) {
                let mut unit = Matrix3::zeros();
                unit[(i, j)] = 1.0;
                let at = |k: f64| law.response(&(f + k * h * unit), false);
                let [a, b, c, d] = [at(-2.0), at(-1.0), at(1.0), at(2.0)];
                let slope = (a.energy - 8.0 * b.energy + 8.0 * c.energy - d.energy) / (12.0 * h);
                let column = (a.stress - 8.0 * b.stress + 8.0 * c.stress - d.stress) / (12.0 * h);
                let tolerance = 3e-10 * largest + 1e-15 * size(&rubber) / h;
                assert_relative_eq!(response.stress[(i, j)], slope, epsilon = tolerance);
                let derivative = contraction(&response.moduli, &unit);
                assert_relative_eq!(derivative, column, epsilon = tolerance);
            }
        }
    }
}

#[test]
fn moduli_are_symmetric() {
    for (_, law) in laws() {
        for f in STRETCHES.into_iter().flat_map(gradients) {
            let moduli = law.response(&f, true).moduli;
            for (j, l) in (0..3).flat_map(|j| (0..3).map(move |l| (j, l))) {
                let error = (moduli[j][l] - moduli[l][j].transpose()).amax();
                // A block beside the diagonal is copied; one on it is made of products in another order.
                assert!(error <= 1e-13 * moduli[j][l].amax(), "{j} {l} {error}");
            }
        }
    }
}

/// Rotations now rotate the stress, rotations at rest do not matter: the laws are objective and isotropic.
#[test]
fn rotations_store_nothing() {
    for (rubber, law) in laws() {
        for stretches in STRETCHES {
            let f = gradients(stretches)[1];
            let still = law.response(&f, true);
            let largest = still.moduli.iter().flatten().map(Matrix3::amax).fold(0.0, f64::max);
            for rotation in rotations() {
                let q = rotation.matrix();
                let tolerance = 1e-13 * (size(&rubber) + largest);
                let now = law.response(&(q * f), true);
                assert_relative_eq!(now.energy, still.energy, epsilon = tolerance);
                assert_relative_eq!(now.stress, q * still.stress, epsilon = tolerance);
                for (turned, block) in
                    now.moduli.iter().flatten().zip(still.moduli.iter().flatten())
                {
                    assert_relative_eq!(
                        *turned,
                        q * block * q.transpose(),
                        epsilon = 20.0 * tolerance
                    );
                }
                let rest = law.response(&(f * q), false);
                assert_relative_eq!(rest.stress, still.stress * q, epsilon = tolerance);
            }
        }
    }
}

/// A change of volume alone changes nothing, and the Kirchhoff stress `P F^T` is symmetric without a trace.
#[test]
fn stress_is_deviatoric_and_symmetric() {
    for (rubber, law) in laws() {
        for f in STRETCHES.into_iter().flat_map(gradients) {
            let response = law.response(&f, false);
            let tau = response.stress * f.transpose();
            let tolerance = 1e-13 * (size(&rubber) + response.stress.amax() * f.amax());
            assert!(tau.trace().abs() < tolerance, "{tau}");
            assert_relative_eq!(tau, tau.transpose(), epsilon = tolerance);
            assert_relative_eq!(law.energy(&(1.7 * f)), response.energy, epsilon = tolerance);
        }
    }
}

/// At rest there is no stress, and the moduli are `2 mu` times the projection on deviatoric strains.
#[test]
fn rest_is_hookean() {
    for (rubber, law) in laws() {
        let response = law.response(&Matrix3::identity(), true);
        let tolerance = 1e-14 * size(&rubber);
        assert!(response.energy.abs() < tolerance && response.stress.amax() < tolerance);
        let h = Matrix3::new(0.3, -1.0, 0.2, 0.7, 0.5, 1.1, -0.4, 0.9, -0.6);
        let strain: Matrix3<f64> = 0.5 * (h + h.transpose());
        let exact =
            2.0 * law.shear_modulus() * (strain - strain.trace() / 3.0 * Matrix3::identity());
        let stress = contraction(&response.moduli, &h);
        assert_relative_eq!(stress, exact, epsilon = 4.0 * tolerance);
    }
}

/// A wall of the shell, seen as a solid that no stress acts across: one energy, one nominal stress.
#[test]
fn wall_in_plane_stress_is_the_shell() {
    for (rubber, law) in laws() {
        for [l1, l2] in [[1.0, 1.0], [1.05, 1.0], [1.2, 1.2], [0.7, 1.4], [2.5, 0.9], [0.4, 0.6]] {
            let (t, j) = invariants([l1, l2]);
            let f = Matrix3::from_diagonal(&Vector3::new(l1, l2, 1.0 / (l1 * l2)));
            let response = law.response(&f, false);
            // Without a pressure that the law would know: differences of Kirchhoff stresses.
            let tau = response.stress.diagonal().component_mul(&f.diagonal());
            let wall = Material::from(rubber.clone());
            let tolerance = 3e-14 * size(&rubber) * (1.0 + response.stress.amax());
            assert_relative_eq!(response.energy, wall.energy(t, j), epsilon = tolerance);
            let [p1, p2] = nominal_stress(&wall, [l1, l2]);
            assert_relative_eq!((tau[0] - tau[2]) / l1, p1, epsilon = tolerance);
            assert_relative_eq!((tau[1] - tau[2]) / l2, p2, epsilon = tolerance);

            let soft = compressible(&rubber, 3.0);
            let wall = Material::Compressible(soft.clone());
            let solid = wall.solid().expect("a rubber");
            assert_eq!(solid.bulk_modulus(), Some(soft.bulk_modulus));
            let l3 = wall.thickness_stretch(t, j).value;
            let f = Matrix3::from_diagonal(&Vector3::new(l1, l2, l3));
            let response = solid.response(&f, false);
            let excess = l1 * l2 * l3 - 1.0;
            let volume = 0.5 * soft.bulk_modulus * excess * excess;
            assert_relative_eq!(response.energy + volume, wall.energy(t, j), epsilon = tolerance);
            let pressure = soft.bulk_modulus * excess;
            let total =
                response.stress.diagonal() + pressure * Vector3::new(l2 * l3, l1 * l3, l1 * l2);
            let [p1, p2] = nominal_stress(&wall, [l1, l2]);
            let tolerance = 10.0 * tolerance;
            assert_relative_eq!(total, Vector3::new(p1, p2, 0.0), epsilon = tolerance);
        }
    }
}

/// Exponents of 2 and -2 make Mooney and Rivlin's law, whose closed formula knows no principal directions.
#[test]
fn powers_keep_their_figures_at_nearly_equal_stretches() {
    let (c1, c2) = (0.4, 0.15);
    let terms = [(2.0 * c1, 2.0), (2.0 * c2, -2.0)].map(|(mu, alpha)| OgdenTerm { mu, alpha });
    let powers = SolidLaw::new(&Rubber::Ogden(Ogden::new(&terms)), None);
    let closed = SolidLaw::new(&Rubber::MooneyRivlin(MooneyRivlin { c1, c2 }), None);
    let gaps = [0.0, 1e-16, 1e-14, 1e-12, 1e-10, 1e-8, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1];
    for gap in gaps {
        for stretches in [
            [1.0, 1.0 + gap, 1.0],
            [1.0, 1.0 + gap, 1.0 - 0.5 * gap],
            [1.3, 1.3 + gap, 0.7],
            [0.7 - gap, 1.4, 0.7],
        ] {
            for f in gradients(stretches) {
                let (powers, closed) = (powers.response(&f, true), closed.response(&f, true));
                assert_relative_eq!(powers.energy, closed.energy, epsilon = 5e-15);
                assert_relative_eq!(powers.stress, closed.stress, epsilon = 2e-14);
                for (a, b) in powers.moduli.iter().flatten().zip(closed.moduli.iter().flatten()) {
                    assert_relative_eq!(*a, *b, epsilon = 1e-13);
                }
            }
        }
    }
}

/// Any power is smooth there too: the moduli at a gap of `g` are those at none but for a share of about `g`.
#[test]
fn moduli_are_continuous_where_stretches_meet() {
    for (rubber, law) in laws() {
        for stretches in [[1.0, 1.0, 1.0], [1.2, 1.2, 0.7], [0.7, 1.3, 1.3]] {
            let meeting = gradients(stretches)[1];
            let exact = law.response(&meeting, true).moduli;
            let direction = Matrix3::new(0.3, -0.5, 0.2, 0.7, 0.1, 0.4, -0.4, 0.6, -0.8);
            for gap in [1e-13, 1e-12, 1e-10, 1e-8, 1e-6, 1e-4] {
                let near = law.response(&(meeting + gap * direction), true).moduli;
                for (a, b) in near.iter().flatten().zip(exact.iter().flatten()) {
                    let error = (a - b).amax();
                    let bound = 100.0 * law.shear_modulus() * gap + 1e-13 * size(&rubber);
                    assert!(error < bound, "{rubber:?} {stretches:?} {gap} {error}");
                }
            }
        }
    }
}

#[test]
fn plates_have_no_solid_law() {
    let plate = super::super::StVenantKirchhoff { young_modulus: 1.0, poisson_ratio: 0.3 };
    assert!(Material::StVenantKirchhoff(plate).solid().is_none());
}
