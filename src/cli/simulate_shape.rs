//! `simulate` on a part without a tip (a patch, a sphere, an ellipsoid): its path, its watches, its pictures.

use std::path::Path;

use anyhow::{Context, ensure};
use serde::Serialize;

use super::contact_rows::{PlaneSummary, plane_summaries, write_contact};
use super::design_folder::{write_json, write_model_pictures, write_watches};
use super::part::PartSource;
use super::patience::End;
use super::provenance::Provenance;
use super::scene_file::SceneFile;
use super::shape::{ChamberReport, Measured, Shape};
use super::simulate::NOTHING_WRITTEN;
use super::walk_summary::{WalkSummary, check_left_rest};
use super::{say, warn};
use crate::fitness::stability;
use crate::io::{OutputFolder, atomic, csv, stl};
use crate::math::cpu_seconds;
use crate::solve::{Backend, Ending, Job, Stop};

/// A row of `path.csv`.
#[derive(Debug, Serialize)]
struct Row {
    step: usize,
    /// Of a patch: the share of its loads; of a closed part: the pressure, MPa.
    load: f64,
    /// mJ.
    work: f64,
    stored_energy: f64,
    /// mm.
    max_displacement: f64,
    /// With self-contact: the smallest gap between faces, mm (`inf` above half a thickness), and their force, N.
    #[serde(skip_serializing_if = "Option::is_none")]
    wall_gap: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    self_contact_force: Option<f64>,
    newton_iterations: usize,
    /// Steps given up since the row before.
    step_cuts: usize,
    /// `stable`, `unstable`, or `snapped` on the way from the row before.
    stability: &'static str,
}

/// `summary.json`: the last state of the path, and what it took.
#[derive(Debug, Serialize)]
struct Summary<'a> {
    load: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    chamber: Option<ChamberReport>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    warnings: Vec<String>,
    watches: Vec<Watch<'a>>,
    stored_energy: f64,
    max_displacement: f64,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    planes: Vec<PlaneSummary>,
    #[serde(flatten)]
    walk: WalkSummary,
    linear: bool,
    newton_iterations: usize,
    unknowns: usize,
    solver: Backend,
    cpu_seconds: f64,
    provenance: Provenance,
}

#[derive(Debug, Serialize)]
struct Watch<'a> {
    name: &'a str,
    value: f64,
}

/// Runs the `scene` read from `path`; the first process of the `job` writes its results into the new folder `out`.
pub(super) fn run(
    path: &Path,
    scene: &SceneFile,
    source: &PartSource<'_>,
    out: &Path,
    json: bool,
    job: Job,
    stop: Stop<'_>,
) -> anyhow::Result<End> {
    let start = cpu_seconds();
    let named = || path.display().to_string();
    let mut shape = Shape::new(scene, source).with_context(named)?;
    if let PartSource::Tetrahedra { file, .. } = source
        && job.is_first()
    {
        let file = file.display();
        shape.warnings.iter().for_each(|warning| warn(&format!("{file}: {warning}")));
    }
    let claim = job.is_first().then(|| OutputFolder::claim(out)).transpose()?;
    let measured = shape
        .measure(scene, scene.solver.backend, start, stop)
        .and_then(|measured| check_left_rest(&measured.walked).map(|()| measured))
        .with_context(named);
    let Some((folder, lock)) = claim else { return Ok(End::of(&measured?.walked)) };
    let Measured { walked, unknowns, cpu_seconds, curves, .. } = match measured {
        Ok(measured) if !measured.walked.points.is_empty() => measured,
        nothing => {
            folder.give_back(lock);
            let Measured { walked, .. } = nothing?;
            ensure!(
                walked.ending == Ending::Interrupted,
                "{}: the part is not stable at rest ({}); is it held against all rigid motions?",
                path.display(),
                walked.ending.name().replace('_', " ")
            );
            say(NOTHING_WRITTEN);
            return Ok(End::Stopped);
        }
    };
    let largest_of = |x: &[f64]| {
        let sizes = shape.model.vertex_displacements(x).into_iter().map(|u| u.norm());
        sizes.fold(0.0, f64::max)
    };
    let has_contact = shape.model.keeps_folds_apart();
    let rows: Vec<Row> = walked
        .points
        .iter()
        .enumerate()
        .map(|(step, point)| Row {
            step,
            load: point.load,
            work: point.work,
            stored_energy: point.stored_energy,
            max_displacement: largest_of(&point.x),
            wall_gap: has_contact.then(|| shape.model.smallest_wall_gap(&point.x)),
            self_contact_force: has_contact.then(|| shape.model.self_contact_force(&point.x)),
            newton_iterations: point.newton_iterations,
            step_cuts: point.cuts,
            stability: stability(point),
        })
        .collect();
    let last = rows.last().expect("it has the start at least");
    let watches = || scene.watches.iter().map(|watch| watch.name.as_str()).zip(&curves);
    let final_values = watches()
        .filter_map(|(name, curve)| Some(Watch { name, value: curve.points.last()?.value }))
        .collect();
    let summary = Summary {
        load: last.load,
        chamber: shape.chamber.clone(),
        warnings: shape.warnings.clone(),
        watches: final_values,
        stored_energy: last.stored_energy,
        max_displacement: last.max_displacement,
        planes: plane_summaries(&shape.model, &walked.points),
        walk: WalkSummary::new(&walked, &shape.model).of_placed(source.placed()),
        linear: scene.load.linear,
        newton_iterations: walked.newton_iterations,
        unknowns,
        solver: scene.solver.backend,
        cpu_seconds,
        provenance: Provenance::of_this_process(),
    };
    atomic::write(&folder.file("scene.toml"), toml::to_string(scene)?.as_bytes())?;
    source.placed().put_back(&mut shape.surface.positions);
    stl::write(&folder.file("surface.stl"), &shape.surface)?;
    csv::write(&folder.file("path.csv"), &rows)?;
    write_contact(folder.path(), &shape.model, &walked.points)?;
    write_watches(folder.path(), watches())?;
    write_model_pictures(folder.path(), "path", &shape.model, &walked.points, source.placed())?;
    write_json(&folder.file("summary.json"), &summary)?;
    lock.remove();
    say(&if json { serde_json::to_string_pretty(&summary)? } else { summary.in_words(out) });
    Ok(End::of(&walked))
}

impl Summary<'_> {
    fn in_words(&self, out: &Path) -> String {
        let watches: Vec<String> = self
            .watches
            .iter()
            .map(|watch| format!("{} = {:.6e}", watch.name, watch.value))
            .collect();
        let chamber =
            self.chamber.as_ref().map_or_else(String::new, |chamber| chamber.in_words() + "\n");
        format!(
            "{} at load {:.4}: largest displacement {:.4e} mm, stored energy {:.4e} mJ{}{}\n\
             {chamber}{} unknowns, {} Newton iterations, {:.2} CPU s ({:?}); results in {}",
            self.walk.in_words(),
            self.load,
            self.max_displacement,
            self.stored_energy,
            if watches.is_empty() { "" } else { ", " },
            watches.join(", "),
            self.unknowns,
            self.newton_iterations,
            self.cpu_seconds,
            self.solver,
            out.display()
        )
    }
}
