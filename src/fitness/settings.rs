//! What a run asks of its designs.

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize};

use super::objective::{Objective, UnknownObjective, always_asked, by_name};
use super::scenario::{Scenario, with_origins};
use crate::math::Vec3;
use crate::model::contact::PlaneSettings;

/// What the objectives ask.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct FitnessSettings {
    /// Exponent of the work in `F_c`.
    pub exponent: f64,
    /// Normal of the blocking plane, pointing towards the part.
    pub plane_normal: [f64; 3],
    /// Distance of the plane from the outermost point of the outer wall at rest, mm.
    pub plane_distance: f64,
    /// Whether a design with an `Exploit` is rejected instead of flagged.
    pub exclude_exploits: bool,
    /// What is asked besides bending and blocking.
    #[schemars(with = "Vec<String>")]
    #[serde(deserialize_with = "further_objectives")]
    pub further_objectives: Vec<Objective>,
}

impl Default for FitnessSettings {
    /// The plane 5 mm from the -x side, to which the published seed bends.
    fn default() -> Self {
        Self {
            exponent: 3.0,
            plane_normal: [1.0, 0.0, 0.0],
            plane_distance: 5.0,
            exclude_exploits: false,
            further_objectives: Vec::new(),
        }
    }
}

impl FitnessSettings {
    /// The objectives that a design is judged by, in their order: those of every run, then the further ones.
    pub fn objectives(&self) -> impl Iterator<Item = &Objective> {
        let always = always_asked().map(|objective: &Objective| objective);
        always.chain(&self.further_objectives)
    }

    /// The scenarios that the objectives are read off, each after the one that it branches off from.
    #[must_use]
    pub fn scenarios(&self) -> Vec<Scenario> {
        with_origins(self.objectives().filter_map(|objective| objective.scenario))
    }

    /// A plane at the distance of the run file, on the side that `direction` (1 or -1, times the normal of the run file) points away
    /// from, with its barrier fit for `pressure` (MPa).
    #[must_use]
    pub fn plane(&self, direction: f64, pressure: f64) -> PlaneSettings {
        let normal = Vec3::from(self.plane_normal).normalize() * direction;
        PlaneSettings::new(normal, self.plane_distance, pressure)
    }
}

/// Reads the names of objectives that are asked by name.
fn further_objectives<'de, D: Deserializer<'de>>(reader: D) -> Result<Vec<Objective>, D::Error> {
    let named = Vec::<Named>::deserialize(reader)?;
    Ok(named.into_iter().map(|Named(objective)| objective).collect())
}

/// An objective as run files name it.
#[derive(Deserialize)]
#[serde(try_from = "String")]
struct Named(Objective);

impl TryFrom<String> for Named {
    type Error = UnknownObjective;

    fn try_from(name: String) -> Result<Self, UnknownObjective> {
        by_name(&name).map(Self)
    }
}
