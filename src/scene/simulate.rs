//! `simulate`: one part under its load, walked, and its results written into a folder.

use std::path::Path;

use anyhow::Context;
use serde::Serialize;

use super::actuator::Actuator;
use super::observer::{End, Observer, Unobserved};
use super::part::PartSource;
use super::part::on_disk::OnDisk;
use super::part::solid_part::SolidReport;
use super::results::contact_rows::{PlaneSummary, plane_summaries, planes_in_words, write_contact};
use super::results::design_folder::{
    write_json, write_model_pictures, write_pictures, write_surface, write_watches,
};
use super::results::path_rows::{LoadKind, ReactionSummary, State, path_table, states};
use super::results::walk_summary::WalkSummary;
use super::scene_file::SceneFile;
use super::shape::watches_of_tip;
use super::simulate_shape::{self, ShapeSummary};
use crate::fitness::{Observation, StageSeconds, observations};
use crate::io::provenance::Provenance;
use crate::io::{OutputFolder, atomic, msh};
use crate::math::cpu_seconds;
use crate::mesh::ShellElement;
use crate::model::{BorneStates, PartModel};
use crate::solve::{Backend, Job, Path as Walked, PathPoint, SolveCounts, Stop};
use crate::surface::SurfaceQuality;

/// A scene file, where its results go, and which process this is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Request<'a> {
    pub scene: &'a Path,
    /// The new folder of the results.
    pub out: &'a Path,
    /// Instead of the scene's.
    pub solver: Option<Backend>,
    /// Its first process writes.
    pub job: Job,
}

/// What has become of a scene.
pub(crate) struct Simulated {
    pub end: End,
    /// What was written; none by processes but the first, and where the path was interrupted at
    /// rest.
    pub summary: Option<Summary>,
}

/// `summary.json`.
#[derive(Debug, Serialize)]
#[serde(untagged)]
pub(crate) enum Summary {
    Actuator(Box<ActuatorSummary>),
    Shape(Box<ShapeSummary>),
}

impl Summary {
    /// Two lines or more for a person; `out` is where the results are.
    pub(crate) fn in_words(&self, out: &Path) -> String {
        match self {
            Self::Actuator(summary) => summary.in_words(out),
            Self::Shape(summary) => summary.in_words(out),
        }
    }
}

/// Of a part with a clamp and a tip: the last state of the path, and what it took.
#[derive(Debug, Serialize)]
pub(crate) struct ActuatorSummary {
    /// Mean displacement of the tip set, mm.
    tip: [f64; 3],
    max_displacement: f64,
    angle_deg: f64,
    tangent_angle_deg: f64,
    /// MPa.
    pressure: f64,
    /// Enclosed by the mid-surface, of a solid by the chamber, mm^3.
    volume_initial: f64,
    volume_final: f64,
    /// mJ.
    work: f64,
    stored_energy: f64,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    planes: Vec<PlaneSummary>,
    /// Of the clamp on the part.
    reaction: Option<ReactionSummary>,
    #[serde(flatten)]
    walk: WalkSummary,
    #[serde(flatten)]
    counts: SolveCounts,
    unknowns: usize,
    /// The finite element of the shell, also of that from which a solid is made.
    element: ShellElement,
    /// Share of the wall whose bending is softened at creases.
    creased_share: f64,
    solver: Backend,
    cpu_seconds: StageSeconds,
    surface: SurfaceQuality,
    #[serde(skip_serializing_if = "Option::is_none")]
    solid: Option<SolidReport>,
    provenance: Provenance,
}

/// Walks the scene of `request` until `stop` wants the end; the first process writes its results.
///
/// # Errors
/// When the scene, a file that it names or its folder is refused, its part cannot be made, or a
/// solver fails.
pub(crate) fn simulate(
    request: &Request<'_>,
    stop: Stop<'_>,
    observer: &dyn Observer,
) -> anyhow::Result<Simulated> {
    let Request { scene: path, out, solver, job } = *request;
    let start = cpu_seconds();
    if job.is_first() {
        OutputFolder::check_unclaimed(out)?;
    }
    let observer = if job.is_first() { observer } else { &Unobserved };
    let scene = SceneFile::read(path, solver)?;
    let source = scene.part.source(path, &OnDisk)?;
    if !source.is_actuator() {
        return simulate_shape::simulate(request, &scene, &source, stop, observer);
    }
    let mut actuator = Actuator::new(&scene, &source, path, observer)?;
    let meshing = cpu_seconds() - start;
    let claim = job.is_first().then(|| OutputFolder::claim(out)).transpose()?;
    let walked = actuator.walk(&scene, stop, observer).with_context(|| path.display().to_string());
    let Some((folder, lock)) = claim else {
        return Ok(Simulated { end: End::of(&walked?.0), summary: None });
    };
    let (walked, times) = match walked {
        Ok(walked) if !walked.0.points.is_empty() => walked,
        nothing => {
            folder.give_back(lock);
            return Ok(Simulated { end: End::of(&nothing?.0), summary: None });
        }
    };
    let Actuator { mesh, model, .. } = &mut actuator;
    let rows = observations(&*mesh, model, &walked.points);
    let states = states(model, &walked.points, true);
    if let Some(preset) = scene.material.preset()
        && let Some(line) = preset.passed_by(|| largest_stretch(model, &walked.points))
    {
        observer.warning(&line);
    }
    let seconds = StageSeconds {
        meshing,
        assembly: times.assembly,
        factorization: times.factorization,
        rest: cpu_seconds() - start - meshing - times.assembly - times.factorization,
    };
    let read = Read { walked: &walked, rows: &rows, states: &states };
    let summary = read.summary(&scene, &source, &actuator, seconds);
    read.write(&folder, &scene, &source, &mut actuator)?;
    let summary = Summary::Actuator(Box::new(summary));
    write_json(&folder.file("summary.json"), &summary)?;
    lock.remove();
    Ok(Simulated { end: End::of(&walked), summary: Some(summary) })
}

