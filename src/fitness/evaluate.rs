//! The two scenarios of Smith et al. (2022) on one part, a shell or a solid.
//!
//! Bending: clamped at the base, pressure rising, nothing in the way. Blocking: the same, with a rigid plane at a
//! distance from the outer wall. Until the part comes near the plane both are one path, which is walked once.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::exploit::{Exploit, exploits, flags};
use super::further::{FurtherObjective, Reading};
use super::objective::{bending, bending_samples, blocking, blocking_samples, figure_of_merit};
use super::observation::{Observation, observations};
use super::outcome::Unevaluated;
use crate::math::{Rejected, Room, Vec3};
use crate::mesh::ShellMesh;
use crate::model::contact::PlaneSettings;
use crate::model::material::Material;
use crate::model::system::System;
use crate::model::{DEFAULT_STRETCH_BOUND, PartModel, PartSetup, Support};
use crate::solve::{Backend, Ending, Path, PathPoint, PathSettings, SolveTimes, Stop, follow_from};

/// The loading programme.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct LoadSettings {
    /// Largest chamber pressure, MPa.
    pub pressure: f64,
    /// The stretch of the wall beyond which a path ends as ballooning.
    pub stretch_bound: f64,
    /// How the path is walked.
    pub path: PathSettings,
}

impl Default for LoadSettings {
    fn default() -> Self {
        Self { pressure: 0.2, stretch_bound: DEFAULT_STRETCH_BOUND, path: PathSettings::default() }
    }
}

impl LoadSettings {
    /// The setup of a part among `planes`, with the bound on its stretch.
    #[must_use]
    pub fn setup(&self, planes: Vec<PlaneSettings>) -> PartSetup {
        PartSetup { planes, stretch_bound: self.stretch_bound, ..PartSetup::default() }
    }
}

/// What the objectives ask.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct FitnessSettings {
    /// Exponent of the work in `F_c`.
    pub exponent: f64,
    /// Normal of the blocking plane, pointing towards the part.
    pub plane_normal: [f64; 3],
    /// Distance of the plane from the outermost point of the outer wall at rest, mm.
    pub plane_distance: f64,
    /// Whether a design with an [`Exploit`] is rejected instead of flagged.
    pub exclude_exploits: bool,
    /// What is asked besides bending and blocking.
    #[schemars(with = "Vec<String>")]
    pub further_objectives: Vec<FurtherObjective>,
}

impl Default for FitnessSettings {
    /// The plane 5 mm from the -x side, to which the published seed bends.
    fn default() -> Self {
        Self {
            exponent: 3.0,
            plane_normal: [1.0, 0.0, 0.0],
            plane_distance: 5.0,
            exclude_exploits: false,
            further_objectives: Vec::new(),
        }
    }
}

impl FitnessSettings {
    /// The plane that blocks a part under `pressure`, MPa.
    #[must_use]
    pub fn plane(&self, pressure: f64) -> PlaneSettings {
        let normal = Vec3::from(self.plane_normal).normalize();
        PlaneSettings::new(normal, self.plane_distance, pressure)
    }
}

/// The objectives of one design, and the figures beside them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Evaluation {
    /// `F_c`, rad / (m J)^(1/exponent).
    pub bending: f64,
    /// `F_bf`, N/kPa.
    pub blocking: f64,
    /// Tangent angle over pressure and length at the largest pressure, deg/(kPa m).
    pub figure_of_merit: f64,
    /// Largest force on the plane, N.
    pub max_force: f64,
    /// Chord angle at the largest pressure, degrees.
    pub angle_deg: f64,
    /// Share of the wall whose bending is softened because it folds tighter than its thickness allows.
    pub creased_share: f64,
    /// Unknowns of the model.
    pub unknowns: usize,
    /// Newton iterations of both scenarios.
    pub newton_iterations: usize,
    /// Losses of stability that both paths went over.
    pub snaps: usize,
    /// Why the bending path ended: the objectives are read off what it reached.
    pub bending_ending: Ending,
    /// Pressure of its last sample, MPa.
    pub bending_pressure: f64,
    /// Why the blocked path ended.
    pub blocking_ending: Ending,
    /// Pressure of its last sample, MPa.
    pub blocking_pressure: f64,
    /// Reasons to doubt the objectives.
    pub exploits: Vec<Exploit>,
    /// The further objectives by name, each in its unit.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub further: BTreeMap<String, f64>,
}

/// Both walked scenarios.
#[derive(Clone, Debug)]
pub struct Scenarios {
    /// The model, planes in place.
    pub model: PartModel,
    /// Bending freely.
    pub free: Path,
    /// Pressing on the plane; the free path where the part never comes near it.
    pub blocked: Path,
    /// Rows of the free path.
    pub free_rows: Vec<Observation>,
    /// Rows of the blocked path.
    pub blocked_rows: Vec<Observation>,
    /// CPU seconds of the solver.
    pub times: SolveTimes,
}

/// Walks both scenarios on `mesh`, until `stop` wants that to end.
///
/// # Errors
/// [`Unevaluated`] when a library fails, or it was stopped. A design that fails is the inner [`Rejected`].
pub fn evaluate(
    mesh: &ShellMesh,
    material: &Material,
    load: &LoadSettings,
    fitness: &FitnessSettings,
    backend: Backend,
    stop: Stop<'_>,
) -> Result<Result<(Evaluation, Scenarios), Rejected>, Unevaluated> {
    let setup = load.setup(vec![fitness.plane(load.pressure)]);
    match PartModel::new(mesh, material, &Support::Clamp, &setup) {
        Ok(model) => evaluate_model(mesh, model, load, fitness, backend, stop),
        Err(rejected) => Ok(Err(rejected)),
    }
}

