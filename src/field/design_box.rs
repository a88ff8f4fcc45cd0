//! The box in which an actuator's mid-surface must lie.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::math::Vec3;

/// A box with sides along the axes, mm; z is the long axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "Corners", into = "Corners")]
pub struct DesignBox {
    min: Vec3,
    max: Vec3,
}

/// Two corners that are not a box.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("the design box from {min:?} to {max:?} is not a box: each min must be below its max")]
pub struct DesignBoxError {
    min: [f64; 3],
    max: [f64; 3],
}

/// As written in a run file.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct Corners {
    /// The corner with the smallest x, y and z, mm.
    min: [f64; 3],
    /// The corner with the largest, mm.
    max: [f64; 3],
}

impl DesignBox {
    /// The box between two corners, mm.
    ///
    /// # Errors
    /// [`DesignBoxError`] unless every `min < max` and all are finite.
    pub fn new(min: Vec3, max: Vec3) -> Result<Self, DesignBoxError> {
        let is_interval = |i: usize| min[i].is_finite() && max[i].is_finite() && min[i] < max[i];
        if (0..3).all(is_interval) {
            return Ok(Self { min, max });
        }
        Err(DesignBoxError { min: min.into(), max: max.into() })
    }

    /// The corner with the least coordinates, mm.
    #[must_use]
    pub fn min(&self) -> Vec3 {
        self.min
    }

    /// The corner with the greatest coordinates, mm.
    #[must_use]
    pub fn max(&self) -> Vec3 {
        self.max
    }

    /// The three side lengths, mm.
    #[must_use]
    pub fn sides(&self) -> Vec3 {
        self.max - self.min
    }

    /// For each axis, the signed distance to the nearer of its two faces, mm, negative inside,
    /// and the sign of that face's outward normal.
    pub(super) fn face_distances(&self, point: Vec3) -> [(f64, f64); 3] {
        std::array::from_fn(|i| {
            let [below, above] = [self.min[i] - point[i], point[i] - self.max[i]];
            if above >= below { (above, 1.0) } else { (below, -1.0) }
        })
    }
}

/// +-20 mm x +-20 mm x 62.8 mm: half as wide as CPPN2sim's box, as long as its 2 pi cm.
impl Default for DesignBox {
    fn default() -> Self {
        Self { min: Vec3::new(-20.0, -20.0, 0.0), max: Vec3::new(20.0, 20.0, 62.8) }
    }
}

impl TryFrom<Corners> for DesignBox {
    type Error = DesignBoxError;

    fn try_from(corners: Corners) -> Result<Self, DesignBoxError> {
        Self::new(corners.min.into(), corners.max.into())
    }
}

impl From<DesignBox> for Corners {
    fn from(design_box: DesignBox) -> Self {
        Self { min: design_box.min.into(), max: design_box.max.into() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_is_read_from_its_corners_and_nothing_else() {
        let text = "min = [-1, -2, 0]\nmax = [1, 2, 30]\n";
        let design_box: DesignBox = toml::from_str(text).unwrap();
        assert_eq!(design_box.sides(), Vec3::new(2.0, 4.0, 30.0));
        for (from, to) in [("max = [1", "max = [-1"), ("30", "nan"), ("max", "top")] {
            assert!(toml::from_str::<DesignBox>(&text.replace(from, to)).is_err(), "{to}");
        }
    }

    #[test]
    fn the_nearer_face_counts() {
        let distances = DesignBox::default().face_distances(Vec3::new(-19.0, 22.0, 1.0));
        assert_eq!(distances, [(-1.0, -1.0), (2.0, 1.0), (-1.0, -1.0)]);
    }
}
