//! `verify shells`: textbook shells against their numbers, on finer and finer meshes.
//!
//! The error of a run is the largest distance between a watch and its reference over the tabulated loads, in % of the
//! largest reference value; the worst watch speaks for the run. The pointwise error is the largest `|u - ref| / |ref|`
//! of that watch, in %, over the loads whose `|ref|` is at least 5 % of the largest. The order is that of the error in
//! the mesh's width, which is taken as one over the square root of the unknowns.
//!
//! A case that is known to miss its reference says why and by how much at most, and is counted apart; a run that gave no
//! number is too far.

use std::path::Path;

use anyhow::{Context, bail, ensure};
use serde::Serialize;

use super::cases::{Case, case};
use super::deviations::{Compared, deviations, missed};
use super::files::{BuiltIn, SceneFolder};
use super::observer::Observer;
use crate::io::{OutputFolder, atomic, csv};
use crate::math::cpu_seconds;
use crate::mesh::ShellElement;
use crate::report::{
    ErrorCurve, ErrorPoint, JudgedError, OverviewRow, error_svg, overview_svg, png,
};
use crate::scene::Unobserved;
use crate::scene::checks::check_solver;
use crate::scene::shape::{Measured, Shape};
use crate::scene::verify_section::{Accepted, MeshSize};
use crate::solve::{Backend, Stop};

/// What to run.
pub struct Selection {
    /// Which cases there are.
    pub folder: &'static SceneFolder,
    /// All where empty.
    pub cases: Vec<String>,
    /// Both where none.
    pub element: Option<ShellElement>,
    /// Only the meshes on which an error is accepted.
    pub quick: bool,
    /// Which library solves.
    pub solver: Backend,
}

/// A row of `errors.csv`: one watch of one run.
#[derive(Clone, Debug, Serialize)]
struct Row {
    case: &'static str,
    element: &'static str,
    mesh: String,
    unknowns: usize,
    cpu_seconds: f64,
    newton_iterations: usize,
    watch: String,
    /// Share of the load at which the error is largest.
    #[serde(rename = "load_share")]
    load: f64,
    measured: f64,
    reference: f64,
    /// Of the largest reference value, %.
    error: f64,
    /// The largest of the watch, of the reference value at the same load, %.
    pointwise_error: f64,
    /// Of the run's worst watch, from the mesh before.
    order: Option<f64>,
    /// %, on the mesh where it counts.
    accepted: Option<f64>,
    verdict: &'static str,
    ending: &'static str,
}

/// Runs the selected cases, tells the lines of their table and writes their files into the new
/// folder `out`.
///
/// # Errors
/// When a case misses what is accepted of it.
pub fn run(
    selection: &Selection,
    out: Option<&Path>,
    observer: &dyn Observer,
) -> anyhow::Result<()> {
    check_solver(selection.solver)?;
    out.map(OutputFolder::check_new).transpose()?;
    let chosen = selection.folder.chosen(&selection.cases);
    let read = |name| case(selection.folder, name);
    let cases = chosen.into_iter().map(read).collect::<anyhow::Result<Vec<_>>>()?;
    let folder = out.map(OutputFolder::create_new).transpose()?;
    observer.line(&heading());
    let mut rows = Vec::new();
    for case in &cases {
        let curves = run_case(case, selection, &mut rows, observer)?;
        if let Some(folder) = &folder {
            // After every case, so that an interrupted run leaves what it has found.
            csv::write(&folder.file("errors.csv"), &rows)?;
            write_figure(folder, case.name, &error_svg(&case.title, &curves))?;
            write_figure(folder, "summary", &overview_svg(&overview(&rows)))?;
        }
    }
    let judged = |verdict: &str| {
        let mut runs: Vec<_> = rows
            .iter()
            .filter(|row| row.verdict == verdict)
            .map(|row| run_name(row.case, row.element))
            .collect();
        runs.dedup();
        runs
    };
    let (near, known, far) = (judged(OK), judged(KNOWN_MISS), judged(TOO_FAR));
    misses(&cases, &known).iter().for_each(|line| observer.line(line));
    observer.line(&format!(
        "{} within what is accepted, {} known to miss it, {} too far",
        near.len(),
        known.len(),
        far.len()
    ));
    ensure!(far.is_empty(), "too far from the reference: {}", far.join(", "));
    Ok(())
}

/// Why each of the `known` runs misses its reference.
fn misses(cases: &[Case], known: &[String]) -> Vec<String> {
    let of_case = |case: &Case| {
        let told = |accept: &Accepted| {
            let run = run_name(case.name, accept.element.name());
            let miss = accept.miss.as_ref().filter(|_| known.contains(&run))?;
            Some(format!("{run}: {}", miss.why))
        };
        case.verify.accept.iter().filter_map(told).collect::<Vec<_>>()
    };
    cases.iter().flat_map(of_case).collect()
}

fn run_name(case: &str, element: &str) -> String {
    format!("{case} with {element}")
}

