//! `compare`: what CalculiX made of a deck, beside our own answer.
//!
//! ```text
//! difference   |tip_ours - tip_theirs| / |tip_ours|        at each sample of the pressure
//! of nodes     max_i |u_ours_i - u_theirs_i|               at the last one, where solid.frd has it
//! ```
//!
//! Its cells lock where the material hardly changes its volume; how much of the difference that makes is said beside it
//! ([`calculix::locking`]). A sample without a base, or without its answer, has no difference.

use std::path::Path;

use anyhow::{Context, ensure};
use serde::{Deserialize, Serialize};

use super::{CASE, DISPLACEMENT, NodeRow, PATH, TipRow};
use crate::io::{InputError, calculix, csv, input};
use crate::math::Vec3;

/// What is read of `case.json`.
#[derive(Debug, Deserialize)]
struct Case {
    design: String,
    /// MPa.
    pressure: f64,
    /// None in a folder written before it was recorded.
    poisson_ratio: Option<f64>,
}

/// Both answers of one case.
#[derive(Debug, Serialize)]
pub(crate) struct Comparison {
    design: String,
    samples: Vec<Sample>,
    /// The largest difference of a sample, as a share; none where none could be compared.
    largest_difference: Option<f64>,
    /// None in a folder written before it was recorded.
    poisson_ratio: Option<f64>,
    /// By how much its tip is known to move less than ours because its cells lock: from, to, as shares.
    expected_locking: Option<[f64; 2]>,
    /// None where there is no `solid.frd`, or it ends before the largest pressure.
    nodes: Option<NodalDifference>,
    /// The largest, MPa.
    #[serde(skip)]
    pressure: f64,
}

/// Both tips at one pressure.
#[derive(Clone, Copy, Debug, Serialize)]
struct Sample {
    /// MPa.
    pressure: f64,
    /// mm.
    tip: [f64; 3],
    /// None where it has no answer.
    tip_calculix: Option<[f64; 3]>,
    /// As a share; none where it has no answer, or either is no number, or ours does not move.
    difference: Option<f64>,
}

/// The node at which the answers differ most, under the largest pressure.
#[derive(Clone, Copy, Debug, Serialize)]
struct NodalDifference {
    /// From 1, as in the deck.
    node: u32,
    /// mm.
    difference: f64,
    /// Of our largest displacement; none where nothing moves.
    share: Option<f64>,
}

/// Where CalculiX writes the tip.
const ANSWER: &str = "solid.dat";

/// How near a time or pressure must be to the one that was asked for: a table has seven digits.
const SAME: f64 = 1e-5;

impl Comparison {
    /// Both answers in the folder `path` of a deck.
    ///
    /// # Errors
    /// When the folder is none of a deck, or CalculiX has not run in it.
    pub(crate) fn read(path: &Path) -> anyhow::Result<Self> {
        let file = |name: &str| path.join(name);
        ensure!(
            file(CASE).is_file(),
            "{} is not the folder of a deck: it has no {CASE}; `pneumorph deck` makes one",
            path.display()
        );
        let case: Case = serde_json::from_str(&text(&file(CASE))?)
            .with_context(|| file(CASE).display().to_string())?;
        let rows: Vec<TipRow> = csv::parse(&text(&file(PATH))?, &file(PATH))?;
        let answer = file(ANSWER);
        ensure!(
            answer.is_file(),
            "{} is not there: CalculiX writes it, by `ccx solid` in {}",
            answer.display(),
            path.display()
        );
        let tips = calculix::read_tip(&answer)?;
        let samples: Vec<Sample> =
            rows.iter().filter(|row| row.step > 0).map(|row| sample(row, &tips, &case)).collect();
        let is_complete = samples.last().is_some_and(|last| last.tip_calculix.is_some());
        let differences = || samples.iter().filter_map(|sample| sample.difference);
        Ok(Self {
            design: case.design,
            largest_difference: differences().reduce(f64::max),
            poisson_ratio: case.poisson_ratio,
            expected_locking: case.poisson_ratio.map(calculix::locking),
            nodes: if is_complete { nodal_difference(path)? } else { None },
            samples,
            pressure: case.pressure,
        })
    }

    /// The largest pressure that CalculiX answered, MPa.
    pub(crate) fn reached(&self) -> Option<f64> {
        let answered = self.samples.iter().filter(|sample| sample.tip_calculix.is_some());
        answered.map(|sample| sample.pressure).next_back()
    }

