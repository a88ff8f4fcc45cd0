//! Boxes along the axes.

use super::Vec3;

/// A box along the axes; its corners are places or, around vectors, components.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Box3 {
    /// The corner of the least coordinates.
    pub low: Vec3,
    /// The corner of the largest coordinates.
    pub high: Vec3,
}

impl Box3 {
    /// The least box around `points`; around none, from infinity to minus infinity.
    #[must_use]
    pub fn around(points: impl IntoIterator<Item = Vec3>) -> Self {
        let empty =
            Self { low: Vec3::repeat(f64::INFINITY), high: Vec3::repeat(f64::NEG_INFINITY) };
        let add = |sum: Self, x: Vec3| Self { low: sum.low.inf(&x), high: sum.high.sup(&x) };
        points.into_iter().fold(empty, add)
    }

    /// The least box around two boxes.
    #[must_use]
    #[inline]
    pub fn join(&self, other: &Self) -> Self {
        Self { low: self.low.inf(&other.low), high: self.high.sup(&other.high) }
    }

    /// The square of the distance from a point to the box, mm^2; 0 inside.
    #[must_use]
    #[inline]
    pub fn squared_distance(&self, point: Vec3) -> f64 {
        (self.low - point).sup(&(point - self.high)).sup(&Vec3::zeros()).norm_squared()
    }

    /// The square of the distance between two boxes, mm^2; 0 where they overlap.
    #[must_use]
    #[inline]
    pub fn gap_squared(&self, other: &Self) -> f64 {
        let apart = (other.low - self.high).sup(&(self.low - other.high));
        apart.iter().map(|apart| apart.max(0.0) * apart.max(0.0)).sum()
    }

    /// The least product of a vector in one box and a vector in the other.
    #[must_use]
    #[inline]
    pub fn least_dot(&self, other: &Self) -> f64 {
        let least = |axis: usize| {
            let ends = |at: &Self| [at.low[axis], at.high[axis]];
            let [[a, b], [c, d]] = [ends(self), ends(other)];
            (a * c).min(a * d).min(b * c).min(b * d)
        };
        least(0) + least(1) + least(2)
    }

    /// The largest distance between a point of one box and a point of another, mm.
    #[must_use]
    #[inline]
    pub fn reach(&self, other: &Self) -> f64 {
        (other.high - self.low).sup(&(self.high - other.low)).norm()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_of_boxes() {
        let boxes = [[0.0, 1.0], [3.0, 5.0]].map(|range| Box3::around(range.map(Vec3::repeat)));
        assert_eq!(boxes[0].gap_squared(&boxes[1]), 12.0);
        assert_eq!(boxes[0].gap_squared(&boxes[0]), 0.0);
        assert_eq!(boxes[1].squared_distance(Vec3::new(1.0, 4.0, 6.0)), 5.0);
        assert!((boxes[0].reach(&boxes[1]) - 75.0_f64.sqrt()).abs() < 1e-14);
        let either = Box3::around([Vec3::new(-1.0, 2.0, 0.0), Vec3::new(3.0, 4.0, 0.5)]);
        assert_eq!(either.least_dot(&boxes[1]), -5.0 + 6.0);
    }
}
