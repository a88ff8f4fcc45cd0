//! `simulate` on a part that is no shell with a tip (a patch, a sphere, an ellipsoid, tetrahedra): its path, its watches, its pictures.

use std::path::Path;

use anyhow::{Context, ensure};
use serde::Serialize;

use super::observer::{End, Observer};
use super::part::PartSource;
use super::results::contact_rows::{PlaneSummary, plane_summaries, planes_in_words, write_contact};
use super::results::design_folder::{write_json, write_model_pictures, write_watches};
use super::results::path_rows::{LoadKind, ReactionSummary, path_table, states};
use super::results::walk_summary::{WalkSummary, check_left_rest};
use super::scene_file::SceneFile;
use super::shape::{ChamberReport, Measured, Shape};
use super::simulate::{Request, Simulated, Summary};
use crate::fitness::observations;
use crate::io::provenance::Provenance;
use crate::io::{OutputFolder, atomic, stl};
use crate::math::cpu_seconds;
use crate::solve::{Backend, Ending, SolveCounts, Stop};

/// Of a part that is no shell with a tip: the last state of the path, and what it took.
#[derive(Debug, Serialize)]
pub(crate) struct ShapeSummary {
    /// Of a closed part, MPa.
    #[serde(skip_serializing_if = "Option::is_none")]
    pressure: Option<f64>,
    /// Of a patch.
    #[serde(skip_serializing_if = "Option::is_none")]
    load_share: Option<f64>,
    #[serde(flatten)]
    tip: Option<TipSummary>,
    /// Of a closed part, mm^3.
    #[serde(skip_serializing_if = "Option::is_none")]
    volume_initial: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    volume_final: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    chamber: Option<ChamberReport>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    warnings: Vec<String>,
    watches: Vec<WatchValue>,
    stored_energy: f64,
    max_displacement: f64,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    planes: Vec<PlaneSummary>,
    /// Of all supports on the part.
    #[serde(skip_serializing_if = "Option::is_none")]
    reaction: Option<ReactionSummary>,
    #[serde(flatten)]
    walk: WalkSummary,
    linear: bool,
    #[serde(flatten)]
    counts: SolveCounts,
    unknowns: usize,
    solver: Backend,
    cpu_seconds: f64,
    provenance: Provenance,
}

/// Of a clamped part, as a shell's.
#[derive(Debug, Serialize)]
struct TipSummary {
    /// mm.
    tip: [f64; 3],
    angle_deg: f64,
    tangent_angle_deg: f64,
}

#[derive(Debug, Serialize)]
struct WatchValue {
    name: String,
    value: f64,
}

