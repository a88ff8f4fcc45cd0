//! What a run file means: every key with its value, defaults included, however the file is written.
//!
//! Two files with one meaning make one search. What may change while a search is interrupted (how many generations there will be, the
//! second stage) is no part of it.

use std::collections::BTreeMap;
use std::fmt;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::inherited::{Checkpoint, Inherited, named_bounds};
use super::run_file::RunFile;
use crate::io::checksum;

/// The keys of a file with their values, by `section.key`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub(crate) struct Meaning(BTreeMap<String, Value>);

/// The first key that means something else in two files.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Difference {
    key: String,
    here: Option<Value>,
    there: Option<Value>,
}

impl Meaning {
    /// What decides the search of a `run`.
    pub(crate) fn of_search(run: &RunFile) -> anyhow::Result<Self> {
        let mut meaning = Self::of(run, "")?;
        let is_of_search = |key: &str| {
            key != "evolution.generations" && key != "solid" && !key.starts_with("solid.")
        };
        meaning.0.retain(|key, _| is_of_search(key));
        meaning.bind_genes(&run.representation()?);
        Ok(meaning)
    }

    /// What decides the certificates of designs of a `run`, by the `section` in force.
    pub(crate) fn of_certificates(run: &RunFile, section: &impl Serialize) -> anyhow::Result<Self> {
        let mut meaning = Self::of(run, "")?;
        let is_of_search = |key: &str| {
            ["evolution.", "genes.", "solid."].iter().any(|section| key.starts_with(section))
        };
        meaning.0.retain(|key, _| !is_of_search(key));
        meaning.0.extend(Self::of(section, "solid")?.0);
        Ok(meaning)
    }

    /// What a checkpoint of a version that kept no meaning tells of it.
    pub(crate) fn of_checkpoint(search: &Checkpoint) -> anyhow::Result<Self> {
        let mut meaning = Self::of(&search.settings, "evolution")?;
        meaning.0.remove("evolution.generations");
        meaning.bind_genes(&search.representation);
        Ok(meaning)
    }

    fn of(settings: &impl Serialize, section: &str) -> anyhow::Result<Self> {
        let mut keys = BTreeMap::new();
        flatten(section, serde_json::to_value(settings)?, &mut keys);
        Ok(Self(keys))
    }

    fn bind_genes(&mut self, inherited: &Inherited) {
        let keys = named_bounds(inherited);
        self.0.extend(keys.map(|(name, bounds)| (format!("genes.{name}"), bounds.to_vec().into())));
    }

    /// A number for the whole of it.
    pub(crate) fn digest(&self) -> String {
        checksum::written(&serde_json::to_vec(self).expect("words and numbers have a JSON form"))
    }

    /// The first key that means something else in `there`, or is in one of them alone.
    pub(crate) fn first_difference(&self, there: &Self) -> Option<Difference> {
        let keys = self.0.keys().chain(there.0.keys());
        let differs = |key: &&String| self.0.get(*key) != there.0.get(*key);
        keys.filter(differs).min().map(|key| self.difference(there, key))
    }

    /// As [`Self::first_difference`]; but a key that an earlier version did not know may stand at its default.
    pub(crate) fn first_difference_from_earlier(&self, there: &Self) -> Option<Difference> {
        let defaults = Self::of_search(&RunFile::default()).unwrap_or_else(|_| there.clone());
        let keys = self.0.keys().chain(there.0.keys());
        let differs = |key: &&String| match (self.0.get(*key), there.0.get(*key)) {
            (Some(here), None) => defaults.0.get(*key) != Some(here),
            (here, there) => here != there,
        };
        keys.filter(differs).min().map(|key| self.difference(there, key))
    }

    /// As [`Self::first_difference`], of the keys alone that are `there`.
    pub(crate) fn first_difference_of_known(&self, there: &Self) -> Option<Difference> {
        let differs = |key: &&String| self.0.get(*key) != there.0.get(*key);
        there.0.keys().find(differs).map(|key| self.difference(there, key))
    }

    fn difference(&self, there: &Self, key: &str) -> Difference {
        let value = |meaning: &Self| meaning.0.get(key).cloned();
        Difference { key: key.to_owned(), here: value(self), there: value(there) }
    }
}

