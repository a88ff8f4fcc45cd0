//! How far a path is, a line now and then, for who waits before a terminal or reads a log.

use std::time::{Duration, Instant};

use super::terminal::narrate;
use crate::solve::{PathPoint, Programme};

/// Says at most every few seconds where a path is.
pub(super) struct WalkProgress {
    programme: Programme,
    /// Of the drive at rest.
    start: Option<f64>,
    begun: Instant,
    said: Instant,
    states: usize,
}

/// Who waits longer than this for a word wonders.
const PATIENCE: Duration = Duration::from_secs(5);

impl WalkProgress {
    /// Of a path through `programme`.
    pub(super) fn new(programme: Programme) -> Self {
        let now = Instant::now();
        Self { programme, start: None, begun: now, said: now, states: 0 }
    }

    /// Takes note of an accepted state.
    pub(super) fn note(&mut self, point: &PathPoint) {
        self.start.get_or_insert(point.drive);
        self.states += 1;
        if self.said.elapsed() >= PATIENCE {
            self.said = Instant::now();
            narrate(&self.line(point));
        }
    }

    fn line(&self, point: &PathPoint) -> String {
        let share = match (self.programme, self.start) {
            (Programme::Driven { end, .. }, Some(start)) if end != start => {
                format!("{:.0} % of the way, ", 100.0 * (point.drive - start) / (end - start))
            }
            _ => String::new(),
        };
        let (load, seconds) = (point.load, self.begun.elapsed().as_secs());
        format!("walking: {share}state {} at load {load:.4}, after {seconds} s", self.states)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_says_how_far_a_path_is() {
        let mut progress = WalkProgress::new(0.2.into());
        progress.note(&PathPoint::at_rest(0.0, 0));
        let point = PathPoint { load: 0.05, ..PathPoint::at_rest(0.05, 0) };
        progress.note(&point);
        let line = progress.line(&point);
        assert_eq!(line, "walking: 25 % of the way, state 2 at load 0.0500, after 0 s");
        let curve = WalkProgress::new(Programme::Curve { end: 1.0 });
        assert_eq!(curve.line(&point), "walking: state 0 at load 0.0500, after 0 s");
    }
}
