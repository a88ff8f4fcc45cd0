//! The tests that every [`Term`] must pass, on irregular shells in states far from rest.
//!
//! `term_suite!(name, make)` in a term's `mod tests` runs them on the [`Case`]s that `make` makes.

use nalgebra::{DVector, Isometry3};

use super::local::{LocalDerivatives, Term};
use super::test_shells::{TestShell, difference};
use crate::math::Vec3;

/// A term in a state where it acts.
pub(super) struct Case<T> {
    pub(super) term: T,
    /// Positions of all nodes, mm.
    pub(super) positions: Vec<Vec3>,
    /// A rigid motion that leaves the energy as it is.
    pub(super) motion: Isometry3<f64>,
}

/// Runs the suite for the cases that `$make` makes of a [`TestShell`].
macro_rules! term_suite {
    ($name:ident, $make:expr) => {
        mod $name {
            #[allow(unused_imports, reason = "the maker may be a path or a closure")]
            use super::*;

            crate::model::term_suite::term_suite! { @tests $make;
                stencils_ascend
                gradient_is_the_difference_of_the_energy
                hessian_is_the_difference_of_the_gradient
                derivatives_do_not_depend_on_what_is_asked
                rigid_motion_turns_the_gradient_and_keeps_the_energy
                inactive_stencils_have_no_energy
            }
        }
    };
    (@tests $make:expr; $($test:ident)*) => {
        $(#[test]
        fn $test() {
            crate::model::term_suite::$test($make);
        })*
    };
}
pub(super) use term_suite;

const SEEDS: u64 = 3;
/// Of the differences, mm. Their error is (step / length)^4 for states that vary over about 0.3 mm (a barrier)
/// to 3 mm (a wall), and rounding over step / length: some 1e-11 of the largest entry.
const STEP: f64 = 1e-3;

fn cases<T: Term>(make: impl Fn(&TestShell) -> Case<T>) -> impl Iterator<Item = Case<T>> {
    (0..SEEDS).map(move |seed| make(&TestShell::new(seed)))
}

impl<T: Term> Case<T> {
    fn local(&self, s: usize, positions: &[Vec3]) -> Vec<Vec3> {
        self.term.stencils()[s].iter().map(|&v| positions[v as usize]).collect()
    }

    fn derivatives(&self, s: usize, x: &[Vec3], with_hessian: bool) -> (f64, LocalDerivatives) {
        let mut local = LocalDerivatives::with_capacity(x.len());
        local.reset(x.len(), with_hessian);
        let energy = self.term.derivatives(s, x, &mut local).unwrap();
        (energy, local)
    }

    /// The gradient of stencil `s` at `x`, `[3 nodes]`.
    fn gradient(&self, s: usize, x: &[Vec3]) -> DVector<f64> {
        let (_, local) = self.derivatives(s, x, false);
        DVector::from_iterator(3 * x.len(), local.gradient().iter().flatten().copied())
    }

    fn energy(&self, positions: &[Vec3]) -> f64 {
        let stencils = 0..self.term.stencils().len();
        stencils.map(|s| self.term.energy(s, &self.local(s, positions)).unwrap()).sum()
    }

    /// Energies without regard to sign: what rounding is relative to.
    fn energy_scale(&self, positions: &[Vec3]) -> f64 {
        let stencils = 0..self.term.stencils().len();
        stencils.map(|s| self.term.energy(s, &self.local(s, positions)).unwrap().abs()).sum()
    }

    fn global_gradient(&self, positions: &[Vec3]) -> Vec<Vec3> {
        let mut gradient = vec![Vec3::zeros(); positions.len()];
        for (s, stencil) in self.term.stencils().iter().enumerate() {
            let (_, local) = self.derivatives(s, &self.local(s, positions), false);
            for (&node, part) in stencil.iter().zip(local.gradient()) {
                gradient[node as usize] += part;
            }
        }
        gradient
    }
}

/// `x` with its `unknown`-th coordinate moved by `step`.
fn moved(x: &[Vec3], unknown: usize, step: f64) -> Vec<Vec3> {
    let mut x = x.to_vec();
    x[unknown / 3][unknown % 3] += step;
    x
}

pub(super) fn stencils_ascend<T: Term>(make: impl Fn(&TestShell) -> Case<T>) {
    for case in cases(make) {
        for stencil in case.term.stencils() {
            assert!(stencil.is_sorted_by(|a, b| a < b), "{stencil:?}");
        }
    }
}

