//! How an indefinite tangent is shifted, shared by every solver: `K + sigma I`.

/// First shift as a fraction of the mean diagonal: small enough to keep Newton's speed beside a limit point.
pub(super) const FIRST_SHIFT: f64 = 1e-5;
/// Growth of the shift from one try to the next.
pub(super) const SHIFT_GROWTH: f64 = 4.0;
/// Tries; the last shift is 1e13 times the mean diagonal, which no finite tangent outweighs.
pub(super) const MOST_SHIFTS: usize = 30;
