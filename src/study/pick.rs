//! `pick`: the design of a run that does most of one thing among those that do enough of others.
//!
//! ```text
//! pneumorph pick DIR "at least 20 N, most angle"
//! ```

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{anyhow, bail, ensure};
use serde::Serialize;

use super::front::LastGeneration;
use super::front_rows::{pressure_column, reached};
use super::run_folder::RunFolder;
use crate::evolve::IndividualId;
use crate::fitness::{Asked, Evaluation, OBJECTIVES, Objective, Outcome, SCENARIOS, flags};

/// What is wished of a design.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Wish {
    bounds: Vec<Bound>,
    aim: Aim,
}

/// What must not be less, or more, than a number.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Bound {
    quantity: Quantity,
    is_least: bool,
    value: f64,
}

/// What should be large, or small.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Aim {
    pub quantity: Quantity,
    pub is_most: bool,
}

/// A number that a run has of each design.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Quantity {
    Angle,
    Force,
    Merit,
    Objective(&'static Objective),
}

/// The names of the quantities that every run has, as messages list them.
fn names() -> String {
    let always = OBJECTIVES.iter().filter(|objective| objective.asked == Asked::Always);
    let objectives = always.map(|objective| match objective.is_unit_told {
        true => format!("{} ({})", objective.title(), objective.unit),
        false => objective.title(),
    });
    let all = ["angle (deg)", "force (N)"].map(str::to_owned).into_iter().chain(objectives);
    all.chain(["merit (deg/(kPa m))".to_owned()]).collect::<Vec<_>>().join(", ")
}

impl Quantity {
    /// By a name or a unit.
    ///
    /// # Errors
    /// When no run knows it.
    pub(crate) fn named(text: &str) -> anyhow::Result<Self> {
        let name = text.trim().to_lowercase();
        Ok(match name.as_str() {
            "angle" | "deg" | "degree" | "degrees" | "angle_deg" => Self::Angle,
            "force" | "n" | "max_force" => Self::Force,
            "merit" | "deg/(kpa m)" | "figure_of_merit" => Self::Merit,
            _ => {
                let is_called = |objective: &&Objective| {
                    let names = [objective.name.to_owned(), objective.title()];
                    let is_one = |one: &str| one.to_lowercase() == name;
                    names.iter().any(|one| is_one(one))
                        || is_one(objective.unit)
                        || is_one(&objective.words())
                };
                match OBJECTIVES.iter().find(is_called) {
                    Some(objective) => Self::Objective(objective),
                    None => bail!(
                        "`{text}` is nothing that a run knows of its designs; it knows {} and its further objectives",
                        names()
                    ),
                }
            }
        })
    }

    fn of(&self, evaluation: &Evaluation) -> Option<f64> {
        Some(match self {
            Self::Angle => evaluation.angle_deg,
            Self::Force => evaluation.max_force,
            Self::Merit => evaluation.figure_of_merit,
            Self::Objective(objective) => evaluation.value(objective)?,
        })
    }

    fn name(&self) -> String {
        match self {
            Self::Angle => "angle".to_owned(),
            Self::Force => "force".to_owned(),
            Self::Merit => "merit".to_owned(),
            Self::Objective(objective) => objective.title(),
        }
    }

    fn unit(&self) -> &str {
        match self {
            Self::Angle => "deg",
            Self::Force => "N",
            Self::Merit => "deg/(kPa m)",
            Self::Objective(objective) => objective.unit,
        }
    }

    fn in_words(&self, value: f64) -> String {
        format!("{} {} {}", self.name(), short(value), self.unit())
    }
}

