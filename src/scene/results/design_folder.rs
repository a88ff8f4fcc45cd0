//! The files of one simulated design: surface, path, pictures.

use std::path::Path;

use serde::Serialize;

use super::path_rows::LoadKind;
use crate::io::csv::{Cell, Table};
use crate::io::vtu::{Picture, Values, write_series};
use crate::io::{OutputError, atomic, stl};
use crate::math::Vec3;
use crate::mesh::ShellMesh;
use crate::model::{BorneStates, PartModel, ShellState, SolidState};
use crate::scene::part::placement::Placed;
use crate::scene::watch_curve::WatchCurve;
use crate::solve::PathPoint;
use crate::surface::TriangleMesh;

/// Writes the mid-surface at rest as `surface.stl`, and both faces of the wall around it as `wall.stl`.
pub(crate) fn write_surface(folder: &Path, mesh: &ShellMesh) -> Result<(), OutputError> {
    stl::write(&folder.join("surface.stl"), &mesh.surface)?;
    stl::write(&folder.join("wall.stl"), &mesh.surface.wall(|v| mesh.section.thickness(v)))
}

/// Writes `<name>.pvd` with one picture for each of `points`: a shell's middle with what its wall bears; of a solid that shows the
/// `surface` of its shell, that surface.
pub(crate) fn write_pictures(
    folder: &Path,
    name: &str,
    surface: &TriangleMesh,
    model: &PartModel,
    points: &[PathPoint],
    placed: Placed,
) -> Result<(), OutputError> {
    if !model.is_solid() {
        return write_model_pictures(folder, name, model, points, placed);
    }
    write_frames(folder, name, points, |path, point| {
        let displacement = model.vertex_displacements(&point.x);
        let deformed = TriangleMesh {
            positions: displaced(&surface.positions, &displacement),
            triangles: surface.triangles.clone(),
        };
        Picture::new(&deformed)
            .with_point_data("displacement_mm", Values::Vectors(&displacement))
            .write(path)
    })
}

/// Writes `<name>.pvd` with one picture of the model's own cells for each of `points`, and what they bear.
pub(crate) fn write_model_pictures(
    folder: &Path,
    name: &str,
    model: &PartModel,
    points: &[PathPoint],
    placed: Placed,
) -> Result<(), OutputError> {
    let (mut at_rest, cells) = model.picture_cells();
    placed.put_back(&mut at_rest);
    write_frames(folder, name, points, |path, point| {
        let displacement = model.picture_displacements(&point.x);
        let positions = displaced(&at_rest, &displacement);
        let (mut of_points, mut of_cells) = (Vec::new(), Vec::new());
        if let Some(pressures) = model.solid_pressures(&point.x) {
            of_points.push(("hydrostatic_pressure_MPa", singles(&pressures)));
        }
        if let Some(contact) = model.contact_states(&point.x) {
            of_points.push(("contact_gap_mm", singles(&contact.gaps)));
            of_points.push(("contact_pressure_MPa", singles(&contact.pressures)));
        }
        match model.borne_states(&point.x) {
            Some(BorneStates::Shell(states)) => {
                let mut column = |name, value: fn(&ShellState) -> f64| {
                    of_cells.push((name, states.iter().map(|s| value(s) as f32).collect()));
                };
                column("stretch_1", |state| state.stretches[0]);
                column("stretch_2", |state| state.stretches[1]);
                column("stretch_3", |state| state.stretches[2]);
                column("thickness_mm", |state| state.thickness);
                column("stress_1_MPa", |state| state.stresses[0]);
                column("stress_2_MPa", |state| state.stresses[1]);
                column("von_mises_MPa", |state| state.von_mises[1]);
                column("von_mises_inner_MPa", |state| state.von_mises[0]);
                column("von_mises_outer_MPa", |state| state.von_mises[2]);
            }
            Some(BorneStates::Solid(states)) => {
                let mut column = |name, value: fn(&SolidState) -> f64| {
                    of_cells.push((name, states.iter().map(|s| value(s) as f32).collect()));
                };
                column("stretch_1", |state| state.stretches[0]);
                column("stretch_2", |state| state.stretches[1]);
                column("stretch_3", |state| state.stretches[2]);
                column("stress_1_MPa", |state| state.stresses[0]);
                column("stress_2_MPa", |state| state.stresses[1]);
                column("stress_3_MPa", |state| state.stresses[2]);
                column("von_mises_MPa", |state| state.von_mises);
                column("J", |state| state.j);
            }
            None => {}
        }
        let of_cells: Vec<(&str, Vec<f32>)> = of_cells;
        let mut picture = Picture::of_cells(&positions, &cells)
            .with_point_data("displacement_mm", Values::Vectors(&displacement));
        for (name, values) in &of_points {
            picture = picture.with_point_data(name, Values::Singles(values));
        }
        for (name, values) in &of_cells {
            picture = picture.with_cell_data(name, Values::Singles(values));
        }
        picture.write(path)
    })
}

/// Writes `<name>.pvd` and the file of each of `points` by `write`.
fn write_frames(
    folder: &Path,
    name: &str,
    points: &[PathPoint],
    write: impl Fn(&Path, &PathPoint) -> Result<(), OutputError>,
) -> Result<(), OutputError> {
    let mut frames = Vec::with_capacity(points.len());
    for (step, point) in points.iter().enumerate() {
        let file = format!("{name}_{step:03}.vtu");
        write(&folder.join(&file), point)?;
        frames.push((point.load, file));
    }
    write_series(&folder.join(format!("{name}.pvd")), &frames)
}

/// Single precision is finer than any state is known.
fn singles(values: &[f64]) -> Vec<f32> {
    values.iter().map(|&value| value as f32).collect()
}

/// Writes `watches.csv`: every watch at every one of `points`, a row each, with the load as `path.csv` has it.
pub(crate) fn write_watches<'a>(
    folder: &Path,
    load: LoadKind,
    points: &[PathPoint],
    watches: impl Iterator<Item = (&'a str, &'a WatchCurve)>,
) -> Result<(), OutputError> {
    let rows: Vec<_> = watches
        .flat_map(|(watch, curve)| {
            let steps = curve.points.iter().zip(points).enumerate();
            steps.map(move |(step, (at, point))| (watch, step, point.load, at.value))
        })
        .collect();
    let mut table = Table::default();
    table.push("watch", rows.iter().map(|&(watch, ..)| Cell::Word(watch)));
    table.push("step", rows.iter().map(|&(_, step, ..)| Cell::Count(step)));
    table.push_numbers(load.column(), rows.iter().map(|&(_, _, load, _)| load));
    table.push_numbers("value", rows.iter().map(|&(.., value)| value));
    table.write(&folder.join("watches.csv"))
}

/// Writes `value` as indented JSON.
pub(crate) fn write_json<T: Serialize>(path: &Path, value: &T) -> anyhow::Result<()> {
    let mut text = serde_json::to_string_pretty(value)?;
    text.push('\n');
    Ok(atomic::write(path, text.as_bytes())?)
}

fn displaced(positions: &[Vec3], displacement: &[Vec3]) -> Vec<Vec3> {
    positions.iter().zip(displacement).map(|(x, u)| x + u).collect()
}
