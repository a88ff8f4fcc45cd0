//! One watched number along a path, and how far it is from its reference.
//!
//! A curve that turns back has several values at a load. It is compared by distance: of each point of the reference from the
//! whole curve, load and value each over the largest of the reference.

use super::verify_section::Reference;
use crate::solve::hermite_basis;

/// A watched number along a path, and between its states by cubics through values and slopes.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct WatchCurve {
    pub points: Vec<CurvePoint>,
}

/// One state of the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CurvePoint {
    pub load: f64,
    pub value: f64,
    /// Derivative of the value with respect to the load.
    pub rate: f64,
}

/// The largest distance between a curve and its reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Deviation {
    /// In % of the largest reference value; of a curve, of the largest load and value.
    pub error: f64,
    /// Where it is that large.
    pub load: f64,
    pub measured: f64,
    pub reference: f64,
    /// The largest distance in % of the reference value at the same load, where that is not near zero; of a curve, the error.
    pub pointwise_error: f64,
}

impl WatchCurve {
    /// The value at `load`; none beyond the ends of the path, whose loads increase.
    pub(crate) fn value_at(&self, load: f64) -> Option<f64> {
        let (first, last) = (self.points.first()?, self.points.last()?);
        // Sample loads are products of rounded numbers.
        let hair = 1e-9 * (last.load - first.load);
        if load < first.load - hair || load > last.load + hair {
            return None;
        }
        let after = self.points.partition_point(|point| point.load < load - hair);
        let b = self.points[after];
        if after == 0 || (b.load - load).abs() <= hair {
            return Some(b.value);
        }
        let a = self.points[after - 1];
        let h = b.load - a.load;
        let s = (load - a.load) / h;
        let [rise, leave, arrive] = hermite_basis(s);
        Some(a.value + (b.value - a.value) * rise + h * (a.rate * leave + b.rate * arrive))
    }

    /// How far the curve is from `reference`; the first load that it does not reach, where there is one.
    pub(crate) fn deviation(&self, reference: &Reference) -> Result<Deviation, f64> {
        if reference.curve {
            return Ok(self.distance(reference));
        }
        let scale = reference.value.iter().fold(0.0_f64, |scale, v| scale.max(v.abs()));
        let mut worst: Option<Deviation> = None;
        let mut pointwise_error = 0.0_f64;
        for (&load, &value) in reference.load.iter().zip(&reference.value) {
            let measured = self.value_at(load).ok_or(load)?;
            // What is not a number is as far as can be.
            let distance = Some((measured - value).abs()).filter(|d| !d.is_nan());
            let distance = distance.unwrap_or(f64::INFINITY);
            let error = 100.0 * distance / scale;
            if value.abs() >= NEAR_ZERO * scale {
                pointwise_error = pointwise_error.max(100.0 * distance / value.abs());
            }
            if worst.is_none_or(|worst| error > worst.error) {
                worst =
                    Some(Deviation { error, load, measured, reference: value, pointwise_error });
            }
        }
        let worst = worst.expect("a reference has at least one value");
        Ok(Deviation { pointwise_error, ..worst })
    }

    /// The largest distance of a point of `reference` from the curve.
    fn distance(&self, reference: &Reference) -> Deviation {
        let largest =
            |numbers: &[f64]| numbers.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
        let scale = [largest(&reference.load), largest(&reference.value)];
        let curve = self.polyline(scale);
        let deviation = |(&load, &value): (&f64, &f64)| {
            let point = [load / scale[0], value / scale[1]];
            let mut nearest = (f64::INFINITY, f64::NAN);
            for ends in curve.windows(2) {
                let on = nearest_on(ends[0], ends[1], point);
                let distance = (on[0] - point[0]).hypot(on[1] - point[1]);
                if distance < nearest.0 {
                    nearest = (distance, on[1] * scale[1]);
                }
            }
            let error = 100.0 * nearest.0;
            Deviation { error, load, measured: nearest.1, reference: value, pointwise_error: error }
        };
        let deviations = reference.load.iter().zip(&reference.value).map(deviation);
        let worst = deviations.max_by(|a, b| a.error.total_cmp(&b.error));
        worst.expect("a reference has at least one value")
    }