/// Walks the `scene` of `request`, read already; the first process writes its results.
///
/// # Errors
/// When its part cannot be made, is not stable at rest, or a solver fails.
pub(crate) fn simulate(
    request: &Request<'_>,
    scene: &SceneFile,
    source: &PartSource<'_>,
    stop: Stop<'_>,
    observer: &dyn Observer,
) -> anyhow::Result<Simulated> {
    let Request { scene: path, out, job, .. } = *request;
    let lies = source.check_size(&scene.part, scene.wall.thickness)?;
    lies.iter().for_each(|line| observer.warning(line));
    let start = cpu_seconds();
    let named = || path.display().to_string();
    let mut shape = Shape::new(scene, source, observer).with_context(named)?;
    if let PartSource::Tetrahedra { file, .. } = source {
        let file = file.display();
        shape.warnings.iter().for_each(|warning| observer.warning(&format!("{file}: {warning}")));
    }
    let claim = job.is_first().then(|| OutputFolder::claim(out)).transpose()?;
    let measured = shape
        .measure(scene, scene.solver.backend, start, stop, observer)
        .and_then(|measured| check_left_rest(&measured.walked).map(|()| measured))
        .with_context(named);
    let Some((folder, lock)) = claim else {
        return Ok(Simulated { end: End::of(&measured?.walked), summary: None });
    };
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
            return Ok(Simulated { end: End::Stopped, summary: None });
        }
    };
    let points = &walked.points;
    let is_patch = scene.part.patch.is_some();
    let load = if is_patch { LoadKind::Share } else { LoadKind::Pressure };
    // What holds a free body only takes its rigid motions away.
    let are_equilibria = !scene.load.linear && !scene.part.is_free();
    let states = states(&mut shape.model, points, are_equilibria);
    let rows = shape
        .watched()
        .map_or_else(Vec::new, |watched| observations(watched, &shape.model, points));
    let (first, last) = (&points[0], &points[points.len() - 1]);
    let end = states.last().expect("a state for each point");
    let watches = || scene.watches.iter().map(|watch| watch.name.as_str()).zip(&curves);
    let final_values = watches()
        .filter_map(|(name, curve)| {
            Some(WatchValue { name: name.to_owned(), value: curve.points.last()?.value })
        })
        .collect();
    let summary = ShapeSummary {
        pressure: (!is_patch).then_some(last.load),
        load_share: is_patch.then_some(last.load),
        tip: rows.last().map(|row| TipSummary {
            tip: [row.tip_x, row.tip_y, row.tip_z],
            angle_deg: row.angle_deg,
            tangent_angle_deg: row.tangent_angle_deg,
        }),
        volume_initial: (!is_patch).then_some(first.conjugate),
        volume_final: (!is_patch).then_some(last.conjugate),
        chamber: shape.chamber.clone(),
        warnings: shape.warnings.clone(),
        watches: final_values,
        stored_energy: last.stored_energy,
        max_displacement: end.max_displacement,
        planes: plane_summaries(&states),
        reaction: end.reaction_of(source.placed()),
        walk: WalkSummary::new(&walked, &shape.model).of_placed(source.placed()),
        linear: scene.load.linear,
        counts: walked.counts,
        unknowns,
        solver: scene.solver.backend,
        cpu_seconds,
        provenance: Provenance::of_this_process(),
    };
    atomic::write(&folder.file("scene.toml"), toml::to_string(scene)?.as_bytes())?;
    source.placed().put_back(&mut shape.surface.positions);
    stl::write(&folder.file("surface.stl"), &shape.surface)?;
    path_table(load, points, &states, &rows).write(&folder.file("path.csv"))?;
    write_contact(folder.path(), load, points, &states)?;
    write_watches(folder.path(), load, points, watches())?;
    write_model_pictures(folder.path(), "path", &shape.model, points, source.placed())?;
    let summary = Summary::Shape(Box::new(summary));
    write_json(&folder.file("summary.json"), &summary)?;
    lock.remove();
    Ok(Simulated { end: End::of(&walked), summary: Some(summary) })
}

impl ShapeSummary {
    pub(crate) fn in_words(&self, out: &Path) -> String {
        let load = match (self.load_share, self.pressure) {
            (Some(share), _) => format!("load share {share:.4}"),
            (None, pressure) => format!("{:.4} MPa", pressure.unwrap_or_default()),
        };
        let tip =
            self.tip.as_ref().map_or_else(String::new, |TipSummary { tip, angle_deg, .. }| {
                let [x, y, z] = tip;
                format!("tip moved by ({x:+.3}, {y:+.3}, {z:+.3}) mm, chord {angle_deg:.2} deg, ")
            });
        let volume = match (self.volume_initial, self.volume_final) {
            (Some(at_rest), Some(last)) => format!(", volume {at_rest:.1} -> {last:.1} mm^3"),
            _ => String::new(),
        };
        let held = self.reaction.as_ref().map_or_else(String::new, ReactionSummary::in_words);
        let planes = planes_in_words(&self.planes);
        let watch = |watch: &WatchValue| format!(", {} = {:.6e}", watch.name, watch.value);
        let watches: String = self.watches.iter().map(watch).collect();
        let chamber =
            self.chamber.as_ref().map_or_else(String::new, |chamber| chamber.in_words() + "\n");
        format!(
            "{} at {load}: {tip}largest displacement {:.4e} mm, stored energy {:.4e} mJ{volume}{planes}{held}{watches}\n\
             {chamber}{} unknowns, {} Newton iterations, {:.2} CPU s ({:?}); results in {}",
            self.walk.in_words(),
            self.max_displacement,
            self.stored_energy,
            self.unknowns,
            self.counts.newton_iterations,
            self.cpu_seconds,
            self.solver,
            out.display()
        )
    }
}
