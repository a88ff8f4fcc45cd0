//! How far a design of the front depends on the mesh of the search: it is evaluated again with a second one, of longer edges; where
//! these cannot follow it, of shorter ones.
//!
//! ```text
//! error of Q(h)  =  |Q(r h) - Q(h)| / (r^2 - 1)  =  |Q(h / r) - Q(h)| r^2 / (r^2 - 1)      r = 4/3, second order
//! ```
//!
//! Source: Roache (1994), Perspective: a method for uniform reporting of grid refinement studies, J. Fluids Eng. 116.

use serde::{Deserialize, Serialize};

use crate::fitness::{CandidateSettings, Evaluation, Outcome, evaluate_network};
use crate::genome::Network;
use crate::report::MeshError;

/// The longer edges over the shorter ones.
const RATIO: f64 = 4.0 / 3.0;

/// One row of `front_error.csv`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct MeshErrorRow {
    pub id: String,
    pub edge_mm: f64,
    pub second_edge_mm: f64,
    /// Objectives with the second mesh; none where the design is rejected with both longer and shorter edges.
    pub bending_second: Option<f64>,
    pub blocking_second: Option<f64>,
    pub bending_error_percent: Option<f64>,
    pub blocking_error_percent: Option<f64>,
    /// Why it is rejected with the last of them.
    pub rejected: Option<String>,
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
            bending_second: None,
            blocking_second: None,
            bending_error_percent: None,
            blocking_error_percent: None,
            rejected: None,
        };
        for ratio in [RATIO, 1.0 / RATIO] {
            let mut second = settings.clone();
            second.mesh.edge *= ratio;
            row.second_edge_mm = second.mesh.edge;
            match evaluate_network(network, &second)?.outcome {
                Outcome::Evaluated(second) => {
                    row.bending_second = Some(second.bending);
                    row.blocking_second = Some(second.blocking);
                    row.bending_error_percent = percent(evaluation.bending, second.bending, ratio);
                    row.blocking_error_percent =
                        percent(evaluation.blocking, second.blocking, ratio);
                    row.rejected = None;
                    break;
                }
                Outcome::Rejected(rejected) => row.rejected = Some(rejected.reason),
            }
        }
        Ok(row)
    }

    pub(crate) fn error(&self) -> MeshError {
        MeshError {
            bending_percent: self.bending_error_percent,
            blocking_percent: self.blocking_error_percent,
        }
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
