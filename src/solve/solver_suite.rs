//! The tests that every [`EquilibriumSolver`] must pass.
//!
//! `solver_suite!(|pattern| ...)` in a solver's `mod tests` runs them on what the closure makes.

use std::panic::{AssertUnwindSafe, catch_unwind};

use super::test_systems::{Chain, Changed, Constrained, Hooked, Term, nothing};
use super::{EquilibriumSolver, NewtonEnding, NewtonReport, NewtonSettings};
use crate::model::system::{Inadmissible, SparsityPattern, System};

/// Runs the suite for the solvers made by `$make`: a function or closure from a pattern to a solver.
macro_rules! solver_suite {
    ($make:expr) => {
        crate::solve::solver_suite::solver_suite! { @tests $make;
            hardening_chain_reaches_its_closed_form
            entries_above_the_diagonal_are_ignored
            converged_start_takes_no_iteration
            indefinite_start_is_shifted_to_a_minimum
            inadmissible_steps_are_shortened
            inadmissible_start_is_named
            inadmissible_surroundings_are_named
            inadmissible_tangent_is_named
            not_a_number_is_inadmissible
            iteration_limit_is_named
            failing_line_search_is_named
            vanishing_tangent_is_singular
            negative_pivots_are_exact
            multipliers_are_expected_negative_pivots
            singular_tangent_is_not_stable
            linearized_solves_reproduce_the_load
            linearized_solve_wants_a_tangent
            another_order_is_refused
            another_pattern_is_planned_for
            pattern_that_grows_on_the_way_is_followed
            one_solver_serves_many_solves_and_failures
            two_solvers_live_side_by_side
            threads_agree_to_the_bit
            panic_of_the_system_reaches_the_caller
            times_are_told_by_stage
        }
    };
    (@tests $make:expr; $($name:ident)*) => {
        $(#[test]
        fn $name() {
            crate::solve::solver_suite::$name($make);
        })*
    };
}
pub(super) use solver_suite;

fn solve<S: EquilibriumSolver>(
    make: impl Fn(&SparsityPattern) -> S,
    system: &mut dyn System,
    x: &mut [f64],
) -> NewtonReport {
    make(system.pattern()).solve(system, x, &NewtonSettings::default()).unwrap()
}

#[track_caller]
fn assert_panics(body: impl FnOnce(), message: &str) {
    let payload = catch_unwind(AssertUnwindSafe(body)).unwrap_err();
    let said = payload.downcast_ref::<&str>().copied();
    let said = said.or_else(|| payload.downcast_ref::<String>().map(String::as_str)).unwrap();
    assert!(said.contains(message), "{said:?}");
}

#[track_caller]
fn assert_close(x: &[f64], expected: impl Fn(usize) -> f64, tolerance: f64) {
    for (index, &value) in x.iter().enumerate() {
        let expected = expected(index);
        assert!((value - expected).abs() <= tolerance, "x[{index}] = {value}, not {expected}");
    }
}

pub(super) fn hardening_chain_reaches_its_closed_form<S: EquilibriumSolver>(
    make: impl Fn(&SparsityPattern) -> S,
) {
    // Each spring carries the load 0.5 + 0.5^3.
    let mut chain = Chain::hardening(20, 0.625);
    let mut x = [0.0; 20];
    let report = solve(make, &mut chain, &mut x);
    assert_eq!(report.ending, NewtonEnding::Converged);
    assert_eq!(report.shifted, 0);
    assert!((2..8).contains(&report.iterations), "{report:?}");
    assert!(report.residual_norm <= 1e-9, "{report:?}");
    // |R| <= 1e-9, and the softest mode has stiffness 1.75 (pi / 41)^2 = 0.01.
    assert_close(&x, |index| 0.5 * (index + 1) as f64, 1e-7);
}

pub(super) fn entries_above_the_diagonal_are_ignored<S: EquilibriumSolver>(
    make: impl Fn(&SparsityPattern) -> S,
) {
    let solution = |above| {
        let mut chain = Chain::hardening(9, 2.0);
        chain.above = above;
        let mut x = [0.0; 9];
        assert_eq!(solve(&make, &mut chain, &mut x).ending, NewtonEnding::Converged);
        x
    };
    assert_eq!(solution(f64::NAN), solution(7.0));
}