impl Bound {
    /// `20 N`, `force 20` or `force 20 N`.
    ///
    /// # Errors
    /// One sentence that says what is wrong.
    pub(crate) fn parse(text: &str, is_least: bool) -> anyhow::Result<Self> {
        let words: Vec<&str> = text.split_whitespace().collect();
        let numbers =
            words.iter().enumerate().filter_map(|(k, word)| Some((k, word.parse().ok()?)));
        let numbers: Vec<(usize, f64)> = numbers.collect();
        let &[(place, value)] = &numbers[..] else {
            bail!(
                "`{text}` should be one number with its name or unit, such as `force 20` or `20 N`"
            );
        };
        ensure!(value.is_finite(), "`{text}` is no bound: the number must be finite");
        let (before, after) = (words[..place].join(" "), words[place + 1..].join(" "));
        let quantity = match (before.is_empty(), after.is_empty()) {
            (true, true) => bail!(
                "`{text}` names neither a quantity nor its unit; write `force {value}` or `{value} N`"
            ),
            (true, false) => Quantity::named(&after)?,
            (false, true) => Quantity::named(&before)?,
            (false, false) => {
                let quantity = Quantity::named(&before)?;
                ensure!(
                    after.eq_ignore_ascii_case(quantity.unit()),
                    "`{text}`: {} is in {}, not in {after}",
                    quantity.name(),
                    quantity.unit()
                );
                quantity
            }
        };
        Ok(Self { quantity, is_least, value })
    }

    fn in_words(&self) -> String {
        let sense = if self.is_least { "at least" } else { "at most" };
        format!("{} {sense} {} {}", self.quantity.name(), short(self.value), self.quantity.unit())
    }

    /// How far a design is from it, as a share; 0 where it is met.
    fn miss(&self, evaluation: &Evaluation) -> f64 {
        let Some(value) = self.quantity.of(evaluation) else { return f64::INFINITY };
        let short_by = if self.is_least { self.value - value } else { value - self.value };
        short_by.max(0.0) / self.value.abs().max(f64::MIN_POSITIVE)
    }
}

/// Phrases with commas between: bounds, and what there should be most or least of.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Phrases {
    pub bounds: Vec<Bound>,
    pub aims: Vec<Aim>,
}

impl Phrases {
    /// Reads phrases such as "at least 20 N, most angle".
    ///
    /// # Errors
    /// One sentence that says which phrase is wrong.
    pub(crate) fn parse(text: &str) -> anyhow::Result<Self> {
        let mut read = Self::default();
        for phrase in text.split(',').map(str::trim).filter(|phrase| !phrase.is_empty()) {
            let lower = phrase.to_lowercase();
            let after =
                |begin: &str| lower.starts_with(begin).then(|| phrase[begin.len()..].trim());
            if let Some(bound) = after("at least ") {
                read.bounds.push(Bound::parse(bound, true)?);
            } else if let Some(bound) = after("at most ") {
                read.bounds.push(Bound::parse(bound, false)?);
            } else if let Some(quantity) = after("most ") {
                read.aims.push(Aim { quantity: Quantity::named(quantity)?, is_most: true });
            } else if let Some(quantity) = after("least ") {
                read.aims.push(Aim { quantity: Quantity::named(quantity)?, is_most: false });
            } else {
                bail!("`{phrase}` should begin with `at least`, `at most`, `most` or `least`");
            }
        }
        Ok(read)
    }
}

impl Wish {
    /// What all `phrases` say together.
    ///
    /// # Errors
    /// When they do not name one thing that there should be most or least of.
    pub(crate) fn new(phrases: Phrases) -> anyhow::Result<Self> {
        let Phrases { bounds, mut aims } = phrases;
        ensure!(
            aims.len() == 1,
            "say what one thing there should be most or least of, such as `most angle`; {} things were asked",
            aims.len()
        );
        Ok(Self { bounds, aim: aims.remove(0) })
    }

    /// The largest share by which a design misses a bound.
    fn miss(&self, evaluation: &Evaluation) -> f64 {
        self.bounds.iter().map(|bound| bound.miss(evaluation)).fold(0.0, f64::max)
    }

    /// What is to be large.
    fn value(&self, evaluation: &Evaluation) -> Option<f64> {
        let value = self.aim.quantity.of(evaluation)?;
        Some(if self.aim.is_most { value } else { -value })
    }
}

