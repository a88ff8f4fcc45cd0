//! `compare` of two runs: which front is ahead, where, and whether the runs may be compared at all.
//!
//! ```text
//! coverage(A, B) = share of B's front that some design of A's front dominates or equals      (Zitzler & Thiele 1999)
//! hypervolume    = volume of objectives that a front dominates, from the worst of each on (of the two of every run: 0)
//! ```

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{anyhow, ensure};
use serde::Serialize;

use super::front::LastGeneration;
use super::front_rows::axes;
use super::run_file::RunFile;
use super::run_folder::Record;
use crate::evolve::hypervolume;
use crate::fitness::{OBJECTIVES, Objective, Outcome};
use crate::io::{OutputFolder, atomic};
use crate::report::{FrontPoint, png, two_fronts_svg};
use crate::scene::results::design_folder::write_json;

/// What is told of both runs.
#[derive(Debug, Serialize)]
pub(crate) struct Comparison {
    runs: [Side; 2],
    /// Keys of the run files that differ, but for the search's own: then the fronts are of different tasks.
    differing_keys: Vec<String>,
}

/// What is told of one run, and what it has over the other.
#[derive(Debug, Serialize)]
struct Side {
    folder: PathBuf,
    candidates: usize,
    evaluated: usize,
    core_hours: f64,
    front: usize,
    /// Of the objectives that both runs have, product of their units.
    hypervolume: f64,
    best_angle_deg: f64,
    best_force: f64,
    /// Of these objectives, `best_<name>`.
    #[serde(flatten)]
    best: BTreeMap<String, f64>,
    best_figure_of_merit: f64,
    /// Designs of the other front that one of this dominates or equals.
    covers: usize,
    /// Designs of both fronts together that are of this one, and that none of the other dominates.
    of_common_front: usize,
}

/// Compares the runs in `folders`; writes figure and numbers into the new folder `out`, if there is one.
///
/// # Errors
/// When a folder is refused, or a run has no front.
pub(crate) fn compare(folders: [&Path; 2], out: Option<&Path>) -> anyhow::Result<Comparison> {
    if let Some(out) = out {
        OutputFolder::check_new(out)?;
    }
    let [one, other] = folders.map(Run::read);
    let (one, other) = (one?, other?);
    let comparison = Comparison {
        runs: [one.against(&other), other.against(&one)],
        differing_keys: differing(&one.file, &other.file)?,
    };
    if let Some(out) = out {
        let names = folders.map(|folder| folder.display().to_string());
        let svg = two_fronts_svg(&axes(), [&names[0], &names[1]], [&one.front, &other.front]);
        let folder = OutputFolder::create_new(out)?;
        atomic::write(&folder.file("fronts.svg"), svg.as_bytes())?;
        atomic::write(&folder.file("fronts.png"), &png(&svg, 2.0))?;
        write_json(&folder.file("comparison.json"), &comparison)?;
    }
    Ok(comparison)
}

/// A run as it is compared.
struct Run {
    folder: PathBuf,
    file: RunFile,
    records: Vec<Record>,
    front: Vec<FrontPoint>,
}

impl Run {
    fn read(path: &Path) -> anyhow::Result<Self> {
        let LastGeneration { folder, search, records } = LastGeneration::read(path)?;
        let front = folder.front(&search, &records)?;
        ensure!(
            !front.is_empty(),
            "{}: no design could be evaluated, so there is no front",
            path.display()
        );
        let file = folder.run_file().map_err(|error| anyhow!("{}: {error}", path.display()))?;
        Ok(Self { folder: path.to_owned(), file, records, front })
    }

    fn against(&self, other: &Self) -> Side {
        let best = |value: fn(&FrontPoint) -> f64| self.front.iter().map(value).fold(0.0, f64::max);
        let common = common(&self.front, &other.front);
        let minimized = |point: &FrontPoint| -> Vec<f64> {
            common.iter().filter_map(|one| Some(one.minimized(value(point, one)?))).collect()
        };
        let objectives: Vec<Vec<f64>> = self.front.iter().map(minimized).collect();
        let worst: Vec<f64> = common.iter().map(|one| one.minimized(one.worst)).collect();
        let best_of = |(k, one): (usize, &&Objective)| {
            let values = objectives.iter().map(|values| values[k]);
            (format!("best_{}", one.name), one.best_of(values))
        };
        let covers = |a: &FrontPoint, b: &FrontPoint| {
            minimized(a).iter().zip(minimized(b)).all(|(a, b)| *a <= b)
        };
        let is_evaluated = |record: &&Record| matches!(record.outcome, Outcome::Evaluated(_));
        let seconds: f64 = self.records.iter().map(|record| record.cpu_seconds.total()).sum();
        let is_covered = |theirs: &&FrontPoint| self.front.iter().any(|ours| covers(ours, theirs));
        let is_beaten = |ours: &FrontPoint| {
            other.front.iter().any(|theirs| covers(theirs, ours) && !covers(ours, theirs))
        };
        Side {
            folder: self.folder.clone(),
            candidates: self.records.len(),
            evaluated: self.records.iter().filter(is_evaluated).count(),
            core_hours: seconds / 3600.0,
            front: self.front.len(),
            hypervolume: hypervolume(&objectives, &worst),
            best_angle_deg: best(|point| {
                point.reached.as_ref().map_or(0.0, |reached| reached.angle_deg)
            }),
            best_force: best(|point| point.max_force),
            best: common.iter().enumerate().map(best_of).collect(),
            best_figure_of_merit: best(|point| point.figure_of_merit),
            covers: other.front.iter().filter(is_covered).count(),
            of_common_front: self.front.iter().filter(|ours| !is_beaten(ours)).count(),
        }
    }
}

