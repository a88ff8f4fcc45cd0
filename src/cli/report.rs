//! `report`: a run folder as figures, tables, and one page that opens from the disk.

use std::path::Path;

use anyhow::Context;

use super::certify::Row;
use super::run_file::RunFile;
use super::run_folder::{HistoryRow, Record, RunFolder, outcome_counts};
use super::{say, warn};
use crate::evolve::{Breeding, Crossover, Mutation, Nsga2, Nsga2Settings, Survival};
use crate::fitness::{FurtherObjective, Sense};
use crate::io::{atomic, input};
use crate::mesh::ShellElement;
use crate::report::{FrontPoint, ReportPage, pdf, standing};
use crate::solve::Backend;

/// The figures of a run with what they show.
const FIGURES: [(&str, &str); 4] = [
    (
        "front",
        "Every evaluated design, and the front; right, the front in the axes of the literature.",
    ),
    (
        "merit",
        "Figure of merit times force, which stiffness does not change: what geometry alone sets.",
    ),
    ("history", "Hypervolume of the front, and the share of candidates that could be evaluated."),
    ("outcomes", "How candidates ended, or why they were rejected."),
];

/// The page.
const PAGE: &str = "report.html";

/// Draws the figures of the run in `path`, writes its page, and prints its front.
pub(super) fn run(path: &Path) -> anyhow::Result<()> {
    let folder = RunFolder::open(path)?;
    let (state, damaged) = folder.load()?;
    for line in damaged {
        warn(&format!("{line}; the checkpoint before it is used"));
    }
    let state = state
        .filter(|state| !state.history.is_empty())
        .with_context(|| format!("{}: no generation has been finished yet", path.display()))?;
    let search = Nsga2::resume(state.search)?;
    let records = folder.records(search.generation())?;
    say(&folder.write_results(&search, &state.history, &records)?);
    let mut written: Vec<&str> = vec!["front.csv", "history.csv", "outcomes.csv"];
    let mut figures = Vec::new();
    for (name, caption) in FIGURES {
        let svg = input::text(&folder.file(&format!("{name}.svg")), input::DATA)?;
        atomic::write(&folder.file(&format!("{name}.pdf")), &pdf(&svg))?;
        figures.push((caption, svg));
    }
    let page = page(&folder, &search, &state.history, &records, &figures)?;
    atomic::write(&folder.file(PAGE), page.as_bytes())?;
    written.push(PAGE);
    for name in written {
        say(&folder.file(name).display().to_string());
    }
    for (name, _) in FIGURES {
        say(&format!("{}, .png, .pdf", folder.file(&format!("{name}.svg")).display()));
    }
    Ok(())
}

fn page(
    folder: &RunFolder,
    search: &Nsga2,
    history: &[HistoryRow],
    records: &[Record],
    figures: &[(&str, String)],
) -> anyhow::Result<String> {
    let run = folder.run_file()?;
    let front = folder.front(search, records)?;
    let solids = folder.solid_front()?;
    let solids: Vec<FrontPoint> = solids.iter().filter_map(Row::front_point).collect();
    let name = folder.path().canonicalize()?;
    let name = name.file_name().unwrap_or_default().to_string_lossy();
    let read = |file: &str| input::text(&folder.file(file), input::SETTINGS).unwrap_or_default();
    let page = ReportPage {
        title: &format!("{name}: actuators by evolution"),
        summary: &summary(history, records, &front),
        methods: &methods(&run, &read("provenance.json")),
        front: &front,
        solids: &solids,
        outcomes: &outcome_counts(records),
        figures,
        files: &[("run.toml", read("run.toml")), ("provenance.json", read("provenance.json"))],
    };
    Ok(page.html())
}

fn summary(history: &[HistoryRow], records: &[Record], front: &[FrontPoint]) -> String {
    let seconds: f64 = records.iter().map(|record| record.cpu_seconds.total()).sum();
    let feasible: usize = history.iter().map(|row| row.feasible).sum();
    let best = |value: fn(&FrontPoint) -> f64| front.iter().map(value).fold(0.0, f64::max);
    let mut text = format!(
        "{} candidates in {} generations, {feasible} of which could be evaluated, took {:.2} core-hours. \
         The front has {} members, with F_c to {:.3} rad/(m J)^(1/p), F_bf to {:.4} N/kPa, \
         {:.2} deg/(kPa m), and forces to {:.2} N.",
        records.len(),
        history.len(),
        seconds / 3600.0,
        front.len(),
        best(|point| point.bending),
        best(|point| point.blocking),
        best(|point| point.figure_of_merit),
        best(|point| point.max_force),
    );
    if let Some(line) = standing(front) {
        text += &format!(" {line}.");
    }
    text
}

