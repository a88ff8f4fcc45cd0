//! The walk along a driven path: steps, their predictions, and when they are believed.

use std::ops::{ControlFlow, Range};

use super::bordered::{self, Constraint};
use super::ending::Ending;
use super::hermite::{work_between, work_by_conjugate};
use super::krylov::solve_unsymmetric;
use super::limit_search::is_past_limit;
use super::past::Past;
use super::path::{PathPoint, PathSettings};
use super::stop::Stop;
use super::supply::Supply;
use super::vectors::dot;
use super::{EquilibriumSolver, NewtonReport, NewtonSettings, SolverFailure};
use crate::model::system::{LoadedSystem, Memory};

/// A path being walked.
pub(super) struct Walk<'a> {
    pub system: &'a mut dyn LoadedSystem,
    pub solver: &'a mut dyn EquilibriumSolver,
    pub settings: &'a PathSettings,
    /// Asked before each search for an equilibrium.
    pub stop: Stop<'a>,
    pub supply: Supply,
    /// Of the drive, from rest to the end.
    pub span: f64,
    /// The step to try next.
    pub step: f64,
    pub points: Vec<PathPoint>,
    /// Equilibria ahead that steps too coarse to be believed have found.
    pub ahead: Vec<PathPoint>,
    /// Newton iterations since the last accepted point.
    pub iterations: usize,
    /// Steps given up since the last accepted point.
    pub cuts: usize,
    /// Newton iterations on this path.
    pub spent: usize,
    /// Those of the attempts that found its points.
    pub useful: usize,
    /// What had been spent when the attempt at hand began.
    pub attempted: usize,
    /// How many points there were when it last looked past a limit point.
    pub looked_past: Option<usize>,
    /// Indefinite tangents of the last search for an equilibrium.
    pub shifted: usize,
    /// Whether a fall from the last point found no end.
    pub fell: bool,
    pub place: Option<usize>,
    /// Sees what is accepted.
    pub watch: &'a mut dyn FnMut(&PathPoint),
}

/// A state and its load.
#[derive(Clone, Debug)]
pub(super) struct State {
    pub x: Vec<f64>,
    pub load: f64,
}

/// Why no equilibrium was found that the path may go on from, and the one that was found instead.
#[derive(Clone, Debug)]
pub(super) struct Missed {
    pub ending: Ending,
    pub unstable: Option<State>,
    /// The stable one at which the material is past its limit.
    pub past_limit: Option<Box<PathPoint>>,
}

impl From<Ending> for Missed {
    fn from(ending: Ending) -> Self {
        Self { ending, unstable: None, past_limit: None }
    }
}