pub(super) fn converged_start_takes_no_iteration<S: EquilibriumSolver>(
    make: impl Fn(&SparsityPattern) -> S,
) {
    let mut chain = Chain::barrier(4);
    let mut x = [1.0; 4];
    let report = solve(&make, &mut chain, &mut x);
    assert_eq!((report.ending, report.iterations), (NewtonEnding::Converged, 0));
    assert_eq!((report.residual_norm, x), (0.0, [1.0; 4]));

    // R = 0.5 is small against a scale of 1e9.
    let mut coarse = Chain::barrier(1);
    coarse.force_scale = 1e9;
    let mut x = [2.0];
    let report = solve(&make, &mut coarse, &mut x);
    assert_eq!((report.ending, report.iterations), (NewtonEnding::Converged, 0));
    assert_eq!((report.residual_norm, x), (0.5, [2.0]));
}

pub(super) fn indefinite_start_is_shifted_to_a_minimum<S: EquilibriumSolver>(
    make: impl Fn(&SparsityPattern) -> S,
) {
    let mut chain = Chain::double_well(12);
    let mut solver = make(chain.pattern());
    let mut x: Vec<f64> = (0..12).map(|index| 0.1 + 0.02 * f64::from(index)).collect();
    let negative_at_start = solver.linearize(&mut chain, &x).unwrap();
    assert!(negative_at_start > 0);
    let report = solver.solve(&mut chain, &mut x, &NewtonSettings::default()).unwrap();
    assert_eq!(report.ending, NewtonEnding::Converged);
    assert!(0 < report.shifted && report.shifted < report.iterations, "{report:?}");
    // |R| <= 1e-9 where the stiffness is 2.
    assert_close(&x, |_| 1.0, 1e-9);
    assert_eq!(solver.linearize(&mut chain, &x).unwrap(), 0);
}

pub(super) fn inadmissible_steps_are_shortened<S: EquilibriumSolver>(
    make: impl Fn(&SparsityPattern) -> S,
) {
    // The full Newton step from 4 leads to -8.
    let mut x = [4.0; 5];
    let report = solve(make, &mut Chain::barrier(5), &mut x);
    assert_eq!(report.ending, NewtonEnding::Converged);
    assert_close(&x, |_| 1.0, 1e-9);
}

pub(super) fn inadmissible_start_is_named<S: EquilibriumSolver>(
    make: impl Fn(&SparsityPattern) -> S,
) {
    let mut x = [1.0, -1.0];
    let report = solve(make, &mut Chain::barrier(2), &mut x);
    assert_eq!((report.ending, report.iterations), (NewtonEnding::Inadmissible, 0));
    assert_eq!(x, [1.0, -1.0]);
}

pub(super) fn inadmissible_surroundings_are_named<S: EquilibriumSolver>(
    make: impl Fn(&SparsityPattern) -> S,
) {
    let mut island = Changed {
        energy: |energy, x| if x[0] == 3.0 { Ok(energy) } else { Err(Inadmissible("outside")) },
        ..Changed::new(Chain::barrier(2))
    };
    let mut x = [3.0; 2];
    let report = solve(make, &mut island, &mut x);
    assert_eq!(report.ending, NewtonEnding::Inadmissible);
    assert_eq!(x, [3.0; 2]);
}

pub(super) fn inadmissible_tangent_is_named<S: EquilibriumSolver>(
    make: impl Fn(&SparsityPattern) -> S,
) {
    let mut rough = Changed {
        tangent: |_| Err(Inadmissible("no second derivative")),
        ..Changed::new(Chain::barrier(2))
    };
    let report = solve(make, &mut rough, &mut [3.0; 2]);
    assert_eq!(report.ending, NewtonEnding::Inadmissible);
}