pub(super) fn gradient_is_the_difference_of_the_energy<T: Term>(
    make: impl Fn(&TestShell) -> Case<T>,
) {
    for case in cases(make) {
        let (mut largest, mut error) = (0.0_f64, 0.0_f64);
        for s in 0..case.term.stencils().len() {
            let x = case.local(s, &case.positions);
            let gradient = case.gradient(s, &x);
            largest = largest.max(gradient.amax());
            for (unknown, exact) in gradient.iter().enumerate() {
                let slope =
                    difference(STEP, |h| case.term.energy(s, &moved(&x, unknown, h)).unwrap());
                error = error.max((slope - exact).abs());
            }
        }
        assert!(largest > 0.0);
        assert!(error <= 1e-10 * largest, "{:e}", error / largest);
    }
}

pub(super) fn hessian_is_the_difference_of_the_gradient<T: Term>(
    make: impl Fn(&TestShell) -> Case<T>,
) {
    for case in cases(make) {
        let (mut largest, mut error) = (0.0_f64, 0.0_f64);
        for s in 0..case.term.stencils().len() {
            let x = case.local(s, &case.positions);
            let (_, local) = case.derivatives(s, &x, true);
            for unknown in 0..3 * x.len() {
                let slope = difference(STEP, |h| case.gradient(s, &moved(&x, unknown, h)));
                let (j, column) = (unknown / 3, unknown % 3);
                for i in 0..x.len() {
                    // The block above the diagonal is the transposed one below it: both are compared.
                    let exact = if i >= j {
                        local.block(i, j).column(column).into_owned()
                    } else {
                        local.block(j, i).row(column).transpose()
                    };
                    largest = largest.max(exact.amax());
                    error = error.max((slope.fixed_rows::<3>(3 * i) - exact).amax());
                }
            }
        }
        assert!(largest > 0.0);
        assert!(error <= 1e-10 * largest, "{:e}", error / largest);
    }
}

pub(super) fn derivatives_do_not_depend_on_what_is_asked<T: Term>(
    make: impl Fn(&TestShell) -> Case<T>,
) {
    for case in cases(make) {
        let mut error = 0.0_f64;
        for s in 0..case.term.stencils().len() {
            let x = case.local(s, &case.positions);
            let (energy, whole) = case.derivatives(s, &x, true);
            let (same, part) = case.derivatives(s, &x, false);
            assert_eq!((energy, whole.gradient()), (same, part.gradient()));
            error = error.max((case.term.energy(s, &x).unwrap() - energy).abs());
        }
        // The two ways to the energy differ by the order of some ten operations.
        assert!(error <= 1e-14 * case.energy_scale(&case.positions), "{error:e}");
    }
}

pub(super) fn rigid_motion_turns_the_gradient_and_keeps_the_energy<T: Term>(
    make: impl Fn(&TestShell) -> Case<T>,
) {
    for case in cases(make) {
        let there: Vec<Vec3> = case
            .positions
            .iter()
            .map(|&x| (case.motion * nalgebra::Point3::from(x)).coords)
            .collect();
        let change = (case.energy(&there) - case.energy(&case.positions)).abs();
        assert!(change <= 1e-13 * case.energy_scale(&case.positions), "{change:e}");
        // Both are sums of some hundred roundings.
        let gradient = case.global_gradient(&case.positions);
        let largest = gradient.iter().map(|g| g.norm()).fold(0.0, f64::max);
        for (turned, gradient) in case.global_gradient(&there).iter().zip(&gradient) {
            let error = (turned - case.motion.rotation * gradient).norm();
            assert!(error <= 1e-13 * largest, "{:e}", error / largest);
        }
    }
}

pub(super) fn inactive_stencils_have_no_energy<T: Term>(make: impl Fn(&TestShell) -> Case<T>) {
    for case in cases(make) {
        let mut active = 0;
        for s in 0..case.term.stencils().len() {
            if case.term.is_active(s, &case.positions) {
                active += 1;
                continue;
            }
            let x = case.local(s, &case.positions);
            let (energy, local) = case.derivatives(s, &x, true);
            assert_eq!((energy, case.term.energy(s, &x)), (0.0, Ok(0.0)));
            assert!(local.gradient().iter().all(|g| *g == Vec3::zeros()));
            assert!((0..x.len()).all(|i| (0..=i).all(|j| local.block(i, j).amax() == 0.0)));
        }
        assert!(active > 0);
    }
}
