//! The end of a path at the limit of the material: the state at which the wall bears what it may, and no more.
//!
//! A step whose equilibrium is past the limit is believed as any other; then the state at the limit is searched between both ends
//! ([`LimitSearch`]), from the cubic through them. A limit is no bound of the model: where a part loses its stability first, that is its
//! ending, and what it passes on its fall does not count. Where the state in which it comes to rest is past the limit, the path ends
//! before the snap.

use super::SolverFailure;
use super::ending::Ending;
use super::limit_search::{LimitSearch, is_at_limit, is_past_limit};
use super::path::PathPoint;
use super::walk::{Missed, PATIENCE, Walk};

impl Walk<'_> {
    /// How much of the limit of the material is used at `x`; 0 where there is none.
    pub(super) fn share_used(&self, x: &[f64]) -> f64 {
        self.system.utilization(x).map_or(0.0, |used| used.share)
    }

    /// Goes on from the last point to the state at the limit of the material, which comes before the equilibrium `past` it.
    pub(super) fn reach_limit(&mut self, past: PathPoint) -> Result<Ending, SolverFailure> {
        let (from, share) = (self.last().drive, self.share_used(&self.last().x));
        if is_at_limit(share) {
            return Ok(self.end_at_limit());
        }
        let mut search = LimitSearch::new([from, share], [past.drive, self.share_used(&past.x)]);
        self.ahead = vec![past];
        let mut nearest = None;
        while let Some(drive) = search.next() {
            self.system.rewind();
            self.attempted = self.spent;
            let guess = self.prediction(drive, true);
            let point = match self.equilibrium(drive, guess, PATIENCE)? {
                Ok(point) => point,
                Err(Missed { past_limit: Some(point), .. }) => *point,
                Err(Missed { ending, .. }) if ending.is_given_up() => return Ok(ending),
                Err(_) => {
                    search.missed(drive);
                    continue;
                }
            };
            let share = self.share_used(&point.x);
            if is_at_limit(share) {
                self.accept(PathPoint { is_sample: true, ..point });
                return Ok(self.end_at_limit());
            }
            search.found(drive, share);
            if is_past_limit(share) {
                self.ahead = vec![point];
            } else {
                nearest = Some(point);
            }
        }
        // It jumps over the limit, within the smallest difference of the drive.
        self.system.rewind();
        if let Some(point) = nearest {
            self.system.refresh(&point.x);
            self.accept(PathPoint { is_sample: true, ..point });
        }
        Ok(self.end_at_limit())
    }

    /// Ends the path at its last point, which becomes a sample.
    pub(super) fn end_at_limit(&mut self) -> Ending {
        let last = self.points.last_mut().expect("the start is accepted first");
        last.is_sample = true;
        self.place = self.system.utilization(&last.x).map(|used| used.unknown);
        Ending::LimitReached
    }
}
