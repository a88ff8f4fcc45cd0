//! `film`: a design while it is inflated, free and against a plane, as a GIF.

use std::path::Path;

use anyhow::{Context, anyhow, ensure};

use super::design_pictures::{Pictured, PicturedPath, StoredPath};
use super::run_folder::RunFolder;
use crate::evolve::IndividualId;
use crate::fitness::{CandidateSettings, Outcome, evaluate_network};
use crate::math::Vec3;
use crate::report::gif_film;
use crate::solve::Backend;

/// A film of the design `id` of the run in `folder`, or without `id` of the part in a folder of
/// `simulate`: its name, and the GIF.
///
/// # Errors
/// When the folder is refused, or the design has no shape.
pub(crate) fn film(folder: &Path, id: Option<&str>) -> anyhow::Result<(String, Vec<u8>)> {
    let (name, pictured) = match id {
        Some(id) => {
            let id: IndividualId = id.parse()?;
            (id.to_string(), of_run(folder, id)?)
        }
        None => {
            ensure!(
                !folder.join("run.toml").exists(),
                "{} is a run: name a design of it, such as g003-017; front.csv lists the best",
                folder.display()
            );
            (stem(folder)?, of_simulation(folder)?)
        }
    };
    Ok((name, gif_film(&pictured.film())))
}

fn of_simulation(folder: &Path) -> anyhow::Result<Pictured> {
    let path = StoredPath::read(folder, "path")?;
    // Across the way of what moves farthest.
    let [first, last] = [0, path.surfaces.len() - 1].map(|k| &path.surfaces[k].positions);
    let ways = first.iter().zip(last).map(|(a, b)| b - a);
    let direction = ways.max_by(|a, b| a.norm().total_cmp(&b.norm())).unwrap_or(Vec3::x());
    Ok(Pictured { paths: vec![PicturedPath::free(path)], direction })
}

fn of_run(path: &Path, id: IndividualId) -> anyhow::Result<Pictured> {
    let folder = RunFolder::open(path)?;
    let run = folder.run_file()?;
    let stored = folder.path().join("front").join(id.to_string());
    if stored.join("path.csv").exists() {
        let paths = PicturedPath::stored(&run, |name| StoredPath::read(&stored, name))?;
        return Ok(Pictured { paths, direction: Vec3::from(run.fitness.plane_normal) });
    }
    let record = folder.record(id)?;
    let record = record.ok_or_else(|| {
        anyhow!("{} has no design {id}; front.csv lists its best", path.display())
    })?;
    if let Outcome::Rejected(rejected) = &record.outcome {
        return Err(anyhow!("{id} has no shape to film: {rejected}"));
    }
    let network = record.network(&run.representation()?);
    let settings =
        CandidateSettings { backend: Backend::Native, ..run.checked()?.candidate_settings()? };
    let candidate = evaluate_network(&network, &settings)?;
    let (Some(mesh), Some(scenarios)) = (candidate.mesh, candidate.scenarios) else {
        return Err(anyhow!("{id} was evaluated by the run, and is rejected by this program"));
    };
    Pictured::computed(&mesh, &scenarios, &run)
}

/// The last part of a path, links and dots followed.
fn stem(path: &Path) -> anyhow::Result<String> {
    let path = path.canonicalize().with_context(|| path.display().to_string())?;
    Ok(path.file_name().unwrap_or_default().to_string_lossy().into_owned())
}
