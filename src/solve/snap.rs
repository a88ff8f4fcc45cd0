//! Losses of stability: the fall from an equilibrium that ends, or turns unstable, to the next stable one.
//!
//! ```text
//! damping (x_(k+1) - x_k) + R(x_(k+1)) = 0          overdamped motion, implicit steps
//! ```
//!
//! Each step is as long as keeps `K + damping I` positive definite on its way, but for a few iterates, so that the state goes
//! down its own valley and does not jump to another. Where it stands on a saddle (a bifurcation), it is first pushed along
//! the mode in which it is least stable, to the lowest of ever larger pushes on both sides; where none is lower, to that on
//! which the mode's largest component is positive. The metric is that of the nodes, whose areas are nearly equal.
//! Source: pseudo-transient continuation, Kelley & Keyes (1998).

use super::damped::Damped;
use super::ending::Ending;
use super::hermite::{work_at_once, work_by_conjugate};
use super::path::{PathPoint, Snap};
use super::shift::mean_diagonal;
use super::vectors::dot;
use super::walk::{State, Walk};
use super::{NewtonEnding, NewtonReport, NewtonSettings, SolverFailure};

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
        let stored = point.stored_energy - self.last().stored_energy;
        if !from_bifurcation && !self.resolves(&point) && self.stiffens(&point) {
            point.work = self.last().work + work_by_conjugate(self.last(), &point);
        } else if from_bifurcation || !self.resolves(&point) {
            let last = self.last();
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
        for _ in 0..MOST_STEPS {
            if self.spent > self.settings.iteration_budget {
                return Ok(Err(Ending::BudgetSpent));
            }
            if self.stop.is_wanted() {
                return Ok(Err(Ending::Interrupted));
            }
            let mut next = state.clone();
            let report = self.damped_solve(drive, damping, &mut next)?;
            if report.ending != NewtonEnding::Converged {
                damping *= 4.0;
                let worst = if report.ending == NewtonEnding::Inadmissible {
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
            // Slowing down: an equilibrium may be near. Where nothing moves any more there is one, though it may be a saddle.
            let rests = report.iterations == 0;
            if rests || moved < moved_before {
                let missed = match self.equilibrium(
                    drive,
                    state.clone(),
                    if rests { usize::MAX } else { 0 },
                )? {
                    Ok(point) => return Ok(Ok(point)),
                    Err(missed) => missed,
                };
                match (missed.ending, missed.unstable) {
                    (ending, _) if ending.is_given_up() || ending.is_of_part() => {
                        return Ok(Err(ending));
                    }
                    (_, Some(saddle)) => state = self.pushed_off(drive, saddle)?,
                    (ending, None) if rests => return Ok(Err(ending)),
                    _ => {}
                }
            }
            moved_before = moved;
        }
        Ok(Err(Ending::LimitPoint))
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
            chord_contraction: self.settings.newton.chord_contraction,
            most_shifted: FEW_SHIFTED,
        };
        let mut damped = Damped { anchor: state.x.clone(), damping, system: &mut *self.system };
        let mut walk = Walk {
            system: &mut damped,
            solver: &mut *self.solver,
            // The states of a fall are none of the path.
            watch: &mut |_| {},
            points: Vec::new(),
            ahead: Vec::new(),
            ..*self
        };
        let report = walk.solve(drive, state, &newton)?;
        (self.iterations, self.spent) = (walk.iterations, walk.spent);
        Ok(report)
    }

    /// The state beside a saddle, along the mode in which it is least stable.
    fn pushed_off(&mut self, drive: f64, saddle: State) -> Result<State, SolverFailure> {
        let mean_diagonal = self.mean_diagonal(&saddle)?;
        let stable = self.system.stable_negative_pivots();
        let mut direction = vec![0.0; saddle.x.len()];
        self.system.load_direction(&saddle.x, &mut direction);
        let conjugate = self.system.conjugate(&saddle.x);
        let equation = self.supply.equation(saddle.load, conjugate, drive);
        let (mut by_load, mut damping) = (direction.clone(), FIRST_SHIFT * mean_diagonal);
        // The first shift that makes the saddle stable is at most twice what it takes, so that the least stable mode is the
        // one nearest to zero.
        for _ in 0..SHIFTS {
            damping *= 2.0;
            let anchor = saddle.x.clone();
            let mut damped = Damped { anchor, damping, system: &mut *self.system };
            let negative = self.solver.linearize(&mut damped, &saddle.x)?;
            if !self.solver.is_invertible() {
                continue;
            }
            by_load.copy_from_slice(&direction);
            self.solver.solve_linearized(&mut by_load)?;
            let cured = equation.cures(dot(&direction, &by_load));
            if negative.saturating_sub(stable) <= cured {
                break;
            }
        }
        if !self.solver.is_invertible() {
            return Ok(saddle);
        }
        let share = equation.by_conjugate * equation.load_rate(dot(&direction, &by_load));
        // Inverse iteration with K + k a a^T, from a vector that no mode is likely to be orthogonal to.
        let mut mode: Vec<f64> = (0..saddle.x.len()).map(|i| (1.0 + i as f64).sin()).collect();
        let multipliers = self.system.multipliers();
        let moving = |mode: &[f64]| -> Vec<f64> {
            let moving = mode.iter().enumerate().filter(|(i, _)| !multipliers.contains(i));
            moving.map(|(_, value)| *value).collect()
        };
        for _ in 0..MODE_ITERATIONS {
            // Multipliers have no mass.
            mode[multipliers.clone()].fill(0.0);
            self.solver.solve_linearized(&mut mode)?;
            let relief = share * dot(&direction, &mode);
            mode.iter_mut().zip(&by_load).for_each(|(mode, z)| *mode -= relief * z);
            let moving = moving(&mode);
            let norm = dot(&moving, &moving).sqrt();
            mode.iter_mut().for_each(|value| *value /= norm);
        }
        let largest =
            moving(&mode).into_iter().fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a });
        // The valleys on both sides may be near or far: the lowest of ever larger pushes is in one.
        let size = PUSH * self.reach_of(&saddle.x) / largest;
        self.system.set_load(saddle.load);
        let energy = self.system.energy(&saddle.x).unwrap_or(f64::INFINITY);
        let mut lowest = (energy - self.system.energy_rounding() - TIE * energy.abs(), size);
        for push in (0..PUSHES).map(|doublings| size * f64::from(1 << doublings)) {
            for push in [push, -push] {
                let energy = self.system.energy(&beside(&saddle.x, &mode, push));
                let energy = energy.unwrap_or(f64::INFINITY);
                let tie = TIE * energy.abs() + self.system.energy_rounding();
                if energy < lowest.0 - tie {
                    lowest = (energy, push);
                }
            }
        }
        Ok(State { x: beside(&saddle.x, &mode, lowest.1), load: saddle.load })
    }

    /// The largest displacement of the path so far.
    fn reach_of(&self, x: &[f64]) -> f64 {
        let multipliers = self.system.multipliers();
        let moved = x.iter().zip(&self.points[0].x).map(|(x, start)| (x - start).abs());
        let moved = moved.enumerate().filter(|(i, _)| !multipliers.contains(i));
        moved.fold(0.0_f64, |largest, (_, moved)| largest.max(moved))
    }

    fn mean_diagonal(&mut self, state: &State) -> Result<f64, SolverFailure> {
        self.system.set_load(state.load);
        self.system.make_room(&state.x);
        let mut entries = vec![0.0; self.system.pattern().stored()];
        let mut residual = vec![0.0; state.x.len()];
        if self.system.tangent(&state.x, &mut residual, &mut entries).is_err() {
            return Ok(self.system.force_scale());
        }
        let diagonal: Vec<f64> = self.system.pattern().diagonal().map(|at| entries[at]).collect();
        Ok(mean_diagonal(diagonal.into_iter(), &self.system.multipliers()))
    }
}

