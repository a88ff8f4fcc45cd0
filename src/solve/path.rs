//! The loading path: equilibria at increasing load.
//!
//! Every accepted state is a stable equilibrium. States stand at fixed sample loads, so that what is read off
//! a path hardly depends on how it was walked; between samples the step is halved when Newton's method fails, when it
//! met an indefinite tangent, and when the work done is not the energy stored. What is still so at the smallest step
//! is accepted and marked: the part snapped. A step starts from a prediction: the cubic through the last two states and their tangents
//!
//! ```text
//! K dx/dload = dC/dx          dC/dload = dC/dx . dx/dload          C = conjugate of the load (volume)
//! work = int load dC = [load C] - int C dload      by Hermite's rule, whose error is of fourth order
//! ```

use serde::{Deserialize, Serialize};

use super::{EquilibriumSolver, NewtonEnding, NewtonReport, NewtonSettings, SolverFailure};
use crate::model::system::LoadedSystem;

/// How a path is walked.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PathSettings {
    /// Number of equal load steps to the largest load.
    pub steps: usize,
    /// How often a step may be halved before the path ends.
    pub halvings: u32,
    /// A step is halved while work done and energy stored differ by more than this share of the work so far.
    pub work_tolerance: f64,
    /// Newton iterations that a whole path may use.
    pub iteration_budget: usize,
    /// When Newton's method stops.
    pub newton: NewtonSettings,
}

impl Default for PathSettings {
    fn default() -> Self {
        Self {
            steps: 10,
            halvings: 5,
            work_tolerance: 1e-3,
            iteration_budget: 400,
            newton: NewtonSettings::default(),
        }
    }
}

/// Why a path ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Ending {
    /// The largest load was reached.
    Reached,
    /// Beyond this load no stable equilibrium is near: the energy loses its minimum.
    LimitPoint,
    /// The equilibrium beyond this load exists but is not stable.
    Unstable,
    /// Elements invert or folds close.
    Inverted,
    /// Newton's method does not converge, for no reason of the above.
    Stalled,
    /// The budget of iterations was spent.
    BudgetSpent,
}

impl Ending {
    /// The ending as tables write it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Reached => "reached",
            Self::LimitPoint => "limit_point",
            Self::Unstable => "unstable",
            Self::Inverted => "inverted",
            Self::Stalled => "stalled",
            Self::BudgetSpent => "budget_spent",
        }
    }
}

/// A stable equilibrium on a path.
#[derive(Clone, Debug, PartialEq)]
pub struct PathPoint {
    /// The load (pressure, MPa).
    pub load: f64,
    /// Its conjugate (volume, mm^3).
    pub conjugate: f64,
    /// Work done by the load since the start of the path, mJ.
    pub work: f64,
    /// Potential energy without the load's own, mJ: what the wall and the barriers store.
    pub stored_energy: f64,
    /// The unknowns, `[n]`.
    pub x: Vec<f64>,
    /// Their derivative with respect to the load, `[n]`.
    pub rate: Vec<f64>,
    /// The conjugate's derivative with respect to the load.
    pub conjugate_rate: f64,
    /// Newton iterations spent since the point before, on steps that were given up too.
    pub newton_iterations: usize,
    /// Iterations of the last step whose tangent was indefinite: above 0 the part snapped here, or came near it.
    pub shifted: usize,
}

/// A walked path, its start included.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    /// Stable equilibria at increasing load.
    pub points: Vec<PathPoint>,
    /// Why there are no more.
    pub ending: Ending,
}

/// Follows the equilibrium of `system` from the last of `points` (from rest where empty) to `max_load`.
///
/// The sample loads are `max_load k / steps` whatever the start.
///
/// # Errors
/// [`SolverFailure`] when a library fails; a path that ends early is a value.
pub fn follow(
    system: &mut dyn LoadedSystem,
    solver: &mut dyn EquilibriumSolver,
    max_load: f64,
    points: Vec<PathPoint>,
    settings: &PathSettings,
) -> Result<Path, SolverFailure> {
    let mut walk = Walk { system, solver, settings, points, iterations: 0, spent: 0 };
    let ending = walk.to(max_load)?;
    Ok(Path { points: walk.points, ending })
}

struct Walk<'a> {
    system: &'a mut dyn LoadedSystem,
    solver: &'a mut dyn EquilibriumSolver,
    settings: &'a PathSettings,
    points: Vec<PathPoint>,
    /// Since the last accepted point.
    iterations: usize,
    /// On this path.
    spent: usize,
}

