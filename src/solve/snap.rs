//! Losses of stability: the fall from an equilibrium that ends, or turns unstable, to the next stable one.
//!
//! ```text
//! damping (x_(k+1) - x_k) + R(x_(k+1)) = 0          overdamped motion, implicit steps
//! ```
//!
//! Each step is as long as keeps `K + damping I` positive definite on its way, so that it has one answer and lowers the
//! energy: the state goes down its own valley and does not jump to another. Where it stands on a saddle (a
//! bifurcation), it is first pushed along the critical mode, to the lower side; where both are equal, to that on which the mode's largest
//! component is positive. The metric is that of the nodes, whose areas are nearly equal. Source: pseudo-transient continuation, Kelley & Keyes (1998).

use serde::{Deserialize, Serialize};

use super::bordered::dot;
use super::damped::Damped;
use super::ending::Ending;
use super::path::{PathPoint, State, Walk, work_at_once};
use super::supply::Supply;
use super::{NewtonEnding, NewtonReport, NewtonSettings, SolverFailure};

/// A loss of stability that a path went over, on the way to the point that carries it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Snap {
    /// Energy given off on the way, mJ.
    pub released: f64,
    /// Whether the equilibrium went on, but unstable: a bifurcation, and the part buckled away from it.
    pub from_bifurcation: bool,
}

