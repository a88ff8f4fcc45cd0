//! Pictures and films of designs, drawn from what a folder holds of them or from what was computed again.
//!
//! ```text
//! path.csv, path_000.vtu, ...      path_blocked.csv, path_blocked_000.vtu, ...
//! ```

use std::path::Path;

use anyhow::{Context, ensure};
use serde::Deserialize;

use super::run_file::RunFile;
use crate::fitness::{Observation, Scenarios};
use crate::io::{csv, input, vtu_surface};
use crate::math::Vec3;
use crate::mesh::ShellMesh;
use crate::model::{PartModel, PictureCells};
use crate::report::{Camera, DesignCurves, Image, Pixels, Rgb};
use crate::solve::PathPoint;
use crate::surface::TriangleMesh;

/// A path as pictures need it: a row and a surface for each state.
pub(crate) struct StoredPath {
    pub rows: Vec<Row>,
    pub surfaces: Vec<TriangleMesh>,
}

/// What of a path's row is told in pictures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
pub(crate) struct Row {
    /// MPa.
    #[serde(default, alias = "pressure_MPa", alias = "load")]
    pub pressure: f64,
    #[serde(default)]
    pub angle_deg: f64,
    /// N.
    #[serde(default, alias = "plane_0_force_N")]
    pub plane_force: f64,
}

impl From<&Observation> for Row {
    fn from(row: &Observation) -> Self {
        let &Observation { pressure, angle_deg, plane_force, .. } = row;
        Self { pressure, angle_deg, plane_force }
    }
}

impl StoredPath {
    /// The path `name` in `folder`.
    pub(crate) fn read(folder: &Path, name: &str) -> anyhow::Result<Self> {
        let rows = read_rows(folder, name)?;
        let surface =
            |step: usize| vtu_surface::read(&folder.join(format!("{name}_{step:03}.vtu")));
        let surfaces = (0..rows.len()).map(surface).collect::<Result<Vec<_>, _>>()?;
        let path = Self { rows, surfaces };
        let points = |surface: &TriangleMesh| surface.positions.len();
        let is_one = path.surfaces.windows(2).all(|pair| points(&pair[0]) == points(&pair[1]));
        ensure!(is_one, "{}: pictures of {name} are of different surfaces", folder.display());
        Ok(path)
    }

    /// Its rest and its end alone.
    pub(crate) fn read_ends(folder: &Path, name: &str) -> anyhow::Result<Self> {
        let rows = read_rows(folder, name)?;
        let last = rows.len() - 1;
        let surface =
            |step: usize| vtu_surface::read(&folder.join(format!("{name}_{step:03}.vtu")));
        Ok(Self { rows: vec![rows[0], rows[last]], surfaces: vec![surface(0)?, surface(last)?] })
    }

    /// What was computed.
    fn computed(
        mesh: &ShellMesh,
        model: &PartModel,
        points: &[PathPoint],
        rows: &[Observation],
    ) -> Self {
        let (at_rest, cells) = model.picture_cells();
        let triangles: Vec<[u32; 3]> = match cells {
            PictureCells::QuadraticTriangles(cells) => cells
                .iter()
                .flat_map(|&[a, b, c, ab, bc, ca]| {
                    [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
                })
                .collect(),
            PictureCells::Triangles(_) | PictureCells::QuadraticTetrahedra(_) => {
                mesh.surface.triangles.clone()
            }
        };
        let surface = |point: &PathPoint| {
            let displacements = model.picture_displacements(&point.x);
            let positions = at_rest.iter().zip(displacements).map(|(x, u)| x + u).collect();
            TriangleMesh { positions, triangles: triangles.clone() }
        };
        Self {
            rows: rows.iter().map(Row::from).collect(),
            surfaces: points.iter().map(surface).collect(),
        }
    }

    fn last(&self) -> (&Row, &TriangleMesh) {
        (&self.rows[self.rows.len() - 1], &self.surfaces[self.surfaces.len() - 1])
    }
}

/// The rows of `<name>.csv` in `folder`, at least one.
pub(crate) fn read_rows(folder: &Path, name: &str) -> anyhow::Result<Vec<Row>> {
    let table = folder.join(format!("{name}.csv"));
    let rows: Vec<Row> = csv::parse(&input::text(&table, input::DATA)?, &table)?;
    ensure!(!rows.is_empty(), "{} has no rows", table.display());
    Ok(rows)
}

/// A plane that blocks: where it stands follows from the part at rest.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Blocking {
    normal: Vec3,
    /// From the outermost point of the outer face, mm.
    distance: f64,
    /// Of the wall, mm.
    thickness: f64,
}

