//! Where a path first loses its stability under a given load.

use super::Ending;
use super::hermite::{Cubic, Segment};
use super::path::{Path, PathPoint};

impl Path {
    /// The load at which the path first loses its stability under a given load: at a limit point or a bifurcation;
    /// `None` where it never does, or ends for another reason.
    #[must_use]
    pub fn limit_load(&self) -> Option<f64> {
        let lost = self.points.windows(2).find_map(|pair| between(&pair[0], &pair[1]));
        let is_limit = self.fell || matches!(self.ending, Ending::LimitPoint | Ending::Unstable);
        lost.or_else(|| self.points.last().filter(|_| is_limit).map(|last| last.load))
    }
}

/// The load between two points where stability is lost, if it is.
fn between(a: &PathPoint, b: &PathPoint) -> Option<f64> {
    let bracketed = 0.5 * (a.load + b.load);
    let scales = Segment::between(a, b).scales;
    let slopes = [scales[0] * a.load_rate, scales[1] * b.load_rate];
    if b.snap.is_some() {
        Some(bracketed)
    } else if slopes[0] * slopes[1] < 0.0 {
        Some(extremum(&Cubic { ends: [a.load, b.load], slopes }))
    } else if a.negative_pivots == 0 && b.negative_pivots > 0 {
        Some(bracketed)
    } else {
        None
    }
}

/// The value where the slope, which has opposite signs at the ends, vanishes.
fn extremum(cubic: &Cubic) -> f64 {
    let rises = cubic.slope(0.0) > 0.0;
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if (cubic.slope(middle) > 0.0) == rises {
            low = middle;
        } else {
            high = middle;
        }
    }
    cubic.at(low)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve::{Snap, SolveCounts};

    fn point(drive: f64, load: f64, load_rate: f64) -> PathPoint {
        PathPoint { load, load_rate, ..PathPoint::at_rest(drive, 0) }
    }

    fn limit(points: Vec<PathPoint>, ending: Ending) -> Option<f64> {
        let counts = SolveCounts::default();
        Path { points, ending, place: None, fell: false, counts }.limit_load()
    }

    /// `1 - (s - 1)^2` has its top at 1, between the points 0.8 and 1.5.
    #[test]
    fn top_of_a_curve_is_interpolated() {
        let load = |s: f64| point(s, 1.0 - (s - 1.0) * (s - 1.0), -2.0 * (s - 1.0));
        let found = limit([0.0, 0.8, 1.5].map(load).to_vec(), Ending::Reached);
        // A cubic through a parabola is exact.
        assert!((found.unwrap() - 1.0).abs() < 1e-12, "{found:?}");
    }

    #[test]
    fn only_an_instability_is_a_limit_load() {
        let path = || [0.0, 0.5, 0.75].map(|load| point(load, load, 1.0)).to_vec();
        for ending in [Ending::LimitPoint, Ending::Unstable] {
            assert_eq!(limit(path(), ending), Some(0.75));
            assert_eq!(limit(Vec::new(), ending), None);
        }
        for ending in [Ending::Reached, Ending::Inverted, Ending::Stalled, Ending::BudgetSpent] {
            assert_eq!(limit(path(), ending), None);
            let mut snapped = path();
            snapped[2].snap = Some(Snap { released: 1.0, from_bifurcation: false });
            assert_eq!(limit(snapped, ending), Some(0.625));
            let mut lost = path();
            lost[1].negative_pivots = 1;
            assert_eq!(limit(lost, ending), Some(0.25));
        }
    }
}
