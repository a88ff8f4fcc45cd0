//! The whole equilibrium curve, stable or not: by its load while that is cheap, then by its arc length.
//!
//! ```text
//! ds^2 = |dx|^2 / X^2 + dload^2 / L^2        the plane across the tangent, ds ahead        (Keller 1977)
//! ```
//!
//! The arc passes limit points of the load and of its conjugate alike, at the price of the conjugate alone (two
//! back-substitutions), so nothing is tried in between. `L` is the largest load, `X` makes both parts equal where the arc begins. The step follows Newton's
//! work and the angle between tangents; it is cut while work done and energy stored differ, as they do where another branch was
//! met.

use super::bordered::{self, Constraint, Metric};
use super::ending::Ending;
use super::hermite::{cubic_step, tangent_step};
use super::limit_search::{LimitSearch, is_at_limit, is_past_limit};
use super::path::PathPoint;
use super::prediction::best_prediction;
use super::supply::Supply;
use super::vectors::norm;
use super::walk::{Missed, State, Walk};
use super::{NewtonEnding, SolverFailure};

/// Traces the curve to where it first reaches the load `end`.
pub(super) fn trace(walk: &mut Walk<'_>, end: f64) -> Result<Ending, SolverFailure> {
    if walk.points.is_empty()
        && let Err(missed) = walk.accept_start()?
    {
        return Ok(missed.ending);
    }
    let part = end / walk.settings.steps as f64;
    let mut step = part;
    loop {
        let from = walk.last().load;
        if (end - from) / part < 1e-9 {
            return Ok(Ending::Reached);
        }
        let load = if (end - from) / step < 1.0 + 1e-9 { end } else { from + step };
        let last = walk.last();
        let mut steps = vec![tangent_step(last, load - from)];
        if let [.., before, last] = walk.points.as_slice() {
            steps.push(cubic_step(before, last, load - from));
        }
        let start = State { x: last.x.clone(), load: from };
        walk.attempted = walk.spent;
        let mut guess = best_prediction(walk.system, start, steps, false);
        guess.load = load;
        match walk.equilibrium(load, guess, 0)? {
            Ok(mut point) if walk.resolves(&point) => {
                point.is_sample = true;
                let easy = walk.iterations <= 5;
                walk.accept(point);
                if easy {
                    step = part.abs().min(2.0 * step.abs()).copysign(part);
                }
            }
            Err(Missed { past_limit: Some(past), .. }) if walk.resolves(&past) => {
                return walk.reach_limit(*past);
            }
            Err(Missed { ending, past_limit: None, .. })
                if ending.is_given_up() || ending.is_of_part() =>
            {
                return Ok(ending);
            }
            Ok(_) | Err(_) => {
                walk.system.rewind();
                walk.cuts += 1;
                step *= 0.5;
                if step / part < LOAD_HALVED {
                    return Arc::from_last(walk, end, step).trace(walk);
                }
            }
        }
    }
}

/// A curve being traced by its length.
struct Arc {
    /// The load at which it ends.
    end: f64,
    metric: Metric,
    /// The last point, its rates those of the arc; the one before it.
    last: PathPoint,
    before: Option<PathPoint>,
    step: f64,
    smallest: f64,
}

impl Arc {
    /// The arc from the last point of a walk, in the direction of a growing share of the load.
    fn from_last(walk: &Walk<'_>, end: f64, dload: f64) -> Self {
        let mut last = walk.last().clone();
        let speed = norm(&last.rate);
        let metric = Metric { state: speed * end.abs(), load: end.abs() };
        let sense = end.signum();
        normalise(&mut last, &metric, sense);
        last.drive = 0.0;
        last.on_arc = true;
        let step = 2.0_f64.sqrt() * (dload / end).abs();
        Self { end, metric, last, before: None, step, smallest: step * SMALLEST }
    }

    fn trace(mut self, walk: &mut Walk<'_>) -> Result<Ending, SolverFailure> {
        loop {
            if walk.spent > walk.settings.iteration_budget {
                return Ok(Ending::BudgetSpent);
            }
            if walk.stop.is_wanted() {
                return Ok(Ending::Interrupted);
            }
            let stepped = self.step(walk)?.filter(|point| walk.resolves(point));
            let Some(point) = stepped else {
                walk.cuts += 1;
                self.step *= 0.5;
                if self.step < self.smallest {
                    return Ok(Ending::Stalled);
                }
                continue;
            };
            if let Some(limit) = walk.system.passed_limit(&point.x) {
                walk.place = Some(limit.unknown);
                return Ok(limit.kind.into());
            }
            if is_past_limit(walk.share_used(&point.x)) {
                return self.reach_limit(walk, &point);
            }
            if (point.load - self.end) / self.end >= 0.0 {
                return self.finish(walk);
            }
            let cosine = self
                .metric
                .product((&point.rate, point.load_rate), (&self.last.rate, self.last.load_rate));
            let by_angle = TURN / cosine.min(1.0).acos();
            let by_work = (4.0 / walk.iterations.max(1) as f64).sqrt();
            self.step *= by_angle.min(by_work).clamp(0.5, 2.0);
            walk.accept(point.clone());
            self.before = Some(std::mem::replace(&mut self.last, point));
        }
    }