pub(super) fn not_a_number_is_inadmissible<S: EquilibriumSolver>(
    make: impl Fn(&SparsityPattern) -> S,
) {
    let nan: fn(&mut [f64]) = |values| values[0] = f64::NAN;
    let mut residual = Changed { residual: nan, ..Changed::new(Chain::barrier(2)) };
    assert_eq!(solve(&make, &mut residual, &mut [3.0; 2]).ending, NewtonEnding::Inadmissible);
    let mut tangent = Changed {
        tangent: |values| {
            values[0] = f64::NAN;
            Ok(())
        },
        ..Changed::new(Chain::barrier(2))
    };
    assert_eq!(solve(&make, &mut tangent, &mut [3.0; 2]).ending, NewtonEnding::Inadmissible);
}

pub(super) fn iteration_limit_is_named<S: EquilibriumSolver>(make: impl Fn(&SparsityPattern) -> S) {
    for max_iterations in [0, 1, 2] {
        let mut chain = Chain::hardening(6, 100.0);
        let settings = NewtonSettings { max_iterations, ..NewtonSettings::default() };
        let report = make(chain.pattern()).solve(&mut chain, &mut [0.0; 6], &settings).unwrap();
        assert_eq!(report.ending, NewtonEnding::IterationLimit);
        assert_eq!(report.iterations, max_iterations);
        assert!(report.residual_norm.is_finite());
    }
}

pub(super) fn failing_line_search_is_named<S: EquilibriumSolver>(
    make: impl Fn(&SparsityPattern) -> S,
) {
    // An energy that contradicts the residual: higher wherever the search looks.
    let mut liar = Changed {
        energy: |_, x| Ok(if x[0] == 3.0 { 0.0 } else { 1.0 }),
        ..Changed::new(Chain::barrier(2))
    };
    let mut x = [3.0; 2];
    let report = solve(make, &mut liar, &mut x);
    assert_eq!(report.ending, NewtonEnding::LineSearchFailed);
    assert_eq!(x, [3.0; 2]);
    // R = 1 - 1/3 for both unknowns.
    assert!((report.residual_norm - 8.0_f64.sqrt() / 3.0).abs() < 1e-15);
}

pub(super) fn vanishing_tangent_is_singular<S: EquilibriumSolver>(
    make: impl Fn(&SparsityPattern) -> S,
) {
    let slope: Term = |x| Ok([x, 1.0, 0.0]);
    let mut system = Chain::new(3, slope, nothing, false);
    let report = solve(make, &mut system, &mut [0.0; 3]);
    assert_eq!(report.ending, NewtonEnding::Singular);
}

pub(super) fn negative_pivots_are_exact<S: EquilibriumSolver>(
    make: impl Fn(&SparsityPattern) -> S,
) {
    // The last spring's end is free: eigenvalues g + 2 - 2 cos((2k - 1) pi / (2n + 1)), k = 1..n.
    let grounds: [(f64, Term); 4] = [
        (0.1, |x| Ok([0.05 * x * x, 0.1 * x, 0.1])),
        (-0.3, |x| Ok([-0.15 * x * x, -0.3 * x, -0.3])),
        (-1.9, |x| Ok([-0.95 * x * x, -1.9 * x, -1.9])),
        (-4.1, |x| Ok([-2.05 * x * x, -4.1 * x, -4.1])),
    ];
    for (ground, term) in grounds {
        for order in [1, 2, 7, 40] {
            let mode = |k: usize| {
                let angle = (2 * k - 1) as f64 * std::f64::consts::PI / (2 * order + 1) as f64;
                ground + 2.0 - 2.0 * angle.cos()
            };
            let expected = (1..=order).filter(|&k| mode(k) < 0.0).count();
            let mut chain = Chain::linear(order, term);
            let found = make(chain.pattern()).linearize(&mut chain, &vec![0.3; order]);
            assert_eq!(found.unwrap(), expected, "ground {ground}, order {order}");
        }
    }
}

pub(super) fn multipliers_are_expected_negative_pivots<S: EquilibriumSolver>(
    make: impl Fn(&SparsityPattern) -> S,
) {
    let mut system = Constrained(SparsityPattern {
        column_starts: vec![0, 2, 4, 5],
        row_indices: vec![0, 2, 1, 2, 2],
    });
    let mut solver = make(system.pattern());
    assert_eq!(solver.linearize(&mut system, &[0.0; 3]).unwrap(), 1);
    // On the constraint but out of balance, the step lowers the energy: from 1/2 to 1/4.
    let mut x = [1.0, 0.0, 0.0];
    let report = solver.solve(&mut system, &mut x, &NewtonSettings::default()).unwrap();
    assert_eq!(report.ending, NewtonEnding::Converged);
    assert_eq!((report.iterations, report.shifted), (1, 0));
    // A linear system of order 3: rounding.
    assert_close(&x, |index| [0.5, 0.5, -0.5][index], 1e-14);
}

