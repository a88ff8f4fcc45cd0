//! The files of one simulated design: surface, path, pictures.

use std::path::Path;

use serde::Serialize;

use super::watch_curve::WatchCurve;
use crate::fitness::Observation;
use crate::io::vtu::{Picture, Values, write_series};
use crate::io::{OutputError, atomic, csv, stl};
use crate::math::Vec3;
use crate::mesh::{ShellMesh, SolidMesh};
use crate::model::PartModel;
use crate::solve::PathPoint;
use crate::surface::TriangleMesh;

/// Writes the mid-surface at rest as `surface.stl`, and both faces of the wall around it as `wall.stl`.
pub(super) fn write_surface(folder: &Path, mesh: &ShellMesh) -> Result<(), OutputError> {
    stl::write(&folder.join("surface.stl"), &mesh.surface)?;
    stl::write(&folder.join("wall.stl"), &mesh.surface.wall(mesh.thickness))
}

/// Writes `<name>.csv`, and the pictures of `points`.
pub(super) fn write_path(
    folder: &Path,
    name: &str,
    mesh: &ShellMesh,
    model: &PartModel,
    points: &[PathPoint],
    rows: &[Observation],
) -> Result<(), OutputError> {
    csv::write(&folder.join(format!("{name}.csv")), rows)?;
    write_pictures(folder, name, &mesh.surface, model, points)
}

/// Writes `<name>.pvd` with one deformed `surface` for each of `points`.
pub(super) fn write_pictures(
    folder: &Path,
    name: &str,
    surface: &TriangleMesh,
    model: &PartModel,
    points: &[PathPoint],
) -> Result<(), OutputError> {
    let mut frames = Vec::with_capacity(points.len());
    for (step, point) in points.iter().enumerate() {
        let file = format!("{name}_{step:03}.vtu");
        let displacement = model.vertex_displacements(&point.x);
        let deformed = TriangleMesh {
            positions: displaced(&surface.positions, &displacement),
            triangles: surface.triangles.clone(),
        };
        Picture::new(&deformed)
            .with_point_data("displacement_mm", Values::Vectors(&displacement))
            .write(&folder.join(&file))?;
        frames.push((point.load, file));
    }
    write_series(&folder.join(format!("{name}.pvd")), &frames)
}

/// Writes `<name>.pvd` with one deformed solid for each of `points`.
pub(super) fn write_solid_pictures(
    folder: &Path,
    name: &str,
    mesh: &SolidMesh,
    points: &[PathPoint],
) -> Result<(), OutputError> {
    let mut frames = Vec::with_capacity(points.len());
    for (step, point) in points.iter().enumerate() {
        let file = format!("{name}_{step:03}.vtu");
        let places = &point.x[..3 * mesh.positions.len()];
        let displacement: Vec<Vec3> = places.as_chunks().0.iter().map(|&u| Vec3::from(u)).collect();
        let positions = displaced(&mesh.positions, &displacement);
        Picture::of_solid(&SolidMesh { positions, ..mesh.clone() })
            .with_point_data("displacement_mm", Values::Vectors(&displacement))
            .write(&folder.join(&file))?;
        frames.push((point.load, file));
    }
    write_series(&folder.join(format!("{name}.pvd")), &frames)
}

/// A row of `watches.csv`.
#[derive(Debug, Serialize)]
struct WatchRow<'a> {
    watch: &'a str,
    step: usize,
    /// Share of the whole load.
    load: f64,
    value: f64,
}

/// Writes `watches.csv`: every watch at every step.
pub(super) fn write_watches<'a>(
    folder: &Path,
    watches: impl Iterator<Item = (&'a str, &'a WatchCurve)>,
) -> Result<(), OutputError> {
    let rows = watches.flat_map(|(watch, curve)| {
        let points = curve.points.iter().enumerate();
        points.map(move |(step, at)| WatchRow { watch, step, load: at.load, value: at.value })
    });
    csv::write(&folder.join("watches.csv"), &rows.collect::<Vec<_>>())
}

/// Writes `value` as indented JSON.
pub(super) fn write_json<T: Serialize>(path: &Path, value: &T) -> anyhow::Result<()> {
    let mut text = serde_json::to_string_pretty(value)?;
    text.push('\n');
    Ok(atomic::write(path, text.as_bytes())?)
}

fn displaced(positions: &[Vec3], displacement: &[Vec3]) -> Vec<Vec3> {
    positions.iter().zip(displacement).map(|(x, u)| x + u).collect()
}
