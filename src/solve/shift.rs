//! How an indefinite tangent is shifted, shared by every solver: `K + sigma I`.

use std::iter;
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

/// The shifts to try in turn, none first, for a tangent whose diagonal has this mean size.
pub(super) fn shifts(mean_diagonal: f64) -> impl Iterator<Item = f64> {
    let grown = |&shift: &f64| Some(SHIFT_GROWTH * shift);
    let growing = iter::successors(Some(FIRST_SHIFT * mean_diagonal), grown);
    iter::once(0.0).chain(growing.take(MOST_SHIFTS))
}

/// First shift as a fraction of the mean diagonal: small enough to keep Newton's speed beside a limit point.
const FIRST_SHIFT: f64 = 1e-5;
const SHIFT_GROWTH: f64 = 4.0;
/// The last shift is 3e12 times the mean diagonal, which no finite tangent outweighs.
const MOST_SHIFTS: usize = 30;
