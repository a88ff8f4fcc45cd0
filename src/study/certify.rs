//! `certify`: designs as shells and as solids, and how far they agree.
//!
//! ```text
//! certificates.csv        one row for each design
//! settings.json           with what they were made
//! <design>/  row.json  genome.toml  surface.stl  wall.msh  path.csv  path_blocked.csv  path_solid.csv  path_solid_blocked.csv  certificate.json
//! ```

use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow, bail, ensure};
use serde::{Deserialize, Serialize};

use super::certificate_row::{Row, table};
use super::meaning::Meaning;
use super::observer::{Limits, Observer};
use super::overload::overload;
use super::run_file::RunFile;
use crate::batch::{Executor, Next, Outcome as Ended, Stopped, Threads};
use crate::evolve::Nsga2;
use crate::fitness::{
    CandidateSettings, Certificate, Evaluation, NotEvaluated, Outcome, Part, Scenarios,
    Unevaluated, evaluate, evaluate_genome, evaluate_network_until,
};
use crate::genome::{Network, Representation};
use crate::io::provenance::COMMIT;
use crate::io::{FolderLock, OutputFolder, atomic, csv, input, msh};
use crate::math::{Rejected, cpu_seconds};
use crate::mesh::ShellMesh;
use crate::model::material::Material;
use crate::model::{MaterialLimits, PartModel, PartSetup};
use crate::scene::End;
use crate::scene::part::on_disk::read_network;
use crate::scene::part::solid_part::{SolidPart, SolidReport, SolidSection};
use crate::scene::pattern::PatternSection;
use crate::scene::results::design_folder::{write_json, write_surface};
use crate::scene::results::path_rows::write_scenarios;
use crate::solve::{Backend, SolveCounts, Stop};

/// A design to be certified.
pub(crate) struct Design {
    pub name: String,
    pub network: Network,
}

/// `certificate.json`.
#[derive(Debug, Serialize)]
struct Sheet<'a> {
    certificate: Certificate,
    shell: Evaluation,
    solid: &'a Evaluation,
    #[serde(skip_serializing_if = "Option::is_none")]
    coarser_solid: Option<Certificate>,
    mesh: &'a SolidReport,
}

/// A design's solid beside its shell.
pub(crate) struct Certified {
    pub part: SolidPart,
    pub evaluation: Evaluation,
    pub scenarios: Scenarios,
    pub certificate: Certificate,
    /// How a solid of a coarser mesh compares with this one.
    pub coarser: Option<Certificate>,
}

/// What is certified, and how.
pub(crate) struct Request<'a> {
    pub run: &'a Path,
    /// Networks, or none where designs are drawn.
    pub files: &'a [PathBuf],
    /// How many valid designs of the first generation are drawn.
    pub random: usize,
    pub out: &'a Path,
    /// Whether to go on in a folder.
    pub resume: bool,
    pub threads: usize,
    pub solver: Option<Backend>,
}

/// Certifies what the `request` names.
///
/// # Errors
/// When a file or the folder is refused, a design has no name of its own, or a solver or a mesher
/// fails as a program.
pub(crate) fn certify_designs(
    request: &Request<'_>,
    limits: &dyn Limits,
    observer: &dyn Observer,
) -> anyhow::Result<End> {
    let &Request { files, random, out, .. } = request;
    if !request.resume {
        OutputFolder::check_unclaimed(out)?;
    }
    let run = RunFile::read(request.run, request.solver)?;
    let section = run.solid.unwrap_or_default();
    section.check_programs()?;
    ensure!(random <= MOST_DRAWN, "--random is {random}, but at most {MOST_DRAWN} are drawn");
    let settings = run.candidate_settings()?;
    overload(&run, &settings.material).iter().for_each(|line| observer.warning(line));
    ensure!(
        files.is_empty() != (random == 0),
        "certify wants either network files or --random with a number of designs"
    );
    let executor = Threads::new(request.threads)?;
    let designs =
        if random == 0 { named(files)? } else { drawn(&run, &settings, random, &executor)? };
    for Design { name, network } in &designs {
        PatternSection::check(run.pattern.as_ref(), network).with_context(|| name.clone())?;
    }
    let (folder, _lock) = if request.resume {
        (OutputFolder::open(out)?, FolderLock::take(out)?)
    } else {
        OutputFolder::claim(out)?
    };
    let certifying = Certifying {
        settings: &settings,
        section: &section,
        meaning: &Meaning::of_certificates(&run, &section)?,
        folder: folder.path(),
        limits,
        observer,
    };
    let CertifiedRows { rows, is_complete } = certifying.rows(&designs, &executor)?;
    csv::write_cells(&folder.file("certificates.csv"), &rows)?;
    observer.table(&table(&rows));
    if !is_complete {
        observer.note(&format!(
            "{} after {} of {} designs; what has ended is in {}, and --resume goes on",
            limits.why(),
            rows.len(),
            designs.len(),
            out.display()
        ));
        return Ok(End::Stopped);
    }
    observer.note(&format!("results in {}", out.display()));
    Ok(End::Finished)
}

