//! `simulate`: one part under pressure.

use std::collections::BTreeSet;
use std::path::Path;

use anyhow::{Context, anyhow, bail, ensure};
use serde::Serialize;

use super::material::instability;
use super::part::PartFiles;
use super::scene_file::SceneFile;
use super::shape::watches_of_closed;
use super::simulate_shape;
use crate::cli::patience::{End, Patience};
use crate::cli::terminal::say;
use crate::cli::terminal::warn;
use crate::cli::walk_progress::WalkProgress;
use crate::fitness::{StageSeconds, observations};
use crate::genome::{Network, NetworkDraft};
use crate::io::provenance::Provenance;
use crate::io::{ChamberChoice, OutputFolder, OwnSolid, atomic, msh, part_file, stl, toml_file};
use crate::math::{Rejected, cpu_seconds};
use crate::mesh::{ShellElement, ShellMesh, ShellSettings};
use crate::model::system::System;
use crate::model::{PartModel, Support};
use crate::scene::part::closed_part::shell;
use crate::scene::part::own_surface;
use crate::scene::part::solid_part::{SolidPart, SolidReport};
use crate::scene::results::contact_rows::{PlaneSummary, plane_summaries, write_contact};
use crate::scene::results::design_folder::{
    write_json, write_model_pictures, write_pictures, write_surface, write_watches,
};
use crate::scene::results::path_rows::{
    LoadKind, ReactionSummary, State, path_table, planes_in_words, states,
};
use crate::scene::results::walk_summary;
use crate::scene::results::walk_summary::WalkSummary;
use crate::solve::{
    Backend, Ending, Job, Path as Walked, PathPoint, SolveTimes, Stop, follow_watched,
};
use crate::surface::{SurfaceQuality, TriangleMesh};

