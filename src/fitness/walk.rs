//! Walking a part through its scenarios.
//!
//! Until the part comes near the planes of a scenario, that is the one that it branches off from, and what they have in common is walked
//! once.

use super::load_settings::LoadSettings;
use super::observation::{Observation, observations};
use super::outcome::{NotEvaluated, Unevaluated};
use super::part::Part;
use super::scenario::{Arrangement, Scenario};
use super::settings::FitnessSettings;
use crate::math::{Rejected, Room};
use crate::model::system::System;
use crate::model::{PartModel, PartSetup};
use crate::solve::{
    Backend, Ending, EquilibriumSolver, Path, PathPoint, PathSettings, Programme, SolveCounts,
    SolveTimes, Stop, follow_from,
};

/// A walked scenario.
#[derive(Clone, Debug)]
pub struct Walked {
    /// Which.
    pub scenario: Scenario,
    /// The path of the part; that of the scenario it branches off from where the part never comes near its planes.
    pub path: Path,
    /// A row for each point of the path.
    pub rows: Vec<Observation>,
    /// How many of the points are those of the scenario that it branches off from.
    pub common: usize,
    /// Which of the models was walked.
    model: usize,
    /// Whether the planes of that model were in place.
    in_place: bool,
}

impl Walked {
    /// The rows that are not those of the scenario that it branches off from.
    pub(super) fn own_rows(&self) -> &[Observation] {
        &self.rows[self.common..]
    }

    /// Whether planes stood in the way.
    #[must_use]
    pub fn is_obstructed(&self) -> bool {
        self.in_place
    }

    /// Pressure of the last sample, MPa.
    #[must_use]
    pub fn last_pressure(&self) -> f64 {
        self.rows.iter().rfind(|row| row.is_sample).map_or(0.0, |row| row.pressure)
    }
}

/// The walked scenarios of a part.
#[derive(Clone, Debug)]
pub struct Scenarios {
    models: Vec<PartModel>,
    /// Each after the one that it branches off from.
    pub walked: Vec<Walked>,
    /// Where each design is judged at a pressure of its own: that pressure.
    pub rated: Option<RatedPressure>,
    /// CPU seconds of the solvers.
    pub times: SolveTimes,
}

/// The pressure at which a design is judged: the least that its scenarios came to, before a limit of the material or another end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RatedPressure {
    /// MPa; each path has a sample there.
    pub pressure: f64,
    /// The pressure at which it is told besides, MPa; none where it does not come to that.
    pub reference: Option<f64>,
}

impl Scenarios {
    /// A model of the part, whatever stands before it.
    ///
    /// # Panics
    /// Never: at least one scenario is walked.
    #[must_use]
    pub fn model(&self) -> &PartModel {
        &self.models[0]
    }

    /// The scenarios, each with the model of the part whose planes stand before it; they may be lifted.
    pub fn with_models(&self) -> impl Iterator<Item = (&Walked, &PartModel)> {
        self.walked.iter().map(|walked| (walked, &self.models[walked.model]))
    }

    /// Calls `visit` with each scenario and the model as it was walked.
    ///
    /// # Errors
    /// The first of `visit`.
    pub fn try_for_each<E>(
        &mut self,
        mut visit: impl FnMut(&Walked, &mut PartModel) -> Result<(), E>,
    ) -> Result<(), E> {
        for walked in &self.walked {
            let model = &mut self.models[walked.model];
            model.lift_planes(!walked.in_place);
            visit(walked, model)?;
        }
        Ok(())
    }

    /// The rows of `scenario`; none where it was not walked.
    #[must_use]
    pub fn rows(&self, scenario: &Scenario) -> &[Observation] {
        let walked = self.walked.iter().find(|walked| walked.scenario == *scenario);
        walked.map_or(&[], |walked| &walked.rows)
    }
}

