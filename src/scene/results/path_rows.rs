//! `path.csv`: what is read off each state of a path; every column is named with its unit.
//!
//! ```text
//! step  pressure_MPa | load_share  volume_mm3  work_mJ  stored_energy_mJ
//! tip_x_mm tip_y_mm tip_z_mm  angle_deg  tangent_angle_deg                     of what is clamped and has a tip
//! max_displacement_mm  plane_0_force_N plane_1_force_N ..                      in the order of the scene
//! wall_gap_mm  self_contact_force_N                                            with self-contact
//! reaction_force_x_N ..  reaction_moment_x_Nmm ..                              of all supports on the part
//! newton_iterations  step_cuts  stability  is_sample
//! ```

use std::path::Path;

use serde::Serialize;

use super::design_folder::write_pictures;
use crate::fitness::{Observation, Scenarios, Stability};
use crate::io::OutputError;
use crate::io::csv::{Cell, Table};
use crate::mesh::ShellMesh;
use crate::model::contact::PlaneState;
use crate::model::{PartModel, Reaction};
use crate::scene::part::placement::Placed;
use crate::solve::PathPoint;

/// What the loads of a path are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LoadKind {
    /// The pressure in a closed part.
    Pressure,
    /// The share of all loads of a patch.
    Share,
}

impl LoadKind {
    /// Its column in every table.
    pub(crate) fn column(self) -> &'static str {
        match self {
            Self::Pressure => "pressure_MPa",
            Self::Share => "load_share",
        }
    }
}

/// What is read off every state of every part.
#[derive(Clone, Debug)]
pub(crate) struct State {
    pub max_displacement: f64,
    pub planes: Vec<PlaneState>,
    /// With self-contact: the smallest gap, mm, and the force, N.
    pub folds: Option<[f64; 2]>,
    pub reaction: Option<Reaction>,
}

/// The states of `model` at `points`; reactions where these are equilibria.
pub(crate) fn states(
    model: &mut PartModel,
    points: &[PathPoint],
    are_equilibria: bool,
) -> Vec<State> {
    let state = |PathPoint { x, load, memory, .. }: &PathPoint| {
        let sizes = model.vertex_displacements(x).into_iter().map(|u| u.norm());
        State {
            max_displacement: sizes.fold(0.0, f64::max),
            planes: model.plane_states(x, memory),
            folds: model
                .keeps_folds_apart()
                .then(|| [model.smallest_wall_gap(x), model.self_contact_force(x)]),
            reaction: if are_equilibria { model.reaction(x, *load) } else { None },
        }
    };
    points.iter().map(state).collect()
}

/// The table of a path; `tip` has a row for each point, or none where the part has no tip.
pub(crate) fn path_table(
    load: LoadKind,
    points: &[PathPoint],
    states: &[State],
    tip: &[Observation],
) -> Table<'static> {
    let mut table = Table::default();
    table.push("step", (0..points.len()).map(Cell::Count));
    table.push_numbers(load.column(), points.iter().map(|point| point.load));
    if load == LoadKind::Pressure {
        table.push_numbers("volume_mm3", points.iter().map(|point| point.conjugate));
    }
    table.push_numbers("work_mJ", points.iter().map(|point| point.work));
    table.push_numbers("stored_energy_mJ", points.iter().map(|point| point.stored_energy));
    if !tip.is_empty() {
        type Column = (&'static str, fn(&Observation) -> f64);
        let columns: [Column; 5] = [
            ("tip_x_mm", |row| row.tip_x),
            ("tip_y_mm", |row| row.tip_y),
            ("tip_z_mm", |row| row.tip_z),
            ("angle_deg", |row| row.angle_deg),
            ("tangent_angle_deg", |row| row.tangent_angle_deg),
        ];
        columns.into_iter().for_each(|(name, of)| table.push_numbers(name, tip.iter().map(of)));
    }
    table.push_numbers("max_displacement_mm", states.iter().map(|state| state.max_displacement));
    for plane in 0..states.first().map_or(0, |state| state.planes.len()) {
        let forces = states.iter().map(|state| state.planes[plane].force.norm());
        table.push_numbers(format!("plane_{plane}_force_N"), forces);
    }
    if let Some(folds) = states.iter().map(|state| state.folds).collect::<Option<Vec<_>>>() {
        table.push_numbers("wall_gap_mm", folds.iter().map(|folds| folds[0]));
        table.push_numbers("self_contact_force_N", folds.iter().map(|folds| folds[1]));
    }
    let reactions = states.iter().map(|state| state.reaction).collect::<Option<Vec<_>>>();
    for (axis, letter) in ["x", "y", "z"].into_iter().enumerate() {
        let forces = reactions.iter().flatten().map(|reaction| reaction.force[axis]);
        if reactions.is_some() {
            table.push_numbers(format!("reaction_force_{letter}_N"), forces);
        }
    }
    for (axis, letter) in ["x", "y", "z"].into_iter().enumerate() {
        let moments = reactions.iter().flatten().map(|reaction| reaction.moment[axis]);
        if reactions.is_some() {
            table.push_numbers(format!("reaction_moment_{letter}_Nmm"), moments);
        }
    }
    let counts = |of: fn(&PathPoint) -> usize| points.iter().map(of).map(Cell::Count);
    table.push("newton_iterations", counts(|point| point.newton_iterations));
    table.push("step_cuts", counts(|point| point.cuts));
    table.push("stability", points.iter().map(|point| Cell::Word(Stability::of(point).name())));
    table.push("is_sample", points.iter().map(|point| Cell::Flag(point.is_sample)));
    table
}

/// A [`Reaction`] in `summary.json`.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct ReactionSummary {
    /// N.
    force: [f64; 3],
    /// About `about`, N mm.
    moment: [f64; 3],
    /// mm.
    about: [f64; 3],
}

impl State {
    /// What holds a part that was put at its place in the computation.
    pub(crate) fn reaction_of(&self, placed: Placed) -> Option<ReactionSummary> {
        let Reaction { force, moment, about } = self.reaction?;
        let mut about = [about];
        placed.put_back(&mut about);
        Some(ReactionSummary { force: force.into(), moment: moment.into(), about: about[0].into() })
    }
}

impl ReactionSummary {
    /// A clause for the terminal.
    pub(crate) fn in_words(&self) -> String {
        let [x, y, z] = self.force;
        format!(", held with ({x:+.3}, {y:+.3}, {z:+.3}) N")
    }
}

/// Writes the path of each of the `scenarios` as a table named after it and the `stage`, with pictures where a `mesh` is given.
pub(crate) fn write_scenarios(
    folder: &Path,
    stage: &str,
    scenarios: &mut Scenarios,
    mesh: Option<&ShellMesh>,
) -> Result<(), OutputError> {
    scenarios.try_for_each(|walked, model| {
        let (name, points) = (walked.scenario.file_stem(stage), &walked.path.points);
        let states = states(model, points, true);
        path_table(LoadKind::Pressure, points, &states, &walked.rows)
            .write(&folder.join(format!("{name}.csv")))?;
        match mesh {
            Some(mesh) => {
                write_pictures(folder, &name, &mesh.surface, model, points, Placed::default())
            }
            None => Ok(()),
        }
    })
}