/// What is told of the design.
#[derive(Debug, Serialize)]
pub(crate) struct Picked {
    id: String,
    /// Degrees, at the pressure of the first scenario.
    angle_deg: f64,
    /// N.
    max_force: f64,
    /// The objectives of every run.
    #[serde(flatten)]
    objectives: BTreeMap<String, f64>,
    figure_of_merit: f64,
    /// Of each scenario the pressure that was reached, MPa.
    #[serde(flatten)]
    pressures: BTreeMap<String, f64>,
    further: BTreeMap<String, f64>,
    flags: String,
    /// How many designs meet all bounds.
    suitable: usize,
    files: Vec<PathBuf>,
    /// Among how many designs, of the front or of all, it was looked for.
    #[serde(skip)]
    among: Among,
}

/// Designs among which one is picked.
#[derive(Clone, Copy, Debug)]
struct Among {
    count: usize,
    all: bool,
}

/// Picks the design of the run in the folder `run` that the `wish` wants: of its front, or of `all`
/// that were evaluated.
///
/// # Errors
/// When the folder is refused, the run did not ask for what is wished, or no design meets all
/// bounds; the nearest are named.
pub(crate) fn pick(run: &Path, wish: &Wish, all: bool) -> anyhow::Result<Picked> {
    let LastGeneration { folder, search, mut records } = LastGeneration::read(run)?;
    if !all {
        let front: Vec<IndividualId> =
            search.front().iter().map(|individual| individual.id).collect();
        records.retain(|record| front.contains(&record.id));
    }
    let evaluated: Vec<(IndividualId, &Evaluation)> = records
        .iter()
        .filter_map(|record| match &record.outcome {
            Outcome::Evaluated(evaluation) => Some((record.id, evaluation)),
            Outcome::Rejected(_) => None,
        })
        .collect();
    ensure!(!evaluated.is_empty(), "{}: no design has been evaluated", run.display());
    let known = |quantity: &Quantity| {
        let has = evaluated.iter().any(|(_, evaluation)| quantity.of(evaluation).is_some());
        ensure!(has, "{}: the run did not ask for {}", run.display(), quantity.name());
        Ok(())
    };
    wish.bounds
        .iter()
        .map(|bound| &bound.quantity)
        .chain([&wish.aim.quantity])
        .try_for_each(known)?;
    let suitable = || evaluated.iter().filter(|(_, evaluation)| wish.miss(evaluation) == 0.0);
    let best = suitable()
        .filter_map(|(id, evaluation)| Some((*id, *evaluation, wish.value(evaluation)?)))
        // The earlier of two that are equal.
        .reduce(|best, next| if next.2 > best.2 { next } else { best });
    let Some((id, evaluation, _)) = best else {
        return Err(nearest(wish, &evaluated, all));
    };
    Ok(Picked {
        id: id.to_string(),
        angle_deg: evaluation.angle_deg,
        max_force: evaluation.max_force,
        objectives: values_of(evaluation, Asked::Always),
        figure_of_merit: evaluation.figure_of_merit,
        pressures: reached(evaluation).pressures.into_iter().collect(),
        further: values_of(evaluation, Asked::ByName),
        flags: flags(&evaluation.exploits),
        suitable: suitable().count(),
        files: files_of(&folder, id),
        among: Among { count: evaluated.len(), all },
    })
}

/// Why no design is picked, with those that miss least.
fn nearest(wish: &Wish, evaluated: &[(IndividualId, &Evaluation)], all: bool) -> anyhow::Error {
    let mut misses: Vec<_> = evaluated.to_vec();
    misses.sort_by(|a, b| wish.miss(a.1).total_cmp(&wish.miss(b.1)));
    let told = |(id, evaluation): &(IndividualId, &Evaluation)| {
        let values = wish
            .bounds
            .iter()
            .filter_map(|bound| Some(bound.quantity.in_words(bound.quantity.of(evaluation)?)));
        format!("{id} ({})", values.collect::<Vec<_>>().join(", "))
    };
    let nearest: Vec<String> = misses.iter().take(NEAREST).map(told).collect();
    let bounds: Vec<String> = wish.bounds.iter().map(Bound::in_words).collect();
    let among = if all { "run" } else { "front" };
    let hint = if all { "" } else { "; --all looks beyond the front" };
    anyhow!(
        "no design of the {among} has {}; nearest: {}{hint}",
        bounds.join(" and "),
        nearest.join(", ")
    )
}

