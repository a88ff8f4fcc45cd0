//! The numbers of a design that was evaluated, and how records hold them.

use std::collections::BTreeMap;

use serde::de::{Error, IgnoredAny};
use serde::ser::SerializeMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::exploit::Exploit;
use super::objective::{OBJECTIVES, Objective, always_asked};
use super::scenario::Scenario;
use crate::solve::Ending;

/// The objectives of one design, and the figures beside them.
///
/// In records an objective of every run is a key of its own, the others are together under `further`; of a scenario there are
/// `<action>_ending` and `<action>_pressure`.
#[derive(Clone, Debug, PartialEq)]
pub struct Evaluation {
    /// The objectives by name, each in its unit.
    pub objectives: BTreeMap<String, f64>,
    /// Tangent angle over pressure and length at the largest pressure, deg/(kPa m).
    pub figure_of_merit: f64,
    /// Largest force on the plane, N.
    pub max_force: f64,
    /// Chord angle at the largest pressure, degrees.
    pub angle_deg: f64,
    /// Share of the wall whose bending is softened because it folds tighter than its thickness allows.
    pub creased_share: f64,
    /// Unknowns of the model.
    pub unknowns: usize,
    /// Newton iterations of all scenarios, those of failed attempts too.
    pub newton_iterations: usize,
    /// Losses of stability that all paths went over.
    pub snaps: usize,
    /// How the scenarios ended, by action: the objectives are read off what was reached.
    pub endings: BTreeMap<String, ScenarioEnding>,
    /// Reasons to doubt the objectives.
    pub exploits: Vec<Exploit>,
    /// Where it is judged at a pressure of its own.
    pub rated: Option<Rated>,
}

/// The pressure of its own at which a design is judged.
#[derive(Clone, Debug, PartialEq)]
pub struct Rated {
    /// MPa.
    pub pressure: f64,
    /// What it is at the reference pressure, where it comes to that.
    pub at_reference: Option<AtReference>,
}

/// A design at the pressure at which all are told.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AtReference {
    /// MPa.
    pub pressure: f64,
    /// What is read there.
    #[serde(flatten)]
    pub readings: Readings,
}

/// What is read off the paths of a design.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Readings {
    /// As [`Evaluation::objectives`].
    pub objectives: BTreeMap<String, f64>,
    /// As [`Evaluation::figure_of_merit`].
    pub figure_of_merit: f64,
    /// As [`Evaluation::max_force`].
    pub max_force: f64,
    /// As [`Evaluation::angle_deg`].
    pub angle_deg: f64,
}

/// How a scenario ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScenarioEnding {
    /// Why its path ended.
    pub ending: Ending,
    /// Pressure of its last sample, MPa.
    pub pressure: f64,
}

impl Evaluation {
    /// The value of `objective`; `None` where it was not asked.
    #[must_use]
    pub fn value(&self, objective: &Objective) -> Option<f64> {
        self.objectives.get(objective.name).copied()
    }

    /// The objectives that were asked with their values, in the order of [`OBJECTIVES`]; others of a later program are left out.
    pub fn known(&self) -> impl Iterator<Item = (&'static Objective, f64)> {
        OBJECTIVES.iter().filter_map(|objective| Some((objective, self.value(objective)?)))
    }

    /// How `scenario` ended; `None` where it was not walked.
    #[must_use]
    pub fn ending(&self, scenario: &Scenario) -> Option<ScenarioEnding> {
        self.endings.get(scenario.action).copied()
    }

    /// The objectives that only some runs ask.
    fn further(&self) -> BTreeMap<&String, f64> {
        let is_further = |name: &str| always_asked().all(|objective| objective.name != name);
        let values = self.objectives.iter().filter(|(name, _)| is_further(name));
        values.map(|(name, value)| (name, *value)).collect()
    }
}

impl Serialize for Evaluation {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut keys = serializer.serialize_map(None)?;
        for objective in always_asked() {
            keys.serialize_entry(objective.name, &self.value(objective))?;
        }
        keys.serialize_entry("figure_of_merit", &self.figure_of_merit)?;
        keys.serialize_entry("max_force", &self.max_force)?;
        keys.serialize_entry("angle_deg", &self.angle_deg)?;
        keys.serialize_entry("creased_share", &self.creased_share)?;
        keys.serialize_entry("unknowns", &self.unknowns)?;
        keys.serialize_entry("newton_iterations", &self.newton_iterations)?;
        keys.serialize_entry("snaps", &self.snaps)?;
        for (action, ScenarioEnding { ending, pressure }) in &self.endings {
            keys.serialize_entry(&format!("{action}{ENDING}"), ending)?;
            keys.serialize_entry(&format!("{action}{PRESSURE}"), pressure)?;
        }
        keys.serialize_entry("exploits", &self.exploits)?;
        if let Some(Rated { pressure, at_reference }) = &self.rated {
            keys.serialize_entry("rated_pressure", pressure)?;
            keys.serialize_entry("at_reference", at_reference)?;
        }
        let further = self.further();
        if !further.is_empty() {
            keys.serialize_entry("further", &further)?;
        }
        keys.end()
    }
}

