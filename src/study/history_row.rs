//! A row of `history.csv`: how a search stands after a generation.

use std::collections::BTreeMap;

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::fitness::OBJECTIVES;
use crate::io::csv::{self, Cell, Cells};

/// One row of `history.csv`.
#[derive(Clone, Debug, Deserialize)]
pub struct HistoryRow {
    /// Its number, from 0.
    pub generation: usize,
    /// How many candidates it had.
    pub evaluated: usize,
    /// How many of them have objectives.
    pub feasible: usize,
    /// How many designs are on the front after it.
    pub front: usize,
    /// Of objectives, that the front dominates.
    pub hypervolume: f64,
    /// Of each objective its best value on the front, in its unit, by name.
    #[serde(flatten, deserialize_with = "best_of_objectives")]
    pub best: BTreeMap<String, f64>,
    /// How evenly the front is spread; small is even.
    pub spread: f64,
}

/// The objectives of which there are columns with a number.
fn best_of_objectives<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<BTreeMap<String, f64>, D::Error> {
    let best =
        |(name, value): (String, Option<f64>)| Some((name.strip_prefix(BEST)?.to_owned(), value?));
    Ok(csv::numbers(deserializer)?.into_iter().filter_map(best).collect())
}

/// Before the name of an objective in the history.
const BEST: &str = "best_";

impl HistoryRow {
    /// A line for a person, of a generation among so many.
    #[must_use]
    pub fn in_words(&self, generations: usize) -> String {
        let best = OBJECTIVES.iter().filter_map(|one| Some((one, self.best.get(one.name)?)));
        let words = best.map(|(one, value)| {
            format!("best {} {value:.*}{}", one.title(), one.decimals, one.told_unit())
        });
        format!(
            "generation {:3} of {generations}: {:3} of {} feasible, {:2} on the front, {}, hypervolume {:.4e}",
            self.generation + 1,
            self.feasible,
            self.evaluated,
            self.front,
            words.collect::<Vec<_>>().join(", "),
            self.hypervolume
        )
    }
}

impl Cells for HistoryRow {
    fn cells(&self) -> Vec<(String, Cell<'_>)> {
        let best = OBJECTIVES.iter().filter_map(|one| {
            Some((format!("{BEST}{}", one.name), Cell::Number(*self.best.get(one.name)?)))
        });
        let begin = [
            ("generation", Cell::Count(self.generation)),
            ("evaluated", Cell::Count(self.evaluated)),
            ("feasible", Cell::Count(self.feasible)),
            ("front", Cell::Count(self.front)),
            ("hypervolume", Cell::Number(self.hypervolume)),
        ];
        let begin = begin.into_iter().map(|(name, cell)| (name.to_owned(), cell));
        begin.chain(best).chain([("spread".to_owned(), Cell::Number(self.spread))]).collect()
    }
}

impl Serialize for HistoryRow {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        csv::as_map(self, serializer)
    }
}
