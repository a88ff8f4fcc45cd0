//! How far a design of the front depends on the mesh of the search: it is evaluated again with longer edges.
//!
//! ```text
//! error of Q(h)  =  |Q(r h) - Q(h)| / (r^2 - 1)      r = 4/3, of a method of second order
//! ```
//!
//! Source: Roache (1994), Perspective: a method for uniform reporting of grid refinement studies, J. Fluids Eng. 116.

use serde::{Deserialize, Serialize};

use crate::fitness::{CandidateSettings, Evaluation, Outcome};
use crate::report::MeshError;

/// The longer edges over those of the search.
const COARSER: f64 = 4.0 / 3.0;

/// One row of `front_error.csv`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct MeshErrorRow {
    pub id: String,
    pub edge_mm: f64,
    pub coarser_edge_mm: f64,
    /// Objectives with the longer edges; none where the design is rejected with them.
    pub bending_coarser: Option<f64>,
    pub blocking_coarser: Option<f64>,
    pub bending_error_percent: Option<f64>,
    pub blocking_error_percent: Option<f64>,
    /// Why it is rejected with the longer edges.
    pub rejected: Option<String>,
}

impl MeshErrorRow {
    /// The row of the design `id`, which has the `evaluation` with the `settings` of the search and the outcome `coarser` with
    /// those of [`coarser`].
    pub(super) fn new(
        id: String,
        settings: &CandidateSettings,
        evaluation: &Evaluation,
        coarser: &Outcome,
    ) -> Self {
        let (second, rejected) = match coarser {
            Outcome::Evaluated(second) => (Some(second), None),
            Outcome::Rejected(rejected) => (None, Some(rejected.reason.clone())),
        };
        let bending_coarser = second.map(|second| second.bending);
        let blocking_coarser = second.map(|second| second.blocking);
        Self {
            id,
            edge_mm: settings.mesh.edge,
            coarser_edge_mm: COARSER * settings.mesh.edge,
            bending_coarser,
            blocking_coarser,
            bending_error_percent: percent(evaluation.bending, bending_coarser),
            blocking_error_percent: percent(evaluation.blocking, blocking_coarser),
            rejected,
        }
    }

    pub(super) fn error(&self) -> MeshError {
        MeshError {
            bending_percent: self.bending_error_percent,
            blocking_percent: self.blocking_error_percent,
        }
    }
}

/// The `settings` of a search with longer edges.
pub(super) fn coarser(settings: &CandidateSettings) -> CandidateSettings {
    let mut coarser = settings.clone();
    coarser.mesh.edge *= COARSER;
    coarser
}

/// The error of `value`, % of it, by what longer edges make of it; none where they make nothing, or something of nothing.
fn percent(value: f64, coarser: Option<f64>) -> Option<f64> {
    let change = (coarser? - value).abs();
    let percent = 100.0 * change / (COARSER * COARSER - 1.0) / value.abs();
    match (change, percent) {
        (0.0, _) => Some(0.0),
        (_, percent) => percent.is_finite().then_some(percent),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a quantity `1 + c h^2` the estimate is `c h^2 / (1 + c h^2)` exactly.
    #[test]
    fn errors_of_second_order_are_met() {
        for (c, h) in [(0.01, 3.0), (-0.02, 2.0)] {
            let at = |h: f64| 1.0 + c * h * h;
            let estimate = percent(at(h), Some(at(COARSER * h))).unwrap();
            let exact = 100.0 * (at(h) - 1.0).abs() / at(h);
            assert!((estimate - exact).abs() < 1e-12, "{estimate} {exact}");
        }
        assert_eq!(percent(0.0, Some(0.0)), Some(0.0));
        assert_eq!(percent(0.0, Some(1.0)), None);
        assert_eq!(percent(1.0, None), None);
    }
}
