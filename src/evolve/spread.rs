//! How steady and how even a front is.
//!
//! ```text
//! spread = (mu + sigma) / (mu + Q d)
//! d, sigma: mean and standard deviation of the Q finite crowding distances; mu: how far the front's ends have moved
//! ```
//!
//! Source: MATLAB's documentation of `gamultiobj`.

use super::crowding::crowding_distances;

/// The spread of a front, from its `objectives [member][objective]` and those of the front `before` it; smaller is steadier and
/// more even. 0 where the front has neither inner members nor ends that moved.
///
/// # Panics
/// When the members differ in their number of objectives.
#[must_use]
pub fn spread(objectives: &[&[f64]], before: &[&[f64]]) -> f64 {
    let inner: Vec<f64> =
        crowding_distances(objectives).into_iter().filter(|d| d.is_finite()).collect();
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
fn ends<'a>(front: &'a [&'a [f64]]) -> impl Iterator<Item = &'a [f64]> {
    let objectives = front.first().map_or(0, |member| member.len());
    (0..objectives).filter_map(move |m| front.iter().copied().min_by(|a, b| a[m].total_cmp(&b[m])))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spread_by_hand() {
        // Inner crowding distances 2/4 + 3/4 = 1.25 and 3/4 + 2/4 = 1.25: even. The ends stay, then one moves by 5.
        let front: [&[f64]; 4] = [&[0.0, 4.0], &[1.0, 2.0], &[2.0, 1.0], &[4.0, 0.0]];
        approx::assert_abs_diff_eq!(spread(&front, &front), 0.0, epsilon = 1e-15);
        let before: [&[f64]; 2] = [&[3.0, 8.0], &[4.0, 0.0]];
        approx::assert_relative_eq!(spread(&front, &before), 5.0 / 7.5, max_relative = 1e-14);
        // Distances (1 + 3)/4 + (4 - 1)/4 ... of an uneven front: 0.75 + 0.75 and 0.75 + 0.5.
        let uneven: [&[f64]; 4] = [&[0.0, 4.0], &[1.0, 2.0], &[3.0, 1.0], &[4.0, 0.0]];
        let (mean, deviation) = (1.375, 0.125);
        let expected = deviation / (2.0 * mean);
        approx::assert_relative_eq!(spread(&uneven, &uneven), expected, max_relative = 1e-14);
    }

    #[test]
    fn fronts_without_inner_members() {
        assert_eq!(spread(&[], &[]), 0.0);
        assert_eq!(spread(&[&[1.0, 2.0]], &[]), 0.0);
        assert_eq!(spread(&[&[1.0, 2.0]], &[&[4.0, 6.0]]), 1.0);
    }
}
