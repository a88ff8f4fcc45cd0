//! A part of a scene file, loaded, solved and watched.

use anyhow::{Context, anyhow, bail, ensure};
use serde::Serialize;

use super::actuator::holds_the_tip;
use super::observer::Observer;
use super::part::PartSource;
use super::scene_file::SceneFile;
use super::watch::{Watch, Watched};
use super::watch_curve::WatchCurve;
use crate::fitness;
use crate::io::{ChamberFound, OwnSolid};
use crate::math::cpu_seconds;
use crate::mesh::{EndSets, Ends, Patch, Side, SolidMesh};
use crate::model::system::System;
use crate::model::{
    DeadLoad, EdgeSupports, FollowerForce, PartModel, PartSetup, PatchLoads, free_motions,
};
use crate::scene::part::closed_part;
use crate::scene::part::patch_part::{Force, PatchSection};
use crate::solve::{Backend, Path as Walked, PathPoint, Stop, follow_watched, linear_path};
use crate::surface::TriangleMesh;

/// A part ready to be loaded.
pub(crate) struct Shape {
    pub surface: TriangleMesh,
    pub model: PartModel,
    /// Of tetrahedra of one's own.
    pub chamber: Option<ChamberReport>,
    /// What is not done as it may be meant, a line each.
    pub warnings: Vec<String>,
    watches: Vec<Watch>,
    /// Of a clamped solid.
    ends: Option<EndSets>,
}

/// The chamber of tetrahedra of one's own.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct ChamberReport {
    #[serde(flatten)]
    found: ChamberFound,
    /// At rest, mm^3.
    volume: f64,
}

impl ChamberReport {
    pub(crate) fn new(found: &ChamberFound, model: &PartModel) -> Self {
        Self { found: found.clone(), volume: model.volume(&vec![0.0; model.unknowns()]) }
    }

    pub(crate) fn in_words(&self) -> String {
        self.found.in_words(self.volume)
    }
}

/// What a shape did under its load.
pub(crate) struct Measured {
    pub walked: Walked,
    pub unknowns: usize,
    /// Of meshing, assembly and solution, s.
    pub cpu_seconds: f64,
    /// Of each watch, over the share of the load.
    pub curves: Vec<WatchCurve>,
    /// The share of the load at which the path first met an instability; none where it met none.
    pub limit_load: Option<f64>,
}

impl Shape {
    /// The part of a `scene`.
    ///
    /// # Errors
    /// When the surface or what holds it does not make a shell.
    pub(crate) fn new(
        scene: &SceneFile,
        source: &PartSource<'_>,
        observer: &dyn Observer,
    ) -> anyhow::Result<Self> {
        if let PartSource::Patch(section) = source {
            return of_patch(scene, section);
        }
        if let PartSource::Tetrahedra { file, solid, .. } = source {
            return of_tetrahedra(scene, solid).with_context(|| file.display().to_string());
        }
        let mesh = closed_part::shell(scene, source, observer)?;
        let support = closed_part::support(source, &mesh);
        let setup = scene.setup(scene.load_settings().pressure)?;
        let model = PartModel::new(&mesh, &scene.materials()?, &support, &setup)
            .map_err(|rejected| anyhow!("{rejected}"))?;
        let watches = watches_of_tip(scene, &mesh.ends)?;
        let (chamber, warnings, ends) = (None, Vec::new(), None);
        Ok(Self { surface: mesh.surface, model, chamber, warnings, watches, ends })
    }

    /// What is looked at of its tip, where it has one.
    pub(crate) fn watched(&self) -> Option<fitness::Watched<'_>> {
        Some(fitness::Watched::new(&self.surface, self.ends.as_ref()?))
    }

    /// Walks the path of the `scene` until `stop` wants its end, or takes its one linear step.
    pub(crate) fn measure(
        &mut self,
        scene: &SceneFile,
        backend: Backend,
        start: f64,
        stop: Stop<'_>,
        observer: &dyn Observer,
    ) -> anyhow::Result<Measured> {
        let largest = scene.load_settings();
        let mut solver = backend.solver_by(scene.solver.linear, self.model.pattern())?;
        let walked = if scene.load.linear {
            linear_path(&mut self.model, solver.as_mut(), largest.pressure)?
        } else {
            let at_rest = self.model.volume(&vec![0.0; self.model.unknowns()]);
            let programme = scene.programme(at_rest)?;
            observer.walk_begins(programme);
            let (model, solver, path) = (&mut self.model, solver.as_mut(), &largest.path);
            let note = &mut |point: &PathPoint| observer.state(point);
            follow_watched(model, solver, programme, path, stop, note)?
        };
        let seconds = cpu_seconds() - start;
        Ok(Measured {
            unknowns: self.model.free_unknowns(),
            cpu_seconds: seconds,
            curves: self
                .watches
                .iter()
                .map(|watch| watch.curve(&self.model, &walked.points, largest.pressure))
                .collect(),
            limit_load: walked.limit_load().map(|load| load / largest.pressure),
            walked,
        })
    }
}

