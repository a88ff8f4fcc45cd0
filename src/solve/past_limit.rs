//! Past a limit point of the load, by the load's conjugate: volume control, for a chamber under pressure.
//!
//! ```text
//! E(x; p) = W(x) - p C(x)          along equilibria driven by C:   dW/dC = load(C),   dE/dC = load(C) - p
//! ```
//!
//! Near a limit point a tangent is nearly singular under a given load, and steps of the load are cut many times before one learns
//! that there is no equilibrium ahead. Under a given conjugate the same equilibria are regular, and a few steps pass the limit point.
//! Where the load then stays below its maximum `p` until a bound of the model's validity is passed, the energy at that load falls
//! all the way: no equilibrium of the branch holds the part, it balloons, and nothing has to be followed in time. Where the load
//! comes back to its maximum, the part may snap to what is there, and the fall decides (`snap.rs`).

use super::ending::Ending;
use super::hermite::Cubic;
use super::limit_search::is_past_limit;
use super::past::Past;
use super::path::{PathPoint, PathSettings};
use super::supply::Supply;
use super::walk::{State, Walk};
use super::{NewtonEnding, NewtonSettings, SolverFailure};
use crate::model::system::{Limit, Memory};

impl Walk<'_> {
    /// Whether equilibria beyond the last point may be followed by the conjugate: once from each point, where a load is given that
    /// has a potential, and nothing has a history.
    pub(super) fn may_look_past(&self, drive: f64) -> bool {
        let last = self.last();
        self.supply == Supply::Load
            && self.system.is_conservative()
            && !self.system.dissipates()
            && last.memory == Memory::default()
            && self.looked_past != Some(self.points.len())
            && self.points.len() > 1
            && last.conjugate_rate > 0.0
            && last.load.abs() < drive.abs()
            && (last.conjugate - self.points[0].conjugate) * drive > 0.0
    }

    /// Follows the equilibria by the conjugate from the last point, which `drive` was not reached from, past the maximum of the load,
    /// which is to lie within `resolution` of the last point. The stable ones before the maximum are accepted.
    pub(super) fn look_past_limit(
        &mut self,
        drive: f64,
        resolution: f64,
    ) -> Result<Past, SolverFailure> {
        self.looked_past = Some(self.points.len());
        let sense = drive.signum();
        let last = self.last();
        // Far enough to reach the load along the tangent, but not further than a share of the way so far.
        let way = last.conjugate - self.points[0].conjugate;
        let step = (last.conjugate_rate * (drive - last.load)).abs().min(FIRST_STEP * way.abs());
        let settings = PathSettings { work_tolerance: COARSE, ..*self.settings };
        let newton = settings.newton;
        let loose = NewtonSettings { tolerance: LOOSE * newton.tolerance, ..newton };
        let mut points = vec![self.by_conjugate(last)];
        if let [.., before, last] = self.points.as_slice()
            && last.snap.is_none()
            && before.conjugate_rate > 0.0
        {
            points.insert(0, self.by_conjugate(before));
        }
        let first = points.len();
        let (spent, iterations) = (self.spent, self.iterations);
        let mut look = Look {
            sense,
            step: step * sense,
            smallest: SMALLEST_STEP * step,
            peak: None,
            walk: Walk {
                system: &mut *self.system,
                solver: &mut *self.solver,
                supply: Supply::Conjugate,
                span: way,
                settings: &settings,
                // The states are none of the path yet.
                watch: &mut |_| {},
                points,
                ahead: Vec::new(),
                ..*self
            },
        };
        let mut attempts = Vec::new();
        let past = loop {
            if look.walk.spent > self.settings.iteration_budget {
                break Past::ended(Ending::BudgetSpent, false);
            }
            if look.walk.stop.is_wanted() {
                break Past::ended(Ending::Interrupted, false);
            }
            if look.walk.points.len() - first == MOST_STEPS || look.step.abs() < look.smallest {
                break look.lost();
            }
            let begun = look.walk.spent;
            let newton = if look.peak.is_some() { &loose } else { &newton };
            let Some((point, limit)) = look.next(newton)? else { continue };
            match look.segment(&point, resolution, drive) {
                Seen::TooCoarse => {}
                Seen::NoLimit => break Past::Unknown,
                Seen::Returned => break Past::Returned,
                Seen::Ahead => {
                    if let Some(limit) = limit {
                        if look.peak.is_none() && look.nears_bound(&point, resolution) {
                            continue;
                        }
                        look.walk.place = Some(limit.unknown);
                        break Past::ended(limit.kind.into(), look.peak.is_some());
                    }
                    // A limit behind the maximum of the load comes too late: the part has ballooned.
                    if look.walk.last().negative_pivots == 0
                        && is_past_limit(look.walk.share_used(&point.x))
                    {
                        let before = look.walk.points.len();
                        let ending = look.walk.reach_limit(point.clone())?;
                        let is_found = look.walk.points.len() > before;
                        if is_found && look.walk.last().negative_pivots > 0 {
                            look.walk.points.pop();
                        } else {
                            attempts.extend(is_found.then_some(begun..look.walk.spent));
                            break Past::ended(ending, false);
                        }
                    }
                    look.walk.points.push(point);
                    attempts.push(begun..look.walk.spent);
                }
            }
        };
        let Look { walk: Walk { points, spent: total, place, .. }, .. } = look;
        self.place = place;
        // What is stable under the load, and not past the drive, belongs to the path. Where no limit point was found, nothing does: behind
        // a knee, as an imperfect column has, the steps of the load decide whether stability is lost.
        let found = if past == Past::Unknown { 0 } else { attempts.len() };
        let mut before = spent - iterations;
        for (point, attempt) in points.into_iter().skip(first).zip(attempts).take(found) {
            let is_before = (drive - point.load) * sense > 0.0;
            if point.negative_pivots > 0 || !is_before {
                break;
            }
            let mut point = by_load(point);
            point.newton_iterations = attempt.end - before;
            (self.attempted, self.spent) = (attempt.start, attempt.end);
            before = attempt.end;
            self.accept(point);
        }
        self.iterations = total - before;
        self.spent = total;
        // From a limit point there is nothing to be seen twice.
        self.looked_past = Some(self.points.len());
        Ok(past)
    }

    /// A point of the path with rates by its conjugate, which becomes its drive.
    fn by_conjugate(&self, point: &PathPoint) -> PathPoint {
        let by_load = point.conjugate_rate / point.load_rate;
        let scale = 1.0 / point.conjugate_rate;
        PathPoint {
            drive: point.conjugate,
            load_rate: 1.0 / by_load,
            conjugate_rate: 1.0,
            rate: point.rate.iter().map(|rate| scale * rate).collect(),
            ..point.clone()
        }
    }
}