/// `summary.json`: the last state of the path, and what it took.
#[derive(Debug, Serialize)]
struct Summary {
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
    newton_iterations: usize,
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

/// Runs the scene at `path`; the first process of the `job` writes its results into the new folder `out`.
pub(crate) fn run(
    path: &Path,
    out: &Path,
    solver: Option<Backend>,
    json: bool,
    job: Job,
) -> anyhow::Result<End> {
    let start = cpu_seconds();
    if job.is_first() {
        OutputFolder::check_unclaimed(out)?;
    }
    let patience = Patience::new(None)?;
    // All processes walk one path, and end it together; a job that can no longer talk is over.
    let is_over = || job.any(patience.is_over()).unwrap_or(true);
    let stop = Stop::when(&is_over);
    let scene = SceneFile::read(path, solver)?;
    let source = scene.part.source(path, &OnDisk)?;
    let lies = source.check_size(&scene.part, scene.wall.thickness)?;
    if !source.is_actuator() {
        if job.is_first() {
            lies.iter().for_each(|line| warn(line));
        }
        return simulate_shape::run(path, &scene, &source, out, json, job, stop);
    }
    let mut mesh = shell(&scene, &source)?;
    check_tip(&mesh, &scene.wall).with_context(|| path.display().to_string())?;
    let surface = SurfaceQuality::of(&mesh.surface)?;

    let planes = scene.plane_settings(scene.load_settings().pressure)?;
    let material = scene.material.material()?;
    if job.is_first() {
        instability(&material).iter().for_each(|line| warn(line));
    }
    let failed = |rejected: Rejected| anyhow!("{}: {rejected}", path.display());
    let mut model = PartModel::new(&mesh, &material, &Support::Clamp, &planes).map_err(failed)?;
    let judgement = own_surface::judged(&scene, &source, &mesh, &model)?;
    if job.is_first() {
        lies.iter().chain(&judgement).for_each(|line| warn(line));
    }
    model.watch_folds(!scene.load.may_overlap);
    if let Some(settings) = scene.self_contact()? {
        model.keep_folds_apart(settings);
    }
    let mut solid = match &scene.solid {
        None => None,
        Some(section) => Some(SolidPart::new(&model, mesh.thickness, section)?.map_err(failed)?),
    };
    if let Some(solid) = &solid {
        model = solid.model(&mesh, &material, &planes).map_err(failed)?;
    }
    let meshing = cpu_seconds() - start;
    let claim = job.is_first().then(|| OutputFolder::claim(out)).transpose()?;
    let walked =
        walk(&scene, &mut model, stop, !job.is_first()).with_context(|| path.display().to_string());
    let Some((folder, lock)) = claim else { return Ok(End::of(&walked?.0)) };
    let (walked, times) = match walked {
        Ok(walked) if !walked.0.points.is_empty() => walked,
        nothing => {
            folder.give_back(lock);
            let (walked, _) = nothing?;
            say(NOTHING_WRITTEN);
            return Ok(End::of(&walked));
        }
    };
    let rows = observations(&mesh, &model, &walked.points);
    let last = rows.last().expect("a walked path has its start");
    let states = states(&mut model, &walked.points, true);
    let summary = Summary {
        tip: [last.tip_x, last.tip_y, last.tip_z],
        max_displacement: last.max_displacement,
        angle_deg: last.angle_deg,
        tangent_angle_deg: last.tangent_angle_deg,
        pressure: last.pressure,
        volume_initial: rows[0].volume,
        volume_final: last.volume,
        work: last.work,
        stored_energy: last.stored_energy,
        planes: plane_summaries(&states),
        reaction: states.last().and_then(|state| state.reaction_of(source.placed())),
        walk: WalkSummary::new(&walked, &model).of_placed(source.placed()),
        newton_iterations: walked.newton_iterations,
        unknowns: model.unknowns(),
        element: mesh.element,
        creased_share: model.creased_share(),
        solver: scene.solver.backend,
        cpu_seconds: StageSeconds {
            meshing,
            assembly: times.assembly,
            factorization: times.factorization,
            rest: cpu_seconds() - start - meshing - times.assembly - times.factorization,
        },
        surface,
        solid: solid.as_ref().map(|solid| solid.report.clone()),
        provenance: Provenance::of_this_process(),
    };
    atomic::write(&folder.file("scene.toml"), toml::to_string(&scene)?.as_bytes())?;
    source.placed().put_back(&mut mesh.surface.positions);
    solid.iter_mut().for_each(|solid| source.placed().put_back(&mut solid.mesh.positions));
    write_surface(folder.path(), &mesh)?;
    if let Some(solid) = &solid {
        msh::write(&folder.file("wall.msh"), &solid.mesh)?;
        write_model_pictures(folder.path(), "solid", &model, &walked.points, source.placed())?;
    }
    let load = LoadKind::Pressure;
    path_table(load, &walked.points, &states, &rows).write(&folder.file("path.csv"))?;
    write_pictures(folder.path(), "path", &mesh.surface, &model, &walked.points, source.placed())?;
    write_contact(folder.path(), load, &walked.points, &states)?;
    if !scene.watches.is_empty() {
        let largest = scene.load_settings().pressure;
        let curves: Vec<_> = watches_of_closed(&scene, &mesh)?
            .iter()
            .map(|watch| watch.curve(&model, &walked.points, largest))
            .collect();
        let names = scene.watches.iter().map(|watch| watch.name.as_str());
        write_watches(folder.path(), load, &walked.points, names.zip(&curves))?;
    }
    write_json(&folder.file("summary.json"), &summary)?;
    lock.remove();
    say(&if json {
        serde_json::to_string_pretty(&summary)?
    } else {
        summary.in_words(out, &states)
    });
    Ok(End::of(&walked))
}

/// What is said of a path that was interrupted in its first state.
pub(crate) const NOTHING_WRITTEN: &str = "interrupted before the path began; nothing is written";

/// The path of a part that is stable at rest, and what it took.
fn walk(
    scene: &SceneFile,
    model: &mut PartModel,
    stop: Stop<'_>,
    is_silent: bool,
) -> anyhow::Result<(Walked, SolveTimes)> {
    let mut solver = scene.solver.backend.solver_by(scene.solver.linear, model.pattern())?;
    let load = scene.load_settings();
    model.set_stretch_bound(load.stretch_bound);
    let programme = scene.programme(model.volume(&vec![0.0; model.unknowns()]))?;
    let mut progress = WalkProgress::new(programme, is_silent);
    let (solver_ref, settings) = (solver.as_mut(), &load.path);
    let note = &mut |point: &PathPoint| progress.note(point);
    let walked = follow_watched(model, solver_ref, programme, settings, stop, note)?;
    ensure!(
        !walked.points.is_empty() || walked.ending == Ending::Interrupted,
        "the part is not stable at rest ({}): look at its mesh and its material",
        walked.ending.name().replace('_', " ")
    );
    walk_summary::check_left_rest(&walked)?;
    Ok((walked, solver.times()))
}

/// Files where they are.
pub(crate) struct OnDisk;

impl PartFiles for OnDisk {
    fn network(&self, path: &Path) -> anyhow::Result<Network> {
        read_network(path)
    }

