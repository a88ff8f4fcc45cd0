//! `compare`: what CalculiX made of a deck, beside our own answer.
//!
//! ```text
//! difference   |tip_ours - tip_theirs| / |tip_ours|        at each sample of the pressure
//! of nodes     max_i |u_ours_i - u_theirs_i|               at the last one, where solid.frd has it
//! ```

use std::path::Path;

use anyhow::{Context, ensure};
use serde::{Deserialize, Serialize};

use super::deck::{CASE, DISPLACEMENT, NodeRow, PATH, TipRow};
use super::say;
use crate::io::{InputError, calculix, csv, input};
use crate::math::Vec3;

/// What is read of `case.json`.
#[derive(Debug, Deserialize)]
struct Case {
    design: String,
    /// MPa.
    pressure: f64,
}

/// Both answers of one case.
#[derive(Debug, Serialize)]
struct Comparison {
    design: String,
    samples: Vec<Sample>,
    /// The largest difference of a sample, as a share.
    largest_difference: f64,
    /// None where there is no `solid.frd`, or it ends before the largest pressure.
    nodes: Option<NodalDifference>,
}

/// Both tips at one pressure.
#[derive(Clone, Copy, Debug, Serialize)]
struct Sample {
    /// MPa.
    pressure: f64,
    /// mm.
    tip: [f64; 3],
    tip_calculix: [f64; 3],
    /// As a share.
    difference: f64,
}

/// The node at which the answers differ most, under the largest pressure.
#[derive(Clone, Copy, Debug, Serialize)]
struct NodalDifference {
    /// From 1, as in the deck.
    node: u32,
    /// mm.
    difference: f64,
    /// Of our largest displacement.
    share: f64,
}

/// How near a time or pressure must be to the one that was asked for: a table has seven digits.
const SAME: f64 = 1e-5;

/// Compares the answers in the folder `path` of a deck.
pub(super) fn run(path: &Path, json: bool) -> anyhow::Result<()> {
    let file = |name: &str| path.join(name);
    ensure!(
        file(CASE).is_file(),
        "{} is not the folder of a deck: it has no {CASE}; `pneumorph deck` makes one",
        path.display()
    );
    let case: Case = serde_json::from_str(&text(&file(CASE))?)
        .with_context(|| file(CASE).display().to_string())?;
    let rows: Vec<TipRow> = csv::parse(&text(&file(PATH))?, &file(PATH))?;
    let answer = file("solid.dat");
    ensure!(
        answer.is_file(),
        "{} is not there: CalculiX writes it, by `ccx solid` in {}",
        answer.display(),
        path.display()
    );
    let tips = calculix::read_tip(&answer)?;
    let reached = tips.last().map_or(0.0, |tip| tip.time);
    let samples: Vec<Sample> = rows.iter().filter_map(|row| sample(row, &tips, &case)).collect();
    let is_complete = reached > 1.0 - SAME && samples.len() + 1 == rows.len();
    let comparison = Comparison {
        design: case.design,
        largest_difference: samples.iter().map(|sample| sample.difference).fold(0.0, f64::max),
        nodes: if is_complete { nodal_difference(path)? } else { None },
        samples,
    };
    if !comparison.samples.is_empty() {
        say(&if json { serde_json::to_string_pretty(&comparison)? } else { comparison.in_words() });
    }
    ensure!(
        is_complete,
        "{} ends at {:.4} of {:.4} MPa: CalculiX gave up, solid.sta tells where; `pneumorph deck` with a smaller --pressure may pass",
        answer.display(),
        reached * case.pressure,
        case.pressure
    );
    Ok(())
}

/// Ours and theirs at the pressure of `row`; none at rest, and where theirs is missing.
fn sample(row: &TipRow, tips: &[calculix::TipAnswer], case: &Case) -> Option<Sample> {
    let time = row.pressure / case.pressure;
    let theirs = tips.iter().find(|tip| (tip.time - time).abs() < SAME)?.tip;
    let ours = Vec3::new(row.tip_x, row.tip_y, row.tip_z);
    let difference = (ours - theirs).norm() / ours.norm();
    difference.is_finite().then(|| Sample {
        pressure: row.pressure,
        tip: ours.into(),
        tip_calculix: theirs.into(),
        difference,
    })
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
    let mut largest = NodalDifference { node: 0, difference: 0.0, share: 0.0 };
    for (node, u) in theirs.displacements {
        let row = (node as usize).checked_sub(1).and_then(|place| ours.get(place));
        let row = row.with_context(|| {
            format!("{} has a node {node}, which {DISPLACEMENT} lacks", file.display())
        })?;
        let difference = (displacement(row) - u).norm();
        if difference > largest.difference {
            largest = NodalDifference { node, difference, share: 0.0 };
        }
    }
    let scale = ours.iter().map(|row| displacement(row).norm()).fold(0.0, f64::max);
    Ok(Some(NodalDifference { share: largest.difference / scale, ..largest }))
}

fn text(path: &Path) -> Result<String, InputError> {
    input::text(path, input::DATA)
}

impl Comparison {
    fn in_words(&self) -> String {
        let place = |[x, y, z]: [f64; 3]| format!("({x:+8.3}, {y:+8.3}, {z:+8.3})");
        let mut lines = vec![format!(
            "{:>10}  {:^30}  {:^30}  {:>12}",
            "MPa", "our tip, mm", "CalculiX' tip, mm", "difference"
        )];
        lines.extend(self.samples.iter().map(|sample| {
            format!(
                "{:>10.5}  {}  {}  {:>10.3} %",
                sample.pressure,
                place(sample.tip),
                place(sample.tip_calculix),
                100.0 * sample.difference
            )
        }));
        let largest = 100.0 * self.largest_difference;
        lines.push(format!("{}: tips differ by {largest:.3} % at most", self.design));
        if let Some(NodalDifference { node, difference, share }) = self.nodes {
            lines.push(format!(
                "of all nodes, node {node} differs most at the last pressure: by {difference:.4} mm, {:.3} % of the largest displacement",
                100.0 * share
            ));
        }
        lines.join("\n")
    }
}
