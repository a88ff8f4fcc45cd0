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

use super::meaning::Meaning;
use super::observer::{Limits, Observer};
use super::overload::overload;
use super::run_file::RunFile;
use crate::batch::{Executor, Next, Outcome as Ended, Stopped, Threads};
use crate::evolve::Nsga2;
use crate::fitness::{
    CandidateSettings, Certificate, Evaluation, FidelitySettings, Outcome, Scenarios, Unevaluated,
    Verdict, evaluate_model, evaluate_network, evaluate_network_until, flags,
};
use crate::genome::{Genome, Network};
use crate::io::provenance::COMMIT;
use crate::io::{FolderLock, OutputFolder, atomic, csv, input, msh};
use crate::math::{Rejected, cpu_seconds};
use crate::mesh::ShellMesh;
use crate::report::FrontPoint;
use crate::scene::End;
use crate::scene::part::on_disk::read_network;
use crate::scene::part::solid_part::{SolidPart, SolidReport, SolidSection};
use crate::scene::results::design_folder::{write_json, write_surface};
use crate::scene::results::path_rows::write_scenarios;
use crate::solve::{Backend, Stop};

/// A design to be certified.
pub(crate) struct Design {
    pub name: String,
    pub network: Network,
}

/// A row of `certificates.csv`; what failed has no numbers behind its reason.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Row {
    pub design: String,
    /// A [`Verdict`], or the room and reason of a rejection.
    pub verdict: String,
    /// Of the shell, then of the solid.
    pub bending_shell: Option<f64>,
    pub bending_solid: Option<f64>,
    pub blocking_shell: Option<f64>,
    pub blocking_solid: Option<f64>,
    pub figure_of_merit_solid: Option<f64>,
    pub max_force_solid: Option<f64>,
    /// Reasons to doubt the solid's objectives, by name.
    pub flags: String,
    /// Deviations as in [`Certificate`].
    pub angle: Option<f64>,
    pub force: Option<f64>,
    pub work: Option<f64>,
    pub growth: Option<f64>,
    #[serde(rename = "common_pressure_MPa", alias = "common_pressure")]
    pub common_pressure: Option<f64>,
    /// The largest deviation of a coarser solid.
    pub coarser_solid: Option<f64>,
    pub mesher: Option<String>,
    pub tetrahedra: Option<usize>,
    pub unknowns: Option<usize>,
    /// CPU seconds of one thread's clock; meshers run as other processes.
    pub seconds_shell: Option<f64>,
    pub seconds_solid: Option<f64>,
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
    csv::write(&folder.file("certificates.csv"), &rows)?;
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
    let candidates = Nsga2::new(evolution, run.gene_bounds()?, 2)?.ask();
    let mut designs = Vec::new();
    for batch in candidates.chunks(2 * wanted) {
        let outcomes = executor.evaluate(
            batch,
            &|candidate| {
                let genome = Genome::try_from(candidate.genome.clone());
                let network = genome.expect("drawn within the bounds").decode();
                let outcome = evaluate_network(&network, settings)?.outcome;
                let is_valid = matches!(outcome, Outcome::Evaluated(_));
                anyhow::Ok(is_valid.then_some(network))
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
    let row = Row::new(&design.name);
    let (shell, mesh, mut scenarios) =
        match (candidate.outcome, candidate.mesh, candidate.scenarios) {
            (Outcome::Evaluated(shell), Some(mesh), Some(scenarios)) => (shell, mesh, scenarios),
            (Outcome::Rejected(rejected), ..) => return Ok(row.rejected(&rejected)),
            _ => unreachable!("an evaluated candidate has its mesh and its scenarios"),
        };
    write_surface(folder, &mesh)?;
    write_scenarios(folder, ["path", "path_blocked"], &mut scenarios, None)?;
    let row = Row {
        bending_shell: Some(shell.bending),
        blocking_shell: Some(shell.blocking),
        seconds_shell: Some(cpu_seconds() - start),
        ..row
    };
    let start = cpu_seconds();
    let mut certified = match certify(&mesh, &scenarios, settings, section, stop)? {
        Ok(certified) => certified,
        Err(rejected) => return Ok(row.rejected(&rejected)),
    };
    let solid = &mut certified.scenarios;
    write_scenarios(folder, ["path_solid", "path_solid_blocked"], solid, None)?;
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
    Ok(Row { seconds_solid: Some(cpu_seconds() - start), ..row.certified(&certified) })
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
        let part = match SolidPart::new(&scenarios.model, shell.thickness, section)? {
            Ok(part) => part,
            Err(rejected) => return Ok(Err(rejected)),
        };
        let planes = [settings.fitness.plane(settings.load.pressure)];
        let model = match part.model(shell, &settings.material, &planes) {
            Ok(model) => model,
            Err(rejected) => return Ok(Err(rejected)),
        };
        let CandidateSettings { load, fitness, backend, .. } = settings;
        let evaluated = evaluate_model(shell, model, load, fitness, *backend, stop)?;
        Ok(evaluated.map(|(evaluation, scenarios)| (part, evaluation, scenarios)))
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

/// The row of a finished design, in its folder.
const ROW: &str = "row.json";
const MOST_DRAWN: usize = 10_000;
/// Genomes drawn for each design that is wanted; more than half of them make one.
const DRAWS_FOR_EACH: usize = 8;

impl Row {
    pub(crate) fn new(design: &str) -> Self {
        Self {
            design: design.to_owned(),
            verdict: String::new(),
            bending_shell: None,
            bending_solid: None,
            blocking_shell: None,
            blocking_solid: None,
            figure_of_merit_solid: None,
            max_force_solid: None,
            flags: String::new(),
            angle: None,
            force: None,
            work: None,
            growth: None,
            common_pressure: None,
            coarser_solid: None,
            mesher: None,
            tetrahedra: None,
            unknowns: None,
            seconds_shell: None,
            seconds_solid: None,
        }
    }

    fn rejected(self, rejected: &Rejected) -> Self {
        Self { verdict: format!("{:?}/{}", rejected.room, rejected.reason).to_lowercase(), ..self }
    }

    fn certified(self, certified: &Certified) -> Self {
        let Certified { part, evaluation, certificate, coarser, .. } = certified;
        Self {
            verdict: word(certificate.verdict).to_owned(),
            bending_solid: Some(evaluation.bending),
            blocking_solid: Some(evaluation.blocking),
            figure_of_merit_solid: Some(evaluation.figure_of_merit),
            max_force_solid: Some(evaluation.max_force),
            flags: flags(&evaluation.exploits),
            angle: Some(certificate.angle),
            force: Some(certificate.force),
            work: Some(certificate.work),
            growth: Some(certificate.growth),
            common_pressure: Some(certificate.common_pressure),
            coarser_solid: coarser.map(|coarser| coarser.largest()),
            mesher: Some(part.report.mesher.clone()),
            tetrahedra: Some(part.report.quality.tetrahedra),
            unknowns: Some(evaluation.unknowns),
            ..self
        }
    }

    /// Both objectives of the solid, where it has some.
    pub(crate) fn solid_objectives(&self) -> Option<[f64; 2]> {
        Some([self.bending_solid?, self.blocking_solid?])
    }

    /// The solid as figures show it, where it has objectives.
    pub(crate) fn front_point(&self) -> Option<FrontPoint> {
        Some(FrontPoint {
            id: self.design.clone(),
            bending: self.bending_solid?,
            blocking: self.blocking_solid?,
            figure_of_merit: self.figure_of_merit_solid?,
            max_force: self.max_force_solid?,
            flags: self.flags.clone(),
            further: Vec::new(),
            reached: None,
            mesh_error: None,
        })
    }
}

fn word(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Trust => "trust",
        Verdict::Check => "check",
        Verdict::Misleads => "misleads",
    }
}

/// The rows for a terminal.
pub(crate) fn table(rows: &[Row]) -> String {
    let percent = |share: Option<f64>| {
        share.map_or_else(|| "-".to_owned(), |share| format!("{:.1}", 100.0 * share))
    };
    let number = |value: Option<f64>, digits: usize| {
        value.map_or_else(|| "-".to_owned(), |value| format!("{value:.digits$}"))
    };
    let mut lines = vec![format!(
        "{:<12} {:>8} {:>8} {:>8} {:>8} {:>7} {:>7} {:>7} {:>7} {:>8} {:>8} {:>8}  verdict",
        "design",
        "F_c",
        "solid",
        "F_bf",
        "solid",
        "angle%",
        "force%",
        "work%",
        "grow%",
        "coarse%",
        "tets",
        "CPU s"
    )];
    for row in rows {
        lines.push(format!(
            "{:<12} {:>8} {:>8} {:>8} {:>8} {:>7} {:>7} {:>7} {:>7} {:>8} {:>8} {:>8}  {}",
            row.design,
            number(row.bending_shell, 4),
            number(row.bending_solid, 4),
            number(row.blocking_shell, 5),
            number(row.blocking_solid, 5),
            percent(row.angle),
            percent(row.force),
            percent(row.work),
            percent(row.growth),
            percent(row.coarser_solid),
            row.tetrahedra.map_or_else(|| "-".to_owned(), |count| count.to_string()),
            number(row.seconds_solid, 1),
            row.verdict
        ));
    }
    lines.join("\n")
}

/// What of a run's certificates is told to a person who wants one line.
pub(crate) fn summary(rows: &[Row], settings: &FidelitySettings) -> String {
    let count = |verdict: Verdict| rows.iter().filter(|row| row.verdict == word(verdict)).count();
    let [trust, check, misleads] = [Verdict::Trust, Verdict::Check, Verdict::Misleads].map(count);
    format!(
        "of {} designs the shell is right within {:.0} % for {trust}, within {:.0} % for {check}, misleads for {misleads}; {} have no solid",
        rows.len(),
        100.0 * settings.trust,
        100.0 * settings.check,
        rows.len() - trust - check - misleads
    )
}