/// Walks both scenarios of `model`, which shows the vertices of `mesh` and has the plane of `fitness` and the bound of `load`.
///
/// # Errors
/// As [`evaluate`].
pub fn evaluate_model(
    mesh: &ShellMesh,
    mut model: PartModel,
    load: &LoadSettings,
    fitness: &FitnessSettings,
    backend: Backend,
    stop: Stop<'_>,
) -> Result<Result<(Evaluation, Scenarios), Rejected>, Unevaluated> {
    let mut solver = backend.solver(model.pattern())?;
    model.lift_planes(true);
    let solver = solver.as_mut();
    let mut walked = |model: &mut PartModel, points, step| {
        let path = follow_from(model, &mut *solver, load.pressure, points, step, &load.path, stop)?;
        if path.ending == Ending::Interrupted { Err(Unevaluated::Stopped) } else { Ok(path) }
    };
    let free = walked(&mut model, Vec::new(), f64::INFINITY)?;
    if let Some(rejected) = cut_short(&free, load.pressure, "bending") {
        return Ok(Err(rejected));
    }
    let free_rows = observations(mesh, &model, &free.points);
    let touching = free.points.iter().position(|point| model.touches_plane(&point.x));
    model.lift_planes(false);
    let blocked = match touching {
        None => free.clone(),
        Some(first) => {
            let common = free.points[..first].to_vec();
            let onto_plane = |last: &PathPoint| free.points[first].drive - last.drive;
            let step = common.last().map_or(f64::INFINITY, |last| ONTO_PLANE * onto_plane(last));
            walked(&mut model, common, step)?
        }
    };
    if let Some(rejected) = cut_short(&blocked, load.pressure, "blocking") {
        return Ok(Err(rejected));
    }
    let blocked_rows = observations(mesh, &model, &blocked.points);
    let own_rows = free_rows.iter().chain(&blocked_rows[touching.unwrap_or(blocked_rows.len())..]);
    let exploits = exploits(
        &bending_samples(&free_rows, mesh.length, fitness.exponent),
        &blocking_samples(&blocked_rows),
        blocked_rows.first(),
        model.creased_share(),
    );
    if fitness.exclude_exploits && !exploits.is_empty() {
        return Ok(Err(excluded(&exploits)));
    }
    let reading = Reading { shell: mesh, free: &free_rows, blocked: &blocked_rows };
    let further = fitness.further_objectives.iter();
    let evaluation = Evaluation {
        bending: bending(&free_rows, mesh.length, fitness.exponent),
        blocking: blocking(&blocked_rows),
        figure_of_merit: figure_of_merit(&free_rows, mesh.length),
        max_force: blocked_rows.iter().map(|row| row.plane_force).fold(0.0, f64::max),
        angle_deg: free_rows.last().map_or(0.0, |row| row.angle_deg),
        creased_share: model.creased_share(),
        unknowns: model.unknowns(),
        newton_iterations: own_rows.clone().map(|row| row.newton_iterations).sum(),
        snaps: own_rows.filter(|row| row.stability == "snapped").count(),
        bending_ending: free.ending,
        bending_pressure: last_sample(&free_rows),
        blocking_ending: blocked.ending,
        blocking_pressure: last_sample(&blocked_rows),
        exploits,
        further: further.map(|one| (one.name.to_owned(), (one.value)(&reading))).collect(),
    };
    if let Some(rejected) = not_finite(&evaluation) {
        return Ok(Err(rejected));
    }
    let times = solver.times();
    Ok(Ok((evaluation, Scenarios { model, free, blocked, free_rows, blocked_rows, times })))
}

/// The first step towards the plane, as a share of that which went through it freely: the touch lies somewhere inside. Six evolved
/// bellows take 693 iterations with a quarter, 717 with a half, 709 with the whole.
const ONTO_PLANE: f64 = 0.25;

/// A number that is none says nothing about its design, and no file of a run can hold it.
fn not_finite(evaluation: &Evaluation) -> Option<Rejected> {
    let Evaluation { bending, blocking, figure_of_merit, max_force, angle_deg, further, .. } =
        evaluation;
    let mut numbers = vec![bending, blocking, figure_of_merit, max_force, angle_deg];
    numbers.extend(further.values());
    (!numbers.iter().all(|number| number.is_finite())).then(|| {
        let detail = format!("among what was read off the paths is no number: {numbers:?}");
        Rejected::new(Room::Fitness, "not_finite", detail, 1.0)
    })
}

/// Why a design is rejected whose objectives are doubted: it came to the end, and is as far from acceptable as flags are many.
fn excluded(exploits: &[Exploit]) -> Rejected {
    Rejected::new(Room::Fitness, "exploit", flags(exploits), 0.1 * exploits.len() as f64)
}

/// Pressure of the last sample, MPa.
fn last_sample(rows: &[Observation]) -> f64 {
    rows.iter().rfind(|row| row.is_sample).map_or(0.0, |row| row.pressure)
}

/// Why a path says nothing about its design: the method ended it, or the part before the first loaded sample.
fn cut_short(path: &Path, pressure: f64, scenario: &str) -> Option<Rejected> {
    let reached = path.points.last().map_or(0.0, |point| point.load / pressure);
    let is_loaded = path.points.iter().any(|point| point.is_sample && point.load > 0.0);
    (!path.ending.is_physical() || !is_loaded).then(|| {
        Rejected::new(
            Room::Solve,
            path.ending.name(),
            format!(
                "{scenario}: the path ends at {:.1} % of the largest pressure",
                100.0 * reached
            ),
            1.0 - reached,
        )
    })
}