/// The largest stretch of the middle of the wall, or in a solid, at any of `points`.
fn largest_stretch(model: &PartModel, points: &[PathPoint]) -> f64 {
    let of_point = |point: &PathPoint| match model.borne_states(&point.x) {
        Some(BorneStates::Shell(states)) => {
            states.iter().map(|state| state.stretches[0]).fold(1.0, f64::max)
        }
        Some(BorneStates::Solid(states)) => {
            states.iter().map(|state| state.stretches[0]).fold(1.0, f64::max)
        }
        None => 1.0,
    };
    points.iter().map(of_point).fold(1.0, f64::max)
}

/// A path, and what was read off its states.
struct Read<'a> {
    walked: &'a Walked,
    rows: &'a [Observation],
    states: &'a [State],
}

impl Read<'_> {
    fn summary(
        &self,
        scene: &SceneFile,
        source: &PartSource<'_>,
        actuator: &Actuator,
        cpu_seconds: StageSeconds,
    ) -> ActuatorSummary {
        let Self { walked, rows, states } = *self;
        let Actuator { mesh, surface, model, solid } = actuator;
        let last = rows.last().expect("a walked path has its start");
        ActuatorSummary {
            tip: [last.tip_x, last.tip_y, last.tip_z],
            max_displacement: last.max_displacement,
            angle_deg: last.angle_deg,
            tangent_angle_deg: last.tangent_angle_deg,
            pressure: last.pressure,
            volume_initial: rows[0].volume,
            volume_final: last.volume,
            work: last.work,
            stored_energy: last.stored_energy,
            planes: plane_summaries(states),
            reaction: states.last().and_then(|state| state.reaction_of(source.placed())),
            walk: WalkSummary::new(walked, model).of_placed(source.placed()),
            counts: walked.counts,
            unknowns: model.unknowns(),
            element: mesh.element,
            creased_share: model.creased_share(),
            solver: scene.solver.backend,
            cpu_seconds,
            surface: surface.clone(),
            solid: solid.as_ref().map(|solid| solid.report.clone()),
            provenance: Provenance::of_this_process(),
        }
    }

    /// Writes everything but the summary, with the part at its place in the file.
    fn write(
        &self,
        folder: &OutputFolder,
        scene: &SceneFile,
        source: &PartSource<'_>,
        actuator: &mut Actuator,
    ) -> anyhow::Result<()> {
        let Self { walked, rows, states } = *self;
        let (points, placed) = (&walked.points, source.placed());
        let Actuator { mesh, model, solid, .. } = actuator;
        atomic::write(&folder.file("scene.toml"), toml::to_string(scene)?.as_bytes())?;
        placed.put_back(&mut mesh.surface.positions);
        solid.iter_mut().for_each(|solid| placed.put_back(&mut solid.mesh.positions));
        write_surface(folder.path(), mesh)?;
        if let Some(solid) = solid {
            msh::write(&folder.file("wall.msh"), &solid.mesh)?;
            write_model_pictures(folder.path(), "solid", model, points, placed)?;
        }
        let load = LoadKind::Pressure;
        path_table(load, points, states, rows).write(&folder.file("path.csv"))?;
        write_pictures(folder.path(), "path", &mesh.surface, model, points, placed)?;
        write_contact(folder.path(), load, points, states)?;
        if !scene.watches.is_empty() {
            let largest = scene.load_settings().pressure;
            let watches = watches_of_tip(scene, &mesh.ends)?;
            let curves: Vec<_> =
                watches.iter().map(|watch| watch.curve(model, points, largest)).collect();
            let names = scene.watches.iter().map(|watch| watch.name.as_str());
            write_watches(folder.path(), load, points, names.zip(&curves))?;
        }
        Ok(())
    }
}

impl ActuatorSummary {
    fn in_words(&self, out: &Path) -> String {
        let ending = self.walk.in_words();
        let solid = self.solid.as_ref().map_or_else(String::new, |solid| solid.in_words() + "\n");
        let [x, y, z] = self.tip;
        let planes = planes_in_words(&self.planes);
        let held = self.reaction.as_ref().map_or_else(String::new, ReactionSummary::in_words);
        format!(
            "{ending} at {:.4} MPa: tip moved by ({x:+.3}, {y:+.3}, {z:+.3}) mm, chord {:.2} deg, volume {:.1} -> {:.1} mm^3{planes}{held}\n\
             {solid}{} unknowns, {} Newton iterations, {:.2} CPU s ({:?}); results in {}",
            self.pressure,
            self.angle_deg,
            self.volume_initial,
            self.volume_final,
            self.unknowns,
            self.counts.newton_iterations,
            self.cpu_seconds.total(),
            self.solver,
            out.display()
        )
    }
}
