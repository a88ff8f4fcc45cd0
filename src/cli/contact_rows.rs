//! `contact.csv` and the planes of `summary.json`: how a part touches each plane.

use std::path::Path;

use serde::Serialize;

use crate::io::{OutputError, csv};
use crate::model::PartModel;
use crate::model::contact::PlaneState;
use crate::solve::PathPoint;

/// A plane in `summary.json`, at the last state.
#[derive(Debug, Serialize)]
pub(super) struct PlaneSummary {
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

/// A row of `contact.csv`; as [`PlaneSummary`].
#[derive(Debug, Serialize)]
struct Row {
    step: usize,
    /// In the order of the scene, from 0.
    plane: usize,
    load: f64,
    force_x: f64,
    force_y: f64,
    force_z: f64,
    friction_x: f64,
    friction_y: f64,
    friction_z: f64,
    /// Empty where the part does not touch the plane.
    centre_x: Option<f64>,
    centre_y: Option<f64>,
    centre_z: Option<f64>,
    area: f64,
    bearing_area: f64,
    smallest_gap: f64,
}

/// The planes at the last of `points`.
pub(super) fn plane_summaries(model: &PartModel, points: &[PathPoint]) -> Vec<PlaneSummary> {
    let summary = |state: PlaneState| PlaneSummary {
        force: state.force.into(),
        friction: state.friction.into(),
        centre: state.centre.map(Into::into),
        area: state.area,
        bearing_area: state.bearing_area,
        smallest_gap: state.smallest_gap,
    };
    let states = points.last().map(|point| model.plane_states(&point.x)).unwrap_or_default();
    states.into_iter().map(summary).collect()
}

/// Writes `contact.csv`, every plane at every one of `points`; nothing where the scene has no planes.
pub(super) fn write_contact(
    folder: &Path,
    model: &PartModel,
    points: &[PathPoint],
) -> Result<(), OutputError> {
    let rows = points.iter().enumerate().flat_map(|(step, point)| {
        let states = model.plane_states(&point.x).into_iter().enumerate();
        states.map(move |(plane, state)| row(step, plane, point.load, state))
    });
    let rows: Vec<Row> = rows.collect();
    if rows.is_empty() {
        return Ok(());
    }
    csv::write(&folder.join("contact.csv"), &rows)
}

fn row(step: usize, plane: usize, load: f64, state: PlaneState) -> Row {
    let PlaneState { force, friction, centre, area, bearing_area, smallest_gap } = state;
    Row {
        step,
        plane,
        load,
        force_x: force.x,
        force_y: force.y,
        force_z: force.z,
        friction_x: friction.x,
        friction_y: friction.y,
        friction_z: friction.z,
        centre_x: centre.map(|centre| centre.x),
        centre_y: centre.map(|centre| centre.y),
        centre_z: centre.map(|centre| centre.z),
        area,
        bearing_area,
        smallest_gap,
    }
}