/// Every setting that decides the result, in words.
fn methods(run: &RunFile, provenance: &str) -> String {
    let told: serde_json::Value = serde_json::from_str(provenance).unwrap_or_default();
    let known = |key: &str| told[key].as_str().unwrap_or("unknown").to_owned();
    let material = toml::to_string(&run.material).unwrap_or_default();
    let material = material.trim().replace('\n', ", ").replace('"', "");
    let element = match run.wall.element {
        ShellElement::Loop => "Loop's subdivision surface",
        ShellElement::MidEdge => "flat triangles with mid-edge normals",
    };
    let [x, y, z] = run.design_box.sides().into();
    let normal = run.fitness.plane_normal.map(|n| n.to_string()).join(", ");
    let path = &run.load.path;
    let chords = match path.newton.chord_contraction {
        contraction if contraction > 0.0 && run.solver.backend == Backend::Native => {
            format!(" and keeps a tangent while the residual contracts by {contraction}")
        }
        _ => String::new(),
    };
    let backend = match run.solver.backend {
        Backend::Native => "native",
        Backend::Petsc => "PETSc's SNES with MUMPS",
    };
    format!(
        "Chambers are zero levels of a network of 22 genes in a box of {x} x {y} x {z} mm, meshed with edges of {} mm. \
         Walls of {} mm are Kirchhoff-Love shells on {element}, clamped below {} thicknesses, of {material}. \
         The chamber's pressure follows the wall and rises to {} MPa in {} samples; Newton's method stops at {:e} of the scale of \
         forces{chords}, steps are halved while work and stored energy differ by more than {:e}, and loss of stability is followed to the \
         next stable state. Bending is judged by the chord angle over the work to the power 1/{}, blocking by the force on a plane with the \
         normal ({normal}), {} mm from the wall at rest, over the pressure. {}{} \
         Computed by {} {} (commit {}, {}, PETSc {}, solver {}).",
        run.mesh.edge,
        run.wall.thickness,
        run.wall.clamp_height,
        run.load.pressure,
        path.steps,
        path.newton.tolerance,
        path.work_tolerance,
        run.fitness.exponent,
        run.fitness.plane_distance,
        further(&run.fitness.further_objectives),
        operators(&run.evolution),
        known("program"),
        known("version"),
        known("commit"),
        known("rustc"),
        known("petsc"),
        backend,
    )
}

/// What was asked besides bending and blocking, as a sentence.
fn further(objectives: &[FurtherObjective]) -> String {
    let one = |objective: &FurtherObjective| {
        let wanted = match objective.sense {
            Sense::Largest => "large",
            Sense::Least => "small",
        };
        format!("a {wanted} {} ({})", objective.name.replace('_', " "), objective.unit)
    };
    if objectives.is_empty() {
        return String::new();
    }
    let asked: Vec<String> = objectives.iter().map(one).collect();
    format!("Asked besides: {}. ", asked.join(", "))
}

/// How NSGA-II was run, in words.
fn operators(settings: &Nsga2Settings) -> String {
    let crossover = match settings.crossover {
        Crossover::Sbx => format!("simulated binary crossover (eta {})", settings.crossover_eta),
        Crossover::Intermediate => "intermediate crossover".to_owned(),
    };
    let mutation = match settings.mutation {
        Mutation::Polynomial => format!("polynomial mutation (eta {})", settings.mutation_eta),
        Mutation::AdaptiveFeasible => "adaptive feasible mutation".to_owned(),
    };
    let breeding = match settings.breeding {
        Breeding::CrossoverOrMutation => format!(
            "children of either {crossover} or {mutation}, the share of the latter {} and from generation {} on {}",
            settings.mutation_share_before,
            settings.switch_generation,
            settings.mutation_share_after
        ),
        Breeding::CrossoverThenMutation => format!("children of {crossover}, then {mutation}"),
    };
    let survival = match settings.survival {
        Survival::Elitist => "elitism".to_owned(),
        Survival::Controlled => {
            format!("controlled elitism (Pareto fraction {})", settings.pareto_fraction)
        }
    };
    format!(
        "NSGA-II had {} individuals in {} generations from seed {}, {breeding}, and {survival}.",
        settings.population, settings.generations, settings.seed
    )
}