const ENDING: &str = "_ending";
const PRESSURE: &str = "_pressure";

/// The keys that are the same for every list of objectives and scenarios, and the rest.
#[derive(Deserialize)]
struct Keys {
    figure_of_merit: f64,
    max_force: f64,
    angle_deg: f64,
    creased_share: f64,
    unknowns: usize,
    newton_iterations: usize,
    snaps: usize,
    exploits: Vec<Exploit>,
    rated_pressure: Option<f64>,
    at_reference: Option<AtReference>,
    #[serde(default)]
    further: BTreeMap<String, f64>,
    #[serde(flatten)]
    rest: BTreeMap<String, Entry>,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Entry {
    Number(f64),
    Ending(Ending),
    Other(IgnoredAny),
}

impl<'de> Deserialize<'de> for Evaluation {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let keys = Keys::deserialize(deserializer)?;
        let number = |key: &str| match keys.rest.get(key) {
            Some(Entry::Number(number)) => Some(*number),
            _ => None,
        };
        let mut objectives = keys.further;
        for Objective { name, .. } in always_asked() {
            let value = number(name).ok_or_else(|| D::Error::missing_field(name))?;
            objectives.insert((*name).to_owned(), value);
        }
        let endings = keys.rest.iter().filter_map(|(key, entry)| match entry {
            Entry::Ending(ending) => Some((key.strip_suffix(ENDING)?, *ending)),
            Entry::Number(_) | Entry::Other(IgnoredAny) => None,
        });
        let endings = endings.map(|(action, ending)| {
            let key = format!("{action}{PRESSURE}");
            let missing = || D::Error::custom(format!("missing field `{key}`"));
            let pressure = number(&key).ok_or_else(missing)?;
            Ok((action.to_owned(), ScenarioEnding { ending, pressure }))
        });
        Ok(Self {
            endings: endings.collect::<Result<_, D::Error>>()?,
            objectives,
            figure_of_merit: keys.figure_of_merit,
            max_force: keys.max_force,
            angle_deg: keys.angle_deg,
            creased_share: keys.creased_share,
            unknowns: keys.unknowns,
            newton_iterations: keys.newton_iterations,
            snaps: keys.snaps,
            exploits: keys.exploits,
            rated: keys
                .rated_pressure
                .map(|pressure| Rated { pressure, at_reference: keys.at_reference }),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fitness::Outcome;

    const CLASSIC: &str = "{\"status\":\"evaluated\",\"bending\":0.25,\"blocking\":0.0,\"figure_of_merit\":3.5,\"max_force\":0.1,\"angle_deg\":12.0,\
        \"creased_share\":0.0,\"unknowns\":3000,\"newton_iterations\":41,\"snaps\":0,\"bending_ending\":\"reached\",\"bending_pressure\":0.2,\
        \"blocking_ending\":\"limit_point\",\"blocking_pressure\":0.15,\"exploits\":[\"tiny_energy\"]}";

    /// The keys of records and their order are a format that other programs read.
    #[test]
    fn records_keep_their_keys() {
        let further = CLASSIC.replace("]}", "],\"further\":{\"wall_volume\":12.5}}");
        let rated = CLASSIC.replace(
            "]}",
            "],\"rated_pressure\":0.31,\"at_reference\":{\"pressure\":0.2,\"objectives\":{\"bending\":0.5},\
             \"figure_of_merit\":2.0,\"max_force\":0.25,\"angle_deg\":9.0}}",
        );
        let not_told = CLASSIC.replace("]}", "],\"rated_pressure\":0.125,\"at_reference\":null}");
        for text in [CLASSIC, &further, &rated, &not_told] {
            let read: Outcome = serde_json::from_str(text).unwrap();
            assert_eq!(serde_json::to_string(&read).unwrap(), text);
            let Outcome::Evaluated(evaluation) = read else { panic!("it was evaluated") };
            assert_eq!(evaluation.endings["blocking"].ending, Ending::LimitPoint);
            assert_eq!(evaluation.known().count(), if text == further { 3 } else { 2 });
        }
        let lacking = CLASSIC.replace("\"blocking\":0.0,", "");
        let error = serde_json::from_str::<Outcome>(&lacking).unwrap_err().to_string();
        assert!(error.contains("missing field `blocking`"), "{error}");
    }
}
