//! Verdicts on runs, and benchmarks that are decided without a path.

use super::*;
use crate::scene::watch_curve::CurvePoint;
use crate::solve::{Ending, Path as Walked, PathPoint, SolveCounts};
use crate::verify::cases::{self, SHELLS};

/// A path of three states with one watch, which grows to `value`.
fn measured(value: f64) -> Measured {
    let state = |k: usize| PathPoint { load: k as f64, ..PathPoint::at_rest(k as f64, 2) };
    let shown =
        |k: usize| CurvePoint { load: 0.5 * k as f64, value: 0.5 * k as f64 * value, rate: 1.0 };
    let walked = Walked {
        points: (0..3).map(state).collect(),
        ending: Ending::Reached,
        place: None,
        fell: false,
        counts: SolveCounts::default(),
    };
    Measured {
        walked,
        unknowns: 2,
        cpu_seconds: 0.0,
        curves: vec![WatchCurve { points: (0..3).map(shown).collect() }],
        limit_load: None,
    }
}

fn ran(value: f64) -> Ran {
    Ran {
        ending: "reached".to_owned(),
        message: None,
        reached: 1.0,
        measured: Some(measured(value)),
        wall_seconds: 0.0,
    }
}

fn plate() -> (StabilityCase, Variant) {
    let case = case("plate_in_um").unwrap();
    let variant = case.variants()[0];
    (case, variant)
}

#[test]
fn an_ending_that_is_not_allowed_fails() {
    let (mut case, variant) = plate();
    let row = judged(&case, variant, Backend::Native, &ran(2.0));
    assert_eq!((row.verdict, row.remark.as_str(), row.load), (OK, "", 1.0));
    case.verify.endings = vec!["limit_point".to_owned(), "ballooning".to_owned()];
    let row = judged(&case, variant, Backend::Native, &ran(2.0));
    assert_eq!((row.verdict, row.ending.as_str()), (FAILED, "reached"));
    assert_eq!(row.remark, "reached, not limit_point or ballooning");
    case.verify.endings = vec!["reached".to_owned()];
    case.verify.snaps = Some([1, 2]);
    let row = judged(&case, variant, Backend::Native, &ran(2.0));
    assert_eq!((row.verdict, row.remark.as_str()), (FAILED, "0 snaps, not 1 to 2"));
    case.verify.snaps = None;
    case.verify.ends_between = Some([0.3, 0.4]);
    let row = judged(&case, variant, Backend::Native, &ran(2.0));
    assert_eq!(row.remark, "it ends at load 1.0000, not 0.3 to 0.4");
}

/// A ring that only lies on a plane, on four meshes: one verdict, from the geometry.
#[test]
fn what_nothing_holds_is_refused_on_every_mesh() {
    let case = case("half_ring_on_plane").unwrap();
    for variant in case.variants() {
        let ran = super::ran(&case, variant, Backend::Native, &Unobserved);
        let row = judged(&case, variant, Backend::Native, &ran);
        assert_eq!((row.ending.as_str(), row.verdict), (REJECTED, OK), "{}", row.remark);
        assert!(row.remark.ends_with("(a [[plane]] pushes a part, but does not hold it)"));
    }
}

/// No other benchmark is taken for one that nothing holds.
#[test]
fn built_in_patches_are_held() {
    let shells = SHELLS.names().map(|name| cases::case(&SHELLS, name).unwrap());
    let hard = FOLDER.names().map(|name| case(name).unwrap()).filter_map(|case| {
        Some((case.name, case.scene.ok()?, case.verify))
            .filter(|(name, ..)| !name.contains("half_ring"))
    });
    let all = shells.map(|case| (case.name, case.scene, case.verify)).chain(hard);
    for (name, mut scene, verify) in all.filter(|(_, scene, _)| scene.part.patch.is_some()) {
        if let Some(&mesh) = verify.meshes.first() {
            scene = scene.with_mesh(mesh).unwrap();
        }
        let source = scene.part.source(Path::new(""), &BuiltIn).unwrap();
        if let Err(error) = Shape::new(&scene, &source, &Unobserved) {
            let message = format!("{error:#}");
            assert!(!message.contains("freely"), "{name}: {message}");
        }
    }
}

#[test]
fn what_is_said_must_be_what_is_expected() {
    let (mut case, variant) = plate();
    case.verify.endings = vec![REFUSED.to_owned()];
    case.verify.says = Some("too near".to_owned());
    let refused = |message: &str| Ran {
        ending: REFUSED.to_owned(),
        message: Some(message.to_owned()),
        reached: 0.0,
        measured: None,
        wall_seconds: 0.0,
    };
    let verdict = |ran: &Ran| judged(&case, variant, Backend::Native, ran).verdict;
    assert_eq!(verdict(&refused("the plane is too near")), OK);
    assert_eq!(verdict(&refused("unknown key")), FAILED);
}