/// The watches of a part with a tip.
pub(crate) fn watches_of_tip(scene: &SceneFile, ends: &EndSets) -> anyhow::Result<Vec<Watch>> {
    let EndSets { heights, tip, .. } = ends;
    let watch = |watched| Watch { watched, vertices: tip.clone(), length: heights.length };
    scene.watches.iter().map(|section| section.watched().map(watch)).collect()
}

/// A clamped wall of tetrahedra.
fn of_tetrahedra(scene: &SceneFile, solid: &OwnSolid) -> anyhow::Result<Shape> {
    let OwnSolid { mesh, chamber, warnings } = solid;
    ensure!(!mesh.chamber.is_empty(), NO_CHAMBER);
    let thickness = scene.wall.thickness;
    let (surface, _) = mesh.boundary();
    let ends = EndSets::of_solid(mesh, Ends::of_solid(mesh, &scene.wall), &surface);
    let Ends { length, clamp_top, tip_bottom, .. } = ends.heights;
    ensure!(
        ends.clamp.len() > 3,
        "the clamp below z = {clamp_top:.3} mm holds {} nodes, fewer than 4; raise [wall] clamp_height",
        ends.clamp.len()
    );
    ensure!(clamp_top < tip_bottom && length > 0.0, holds_the_tip(clamp_top, tip_bottom));
    // Folds are those of middles of walls.
    let setup = PartSetup { folds: None, ..scene.setup(scene.load_settings().pressure)? };
    let held = SolidMesh::unknowns_of(&ends.clamp);
    if let Some(motions) = free_motions(&mesh.positions, &held) {
        bail!(
            "the clamp below z = {clamp_top:.3} mm leaves the part free to move: {motions}; see [wall] clamp_height"
        );
    }
    let material = scene.material.material()?;
    let model = PartModel::of_solid(mesh, thickness, &material, &held.into(), &setup)
        .map_err(|rejected| anyhow!("{rejected}"))?;
    let watches = watches_of_tip(scene, &ends)?;
    let chamber = Some(ChamberReport::new(chamber, &model));
    Ok(Shape { surface, model, chamber, warnings: warnings.clone(), watches, ends: Some(ends) })
}

/// What is said of tetrahedra with nothing to inflate.
pub(crate) const NO_CHAMBER: &str = "the wall surrounds no chamber; name the group of its triangles as [part] chamber, with close_inlet = true where it is open at a flat air inlet";

fn of_patch(scene: &SceneFile, section: &PatchSection) -> anyhow::Result<Shape> {
    let surface = section.surface()?;
    let mut patch = Patch::new(section.cells, section.s, section.t, scene.wall.thickness, &surface)
        .map_err(|rejected| anyhow!("[part.patch]: {rejected}"))?;
    patch.section = scene.regions()?.of_patch(&patch)?;
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
        let dead = match force.acting()? {
            Force::Point { at, force } => DeadLoad::Point { vertex: vertex(at)?, force },
            Force::Edge { side, per_length } => DeadLoad::Edge { side, per_length },
            Force::Area { per_area } => DeadLoad::Area { per_area },
            Force::FollowerPoint { at, force } => {
                loads.followers.push(FollowerForce::Point { vertex: vertex(at)?, force });
                continue;
            }
            Force::FollowerEdge { side, per_length } => {
                loads.followers.push(FollowerForce::Edge { side, per_length });
                continue;
            }
        };
        loads.dead.push(dead);
    }
    for moment in &scene.moments {
        loads.moments.push((moment.side, moment.per_length()?));
    }
    if let Some(motions) = loads.free_motions(&patch) {
        let of_planes = if scene.planes.is_empty() {
            ""
        } else {
            " (a [[plane]] pushes a part, but does not hold it)"
        };
        bail!(
            "[part.patch] can move freely: {motions}; hold it with an [[edge]] or a [[pin]]{of_planes}"
        );
    }
    let setup = scene.setup(loads.mean_pressure(&patch))?;
    let materials = scene.materials()?;
    let element = scene.wall.element.unwrap_or_default();
    let model = PartModel::of_patch(&patch, element, &materials, &loads, &setup)
        .map_err(|rejected| anyhow!("[part.patch]: {rejected}"))?;
    let watches = scene
        .watches
        .iter()
        .map(|section| {
            let watched = section.watched()?;
            let vertices = match watched {
                Watched::Vertex { at, .. } => vec![vertex(at)?],
                _ => Vec::new(),
            };
            Ok(Watch { watched, vertices, length: 0.0 })
        })
        .collect::<anyhow::Result<_>>()?;
    let (chamber, warnings, ends) = (None, Vec::new(), None);
    Ok(Shape { surface: patch.surface, model, chamber, warnings, watches, ends })
}