impl Walk<'_> {
    /// Falls from the last point, at `drive`, which its equilibrium does not reach stably, to a stable one.
    ///
    /// `saddle` is the unstable equilibrium at `drive`, where one is known.
    pub(super) fn fall(
        &mut self,
        drive: f64,
        saddle: Option<State>,
    ) -> Result<Result<PathPoint, Ending>, SolverFailure> {
        if self.points.iter().filter(|point| point.snap.is_some()).count() == MOST_SNAPS {
            return Ok(Err(Ending::BudgetSpent));
        }
        let from_bifurcation = saddle.is_some();
        let last = self.last();
        let mut state = State { x: last.x.clone(), load: last.load };
        if let Some(saddle) = saddle {
            state = self.pushed_off(drive, saddle)?;
        }
        let mut point = match self.descend(drive, state)? {
            Ok(point) => point,
            Err(ending) => return Ok(Err(ending)),
        };
        let last = self.last();
        let stored = point.stored_energy - last.stored_energy;
        let work = point.work - last.work;
        let tolerance = self.settings.work_tolerance * point.work.abs();
        if (work - stored).abs() > tolerance || from_bifurcation {
            point.work = last.work + work_at_once(last, &point);
            let released = point.work - last.work - stored;
            point.snap = Some(Snap { released, from_bifurcation });
            point.dissipated += released;
        }
        Ok(Ok(point))
    }

    /// Goes down from `state` to a stable equilibrium.
    fn descend(
        &mut self,
        drive: f64,
        mut state: State,
    ) -> Result<Result<PathPoint, Ending>, SolverFailure> {
        let mut damping = FIRST_DAMPING * self.mean_diagonal(&state)?;
        let largest = damping * MOST_DAMPING;
        let mut moved_before = f64::INFINITY;
        let mut worst = Ending::LimitPoint;
        for _ in 0..MOST_STEPS {
            if self.spent > self.settings.iteration_budget {
                return Ok(Err(Ending::BudgetSpent));
            }
            let mut next = state.clone();
            let report = self.damped_solve(drive, damping, &mut next)?;
            if report.ending != NewtonEnding::Converged {
                damping *= 4.0;
                worst = if report.ending == NewtonEnding::Inadmissible {
                    Ending::Inverted
                } else {
                    Ending::Stalled
                };
                if damping > largest {
                    return Ok(Err(worst));
                }
                continue;
            }
            let moved: f64 =
                next.x.iter().zip(&state.x).map(|(x, before)| (x - before).powi(2)).sum();
            state = next;
            if let Some(limit) = self.system.passed_limit(&state.x) {
                self.place = Some(limit.unknown);
                return Ok(Err(limit.kind.into()));
            }
            damping *= 0.25;
            // Slowing down: an equilibrium may be near.
            if moved < moved_before {
                match self.equilibrium(drive, state.clone())? {
                    Ok(point) => return Ok(Ok(point)),
                    Err(missed) => match (missed.ending, missed.unstable) {
                        (Ending::BudgetSpent | Ending::Ballooning | Ending::SelfTouch, _) => {
                            return Ok(Err(missed.ending));
                        }
                        (_, Some(saddle)) => state = self.pushed_off(drive, saddle)?,
                        _ => {}
                    },
                }
            }
            moved_before = moved;
        }
        Ok(Err(worst))
    }

    fn damped_solve(
        &mut self,
        drive: f64,
        damping: f64,
        state: &mut State,
    ) -> Result<NewtonReport, SolverFailure> {
        let newton = NewtonSettings {
            tolerance: LOOSE * self.settings.newton.tolerance,
            max_iterations: FEW_ITERATIONS,
            stops_when_indefinite: true,
        };
        let mut damped = Damped { anchor: state.x.clone(), damping, system: &mut *self.system };
        let mut walk =
            Walk { system: &mut damped, solver: &mut *self.solver, points: Vec::new(), ..*self };
        let report = walk.solve(drive, state, &newton)?;
        (self.iterations, self.spent) = (walk.iterations, walk.spent);
        Ok(report)
    }

    /// The state beside a saddle, along its critical mode.
    fn pushed_off(&mut self, drive: f64, saddle: State) -> Result<State, SolverFailure> {
        self.system.set_load(saddle.load);
        self.solver.linearize(self.system, &saddle.x)?;
        if !self.solver.is_invertible() {
            return Ok(saddle);
        }
        // Inverse iteration, from a vector that no mode is likely to be orthogonal to, zero where unknowns are held.
        let mut mode: Vec<f64> = (0..saddle.x.len()).map(|i| (1.0 + i as f64).sin()).collect();
        for _ in 0..MODE_ITERATIONS {
            self.solver.solve_linearized(&mut mode)?;
            let norm = dot(&mode, &mode).sqrt();
            mode.iter_mut().for_each(|value| *value /= norm);
        }
        let largest =
            mode.iter().copied().fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a });
        let size = self.reach_of(&saddle.x);
        let beside = |sign: f64| {
            let scale = sign * PUSH * size / largest;
            let x = saddle.x.iter().zip(&mode).map(|(x, mode)| x + scale * mode).collect();
            State { x, load: saddle.load }
        };
        let [up, down] = [beside(1.0), beside(-1.0)];
        if self.supply == Supply::Load {
            self.system.set_load(drive);
        }
        let [at_up, at_down] =
            [&up, &down].map(|state| self.system.energy(&state.x).unwrap_or(f64::INFINITY));
        let slack = 1e-6 * (at_up - at_down).abs() + self.system.energy_rounding();
        Ok(if at_down < at_up - slack.max(TIE * at_up.abs()) { down } else { up })
    }

    /// The largest displacement of the path so far.
    fn reach_of(&self, x: &[f64]) -> f64 {
        let start = &self.points[0].x;
        x.iter().zip(start).fold(0.0_f64, |largest, (x, start)| largest.max((x - start).abs()))
    }

    fn mean_diagonal(&mut self, state: &State) -> Result<f64, SolverFailure> {
        self.system.set_load(state.load);
        self.system.make_room(&state.x);
        let mut entries = vec![0.0; self.system.pattern().stored()];
        let mut residual = vec![0.0; state.x.len()];
        if self.system.tangent(&state.x, &mut residual, &mut entries).is_err() {
            return Ok(self.system.force_scale());
        }
        let sum: f64 = self.system.pattern().diagonal().map(|at| entries[at].abs()).sum();
        Ok(sum / state.x.len() as f64)
    }
}

/// The first damping, as a share of the mean diagonal.
const FIRST_DAMPING: f64 = 1e-3;
/// Over the first: where even this does not help, nothing does.
const MOST_DAMPING: f64 = 1e6;
const MOST_STEPS: usize = 100;
/// A step of the motion need not be solved as well as an equilibrium.
const LOOSE: f64 = 1e3;
const FEW_ITERATIONS: usize = 12;
/// More would be a part that chatters.
const MOST_SNAPS: usize = 20;
const MODE_ITERATIONS: usize = 8;
/// The push along the critical mode, as a share of the largest displacement so far.
const PUSH: f64 = 1e-2;
/// Energies that differ by less are equal.
const TIE: f64 = 1e-12;
