//! A shell that is clamped at its base and has a tip, as a shell or as the solid around it, ready
//! to be walked.

use std::path::Path;

use anyhow::{Context, anyhow, bail, ensure};

use super::material::instability;
use super::observer::Observer;
use super::part::closed_part::shell;
use super::part::solid_part::SolidPart;
use super::part::{PartSource, own_surface};
use super::results::walk_summary;
use super::scene_file::SceneFile;
use crate::math::Rejected;
use crate::mesh::{Ends, ShellMesh};
use crate::model::system::System;
use crate::model::{PartModel, Support};
use crate::solve::{Ending, Path as Walked, PathPoint, SolveTimes, Stop, follow_watched};
use crate::surface::SurfaceQuality;

/// A part with a clamp and a tip.
pub(crate) struct Actuator {
    pub mesh: ShellMesh,
    /// Of the mesh.
    pub surface: SurfaceQuality,
    pub model: PartModel,
    /// Where the scene has a `[solid]`.
    pub solid: Option<SolidPart>,
}

impl Actuator {
    /// The part of the `scene` read from `path`.
    ///
    /// # Errors
    /// When its surface makes no shell, or its wall no solid.
    pub(crate) fn new(
        scene: &SceneFile,
        source: &PartSource<'_>,
        path: &Path,
        observer: &dyn Observer,
    ) -> anyhow::Result<Self> {
        let lies = source.check_size(&scene.part, scene.wall.thickness)?;
        let mesh = shell(scene, source, observer)?;
        check_tip(&mesh).with_context(|| path.display().to_string())?;
        let surface = SurfaceQuality::of(&mesh.surface)?;
        let setup = scene.setup(scene.load_settings().pressure)?;
        let materials = scene.materials()?;
        let unstable = materials.iter().filter_map(instability);
        unstable.for_each(|line| observer.warning(&line));
        let failed = |rejected: Rejected| anyhow!("{}: {rejected}", path.display());
        let mut model =
            PartModel::new(&mesh, &materials, &Support::Clamp, &setup).map_err(failed)?;
        let judgement = own_surface::judged(scene, source, &mesh, &model)?;
        lies.iter().chain(&judgement).for_each(|line| observer.warning(line));
        let solid = match &scene.solid {
            None => None,
            Some(section) => Some(SolidPart::new(&mesh, &model, section)?.map_err(failed)?),
        };
        if let Some(solid) = &solid {
            model = solid.model(&mesh, &materials, &setup).map_err(failed)?;
        }
        Ok(Self { mesh, surface, model, solid })
    }

    /// Its path until `stop` wants the end, and what that took; no points only where it was
    /// interrupted at rest.
    ///
    /// # Errors
    /// When the part is not stable at rest or its path stalls there, or a solver fails.
    pub(crate) fn walk(
        &mut self,
        scene: &SceneFile,
        stop: Stop<'_>,
        observer: &dyn Observer,
    ) -> anyhow::Result<(Walked, SolveTimes)> {
        let model = &mut self.model;
        let mut solver = scene.solver.backend.solver_by(scene.solver.linear, model.pattern())?;
        let load = scene.load_settings();
        let programme = scene.programme(model.volume(&vec![0.0; model.unknowns()]))?;
        observer.walk_begins(programme);
        let (solver_ref, settings) = (solver.as_mut(), &load.path);
        let note = &mut |point: &PathPoint| observer.state(point);
        let walked = follow_watched(model, solver_ref, programme, settings, stop, note)?;
        walk_summary::check_left_rest(&walked)?;
        ensure!(
            !walked.points.is_empty() || walked.ending == Ending::Interrupted,
            "the part is not stable at rest ({}): look at its mesh and its material",
            walked.ending.name().replace('_', " ")
        );
        Ok((walked, solver.times()))
    }
}

/// What is wrong with a clamp up to the height `clamp_top` of a part whose tip begins at the height
/// `tip`, mm.
pub(crate) fn holds_the_tip(clamp_top: f64, tip: f64) -> String {
    format!(
        "the clamp holds the tip too: it holds all below z = {clamp_top:.3} mm, and the tip begins at z = {tip:.3} mm; lower [wall] clamp_height or tip_fraction, unless the file is not in mm"
    )
}

/// Refuses a clamp that leaves nothing to watch.
fn check_tip(mesh: &ShellMesh) -> anyhow::Result<()> {
    let held = mesh.held_vertices();
    if mesh.ends.tip.iter().any(|v| !held.contains(v)) {
        return Ok(());
    }
    let Ends { clamp_top, tip_bottom, .. } = mesh.ends.heights;
    ensure!(clamp_top < tip_bottom, holds_the_tip(clamp_top, tip_bottom));
    bail!(
        "the clamp holds the tip too: the vertices beside those below z = {clamp_top:.3} mm are held with them, and some are the tip, above z = {tip_bottom:.3} mm; mesh the part finer"
    )
}
