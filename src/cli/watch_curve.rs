//! One watched number along a path, and how far it is from its reference.

use super::verify_section::Reference;

/// A watched number at increasing loads, and between them by the cubic through values and slopes.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct WatchCurve {
    pub points: Vec<CurvePoint>,
}

/// One state of the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CurvePoint {
    pub load: f64,
    pub value: f64,
    /// Derivative of the value with respect to the load.
    pub rate: f64,
}

/// The largest distance between a curve and its reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Deviation {
    /// In % of the largest reference value.
    pub error: f64,
    /// Where it is that large.
    pub load: f64,
    pub measured: f64,
    pub reference: f64,
    /// The largest distance in % of the reference value at the same load, where that is not near zero.
    pub pointwise_error: f64,
}

impl WatchCurve {
    /// The value at `load`; none beyond the ends of the path.
    pub(super) fn value_at(&self, load: f64) -> Option<f64> {
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
        let (s2, s3) = (s * s, s * s * s);
        Some(
            a.value
                + (b.value - a.value) * (3.0 * s2 - 2.0 * s3)
                + h * (a.rate * (s3 - 2.0 * s2 + s) + b.rate * (s3 - s2)),
        )
    }

    /// How far the curve is from `reference`; the first load that it does not reach, where there is one.
    pub(super) fn deviation(&self, reference: &Reference) -> Result<Deviation, f64> {
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
}

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
        let reference =
            Reference { watch: "w".to_owned(), load: vec![0.3, 1.0], value: vec![1.2, 3.0] };
        assert_eq!(curve.deviation(&reference).unwrap().error, f64::INFINITY);
    }
}