    /// The point a step ahead, where Newton's method finds it and the curve does not turn too sharply on the way.
    fn step(&self, walk: &mut Walk<'_>) -> Result<Option<PathPoint>, SolverFailure> {
        let mut steps = vec![tangent_step(&self.last, self.step)];
        if let Some(before) = &self.before {
            steps.push(cubic_step(before, &self.last, self.step));
        }
        let start = State { x: self.last.x.clone(), load: self.last.load };
        walk.attempted = walk.spent;
        let State { mut x, mut load } = best_prediction(walk.system, start, steps, false);
        let constraint =
            Constraint::Arc { from: &self.last, metric: self.metric, length: self.step };
        let newton = &walk.settings.newton;
        let report =
            bordered::solve(walk.system, walk.solver, &constraint, &mut x, &mut load, newton)?;
        walk.iterations += report.iterations;
        walk.spent += report.iterations;
        if report.ending != NewtonEnding::Converged {
            return Ok(None);
        }
        let Some(mut point) = walk.any_point(&State { x, load })? else {
            return Ok(None);
        };
        let towards = self
            .metric
            .product((&point.rate, point.load_rate), (&self.last.rate, self.last.load_rate));
        normalise(&mut point, &self.metric, towards.signum());
        let cosine = self
            .metric
            .product((&point.rate, point.load_rate), (&self.last.rate, self.last.load_rate));
        point.drive = self.last.drive + self.step;
        point.on_arc = true;
        walk.account(&mut point);
        Ok((cosine > SHARPEST).then_some(point))
    }

    /// The point on the way to `past` at which the material is at its limit.
    fn reach_limit(
        mut self,
        walk: &mut Walk<'_>,
        past: &PathPoint,
    ) -> Result<Ending, SolverFailure> {
        let share = walk.share_used(&self.last.x);
        if is_at_limit(share) {
            return Ok(walk.end_at_limit());
        }
        let mut search = LimitSearch::new([0.0, share], [self.step, walk.share_used(&past.x)]);
        while let Some(step) = search.next() {
            self.step = step;
            let Some(mut point) = self.step(walk)? else {
                if walk.spent > walk.settings.iteration_budget {
                    return Ok(Ending::BudgetSpent);
                }
                search.missed(step);
                continue;
            };
            let share = walk.share_used(&point.x);
            if is_at_limit(share) {
                point.is_sample = true;
                walk.accept(point);
                return Ok(walk.end_at_limit());
            }
            search.found(step, share);
        }
        Ok(walk.end_at_limit())
    }

    /// The point at the load where the curve ends.
    fn finish(self, walk: &mut Walk<'_>) -> Result<Ending, SolverFailure> {
        let slope = self.last.load_rate;
        walk.attempted = walk.spent;
        let length = (self.end - self.last.load) / slope;
        let (dx, _) = tangent_step(&self.last, length);
        let mut x: Vec<f64> = self.last.x.iter().zip(&dx).map(|(x, dx)| x + dx).collect();
        let mut load = self.end;
        let supply = Supply::Load;
        let constraint =
            Constraint::Supplied { supply: &supply, drive: self.end, scale: self.end.abs() };
        let newton = &walk.settings.newton;
        let report =
            bordered::solve(walk.system, walk.solver, &constraint, &mut x, &mut load, newton)?;
        walk.iterations += report.iterations;
        walk.spent += report.iterations;
        if report.ending != NewtonEnding::Converged {
            return Ok(Ending::Stalled);
        }
        let Some(mut point) = walk.any_point(&State { x, load })? else {
            return Ok(Ending::Stalled);
        };
        point.is_sample = true;
        walk.account(&mut point);
        walk.accept(point);
        Ok(Ending::Reached)
    }
}

/// Makes the rates of a point those of a unit arc, in the sense of `sense` of their present direction.
fn normalise(point: &mut PathPoint, metric: &Metric, sense: f64) {
    let scale = sense / metric.norm(&point.rate, point.load_rate);
    point.rate.iter_mut().for_each(|rate| *rate *= scale);
    point.load_rate *= scale;
    point.conjugate_rate *= scale;
}

/// The load's step is halved to this share before the arc takes over.
const LOAD_HALVED: f64 = 0.1;
/// The smallest arc, as a share of the first.
const SMALLEST: f64 = 1e-4;
/// The angle between tangents at which an arc is as long as it should be.
const TURN: f64 = 0.15;
/// The cosine of the largest angle between tangents: 45 degrees.
const SHARPEST: f64 = 0.7;
