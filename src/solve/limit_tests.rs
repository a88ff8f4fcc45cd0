//! Paths of the systems of [`super::path_tests`] that end at the limit of a material.

use super::path_tests::{LIMIT, Plain, along_x, bistable, sphere, volume_of_sphere};
use super::{Ending, Path, PathSettings, Programme, Supply};

/// The load of the thin sphere at the stretch `l`.
fn pressure(l: f64) -> f64 {
    4.0 / 3.0 * (1.0 / l - l.powi(-7))
}

/// The paths of the sphere that may be stretched to `l`.
fn spheres(l: f64, programme: impl Into<Programme> + Copy) -> Vec<Path> {
    let mut system = Plain::new(sphere, volume_of_sphere);
    system.limit = Some((5.0, crate::model::system::LimitKind::Ballooning));
    system.allowed = Some(l - 1.0);
    system.paths(programme, &PathSettings::default())
}

/// The last state is at the limit to 1e-4 of it, on the safe side, and so is the load, to the share that the part's stiffness makes of
/// that; wherever the limit lies between two samples, in the first step too, and however long a step would be.
#[test]
fn a_path_ends_at_the_limit() {
    for l in [1.001, 1.05, 1.2, 1.3, 1.35] {
        for load in [0.9, 1.2, 8.0] {
            for path in spheres(l, load) {
                assert_eq!(
                    (path.ending, path.place, path.fell),
                    (Ending::LimitReached, Some(0), false)
                );
                let last = path.points.last().unwrap();
                let share = last.x[0] / (l - 1.0);
                assert!((1.0 - 1e-4..=1.0).contains(&share), "{share}");
                // The sphere gives way: its load is known better than its stretch.
                assert!((last.load / pressure(l) - 1.0).abs() < 1e-4, "{} {l}", last.load);
                assert!(last.is_sample && last.is_stable);
                assert!(path.points.iter().all(|point| point.x[0] <= l - 1.0));
                let audit = last.work - last.stored_energy;
                assert!(audit.abs() < 1e-3 * last.work, "{audit}");
            }
        }
    }
}

/// Just before its maximum the load hardly tells the stretch: the limit is found all the same. Just behind it is never reached, as the
/// part balloons first; nor is a limit that the largest load does not come to.
#[test]
fn a_limit_behind_the_limit_point_comes_too_late() {
    let at_peak = 7.0_f64.powf(1.0 / 6.0);
    for load in [1.2, 3.0] {
        for path in spheres(at_peak - 0.005, load) {
            assert_eq!((path.ending, path.fell), (Ending::LimitReached, false));
            let last = path.points.last().unwrap();
            assert!((last.x[0] / (at_peak - 1.005) - 1.0).abs() < 1e-4, "{:?}", last.x);
        }
        for l in [at_peak + 0.005, 2.0] {
            for path in spheres(l, load) {
                assert_eq!((path.ending, path.fell), (Ending::Ballooning, true));
                assert!(path.points.last().unwrap().x[0] < at_peak - 1.0);
            }
        }
    }
    for path in spheres(1.3, 0.5) {
        assert_eq!(path.ending, Ending::Reached);
    }
}

/// Where the volume is given, or the whole curve is traced, the limit behind the maximum of the load is one of the path: it ends there.
#[test]
fn a_given_volume_and_a_curve_end_at_the_limit() {
    let volume = Programme::Driven { supply: Supply::Conjugate, end: 26.0 };
    for (programme, l) in [(volume, 1.2), (volume, 2.0), (Programme::Curve { end: 3.0 }, 2.0)] {
        for path in spheres(l, programme) {
            assert_eq!(path.ending, Ending::LimitReached, "{l}");
            let last = path.points.last().unwrap();
            let share = last.x[0] / (l - 1.0);
            assert!((1.0 - 1e-4..=1.0).contains(&share), "{share}");
            // Along the arc Newton's tolerance is one of forces.
            assert!((last.load / pressure(l) - 1.0).abs() < 1e-3, "{} {l}", last.load);
        }
    }
}

/// A snap to a state past the limit ends the path before it; one to a state within it does not. What is passed on the way does not count.
#[test]
fn a_snap_over_the_limit_ends_the_path_before_it() {
    let snapped = |allowed: f64| {
        let mut system = Plain::new(bistable, along_x);
        system.allowed = Some(allowed);
        system.paths(0.6, &PathSettings::default())
    };
    // Before the snap `x` is less than 0.43, after it more than 2.15.
    for path in snapped(1.0) {
        assert_eq!((path.ending, path.fell), (Ending::LimitReached, true));
        let last = path.points.last().unwrap();
        assert!(last.load < LIMIT && LIMIT - last.load < 0.6 / 160.0, "{}", last.load);
        assert_eq!(path.snaps().count(), 0);
    }
    for path in snapped(2.18) {
        assert_eq!((path.ending, path.fell), (Ending::LimitReached, false));
        assert_eq!(path.snaps().count(), 1);
        let last = path.points.last().unwrap();
        let s: f64 = 2.18 - 1.0;
        assert!((last.load / (s.powi(3) - s) - 1.0).abs() < 1e-3, "{}", last.load);
    }
    for path in snapped(2.3) {
        assert_eq!(path.ending, Ending::SnappedAndContinued);
    }
}

/// A wall that is past its limit at rest has no path.
#[test]
fn a_limit_below_rest_leaves_no_path() {
    fn pushed([x, y]: [f64; 2]) -> super::path_tests::Jet {
        let value = (x - 0.3).powi(2) / 2.0 + y * y / 2.0;
        super::path_tests::Jet { value, gradient: [x - 0.3, y], hessian: [1.0, 0.0, 1.0] }
    }
    let mut system = Plain::new(pushed, along_x);
    system.allowed = Some(0.2);
    for path in system.paths(1.0, &PathSettings::default()) {
        assert_eq!((path.ending, path.points.len()), (Ending::LimitReached, 0));
    }
}