/// A point that was found by its conjugate with rates by its load, which becomes its drive.
fn by_load(mut point: PathPoint) -> PathPoint {
    let scale = 1.0 / point.load_rate;
    point.rate.iter_mut().for_each(|rate| *rate *= scale);
    PathPoint {
        drive: point.load,
        load_rate: 1.0,
        conjugate_rate: scale * point.conjugate_rate,
        ..point
    }
}

/// Equilibria being followed by their conjugate.
struct Look<'a> {
    walk: Walk<'a>,
    /// 1 or -1, as the load is.
    sense: f64,
    /// Of the conjugate.
    step: f64,
    smallest: f64,
    /// The maximum of the load, once it was passed.
    peak: Option<f64>,
}

/// What the way from the last point to another one is like.
enum Seen {
    /// The limit point on it is not known well enough.
    TooCoarse,
    /// The load rises to the drive.
    NoLimit,
    /// The load comes back to its maximum.
    Returned,
    /// The load is below its maximum, or has none yet.
    Ahead,
}

impl Look<'_> {
    /// The equilibrium a step ahead, and the bound it has passed; none where it was not found, and the step is cut.
    fn next(
        &mut self,
        newton: &NewtonSettings,
    ) -> Result<Option<(PathPoint, Option<Limit>)>, SolverFailure> {
        let walk = &mut self.walk;
        walk.iterations = 0;
        let drive = walk.last().drive + self.step;
        let guess = walk.prediction(drive, false);
        let mut state = guess.clone();
        // A tangent that the constraint does not cure lies past a bifurcation: what is found from it may be another branch.
        let newton = NewtonSettings { most_shifted: 0, ..*newton };
        let report = walk.solve(drive, &mut state, &newton)?;
        let found = match report.ending {
            NewtonEnding::Converged => walk.stable_under_conjugate(drive, &state)?,
            _ => None,
        };
        let Some(point) = found.filter(|point| walk.resolves(point)) else {
            self.step *= 0.5;
            return Ok(None);
        };
        let limit = walk.system.passed_limit(&point.x);
        let is_easy = self.peak.is_some() && report.iterations <= EASY_ITERATIONS;
        self.step *= if is_easy { 2.0 } else { walk.growth(&point, &guess) };
        Ok(Some((point, limit)))
    }

    /// Looks at the load between the last point and `point`, as a cubic of the conjugate.
    fn segment(&mut self, point: &PathPoint, resolution: f64, drive: f64) -> Seen {
        let last = self.walk.last();
        let rise = point.drive - last.drive;
        let slopes = [last, point].map(|point| self.sense * rise * point.load_rate);
        let cubic = Cubic { ends: [last, point].map(|point| self.sense * point.load), slopes };
        let places = (0..=PARTS).map(|k| k as f64 / PARTS as f64);
        let [top, largest] = places
            .map(|s| [s, cubic.at(s)])
            .fold([0.0, f64::MIN], |one, other| if other[1] > one[1] { other } else { one });
        if let Some(peak) = self.peak {
            return if largest >= peak { Seen::Returned } else { Seen::Ahead };
        }
        let may_cut = rise.abs() > self.smallest;
        let hump = largest - cubic.ends[0].max(cubic.ends[1]);
        if slopes[1] > 0.0 && point.negative_pivots == 0 && !(may_cut && hump > resolution) {
            let is_there = self.sense * point.load >= drive.abs();
            return if is_there { Seen::NoLimit } else { Seen::Ahead };
        }
        let lacking = largest - cubic.ends[0];
        if may_cut && (largest >= drive.abs() || lacking > resolution) {
            // Near its maximum the load is a parabola: what it lacks there falls with the square of the way.
            let left = (NEAR * resolution / lacking).sqrt().min(0.5);
            self.step = (top * (1.0 - left)).max(1.0 / PARTS as f64) * rise;
            return Seen::TooCoarse;
        }
        self.peak = Some(largest);
        Seen::Ahead
    }

    /// Whether the step to `point`, which has passed a bound, is cut, so that the bound is known to this resolution of the load.
    fn nears_bound(&mut self, point: &PathPoint, resolution: f64) -> bool {
        let last = self.walk.last();
        let rise = point.drive - last.drive;
        let is_coarse = (point.load - last.load).abs() > resolution && rise.abs() > self.smallest;
        if is_coarse {
            self.step = 0.5 * rise;
        }
        is_coarse
    }

    /// What there is to say where no equilibrium is found.
    fn lost(&self) -> Past {
        if self.peak.is_some() { Past::Returned } else { Past::Unknown }
    }
}

