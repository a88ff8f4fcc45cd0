//! `[gravity]`: the weight of the wall.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::material::within;
use crate::math::Vec3;

/// The weight of the wall.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct GravitySection {
    /// Mass of the wall per volume, g/cm^3: of silicones and printed elastomers about 1.1.
    pub density: f64,
    /// Acceleration, m/s^2; z is the long axis of a closed part.
    #[serde(default = "downwards")]
    pub acceleration: [f64; 3],
}

/// m/s^2.
fn downwards() -> [f64; 3] {
    [0.0, 0.0, -9.81]
}

impl GravitySection {
    /// Checks that its numbers are those of a wall on some planet or centrifuge.
    pub(crate) fn check(self) -> anyhow::Result<()> {
        within("[gravity] density", self.density, 1e-3, 30.0)?;
        for component in self.acceleration {
            within("[gravity] acceleration", component, -1e4, 1e4)?;
        }
        Ok(())
    }

    /// The weight per volume, N/mm^3.
    pub(crate) fn body_force(self) -> Vec3 {
        // 1 g/cm^3 is 1e-6 kg/mm^3, and 1 m/s^2 is 1 N/kg.
        1e-6 * self.density * Vec3::from(self.acceleration)
    }
}