fn beside(x: &[f64], mode: &[f64], push: f64) -> Vec<f64> {
    x.iter().zip(mode).map(|(x, mode)| x + push * mode).collect()
}

/// The first damping, as a share of the mean diagonal.
const FIRST_DAMPING: f64 = 1e-3;
/// Over the first: where even this does not help, nothing does.
const MOST_DAMPING: f64 = 1e6;
const MOST_STEPS: usize = 100;
/// A step of the motion need not be solved as well as an equilibrium.
const LOOSE: f64 = 1e3;
const FEW_ITERATIONS: usize = 12;
/// Barriers that fold about each other are indefinite on the way, however strong the damping.
const FEW_SHIFTED: usize = 3;
/// More would be a part that chatters.
const MOST_SNAPS: usize = 20;
/// Half the first shift of a saddle's tangent, as a share of its mean diagonal, and how often it is doubled.
const FIRST_SHIFT: f64 = 1e-9;
const SHIFTS: usize = 34;
const MODE_ITERATIONS: usize = 20;
/// The first push along the critical mode, as a share of the largest displacement so far, and how many are tried, each twice
/// the one before.
const PUSH: f64 = 1e-3;
const PUSHES: u32 = 11;
/// Energies that differ by less are equal.
const TIE: f64 = 1e-12;
