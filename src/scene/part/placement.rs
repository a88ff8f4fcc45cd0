//! How a part of one's own lies in the space of the computation: turned, scaled, and near the origin.
//!
//! ```text
//! X = s R x - c      R: the turn that brings `axis` to z      s: `scale`      c: `moved`, whole mm, zero for a part near the origin
//! ```
//! Coordinates of the size of the part lose fewest digits: at 30 m a part of 80 mm has lost three of sixteen. What is written is
//! moved back by `c`. An STL file itself keeps seven digits: 2e-3 mm at 30 m.

use anyhow::bail;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Part;
use crate::math::Vec3;

/// The direction in a file that is the part's long axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub(crate) enum Axis {
    #[serde(rename = "x")]
    X,
    #[serde(rename = "-x")]
    MinusX,
    #[serde(rename = "y")]
    Y,
    #[serde(rename = "-y")]
    MinusY,
    #[default]
    #[serde(rename = "z")]
    Z,
    #[serde(rename = "-z")]
    MinusZ,
}

impl Axis {
    /// `x` turned so that this axis points along z.
    fn turned(self, x: Vec3) -> Vec3 {
        match self {
            Self::X => Vec3::new(x.y, x.z, x.x),
            Self::MinusX => Vec3::new(x.y, -x.z, -x.x),
            Self::Y => Vec3::new(x.z, x.x, x.y),
            Self::MinusY => Vec3::new(x.z, -x.x, -x.y),
            Self::Z => x,
            Self::MinusZ => Vec3::new(x.x, -x.y, -x.z),
        }
    }
}

/// Where a part was put.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Placed {
    /// What was taken from its turned and scaled positions, mm.
    pub moved: Vec3,
}

impl Placed {
    /// Turns, scales and moves the `positions` of a file as the `part` says.
    pub(crate) fn new(part: &Part, positions: &mut [Vec3]) -> Self {
        let (axis, scale) = (part.axis.unwrap_or_default(), part.scale.unwrap_or(1.0));
        if axis != Axis::Z || scale != 1.0 {
            positions.iter_mut().for_each(|x| *x = scale * axis.turned(*x));
        }
        let Some((lower, upper)) = bounds(positions) else { return Self::default() };
        // From the origin to the box; 0 inside.
        let distance = lower.sup(&-upper).sup(&Vec3::zeros()).norm();
        if distance <= FARTHEST * (upper - lower).norm() {
            return Self::default();
        }
        let moved = (0.5 * (lower + upper)).map(f64::round);
        positions.iter_mut().for_each(|x| *x -= moved);
        Self { moved }
    }
}

impl Placed {
    /// Moves `positions` back to where the file has them, turned and scaled.
    pub(crate) fn put_back(self, positions: &mut [Vec3]) {
        if self != Self::default() {
            positions.iter_mut().for_each(|x| *x += self.moved);
        }
    }
}

/// Refuses a part of the file `name` between `bounds` that is no larger than its wall of `thickness` (mm), and tells of one that does
/// not lie along z.
pub(crate) fn check_size(
    name: &str,
    part: &Part,
    bounds: (Vec3, Vec3),
    thickness: f64,
) -> anyhow::Result<Option<String>> {
    let size = bounds.1 - bounds.0;
    let longest = size.max();
    if longest < LEAST_LENGTH * thickness {
        let advice = if part.scale.is_none() { "in metres or inches" } else { "in other units" };
        bail!(
            "{name}: the part is {longest:.3} mm long and its wall {thickness:.3} mm thick; is the file {advice}? see [part] scale and [wall] thickness"
        );
    }
    if size.z * LONGER_THAN_Z >= longest || part.axis.is_some() {
        return Ok(None);
    }
    let letter = ["x", "y", "z"][size.imax()];
    Ok(Some(format!(
        "{name}: the part is longest along {letter} ({longest:.1} mm; {:.1} mm along z), but is clamped at its lowest z; does it want [part] axis = \"{letter}\"?",
        size.z
    )))
}

/// The lower and upper corner of the box around `positions`; none where there are none.
pub(crate) fn bounds(positions: &[Vec3]) -> Option<(Vec3, Vec3)> {
    let first = *positions.first()?;
    Some(positions.iter().fold((first, first), |(lower, upper), x| (lower.inf(x), upper.sup(x))))
}

/// Farther from the origin than this, in diagonals of its box, a part is moved: at one it still lies beside the origin, as parts
/// of an assembly do.
const FARTHEST: f64 = 1.0;
/// Of a part, in thicknesses: shorter, there is nothing between the clamp of 1.5 and the tip.
const LEAST_LENGTH: f64 = 2.0;
/// What counts as longer along another axis than along z.
const LONGER_THAN_Z: f64 = 1.01;

#[cfg(test)]
mod tests {
    use super::*;

    /// Turned, the axis is z, lengths are kept and right hands stay right hands.
    #[test]
    fn turns_are_turns() {
        let axes = [
            (Axis::X, Vec3::x()),
            (Axis::MinusX, -Vec3::x()),
            (Axis::Y, Vec3::y()),
            (Axis::MinusY, -Vec3::y()),
            (Axis::Z, Vec3::z()),
            (Axis::MinusZ, -Vec3::z()),
        ];
        for (axis, along) in axes {
            assert_eq!(axis.turned(along), Vec3::z(), "{axis:?}");
            let [x, y, z] = [Vec3::x(), Vec3::y(), Vec3::z()].map(|e| axis.turned(e));
            assert_eq!(x.cross(&y), z, "{axis:?}");
        }
    }

    /// Parts near the origin keep their bits; others are moved by whole millimetres.
    #[test]
    fn only_what_is_far_is_moved() {
        let part = Part::default();
        let box_at = |x: f64| vec![Vec3::new(x, 0.1, 0.2), Vec3::new(x + 8.0, 6.1, 80.2)];
        for x in [-4.0, 0.0, 80.0, -88.0] {
            let mut positions = box_at(x);
            assert_eq!(Placed::new(&part, &mut positions), Placed::default());
            assert_eq!(positions, box_at(x));
        }
        let mut positions = box_at(30_000.25);
        let placed = Placed::new(&part, &mut positions);
        assert_eq!(placed.moved, Vec3::new(30_004.0, 3.0, 40.0));
        assert_eq!(positions[0].x, -3.75);
    }

    #[test]
    fn sizes_and_axes_are_looked_at() {
        let check = |size: Vec3, part: &Part| check_size("a.stl", part, (Vec3::zeros(), size), 1.6);
        let part = Part::default();
        assert!(check(Vec3::new(16.0, 16.0, 80.0), &part).unwrap().is_none());
        let told = check(Vec3::new(80.0, 16.0, 12.0), &part).unwrap().unwrap();
        assert!(told.contains("longest along x (80.0 mm; 12.0 mm along z)"), "{told}");
        let meant = Part { axis: Some(Axis::Z), ..Part::default() };
        assert!(check(Vec3::new(80.0, 16.0, 12.0), &meant).unwrap().is_none());
        let refused = check(Vec3::new(0.016, 0.016, 0.08), &part).unwrap_err().to_string();
        assert!(
            refused.contains("0.080 mm long and its wall 1.600 mm thick; is the file in metres")
        );
    }
}
