//! An individual of a run as a deck for other programs.

use std::path::Path;

use anyhow::{Context, anyhow, ensure};

use super::run_folder::RunFolder;
use crate::evolve::IndividualId;
use crate::fitness::shell_of_network;
use crate::model::material::Material;
use crate::scene::deck::{Choices, Subject, compressible, solid};
use crate::solve::LinearMethod;

/// What the decks of the individual `id` of the run in `folder` are of.
///
/// # Errors
/// When the folder or the name is refused, or the wall cannot be filled.
pub(crate) fn of_run(folder: &Path, id: &str, choices: &Choices) -> anyhow::Result<Subject> {
    let folder = RunFolder::open(folder)?;
    let mut run = folder.run_file()?;
    run.solver.backend = choices.solver.unwrap_or(run.solver.backend);
    let id: IndividualId = id.parse()?;
    let logged = folder.logged()?;
    let record = logged.all().find(|record| record.id == id).with_context(|| {
        format!("{} has no individual {id}; front.csv lists its best", folder.path().display())
    })?;
    ensure!(run.pattern.is_none(), "[pattern] is not written into decks");
    let mut settings = run.candidate_settings()?;
    let was_incompressible = settings.material.poisson_ratio() == 0.5;
    let material = compressible(&settings.material, choices.poisson_ratio)?;
    settings.material = Material::Compressible(material.clone());
    let network = record.network(&run.representation()?);
    let shell = shell_of_network(&network, &settings).map_err(|rejected| anyhow!("{rejected}"))?;
    let section = choices.section(run.solid.unwrap_or_default())?;
    let (mesh, report) = solid(&shell, &settings.material, &section)?;
    Ok(Subject {
        design: id.to_string(),
        mesh,
        chamber: None,
        report: Some(report),
        wall: settings.wall,
        ends: shell.ends.heights,
        material,
        was_incompressible,
        load: settings.load,
        backend: settings.backend,
        linear: LinearMethod::Automatic,
    })
}