#[test]
fn a_number_that_is_none_fails_wherever_it_stands() {
    assert_eq!(not_finite(&measured(2.0)), None);
    assert_eq!(not_finite(&measured(f64::NAN)).unwrap(), "watch 0 is not finite");
    let mut broken = measured(2.0);
    broken.walked.points[1].rate[1] = f64::INFINITY;
    assert_eq!(not_finite(&broken).unwrap(), "state 1 holds a number that is not finite");
    let (case, variant) = plate();
    let ran = Ran { measured: Some(broken), ..ran(2.0) };
    assert_eq!(judged(&case, variant, Backend::Native, &ran).verdict, FAILED);
}

#[test]
fn a_panic_is_a_failure_of_its_run() {
    let ran = guarded(&|| panic!("index out of bounds"));
    assert_eq!(ran.ending, "panicked");
    let (case, variant) = plate();
    let row = judged(&case, variant, Backend::Native, &ran);
    assert_eq!((row.verdict, row.remark.as_str()), (FAILED, "index out of bounds"));
}

#[test]
fn solvers_are_compared_where_both_have_a_state() {
    // 0.002 of 2 at the last of three states; 0.25 of the programme.
    let (difference, what) = disagreement(&measured(2.0), &measured(2.002), [1.0, 1.0], 1.0);
    assert!((difference - 1e-3).abs() < 1e-12 && what == "watch 1 at load 1.0000", "{what}");
    let (difference, what) = disagreement(&measured(2.0), &measured(2.002), [1.0, 0.75], 1.0);
    assert!((difference - 0.25).abs() < 1e-12 && what == "the load reached", "{what}");
    assert!(disagreement(&measured(2.0), &measured(f64::NAN), [1.0; 2], 1.0).0.is_nan());

    let (case, variant) = plate();
    let compared = |other: &Ran| {
        let mut row = judged(&case, variant, Backend::Petsc, other);
        compare_solvers(&case, &ran(2.0), other, &mut row);
        row.verdict
    };
    // The case allows 1e-6.
    assert_eq!(
        [2.0, 2.000_001, 2.00001, f64::NAN].map(|v| compared(&ran(v))),
        [OK, OK, FAILED, FAILED]
    );
    assert_eq!(compared(&Ran { ending: "stalled".to_owned(), ..ran(2.0) }), FAILED);
}

/// Other units: a watch of 2 becomes 2000 in a thousandth of the unit, whatever the iterations.
#[test]
fn units_change_numbers_and_not_states() {
    let (case, variant) = plate();
    let done = |name, value| [(name, Backend::Native, Rc::new(ran(value)))];
    let compared = |done: &[Done], case: &StabilityCase, value| {
        let ran = ran(value);
        let mut row = judged(case, variant, Backend::Native, &ran);
        compare_units(case, done, Backend::Native, &ran, &mut row);
        row
    };
    let SameAs { case: name, factor } = case.verify.same_as.clone().unwrap();
    assert_eq!((name.as_str(), factor), ("plate_in_mm", 1e-3));
    // The case allows 1e-6.
    for (value, verdict) in [(0.002, OK), (0.002_000_001, OK), (0.002_000_01, FAILED)] {
        assert_eq!(compared(&done("plate_in_mm", 2.0), &case, value).verdict, verdict);
    }
    let row = compared(&done("plate_in_mm", 2.0), &case, 2.0);
    assert!(row.remark.starts_with("it differs from plate_in_mm by 1.0e3 in watch 1"), "{row:?}");
    assert_eq!(compared(&done("foil", 2.0), &case, 2.0).verdict, OK);
    let ends = Ran { ending: "stalled".to_owned(), ..ran(2.0) };
    let row = compared(&[("plate_in_mm", Backend::Native, Rc::new(ends))], &case, 0.002);
    assert_eq!(row.remark, "plate_in_mm ends as stalled");
}

#[test]
fn columns_stand_below_their_heads() {
    let (case, variant) = plate();
    let mut row = judged(&case, variant, Backend::Native, &ran(2.0));
    (row.newton_iterations, row.error) = (1234, Some(0.125));
    let (head, line) = (heading(), line(&row));
    for (name, cell) in [("load", "1.0000"), ("Newton", "1234"), ("err%", "0.125")] {
        let end = |text: &str, part: &str| text.find(part).unwrap() + part.len();
        assert_eq!(end(&head, name), end(&line, cell), "{name}");
    }
    assert_eq!(head.find("verdict"), line.find(OK));
}
