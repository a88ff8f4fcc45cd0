//! What a run may ask besides the two objectives of Smith et al. (2022): each a file beside this one, and a line in the list.

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize};

use super::Observation;
use crate::mesh::ShellMesh;

macro_rules! further_objectives {
    ($($file:ident,)+) => {
        $(mod $file;)+
        /// All that a run may ask besides bending and blocking.
        const FURTHER: &[FurtherObjective] = &[$($file::OBJECTIVE,)+];
    };
}

// Each a file beside this one, and a line here.
further_objectives! {
    wall_volume,
}

/// What an objective is read off: a part and its two walked scenarios.
#[derive(Clone, Copy, Debug)]
pub struct Reading<'a> {
    /// The part at rest.
    pub shell: &'a ShellMesh,
    /// Rows of the path with nothing in the way.
    pub free: &'a [Observation],
    /// Rows of the path with the plane in the way.
    pub blocked: &'a [Observation],
}

/// Which values of an objective are good.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sense {
    /// Large ones.
    Largest,
    /// Small ones.
    Least,
}

/// An objective besides bending and blocking; in files it is its name.
#[derive(Clone, Copy, Debug, Serialize)]
#[serde(into = "String")]
pub struct FurtherObjective {
    /// Its name in run files and tables.
    pub name: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Which values are good.
    pub sense: Sense,
    /// From where the hypervolume is measured: a design that is worse adds nothing to it.
    pub worst: f64,
    /// Its value for a design.
    pub value: fn(&Reading<'_>) -> f64,
}

impl FurtherObjective {
    /// `value` as a search sees it, which makes everything small.
    #[must_use]
    pub fn minimized(&self, value: f64) -> f64 {
        match self.sense {
            Sense::Largest => -value,
            Sense::Least => value,
        }
    }
}

/// There is no objective of that name.
#[derive(Debug, thiserror::Error)]
#[error("`{name}` is no further objective; those are {}", names().join(", "))]
pub struct UnknownObjective {
    name: String,
}

fn names() -> Vec<&'static str> {
    FURTHER.iter().map(|objective| objective.name).collect()
}

impl TryFrom<String> for FurtherObjective {
    type Error = UnknownObjective;

    fn try_from(name: String) -> Result<Self, UnknownObjective> {
        let named = FURTHER.iter().find(|objective| objective.name == name);
        named.copied().ok_or(UnknownObjective { name })
    }
}

// By hand: derived, it would borrow the names from what is read.
impl<'de> Deserialize<'de> for FurtherObjective {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        String::deserialize(deserializer)?.try_into().map_err(D::Error::custom)
    }
}

impl From<FurtherObjective> for String {
    fn from(objective: FurtherObjective) -> Self {
        objective.name.to_owned()
    }
}

impl PartialEq for FurtherObjective {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A column of a table is one objective, and a front is bounded by what is worst.
    #[test]
    fn objectives_are_told_apart() {
        let mut columns = names();
        columns.extend(["bending", "blocking", "figure_of_merit", "max_force", "flags", "id"]);
        let count = columns.len();
        columns.sort_unstable();
        columns.dedup();
        assert_eq!(columns.len(), count, "two columns have one name");
        for objective in FURTHER {
            assert!(objective.worst.is_finite() && !objective.unit.is_empty(), "{objective:?}");
            let read: FurtherObjective = objective.name.to_owned().try_into().unwrap();
            assert_eq!(read, *objective);
        }
        let unknown = FurtherObjective::try_from("beauty".to_owned()).unwrap_err().to_string();
        assert!(unknown.contains("`beauty`") && unknown.contains("wall_volume"), "{unknown}");
    }
}