    /// Refuses answers in the folder `path` that end early, or that cannot be compared.
    ///
    /// # Errors
    /// One sentence that says where and why.
    pub(crate) fn check(&self, path: &Path) -> anyhow::Result<()> {
        ensure!(
            self.samples.last().is_some_and(|last| last.tip_calculix.is_some()),
            "{} ends at {:.4} of {:.4} MPa: {}",
            path.join(ANSWER).display(),
            self.reached().unwrap_or(0.0),
            self.pressure,
            why_it_ends(&path.join("solid.frd"))?
        );
        let missing = self.samples.iter().filter(|sample| sample.difference.is_none()).count();
        ensure!(
            missing == 0,
            "{missing} of {} samples cannot be compared: a tip that does not move, or one that is no number",
            self.samples.len()
        );
        Ok(())
    }
}

/// A program that ends by itself closes its results, also where it found no equilibrium.
fn why_it_ends(results: &Path) -> anyhow::Result<&'static str> {
    Ok(if !results.is_file() {
        "the rest of the answer is not there"
    } else if calculix::is_closed(results)? {
        "CalculiX gave up, solid.sta tells where; `pneumorph deck` with a smaller --pressure may pass"
    } else {
        "CalculiX was stopped before its end, or is still running"
    })
}

/// Ours and theirs at the pressure of `row`.
fn sample(row: &TipRow, tips: &[calculix::TipAnswer], case: &Case) -> Sample {
    let time = row.pressure / case.pressure;
    let theirs = tips.iter().find(|tip| (tip.time - time).abs() < SAME).map(|tip| tip.tip);
    let ours = Vec3::new(row.tip_x, row.tip_y, row.tip_z);
    let difference = theirs.map(|theirs| (ours - theirs).norm() / ours.norm());
    Sample {
        pressure: row.pressure,
        tip: ours.into(),
        tip_calculix: theirs.map(Into::into),
        difference: difference.filter(|difference| difference.is_finite()),
    }
}

fn nodal_difference(path: &Path) -> anyhow::Result<Option<NodalDifference>> {
    let file = path.join("solid.frd");
    if !file.is_file() {
        return Ok(None);
    }
    let Some(theirs) = calculix::read_nodes(&file)?.filter(|theirs| theirs.time > 1.0 - SAME)
    else {
        return Ok(None);
    };
    let name = path.join(DISPLACEMENT);
    let ours: Vec<NodeRow> = csv::parse(&text(&name)?, &name)?;
    let displacement = |row: &NodeRow| Vec3::new(row.x, row.y, row.z);
    let mut largest = NodalDifference { node: 0, difference: 0.0, share: None };
    for (node, u) in theirs.displacements {
        let row = (node as usize).checked_sub(1).and_then(|place| ours.get(place));
        let row = row.with_context(|| {
            format!("{} has a node {node}, which {DISPLACEMENT} lacks", file.display())
        })?;
        let difference = (displacement(row) - u).norm();
        if difference > largest.difference {
            largest = NodalDifference { node, difference, share: None };
        }
    }
    let scale = ours.iter().map(|row| displacement(row).norm()).fold(0.0, f64::max);
    let share = Some(largest.difference / scale).filter(|share| share.is_finite());
    Ok(Some(NodalDifference { share, ..largest }))
}

fn text(path: &Path) -> Result<String, InputError> {
    input::text(path, input::DATA)
}

impl Comparison {
    /// A table of the samples and what is to be said of it, for a person.
    pub(crate) fn in_words(&self) -> String {
        let place = |tip: [f64; 3]| match tip {
            [x, y, z] if tip.iter().all(|x| x.is_finite()) => {
                format!("({x:+8.3}, {y:+8.3}, {z:+8.3})")
            }
            _ => format!("{:^30}", "no numbers"),
        };
        let percent = |share: f64| format!("{:.3} %", 100.0 * share);
        let mut lines = vec![format!(
            "{:>10}  {:^30}  {:^30}  {:>12}",
            "MPa", "our tip, mm", "CalculiX' tip, mm", "difference"
        )];
        lines.extend(self.samples.iter().map(|sample| {
            let theirs = sample.tip_calculix.map_or_else(|| "no answer".to_owned(), place);
            let difference = sample.difference.map_or("\u{2014}".to_owned(), percent);
            format!(
                "{:>10.5}  {}  {theirs:^30}  {difference:>12}",
                sample.pressure,
                place(sample.tip)
            )
        }));
        let design = &self.design;
        lines.push(match self.largest_difference {
            Some(largest) => format!("{design}: tips differ by {} at most", percent(largest)),
            None => format!("{design}: nothing could be compared"),
        });
        if let Some(nu) = self.poisson_ratio {
            lines.push(format!(
                "of that, {} is expected: CalculiX' tetrahedra have no pressure of their own and lock, so that its tip moves less",
                calculix::locking_in_percent(nu)
            ));
        }
        if let Some(NodalDifference { node, difference, share }) = self.nodes {
            let share = share.map_or("\u{2014}".to_owned(), percent);
            lines.push(format!(
                "of all nodes, node {node} differs most at the last pressure: by {difference:.4} mm, {share} of the largest displacement"
            ));
        }
        lines.join("\n")
    }
}