/// Walks `part` through the scenarios that `fitness` asks for, until `stop` wants that to end; adds to `counts` what that asked of the
/// solvers, however it ended. All scenarios together have the one budget of iterations.
///
/// # Errors
/// [`NotEvaluated`] when the part has no model, a path ends before it says anything of the part, a library fails, or it was stopped.
pub(super) fn walk_scenarios(
    part: &dyn Part,
    load: &LoadSettings,
    fitness: &FitnessSettings,
    backend: Backend,
    stop: Stop<'_>,
    counts: &mut SolveCounts,
) -> Result<Scenarios, NotEvaluated> {
    let scenarios: Vec<(Scenario, Arrangement)> = fitness
        .scenarios()
        .into_iter()
        .map(|scenario| (scenario, (scenario.arrangement)(fitness, load)))
        .collect();
    let (arranged, walked) = (Vec::new(), Vec::new());
    let mut walker = Walker { part, load, backend, stop, counts, arranged, walked };
    // Without planes a part is walked by the model that soon gets some.
    let with_planes = scenarios.iter().map(|(_, arrangement)| arrangement);
    let mut with_planes = with_planes.filter(|arrangement| !arrangement.planes.is_empty());
    let first = with_planes.next();
    for (scenario, arrangement) in &scenarios {
        let in_place = !arrangement.planes.is_empty();
        let model = match first {
            Some(first) if !in_place => walker.arranged_as(first)?,
            _ => walker.arranged_as(arrangement)?,
        };
        let walked = walker.walked(*scenario, arrangement, model, in_place)?;
        walker.walked.push(walked);
    }
    let rated = load.rated.map(|rated| walker.rate(rated.reference)).transpose()?;
    let Walker { arranged, walked, .. } = walker;
    let mut times = SolveTimes::default();
    for Arranged { solver, .. } in &arranged {
        times.assembly += solver.times().assembly;
        times.factorization += solver.times().factorization;
    }
    let models = arranged.into_iter().map(|arranged| arranged.model).collect();
    Ok(Scenarios { models, walked, rated, times })
}

/// A model with the arrangement that it was made for.
struct Arranged {
    arrangement: Arrangement,
    model: PartModel,
    solver: Box<dyn EquilibriumSolver>,
}

struct Walker<'a> {
    part: &'a dyn Part,
    load: &'a LoadSettings,
    backend: Backend,
    stop: Stop<'a>,
    counts: &'a mut SolveCounts,
    arranged: Vec<Arranged>,
    walked: Vec<Walked>,
}