    fn surface(&self, path: &Path) -> anyhow::Result<TriangleMesh> {
        Ok(stl::read(path, stl::WELD_TOLERANCE)?)
    }

    fn tetrahedra(&self, path: &Path, choice: &ChamberChoice) -> anyhow::Result<OwnSolid> {
        Ok(part_file::solid(path, choice)?)
    }
}

/// Reads a network file.
pub(crate) fn read_network(path: &Path) -> anyhow::Result<Network> {
    let draft: NetworkDraft = toml_file::read(path)?;
    Network::try_from(draft).with_context(|| path.display().to_string())
}

/// What is wrong with a clamp up to the height `clamp_top` of a part whose tip begins at the height `tip`, mm.
pub(crate) fn holds_the_tip(clamp_top: f64, tip: f64) -> String {
    format!(
        "the clamp holds the tip too: it holds all below z = {clamp_top:.3} mm, and the tip begins at z = {tip:.3} mm; lower [wall] clamp_height or tip_fraction, unless the file is not in mm"
    )
}

/// Refuses a clamp that leaves nothing to watch.
fn check_tip(mesh: &ShellMesh, wall: &ShellSettings) -> anyhow::Result<()> {
    let held: BTreeSet<u32> =
        mesh.clamp.iter().flat_map(|&v| mesh.rings.ring(v).iter().copied().chain([v])).collect();
    if mesh.tip.iter().any(|v| !held.contains(v)) {
        return Ok(());
    }
    let (clamp_top, tip) = (mesh.clamp_top, mesh.base + (1.0 - wall.tip_fraction) * mesh.length);
    ensure!(clamp_top < tip, holds_the_tip(clamp_top, tip));
    bail!(
        "the clamp holds the tip too: the vertices beside those below z = {clamp_top:.3} mm are held with them, and some are the tip, above z = {tip:.3} mm; mesh the part finer"
    )
}

impl Summary {
    fn in_words(&self, out: &Path, states: &[State]) -> String {
        let ending = self.walk.in_words();
        let solid = self.solid.as_ref().map_or_else(String::new, |solid| solid.in_words() + "\n");
        let [x, y, z] = self.tip;
        let planes = states.last().map_or_else(String::new, |state| planes_in_words(&state.planes));
        let held = self.reaction.as_ref().map_or_else(String::new, ReactionSummary::in_words);
        format!(
            "{ending} at {:.4} MPa: tip moved by ({x:+.3}, {y:+.3}, {z:+.3}) mm, chord {:.2} deg, volume {:.1} -> {:.1} mm^3{planes}{held}\n\
             {solid}{} unknowns, {} Newton iterations, {:.2} CPU s ({:?}); results in {}",
            self.pressure,
            self.angle_deg,
            self.volume_initial,
            self.volume_final,
            self.unknowns,
            self.newton_iterations,
            self.cpu_seconds.total(),
            self.solver,
            out.display()
        )
    }
}