impl Walk<'_> {
    /// The point of an equilibrium that is stable under its conjugate, which is its drive.
    fn stable_under_conjugate(
        &mut self,
        drive: f64,
        state: &State,
    ) -> Result<Option<PathPoint>, SolverFailure> {
        let Some(mut point) = self.any_point(state)? else { return Ok(None) };
        let equation = self.supply.equation(point.load, point.conjugate, drive);
        if point.negative_pivots > equation.cures(point.conjugate_rate) {
            return Ok(None);
        }
        point.drive = drive;
        point.is_stable = true;
        self.turn_to_supply(&mut point);
        self.account(&mut point);
        Ok(Some(point))
    }
}

/// The first step, as a share of how far the conjugate has come.
const FIRST_STEP: f64 = 0.25;
/// The smallest step, as a share of the first.
const SMALLEST_STEP: f64 = 1e-3;
/// How much the load is to lack of its maximum before it, as a share of what it may.
const NEAR: f64 = 0.5;
/// The work tolerance: what lies past a limit point is looked at, not recorded.
const COARSE: f64 = 1e-2;
/// How much larger a residual may be past the limit point.
const LOOSE: f64 = 1e3;
/// Past the maximum a step that took so many iterations is followed by one twice as long.
const EASY_ITERATIONS: usize = 5;
const MOST_STEPS: usize = 100;
/// At so many places is the load between two points compared with its maximum.
const PARTS: usize = 16;
