//! How steady and how even a front is, and what mutations that adapt learn from it.
//!
//! ```text
//! spread = (mu + sigma) / (mu + Q d)
//! d, sigma: mean and standard deviation of the Q finite crowding distances; mu: how far the front's ends have moved
//! ```
//!
//! Source: MATLAB's documentation of `gamultiobj`.

use serde::{Deserialize, Serialize};

use super::crowding::crowding_distances;

/// The spread of a front, from its `objectives [member][objective]` and those of the front `before` it; smaller is steadier and
/// more even. 0 where the front has neither inner members nor ends that moved.
///
/// # Panics
/// When the members differ in their number of objectives.
#[must_use]
pub fn spread(objectives: &[Vec<f64>], before: &[Vec<f64>]) -> f64 {
    let members: Vec<&[f64]> = objectives.iter().map(Vec::as_slice).collect();
    let inner: Vec<f64> =
        crowding_distances(&members).into_iter().filter(|d| d.is_finite()).collect();
    let count = inner.len().max(1) as f64;
    let mean = inner.iter().sum::<f64>() / count;
    let deviation = (inner.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / count).sqrt();
    let moved = ends(objectives)
        .zip(ends(before))
        .map(|(end, old)| end.iter().zip(old).map(|(x, y)| (x - y).powi(2)).sum::<f64>().sqrt())
        .sum::<f64>();
    let whole = moved + inner.len() as f64 * mean;
    if whole > 0.0 { (moved + deviation) / whole } else { 0.0 }
}

/// The best member in each objective; none of an empty front.
fn ends(front: &[Vec<f64>]) -> impl Iterator<Item = &Vec<f64>> {
    let objectives = front.first().map_or(0, Vec::len);
    (0..objectives).filter_map(|m| front.iter().min_by(move |a, b| a[m].total_cmp(&b[m])))
}

/// What a run remembers of the generation before, for mutations that adapt.
///
/// ```text
/// step: 1 up to generation 2, then four times longer when the spread rose (1 at most), or a quarter when it fell (sqrt(eps) at least)
/// ```
/// Source: MATLAB's `mutationadaptfeasible`, as described by its users.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Adaptation {
    /// Of a mutation, in widths of the bounds.
    pub step: f64,
    /// Of the last front, 0 before the first.
    pub spread: f64,
}

impl Adaptation {
    pub(super) const FIRST: Self = Self { step: 1.0, spread: 0.0 };

    /// After `generation` has ended with a front of this `spread`.
    pub(super) fn next(self, generation: usize, spread: f64) -> Self {
        let step = if generation < 2 || spread == self.spread {
            self.step
        } else if spread > self.spread {
            (4.0 * self.step).min(1.0)
        } else {
            (0.25 * self.step).max(f64::EPSILON.sqrt())
        };
        Self { step, spread }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spread_by_hand() {
        // Inner crowding distances 2/4 + 3/4 = 1.25 and 3/4 + 2/4 = 1.25: even. The ends stay, then one moves by 5.
        let front = [vec![0.0, 4.0], vec![1.0, 2.0], vec![2.0, 1.0], vec![4.0, 0.0]];
        approx::assert_abs_diff_eq!(spread(&front, &front), 0.0, epsilon = 1e-15);
        let before = [vec![3.0, 8.0], vec![4.0, 0.0]];
        approx::assert_relative_eq!(spread(&front, &before), 5.0 / 7.5, max_relative = 1e-14);
        // Of an uneven front 3/4 + 3/4 and 3/4 + 2/4.
        let uneven = [vec![0.0, 4.0], vec![1.0, 2.0], vec![3.0, 1.0], vec![4.0, 0.0]];
        let (mean, deviation) = (1.375, 0.125);
        let expected = deviation / (2.0 * mean);
        approx::assert_relative_eq!(spread(&uneven, &uneven), expected, max_relative = 1e-14);
    }

    #[test]
    fn fronts_without_inner_members() {
        assert_eq!(spread(&[], &[]), 0.0);
        assert_eq!(spread(&[vec![1.0, 2.0]], &[]), 0.0);
        assert_eq!(spread(&[vec![1.0, 2.0]], &[vec![4.0, 6.0]]), 1.0);
    }

    #[test]
    fn steps_grow_while_the_spread_rises_and_shrink_while_it_falls() {
        let mut adaptation = Adaptation::FIRST;
        let mut steps = Vec::new();
        for (generation, spread) in [0.9, 0.5, 0.4, 0.3, 0.3, 0.6, 0.7, 0.8].into_iter().enumerate()
        {
            adaptation = adaptation.next(generation, spread);
            steps.push(adaptation.step);
        }
        assert_eq!(steps, [1.0, 1.0, 0.25, 0.0625, 0.0625, 0.25, 1.0, 1.0]);
        for generation in 2..40 {
            adaptation = adaptation.next(generation, 1.0 / generation as f64);
        }
        assert_eq!(adaptation.step, f64::EPSILON.sqrt());
    }
}
