//! Where between two states the limit of the material is met.
//!
//! ```text
//! share(drive) = 1 - ACCURACY / 2          by the Illinois method: the secant of a bracket, the weight of an end that stays halved
//! ```
//!
//! A state is at the limit where its share is from `1 - ACCURACY` to 1: on the safe side. The share is 0 at rest and grows about as the
//! drive does, so the drive is known as well, to about `ACCURACY` of it; better where the part gives way, and worse, in proportion, where
//! it stiffens.
//!
//! Source: Dowell & Jarratt (1971), a modified regula falsi method.

/// How near to the limit a state at the limit is, as a share of it.
const ACCURACY: f64 = 1e-4;
/// The width of a bracket that is not worth being searched, as a share of the larger end.
const CLOSED: f64 = 1e-6;
const MOST_TRIES: usize = 40;

/// Whether more than the limit is used; also of a share that is no number.
pub(super) fn is_past_limit(share: f64) -> bool {
    share.is_nan() || share > 1.0
}

/// Whether the limit is used up, and not passed.
pub(super) fn is_at_limit(share: f64) -> bool {
    (1.0 - ACCURACY..=1.0).contains(&share)
}

/// A bracket of the drive at which the limit is met.
#[derive(Clone, Debug)]
pub(super) struct LimitSearch {
    /// An end within the limit, and one past it.
    ends: [End; 2],
    /// The end that the last try replaced.
    moved: Option<usize>,
    tries: usize,
}

#[derive(Clone, Copy, Debug)]
struct End {
    drive: f64,
    /// What the share has too much, weighed.
    excess: f64,
}

impl End {
    fn new(drive: f64, share: f64) -> Self {
        let excess = share - (1.0 - 0.5 * ACCURACY);
        Self { drive, excess: if excess.is_finite() { excess } else { 1.0 } }
    }
}

impl LimitSearch {
    /// Between a drive and share within the limit and others past it.
    pub(super) fn new(within: [f64; 2], past: [f64; 2]) -> Self {
        let ends = [within, past].map(|[drive, share]| End::new(drive, share));
        Self { ends, moved: None, tries: 0 }
    }

    /// The drive to be tried next; none where nothing is left between the ends.
    pub(super) fn next(&mut self) -> Option<f64> {
        let [within, past] = self.ends;
        let width = past.drive - within.drive;
        let is_closed = width.abs() <= CLOSED * past.drive.abs().max(within.drive.abs());
        if is_closed || self.tries == MOST_TRIES {
            return None;
        }
        self.tries += 1;
        let share = -within.excess / (past.excess - within.excess);
        // An end that is tried again teaches nothing.
        let share = if share.is_finite() { share.clamp(CLOSED, 1.0 - CLOSED) } else { 0.5 };
        Some(within.drive + share * width)
    }

    /// Takes the `share` found at a `drive` tried.
    pub(super) fn found(&mut self, drive: f64, share: f64) {
        let end = End::new(drive, share);
        let moves = usize::from(is_past_limit(share));
        if self.moved == Some(moves) {
            self.ends[1 - moves].excess *= 0.5;
        }
        self.ends[moves] = end;
        self.moved = Some(moves);
    }

    /// Takes that nothing was found at the `drive` tried: what is left of the bracket lies before it.
    pub(super) fn missed(&mut self, drive: f64) {
        let [within, past] = &mut self.ends;
        past.drive = 0.5 * (within.drive + drive);
        // Of what is there nothing is known: the middle is next.
        past.excess = -within.excess;
        self.moved = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The drive at which `share` comes to the limit, and how many tries it took.
    fn found(share: impl Fn(f64) -> f64, past: f64) -> (Option<f64>, usize) {
        let mut search = LimitSearch::new([0.0, share(0.0)], [past, share(past)]);
        while let Some(drive) = search.next() {
            if is_at_limit(share(drive)) {
                return (Some(drive), search.tries);
            }
            search.found(drive, share(drive));
        }
        (None, search.tries)
    }

    /// Shares that grow as a line, a square, a square root, and with a kink, in a few tries each; a vacuum's drive falls.
    #[test]
    fn the_limit_is_met_in_a_few_tries() {
        let kinked = |p: f64| if p < 0.5 { p } else { 0.5 + 20.0 * (p - 0.5) };
        for (share, exact, past) in [
            (&(|p: f64| 2.5 * p) as &dyn Fn(f64) -> f64, 0.4, 1.0),
            (&|p: f64| 4.0 * p * p, 0.5, 3.0),
            (&|p: f64| (2.0 * p).sqrt(), 0.5, 0.7),
            (&kinked, 0.525, 1.0),
            (&|p: f64| -2.5 * p, -0.4, -1.0),
        ] {
            let (drive, tries) = found(share, past);
            // The share's accuracy times the drive over the share's own power of it, 2 at most.
            assert!((drive.unwrap() / exact - 1.0).abs() < 2.0 * ACCURACY, "{drive:?} {exact}");
            assert!(tries <= 12, "{tries}");
        }
    }

    /// A share that jumps over the limit has no state at it; the bracket closes about the jump.
    #[test]
    fn a_jump_ends_the_search() {
        let (drive, tries) = found(|p| if p < 0.3 { p } else { 2.0 }, 1.0);
        assert_eq!(drive, None);
        assert!(tries <= MOST_TRIES);
        let mut search = LimitSearch::new([0.2, 0.5], [0.4, 1.5]);
        search.missed(0.3);
        assert!((search.next().unwrap() - 0.225).abs() < 1e-12);
    }
}
