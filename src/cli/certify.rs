//! `certify`: designs as shells and as solids, and how far they agree.
//!
//! ```text
//! certificates.csv        one row for each design
//! <design>/  row.json  genome.toml  surface.stl  wall.msh  path.csv  path_blocked.csv  path_solid.csv  path_solid_blocked.csv  certificate.json
//! ```

use std::path::{Path, PathBuf};

use anyhow::{Context, ensure};
use serde::{Deserialize, Serialize};

use super::design_folder::{write_json, write_surface};
use super::run_file::RunFile;
use super::say;
use super::simulate::read_network;
use super::solid_part::{SolidPart, SolidReport, SolidSection};
use crate::batch::{Executor, Next, Threads};
use crate::evolve::Nsga2;
use crate::fitness::{
    CandidateSettings, Certificate, Evaluation, FidelitySettings, Outcome, Scenarios, Verdict,
    evaluate_model, evaluate_network, flags,
};
use crate::genome::{Genome, Network};
use crate::io::{OutputFolder, atomic, csv, input, msh};
use crate::math::{Rejected, cpu_seconds};
use crate::mesh::ShellMesh;
use crate::report::FrontPoint;
use crate::solve::Backend;

/// A design to be certified.
pub(super) struct Design {
    pub name: String,
    pub network: Network,
}

/// A row of `certificates.csv`; what failed has no numbers behind its reason.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Row {
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
pub(super) struct Certified {
    pub part: SolidPart,
    pub evaluation: Evaluation,
    pub scenarios: Scenarios,
    pub certificate: Certificate,
    /// How a solid of a coarser mesh compares with this one.
    pub coarser: Option<Certificate>,
}

/// Certifies the networks in `files`, or as many valid designs of the first generation as `random` asks, by the run file at `run`.
pub(super) fn run(
    run: &Path,
    files: &[PathBuf],
    random: usize,
    out: &Path,
    threads: usize,
    solver: Option<Backend>,
) -> anyhow::Result<()> {
    OutputFolder::check_new(out)?;
    let run = RunFile::read(run, solver)?;
    let section = run.solid.unwrap_or_default();
    section.check_programs()?;
    ensure!(random <= MOST_DRAWN, "--random is {random}, but at most {MOST_DRAWN} are drawn");
    let settings = run.candidate_settings()?;
    ensure!(
        files.is_empty() != (random == 0),
        "certify wants either network files or --random with a number of designs"
    );
    let executor = Threads::new(threads)?;
    let designs =
        if random == 0 { named(files)? } else { drawn(&run, &settings, random, &executor)? };
    let folder = OutputFolder::create_new(out)?;
    let rows = certified(&designs, &settings, &section, folder.path(), &executor)?;
    csv::write(&folder.file("certificates.csv"), &rows)?;
    say(&table(&rows));
    say(&format!("results in {}", out.display()));
    Ok(())
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

/// Certifies `designs`, writes each into a folder of its own under `folder`, and returns their rows in order.
///
/// A design whose row is there already is not walked again.
pub(super) fn certified(
    designs: &[Design],
    settings: &CandidateSettings,
    section: &SolidSection,
    folder: &Path,
    executor: &Threads,
) -> anyhow::Result<Vec<Row>> {
    let outcomes = executor.evaluate(
        designs,
        &|design: &Design| {
            let folder = folder.join(&design.name);
            let finished = folder.join(ROW);
            if finished.exists() {
                let text = input::bytes(&finished, input::DATA)?;
                return serde_json::from_slice(&text)
                    .with_context(|| finished.display().to_string());
            }
            let row = certify_design(design, settings, section, &folder)?;
            write_json(&finished, &row)?;
            Ok(row)
        },
        &mut |_, _| Next::Continue,
    )?;
    outcomes.into_iter().map(|outcome| outcome?).collect()
}

fn certify_design(
    design: &Design,
    settings: &CandidateSettings,
    section: &SolidSection,
    folder: &Path,
) -> anyhow::Result<Row> {
    std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    atomic::write(&folder.join("genome.toml"), design.network.to_toml().as_bytes())?;
    let start = cpu_seconds();
    let candidate = evaluate_network(&design.network, settings)?;
    let row = Row::new(&design.name);
    let (shell, mesh, scenarios) = match (candidate.outcome, candidate.mesh, candidate.scenarios) {
        (Outcome::Evaluated(shell), Some(mesh), Some(scenarios)) => (shell, mesh, scenarios),
        (Outcome::Rejected(rejected), ..) => return Ok(row.rejected(&rejected)),
        _ => unreachable!("an evaluated candidate has its mesh and its scenarios"),
    };
    write_surface(folder, &mesh)?;
    csv::write(&folder.join("path.csv"), &scenarios.free_rows)?;
    csv::write(&folder.join("path_blocked.csv"), &scenarios.blocked_rows)?;
    let row = Row {
        bending_shell: Some(shell.bending),
        blocking_shell: Some(shell.blocking),
        seconds_shell: Some(cpu_seconds() - start),
        ..row
    };
    let start = cpu_seconds();
    let certified = match certify(&mesh, &scenarios, settings, section)? {
        Ok(certified) => certified,
        Err(rejected) => return Ok(row.rejected(&rejected)),
    };
    let Certified { part, evaluation, scenarios, certificate, coarser } = &certified;
    msh::write(&folder.join("wall.msh"), &part.mesh)?;
    csv::write(&folder.join("path_solid.csv"), &scenarios.free_rows)?;
    csv::write(&folder.join("path_solid_blocked.csv"), &scenarios.blocked_rows)?;
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
/// When a library or a mesher cannot be run. A wall or a path that fails is the inner [`Rejected`].
pub(super) fn certify(
    shell: &ShellMesh,
    scenarios: &Scenarios,
    settings: &CandidateSettings,
    section: &SolidSection,
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
        let evaluated = evaluate_model(shell, model, load, fitness, *backend)?;
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
    pub(super) fn new(design: &str) -> Self {
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
    pub(super) fn solid_objectives(&self) -> Option<[f64; 2]> {
        Some([self.bending_solid?, self.blocking_solid?])
    }

    /// The solid as figures show it, where it has objectives.
    pub(super) fn front_point(&self) -> Option<FrontPoint> {
        Some(FrontPoint {
            id: self.design.clone(),
            bending: self.bending_solid?,
            blocking: self.blocking_solid?,
            figure_of_merit: self.figure_of_merit_solid?,
            max_force: self.max_force_solid?,
            flags: self.flags.clone(),
            further: Vec::new(),
            reached: None,
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
pub(super) fn table(rows: &[Row]) -> String {
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
pub(super) fn summary(rows: &[Row], settings: &FidelitySettings) -> String {
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
