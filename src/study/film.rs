//! `film`: a design while it is inflated, free and against a plane, as a GIF.

use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow, ensure};

use super::design_pictures::{Blocking, Pictured, StoredPath};
use super::run_folder::RunFolder;
use crate::cli::terminal::say;
use crate::evolve::IndividualId;
use crate::fitness::{CandidateSettings, Outcome, evaluate_network};
use crate::genome::Genome;
use crate::io::atomic;
use crate::math::Vec3;
use crate::report::gif_film;
use crate::solve::Backend;

/// What is filmed.
#[derive(Debug, clap::Args)]
pub(crate) struct Film {
    /// The folder of a run, or of `simulate`.
    folder: PathBuf,
    /// Of a run: the design, such as g003-017. The front's designs have their shapes in the folder; others are computed again.
    id: Option<String>,
    /// The file; must not exist [default: the design's name and .gif, here].
    #[arg(long)]
    out: Option<PathBuf>,
}

impl Film {
    /// Draws the film and writes it.
    pub(crate) fn run(&self) -> anyhow::Result<()> {
        if let Some(out) = &self.out {
            check_new(out)?;
        }
        let (name, pictured) = match &self.id {
            Some(id) => {
                let id: IndividualId = id.parse()?;
                (id.to_string(), self.of_run(id)?)
            }
            None => {
                ensure!(
                    !self.folder.join("run.toml").exists(),
                    "{} is a run: name a design of it, such as g003-017; front.csv lists the best",
                    self.folder.display()
                );
                (stem(&self.folder)?, self.of_simulation()?)
            }
        };
        let out = self.out.clone().unwrap_or_else(|| PathBuf::from(format!("{name}.gif")));
        check_new(&out)?;
        atomic::write(&out, &gif_film(&pictured.film()))?;
        say(&out.display().to_string());
        Ok(())
    }

    fn of_simulation(&self) -> anyhow::Result<Pictured> {
        let path = StoredPath::read(&self.folder, "path")?;
        // Across the way of what moves farthest.
        let [first, last] = [0, path.surfaces.len() - 1].map(|k| &path.surfaces[k].positions);
        let ways = first.iter().zip(last).map(|(a, b)| b - a);
        let direction = ways.max_by(|a, b| a.norm().total_cmp(&b.norm())).unwrap_or(Vec3::x());
        Ok(Pictured { free: path, blocked: None, direction })
    }

    fn of_run(&self, id: IndividualId) -> anyhow::Result<Pictured> {
        let folder = RunFolder::open(&self.folder)?;
        let run = folder.run_file()?;
        let blocking = Blocking::of(&run)?;
        let stored = folder.path().join("front").join(id.to_string());
        if stored.join("path.csv").exists() {
            let path = |name| StoredPath::read(&stored, name);
            let blocked = Some((path("path_blocked")?, blocking));
            let direction = Vec3::from(run.fitness.plane_normal);
            return Ok(Pictured { free: path("path")?, blocked, direction });
        }
        let record = folder.record(id)?;
        let record = record.ok_or_else(|| {
            anyhow!("{} has no design {id}; front.csv lists its best", self.folder.display())
        })?;
        if let Outcome::Rejected(rejected) = &record.outcome {
            return Err(anyhow!("{id} has no shape to film: {rejected}"));
        }
        let network = Genome::try_from(record.genome.clone())?.decode();
        let settings =
            CandidateSettings { backend: Backend::Native, ..run.checked()?.candidate_settings()? };
        let candidate = evaluate_network(&network, &settings)?;
        let (Some(mesh), Some(scenarios)) = (candidate.mesh, candidate.scenarios) else {
            return Err(anyhow!("{id} was evaluated by the run, and is rejected by this program"));
        };
        Ok(Pictured::computed(&mesh, &scenarios, blocking))
    }
}

/// The last part of a path, links and dots followed.
fn stem(path: &Path) -> anyhow::Result<String> {
    let path = path.canonicalize().with_context(|| path.display().to_string())?;
    Ok(path.file_name().unwrap_or_default().to_string_lossy().into_owned())
}

/// Refuses a file that is there.
fn check_new(path: &Path) -> anyhow::Result<()> {
    ensure!(!path.exists(), "{} exists; choose another name with --out", path.display());
    Ok(())
}
