//! What a design is judged by: each a file beside this one, and a line in the list.

use serde::Serialize;

use super::part::Part;
use super::scenario::Scenario;
use super::walk::Walked;
use super::{FitnessSettings, Observation};

macro_rules! objectives {
    ($($file:ident,)+) => {
        $(mod $file;)+
        /// All objectives, those of every run first.
        pub const OBJECTIVES: &[Objective] = &[$($file::OBJECTIVE,)+];
    };
}

// Each a file beside this one, and a line here.
objectives! {
    bending,
    blocking,
    wall_volume,
    blocking_back,
}

/// What an objective is read off: a part and its walked scenarios.
#[derive(Clone, Copy)]
pub struct Reading<'a> {
    /// The part, a shell or a solid.
    pub part: &'a dyn Part,
    /// What was asked.
    pub settings: &'a FitnessSettings,
    /// The scenarios that were walked.
    pub walked: &'a [Walked],
    /// The one pressure at which it is read, MPa; none where it is read over all of the paths.
    pub at: Option<f64>,
}

impl<'a> Reading<'a> {
    /// The rows of the path of `scenario`, the one at a given pressure alone; none where it was not walked.
    #[must_use]
    pub fn rows(&self, scenario: &Scenario) -> &'a [Observation] {
        let walked = self.walked.iter().find(|walked| walked.scenario == *scenario);
        let rows = walked.map_or(&[][..], |walked| &walked.rows);
        let Some(pressure) = self.at else { return rows };
        let place = rows.iter().rposition(|row| row.is_sample && row.pressure == pressure);
        place.map_or(&[], |place| &rows[place..=place])
    }
}

/// Rows of a path with the value of an objective at each.
pub type Samples<'a> = Vec<(&'a Observation, f64)>;

/// Which values of an objective are good.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sense {
    /// Large ones.
    Largest,
    /// Small ones.
    Least,
}

/// Which runs are judged by an objective.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Asked {
    /// All.
    Always,
    /// Those whose run file names it.
    ByName,
}

/// How an objective is computed.
#[derive(Clone, Copy, Debug)]
pub enum Value {
    /// A number of the part and its paths.
    Number(fn(&Reading<'_>) -> f64),
    /// The largest of the numbers at the samples of a path, at least 0.
    LargestOf(for<'a> fn(&Reading<'a>) -> Samples<'a>),
}

/// What a design is judged by; in files it is its name.
#[derive(Clone, Copy, Debug, Serialize)]
#[serde(into = "String")]
pub struct Objective {
    /// Its name in files.
    pub name: &'static str,
    /// Its symbol, where it has one.
    pub symbol: Option<&'static str>,
    /// Its unit.
    pub unit: &'static str,
    /// Whether the unit is told in a sentence, and not in tables and figures alone.
    pub is_unit_told: bool,
    /// Decimals that tell designs apart.
    pub decimals: usize,
    /// Which values are good.
    pub sense: Sense,
    /// From where the hypervolume is measured: a design that is worse adds nothing to it.
    pub worst: f64,
    /// Which runs are judged by it.
    pub asked: Asked,
    /// The scenario that it is read off, where it is not read off the part at rest.
    pub scenario: Option<Scenario>,
    /// By what it judges a design, in words.
    pub judged_by: fn(&FitnessSettings) -> String,
    /// Whether it is a quotient by the work: it is doubted where next to no work was done.
    pub is_per_work: bool,
    /// Its value for a design.
    pub value: Value,
}

impl Objective {
    /// Its value for a design.
    #[must_use]
    pub fn value(&self, reading: &Reading<'_>) -> f64 {
        match self.value {
            Value::Number(value) => value(reading),
            Value::LargestOf(samples) => {
                samples(reading).iter().map(|(_, value)| *value).fold(0.0, f64::max)
            }
        }
    }

    /// `value` as a search sees it, which makes everything small; also back again.
    #[must_use]
    pub fn minimized(&self, value: f64) -> f64 {
        match self.sense {
            Sense::Largest => -value,
            Sense::Least => value,
        }
    }

    /// The best of `values`, which are as a search sees them; the worst where there are none.
    #[must_use]
    pub fn best_of(&self, values: impl Iterator<Item = f64>) -> f64 {
        self.minimized(values.fold(self.minimized(self.worst), f64::min))
    }

    /// What tables call it: its symbol, or its name in words.
    #[must_use]
    pub fn title(&self) -> String {
        self.symbol.map_or_else(|| self.words(), str::to_owned)
    }

    /// Its name in words.
    #[must_use]
    pub fn words(&self) -> String {
        self.name.replace('_', " ")
    }

    /// ` ` and its unit where that is told in a sentence; else nothing.
    #[must_use]
    pub fn told_unit(&self) -> String {
        if self.is_unit_told { format!(" {}", self.unit) } else { String::new() }
    }
}

/// The objectives of every run.
pub(super) fn always_asked() -> impl Iterator<Item = &'static Objective> {
    OBJECTIVES.iter().filter(|objective| objective.asked == Asked::Always)
}

/// The objective called `name`, of those that a run file may name.
pub(super) fn by_name(name: &str) -> Result<Objective, UnknownObjective> {
    let mut named = OBJECTIVES.iter().filter(|objective| objective.asked == Asked::ByName);
    let found = named.find(|objective| objective.name == name);
    found.copied().ok_or_else(|| UnknownObjective { name: name.to_owned() })
}

/// The objective called `name`, of all.
#[must_use]
pub fn objective(name: &str) -> Option<&'static Objective> {
    OBJECTIVES.iter().find(|objective| objective.name == name)
}