impl Blocking {
    pub(crate) fn of(run: &RunFile) -> anyhow::Result<Self> {
        let normal = Vec3::from(run.fitness.plane_normal);
        let normal = normal.try_normalize(0.0).context("the plane of [fitness] has no normal")?;
        let (distance, thickness) = (run.fitness.plane_distance, run.wall.thickness);
        Ok(Self { normal, distance, thickness })
    }

    /// A point of the plane beside a part that is `at_rest`.
    fn point(&self, at_rest: &TriangleMesh) -> Vec3 {
        let heights = at_rest.positions.iter().map(|x| self.normal.dot(x));
        let offset = heights.fold(f64::INFINITY, f64::min) - 0.5 * self.thickness - self.distance;
        let sum: Vec3 = at_rest.positions.iter().sum();
        let middle = sum / at_rest.positions.len() as f64;
        middle + self.normal * (offset - self.normal.dot(&middle))
    }
}

/// A design that bends freely and, where that was computed, against a plane.
pub(crate) struct Pictured {
    pub free: StoredPath,
    pub blocked: Option<(StoredPath, Blocking)>,
    /// Towards where it moves, or away.
    pub direction: Vec3,
}

/// The size of one panel, pixels.
const PANEL: [usize; 2] = [300, 360];
/// Pixels that a part leaves free, above it and for the words below it.
const FREE: usize = 20;
const WALL: Rgb = [138, 176, 226];
const PLANE: Rgb = [214, 214, 208];
/// Pictures between two states of a path.
const BETWEEN: usize = 4;
/// Hundredths of a second that a picture of a film is shown, and the last.
const DELAY: u16 = 6;
const LAST_DELAY: u16 = 90;

impl Pictured {
    /// What was computed of a candidate.
    pub(crate) fn computed(mesh: &ShellMesh, scenarios: &Scenarios, blocking: Blocking) -> Self {
        let Scenarios { model, free, blocked, free_rows, blocked_rows, .. } = scenarios;
        let path = |points: &[PathPoint], rows| StoredPath::computed(mesh, model, points, rows);
        Self {
            free: path(&free.points, free_rows),
            blocked: Some((path(&blocked.points, blocked_rows), blocking)),
            direction: blocking.normal,
        }
    }

    /// At rest, bent, and pressing on the plane, side by side.
    pub(crate) fn still(&self) -> Pixels {
        let camera = self.camera();
        let (bent, surface) = self.free.last();
        let mut panels = vec![
            self.panel(&self.free.surfaces[0], None, &camera, "at rest"),
            self.panel(
                surface,
                None,
                &camera,
                &format!("free: {:.1} deg at {} MPa", bent.angle_deg, short(bent.pressure)),
            ),
        ];
        if let Some((path, blocking)) = &self.blocked {
            let (row, surface) = path.last();
            let words = format!("blocked: {:.2} N at {} MPa", row.plane_force, short(row.pressure));
            panels.push(self.panel(surface, Some(blocking), &camera, &words));
        }
        Pixels::beside(&panels)
    }