impl Walk<'_> {
    fn to(&mut self, max_load: f64) -> Result<Ending, SolverFailure> {
        if self.points.is_empty()
            && let Err(ending) = self.accept_start()?
        {
            return Ok(ending);
        }
        let steps = self.settings.steps;
        let sample_step = max_load / steps as f64;
        for k in 1..=steps {
            let target = max_load * k as f64 / steps as f64;
            let is_ahead = target > self.last().load + 1e-9 * sample_step;
            if is_ahead && let Some(ending) = self.reach(target, sample_step)? {
                return Ok(ending);
            }
        }
        Ok(Ending::Reached)
    }

    /// Walks to `target`, halving the step where it fails or is too coarse; the ending, where one came first.
    fn reach(&mut self, target: f64, sample_step: f64) -> Result<Option<Ending>, SolverFailure> {
        let smallest = sample_step * 0.5_f64.powi(self.settings.halvings as i32);
        let mut step = target - self.last().load;
        loop {
            let from = self.last().load;
            let load = if step >= (target - from) * (1.0 - 1e-9) { target } else { from + step };
            let halved = 0.5 * (load - from);
            let may_halve = halved >= smallest * (1.0 - 1e-9);
            self.system.set_load(load);
            let guess = self.prediction(load);
            match self.equilibrium(load, guess)? {
                Ok(point) if self.resolves(&point) || !may_halve => {
                    self.system.settle(&point.x);
                    self.points.push(point);
                    self.iterations = 0;
                    if load == target {
                        return Ok(None);
                    }
                }
                Err(Ending::BudgetSpent) => return Ok(Some(Ending::BudgetSpent)),
                Err(ending) if !may_halve => return Ok(Some(ending)),
                Ok(_) | Err(_) => step = halved,
            }
        }
    }

    fn accept_start(&mut self) -> Result<Result<(), Ending>, SolverFailure> {
        self.system.set_load(0.0);
        // At rest nothing moves, unless a barrier already pushes.
        let rest = vec![0.0; self.system.pattern().order()];
        let start = self.equilibrium(0.0, rest)?;
        Ok(start.map(|point| self.points.push(point)))
    }

    /// Whether the step to `point` is fine enough to be believed: Newton met no indefinite tangent on the way, and the
    /// work done equals the energy stored.
    fn resolves(&self, point: &PathPoint) -> bool {
        let last = self.last();
        let stored = point.stored_energy - last.stored_energy;
        let work = point.work - last.work;
        point.shifted == 0
            && (work - stored).abs() <= self.settings.work_tolerance * point.work.abs()
    }

    /// The stable equilibrium near `x` at `load`, which the system is under.
    fn equilibrium(
        &mut self,
        load: f64,
        mut x: Vec<f64>,
    ) -> Result<Result<PathPoint, Ending>, SolverFailure> {
        let report = self.solver.solve(self.system, &mut x, &self.settings.newton)?;
        self.iterations += report.iterations;
        self.spent += report.iterations;
        if self.spent > self.settings.iteration_budget {
            return Ok(Err(Ending::BudgetSpent));
        }
        if let Some(ending) = failure(&report) {
            return Ok(Err(ending));
        }
        let negative_pivots = self.solver.linearize(self.system, &x)?;
        if negative_pivots != self.system.stable_negative_pivots() {
            return Ok(Err(Ending::Unstable));
        }
        let mut direction = vec![0.0; x.len()];
        self.system.load_direction(&x, &mut direction);
        let mut rate = direction.clone();
        self.solver.solve_linearized(&mut rate)?;
        let conjugate = self.system.conjugate(&x);
        let conjugate_rate = direction.iter().zip(&rate).map(|(a, b)| a * b).sum();
        let Ok(energy) = self.system.energy(&x) else {
            return Ok(Err(Ending::Inverted));
        };
        let mut point = PathPoint {
            load,
            conjugate,
            work: 0.0,
            stored_energy: energy + load * conjugate,
            x,
            rate,
            conjugate_rate,
            newton_iterations: self.iterations,
            shifted: report.shifted,
        };
        if let Some(last) = self.points.last() {
            point.work = last.work + work_between(last, &point);
        }
        Ok(Ok(point))
    }

    fn last(&self) -> &PathPoint {
        self.points.last().expect("the start is accepted first")
    }

    /// The better of the cubic and the tangent by the size of their residual; the last state where neither is admissible.
    fn prediction(&mut self, load: f64) -> Vec<f64> {
        let last = self.last();
        let mut steps = vec![tangent_step(last, load)];
        if let [.., before, last] = self.points.as_slice() {
            steps.push(cubic_step(before, last, load));
        }
        let start = last.x.clone();
        let mut best = start.clone();
        let mut residual = vec![0.0; best.len()];
        let mut smallest = f64::INFINITY;
        for step in steps {
            let length = self.system.longest_step(&start, &step);
            let x: Vec<f64> = start.iter().zip(&step).map(|(x, dx)| x + length * dx).collect();
            if self.system.residual(&x, &mut residual).is_ok() {
                let size = residual.iter().map(|r| r * r).sum::<f64>();
                if size < smallest {
                    (smallest, best) = (size, x);
                }
            }
        }
        best
    }
}

fn failure(report: &NewtonReport) -> Option<Ending> {
    match report.ending {
        NewtonEnding::Converged => None,
        _ if report.shifted > 0 => Some(Ending::LimitPoint),
        NewtonEnding::Singular => Some(Ending::LimitPoint),
        NewtonEnding::Inadmissible => Some(Ending::Inverted),
        NewtonEnding::IterationLimit | NewtonEnding::LineSearchFailed => Some(Ending::Stalled),
    }
}

fn tangent_step(last: &PathPoint, load: f64) -> Vec<f64> {
    last.rate.iter().map(|rate| (load - last.load) * rate).collect()
}

/// The step to `load` along the cubic through two states with their rates.
fn cubic_step(before: &PathPoint, last: &PathPoint, load: f64) -> Vec<f64> {
    let h = last.load - before.load;
    let s = (load - before.load) / h;
    // Hermite's basis at s, less its value at s = 1.
    let (s2, s3) = (s * s, s * s * s);
    let at_before = 2.0 * s3 - 3.0 * s2 + 1.0;
    let rate_before = h * (s3 - 2.0 * s2 + s);
    let rate_last = h * (s3 - s2);
    (0..last.x.len())
        .map(|i| {
            at_before * (before.x[i] - last.x[i])
                + rate_before * before.rate[i]
                + rate_last * last.rate[i]
        })
        .collect()
}

/// `int load dC` between two states.
fn work_between(a: &PathPoint, b: &PathPoint) -> f64 {
    let h = b.load - a.load;
    // Relative to a's conjugate, so that nothing large cancels.
    let rise = b.conjugate - a.conjugate;
    let integral = 0.5 * h * rise + h * h / 12.0 * (a.conjugate_rate - b.conjugate_rate);
    b.load * rise - integral
}
