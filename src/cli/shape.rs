//! Parts that a scene file describes in a few numbers: a patch of formulas, or a sphere; loaded, solved and watched.

use anyhow::{Context, anyhow, bail};

use super::patch_part::{Force, Measure, PatchSection, Watched};
use super::scene_file::{PartSource, SceneFile, SphereSection};
use super::watch_curve::{CurvePoint, WatchCurve};
use crate::math::cpu_seconds;
use crate::mesh::{Patch, ShellMesh, ShellSettings, Side};
use crate::model::system::{LoadedSystem, System};
use crate::model::{DeadLoad, EdgeSupports, PatchLoads, ShellModel, Support};
use crate::solve::{Backend, Ending, EquilibriumSolver, Path as Walked, PathPoint, follow};
use crate::surface::TriangleMesh;

/// A part ready to be loaded.
pub(super) struct Shape {
    pub surface: TriangleMesh,
    pub model: ShellModel,
    /// Vertices of the watches, none for what is measured of the whole.
    watched: Vec<(Watched, Option<u32>)>,
}

/// What a shape did under its load.
pub(super) struct Measured {
    pub walked: Walked,
    pub unknowns: usize,
    /// Of meshing, assembly and solution, s.
    pub cpu_seconds: f64,
    /// Of each watch, over the share of the load.
    pub curves: Vec<WatchCurve>,
    /// The share of the load at which the path first met an instability, or ended.
    pub limit_load: f64,
}

impl Shape {
    /// The part of a `scene`.
    ///
    /// # Errors
    /// When the surface or what holds it does not make a shell; or the part is one of a file.
    pub(super) fn new(scene: &SceneFile, source: &PartSource<'_>) -> anyhow::Result<Self> {
        let watched = scene.watches.iter().map(|watch| watch.watched());
        let watched = watched.collect::<anyhow::Result<Vec<_>>>()?;
        match source {
            PartSource::Patch(section) => of_patch(scene, section, watched),
            PartSource::Sphere(sphere) => of_sphere(scene, sphere, watched),
            PartSource::Network(_) | PartSource::Stl(_) => bail!("the part is one of a file"),
        }
    }

    /// Walks the path of the `scene`, or takes its one linear step.
    pub(super) fn measure(
        &mut self,
        scene: &SceneFile,
        backend: Backend,
        start: f64,
    ) -> anyhow::Result<Measured> {
        let largest = scene.load_settings();
        let mut solver = backend.solver(self.model.pattern())?;
        let walked = if scene.load.linear {
            linear_step(&mut self.model, solver.as_mut(), largest.pressure)?
        } else {
            follow(&mut self.model, solver.as_mut(), largest.pressure, Vec::new(), &largest.path)?
        };
        let seconds = cpu_seconds() - start;
        let snap = walked.points.iter().position(|point| point.shifted > 0);
        let last = snap.unwrap_or(walked.points.len()).saturating_sub(1);
        Ok(Measured {
            unknowns: self.model.free_unknowns(),
            cpu_seconds: seconds,
            curves: self
                .watched
                .iter()
                .map(|&w| self.curve(w, &walked, largest.pressure))
                .collect(),
            limit_load: walked.points.get(last).map_or(0.0, |point| point.load / largest.pressure),
            walked,
        })
    }

    /// A watched number over the share of the `largest` load.
    fn curve(
        &self,
        (watched, vertex): (Watched, Option<u32>),
        walked: &Walked,
        largest: f64,
    ) -> WatchCurve {
        let at_rest = walked.points.first().map_or(0.0, |point| point.conjugate);
        let number = |point: &PathPoint| match (watched, vertex) {
            (Watched::Displacement { direction, .. }, Some(vertex)) => {
                // The displacement of a vertex is linear in the unknowns.
                let along =
                    |x: &[f64]| self.model.vertex_displacements(x)[vertex as usize].dot(&direction);
                [along(&point.x), along(&point.rate)]
            }
            (Watched::Whole(Measure::VolumeStrain), _) => {
                let stretch = (point.conjugate / at_rest).cbrt();
                [stretch - 1.0, stretch / (3.0 * point.conjugate) * point.conjugate_rate]
            }
            _ => [point.stored_energy, point.load * point.conjugate_rate],
        };
        let point = |point: &PathPoint| {
            let [value, rate] = number(point);
            CurvePoint { load: point.load / largest, value, rate: rate * largest }
        };
        WatchCurve { points: walked.points.iter().map(point).collect() }
    }
}

