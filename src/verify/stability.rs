//! `verify stability`: scenes on which solvers come to grief, each on every solver, against the endings that physics allows.
//!
//! A run fails when its path has an ending that the case does not allow, when a number is not finite, when it panics,
//! when a watch misses its reference, and when the solvers differ: in the ending, in the load reached, or in a watch at a
//! load where both have a state, by more than the case allows as a share of the watch's largest value. So does a case that differs
//! from another in its units alone, where its states are others. Iterations are told, and decide nothing: the last bit may make one more.

use std::fmt::Write as _;
use std::path::Path;
use std::rc::Rc;
use std::time::Instant;

use anyhow::ensure;
use serde::Serialize;

use super::deviations::deviations;
use super::files::BuiltIn;
use super::observer::Observer;
use super::stability_case::{FOLDER, REFUSED, REJECTED, StabilityCase, Variant, case};
use crate::batch::{Executor, Next, Serial};
use crate::io::{OutputFolder, csv};
use crate::math::cpu_seconds;
use crate::scene::checks::check_solver;
use crate::scene::scene_file::SceneFile;
use crate::scene::shape::{Measured, Shape};
use crate::scene::verify_section::SameAs;
use crate::scene::watch_curve::WatchCurve;
use crate::scene::{self, Unobserved};
use crate::solve::{Backend, Programme, Stop, Supply};

/// What to run.
pub struct Selection {
    /// All where empty.
    pub cases: Vec<String>,
    /// All that are built in where none.
    pub solver: Option<Backend>,
    /// Only the cases that take a few seconds.
    pub quick: bool,
}

/// Cases that take longer are left out of a quick run, s.
const QUICK: f64 = 5.0;

/// A row of `stability.csv`: one run.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct Row {
    case: &'static str,
    solver: &'static str,
    element: &'static str,
    mesh: String,
    /// Endings that are right, with a bar between them.
    expected: String,
    ending: String,
    /// Share of the programme at the last state.
    #[serde(rename = "load_share")]
    load: f64,
    snaps: usize,
    newton_iterations: usize,
    /// Steps given up.
    step_cuts: usize,
    unknowns: usize,
    cpu_seconds: f64,
    wall_seconds: f64,
    /// Largest distance of a watch from its reference, % of the largest reference value.
    error: Option<f64>,
    accepted: Option<f64>,
    /// Largest distance from the first solver's run, or from the case that this one should be, as a share of the watch's largest value.
    disagreement: Option<f64>,
    verdict: &'static str,
    /// What is wrong, or what was said.
    remark: String,
}

/// What came of one run.
struct Ran {
    ending: String,
    /// What was said where there is no path.
    message: Option<String>,
    /// Share of the programme.
    reached: f64,
    measured: Option<Measured>,
    wall_seconds: f64,
}

/// Runs the selected cases, tells the lines of their table and writes it into the new folder `out`.
///
/// # Errors
/// When a run fails.
pub fn run(
    selection: &Selection,
    out: Option<&Path>,
    observer: &dyn Observer,
) -> anyhow::Result<()> {
    let solvers = match selection.solver {
        Some(solver) => vec![solver],
        None => [Backend::Native, Backend::Petsc].into_iter().filter(|s| s.is_built_in()).collect(),
    };
    solvers.iter().try_for_each(|&solver| check_solver(solver))?;
    out.map(OutputFolder::check_new).transpose()?;
    let chosen = FOLDER.chosen(&selection.cases);
    let cases = chosen.into_iter().map(case).collect::<anyhow::Result<Vec<_>>>()?;
    let folder = out.map(OutputFolder::create_new).transpose()?;
    observer.line(&heading());
    let is_short = |case: &StabilityCase| case.verify.seconds.is_none_or(|s| s <= QUICK);
    let (mut rows, mut done) = (Vec::new(), Vec::new());
    for case in cases.iter().filter(|case| !selection.quick || is_short(case)) {
        for variant in case.variants() {
            run_variant(case, variant, &solvers, (&mut rows, &mut done), observer)?;
            if let Some(folder) = &folder {
                // After every run, so that an interrupted one leaves what it has found.
                csv::write(&folder.file("stability.csv"), &rows)?;
            }
        }
    }
    let mut failed: Vec<&str> =
        rows.iter().filter(|row| row.verdict == FAILED).map(|row| row.case).collect();
    let bad = failed.len();
    observer.line(&format!("{} of {} runs as expected", rows.len() - bad, rows.len()));
    failed.dedup();
    ensure!(failed.is_empty(), "{bad} runs failed: {}", failed.join(", "));
    Ok(())
}