/// There is no objective of that name.
#[derive(Debug, thiserror::Error)]
#[error("`{name}` is no further objective; those are {}", names().join(", "))]
pub struct UnknownObjective {
    name: String,
}

/// Names of the objectives that a run file may name.
fn names() -> Vec<&'static str> {
    let named = OBJECTIVES.iter().filter(|objective| objective.asked == Asked::ByName);
    named.map(|objective| objective.name).collect()
}

impl From<Objective> for String {
    fn from(objective: Objective) -> Self {
        objective.name.to_owned()
    }
}

impl PartialEq for Objective {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

/// The rows that a quotient can be read off: samples under pressure that did some work.
pub(super) fn loaded(rows: &[Observation]) -> impl Iterator<Item = &Observation> {
    rows.iter().filter(|row| row.is_sample && row.pressure > 0.0 && row.work > 0.0)
}

/// The force on the planes for the pressure, N/kPa, at each loaded sample of `rows`.
pub(super) fn forces_per_pressure(rows: &[Observation]) -> Samples<'_> {
    loaded(rows).map(|row| (row, row.plane_force / (1e3 * row.pressure))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A column of a table is one objective, and a front is bounded by what is worst.
    #[test]
    fn objectives_are_told_apart() {
        let mut columns: Vec<&str> = OBJECTIVES.iter().map(|objective| objective.name).collect();
        columns.extend(["figure_of_merit", "max_force", "flags", "id"]);
        let count = columns.len();
        columns.sort_unstable();
        columns.dedup();
        assert_eq!(columns.len(), count, "two columns have one name");
        let is_further = |objective: &Objective| objective.asked == Asked::ByName;
        assert!(OBJECTIVES.is_sorted_by_key(is_further), "those of every run come first");
        for objective in OBJECTIVES {
            assert!(objective.worst.is_finite() && !objective.unit.is_empty(), "{objective:?}");
            let read = by_name(objective.name).ok();
            assert_eq!(read, is_further(objective).then_some(*objective));
        }
        let unknown = by_name("beauty").unwrap_err().to_string();
        assert!(unknown.contains("`beauty`") && unknown.contains("wall_volume"), "{unknown}");
    }
}
