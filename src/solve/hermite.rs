//! Between two points of a path, and a step ahead of them: Hermite's cubics through states and rates.

use super::path::PathPoint;
use super::vectors::dot;

/// A step of state and load along the tangent.
pub(super) fn tangent_step(last: &PathPoint, step: f64) -> (Vec<f64>, f64) {
    (last.rate.iter().map(|rate| step * rate).collect(), step * last.load_rate)
}

/// The step along the cubic through two states with their rates.
pub(super) fn cubic_step(before: &PathPoint, last: &PathPoint, step: f64) -> (Vec<f64>, f64) {
    let h = last.drive - before.drive;
    let s = (h + step) / h;
    // From the last state on, so that nothing large cancels.
    let [rise, leave, arrive] = hermite_basis(s);
    let (at_before, rate_before, rate_last) = (1.0 - rise, h * leave, h * arrive);
    let at = |a: f64, b: f64, rate_a: f64, rate_b: f64| {
        at_before * (a - b) + rate_before * rate_a + rate_last * rate_b
    };
    let dx = (0..last.x.len())
        .map(|i| at(before.x[i], last.x[i], before.rate[i], last.rate[i]))
        .collect();
    (dx, at(before.load, last.load, before.load_rate, last.load_rate))
}

/// `int load dC` between two states.
pub(super) fn work_between(a: &PathPoint, b: &PathPoint) -> f64 {
    let rise = b.conjugate - a.conjugate;
    let [from, to] = Segment::between(a, b).scales;
    let load = Cubic { ends: [a.load, b.load], slopes: [from * a.load_rate, to * b.load_rate] };
    // Relative to a's conjugate, so that nothing large cancels.
    let conjugate =
        Cubic { ends: [0.0, rise], slopes: [from * a.conjugate_rate, to * b.conjugate_rate] };
    // Gauss's three points are exact for the fifth degree.
    let half = 0.5 * 0.6_f64.sqrt();
    [(0.5 - half, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.5 + half, 5.0 / 18.0)]
        .iter()
        .map(|&(s, weight)| weight * load.at(s) * conjugate.slope(s))
        .sum()
}

/// `int load dC` between two states, the load a cubic of the conjugate `C`.
pub(super) fn work_by_conjugate(a: &PathPoint, b: &PathPoint) -> f64 {
    let rise = b.conjugate - a.conjugate;
    let stiffness = |point: &PathPoint| point.load_rate / point.conjugate_rate;
    // The integral of Hermite's cubic.
    rise * (0.5 * (a.load + b.load) + rise / 12.0 * (stiffness(a) - stiffness(b)))
}

/// `int load dC` of a jump from one state to another.
pub(super) fn work_at_once(a: &PathPoint, b: &PathPoint) -> f64 {
    0.5 * (a.load + b.load) * (b.conjugate - a.conjugate)
}

/// The part of a path between two of its points, as a curve over 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// What turns the rates at the two ends into derivatives by that parameter.
    pub scales: [f64; 2],
}

impl Segment {
    /// The segment from `a` to `b`.
    #[must_use]
    pub fn between(a: &PathPoint, b: &PathPoint) -> Self {
        if a.on_arc == b.on_arc {
            return Self { scales: [b.drive - a.drive; 2] };
        }
        let chord: Vec<f64> = b.x.iter().zip(&a.x).map(|(b, a)| b - a).collect();
        let square = dot(&chord, &chord);
        Self { scales: [a, b].map(|point| square / dot(&point.rate, &chord)) }
    }
}

/// Hermite's basis at `s`: the factors of the difference between the ends of a cubic over 0 to 1, of
/// its slope at 0 and of its slope at 1. Beyond that range it extrapolates.
#[must_use]
pub fn hermite_basis(s: f64) -> [f64; 3] {
    let (s2, s3) = (s * s, s * s * s);
    [3.0 * s2 - 2.0 * s3, s3 - 2.0 * s2 + s, s3 - s2]
}

/// A cubic over 0 to 1 by its ends and slopes there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cubic {
    /// Values at 0 and 1.
    pub ends: [f64; 2],
    /// Derivatives at 0 and 1.
    pub slopes: [f64; 2],
}

impl Cubic {
    /// The value at `s`.
    #[must_use]
    pub fn at(&self, s: f64) -> f64 {
        let [a, b] = self.ends;
        let [da, db] = self.slopes;
        let [rise, leave, arrive] = hermite_basis(s);
        a + (b - a) * rise + da * leave + db * arrive
    }

    /// The derivative at `s`.
    #[must_use]
    pub fn slope(&self, s: f64) -> f64 {
        let [a, b] = self.ends;
        let [da, db] = self.slopes;
        6.0 * (b - a) * (s - s * s)
            + da * (3.0 * s * s - 4.0 * s + 1.0)
            + db * (3.0 * s * s - 2.0 * s)
    }
}