/// The name of every case and what it is, a line each.
///
/// # Errors
/// When a file is no case.
pub fn list(folder: &SceneFolder) -> anyhow::Result<Vec<String>> {
    let line = |name| Ok(format!("{name:<31} {}", case(folder, name)?.title));
    folder.names().map(line).collect()
}

fn write_figure(folder: &OutputFolder, name: &str, svg: &str) -> anyhow::Result<()> {
    atomic::write(&folder.file(&format!("{name}.svg")), svg.as_bytes())?;
    Ok(atomic::write(&folder.file(&format!("{name}.png")), &png(svg, 2.0))?)
}

/// The judged error of every run: that of its worst watch, which comes first.
fn overview(rows: &[Row]) -> Vec<OverviewRow> {
    let mut overview: Vec<OverviewRow> = Vec::new();
    for row in rows {
        let Some(accepted) = row.accepted else { continue };
        if overview.last().is_none_or(|last| last.case != row.case) {
            overview.push(OverviewRow { case: row.case.to_owned(), errors: Vec::new() });
        }
        let errors = &mut overview.last_mut().expect("one was pushed").errors;
        if errors.iter().all(|judged| judged.element != row.element) {
            let element = row.element.to_owned();
            errors.push(JudgedError { element, error: row.error, accepted });
        }
    }
    overview
}

/// Runs one case with every element; adds its rows and returns its curves.
fn run_case(
    case: &Case,
    selection: &Selection,
    rows: &mut Vec<Row>,
    observer: &dyn Observer,
) -> anyhow::Result<Vec<ErrorCurve>> {
    let wanted = |element| selection.element.is_none_or(|only| only == element);
    let mut curves = Vec::new();
    for accept in case.verify.accept.iter().filter(|accept| wanted(accept.element)) {
        let mut runs: Vec<ErrorPoint> = Vec::new();
        for &mesh in &case.verify.meshes {
            let counts = accept.concerns(accept.element, mesh);
            if selection.quick && !counts {
                continue;
            }
            let measured = measure(case, accept.element, mesh, selection.solver, observer);
            let (measured, mut deviations) = match measured {
                Ok(measured) => {
                    let deviations = deviations(&case.scene, &case.verify, &measured);
                    (Some(measured), deviations)
                }
                Err(error) => (None, vec![missed("", 0.0, f64::NAN, format!("{error:#}"))]),
            };
            deviations.sort_by(|a, b| b.deviation.error.total_cmp(&a.deviation.error));
            let worst = deviations.first().context("[verify] compares nothing")?;
            let run = ErrorPoint {
                cpu_seconds: measured.as_ref().map_or(0.0, |m| m.cpu_seconds),
                unknowns: measured.as_ref().map_or(0, |m| m.unknowns),
                error: worst.deviation.error,
            };
            let order = runs.last().and_then(|before| order(before, &run));
            let accepted = counts.then_some(accept.error);
            let verdict = if counts { verdict(accept, run.error) } else { "" };
            let common = |compared: &Compared| Row {
                case: case.name,
                element: accept.element.name(),
                mesh: mesh.to_string(),
                unknowns: run.unknowns,
                cpu_seconds: run.cpu_seconds,
                newton_iterations: measured.as_ref().map_or(0, iterations),
                watch: compared.watch.clone(),
                load: compared.deviation.load,
                measured: compared.deviation.measured,
                reference: compared.deviation.reference,
                error: compared.deviation.error,
                pointwise_error: compared.deviation.pointwise_error,
                order,
                accepted,
                verdict,
                ending: measured.as_ref().map_or("failed", |m| m.walked.ending.name()),
            };
            observer.line(&line(&common(worst), worst.remark.as_deref()));
            rows.extend(deviations.iter().map(common));
            runs.push(run);
        }
        let accepted = Some(accept.error);
        curves.push(ErrorCurve { element: accept.element.name().to_owned(), runs, accepted });
    }
    Ok(curves)
}

fn measure(
    case: &Case,
    element: ShellElement,
    mesh: MeshSize,
    solver: Backend,
    observer: &dyn Observer,
) -> anyhow::Result<Measured> {
    let mut scene = case.scene.with_mesh(mesh)?;
    scene.wall.element = Some(element);
    let start = cpu_seconds();
    let source = scene.part.source(Path::new("verify/shells/case.toml"), &BuiltIn)?;
    let mut shape = Shape::new(&scene, &source, observer)?;
    let measured = shape.measure(&scene, solver, start, Stop::NEVER, &Unobserved)?;
    if measured.walked.points.is_empty() {
        bail!("not stable at rest: {}", measured.walked.ending.name().replace('_', " "));
    }
    Ok(measured)
}

fn verdict(accept: &Accepted, error: f64) -> &'static str {
    match &accept.miss {
        _ if error <= accept.error => OK,
        Some(miss) if error <= miss.up_to => KNOWN_MISS,
        _ => TOO_FAR,
    }
}

