//! How an indefinite tangent is shifted, shared by every solver: `K + sigma I`.
//!
//! ```text
//! sigma = 0, or the first of  s, 4 s, 16 s, ..   that leaves no more negative pivots than stable        s = 1e-5 mean|diag K|
//! ```
//!
//! Where a shift is enough, so is every larger one: the eigenvalues of `K + sigma I` rise with `sigma`. So the first that is enough lies
//! between one that is not and one that is, and the search begins beside the one found last: two factorisations where nothing has
//! changed, instead of one for each shift that is too small.

use std::ops::Range;

/// The mean size of a tangent's `diagonal [n]`, multipliers left out.
pub(super) fn mean_diagonal(
    diagonal: impl ExactSizeIterator<Item = f64>,
    multipliers: &Range<usize>,
) -> f64 {
    let count = diagonal.len() - multipliers.len();
    let sizes = diagonal.enumerate().filter(|(i, _)| !multipliers.contains(i));
    sizes.map(|(_, entry)| entry.abs()).sum::<f64>() / count as f64
}

/// The place of the shift found last in the list of shifts; 0 is none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct LastShift(usize);

impl LastShift {
    /// The smallest shift that `is_enough` for a tangent whose diagonal has this `mean` size, and none other than 0 where it must be
    /// `unshifted`; `None` where no shift is. `is_enough` is last called with the one returned.
    pub(super) fn smallest<E>(
        &mut self,
        mean: f64,
        unshifted: bool,
        mut is_enough: impl FnMut(f64) -> Result<bool, E>,
    ) -> Result<Option<f64>, E> {
        if unshifted {
            return Ok(is_enough(0.0)?.then_some(0.0));
        }
        let Some((found, tried_last)) = self.search(mean, &mut is_enough)? else {
            return Ok(None);
        };
        self.0 = found;
        let shift = shift(mean, found);
        // Its factor is to be the one at hand.
        if tried_last != found && !is_enough(shift)? {
            return Ok(None);
        }
        Ok(Some(shift))
    }

    /// The place of the smallest shift that is enough, and the place tried last.
    fn search<E>(
        self,
        mean: f64,
        is_enough: &mut impl FnMut(f64) -> Result<bool, E>,
    ) -> Result<Option<(usize, usize)>, E> {
        let mut place = self.0.saturating_sub(1);
        if !is_enough(shift(mean, place))? {
            while place < MOST_SHIFTS {
                place += 1;
                if is_enough(shift(mean, place))? {
                    return Ok(Some((place, place)));
                }
            }
            return Ok(None);
        }
        if place == 0 || is_enough(0.0)? {
            return Ok(Some((0, 0)));
        }
        // None is not enough, `place` is.
        let (mut lower, mut tried) = (0, 0);
        while place - lower > 1 {
            tried = lower.midpoint(place);
            if is_enough(shift(mean, tried))? {
                place = tried;
            } else {
                lower = tried;
            }
        }
        Ok(Some((place, tried)))
    }
}

/// The shift at a `place` in the list, for a tangent whose diagonal has this mean size.
fn shift(mean_diagonal: f64, place: usize) -> f64 {
    match place {
        0 => 0.0,
        _ => FIRST_SHIFT * mean_diagonal * SHIFT_GROWTH.powi(place as i32 - 1),
    }
}

/// First shift as a fraction of the mean diagonal: small enough to keep Newton's speed beside a limit point.
const FIRST_SHIFT: f64 = 1e-5;
/// A power of two, by which a shift grows without rounding.
const SHIFT_GROWTH: f64 = 4.0;
/// The last shift is 3e12 times the mean diagonal, which no finite tangent outweighs.
const MOST_SHIFTS: usize = 30;

#[cfg(test)]
mod tests {
    use std::convert::Infallible;

    use super::*;

    /// The shift that is found for each least shift of `wanted` in turn, and how many were tried in all.
    fn found(wanted: &[f64]) -> (Vec<Option<f64>>, usize) {
        let (mut last, mut tried) = (LastShift::default(), 0);
        let find = |&least: &f64| {
            let mut at_hand = None;
            let is_enough = |shift| {
                tried += 1;
                at_hand = Some(shift);
                Ok::<_, Infallible>(shift >= least)
            };
            let Ok(found) = last.smallest(1.0, false, is_enough);
            assert!(found.is_none() || found == at_hand, "the factor at hand is another");
            found
        };
        (wanted.iter().map(find).collect(), tried)
    }

    /// Whatever was found before, it is the first of `1e-5 * 4^k` that is no less than the least one: exactly, as the growth is a power
    /// of two.
    #[test]
    fn smallest_shift_is_found_from_every_other() {
        let first_of = |least: f64| {
            let mut shift = if least > 0.0 { 1e-5 } else { 0.0 };
            while shift < least {
                shift *= 4.0;
            }
            Some(shift)
        };
        let least = [0.0, 1e-6, 3e-5, 0.1, 7.0, 1e5];
        for before in least {
            for wanted in least {
                let (found, _) = found(&[before, wanted]);
                assert_eq!(found, [before, wanted].map(first_of), "{wanted} after {before}");
            }
        }
    }

    /// Two factorisations for each tangent that wants the shift of the one before, and one where none is wanted.
    #[test]
    fn shift_found_last_costs_two_factorisations() {
        let (_, once) = found(&[0.1]);
        let (_, often) = found(&[0.1; 11]);
        assert_eq!(often - once, 20);
        let (_, none) = found(&[0.0; 11]);
        assert_eq!(none, 11);
    }

    #[test]
    fn tangent_that_no_shift_helps_has_none() {
        assert_eq!(found(&[f64::INFINITY]).0, [None]);
    }
}