    /// Points of the curve as `[load, value]` over `scale`: on the cubics between the states, which leave each along its slope.
    fn polyline(&self, scale: [f64; 2]) -> Vec<[f64; 2]> {
        let place = |point: &CurvePoint| [point.load / scale[0], point.value / scale[1]];
        let mut polyline: Vec<_> = self.points.iter().take(1).map(place).collect();
        for pair in self.points.windows(2) {
            let [a, b] = [place(&pair[0]), place(&pair[1])];
            let chord = [b[0] - a[0], b[1] - a[1]];
            let [from, to] =
                [&pair[0], &pair[1]].map(|p| along(p.rate * scale[0] / scale[1], chord));
            polyline.extend((1..=PIECES).map(|k| {
                let [rise, leave, arrive] = hermite_basis(k as f64 / PIECES as f64);
                [0, 1].map(|i| a[i] + rise * chord[i] + leave * from[i] + arrive * to[i])
            }));
        }
        polyline
    }
}

/// A chord turned into the direction `(1, slope)`, whichever way it points; where there is no slope, the chord.
fn along(slope: f64, chord: [f64; 2]) -> [f64; 2] {
    // At a limit point the slope is infinite.
    let angle = slope.atan();
    if angle.is_nan() {
        return chord;
    }
    let direction = [angle.cos(), angle.sin()];
    let forward = direction[0] * chord[0] + direction[1] * chord[1];
    direction.map(|d| d * chord[0].hypot(chord[1]).copysign(forward))
}

/// The point between `a` and `b` that is nearest to `point`.
fn nearest_on(a: [f64; 2], b: [f64; 2], point: [f64; 2]) -> [f64; 2] {
    let chord = [b[0] - a[0], b[1] - a[1]];
    let square = chord[0] * chord[0] + chord[1] * chord[1];
    let share = (point[0] - a[0]) * chord[0] + (point[1] - a[1]) * chord[1];
    let share = if square > 0.0 { (share / square).clamp(0.0, 1.0) } else { 0.0 };
    [a[0] + share * chord[0], a[1] + share * chord[1]]
}

/// Of the curve between two states: a bend of a right angle is off by a thousandth of the piece's length.
const PIECES: usize = 16;

/// Tables have three or four digits: of a value below this share of the largest, the last digit alone is some percent.
const NEAR_ZERO: f64 = 0.05;

#[cfg(test)]
mod tests {
    use super::*;

    fn cubic() -> WatchCurve {
        let value = |x: f64| 1.0 + x - 2.0 * x * x + 3.0 * x * x * x;
        let rate = |x: f64| 1.0 - 4.0 * x + 9.0 * x * x;
        let point = |load| CurvePoint { load, value: value(load), rate: rate(load) };
        WatchCurve { points: [0.0, 0.3, 1.0].map(point).to_vec() }
    }

    #[test]
    fn a_cubic_is_interpolated_exactly() {
        let curve = cubic();
        for load in [0.0, 0.1, 0.3, 0.7, 1.0, 1.0 + 1e-12] {
            let exact = 1.0 + load - 2.0 * load * load + 3.0 * load * load * load;
            assert!((curve.value_at(load).unwrap() - exact).abs() < 1e-9, "{load}");
        }
        assert_eq!(curve.value_at(1.01), None);
        assert_eq!(curve.value_at(-0.01), None);
    }

    #[test]
    fn the_worst_point_is_named() {
        let reference = Reference {
            watch: "w".to_owned(),
            curve: false,
            load: vec![0.0, 0.3, 1.0],
            value: vec![1.1, 1.0, 4.0],
        };
        let deviation = cubic().deviation(&reference).unwrap();
        // 1 + 0.3 - 0.18 + 0.081 = 1.201 at 0.3; 3 at 1.
        assert_eq!(deviation.load, 1.0);
        assert!((deviation.error - 25.0).abs() < 1e-9 && (deviation.measured - 3.0).abs() < 1e-9);
        assert!((deviation.pointwise_error - 25.0).abs() < 1e-9);
        // 4 % of the largest is near zero, 5 % is not: 1.201 / 0.2 - 1.
        for (value, exact) in [(0.16, 25.0), (0.2, 500.5)] {
            let reference = Reference { value: vec![1.1, value, 4.0], ..reference.clone() };
            let pointwise = cubic().deviation(&reference).unwrap().pointwise_error;
            assert!((pointwise - exact).abs() < 1e-9, "{pointwise}");
        }
        let beyond = Reference { load: vec![0.5, 2.0], value: vec![1.0, 2.0], ..reference };
        assert_eq!(cubic().deviation(&beyond), Err(2.0));
    }

