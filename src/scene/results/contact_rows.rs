//! `contact.csv` and the planes of `summary.json`: how a part touches each plane.

use std::path::Path;

use serde::Serialize;

use super::path_rows::{LoadKind, State};
use crate::io::OutputError;
use crate::io::csv::{Cell, Table};
use crate::math::Vec3;
use crate::model::contact::PlaneState;
use crate::solve::PathPoint;

/// A plane in `summary.json`, at the last state.
#[derive(Debug, Serialize)]
pub(crate) struct PlaneSummary {
    /// With which the part presses on the plane, N.
    force: [f64; 3],
    /// With which it drags the plane along, N.
    friction: [f64; 3],
    /// Of pressure, mm; none where the part does not touch the plane.
    centre: Option<[f64; 3]>,
    /// Of the wall at rest that the barrier pushes on, mm^2.
    area: f64,
    /// That would bear the force at a uniform pressure, mm^2.
    bearing_area: f64,
    /// mm.
    smallest_gap: f64,
}

impl From<&PlaneState> for PlaneSummary {
    fn from(state: &PlaneState) -> Self {
        Self {
            force: state.force.into(),
            friction: state.friction.into(),
            centre: state.centre.map(Into::into),
            area: state.area,
            bearing_area: state.bearing_area,
            smallest_gap: state.smallest_gap,
        }
    }
}

/// The planes at the last of `states`.
pub(crate) fn plane_summaries(states: &[State]) -> Vec<PlaneSummary> {
    let planes = states.last().map(|state| state.planes.as_slice());
    planes.unwrap_or_default().iter().map(Into::into).collect()
}

/// The force on each of the `planes`, as clauses of a sentence.
pub(crate) fn planes_in_words(planes: &[PlaneSummary]) -> String {
    let force = |(plane, summary): (usize, &PlaneSummary)| {
        let force = Vec3::from(summary.force).norm();
        format!(", plane {plane} pressed with {force:.3} N")
    };
    planes.iter().enumerate().map(force).collect()
}

/// Writes `contact.csv`, every plane at every one of `points`; nothing where the scene has no planes.
pub(crate) fn write_contact(
    folder: &Path,
    load: LoadKind,
    points: &[PathPoint],
    states: &[State],
) -> Result<(), OutputError> {
    let rows: Vec<(usize, f64, usize, &PlaneState)> = points
        .iter()
        .zip(states)
        .enumerate()
        .flat_map(|(step, (point, state))| {
            let planes = state.planes.iter().enumerate();
            planes.map(move |(plane, state)| (step, point.load, plane, state))
        })
        .collect();
    if rows.is_empty() {
        return Ok(());
    }
    let mut table = Table::default();
    table.push("step", rows.iter().map(|row| Cell::Count(row.0)));
    table.push("plane", rows.iter().map(|row| Cell::Count(row.2)));
    table.push_numbers(load.column(), rows.iter().map(|row| row.1));
    let mut push = |name: &str, unit: &str, of: &dyn Fn(&PlaneState) -> Vec3| {
        for (axis, letter) in ["x", "y", "z"].into_iter().enumerate() {
            let components = rows.iter().map(|row| of(row.3)[axis]);
            table.push_numbers(format!("{name}_{letter}_{unit}"), components);
        }
    };
    push("force", "N", &|state| state.force);
    push("friction", "N", &|state| state.friction);
    for (axis, letter) in ["x", "y", "z"].into_iter().enumerate() {
        // Empty where the part does not touch the plane.
        let centre = |state: &PlaneState| state.centre.map(|centre| centre[axis]);
        let cells = rows.iter().map(|row| centre(row.3).map_or(Cell::Nothing, Cell::Number));
        table.push(format!("centre_{letter}_mm"), cells);
    }
    table.push_numbers("area_mm2", rows.iter().map(|row| row.3.area));
    table.push_numbers("bearing_area_mm2", rows.iter().map(|row| row.3.bearing_area));
    table.push_numbers("smallest_gap_mm", rows.iter().map(|row| row.3.smallest_gap));
    table.write(&folder.join("contact.csv"))
}