    /// Its pictures while it is inflated, free and blocked side by side, each with its time in hundredths of a second.
    pub(crate) fn film(&self) -> Vec<(Pixels, u16)> {
        let camera = self.camera();
        let paths = [Some(&self.free), self.blocked.as_ref().map(|(path, _)| path)];
        let states = paths.iter().flatten().map(|path| path.rows.len()).max().unwrap_or(1);
        let pictures = BETWEEN * (states - 1);
        let picture = |k: usize| {
            let share = if pictures == 0 { 0.0 } else { k as f64 / pictures as f64 };
            let (row, surface) = between(&self.free, share);
            let words = format!("free: {:.1} deg at {} MPa", row.angle_deg, short(row.pressure));
            let mut panels = vec![self.panel(&surface, None, &camera, &words)];
            if let Some((path, blocking)) = &self.blocked {
                let (row, surface) = between(path, share);
                let words =
                    format!("blocked: {:.2} N at {} MPa", row.plane_force, short(row.pressure));
                panels.push(self.panel(&surface, Some(blocking), &camera, &words));
            }
            (Pixels::beside(&panels), if k == pictures { LAST_DELAY } else { DELAY })
        };
        (0..=pictures).map(picture).collect()
    }

    /// From where all its states are seen.
    fn camera(&self) -> Camera {
        let blocked = self.blocked.iter().flat_map(|(path, _)| &path.surfaces);
        let states = self.free.surfaces.iter().chain(blocked);
        let size = [PANEL[0], PANEL[1] - 2 * FREE];
        Camera::beside(self.direction, states.flat_map(|surface| &surface.positions), size)
    }

    fn panel(
        &self,
        surface: &TriangleMesh,
        blocking: Option<&Blocking>,
        camera: &Camera,
        words: &str,
    ) -> Pixels {
        let mut image = Image::new(PANEL);
        image.draw(surface, camera, WALL);
        if let Some(blocking) = blocking {
            let at_rest = &self.free.surfaces[0];
            let (low, high) = at_rest.bounding_box().unwrap_or_default();
            let reach = 0.5 * (high - low).norm();
            image.draw_plane(blocking.normal, blocking.point(at_rest), reach, camera, PLANE);
        }
        let mut pixels = image.pixels();
        pixels.write(words, PANEL[0] / 2, PANEL[1] - 8, true);
        pixels
    }
}

/// The state at `share` of a path's states, straight between two.
fn between(path: &StoredPath, share: f64) -> (Row, TriangleMesh) {
    let at = share * (path.rows.len() - 1) as f64;
    let (from, to) = (at.floor() as usize, at.ceil() as usize);
    let t = at - at.floor();
    let mix = |a: f64, b: f64| a + t * (b - a);
    let (a, b) = (path.rows[from], path.rows[to]);
    let row = Row {
        pressure: mix(a.pressure, b.pressure),
        angle_deg: mix(a.angle_deg, b.angle_deg),
        plane_force: mix(a.plane_force, b.plane_force),
    };
    let [one, other] = [from, to].map(|k| &path.surfaces[k]);
    let positions = one.positions.iter().zip(&other.positions).map(|(a, b)| a + t * (b - a));
    (row, TriangleMesh { positions: positions.collect(), triangles: one.triangles.clone() })
}

/// The curves of the design `id` in `folder`.
pub(crate) fn curves(folder: &Path, id: &str) -> anyhow::Result<DesignCurves> {
    let of = |name: &str, value: fn(&Row) -> f64| -> anyhow::Result<Vec<[f64; 2]>> {
        let rows = read_rows(folder, name)?;
        Ok(rows.iter().map(|row| [row.pressure, value(row)]).collect())
    };
    Ok(DesignCurves {
        id: id.to_owned(),
        angle: of("path", |row| row.angle_deg)?,
        force: of("path_blocked", |row| row.plane_force)?,
    })
}

/// Three decimals, without zeros behind.
fn short(value: f64) -> String {
    let text = format!("{value:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