    #[test]
    fn what_is_no_number_is_never_near() {
        let mut curve = cubic();
        curve.points[1].value = f64::NAN;
        let reference = reference(vec![0.3, 1.0], vec![1.2, 3.0]);
        assert_eq!(curve.deviation(&reference).unwrap().error, f64::INFINITY);
        // Both halves of the curve end there.
        let reference = Reference { curve: true, ..reference };
        assert_eq!(curve.deviation(&reference).unwrap().error, f64::INFINITY);
    }

    fn reference(load: Vec<f64>, value: Vec<f64>) -> Reference {
        Reference { watch: "w".to_owned(), curve: false, load, value }
    }

    /// `load = 4 v^3 - 3 v` on `-1..1`: two limit points at loads of 1 and -1, where `v` is -1/2 and 1/2.
    fn turning(states: usize) -> WatchCurve {
        let point = |k: usize| {
            let v = -1.0 + 2.0 * k as f64 / (states - 1) as f64;
            CurvePoint {
                load: 4.0 * v * v * v - 3.0 * v,
                value: v,
                rate: 1.0 / (12.0 * v * v - 3.0),
            }
        };
        WatchCurve { points: (0..states).map(point).collect() }
    }

    /// Loads that turn back are no hindrance, nor are slopes that are infinite, at the limit points. There the curvature is
    /// 12, and cubics over a chord `h` whose ends leave it with its length miss an arc by `12^3 h^4 (1/192 + 1/384)`, and the
    /// pieces of a cubic by `12 (h/16)^2 / 8`; twice that for higher orders. Chords alone would miss it by `12 h^2 / 8`.
    #[test]
    fn a_curve_that_turns_back_is_followed() {
        let values: Vec<f64> = (0..=200).map(|k| -1.0 + 0.01 * f64::from(k)).collect();
        let loads = values.iter().map(|v| 4.0 * v * v * v - 3.0 * v).collect();
        let exact = Reference { curve: true, ..reference(loads, values) };
        for states in [9, 17, 33, 65] {
            let curve = turning(states);
            assert!(curve.points.iter().any(|point| point.rate.is_infinite()));
            let h = 2.0 / (states - 1) as f64;
            let bound = 1728.0 * h.powi(4) / 128.0 + 12.0 * (h / 16.0).powi(2) / 8.0;
            let error = curve.deviation(&exact).unwrap().error;
            assert!(error < 2.0 * 100.0 * bound, "{states}: {error} %, {bound}");
        }
    }

    /// A distance is measured across the curve, in axes over the largest load and value; an end that is missing is missed.
    #[test]
    fn distance_is_across_the_curve() {
        let line = |k: f64| CurvePoint { load: 2.0 * k, value: 30.0 * k, rate: 15.0 };
        let curve = WatchCurve { points: [0.0, 1.0, 2.0].map(line).to_vec() };
        let off = |load: f64, value: f64| {
            let reference = reference(vec![0.0, load, 4.0], vec![0.0, value, 60.0]);
            curve.deviation(&Reference { curve: true, ..reference }).unwrap()
        };
        assert!(off(1.0, 15.0).error < 1e-12);
        // Along the diagonal of the scaled axes: 10 % of the value is 10 % / sqrt 2 away.
        let aside = off(1.0, 21.0);
        assert!((aside.error - 10.0 / 2.0_f64.sqrt()).abs() < 1e-9, "{aside:?}");
        assert!(
            aside.load == 1.0 && aside.reference == 21.0 && (aside.measured - 18.0).abs() < 1e-9
        );
        // 5, 75: a quarter further in both, where these are now the largest.
        let beyond = reference(vec![0.0, 5.0], vec![0.0, 75.0]);
        let beyond = curve.deviation(&Reference { curve: true, ..beyond }).unwrap();
        assert!((beyond.error - 20.0 * 2.0_f64.sqrt()).abs() < 1e-9, "{beyond:?}");
    }
}