fn of_patch(
    scene: &SceneFile,
    section: &PatchSection,
    watched: Vec<Watched>,
) -> anyhow::Result<Shape> {
    let surface = section.surface()?;
    let patch = Patch::new(section.cells, section.s, section.t, scene.wall.thickness, &surface)
        .map_err(|rejected| anyhow!("[part.patch]: {rejected}"))?;
    let vertex = |[s, t]: [f64; 2]| {
        patch.vertex(s, t).with_context(|| format!("no vertex of the patch lies at [{s}, {t}]"))
    };
    let mut loads = PatchLoads {
        pressure: scene.load.pressure.unwrap_or(0.0),
        supports: EdgeSupports::default(),
        ..PatchLoads::default()
    };
    for edge in &scene.edges {
        let place = Side::ALL.iter().position(|side| *side == edge.side);
        loads.supports[place.expect("all sides are listed")] = edge.support()?;
    }
    for pin in &scene.pins {
        let vertex = vertex(pin.at)?;
        let held = pin.held()?;
        loads.pins.extend((0..3).filter(|&axis| held[axis]).map(|axis| (vertex, axis)));
    }
    for force in &scene.forces {
        loads.dead.push(match force.acting()? {
            Force::Point { at, force } => DeadLoad::Point { vertex: vertex(at)?, force },
            Force::Edge { side, per_length } => DeadLoad::Edge { side, per_length },
            Force::Area { per_area } => DeadLoad::Area { per_area },
        });
    }
    for moment in &scene.moments {
        loads.moments.push((moment.side, moment.per_length()?));
    }
    let material = scene.material.material()?;
    let model = ShellModel::of_patch(&patch, scene.wall.element, &material, &loads)
        .map_err(|rejected| anyhow!("[part.patch]: {rejected}"))?;
    let watched = watched
        .into_iter()
        .map(|watched| {
            let vertex = match watched {
                Watched::Displacement { at, .. } => Some(vertex(at)?),
                Watched::Whole(_) => None,
            };
            Ok((watched, vertex))
        })
        .collect::<anyhow::Result<_>>()?;
    Ok(Shape { surface: patch.surface, model, watched })
}

/// Held against its six rigid motions alone: 3 unknowns at the top, 2 at the bottom, 1 beside.
fn of_sphere(
    scene: &SceneFile,
    sphere: &SphereSection,
    watched: Vec<Watched>,
) -> anyhow::Result<Shape> {
    let surface = TriangleMesh::sphere(sphere.radius, sphere.subdivisions);
    let farthest = |axis: usize, sign: f64| {
        let height = |v: &u32| sign * surface.positions[*v as usize][axis];
        let vertices = 0..surface.positions.len() as u32;
        vertices.max_by(|a, b| height(a).total_cmp(&height(b))).expect("a sphere has vertices")
    };
    let (top, bottom, side) = (farthest(2, 1.0), farthest(2, -1.0), farthest(0, 1.0));
    let pins = vec![3 * top, 3 * top + 1, 3 * top + 2, 3 * bottom, 3 * bottom + 1, 3 * side + 1];
    // A mesh wants a clamp, though these supports do not use it.
    let settings =
        ShellSettings { clamp_height: sphere.radius / scene.wall.thickness, ..scene.wall };
    let rejected = |rejected| anyhow!("[part.sphere]: {rejected}");
    let mesh = ShellMesh::new(surface, &settings).map_err(rejected)?;
    let material = scene.material.material()?;
    let model =
        ShellModel::new(&mesh, &material, &Support::Unknowns(pins), &[]).map_err(rejected)?;
    let watched = watched.into_iter().map(|watched| (watched, None)).collect();
    Ok(Shape { surface: mesh.surface, model, watched })
}

/// Rest, and the state that the linear theory has at the `largest` load.
fn linear_step(
    model: &mut ShellModel,
    solver: &mut dyn EquilibriumSolver,
    largest: f64,
) -> anyhow::Result<Walked> {
    let rest = vec![0.0; model.pattern().order()];
    model.set_load(0.0);
    let negative_pivots = solver.linearize(model, &rest)?;
    if negative_pivots != model.stable_negative_pivots() {
        return Ok(Walked { points: Vec::new(), ending: Ending::Unstable });
    }
    let mut direction = rest.clone();
    model.load_direction(&rest, &mut direction);
    let mut rate = direction.clone();
    solver.solve_linearized(&mut rate)?;
    let conjugate_rate: f64 = direction.iter().zip(&rate).map(|(f, u)| f * u).sum();
    let at_rest = model.conjugate(&rest);
    let point = |load: f64| PathPoint {
        load,
        conjugate: at_rest + load * conjugate_rate,
        work: 0.5 * load * load * conjugate_rate,
        stored_energy: 0.5 * load * load * conjugate_rate,
        x: rate.iter().map(|rate| load * rate).collect(),
        rate: rate.clone(),
        conjugate_rate,
        newton_iterations: 0,
        shifted: 0,
    };
    Ok(Walked { points: vec![point(0.0), point(largest)], ending: Ending::Reached })
}