/// The name of every case and what it is, a line each.
///
/// # Errors
/// When a file is no case.
pub fn list() -> anyhow::Result<Vec<String>> {
    FOLDER.names().map(|name| Ok(format!("{name:<31} {}", case(name)?.title))).collect()
}

/// What came of a case on a solver.
type Done = (&'static str, Backend, Rc<Ran>);

/// Runs one variant of a case on every solver, tells and adds its rows.
fn run_variant(
    case: &StabilityCase,
    variant: Variant,
    solvers: &[Backend],
    (rows, done): (&mut Vec<Row>, &mut Vec<Done>),
    observer: &dyn Observer,
) -> anyhow::Result<()> {
    let first = rows.len();
    let mut model: Option<Rc<Ran>> = None;
    for &solver in solvers {
        let ran = guarded(&|| ran(case, variant, solver, observer));
        let mut row = judged(case, variant, solver, &ran);
        if let Some(model) = &model {
            compare_solvers(case, model, &ran, &mut row);
        }
        compare_units(case, done, solver, &ran, &mut row);
        observer.line(&line(&row));
        rows.push(row);
        let ran = Rc::new(ran);
        done.push((case.name, solver, Rc::clone(&ran)));
        model.get_or_insert(ran);
    }
    ensure!(rows.len() > first, "no solver is built in");
    Ok(())
}

/// The run, a panic caught.
fn guarded(run: &(dyn Fn() -> Ran + Sync)) -> Ran {
    let start = Instant::now();
    let mut outcomes = Serial
        .evaluate(&[()], &|()| run(), &mut |_, _| Next::Continue)
        .expect("its observer stops nothing");
    let ran = outcomes.pop().expect("one item has one outcome").unwrap_or_else(|panicked| Ran {
        ending: "panicked".to_owned(),
        message: Some(panicked.message),
        reached: 0.0,
        measured: None,
        wall_seconds: 0.0,
    });
    Ran { wall_seconds: start.elapsed().as_secs_f64(), ..ran }
}

fn ran(
    case: &StabilityCase,
    variant: Variant,
    solver: Backend,
    observer: &dyn scene::Observer,
) -> Ran {
    let without_path = |ending: &str, message: String| Ran {
        ending: ending.to_owned(),
        message: Some(message),
        reached: 0.0,
        measured: None,
        wall_seconds: 0.0,
    };
    let scene = match &case.scene {
        Ok(scene) => variant.mesh.map_or_else(|| Ok(scene.clone()), |mesh| scene.with_mesh(mesh)),
        Err(message) => return without_path(REFUSED, message.clone()),
    };
    let start = cpu_seconds();
    let made = scene.and_then(|mut scene| {
        scene.wall.element = Some(variant.element);
        let source = scene.part.source(Path::new(&case.file), &BuiltIn)?;
        let shape = Shape::new(&scene, &source, observer)?;
        drop(source);
        Ok((scene, shape))
    });
    let (scene, mut shape) = match made {
        Ok(made) => made,
        Err(error) => return without_path(REJECTED, format!("{error:#}")),
    };
    match shape.measure(&scene, solver, start, Stop::NEVER, &Unobserved) {
        Ok(mut measured) => Ran {
            ending: measured.walked.ending.name().to_owned(),
            message: None,
            reached: progress(&scene, &mut measured),
            measured: Some(measured),
            wall_seconds: 0.0,
        },
        Err(error) => without_path("broken", format!("{error:#}")),
    }
}

/// Share of the programme up to which a path was walked, and its curves over that share where a pressure is not what is
/// driven.
fn progress(scene: &SceneFile, measured: &mut Measured) -> f64 {
    let points = &measured.walked.points;
    let (Some(first), Some(last)) = (points.first(), points.last()) else { return 0.0 };
    let programme = scene.programme(first.conjugate).expect("its path was walked");
    let (start, end) = match programme {
        Programme::Driven { supply: Supply::Load, end } | Programme::Curve { end } => {
            return last.load / end;
        }
        Programme::Driven { end, .. } => (first.drive, end),
    };
    let share = |drive: f64| (drive - start) / (end - start);
    let largest = scene.load_settings().pressure;
    for curve in &mut measured.curves {
        for (shown, point) in curve.points.iter_mut().zip(points) {
            shown.load = share(point.drive);
            shown.rate *= (end - start) / largest;
        }
    }
    share(last.drive)
}

/// The row of a run on its own.
fn judged(case: &StabilityCase, variant: Variant, solver: Backend, ran: &Ran) -> Row {
    let verify = &case.verify;
    let mut row = Row {
        case: case.name,
        solver: solver_name(solver),
        element: variant.element.name(),
        mesh: variant.mesh.map_or_else(String::new, |mesh| mesh.to_string()),
        expected: verify.endings.join("|"),
        ending: ran.ending.clone(),
        load: 0.0,
        snaps: 0,
        newton_iterations: 0,
        step_cuts: 0,
        unknowns: 0,
        cpu_seconds: 0.0,
        wall_seconds: ran.wall_seconds,
        error: None,
        accepted: variant.error.filter(|_| !verify.reference.is_empty()),
        disagreement: None,
        verdict: OK,
        remark: String::new(),
    };
    let is_allowed = verify.endings.contains(&row.ending);
    if let Some(message) = &ran.message {
        let is_said = verify.says.as_ref().is_none_or(|words| message.contains(words));
        row.note(is_allowed && is_said, message.clone());
        return row;
    }
    if !is_allowed {
        row.note(false, format!("{}, not {}", row.ending, row.expected.replace('|', " or ")));
    }
    let (Ok(scene), Some(measured)) = (&case.scene, &ran.measured) else { return row };
    let points = &measured.walked.points;
    row.load = ran.reached;
    row.snaps = measured.walked.snaps().count();
    row.newton_iterations = measured.walked.counts.newton_iterations;
    row.step_cuts = points.iter().map(|point| point.cuts).sum();
    row.unknowns = measured.unknowns;
    row.cpu_seconds = measured.cpu_seconds;
    if let Some(what) = not_finite(measured) {
        row.note(false, what);
    }
    if let Some([least, most]) = verify.snaps.filter(|[l, m]| !(*l..=*m).contains(&row.snaps)) {
        row.note(false, format!("{} snaps, not {least} to {most}", row.snaps));
    }
    if let Some([least, most]) = verify.ends_between.filter(|[l, m]| !(*l..=*m).contains(&row.load))
    {
        row.note(false, format!("it ends at load {:.4}, not {least} to {most}", row.load));
    }
    let compared = deviations(scene, verify, measured);
    let worst = compared
        .iter()
        .max_by(|a, b| a.deviation.error.total_cmp(&b.deviation.error))
        .zip(variant.error);
    if let Some((worst, accepted)) = worst {
        row.error = Some(worst.deviation.error);
        // Also where it is no number.
        if worst.deviation.error.partial_cmp(&accepted).is_none_or(|order| order.is_gt()) {
            let why = worst.remark.clone().unwrap_or_else(|| {
                let deviation = &worst.deviation;
                format!(
                    "{} is {:.5e}, not {:.5e}, at load {}",
                    worst.watch, deviation.measured, deviation.reference, deviation.load
                )
            });
            row.note(false, why);
        }
    }
    row
}

impl Row {
    /// Adds to the remark; what is not fine makes the run fail.
    fn note(&mut self, is_fine: bool, remark: String) {
        if !is_fine {
            self.verdict = FAILED;
        }
        let separator = if self.remark.is_empty() { "" } else { "; " };
        self.remark = format!("{}{separator}{}", self.remark, remark.replace('\n', " "));
    }
}

/// The first number of a path or a watch that is none.
fn not_finite(measured: &Measured) -> Option<String> {
    for (k, point) in measured.walked.points.iter().enumerate() {
        let scalars = [
            point.drive,
            point.load,
            point.conjugate,
            point.work,
            point.stored_energy,
            point.dissipated,
            point.load_rate,
            point.conjugate_rate,
        ];
        if !scalars.iter().chain(&point.x).chain(&point.rate).all(|x| x.is_finite()) {
            return Some(format!("state {k} holds a number that is not finite"));
        }
    }
    let is_finite =
        |curve: &WatchCurve| curve.points.iter().all(|p| p.load.is_finite() && p.value.is_finite());
    let watch = measured.curves.iter().position(|curve| !is_finite(curve))?;
    Some(format!("watch {watch} is not finite"))
}

/// Notes where a run differs from the first solver's.
fn compare_solvers(case: &StabilityCase, model: &Ran, ran: &Ran, row: &mut Row) {
    if model.ending != ran.ending {
        row.note(false, format!("the other solver ends as {}", model.ending));
    }
    let (Some(a), Some(b)) = (&model.measured, &ran.measured) else { return };
    let (difference, what) = disagreement(a, b, [model.reached, ran.reached], 1.0);
    row.disagreement = Some(difference);
    if difference.partial_cmp(&case.verify.agreement).is_none_or(|order| order.is_gt()) {
        row.note(false, format!("the solvers differ by {difference:.1e} in {what}"));
    }
}

/// Notes where a run differs from that of the case which it should be in other units, if that was run.
fn compare_units(case: &StabilityCase, done: &[Done], solver: Backend, ran: &Ran, row: &mut Row) {
    let Some(SameAs { case: name, factor }) = &case.verify.same_as else { return };
    let same = |(other, by, _): &&Done| other == name && *by == solver;
    let Some((_, _, model)) = done.iter().find(same) else { return };
    if model.ending != ran.ending {
        row.note(false, format!("{name} ends as {}", model.ending));
    }
    let (Some(a), Some(b)) = (&model.measured, &ran.measured) else { return };
    let (difference, what) = disagreement(a, b, [model.reached, ran.reached], *factor);
    row.disagreement = Some(row.disagreement.map_or(difference, |other| other.max(difference)));
    if difference.partial_cmp(&case.verify.agreement).is_none_or(|order| order.is_gt()) {
        row.note(false, format!("it differs from {name} by {difference:.1e} in {what}"));
    }
}

/// The largest difference of two runs, and in what: the share of the load reached, or a watch at loads where both have a
/// state, as a share of its largest value; those of `a` are taken `factor` times.
fn disagreement(a: &Measured, b: &Measured, reached: [f64; 2], factor: f64) -> (f64, String) {
    let scale = reached[0].abs().max(reached[1].abs());
    let load = if scale > 0.0 { (reached[0] - reached[1]).abs() / scale } else { 0.0 };
    let mut worst = (load, "the load reached".to_owned());
    for (k, (a, b)) in a.curves.iter().zip(&b.curves).enumerate() {
        let largest = a.points.iter().fold(0.0_f64, |largest, p| largest.max(p.value.abs()));
        for p in &a.points {
            let same = b.points.iter().find(|q| (p.load - q.load).abs() <= 1e-9);
            let value = factor * p.value;
            let Some(q) = same.filter(|q| q.value != value) else { continue };
            let difference = (value - q.value).abs() / (factor * largest);
            if difference.partial_cmp(&worst.0).is_none_or(|order| order.is_gt()) {
                worst = (difference, format!("watch {} at load {:.4}", k + 1, p.load));
            }
        }
    }
    worst
}

const OK: &str = "ok";
const FAILED: &str = "failed";

fn solver_name(solver: Backend) -> &'static str {
    match solver {
        Backend::Native => "native",
        Backend::Petsc => "petsc",
    }
}

fn heading() -> String {
    format!(
        "{:<25} {:<6} {:<23} {:<21} {:>6} {:>5} {:>6} {:>4} {:>6} {:>6} verdict",
        "case", "solver", "expected", "found", "load", "snaps", "Newton", "cuts", "CPU s", "err%"
    )
}

fn line(row: &Row) -> String {
    let allowed = row.expected.split('|').count() - 1;
    let mut expected = row.expected.split('|').next().unwrap_or_default().to_owned();
    if allowed > 0 {
        // Writing to a text does not fail.
        let _ = write!(expected, "+{allowed}");
    }
    let error = row.error.map_or_else(|| "-".to_owned(), |error| format!("{error:.3}"));
    let remark = if row.remark.is_empty() { String::new() } else { format!(" ({})", row.remark) };
    format!(
        "{:<25} {:<6} {expected:<23} {:<21} {:>6.4} {:>5} {:>6} {:>4} {:>6.2} {error:>6} {}{remark}",
        row.case,
        row.solver,
        row.ending,
        row.load,
        row.snaps,
        row.newton_iterations,
        row.step_cuts,
        row.cpu_seconds,
        row.verdict,
    )
}

#[cfg(test)]
mod tests;