/// How many designs are told that come near.
const NEAREST: usize = 3;

impl Picked {
    /// Its numbers and its files, a line each, for a person.
    pub(crate) fn in_words(&self) -> String {
        let Among { count: of, all } = self.among;
        let Self { id, angle_deg, max_force, pressures, .. } = self;
        let among = if all { "evaluated designs" } else { "designs of the front" };
        let mut text = format!(
            "{id}: angle {} deg at {} MPa, force {} N",
            short(*angle_deg),
            short(pressures.get(&pressure_column(&SCENARIOS[0])).copied().unwrap_or_default()),
            short(*max_force),
        );
        for objective in OBJECTIVES {
            if let Some(value) = self.objectives.get(objective.name) {
                let unit = objective.told_unit();
                text += &format!(", {} {}{unit}", objective.title(), short(*value));
            }
        }
        for (name, value) in &self.further {
            text += &format!(", {} {}", name.replace('_', " "), short(*value));
        }
        if !self.flags.is_empty() {
            text += &format!(" (doubted: {})", self.flags);
        }
        text += &format!("\nbest of {} that meet the wish, of {of} {among}", self.suitable);
        if self.files.is_empty() {
            text += "\nit has no files of its own: it is not on the front; candidates.jsonl has its genome";
        }
        for file in &self.files {
            text += &format!("\n{}", file.display());
        }
        text
    }
}

/// The objectives of a design that are `asked` in this way, by name.
fn values_of(evaluation: &Evaluation, asked: Asked) -> BTreeMap<String, f64> {
    let values = evaluation.known().filter(|(objective, _)| objective.asked == asked);
    values.map(|(objective, value)| (objective.name.to_owned(), value)).collect()
}

/// The files of a member of the front, but for the single pictures of its series.
fn files_of(folder: &RunFolder, id: IndividualId) -> Vec<PathBuf> {
    let design: &Path = &folder.path().join("front").join(id.to_string());
    let entries = std::fs::read_dir(design).into_iter().flatten().flatten();
    let mut files: Vec<PathBuf> = entries
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_none_or(|extension| extension != "vtu"))
        .collect();
    files.sort();
    files
}

/// Four significant digits.
fn short(value: f64) -> String {
    let decimals =
        if value == 0.0 { 0 } else { 3 - value.abs().log10().floor().clamp(-9.0, 3.0) as i32 };
    let text = format!("{value:.*}", decimals.max(0) as usize);
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fitness::objective;

    #[test]
    fn wishes_are_read_with_names_or_units() {
        let read = |text: &str| Phrases::parse(text).unwrap();
        let bound = |quantity, is_least, value| Bound { quantity, is_least, value };
        let wish = read("At least 20 N, at most angle 90 deg, most F_bf");
        assert_eq!(
            wish.bounds,
            [bound(Quantity::Force, true, 20.0), bound(Quantity::Angle, false, 90.0)]
        );
        let blocking = Quantity::Objective(objective("blocking").unwrap());
        assert_eq!(wish.aims, [Aim { quantity: blocking, is_most: true }]);
        let volume = &read("at least force 20, least wall volume").aims[0];
        assert!(!volume.is_most && volume.quantity.unit() == "cm^3");
        assert_eq!(read(""), Phrases::default());
    }

    #[test]
    fn what_is_no_wish_is_told() {
        let refused = |phrases: &str, word: &str| {
            let error = Phrases::parse(phrases).unwrap_err().to_string();
            assert!(error.contains(word), "{error}");
        };
        refused("most beauty", "`beauty` is nothing that a run knows");
        refused("at least 20, most angle", "names neither");
        refused("at least force 20 kPa, most angle", "force is in N, not in kPa");
        refused("at least force, most angle", "one number");
        refused("at least nan N, most angle", "finite");
        refused("more force", "should begin with");
    }

    #[test]
    fn numbers_are_short() {
        let told = [0.0, 20.0, 43.216, 1234.56, 123456.0, 0.000_123_46, -0.5].map(short);
        assert_eq!(told, ["0", "20", "43.22", "1235", "123456", "0.0001235", "-0.5"]);
    }
}
