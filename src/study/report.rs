//! `report`: a run folder as figures, tables, and one page that opens from the disk.

use std::path::Path;

use anyhow::Context;

use super::certificate_row::Row;
use super::design_pictures::{self, Pictured, PicturedPath, StoredPath};
use super::history_row::HistoryRow;
use super::inherited::Nsga2;
use super::observer::Observer;
use super::run_file::RunFile;
use super::run_folder::{Record, RunFolder, outcome_counts};
use crate::evolve::{Breeding, Nsga2Settings, Survival};
use crate::fitness::{Asked, FitnessSettings, OBJECTIVES, Objective, Sense, objective};
use crate::genome::{Crossover, Mutation};
use crate::io::{atomic, input};
use crate::math::Vec3;
use crate::mesh::ShellElement;
use crate::report::{FrontPoint, ReportPage, curves_svg, pdf, standing};
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

/// What of a run was drawn and written.
pub(crate) struct Reported {
    /// The front, for a person.
    pub table: String,
    /// What was written, a line each.
    pub written: Vec<String>,
}

/// Draws the figures of the run in `path`, and writes its tables and its page.
///
/// # Errors
/// When the folder is refused or damaged, has no generation yet, or cannot be written.
pub(crate) fn report(path: &Path, observer: &dyn Observer) -> anyhow::Result<Reported> {
    let folder = RunFolder::open(path)?;
    let (state, damaged) = folder.load()?;
    for line in damaged {
        observer.warning(&format!("{line}; the checkpoint before it is used"));
    }
    let state = state
        .filter(|state| !state.history.is_empty())
        .with_context(|| format!("{}: no generation has been finished yet", path.display()))?;
    let search = Nsga2::resume(state.search)?;
    let records = folder.records(search.generation())?;
    folder.write_results(&search, &state.history, &records)?;
    let table = folder.table(&search, &records)?;
    let mut figures = Vec::new();
    for (name, caption) in FIGURES {
        let svg = input::text(&folder.file(&format!("{name}.svg")), input::DATA)?;
        atomic::write(&folder.file(&format!("{name}.pdf")), &pdf(&svg))?;
        figures.push((caption, svg));
    }
    let (designs, curves) = designs(&folder, &search, &records)?;
    if let Some(curves) = curves {
        figures.push(("Some designs of the front over the pressure.", curves));
    }
    let page = page(&folder, &search, &state.history, &records, &figures, &designs)?;
    atomic::write(&folder.file(PAGE), page.as_bytes())?;
    let files = ["front.csv", "history.csv", "outcomes.csv", PAGE]
        .map(|name| folder.file(name).display().to_string());
    let drawn = FIGURES
        .map(|(name, _)| format!("{}, .png, .pdf", folder.file(&format!("{name}.svg")).display()));
    Ok(Reported { table, written: files.into_iter().chain(drawn).collect() })
}

/// A design's name with its numbers, and its picture (PNG).
type DesignPicture = (String, Vec<u8>);

/// How many designs are shown.
const SHOWN: usize = 5;

/// Names and pictures of designs along the front, and the figure of their curves; none of a run that has written no designs yet.
fn designs(
    folder: &RunFolder,
    search: &Nsga2,
    records: &[Record],
) -> anyhow::Result<(Vec<DesignPicture>, Option<String>)> {
    let mut front = folder.front(search, records)?;
    let by_first = |a: &FrontPoint, b: &FrontPoint| {
        let [a, b] = [a, b].map(|point| OBJECTIVES[0].minimized(point.objectives[0].value));
        a.total_cmp(&b)
    };
    front.sort_by(by_first);
    let run = folder.run_file()?;
    let scenarios = run.fitness.scenarios();
    front.retain(|point| {
        let design = folder.design(&point.id);
        let has = |stem: String| design.join(format!("{stem}.csv")).exists();
        scenarios.iter().all(|scenario| has(scenario.file_stem("")))
    });
    let count = front.len().min(SHOWN);
    let places =
        (0..count).map(|k| if count > 1 { k * (front.len() - 1) / (count - 1) } else { 0 });
    let (mut pictures, mut curves) = (Vec::new(), Vec::new());
    for point in places.map(|k| &front[k]) {
        let design = folder.design(&point.id);
        let paths = PicturedPath::stored(&run, |name| StoredPath::read_ends(&design, name))?;
        let direction = Vec3::from(run.fitness.plane_normal);
        let pictured = Pictured { paths, direction };
        let angle = point.reached.as_ref().map_or(0.0, |reached| reached.angle_deg);
        let mut name = format!("{}: {angle:.1} deg, {:.2} N", point.id, point.max_force);
        for (one, value) in objectives(point) {
            let digits = one.decimals - 1;
            name += &format!(", {} {value:.digits$}{}", one.title(), one.told_unit());
        }
        pictures.push((name, pictured.still().png()));
        curves.push(design_pictures::curves(&design, &point.id)?);
    }
    let figure = (!curves.is_empty()).then(|| curves_svg(&curves));
    Ok((pictures, figure))
}