pub(super) fn linearized_solves_reproduce_the_load<S: EquilibriumSolver>(
    make: impl Fn(&SparsityPattern) -> S,
) {
    let mut chain = Chain::linear(30, |x| Ok([-0.15 * x * x, -0.3 * x, -0.3]));
    let mut solver = make(chain.pattern());
    solver.linearize(&mut chain, &[0.0; 30]).unwrap();
    for seed in 1..4 {
        let load: Vec<f64> = (0..30).map(|index| f64::sin(f64::from(seed * index))).collect();
        let mut y = load.clone();
        solver.solve_linearized(&mut y).unwrap();
        // The system is linear and free of load: its residual at y is K y.
        let mut product = [0.0; 30];
        chain.residual(&y, &mut product).unwrap();
        // Rounding times the condition number, about 1e3.
        assert_close(&product, |index| load[index], 1e-12);
    }
}

pub(super) fn singular_tangent_is_not_stable<S: EquilibriumSolver>(
    make: impl Fn(&SparsityPattern) -> S,
) {
    // Springs between free unknowns: all may move together. The last of the pivots is zero.
    for order in [1, 2, 5] {
        let spring: Term = |e| Ok([e * e / 2.0, e, 1.0]);
        let mut chain = Chain::new(order, nothing, spring, false);
        let mut solver = make(chain.pattern());
        assert!(solver.linearize(&mut chain, &vec![0.0; order]).unwrap() > 0, "order {order}");
        assert_panics(|| solver.solve_linearized(&mut vec![1.0; order]).unwrap(), "linearize");
    }
}

pub(super) fn linearized_solve_wants_a_tangent<S: EquilibriumSolver>(
    make: impl Fn(&SparsityPattern) -> S,
) {
    let mut chain = Chain::hardening(3, 2.0);
    let mut solver = make(chain.pattern());
    assert_panics(|| solver.solve_linearized(&mut [1.0; 3]).unwrap(), "without linearize");
    // A solve leaves another factor behind.
    solver.linearize(&mut chain, &[0.0; 3]).unwrap();
    solver.solve_linearized(&mut [1.0; 3]).unwrap();
    solver.solve(&mut chain, &mut [0.0; 3], &NewtonSettings::default()).unwrap();
    assert_panics(|| solver.solve_linearized(&mut [1.0; 3]).unwrap(), "without linearize");
}

pub(super) fn another_order_is_refused<S: EquilibriumSolver>(make: impl Fn(&SparsityPattern) -> S) {
    let mut solver = make(Chain::hardening(3, 2.0).pattern());
    let mut chain = Chain::hardening(2, 2.0);
    let settings = NewtonSettings::default();
    assert_panics(
        || solver.solve(&mut chain, &mut [0.0; 2], &settings).map(drop).unwrap(),
        "order",
    );
    assert_panics(|| solver.linearize(&mut chain, &[0.0; 2]).map(drop).unwrap(), "order");
}

pub(super) fn another_pattern_is_planned_for<S: EquilibriumSolver>(
    make: impl Fn(&SparsityPattern) -> S,
) {
    let mut chain = Chain::hardening(2, 2.0);
    let diagonal = SparsityPattern { column_starts: vec![0, 1, 2], row_indices: vec![0, 1] };
    let mut solver = make(&diagonal);
    assert_eq!(solver.linearize(&mut chain, &[0.0; 2]).unwrap(), 0);
    let mut solver = make(&diagonal);
    let mut x = [0.0; 2];
    let report = solver.solve(&mut chain, &mut x, &NewtonSettings::default()).unwrap();
    assert_eq!(report.ending, NewtonEnding::Converged);
    // The load 1 + 1^3 stretches each by 1; |R| <= 1e-9.
    assert_close(&x, |index| (index + 1) as f64, 1e-8);
}

