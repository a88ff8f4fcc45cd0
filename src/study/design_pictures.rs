//! Pictures and films of designs, drawn from what a folder holds of them or from what was computed again.
//!
//! ```text
//! path.csv, path_000.vtu, ...      path_blocked.csv, path_blocked_000.vtu, ...
//! ```

use std::path::Path;

use anyhow::ensure;
use serde::Deserialize;

use super::run_file::RunFile;
use crate::fitness::{OBJECTIVES, Observation, SCENARIOS, Scenario, Scenarios, Walked};
use crate::io::{csv, input, vtu_surface};
use crate::math::Vec3;
use crate::mesh::ShellMesh;
use crate::model::contact::PlaneSettings;
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
    /// A point of the plane beside a part that is `at_rest`.
    fn point(&self, at_rest: &TriangleMesh) -> Vec3 {
        let heights = at_rest.positions.iter().map(|x| self.normal.dot(x));
        let offset = heights.fold(f64::INFINITY, f64::min) - 0.5 * self.thickness - self.distance;
        let sum: Vec3 = at_rest.positions.iter().sum();
        let middle = sum / at_rest.positions.len() as f64;
        middle + self.normal * (offset - self.normal.dot(&middle))
    }
}

/// A path with what stands in its way.
pub(crate) struct PicturedPath {
    /// The name of its scenario.
    pub name: &'static str,
    pub path: StoredPath,
    pub planes: Vec<Blocking>,
}

impl PicturedPath {
    /// A path that nothing stands in the way of.
    pub(crate) fn free(path: StoredPath) -> Self {
        Self { name: "free", path, planes: Vec::new() }
    }

    /// The scenarios of a `run` for a design whose path of a name `read` finds.
    ///
    /// # Errors
    /// Those of `read`, and where a plane has no normal.
    pub(crate) fn stored(
        run: &RunFile,
        read: impl Fn(&str) -> anyhow::Result<StoredPath>,
    ) -> anyhow::Result<Vec<Self>> {
        let scenarios = run.fitness.scenarios().into_iter();
        scenarios.map(|one| Self::new(run, one, read(&one.file_stem(""))?)).collect()
    }

    fn new(run: &RunFile, scenario: Scenario, path: StoredPath) -> anyhow::Result<Self> {
        let blocking = |plane: &PlaneSettings| {
            let &PlaneSettings { normal, distance, .. } = plane;
            ensure!(normal.norm().is_finite(), "the plane of [fitness] has no normal");
            Ok(Blocking { normal, distance, thickness: run.wall.thickness })
        };
        let planes = (scenario.arrangement)(&run.fitness, &run.load).planes;
        let planes = planes.iter().map(blocking).collect::<anyhow::Result<_>>()?;
        Ok(Self { name: scenario.name, path, planes })
    }

    /// What is told below a picture of the state that `row` is of: the force on what stands in the way, else the angle.
    fn words(&self, row: &Row) -> String {
        let Row { pressure, angle_deg, plane_force } = row;
        let (name, pressure) = (self.name, short(*pressure));
        if self.planes.is_empty() {
            format!("{name}: {angle_deg:.1} deg at {pressure} MPa")
        } else {
            format!("{name}: {plane_force:.2} N at {pressure} MPa")
        }
    }
}

/// A design in its scenarios, at least one.
pub(crate) struct Pictured {
    pub paths: Vec<PicturedPath>,
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
    /// What was computed of a candidate of a `run`.
    ///
    /// # Errors
    /// When a plane has no normal.
    pub(crate) fn computed(
        mesh: &ShellMesh,
        scenarios: &Scenarios,
        run: &RunFile,
    ) -> anyhow::Result<Self> {
        let path = |(walked, model): (&Walked, &PartModel)| {
            let path = StoredPath::computed(mesh, model, &walked.path.points, &walked.rows);
            PicturedPath::new(run, walked.scenario, path)
        };
        let paths = scenarios.with_models().map(path).collect::<anyhow::Result<_>>()?;
        Ok(Self { paths, direction: Vec3::from(run.fitness.plane_normal).normalize() })
    }

    /// At rest, and at the end of each scenario, side by side.
    pub(crate) fn still(&self) -> Pixels {
        let camera = self.camera();
        let mut panels = vec![self.panel(self.at_rest(), &[], &camera, "at rest")];
        for pictured in &self.paths {
            let (row, surface) = pictured.path.last();
            panels.push(self.panel(surface, &pictured.planes, &camera, &pictured.words(row)));
        }
        Pixels::beside(&panels)
    }

    /// Its pictures while it is inflated, all scenarios side by side, each with its time in hundredths of a second.
    pub(crate) fn film(&self) -> Vec<(Pixels, u16)> {
        let camera = self.camera();
        let states = self.paths.iter().map(|pictured| pictured.path.rows.len()).max().unwrap_or(1);
        let pictures = BETWEEN * (states - 1);
        let picture = |k: usize| {
            let share = if pictures == 0 { 0.0 } else { k as f64 / pictures as f64 };
            let panel = |pictured: &PicturedPath| {
                let (row, surface) = between(&pictured.path, share);
                self.panel(&surface, &pictured.planes, &camera, &pictured.words(&row))
            };
            let panels: Vec<Pixels> = self.paths.iter().map(panel).collect();
            (Pixels::beside(&panels), if k == pictures { LAST_DELAY } else { DELAY })
        };
        (0..=pictures).map(picture).collect()
    }

    fn at_rest(&self) -> &TriangleMesh {
        &self.paths[0].path.surfaces[0]
    }

    /// From where all its states are seen.
    fn camera(&self) -> Camera {
        let states = self.paths.iter().flat_map(|pictured| &pictured.path.surfaces);
        let size = [PANEL[0], PANEL[1] - 2 * FREE];
        Camera::beside(self.direction, states.flat_map(|surface| &surface.positions), size)
    }

    fn panel(
        &self,
        surface: &TriangleMesh,
        planes: &[Blocking],
        camera: &Camera,
        words: &str,
    ) -> Pixels {
        let mut image = Image::new(PANEL);
        image.draw(surface, camera, WALL);
        for blocking in planes {
            let at_rest = self.at_rest();
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
    // Of the scenarios behind the axes of the front.
    let [angle, force] =
        [0, 1].map(|k| OBJECTIVES[k].scenario.unwrap_or(SCENARIOS[k]).file_stem(""));
    Ok(DesignCurves {
        id: id.to_owned(),
        angle: of(&angle, |row| row.angle_deg)?,
        force: of(&force, |row| row.plane_force)?,
    })
}

/// Three decimals, without zeros behind.
fn short(value: f64) -> String {
    let text = format!("{value:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
