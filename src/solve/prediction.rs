//! Where the next state of a path is looked for first.

use super::hermite::{cubic_step, tangent_step};
use super::path::PathPoint;
use super::supply::Supply;
use super::vectors::dot;
use super::walk::{State, Walk};
use crate::model::system::LoadedSystem;

impl Walk<'_> {
    /// The best (see [`best_prediction`]) of tangent, cubic, and cubic to what is known ahead, where that is to be looked at; the
    /// last state where none is admissible.
    pub(super) fn prediction(&mut self, drive: f64, looks_ahead: bool) -> State {
        let last = self.last();
        let step = drive - last.drive;
        let mut candidates = vec![tangent_step(last, step)];
        if let [.., before, last] = self.points.as_slice()
            && last.snap.is_none()
        {
            candidates.push(cubic_step(before, last, step));
        }
        let distance = |ahead: &&PathPoint| (ahead.drive - last.drive).abs();
        let nearest = self.ahead.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        if let Some(ahead) = nearest.filter(|_| looks_ahead) {
            candidates.push(cubic_step(ahead, last, step));
        }
        let start = State { x: last.x.clone(), load: last.load };
        let is_minimum = self.supply == Supply::Load
            && self.system.is_conservative()
            && self.system.multipliers().is_empty();
        best_prediction(self.system, start, candidates, is_minimum)
    }
}

/// The admissible one of `steps` (of state and load) from `start` that is the nearest to an equilibrium; `start` where none is.
///
/// That is the one of the least energy where `by_energy`: where all have one load, and the equilibrium is a minimum. An energy costs half
/// as much as a residual. Else it is the one of the smallest residual.
pub(super) fn best_prediction(
    system: &mut dyn LoadedSystem,
    start: State,
    steps: Vec<(Vec<f64>, f64)>,
    by_energy: bool,
) -> State {
    let mut best = start.clone();
    let mut residual = vec![0.0; start.x.len()];
    let mut least = f64::INFINITY;
    for (dx, dload) in steps {
        let length = system.longest_step(&start.x, &dx);
        let x: Vec<f64> = start.x.iter().zip(&dx).map(|(x, dx)| x + length * dx).collect();
        let load = start.load + length * dload;
        system.set_load(load);
        let distance = if by_energy {
            system.energy(&x)
        } else {
            system.residual(&x, &mut residual).map(|_| dot(&residual, &residual))
        };
        if let Ok(distance) = distance
            && distance < least
        {
            (least, best) = (distance, State { x, load });
        }
    }
    best
}