fn page(
    folder: &RunFolder,
    search: &Nsga2,
    history: &[HistoryRow],
    records: &[Record],
    figures: &[(&str, String)],
    designs: &[DesignPicture],
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
        designs,
        files: &[("run.toml", read("run.toml")), ("provenance.json", read("provenance.json"))],
    };
    Ok(page.html())
}

fn summary(history: &[HistoryRow], records: &[Record], front: &[FrontPoint]) -> String {
    let seconds: f64 = records.iter().map(|record| record.cpu_seconds.total()).sum();
    let feasible: usize = history.iter().map(|row| row.feasible).sum();
    let mut text = format!(
        "{} candidates in {} generations, {feasible} of which could be evaluated, took {:.2} core-hours. ",
        records.len(),
        history.len(),
        seconds / 3600.0,
    );
    if front.is_empty() {
        let causes = outcome_counts(records);
        let most = causes.first().map_or(String::new(), |cause| {
            format!(": {} of them ended as {}", cause.candidates, cause.outcome)
        });
        return text + &format!("No design has objectives{most}.");
    }
    let best = |value: fn(&FrontPoint) -> f64| front.iter().map(value).fold(0.0, f64::max);
    let angle = |point: &FrontPoint| point.reached.as_ref().map_or(0.0, |r| r.angle_deg);
    text += &format!(
        "The front has {} members, with angles to {:.1} deg, forces to {:.2} N, ",
        front.len(),
        best(angle),
        best(|point| point.max_force),
    );
    for one in OBJECTIVES {
        let of_point = |point: &FrontPoint| {
            let found = objectives(point).find(|(objective, _)| *objective == one);
            found.map(|(_, value)| one.minimized(value))
        };
        let values: Vec<f64> = front.iter().filter_map(of_point).collect();
        if !values.is_empty() {
            let (best, digits) = (one.best_of(values.into_iter()), one.decimals - 1);
            text += &format!("{} to {best:.digits$} {}, ", one.title(), one.unit);
        }
    }
    text += &format!("and {:.2} deg/(kPa m).", best(|point| point.figure_of_merit));
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
    let element = match run.wall.element.unwrap_or_default() {
        ShellElement::Loop => "Loop's subdivision surface",
        ShellElement::MidEdge => "flat triangles with mid-edge normals",
    };
    let [x, y, z] = run.design_box.sides().into();
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
         The chamber's pressure follows the wall and rises to {} in {} samples; Newton's method stops at {:e} of the scale of \
         forces{chords}, steps are halved while work and stored energy differ by more than {:e}, and loss of stability is followed to the \
         next stable state. {}{} \
         Computed by {} {} (commit {}, {}, PETSc {}, solver {}).",
        run.mesh.edge,
        run.wall.thickness,
        run.wall.clamp_height,
        pressure_in_words(run),
        path.steps,
        path.newton.tolerance,
        path.work_tolerance,
        asked(&run.fitness),
        operators(&run.evolution),
        known("program"),
        known("version"),
        known("commit"),
        known("rustc"),
        known("petsc"),
        backend,
    )
}

/// To what the pressure rises.
fn pressure_in_words(run: &RunFile) -> String {
    let largest = run.load.pressure;
    let limits = run.limits.as_ref().map(|limits| toml::to_string(limits).unwrap_or_default());
    let limits = limits.map(|text| match text.trim().replace('\n', ", ") {
        text if text.is_empty() => "that of the preset".to_owned(),
        text => text,
    });
    match (run.load.rated, limits) {
        (Some(rated), Some(limits)) => format!(
            "that at which the material is at its limit ({limits}), the rated pressure, at which each design is judged (at most {largest} MPa; besides, each is told at {} MPa if it comes to that),",
            rated.reference
        ),
        (None, Some(limits)) => {
            format!("{largest} MPa, or to where the material is at its limit ({limits}),")
        }
        (_, None) => format!("{largest} MPa"),
    }
}

/// The objectives of a design with their values.
fn objectives(point: &FrontPoint) -> impl Iterator<Item = (&'static Objective, f64)> {
    point.objectives.iter().filter_map(|column| Some((objective(column.name)?, column.value)))
}

/// By what designs are judged, in sentences.
fn asked(settings: &FitnessSettings) -> String {
    let of = |asked: Asked| settings.objectives().filter(move |one| one.asked == asked);
    let judged = |(k, one): (usize, &Objective)| {
        let is = if k == 0 { " is judged" } else { "" };
        format!("{}{is} by {}", one.words(), (one.judged_by)(settings))
    };
    let judged: Vec<String> = of(Asked::Always).enumerate().map(judged).collect();
    let mut text = format!("{}. ", judged.join(", "));
    text[..1].make_ascii_uppercase();
    let besides = |one: &Objective| {
        let wanted = match one.sense {
            Sense::Largest => "large",
            Sense::Least => "small",
        };
        format!("a {wanted} {} ({})", one.words(), one.unit)
    };
    let besides: Vec<String> = of(Asked::ByName).map(besides).collect();
    if !besides.is_empty() {
        text += &format!("Asked besides: {}. ", besides.join(", "));
    }
    text
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