/// One solve: the hook catches in its midst, where the pattern has no room for it yet.
pub(super) fn pattern_that_grows_on_the_way_is_followed<S: EquilibriumSolver>(
    make: impl Fn(&SparsityPattern) -> S,
) {
    let order = 9;
    let mut system = Hooked::new(order, 2.0, 3.0, 4.0);
    let mut solver = make(system.pattern());
    let settings = NewtonSettings::default();
    let mut x = vec![0.0; order];
    let report = solver.solve(&mut system, &mut x, &settings).unwrap();
    assert_eq!(report.ending, NewtonEnding::Converged);
    assert!(system.room.is_some() && report.iterations > 2, "{report:?}");
    // The first spring carries the load 2; the others and the hook share it.
    let stretch = (x[order - 1] - x[0]) / (order - 1) as f64;
    let hook = 1.5 * (x[order - 1] - x[0] - 4.0).powi(2);
    // |R| <= 1e-9, and the softest mode has a stiffness of 0.01.
    assert!(hook > 0.5 && (stretch + stretch.powi(3) + hook - 2.0).abs() < 1e-7, "{hook}");
    assert_close(&x, |index| 1.0 + index as f64 * stretch, 1e-7);

    assert_eq!(solver.linearize(&mut system, &x).unwrap(), 0);
    let mut y: Vec<f64> = (0..order).map(|index| f64::sin(index as f64)).collect();
    let load = y.clone();
    solver.solve_linearized(&mut y).unwrap();
    // A step along y changes the residual by its load, to first order.
    let (mut before, mut after) = (vec![0.0; order], vec![0.0; order]);
    let step = 1e-6;
    let moved =
        |sign: f64| -> Vec<f64> { x.iter().zip(&y).map(|(x, y)| x + sign * step * y).collect() };
    system.residual(&moved(-1.0), &mut before).unwrap();
    system.residual(&moved(1.0), &mut after).unwrap();
    // Rounding over the step, and the step squared.
    assert_close(&after, |i| before[i] + 2.0 * step * load[i], 1e-13);

    // A solver that was planned before the pattern grew finds the same; nothing changes any more.
    let mut other = make(Chain::hardening(order, 2.0).pattern());
    let mut again = vec![0.0; order];
    let report = other.solve(&mut system, &mut again, &settings).unwrap();
    assert_eq!(report.ending, NewtonEnding::Converged);
    assert_close(&again, |index| x[index], 1e-7);
}

pub(super) fn one_solver_serves_many_solves_and_failures<S: EquilibriumSolver>(
    make: impl Fn(&SparsityPattern) -> S,
) {
    let mut solver = make(Chain::hardening(6, 0.0).pattern());
    let slope: Term = |x| Ok([x, 1.0, 0.0]);
    let mut failures: Vec<Box<dyn System>> = vec![
        Box::new(Chain::new(6, slope, nothing, false)),
        Box::new(Changed {
            residual: |residual| residual[1] = f64::INFINITY,
            ..Changed::new(Chain::barrier(6))
        }),
        Box::new(Changed {
            tangent: |_| Err(Inadmissible("no second derivative")),
            ..Changed::new(Chain::barrier(6))
        }),
        Box::new(Changed {
            energy: |_, x| Ok(if x[0] == 0.5 { 0.0 } else { 1.0 }),
            ..Changed::new(Chain::barrier(6))
        }),
    ];
    let settings = NewtonSettings::default();
    let mut first = None;
    for (case, failing) in failures.iter_mut().enumerate() {
        let failed = solver.solve(failing.as_mut(), &mut [0.5; 6], &settings).unwrap();
        assert_ne!(failed.ending, NewtonEnding::Converged);

        let mut x = [0.0; 6];
        let report = solver.solve(&mut Chain::hardening(6, 2.0), &mut x, &settings).unwrap();
        assert_eq!(report.ending, NewtonEnding::Converged, "after failure {case}");
        // Nothing of the failures is left: the same bits each time. The load 1 + 1^3 stretches each by 1.
        assert_eq!(*first.get_or_insert((x, report)), (x, report));
        assert_close(&x, |index| (index + 1) as f64, 1e-8);
    }
}

