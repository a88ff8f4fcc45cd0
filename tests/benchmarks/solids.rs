//! Quadratic tetrahedra against closed forms and the results of other programs, by both solvers.
//!
//! Every state of every path has as many negative pivots as pressures, but for the one that a given volume cures beyond a
//! balloon's limit point. `cargo run --release --example solid_benchmarks` prints the tables on finer meshes.

use std::f64::consts::{FRAC_PI_4, PI};

use pneumorph::solve::Backend;

use crate::solid_problems::{
    BLOCK_SINKING, COOK_RISE, Volume, beam_tips, block_sinking, cook_rise, elastica_error,
    exact_pressure, exact_twisted_energy, inflation_error, sphere, tube, twisted_energy,
};

/// The solvers that this program was built with.
fn backends() -> impl Iterator<Item = Backend> {
    [Backend::Native, Backend::Petsc].into_iter().filter(|backend| backend.is_built_in())
}

/// How the error falls when cells are halved.
fn order([coarse, fine]: [f64; 2]) -> f64 {
    (coarse / fine).log2()
}

/// Quadratures of the stress by another program.
#[test]
fn exact_pressures_are_those_of_the_tables() {
    for (directions, outer, stretch, pressure) in [
        (2, 1.2, 1.2, 0.183928708870),
        (2, 2.0, 1.5, 0.755433118712),
        (1, 1.2, 1.2, 0.0847637263490),
        (1, 2.0, 1.5, 0.428228409097),
    ] {
        // The tables have 12 digits.
        let found = exact_pressure(directions, outer, stretch);
        assert!((found - pressure).abs() < 1e-11, "{directions} {outer}: {found} {pressure}");
    }
}

/// Within 0.1 % up to twice the radius, through the sphere's limit point. (Rubber of nu = 0.4999 differs from the closed form,
/// which is incompressible, by some 1e-4 itself.)
#[test]
fn thick_walls_follow_their_closed_forms() {
    for (volume, backend) in Volume::ALL.into_iter().flat_map(|v| backends().map(move |b| (v, b))) {
        for outer in [1.2, 2.0] {
            let material = volume.rubber(1.0);
            let layers = if outer == 1.2 { 2 } else { 4 };
            let mut body = sphere(4, layers, outer, &material);
            let error = inflation_error(&mut body, 2, outer, 8.0, backend);
            assert!(error < 1e-3, "sphere {outer} {volume:?} {backend:?}: {error}");
            let mut body = tube(6, layers, outer, &material);
            let error = inflation_error(&mut body, 1, outer, 4.0, backend);
            assert!(error < 1e-3, "tube {outer} {volume:?} {backend:?}: {error}");
        }
    }
}

/// A pressure is an energy's slope: its error is the square of that of the strains, of fourth order.
#[test]
fn pressures_converge_with_the_fourth_order() {
    let material = Volume::Incompressible.rubber(1.0);
    let error = |n: usize| {
        inflation_error(&mut sphere(n, n / 2, 1.5, &material), 2, 1.5, 3.4, Backend::Native)
    };
    let order = order([2, 4].map(error));
    assert!(order > 3.5, "sphere: {order}");
    let error = |n: usize| {
        inflation_error(&mut tube(n, n / 2, 1.5, &material), 1, 1.5, 2.3, Backend::Native)
    };
    let order = crate::solids::order([4, 8].map(error));
    assert!(order > 3.5, "tube: {order}");
}

/// Within 0.5 % of the other program's limit at every force, with more than the first order that equal cells have.
#[test]
fn cooks_membrane_rises_as_known() {
    let errors = |n: usize, volume: Volume, backend: Backend| {
        let rise = cook_rise(n, volume, backend);
        [0, 1, 2, 3, 4].map(|fifth| (rise[fifth] / COOK_RISE[fifth] - 1.0).abs())
    };
    for (volume, backend) in Volume::ALL.into_iter().flat_map(|v| backends().map(move |b| (v, b))) {
        let errors = errors(16, volume, backend);
        assert!(errors.iter().all(|&error| error < 5e-3), "{volume:?} {backend:?}: {errors:?}");
    }
    // Of the last, which is known best.
    let order = order([4, 8].map(|n| errors(n, Volume::Incompressible, Backend::Native)[4]));
    assert!(order > 1.4, "{order}");
}

/// Compressed to less than a third of its height, within 0.5 % of the other program, whose law of volume is another.
#[test]
fn compressed_block_sinks_as_known() {
    let fastest = backends().last().unwrap();
    for (found, known) in block_sinking(8, fastest).iter().zip(BLOCK_SINKING) {
        let error = found / known - 1.0;
        assert!(error.abs() < 5e-3, "{found} {known} {error}");
    }
    let coarse: Vec<[f64; 4]> = backends().map(|backend| block_sinking(4, backend)).collect();
    for (one, other) in coarse[0].iter().zip(coarse.last().unwrap()) {
        // Newton's tolerance, 1e-9 of the force scale.
        assert!((one - other).abs() < 1e-8, "{one} {other}");
    }
}

/// Bent to an end slope of 82 degrees by one cell across. A beam shears as the elastica does not: what is left on fine
/// meshes falls to a quarter where it is twice as slender.
#[test]
fn bent_beam_is_the_elastica() {
    for backend in backends() {
        let error = elastica_error(&beam_tips(16, 40.0, backend));
        assert!(error < 5e-3, "{backend:?}: {error}");
    }
    let tips = |n, length| beam_tips(n, length, Backend::Native);
    let [thick, slender] = [tips(32, 40.0), tips(64, 80.0)];
    let ratio = elastica_error(&thick) / elastica_error(&slender);
    assert!((ratio - 4.0).abs() < 0.5, "{ratio}");
    let distance = |n| (tips(n, 40.0)[9] - thick[9]).norm();
    let order = order([4, 8].map(distance));
    assert!(order > 3.0, "{order}");
}

/// Torque `pi/2 mu tau` and thrust `-pi/4 mu tau^2` of a twisted rod, as slopes of the energy; and its order.
#[test]
fn twisted_rod_resists_and_pushes() {
    let twist = 0.5;
    for backend in backends() {
        let slopes = |energy: &dyn Fn(f64, f64) -> f64| {
            let h = 0.02;
            let torque = (energy(twist + h, 1.0) - energy(twist - h, 1.0)) / (2.0 * h);
            let thrust = (energy(twist, 1.0 + h) - energy(twist, 1.0 - h)) / (2.0 * h);
            [torque, thrust]
        };
        let found = slopes(&|twist, stretch| twisted_energy(3, twist, stretch, backend));
        let exact = slopes(&exact_twisted_energy);
        // The slopes of the closed form itself, to the square of the difference's step.
        assert!((exact[0] - FRAC_PI_4).abs() < 1e-6 && (exact[1] + PI / 16.0).abs() < 2e-3);
        for (found, exact) in found.iter().zip(exact) {
            assert!((found / exact - 1.0).abs() < 5e-3, "{backend:?}: {found} {exact}");
        }
    }
    let error = |n: usize| {
        twisted_energy(n, twist, 1.0, Backend::Native) / exact_twisted_energy(twist, 1.0) - 1.0
    };
    let order = order([2, 4].map(error).map(f64::abs));
    assert!(order > 3.0, "{order}");
}