fn flatten(path: &str, value: Value, keys: &mut BTreeMap<String, Value>) {
    match value {
        Value::Object(map) => {
            for (key, value) in map {
                let path = if path.is_empty() { key } else { format!("{path}.{key}") };
                flatten(&path, value, keys);
            }
        }
        leaf => {
            keys.insert(path.to_owned(), leaf);
        }
    }
}

impl Difference {
    /// The key as a file has it: `[section] key`.
    fn key(&self) -> String {
        match self.key.rsplit_once('.') {
            Some((section, key)) => format!("[{section}] {key}"),
            None => self.key.clone(),
        }
    }
}

impl fmt::Display for Difference {
    /// `[load] pressure is 0.2 instead of 0.1`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let told = |value: &Option<Value>| match value {
            None | Some(Value::Null) => "not given".to_owned(),
            Some(value) => shortened(&value.to_string()),
        };
        write!(f, "{} is {} instead of {}", self.key(), told(&self.here), told(&self.there))
    }
}

/// Longer values are not read.
const LONGEST: usize = 48;

fn shortened(text: &str) -> String {
    if text.chars().count() <= LONGEST {
        return text.to_owned();
    }
    text.chars().take(LONGEST - 3).chain("...".chars()).collect()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::genome::GENES;
    use crate::io::toml_file;

    fn meaning(text: &str) -> Meaning {
        Meaning::of_search(&toml_file::parse(text, Path::new("run.toml")).unwrap()).unwrap()
    }

    fn difference(here: &str, there: &str) -> Option<String> {
        meaning(here).first_difference(&meaning(there)).map(|difference| difference.to_string())
    }

    #[test]
    fn a_file_means_the_same_however_it_is_written() {
        let short = "[load]\npressure = 0.2\n[evolution]\nseed = 7\n";
        let long = "# mine\n[evolution]\nseed = 0x7\npopulation = 60\ngenerations = 99\n\
                    [load]\npressure = 2e-1\npath = { steps = 10 }\n[solid]\nedge = 3\n";
        assert_eq!(difference(short, long), None);
        assert_eq!(meaning(short).digest(), meaning(long).digest());
        // A bound that is the gene's own.
        let gene = &GENES[0];
        let own = format!("[genes]\n{} = [{:?}, {:?}]\n", gene.name, gene.lower, gene.upper);
        assert_eq!(difference(&own, ""), None);
    }

    #[test]
    fn the_first_key_that_differs_is_named_with_both_values() {
        for (here, there, told) in [
            ("[load]\npressure = 0.3", "", "[load] pressure is 0.3 instead of 0.2"),
            ("[load.path]\nsteps = 4", "", "[load.path] steps is 4 instead of 10"),
            ("", "[evolution]\nseed = 2", "[evolution] seed is 1 instead of 2"),
            (
                "[material]\nlaw = 'neo-hookean'\nmu = 1",
                "",
                "[material] law is \"neo-hookean\" instead of not given",
            ),
            (
                "[evolution]\nmutation_probability = 0.5",
                "",
                "[evolution] mutation_probability is 0.5 instead of not given",
            ),
        ] {
            assert_eq!(difference(here, there).as_deref(), Some(told));
            assert_ne!(meaning(here).digest(), meaning(there).digest());
        }
        let long = shortened(&"x".repeat(100));
        assert_eq!((long.len(), long.ends_with("x...")), (LONGEST, true));
    }

    #[test]
    fn an_earlier_version_need_not_know_a_key_that_stands_at_its_default() {
        let mut earlier = meaning("[load]\npressure = 0.3");
        earlier.0.remove("fitness.exponent");
        let told = |here: &str, earlier: &Meaning| {
            let difference = meaning(here).first_difference_from_earlier(earlier);
            difference.map(|difference| difference.to_string())
        };
        assert_eq!(told("[load]\npressure = 0.3", &earlier), None);
        assert_eq!(
            told("[load]\npressure = 0.3\n[fitness]\nexponent = 2", &earlier).as_deref(),
            Some("[fitness] exponent is 2.0 instead of not given")
        );
        // A key that this version does not know decided something.
        earlier.0.insert("load.vacuum".to_owned(), true.into());
        assert_eq!(
            told("[load]\npressure = 0.3", &earlier).as_deref(),
            Some("[load] vacuum is not given instead of true")
        );
    }
}
