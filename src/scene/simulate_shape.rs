//! `simulate` on a part that is no shell with a tip (a patch, a sphere, an ellipsoid, tetrahedra): its path, its watches, its pictures.

use std::path::Path;

use anyhow::{Context, ensure};
use serde::Serialize;

use super::part::PartSource;
use super::scene_file::SceneFile;
use super::shape::{ChamberReport, Measured, Shape};
use super::simulate::NOTHING_WRITTEN;
use crate::cli::patience::End;
use crate::cli::terminal::say;
use crate::cli::terminal::warn;
use crate::fitness::observations;
use crate::io::provenance::Provenance;
use crate::io::{OutputFolder, atomic, stl};
use crate::math::cpu_seconds;
use crate::scene::results::contact_rows::{PlaneSummary, plane_summaries, write_contact};
use crate::scene::results::design_folder::{write_json, write_model_pictures, write_watches};
use crate::scene::results::path_rows::{
    LoadKind, ReactionSummary, path_table, planes_in_words, states,
};
use crate::scene::results::walk_summary::{WalkSummary, check_left_rest};
use crate::solve::{Backend, Ending, Job, Stop};

/// `summary.json`: the last state of the path, and what it took.
#[derive(Debug, Serialize)]
struct Summary<'a> {
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
    watches: Vec<Watch<'a>>,
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
    newton_iterations: usize,
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
struct Watch<'a> {
    name: &'a str,
    value: f64,
}

/// Runs the `scene` read from `path`; the first process of the `job` writes its results into the new folder `out`.
pub(crate) fn run(
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
        .measure(scene, scene.solver.backend, start, stop, !job.is_first())
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
        .filter_map(|(name, curve)| Some(Watch { name, value: curve.points.last()?.value }))
        .collect();
    let summary = Summary {
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
        newton_iterations: walked.newton_iterations,
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
    write_json(&folder.file("summary.json"), &summary)?;
    lock.remove();
    say(&if json {
        serde_json::to_string_pretty(&summary)?
    } else {
        summary.in_words(out, &planes_in_words(&end.planes))
    });
    Ok(End::of(&walked))
}

impl Summary<'_> {
    fn in_words(&self, out: &Path, planes: &str) -> String {
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
        let watch = |watch: &Watch<'_>| format!(", {} = {:.6e}", watch.name, watch.value);
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
            self.newton_iterations,
            self.cpu_seconds,
            self.solver,
            out.display()
        )
    }
}