pub(super) fn two_solvers_live_side_by_side<S: EquilibriumSolver>(
    make: impl Fn(&SparsityPattern) -> S,
) {
    let (mut small, mut large) = (Chain::hardening(3, 2.0), Chain::hardening(50, 2.0));
    let (mut one, mut two) = (make(small.pattern()), make(large.pattern()));
    let (mut x, mut y) = ([0.0; 3], [0.0; 50]);
    let settings = NewtonSettings::default();
    one.solve(&mut small, &mut x, &settings).unwrap();
    two.solve(&mut large, &mut y, &settings).unwrap();
    // The one's factor survives what the other does.
    one.linearize(&mut small, &x).unwrap();
    two.linearize(&mut large, &y).unwrap();
    drop(two);
    let mut load = [0.0, 0.0, 4.0];
    one.solve_linearized(&mut load).unwrap();
    // Stiffness 1 + 3 e^2 = 4 for each spring at e = 1, so the end load 4 stretches each by 1.
    assert_close(&load, |index| (index + 1) as f64, 1e-8);
    assert_close(&y, |index| (index + 1) as f64, 1e-6);
}

pub(super) fn threads_agree_to_the_bit<S: EquilibriumSolver>(
    make: impl Fn(&SparsityPattern) -> S + Sync,
) {
    let run = || {
        let mut chain = Chain::double_well(60);
        let mut solver = make(chain.pattern());
        let mut x: Vec<f64> = (0..60).map(|index| 0.3 * f64::sin(f64::from(index))).collect();
        let report = solver.solve(&mut chain, &mut x, &NewtonSettings::default()).unwrap();
        let negative = solver.linearize(&mut chain, &x).unwrap();
        (x, report, negative)
    };
    let expected = run();
    assert_eq!((expected.1.ending, expected.2), (NewtonEnding::Converged, 0));
    std::thread::scope(|scope| {
        let threads: Vec<_> = (0..4).map(|_| scope.spawn(run)).collect();
        for thread in threads {
            assert_eq!(thread.join().unwrap(), expected);
        }
    });
}

pub(super) fn panic_of_the_system_reaches_the_caller<S: EquilibriumSolver>(
    make: impl Fn(&SparsityPattern) -> S,
) {
    let chain = || Changed::new(Chain::barrier(2));
    let mut systems = [
        Changed { residual: |_| panic!("on purpose"), ..chain() },
        Changed { tangent: |_| panic!("on purpose"), ..chain() },
        Changed {
            energy: |energy, x| if x[0] == 3.0 { Ok(energy) } else { panic!("on purpose") },
            ..chain()
        },
    ];
    let mut solver = make(systems[0].pattern());
    let settings = NewtonSettings::default();
    for system in &mut systems {
        assert_panics(|| drop(solver.solve(system, &mut [3.0; 2], &settings)), "on purpose");

        let report = solver.solve(&mut chain(), &mut [3.0; 2], &settings).unwrap();
        assert_eq!(report.ending, NewtonEnding::Converged);
    }
}

pub(super) fn times_are_told_by_stage<S: EquilibriumSolver>(make: impl Fn(&SparsityPattern) -> S) {
    let busy: fn(&mut [f64]) = |_| {
        let start = crate::math::cpu_seconds();
        while crate::math::cpu_seconds() - start < 0.005 {
            std::hint::spin_loop();
        }
    };
    let mut chain = Changed { residual: busy, ..Changed::new(Chain::hardening(6, 2.0)) };
    let mut solver = make(chain.pattern());
    let (before, start) = (solver.times(), crate::math::cpu_seconds());
    let report = solver.solve(&mut chain, &mut [0.0; 6], &NewtonSettings::default()).unwrap();
    let all = crate::math::cpu_seconds() - start;
    assert_eq!(report.ending, NewtonEnding::Converged);
    let after = solver.times();
    // Each iteration evaluates the residual at least once, and no second is counted twice.
    let assembly = after.assembly - before.assembly;
    let factorization = after.factorization - before.factorization;
    assert!(assembly >= 0.005 * report.iterations as f64);
    assert!(0.0 < factorization && assembly + factorization <= all);
}
