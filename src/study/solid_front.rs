//! The second stage of a search: its front as solids, the designs that this may bring to the front, and the front of all of them.
//!
//! ```text
//! s(c) = max over solids m of  min over k  m_k / c_k         the gain that brings shell c level with the solids' front
//! promoted where  s(c) < 1 + largest gain of a solid over its shell,  those with the least s first
//! ```

use anyhow::Context;

use super::certify::{CertifiedRows, Certifying, Design, Row};
use super::run_folder::Record;
use crate::batch::Threads;
use crate::evolve::IndividualId;
use crate::fitness::Outcome;
use crate::genome::Genome;

/// What the second stage found.
pub(crate) struct SolidFront {
    /// The shells' front, then what was promoted.
    pub rows: Vec<Row>,
    /// How many of the rows are of the shells' front.
    pub of_front: usize,
    /// The rows that no other solid is better than in both objectives.
    pub front: Vec<Row>,
}

impl SolidFront {
    /// Certifies the `front` of a search and what its solids promote among the `records`; nothing where that was stopped.
    pub(crate) fn new(
        front: &[IndividualId],
        records: &[Record],
        certifying: &Certifying<'_>,
        executor: &Threads,
    ) -> anyhow::Result<Option<Self>> {
        let design = |record: &Record| {
            let genome = Genome::try_from(record.genome.clone())?;
            anyhow::Ok(Design { name: record.id.to_string(), network: genome.decode() })
        };
        let of = |id: &IndividualId| {
            let record = records.iter().find(|record| record.id == *id);
            design(record.with_context(|| format!("candidates.jsonl lacks {id}"))?)
        };
        let designs = front.iter().map(of).collect::<anyhow::Result<Vec<_>>>()?;
        let certified = |designs: &[Design]| {
            let CertifiedRows { rows, is_complete } = certifying.rows(designs, executor)?;
            anyhow::Ok(is_complete.then_some(rows))
        };
        let Some(mut rows) = certified(&designs)? else { return Ok(None) };
        let of_front = rows.len();
        let others: Vec<(&Record, [f64; 2])> = records
            .iter()
            .filter(|record| !front.contains(&record.id))
            .filter_map(|record| match &record.outcome {
                Outcome::Evaluated(shell) => Some((record, [shell.bending, shell.blocking])),
                Outcome::Rejected(_) => None,
            })
            .collect();
        let objectives: Vec<[f64; 2]> = others.iter().map(|(_, objectives)| *objectives).collect();
        let designs = promoted(&rows, &objectives)
            .into_iter()
            .map(|other| design(others[other].0))
            .collect::<anyhow::Result<Vec<_>>>()?;
        let Some(promoted) = certified(&designs)? else { return Ok(None) };
        rows.extend(promoted);
        let front = front_of(&rows);
        Ok(Some(Self { rows, of_front, front }))
    }
}

/// Those of `shells` (both objectives, larger is better) that may belong to the front of the solids of `rows`, at most as many as
/// there are rows, the likeliest first.
fn promoted(rows: &[Row], shells: &[[f64; 2]]) -> Vec<usize> {
    let solids: Vec<[f64; 2]> = rows.iter().filter_map(Row::solid_objectives).collect();
    if solids.is_empty() {
        return Vec::new();
    }
    let gains = rows.iter().filter_map(|row| {
        let [bending, blocking] = row.solid_objectives()?;
        Some((bending / row.bending_shell?).max(blocking / row.blocking_shell?))
    });
    let largest = gains.filter(|gain| gain.is_finite()).fold(1.0, f64::max);
    let needed = |shell: &[f64; 2]| {
        let level = |solid: &[f64; 2]| (solid[0] / shell[0]).min(solid[1] / shell[1]);
        solids.iter().map(level).fold(0.0, f64::max)
    };
    let mut near: Vec<(f64, usize)> =
        shells.iter().map(needed).zip(0..).filter(|(needed, _)| *needed < largest).collect();
    near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    near.into_iter().take(rows.len()).map(|(_, shell)| shell).collect()
}

/// The rows whose solids no other one is better than, by falling bending objective.
fn front_of(rows: &[Row]) -> Vec<Row> {
    let solids: Vec<(&Row, [f64; 2])> =
        rows.iter().filter_map(|row| Some((row, row.solid_objectives()?))).collect();
    let is_dominated = |[x, y]: [f64; 2]| {
        solids.iter().any(|(_, [a, b])| *a >= x && *b >= y && (*a > x || *b > y))
    };
    let mut front: Vec<_> =
        solids.iter().filter(|(_, objectives)| !is_dominated(*objectives)).collect();
    front.sort_by(|a, b| b.1[0].total_cmp(&a.1[0]).then_with(|| a.0.design.cmp(&b.0.design)));
    front.into_iter().map(|(row, _)| (*row).clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(design: &str, shell: [f64; 2], solid: Option<[f64; 2]>) -> Row {
        Row {
            bending_shell: Some(shell[0]),
            blocking_shell: Some(shell[1]),
            bending_solid: solid.map(|solid| solid[0]),
            blocking_solid: solid.map(|solid| solid[1]),
            ..Row::new(design)
        }
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
        assert_eq!(promoted(&rows, &shells), [2, 0, 3]);
        assert_eq!(promoted(&rows[..2], &shells), [2, 0]);
        assert!(promoted(&[], &shells).is_empty());
    }
}