impl Walker<'_> {
    /// The place of the model with the planes of `arrangement`.
    fn arranged_as(&mut self, arrangement: &Arrangement) -> Result<usize, NotEvaluated> {
        let has_them = |other: &Arranged| other.arrangement.planes == arrangement.planes;
        if let Some(place) = self.arranged.iter().position(has_them) {
            return Ok(place);
        }
        let setup = self.load.setup(arrangement.planes.clone());
        let model = self.part.model(&PartSetup { limits: self.part.limits().to_vec(), ..setup })?;
        let solver = self.backend.solver(model.pattern())?;
        self.arranged.push(Arranged { arrangement: arrangement.clone(), model, solver });
        Ok(self.arranged.len() - 1)
    }

    /// Walks one scenario by the model at the place `model`.
    fn walked(
        &mut self,
        scenario: Scenario,
        arrangement: &Arrangement,
        model: usize,
        in_place: bool,
    ) -> Result<Walked, NotEvaluated> {
        let origin = |name: &str| self.walked.iter().find(|walked| walked.scenario.name == name);
        let origin = scenario.branches_off.and_then(origin).map(|origin| &origin.path);
        let part = &mut self.arranged[model].model;
        part.lift_planes(!in_place);
        let touching = origin.map(|origin| {
            let touches = |point: &PathPoint| part.touches_plane(&point.x);
            (origin, origin.points.iter().position(touches))
        });
        let (path, common) = match touching {
            Some((origin, None)) => (origin.clone(), origin.points.len()),
            Some((origin, Some(touching))) => {
                let common = origin.points[..touching].to_vec();
                let onto_plane = |last: &PathPoint| origin.points[touching].drive - last.drive;
                let step =
                    common.last().map_or(f64::INFINITY, |last| ONTO_PLANE * onto_plane(last));
                (self.follow(model, arrangement.programme, common, step)?, touching)
            }
            None => (self.follow(model, arrangement.programme, Vec::new(), f64::INFINITY)?, 0),
        };
        if let Some(rejected) = cut_short(&path, self.load.pressure, &scenario) {
            return Err(rejected.into());
        }
        let rows = observations(self.part.shell(), &self.arranged[model].model, &path.points);
        Ok(Walked { scenario, path, rows, common, model, in_place })
    }

    /// Follows a path; one of a design with a pressure of its own over a sample at the reference pressure.
    fn follow(
        &mut self,
        model: usize,
        programme: Programme,
        points: Vec<PathPoint>,
        step: f64,
    ) -> Result<Path, NotEvaluated> {
        let path = self.load.path;
        let (Some(rated), Programme::Driven { end, .. }) = (self.load.rated, programme) else {
            return self.follow_by(&path, model, programme, points, step);
        };
        let from = points.last().map_or(0.0, |last| last.load);
        if rated.reference >= end || rated.reference <= from {
            return self.follow_by(&path, model, programme, points, step);
        }
        let first = self.follow_by(&path, model, rated.reference.into(), points, step)?;
        if !first.ending.is_complete() {
            return Ok(first);
        }
        let mut second = self.follow_by(&path, model, programme, first.points, f64::INFINITY)?;
        second.counts += first.counts;
        Ok(second)
    }

    /// The pressure at which the design is judged, after each path got a sample there.
    fn rate(&mut self, reference: f64) -> Result<RatedPressure, NotEvaluated> {
        let last = |walked: &Walked| walked.path.points.last().map_or(0.0, |last| last.load);
        let reached = self.walked.iter().map(last);
        let pressure = reached.fold(self.load.pressure, f64::min);
        for k in 0..self.walked.len() {
            self.sample_at(k, pressure)?;
        }
        let is_reached = |walked: &Walked| {
            walked.rows.iter().any(|row| row.is_sample && row.pressure == reference)
        };
        let is_told = reference <= pressure && self.walked.iter().all(is_reached);
        Ok(RatedPressure { pressure, reference: is_told.then_some(reference) })
    }

    /// Puts a sample at `pressure` into the path of the walked scenario `k`, which goes further, where it has none.
    fn sample_at(&mut self, k: usize, pressure: f64) -> Result<(), NotEvaluated> {
        let Walked { scenario, path, common, model, in_place, .. } = &self.walked[k];
        let (scenario, model, in_place) = (*scenario, *model, *in_place);
        let (mut path, mut common) = (path.clone(), *common);
        let Some(next) = path.points.iter().position(|point| point.load >= pressure) else {
            return Ok(());
        };
        if path.points[next].load == pressure {
            path.points[next].is_sample = true;
        } else {
            self.arranged[model].model.lift_planes(!in_place);
            let before = path.points[..next].to_vec();
            // One sample, at the end, steps as small as on the way, and a budget of its own: what was reached is to be read.
            let settings = PathSettings {
                steps: 1,
                iteration_budget: usize::MAX,
                halvings: self.load.path.halvings + self.load.path.steps.ilog2() + 1,
                ..self.load.path
            };
            let step = path.points[next].load - before.last().map_or(0.0, |last| last.load);
            let found = self.follow_by(&settings, model, pressure.into(), before, step)?;
            if !found.ending.is_complete() {
                let detail = format!(
                    "{}: no state was found at the rated pressure, {pressure:.5} MPa, between two others",
                    scenario.action
                );
                let rejected = Rejected::new(Room::Solve, found.ending.reason(), detail, 1e-3);
                return Err(rejected.into());
            }
            let between = found.points.len() - next;
            common += if next < common { between } else { 0 };
            drop(path.points.splice(next..next, found.points.into_iter().skip(next)));
        }
        let rows = observations(self.part.shell(), &self.arranged[model].model, &path.points);
        let walked = &mut self.walked[k];
        (walked.path, walked.rows, walked.common) = (path, rows, common);
        Ok(())
    }

    fn follow_by(
        &mut self,
        settings: &PathSettings,
        model: usize,
        programme: Programme,
        points: Vec<PathPoint>,
        step: f64,
    ) -> Result<Path, NotEvaluated> {
        let Self { stop, counts, arranged, .. } = self;
        let Arranged { model, solver, .. } = &mut arranged[model];
        let budget = settings.iteration_budget;
        let iteration_budget = budget.saturating_sub(counts.newton_iterations);
        let settings = PathSettings { iteration_budget, ..*settings };
        let path = follow_from(model, solver.as_mut(), programme, points, step, &settings, *stop)?;
        **counts += path.counts;
        let is_stopped = path.ending == Ending::Interrupted;
        if is_stopped { Err(Unevaluated::Stopped.into()) } else { Ok(path) }
    }
}

/// The first step towards the plane, as a share of that which went through it freely: the touch lies somewhere inside. Six evolved
/// bellows take 693 iterations with a quarter, 717 with a half, 709 with the whole.
const ONTO_PLANE: f64 = 0.25;

/// Why a path says nothing about its design: the method ended it, or the part before the first loaded sample.
fn cut_short(path: &Path, pressure: f64, scenario: &Scenario) -> Option<Rejected> {
    let reached = path.points.last().map_or(0.0, |point| point.load / pressure);
    let is_loaded = path.points.iter().any(|point| point.is_sample && point.load > 0.0);
    (!path.ending.leaves_an_answer() || !is_loaded).then(|| {
        Rejected::new(
            Room::Solve,
            path.ending.reason(),
            format!(
                "{}: the path ends at {:.1} % of the largest pressure",
                scenario.action,
                100.0 * reached
            ),
            1.0 - reached,
        )
    })
}
