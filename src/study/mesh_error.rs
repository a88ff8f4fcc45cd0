//! How far a design of the front depends on the mesh of the search: it is evaluated again with a second one, of longer edges; where
//! these cannot follow it, of shorter ones.
//!
//! ```text
//! error of Q(h)  =  |Q(r h) - Q(h)| / (r^2 - 1)  =  |Q(h / r) - Q(h)| r^2 / (r^2 - 1)      r = 4/3, second order
//! ```
//!
//! Source: Roache (1994), Perspective: a method for uniform reporting of grid refinement studies, J. Fluids Eng. 116.

use serde::{Deserialize, Deserializer};

use crate::fitness::{
    CandidateSettings, Evaluation, OBJECTIVES, Objective, Outcome, evaluate_network,
};
use crate::genome::Network;
use crate::io::csv::{self, Cell, Cells};

/// The longer edges over the shorter ones.
const RATIO: f64 = 4.0 / 3.0;

/// One row of `front_error.csv`.
#[derive(Clone, Debug, Deserialize)]
pub(crate) struct MeshErrorRow {
    pub id: String,
    pub edge_mm: f64,
    pub second_edge_mm: f64,
    /// The objectives that were asked, in the order of [`OBJECTIVES`].
    #[serde(flatten, deserialize_with = "objectives")]
    pub objectives: Vec<Second>,
    /// Why it is rejected with the last of them.
    pub rejected: Option<String>,
}

/// An objective with the second mesh.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Second {
    pub objective: &'static Objective,
    /// `None` if the design is rejected with both longer and shorter edges.
    pub value: Option<f64>,
    pub error_percent: Option<f64>,
}

/// The objectives of which there are columns.
fn objectives<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<Second>, D::Error> {
    let numbers = csv::numbers(deserializer)?;
    let second = |objective: &'static Objective| {
        let of = |what: &str| numbers.get(&format!("{}_{what}", objective.name)).copied();
        Some(Second { objective, value: of(SECOND)?, error_percent: of(ERROR)? })
    };
    Ok(OBJECTIVES.iter().filter_map(second).collect())
}

const SECOND: &str = "second";
const ERROR: &str = "error_percent";

impl Cells for MeshErrorRow {
    fn cells(&self) -> Vec<(String, Cell<'_>)> {
        let column = |what: &str, of: fn(&Second) -> Option<f64>| -> Vec<(String, Cell<'_>)> {
            let cell = |one: &Second| {
                let number = of(one).map_or(Cell::Nothing, Cell::Number);
                (format!("{}_{what}", one.objective.name), number)
            };
            self.objectives.iter().map(cell).collect()
        };
        let mut cells = vec![
            ("id".to_owned(), Cell::Word(&self.id)),
            ("edge_mm".to_owned(), Cell::Number(self.edge_mm)),
            ("second_edge_mm".to_owned(), Cell::Number(self.second_edge_mm)),
        ];
        cells.extend(column(SECOND, |one| one.value));
        cells.extend(column(ERROR, |one| one.error_percent));
        let rejected = self.rejected.as_deref().map_or(Cell::Nothing, Cell::Word);
        cells.push(("rejected".to_owned(), rejected));
        cells
    }
}

impl MeshErrorRow {
    /// The row of the design `id` of the `network`, which has the `evaluation` with the `settings` of the search.
    ///
    /// # Errors
    /// As [`evaluate_network`].
    pub(crate) fn new(
        id: String,
        network: &Network,
        settings: &CandidateSettings,
        evaluation: &Evaluation,
    ) -> anyhow::Result<Self> {
        let mut row = Self {
            id,
            edge_mm: settings.mesh.edge,
            second_edge_mm: f64::NAN,
            objectives: evaluation
                .known()
                .map(|(objective, _)| Second { objective, value: None, error_percent: None })
                .collect(),
            rejected: None,
        };
        for ratio in [RATIO, 1.0 / RATIO] {
            let mut second = settings.clone();
            second.mesh.edge *= ratio;
            row.second_edge_mm = second.mesh.edge;
            match evaluate_network(network, &second)?.outcome {
                Outcome::Evaluated(second) => {
                    for one in &mut row.objectives {
                        let [first, second] = [evaluation, &second].map(|e| e.value(one.objective));
                        one.value = second;
                        one.error_percent =
                            first.zip(second).and_then(|(a, b)| percent(a, b, ratio));
                    }
                    row.rejected = None;
                    break;
                }
                Outcome::Rejected(rejected) => row.rejected = Some(rejected.reason.to_string()),
            }
        }
        Ok(row)
    }

    /// The error of the objective called `name`, %.
    pub(crate) fn error_percent(&self, name: &str) -> Option<f64> {
        self.objectives.iter().find(|one| one.objective.name == name)?.error_percent
    }
}

/// The error of `value`, % of it, where edges `ratio` times as long make `second` of it; none where they make something of nothing.
fn percent(value: f64, second: f64, ratio: f64) -> Option<f64> {
    let change = (second - value).abs();
    let percent = 100.0 * change / (ratio * ratio - 1.0).abs() / value.abs();
    match (change, percent) {
        (0.0, _) => Some(0.0),
        (_, percent) => percent.is_finite().then_some(percent),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a quantity `1 + c h^2` the estimate is `c h^2 / (1 + c h^2)` exactly, by longer edges and by shorter ones.
    #[test]
    fn errors_of_second_order_are_met() {
        for (c, h) in [(0.01, 3.0), (-0.02, 2.0)] {
            let at = |h: f64| 1.0 + c * h * h;
            let exact = 100.0 * (at(h) - 1.0).abs() / at(h);
            for ratio in [RATIO, 1.0 / RATIO] {
                let estimate = percent(at(h), at(ratio * h), ratio).unwrap();
                assert!((estimate - exact).abs() < 1e-12, "{estimate} {exact}");
            }
        }
        assert_eq!(percent(0.0, 0.0, RATIO), Some(0.0));
        assert_eq!(percent(0.0, 1.0, RATIO), None);
    }
}
