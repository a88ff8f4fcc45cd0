//! What a part is put through: each a file beside this one, and a line in the list.

use super::{FitnessSettings, LoadSettings};
use crate::model::contact::PlaneSettings;
use crate::solve::Programme;

macro_rules! scenarios {
    ($($file:ident,)+) => {
        $(pub(super) mod $file;)+
        /// All scenarios, each after the one that it branches off from.
        pub const SCENARIOS: &[Scenario] = &[$($file::SCENARIO,)+];
    };
}

// Each a file beside this one, and a line here.
scenarios! {
    free,
    blocked,
    blocked_back,
}

/// What a part is put through: what stands in its way, and what drives it. It is held by its clamp.
#[derive(Clone, Copy, Debug)]
pub struct Scenario {
    /// Its name in names of files and on pictures.
    pub name: &'static str,
    /// What the part does in it: its name in records and messages.
    pub action: &'static str,
    /// The name of the scenario that this one is until the part comes near its planes.
    pub branches_off: Option<&'static str>,
    /// How the part is arranged, for a run with these settings.
    pub arrangement: fn(&FitnessSettings, &LoadSettings) -> Arrangement,
}

/// How a part is arranged in a scenario.
#[derive(Clone, Debug, PartialEq)]
pub struct Arrangement {
    /// The planes before the part.
    pub planes: Vec<PlaneSettings>,
    /// What the pressure in the chamber is driven through.
    pub programme: Programme,
}

impl Scenario {
    /// The scenario called `name`.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        SCENARIOS.iter().find(|scenario| scenario.name == name).copied()
    }

    /// The name of its path in files, without ending: `path`, or `path_` and its name where it branches off; with `stage` in between where
    /// that is not empty.
    #[must_use]
    pub fn file_stem(&self, stage: &str) -> String {
        let words = ["path", stage, if self.branches_off.is_some() { self.name } else { "" }];
        let words: Vec<&str> = words.into_iter().filter(|word| !word.is_empty()).collect();
        words.join("_")
    }
}

impl PartialEq for Scenario {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

/// Each of the scenarios `asked`, and what these branch off from, once, in the order of the list.
pub(super) fn with_origins(asked: impl Iterator<Item = Scenario>) -> Vec<Scenario> {
    let mut needed: Vec<&str> = Vec::new();
    for scenario in asked {
        let mut next = Some(scenario);
        while let Some(scenario) = next {
            needed.push(scenario.name);
            next = scenario.branches_off.and_then(Scenario::named);
        }
    }
    SCENARIOS.iter().filter(|scenario| needed.contains(&scenario.name)).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Names are of one scenario, and each stands after the one that it branches off from, whose planes it has too.
    #[test]
    fn scenarios_are_told_apart_and_in_order() {
        let (fitness, load) = (FitnessSettings::default(), LoadSettings::default());
        for (k, scenario) in SCENARIOS.iter().enumerate() {
            let before = &SCENARIOS[..k];
            let is_other =
                |other: &Scenario| other.name != scenario.name && other.action != scenario.action;
            assert!(before.iter().all(is_other), "{}", scenario.name);
            if let Some(origin) = scenario.branches_off {
                let origin = before.iter().find(|other| other.name == origin).unwrap();
                let [planes, programme] =
                    [origin, scenario].map(|s| (s.arrangement)(&fitness, &load));
                assert!(planes.planes.iter().all(|plane| programme.planes.contains(plane)));
                assert_eq!(planes.programme, programme.programme);
            }
        }
    }

    #[test]
    fn files_are_named_after_scenarios() {
        let stems = |stage| [free::SCENARIO, blocked::SCENARIO].map(|s| s.file_stem(stage));
        assert_eq!(stems(""), ["path", "path_blocked"]);
        assert_eq!(stems("solid"), ["path_solid", "path_solid_blocked"]);
    }
}