impl Walk<'_> {
    pub(super) fn drive_to(&mut self, end: f64) -> Result<Ending, SolverFailure> {
        if self.points.is_empty()
            && let Err(missed) = self.accept_start()?
        {
            return Ok(missed.ending);
        }
        let start = self.supply.at_rest(self.points[0].conjugate);
        if end == start {
            return self.stay(end);
        }
        self.span = end - start;
        let part = self.span / self.settings.steps as f64;
        for k in 1..=self.settings.steps {
            let target = start + self.span * k as f64 / self.settings.steps as f64;
            let is_ahead = (target - self.last().drive) / part > 1e-9;
            if is_ahead && let Some(ending) = self.reach(target, part)? {
                return Ok(ending);
            }
        }
        let is_snapped = self.points.iter().any(|point| point.snap.is_some());
        Ok(if is_snapped { Ending::SnappedAndContinued } else { Ending::Reached })
    }

    /// Where the drive is to stay as it is at rest: a sealed chamber still answers to what pushes the part already.
    fn stay(&mut self, drive: f64) -> Result<Ending, SolverFailure> {
        if self.supply == Supply::Load {
            return Ok(Ending::Reached);
        }
        self.span = drive;
        self.attempted = self.spent;
        let start = State { x: self.last().x.clone(), load: self.last().load };
        let found = self.equilibrium(drive, start, usize::MAX)?;
        Ok(match found {
            Ok(mut point) => {
                point.is_sample = true;
                self.accept(point);
                Ending::Reached
            }
            Err(Missed { ending, .. }) => ending,
        })
    }

    /// Finds the state at rest.
    pub(super) fn accept_start(&mut self) -> Result<Result<(), Missed>, SolverFailure> {
        // At rest nothing moves, unless a barrier already pushes.
        let x = vec![0.0; self.system.pattern().order()];
        self.system.set_load(0.0);
        let drive = self.supply.at_rest(self.system.conjugate(&x));
        let supply = std::mem::replace(&mut self.supply, Supply::Load);
        self.attempted = self.spent;
        let found = self.equilibrium(0.0, State { x, load: 0.0 }, usize::MAX)?;
        self.supply = supply;
        Ok(found.map(|mut point| {
            if supply != Supply::Load {
                self.turn_to_supply(&mut point);
            }
            point.drive = drive;
            point.is_sample = true;
            self.accept(point);
        }))
    }

    /// Gives the rates of a point, which are those of a given load, with respect to the drive of the supply.
    pub(super) fn turn_to_supply(&self, point: &mut PathPoint) {
        let by_load = point.conjugate_rate;
        let load_rate =
            self.supply.equation(point.load, point.conjugate, point.drive).load_rate(by_load);
        point.rate.iter_mut().for_each(|rate| *rate *= load_rate);
        point.load_rate = load_rate;
        point.conjugate_rate = by_load * load_rate;
    }

    /// Walks to `target`, halving the step where it fails or is too coarse; the ending, where one came first.
    fn reach(&mut self, target: f64, part: f64) -> Result<Option<Ending>, SolverFailure> {
        let halvings = self.settings.halvings as i32;
        let shortest = part * 0.5_f64.powi(halvings);
        let largest = part * self.settings.largest_step.max(0.5_f64.powi(halvings));
        loop {
            // A thin wall that bends from flat stiffens within a hair of load.
            let starts = self.points.len() == 1;
            let smallest = if starts { START * shortest } else { shortest };
            let from = self.last().drive;
            let left = target - from;
            // What is added to the drive must change it.
            let resolution = RESOLVED * f64::EPSILON * from.abs().max(target.abs());
            let mut step = if self.step.abs() < largest.abs() { self.step } else { largest };
            if step.abs() < resolution {
                step = resolution.min(left.abs()).copysign(left);
            }
            // One step where it is nearly as long, and two equal ones rather than a long and a tiny one.
            if (left / step) < LENIENT {
                step = left;
            } else if (left / step) < 2.0 {
                step = 0.5 * left;
            }
            let drive = if step == left { target } else { from + step };
            let halved = 0.5 * step;
            let may_halve = halved / smallest >= 1.0 - 1e-9 && halved.abs() >= resolution;
            // The smallest step is to follow its own branch: what was found ahead may lie on another.
            let guess = self.prediction(drive, may_halve);
            let predicted = guess.clone();
            self.attempted = self.spent;
            let tried =
                self.equilibrium(drive, guess, if may_halve { PATIENCE } else { usize::MAX })?;
            match tried {
                // At the smallest step only a tangent that was indefinite on the way tells a jump from a stiff start.
                Ok(mut point) if self.resolves(&point) || (!may_halve && self.shifted == 0) => {
                    self.step = step * self.growth(&point, &predicted);
                    point.is_sample = drive == target;
                    self.accept(point);
                    if drive == target {
                        return Ok(None);
                    }
                }
                Ok(mut point) if !may_halve && self.stiffens(&point) => {
                    self.step = step * self.growth(&point, &predicted);
                    point.work = self.last().work + work_by_conjugate(self.last(), &point);
                    point.is_sample = drive == target;
                    self.accept(point);
                    if drive == target {
                        return Ok(None);
                    }
                }
                Err(Missed { ending, .. }) if ending.is_given_up() => return Ok(Some(ending)),
                Err(Missed { past_limit: Some(past), .. })
                    if self.resolves(&past)
                        || (!may_halve && (self.shifted == 0 || self.stiffens(&past))) =>
                {
                    return self.reach_limit(*past).map(Some);
                }
                Err(Missed { ending: Ending::LimitPoint, unstable: None, .. })
                    if self.may_look_past(drive) =>
                {
                    self.system.rewind();
                    self.cuts += 1;
                    match self.look_past_limit(drive, shortest.abs())? {
                        Past::Ended { ending, fell } => {
                            self.fell = fell;
                            return Ok(Some(ending));
                        }
                        Past::Unknown if may_halve => self.step = halved,
                        Past::Unknown => self.step = smallest,
                        Past::Returned => {
                            let left = target - self.last().drive;
                            let step = if left / smallest < 1.0 { left } else { smallest };
                            match self.lose_stability(step, smallest, target, None)? {
                                ControlFlow::Continue(()) => {}
                                ControlFlow::Break(ending) => return Ok(ending),
                            }
                        }
                    }
                }
                unresolved if may_halve => {
                    self.ahead.extend(unresolved);
                    self.system.rewind();
                    self.step = halved;
                    self.cuts += 1;
                    self.place = None;
                }
                Err(Missed { ending, past_limit: None, .. }) if ending.is_of_part() => {
                    return Ok(Some(ending));
                }
                unresolved => {
                    self.system.rewind();
                    let saddle = unresolved.err().and_then(|missed| missed.unstable);
                    match self.lose_stability(step, smallest, target, saddle)? {
                        ControlFlow::Continue(()) => {}
                        ControlFlow::Break(ending) => return Ok(ending),
                    }
                }
            }
        }
    }

    /// Leaves the last point, beyond which there is no stable state near, for one that is reached by a fall; breaks with the ending, or
    /// with none where the state is at `target`.
    fn lose_stability(
        &mut self,
        step: f64,
        smallest: f64,
        target: f64,
        saddle: Option<State>,
    ) -> Result<ControlFlow<Option<Ending>>, SolverFailure> {
        self.ahead.clear();
        self.attempted = self.spent;
        match self.fall_beyond(step, target, saddle)? {
            Ok(mut point) => {
                self.step = 4.0 * smallest;
                point.is_sample = point.drive == target;
                let is_there = point.is_sample;
                self.accept(point);
                Ok(if is_there { ControlFlow::Break(None) } else { ControlFlow::Continue(()) })
            }
            Err(ending) => {
                self.fell = ending != Ending::Interrupted;
                Ok(ControlFlow::Break(Some(ending)))
            }
        }
    }

    /// Falls to a stable state at `step` or further ahead, at most at `target`: right behind a bifurcation the branches are
    /// too near to be told apart.
    fn fall_beyond(
        &mut self,
        step: f64,
        target: f64,
        mut saddle: Option<State>,
    ) -> Result<Result<PathPoint, Ending>, SolverFailure> {
        let left = target - self.last().drive;
        let mut ahead = step;
        loop {
            let is_last = left / ahead < FURTHER || ahead / step > FURTHEST;
            let drive = if ahead == left { target } else { self.last().drive + ahead };
            match self.fall(drive, saddle.take())? {
                Err(Ending::LimitPoint | Ending::Stalled) if !is_last => ahead *= FURTHER,
                fallen => return Ok(fallen),
            }
        }
    }

    /// The factor on the next step: less where Newton's method had much to do, more where it had little and the prediction was
    /// near. What was spent on longer steps counts: a part that refused them is walked with care, and its work adds up.
    pub(super) fn growth(&self, point: &PathPoint, predicted: &State) -> f64 {
        let last = self.last();
        let (mut missed, mut moved) = (0.0, 0.0);
        for ((x, guess), before) in point.x.iter().zip(&predicted.x).zip(&last.x) {
            missed += (x - guess) * (x - guess);
            moved += (x - before) * (x - before);
        }
        let by_work = (EASY_ITERATIONS / self.iterations.max(1) as f64).sqrt();
        // The prediction's error is of third order or better.
        let by_shape =
            if moved > 0.0 { (NEAR * NEAR * moved / missed).powf(1.0 / 6.0) } else { 2.0 };
        by_work.min(by_shape.max(1.0)).clamp(0.5, 2.0)
    }

    pub(super) fn accept(&mut self, mut point: PathPoint) {
        let heat = self.system.settle(&point.x);
        point.memory = self.system.memory();
        point.dissipated += heat;
        point.stored_energy -= heat;
        if let Some(last) = self.points.last() {
            let forward = point.drive - last.drive;
            self.ahead.retain(|ahead| (ahead.drive - point.drive) / forward > 1e-9);
        }
        (self.watch)(&point);
        self.points.push(point);
        self.useful += self.spent - self.attempted;
        self.attempted = self.spent;
        (self.iterations, self.cuts) = (0, 0);
    }

    /// Whether the step to `point` is fine enough to be believed: the work done is the energy stored.
    ///
    /// What has no potential stores nothing to compare with.
    pub(super) fn resolves(&self, point: &PathPoint) -> bool {
        if !self.system.is_conservative() {
            return true;
        }
        let last = self.last();
        let stored = point.stored_energy - last.stored_energy;
        let work = point.work - last.work;
        let scale = point.work.abs().max(last.work.abs());
        let tolerance = self.settings.work_tolerance * scale + self.rounding(point);
        stored - work <= tolerance && (work - stored <= tolerance || self.system.dissipates())
    }

    /// What rounding makes of the energy at `point`, mJ: of the wall's, and of the load's, which cancels against its work.
    fn rounding(&self, point: &PathPoint) -> f64 {
        let of_load = 4.0 * f64::EPSILON * (point.load * point.conjugate).abs();
        self.system.energy_rounding() + of_load
    }

    /// Whether the step to `point`, near rest, is that of a part which stiffens, as a flat membrane does.
    ///
    /// Under a load `p` a flat membrane bulges by `p^(1/3)`, which no polynomial of the load follows; but the load is nearly one of
    /// the conjugate `C`, `k C + c C^3`. A part that jumps gives off energy however its work is counted.
    pub(super) fn stiffens(&self, point: &PathPoint) -> bool {
        let (last, start) = (self.last(), &self.points[0]);
        let shortest =
            self.span / self.settings.steps as f64 * 0.5_f64.powi(self.settings.halvings as i32);
        let work = work_by_conjugate(last, point);
        let missing = work - (point.stored_energy - last.stored_energy);
        self.system.is_conservative()
            && (last.drive - start.drive).abs() < shortest.abs()
            && missing.abs() <= STIFFENING * work.abs()
    }

    /// Adds the work done since the last point, and makes the energy exact where it is too small to be a difference.
    ///
    /// The energy of a wall that hardly moves drowns in the rounding of its strains. Then both energy and work are the work of the
    /// forces, by the trapezoidal rule.
    pub(super) fn account(&self, point: &mut PathPoint) {
        let rounding = self.rounding(point);
        let Some(last) = self.points.last() else {
            if point.stored_energy.abs() <= rounding {
                point.stored_energy = 0.0;
            }
            return;
        };
        let stored = point.stored_energy - last.stored_energy;
        let mut work = work_between(last, point);
        if stored.abs() <= rounding && work.abs() <= rounding && self.system.is_conservative() {
            work = self.work_of_forces(last, point);
            point.stored_energy = last.stored_energy + work;
        }
        point.work = last.work + work;
    }

    /// `1/2 (f_a + f_b) . (x_b - x_a)` with the forces `f` of the load.
    fn work_of_forces(&self, a: &PathPoint, b: &PathPoint) -> f64 {
        let moved: Vec<f64> = b.x.iter().zip(&a.x).map(|(b, a)| b - a).collect();
        let mut direction = vec![0.0; moved.len()];
        let mut along = |point: &PathPoint| {
            self.system.load_direction(&point.x, &mut direction);
            point.load * dot(&direction, &moved)
        };
        0.5 * (along(a) + along(b))
    }

    /// The stable equilibrium near `guess` at `drive`, over `most_shifted` indefinite tangents at most.
    pub(super) fn equilibrium(
        &mut self,
        drive: f64,
        guess: State,
        most_shifted: usize,
    ) -> Result<Result<PathPoint, Missed>, SolverFailure> {
        let mut state = guess;
        self.shifted = 0;
        for _ in 0..REFRESHES {
            if self.stop.is_wanted() {
                return Ok(Err(Ending::Interrupted.into()));
            }
            let mut newton = NewtonSettings { most_shifted, ..self.settings.newton };
            if most_shifted == usize::MAX {
                // What jumps is known by its tangents on the way.
                newton.chord_contraction = 0.0;
            }
            let report = self.solve(drive, &mut state, &newton)?;
            self.shifted += report.shifted;
            if self.spent > self.settings.iteration_budget {
                return Ok(Err(Ending::BudgetSpent.into()));
            }
            if let Some(ending) = Ending::of_failure(&report) {
                return Ok(Err(ending.into()));
            }
            if self.system.refresh(&state.x) <= REFRESHED {
                break;
            }
        }
        self.point(drive, state)
    }

    /// One Newton solve under the supply.
    pub(super) fn solve(
        &mut self,
        drive: f64,
        state: &mut State,
        newton: &NewtonSettings,
    ) -> Result<NewtonReport, SolverFailure> {
        let report = if self.supply == Supply::Load && self.system.is_conservative() {
            self.system.set_load(drive);
            state.load = drive;
            self.solver.solve(self.system, &mut state.x, newton)?
        } else {
            let constraint =
                Constraint::Supplied { supply: &self.supply, drive, scale: self.span.abs() };
            let State { x, load } = state;
            bordered::solve(self.system, self.solver, &constraint, x, load, newton)?
        };
        self.iterations += report.iterations;
        self.spent += report.iterations;
        Ok(report)
    }

    /// The point of the path at an equilibrium, where it is stable and within the model's bounds.
    pub(super) fn point(
        &mut self,
        drive: f64,
        state: State,
    ) -> Result<Result<PathPoint, Missed>, SolverFailure> {
        let Some(mut point) = self.any_point(&state)? else {
            let unstable = Some(state);
            return Ok(Err(Missed { unstable, ..Ending::LimitPoint.into() }));
        };
        let equation = self.supply.equation(point.load, point.conjugate, drive);
        let cured = equation.cures(point.conjugate_rate);
        if point.negative_pivots > cured {
            return Ok(Err(Missed { unstable: Some(state), ..Ending::Unstable.into() }));
        }
        if let Some(limit) = self.system.passed_limit(&state.x) {
            self.place = Some(limit.unknown);
            return Ok(Err(Ending::from(limit.kind).into()));
        }
        point.drive = drive;
        point.is_stable = true;
        if self.supply != Supply::Load {
            self.turn_to_supply(&mut point);
        }
        self.account(&mut point);
        if let Some(used) = self.system.utilization(&point.x)
            && is_past_limit(used.share)
        {
            self.place = Some(used.unknown);
            let past_limit = Some(Box::new(point));
            return Ok(Err(Missed { past_limit, ..Ending::LimitReached.into() }));
        }
        Ok(Ok(point))
    }

    /// The point of an equilibrium, stable or not, its rates with respect to the load; none where the tangent is
    /// singular. Its work is still to be added.
    pub(super) fn any_point(&mut self, state: &State) -> Result<Option<PathPoint>, SolverFailure> {
        let State { x, load } = state;
        let stable = self.system.stable_negative_pivots();
        self.system.set_load(*load);
        let mut negative = self.solver.linearize(self.system, x)?;
        if !self.system.is_conservative() {
            // What the symmetric part loses says nothing.
            negative = stable;
        }
        let energy = self.system.energy(x);
        let (true, Ok(energy)) = (self.solver.is_invertible(), energy) else {
            return Ok(None);
        };
        let mut direction = vec![0.0; x.len()];
        self.system.load_direction(x, &mut direction);
        let mut rate = direction.clone();
        if !solve_unsymmetric(self.system, self.solver, x, &mut rate)?.has_converged() {
            return Ok(None);
        }
        let conjugate = self.system.conjugate(x);
        Ok(Some(PathPoint {
            drive: *load,
            on_arc: false,
            load: *load,
            conjugate,
            work: 0.0,
            stored_energy: energy + load * conjugate,
            dissipated: self.points.last().map_or(0.0, |last| last.dissipated),
            x: x.clone(),
            memory: Memory::default(),
            conjugate_rate: dot(&direction, &rate),
            rate,
            load_rate: 1.0,
            negative_pivots: negative.saturating_sub(stable),
            is_stable: negative <= stable,
            is_sample: false,
            newton_iterations: self.iterations,
            cuts: self.cuts,
            snap: None,
        }))
    }

    pub(super) fn last(&self) -> &PathPoint {
        self.points.last().expect("the start is accepted first")
    }
}