/// `e ~ h^order`, `h ~ unknowns^(-1/2)`.
fn order(coarse: &ErrorPoint, fine: &ErrorPoint) -> Option<f64> {
    let order = 2.0 * (coarse.error / fine.error).ln()
        / (fine.unknowns as f64 / coarse.unknowns as f64).ln();
    order.is_finite().then_some(order)
}

fn iterations(measured: &Measured) -> usize {
    measured.walked.counts.newton_iterations
}

const OK: &str = "ok";
const KNOWN_MISS: &str = "known miss";
const TOO_FAR: &str = "too far";

fn heading() -> String {
    format!(
        "{:<31} {:<8} {:>7} {:>6} {:>5} {:>6} {:>8} {:>8} {:>5} {:>6} {:>5} {:>3} verdict",
        "case",
        "element",
        "mesh",
        "dofs",
        "CPU s",
        "worst",
        "measured",
        "wanted",
        "err%",
        "point%",
        "order",
        "max",
    )
}

fn line(row: &Row, remark: Option<&str>) -> String {
    let number = |x: f64| match format!("{x:.3e}") {
        _ if !x.is_finite() => "-".to_owned(),
        fits if fits.len() <= 8 => fits,
        _ => format!("{x:.2e}"),
    };
    let seconds = row.cpu_seconds;
    let seconds = format!("{seconds:.*}", if seconds < 100.0 { 2 } else { 0 });
    let order = row.order.map_or_else(|| "-".to_owned(), |order| format!("{order:.1}"));
    let accepted = row.accepted.map_or_else(String::new, |accepted| accepted.to_string());
    let percent = |error: f64| match error {
        error if error < 10.0 => format!("{error:.3}"),
        error if error < 100.0 => format!("{error:.2}"),
        error if error.is_finite() => format!("{error:.0}"),
        _ => "-".to_owned(),
    };
    format!(
        "{:<31} {:<8} {:>7} {:>6} {seconds:>5} {:>6} {:>8} {:>8} {:>5} {:>6} {order:>5} {accepted:>3} {}{}",
        row.case,
        row.element,
        row.mesh,
        row.unknowns,
        row.watch,
        number(row.measured),
        number(row.reference),
        percent(row.error),
        percent(row.pointwise_error),
        row.verdict,
        remark.map_or_else(String::new, |remark| format!(" ({remark})"))
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::verify_section::KnownMiss;

    #[test]
    fn order_is_that_of_the_mesh_width() {
        let run = |unknowns, error| ErrorPoint { cpu_seconds: 1.0, unknowns, error };
        // Four times the unknowns, half the width, an eighth of the error.
        assert!((order(&run(300, 8.0), &run(1200, 1.0)).unwrap() - 3.0).abs() < 1e-12);
        assert_eq!(order(&run(300, f64::INFINITY), &run(1200, 1.0)), None);
        assert_eq!(order(&run(300, 8.0), &run(300, 1.0)), None);
    }

    #[test]
    fn a_known_miss_is_a_number_too_far_with_a_reason() {
        let mut accept = Accepted {
            element: ShellElement::Loop,
            mesh: MeshSize::Cells([8, 8]),
            error: 2.0,
            miss: Some(KnownMiss { up_to: 5.0, why: "the table is coarse".to_owned() }),
        };
        let verdicts =
            |accept: &Accepted| [2.0, 2.1, 5.1, f64::INFINITY].map(|e| verdict(accept, e));
        assert_eq!(verdicts(&accept), [OK, KNOWN_MISS, TOO_FAR, TOO_FAR]);
        accept.miss = None;
        assert_eq!(verdicts(&accept), [OK, TOO_FAR, TOO_FAR, TOO_FAR]);
    }

    #[test]
    fn columns_stand_below_their_heads() {
        let row = Row {
            case: "twisted_beam_thick_out_of_plane",
            element: "mid-edge",
            mesh: "16x16".to_owned(),
            unknowns: 12_675,
            cpu_seconds: 1.234,
            newton_iterations: 0,
            watch: "w".to_owned(),
            load: 1.0,
            measured: -0.3006,
            reference: 0.3006,
            error: 0.166,
            pointwise_error: 12.345,
            order: Some(2.01),
            accepted: Some(1.5),
            verdict: KNOWN_MISS,
            ending: "reached",
        };
        let (head, line) = (heading(), line(&row, None));
        for (name, cell) in [
            ("CPU s", "1.23"),
            ("err%", "0.166"),
            ("point%", "12.35"),
            ("order", "2.0"),
            ("max", "1.5"),
        ] {
            let end = |text: &str, part: &str| text.find(part).unwrap() + part.len();
            assert_eq!(end(&head, name), end(&line, cell), "{name}");
        }
        assert_eq!(head.find("verdict"), line.find(KNOWN_MISS));
        // A terminal's width.
        assert!(line.len() <= 120, "{line}");
    }
}