/// The objectives that the designs of both fronts have.
fn common(one: &[FrontPoint], other: &[FrontPoint]) -> Vec<&'static Objective> {
    let all_have = |objective: &&Objective| {
        one.iter().chain(other).all(|point| value(point, objective).is_some())
    };
    OBJECTIVES.iter().filter(all_have).collect()
}

/// The value of `objective`; `None` if the design has none.
fn value(point: &FrontPoint, objective: &Objective) -> Option<f64> {
    let column = point.objectives.iter().find(|column| column.name == objective.name);
    column.map(|column| column.value)
}

/// The keys in which two run files differ, but for those of the search itself.
fn differing(one: &RunFile, other: &RunFile) -> anyhow::Result<Vec<String>> {
    let table = |file: &RunFile| toml::Value::try_from(file);
    let mut keys = Vec::new();
    collect(&table(one)?, &table(other)?, "", &mut keys);
    let of_search = ["evolution.", "solver.", "solid."];
    keys.retain(|key| !of_search.iter().any(|begin| key.starts_with(begin)));
    Ok(keys)
}

fn collect(one: &toml::Value, other: &toml::Value, path: &str, keys: &mut Vec<String>) {
    let (toml::Value::Table(one), toml::Value::Table(other)) = (one, other) else {
        if one != other {
            keys.push(path.to_owned());
        }
        return;
    };
    let mut names: Vec<&String> = one.keys().chain(other.keys()).collect();
    names.sort();
    names.dedup();
    for name in names {
        let path = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
        match (one.get(name), other.get(name)) {
            (Some(one), Some(other)) => collect(one, other, &path, keys),
            _ => keys.push(path),
        }
    }
}

impl Comparison {
    /// A table of both runs, for a person; `out` is where figure and numbers are.
    pub(crate) fn in_words(&self, out: Option<&Path>) -> String {
        let [one, other] = &self.runs;
        let row = |name: &str, value: &dyn Fn(&Side) -> String| {
            format!("{name:<34}  {:>14}  {:>14}\n", value(one), value(other))
        };
        let mut text = row("", &|side| tail(&side.folder));
        text += &row("candidates", &|side| side.candidates.to_string());
        text += &row("of which evaluated", &|side| side.evaluated.to_string());
        text += &row("core-hours", &|side| format!("{:.3}", side.core_hours));
        text += &row("designs on the front", &|side| side.front.to_string());
        text += &row("hypervolume", &|side| format!("{:.4e}", side.hypervolume));
        text += &row("largest angle, deg", &|side| format!("{:.2}", side.best_angle_deg));
        text += &row("largest force, N", &|side| format!("{:.3}", side.best_force));
        for objective in OBJECTIVES {
            let best = |side: &Side| side.best.get(&format!("best_{}", objective.name)).copied();
            if best(one).is_some() {
                let name = format!("best {}, {}", objective.title(), objective.unit);
                let digits = objective.decimals;
                text += &row(&name, &|side| format!("{:.digits$}", best(side).unwrap_or_default()));
            }
        }
        text +=
            &row("best merit, deg/(kPa m)", &|side| format!("{:.3}", side.best_figure_of_merit));
        text += &row("covers of the other front", &|side| {
            let of = if std::ptr::eq(side, one) { other.front } else { one.front };
            format!("{} of {of}", side.covers)
        });
        text += &row("designs on the common front", &|side| side.of_common_front.to_string());
        text += &self.verdict();
        if !self.differing_keys.is_empty() {
            let keys = self.differing_keys.join(", ");
            text += &format!(
                "\nthe runs are of different tasks, so that numbers may not compare; they differ in {keys}"
            );
        }
        if let Some(out) = out {
            text += &format!("\nboth fronts: {}", out.join("fronts.svg").display());
        }
        text
    }

    fn verdict(&self) -> String {
        let [one, other] = &self.runs;
        let ahead = |ahead: &Side, behind: &Side| {
            format!(
                "every design on the front of {} is matched by one of {}",
                tail(&behind.folder),
                tail(&ahead.folder)
            )
        };
        match (one.covers == other.front, other.covers == one.front) {
            (true, true) => "both fronts are the same".to_owned(),
            (true, false) => ahead(one, other),
            (false, true) => ahead(other, one),
            (false, false) => "neither front is ahead everywhere".to_owned(),
        }
    }
}

/// The last part of a path.
fn tail(path: &Path) -> String {
    path.file_name()
        .map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_that_differ_are_named() {
        let value = |text: &str| text.parse::<toml::Table>().map(toml::Value::Table).unwrap();
        let mut keys = Vec::new();
        let one = value("[load]\npressure = 0.1\nsteps = 3\n[wall]\nthickness = 1.0\n");
        let other =
            value("[load]\npressure = 0.2\nsteps = 3\n[wall]\nthickness = 1.0\nelement = 1\n");
        collect(&one, &other, "", &mut keys);
        assert_eq!(keys, ["load.pressure", "wall.element"]);
    }
}