fn named(files: &[PathBuf]) -> anyhow::Result<Vec<Design>> {
    let design = |path: &PathBuf| {
        let stem = path.file_stem().with_context(|| format!("{} names no file", path.display()))?;
        // A run's designs are files of one name in folders of theirs.
        let folder = path.parent().and_then(Path::file_name).filter(|_| stem == "genome");
        let name = folder.unwrap_or(stem).to_string_lossy().into_owned();
        Ok(Design { name, network: read_network(path)? })
    };
    let designs: Vec<Design> = files.iter().map(design).collect::<anyhow::Result<_>>()?;
    for (i, design) in designs.iter().enumerate() {
        ensure!(
            designs[..i].iter().all(|before| before.name != design.name),
            "two designs are called {}",
            design.name
        );
    }
    Ok(designs)
}

/// The first designs of the search's first generation that the shell evaluates.
fn drawn(
    run: &RunFile,
    settings: &CandidateSettings,
    wanted: usize,
    executor: &Threads,
) -> anyhow::Result<Vec<Design>> {
    let mut evolution = run.evolution.clone();
    evolution.population = DRAWS_FOR_EACH * wanted;
    let representation = run.representation()?;
    let candidates = Nsga2::new(evolution, representation.clone(), 2)?.ask();
    let mut designs = Vec::new();
    for batch in candidates.chunks(2 * wanted) {
        let outcomes = executor.evaluate(
            batch,
            &|candidate| {
                let genome = &candidate.genome;
                let candidate = evaluate_genome(&representation, genome, settings, Stop::NEVER)?;
                let is_valid = matches!(candidate.outcome, Outcome::Evaluated(_));
                anyhow::Ok(is_valid.then(|| representation.express(genome)))
            },
            &mut |_, _| Next::Continue,
        )?;
        for (candidate, outcome) in batch.iter().zip(outcomes) {
            if let Some(network) = outcome??
                && designs.len() < wanted
            {
                designs.push(Design { name: candidate.id.to_string(), network });
            }
        }
        if designs.len() == wanted {
            break;
        }
    }
    ensure!(!designs.is_empty(), "none of {} genomes makes a valid design", candidates.len());
    Ok(designs)
}

/// How designs are certified, and where.
pub(crate) struct Certifying<'a> {
    pub settings: &'a CandidateSettings,
    pub section: &'a SolidSection,
    /// What settings and section mean.
    pub meaning: &'a Meaning,
    /// Holds a folder for each design.
    pub folder: &'a Path,
    pub limits: &'a dyn Limits,
    /// Is told of each design that has ended.
    pub observer: &'a dyn Observer,
}

/// Rows in the order of their designs.
pub(crate) struct CertifiedRows {
    pub rows: Vec<Row>,
    /// Whether no design lacks its row, because it was stopped.
    pub is_complete: bool,
}