/// Indefinite tangents on the way to an equilibrium after which a smaller step is tried: barriers that fold about each other
/// have some, though nothing is lost where the step ends.
pub(super) const PATIENCE: usize = 6;
/// Newton iterations at which a step is as long as it should be.
const EASY_ITERATIONS: f64 = 6.0;
/// How much longer than it should be a step may be that ends at a sample: half of the way there, found easy, grows by less than 2.
const LENIENT: f64 = 1.25;
/// The error of a prediction, as a share of the step, at which it is as long as it should be.
const NEAR: f64 = 0.2;
/// The smallest step from rest, as a share of the smallest later.
const START: f64 = 1e-3;
/// How far the energy stored by a part that stiffens from rest may be from its work, as a share of it: 3e-4 of a flat membrane.
const STIFFENING: f64 = 0.01;
/// The least step of a drive, in roundings of its value.
const RESOLVED: f64 = 16.0;
/// How much further the next fall is tried, and the furthest after which none is.
const FURTHER: f64 = 4.0;
const FURTHEST: f64 = 15.0;
/// Solves of one state until what the energy takes as constant agrees with it.
const REFRESHES: usize = 30;
/// How well it has to agree.
const REFRESHED: f64 = 1e-4;

/// The unknown that moves fastest, multipliers left out.
pub(super) fn fastest(rate: &[f64], multipliers: &Range<usize>) -> Option<usize> {
    let moving = (0..rate.len()).filter(|i| !multipliers.contains(i));
    moving.max_by(|&a, &b| rate[a].abs().total_cmp(&rate[b].abs()))
}
