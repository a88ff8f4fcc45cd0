//! The second stage of a search: its front as solids, the designs that this may bring to the front, and the front of all of them.
//!
//! ```text
//! s(c) = max over solids m of  min over k  m_k / c_k         the gain that brings shell c level with the solids' front
//! promoted where  s(c) < 1 + largest gain of a solid over its shell,  those with the least s first
//! ```
//!
//! Of an objective that is to be small the gain is `c_k / m_k`.

use anyhow::Context;

use super::certificate_row::{OfBoth, Row};
use super::certify::{CertifiedRows, Certifying, Design};
use super::inherited::Inherited;
use super::run_folder::Record;
use crate::batch::Threads;
use crate::evolve::IndividualId;
use crate::fitness::{Objective, Outcome, Sense};

/// What the second stage found.
pub(crate) struct SolidFront {
    /// The shells' front, then what was promoted.
    pub rows: Vec<Row>,
    /// How many of the rows are of the shells' front.
    pub of_front: usize,
    /// The rows that no other solid is better than in all objectives.
    pub front: Vec<Row>,
}

impl SolidFront {
    /// Certifies the `front` of a search and what its solids promote among the `records`; nothing where that was stopped.
    pub(crate) fn new(
        front: &[IndividualId],
        records: &[Record],
        representation: &Inherited,
        certifying: &Certifying<'_>,
        executor: &Threads,
    ) -> anyhow::Result<Option<Self>> {
        let design = |record: &Record| Design {
            name: record.id.to_string(),
            network: record.network(representation),
        };
        let of = |id: &IndividualId| {
            let record = records.iter().find(|record| record.id == *id);
            record.map(design).with_context(|| format!("candidates.jsonl lacks {id}"))
        };
        let designs = front.iter().map(of).collect::<anyhow::Result<Vec<_>>>()?;
        let certified = |designs: &[Design]| {
            let CertifiedRows { rows, is_complete } = certifying.rows(designs, executor)?;
            anyhow::Ok(is_complete.then_some(rows))
        };
        let Some(mut rows) = certified(&designs)? else { return Ok(None) };
        let of_front = rows.len();
        let others: Vec<(&Record, Values)> = records
            .iter()
            .filter(|record| !front.contains(&record.id))
            .filter_map(|record| match &record.outcome {
                Outcome::Evaluated(shell) => Some((record, shell.known().collect())),
                Outcome::Rejected(_) => None,
            })
            .collect();
        let objectives: Vec<&Values> = others.iter().map(|(_, objectives)| objectives).collect();
        let promoted = promoted(&rows, &objectives).into_iter();
        let designs: Vec<_> = promoted.map(|other| design(others[other].0)).collect();
        let Some(promoted) = certified(&designs)? else { return Ok(None) };
        rows.extend(promoted);
        let front = front_of(&rows);
        Ok(Some(Self { rows, of_front, front }))
    }
}

/// Objectives with their values, in the order of the list of objectives.
type Values = Vec<(&'static Objective, f64)>;

/// By how much `better` is better than `value`, as a quotient.
fn gain(objective: &Objective, better: f64, value: f64) -> f64 {
    match objective.sense {
        Sense::Largest => better / value,
        Sense::Least => value / better,
    }
}

/// Those of `shells` that may belong to the front of the solids of `rows`, at most as many as there are rows, the likeliest first.
fn promoted(rows: &[Row], shells: &[&Values]) -> Vec<usize> {
    let solids: Vec<Values> = rows.iter().filter_map(Row::solid_objectives).collect();
    if solids.is_empty() {
        return Vec::new();
    }
    let of_both = |of_both: &OfBoth| Some(gain(of_both.objective, of_both.solid?, of_both.shell?));
    let gains = rows.iter().filter_map(|row| {
        let gains: Option<Vec<f64>> = row.objectives.iter().map(of_both).collect();
        gains?.into_iter().reduce(f64::max)
    });
    let largest = gains.filter(|gain| gain.is_finite()).fold(1.0, f64::max);
    let needed = |shell: &&Values| {
        let level = |solid: &Values| {
            let gains =
                solid.iter().zip(*shell).map(|((k, solid), (_, shell))| gain(k, *solid, *shell));
            gains.reduce(f64::min).unwrap_or(0.0)
        };
        solids.iter().map(level).fold(0.0, f64::max)
    };
    let mut near: Vec<(f64, usize)> =
        shells.iter().map(needed).zip(0..).filter(|(needed, _)| *needed < largest).collect();
    near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    near.into_iter().take(rows.len()).map(|(_, shell)| shell).collect()
}

/// The rows whose solids no other one is better than, the best by the first objective first.
fn front_of(rows: &[Row]) -> Vec<Row> {
    let minimized = |row: &Row| -> Option<Vec<f64>> {
        Some(row.solid_objectives()?.iter().map(|(k, value)| k.minimized(*value)).collect())
    };
    let solids: Vec<(&Row, Vec<f64>)> =
        rows.iter().filter_map(|row| Some((row, minimized(row)?))).collect();
    let is_better = |a: &[f64], b: &[f64]| {
        a.iter().zip(b).all(|(a, b)| a <= b) && a.iter().zip(b).any(|(a, b)| a < b)
    };
    let is_dominated = |b: &[f64]| solids.iter().any(|(_, a)| is_better(a, b));
    let mut front: Vec<_> = solids.iter().filter(|(_, values)| !is_dominated(values)).collect();
    front.sort_by(|a, b| a.1[0].total_cmp(&b.1[0]).then_with(|| a.0.design.cmp(&b.0.design)));
    front.into_iter().map(|(row, _)| (*row).clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fitness::OBJECTIVES;

    fn row(design: &str, shell: [f64; 2], solid: Option<[f64; 2]>) -> Row {
        let mut row = Row::new(design, OBJECTIVES[..2].iter());
        for (k, of_both) in row.objectives.iter_mut().enumerate() {
            (of_both.shell, of_both.solid) = (Some(shell[k]), solid.map(|solid| solid[k]));
        }
        row
    }

    #[test]
    fn front_is_of_solids() {
        let rows = [
            row("a", [3.0, 1.0], Some([1.0, 1.0])),
            row("b", [2.0, 2.0], Some([2.0, 2.0])),
            row("c", [1.0, 3.0], Some([1.0, 3.0])),
            row("d", [9.0, 9.0], None),
        ];
        let names: Vec<_> = front_of(&rows).into_iter().map(|row| row.design).collect();
        assert_eq!(names, ["b", "c"]);
    }

    /// A shell is promoted where the largest gain seen may lift it over the solids' front.
    #[test]
    fn promotion_follows_the_largest_gain() {
        let rows = [
            row("a", [2.0, 1.0], Some([2.0, 1.1])),
            row("b", [1.0, 2.0], Some([1.0, 1.8])),
            row("c", [1.0, 1.0], None),
        ];
        // The gain is 1.1; needed are 0.947, 2.2, 0.733 and 1.059. No more are promoted than there are rows.
        let shells = [[0.95, 1.9], [0.5, 0.5], [1.5, 1.5], [0.8, 1.7]];
        let shells = shells.map(|values| OBJECTIVES.iter().zip(values).collect::<Values>());
        let shells: Vec<&Values> = shells.iter().collect();
        assert_eq!(promoted(&rows, &shells), [2, 0, 3]);
        assert_eq!(promoted(&rows[..2], &shells), [2, 0]);
        assert!(promoted(&[], &shells).is_empty());
    }
}