impl Certifying<'_> {
    /// Certifies `designs`, and writes each into a folder of its own. A design whose row is there already is not walked again.
    pub(crate) fn rows(
        &self,
        designs: &[Design],
        executor: &Threads,
    ) -> anyhow::Result<CertifiedRows> {
        self.bind_folder()?;
        let before = designs.iter().map(|design| self.finished(design));
        let before: Vec<Option<Row>> = before.collect::<anyhow::Result<_>>()?;
        let open = || designs.iter().zip(&before).filter(|(_, row)| row.is_none());
        let open: Vec<&Design> = open().map(|(design, _)| design).collect();
        let is_over = || self.limits.is_over();
        let stop = Stop::when(&is_over);
        let (mut done, mut failure) = (designs.len() - open.len(), None);
        self.observer.work_begins("solids", done, designs.len());
        let mut watch = |_, ended: &Ended<anyhow::Result<Option<String>>>| {
            match ended {
                Ok(Ok(Some(told))) => {
                    done += 1;
                    self.observer.item_done();
                    self.observer.note(&format!("{told} ({done} of {})", designs.len()));
                }
                Ok(Ok(None)) => return Next::Stop,
                Ok(Err(error)) => failure = Some(anyhow!("{error:#}")),
                Err(panicked) => failure = Some(anyhow!("{panicked}")),
            }
            if failure.is_some() || self.limits.is_over() { Next::Stop } else { Next::Continue }
        };
        let (settings, section, folder) = (self.settings, self.section, self.folder);
        let certify = |design: &&Design| certified(design, settings, section, folder, stop);
        let ended = executor.evaluate(&open, &certify, &mut watch);
        self.observer.work_ends();
        if let Some(failure) = failure {
            return Err(failure);
        }
        if let Err(lost @ Stopped::Lost(_)) = ended {
            return Err(lost.into());
        }
        let rows = designs.iter().map(|design| self.finished(design));
        let rows: Vec<Option<Row>> = rows.collect::<anyhow::Result<_>>()?;
        let is_complete = rows.iter().all(Option::is_some);
        Ok(CertifiedRows { rows: rows.into_iter().flatten().collect(), is_complete })
    }

    /// Refuses a folder whose rows were made with other settings.
    fn bind_folder(&self) -> anyhow::Result<()> {
        let path = self.folder.join(SETTINGS);
        if path.exists() {
            let text = input::bytes(&path, input::SETTINGS)?;
            let kept: Settings =
                serde_json::from_slice(&text).with_context(|| path.display().to_string())?;
            if let Some(difference) = self.meaning.first_difference(&kept.settings) {
                bail!(
                    "{} was made with other settings: {difference}; choose another folder, or remove it",
                    self.folder.display()
                );
            }
            if kept.commit != COMMIT {
                self.observer.warning(&format!(
                    "{} was made by another build (commit {}, now {COMMIT})",
                    self.folder.display(),
                    kept.commit
                ));
            }
        }
        std::fs::create_dir_all(self.folder).with_context(|| self.folder.display().to_string())?;
        write_json(&path, &Settings { commit: COMMIT.to_owned(), settings: self.meaning.clone() })
    }

    /// The row of a design that has ended already.
    fn finished(&self, design: &Design) -> anyhow::Result<Option<Row>> {
        let folder = self.folder.join(&design.name);
        let row = folder.join(ROW);
        if !row.exists() {
            return Ok(None);
        }
        let genome = folder.join(GENOME);
        let is_same =
            input::text(&genome, input::SETTINGS).is_ok_and(|of| of == design.network.to_toml());
        ensure!(
            is_same,
            "{} is not the design {} that is asked for",
            genome.display(),
            design.name
        );
        let text = input::bytes(&row, input::DATA)?;
        let row = serde_json::from_slice(&text).with_context(|| row.display().to_string())?;
        Ok(Some(row))
    }
}

/// Writes the row of a design into a folder of its own in `folder`, and says how it ended; nothing where it was stopped.
fn certified(
    design: &Design,
    settings: &CandidateSettings,
    section: &SolidSection,
    folder: &Path,
    stop: Stop<'_>,
) -> anyhow::Result<Option<String>> {
    let folder = folder.join(&design.name);
    let row = match certify_design(design, settings, section, &folder, stop) {
        Ok(row) => row,
        Err(error) if error.downcast_ref() == Some(&Unevaluated::Stopped) => return Ok(None),
        Err(error) => return Err(error.context(design.name.clone())),
    };
    write_json(&folder.join(ROW), &row)?;
    let seconds = row.seconds_shell.unwrap_or(0.0) + row.seconds_solid.unwrap_or(0.0);
    Ok(Some(format!("{}: {}, {seconds:.1} CPU s", row.design, row.verdict)))
}

/// `settings.json`: with what the rows of a folder were made.
#[derive(Serialize, Deserialize)]
struct Settings {
    commit: String,
    settings: Meaning,
}

const SETTINGS: &str = "settings.json";
const GENOME: &str = "genome.toml";

fn certify_design(
    design: &Design,
    settings: &CandidateSettings,
    section: &SolidSection,
    folder: &Path,
    stop: Stop<'_>,
) -> anyhow::Result<Row> {
    std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    atomic::write(&folder.join(GENOME), design.network.to_toml().as_bytes())?;
    let start = cpu_seconds();
    let candidate = evaluate_network_until(&design.network, settings, stop)?;
    let row = Row::new(&design.name, settings.fitness.objectives());
    let (shell, mesh, mut scenarios) =
        match (candidate.outcome, candidate.mesh, candidate.scenarios) {
            (Outcome::Evaluated(shell), Some(mesh), Some(scenarios)) => (shell, mesh, scenarios),
            (Outcome::Rejected(rejected), ..) => return Ok(row.rejected(&rejected)),
            _ => unreachable!("an evaluated candidate has its mesh and its scenarios"),
        };
    write_surface(folder, &mesh)?;
    write_scenarios(folder, "", &mut scenarios, None)?;
    let row = Row { seconds_shell: Some(cpu_seconds() - start), ..row.with_shell(&shell) };
    let start = cpu_seconds();
    let mut certified = match certify(&mesh, &scenarios, settings, section, stop)? {
        Ok(certified) => certified,
        Err(rejected) => return Ok(row.rejected(&rejected)),
    };
    let solid = &mut certified.scenarios;
    write_scenarios(folder, "solid", solid, None)?;
    let Certified { part, evaluation, certificate, coarser, .. } = &certified;
    msh::write(&folder.join("wall.msh"), &part.mesh)?;
    let sheet = Sheet {
        certificate: *certificate,
        shell,
        solid: evaluation,
        coarser_solid: *coarser,
        mesh: &part.report,
    };
    write_json(&folder.join("certificate.json"), &sheet)?;
    let row = row.certified(evaluation, &part.report, certificate, coarser.as_ref());
    Ok(Row { seconds_solid: Some(cpu_seconds() - start), ..row })
}

/// Walks the scenarios of the solid around the `shell` whose `scenarios` are known.
///
/// # Errors
/// When a library or a mesher cannot be run, and [`Unevaluated::Stopped`] where `stop` wanted the end. A wall or a path that fails is the inner [`Rejected`].
pub(crate) fn certify(
    shell: &ShellMesh,
    scenarios: &Scenarios,
    settings: &CandidateSettings,
    section: &SolidSection,
    stop: Stop<'_>,
) -> anyhow::Result<Result<Certified, Rejected>> {
    let walked = |section: &SolidSection| -> anyhow::Result<Result<_, Rejected>> {
        let solid = match SolidPart::new(shell, scenarios.model(), section)? {
            Ok(solid) => solid,
            Err(rejected) => return Ok(Err(rejected)),
        };
        let CandidateSettings { load, fitness, backend, .. } = settings;
        let (materials, limits) = (&settings.materials(), &settings.limits);
        let part = SolidOfShell { solid: &solid, shell, materials, limits };
        let mut counts = SolveCounts::default();
        match evaluate(&part, load, fitness, *backend, stop, &mut counts) {
            Ok((evaluation, scenarios)) => Ok(Ok((solid, evaluation, scenarios))),
            Err(NotEvaluated::Rejected(rejected)) => Ok(Err(rejected)),
            Err(NotEvaluated::Unevaluated(why)) => Err(why.into()),
        }
    };
    let (part, evaluation, solid) = match walked(section)? {
        Ok(walked) => walked,
        Err(rejected) => return Ok(Err(rejected)),
    };
    let coarser = match section.coarser {
        None => None,
        Some(times) => match walked(&section.scaled(times))? {
            Ok((_, _, coarse)) => Some(Certificate::new(&coarse, &solid, &section.fidelity)),
            // It only says how good the first is.
            Err(_) => None,
        },
    };
    let certificate = Certificate::new(scenarios, &solid, &section.fidelity);
    Ok(Ok(Certified { part, evaluation, scenarios: solid, certificate, coarser }))
}

/// The solid of a shell's wall as a part to be evaluated.
struct SolidOfShell<'a> {
    solid: &'a SolidPart,
    shell: &'a ShellMesh,
    materials: &'a [Material],
    limits: &'a [MaterialLimits],
}

impl Part for SolidOfShell<'_> {
    fn shell(&self) -> &ShellMesh {
        self.shell
    }

    fn model(&self, setup: &PartSetup) -> Result<PartModel, Rejected> {
        self.solid.model(self.shell, self.materials, setup)
    }

    fn limits(&self) -> &[MaterialLimits] {
        self.limits
    }

    fn wall_volume_cm3(&self) -> f64 {
        1e-3 * self.solid.report.quality.volume
    }
}

/// The row of a finished design, in its folder.
const ROW: &str = "row.json";
const MOST_DRAWN: usize = 10_000;
/// Genomes drawn for each design that is wanted; more than half of them make one.
const DRAWS_FOR_EACH: usize = 8;
