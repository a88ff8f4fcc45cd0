//! How alone an individual is on its front.
//!
//! ```text
//! d_i = sum over objectives m of (f_m of the next - f_m of the one before) / (max f_m - min f_m)
//! ```
//!
//! The first and the last in any objective are infinitely alone. An objective that is the same for all adds nothing.
//! Source: Deb et al. (2002), section III.B.

/// The crowding distance of each member of one front, from its `objectives [member][objective]`.
///
/// Equal values keep the order in which they are given.
///
/// # Panics
/// When the members differ in their number of objectives.
#[must_use]
pub fn crowding_distances(objectives: &[&[f64]]) -> Vec<f64> {
    let mut distances = vec![0.0; objectives.len()];
    let Some(first) = objectives.first() else { return distances };
    for m in 0..first.len() {
        let value = |member: usize| objectives[member][m];
        let mut order: Vec<usize> = (0..objectives.len()).collect();
        order.sort_by(|a, b| value(*a).total_cmp(&value(*b)));
        let (lowest, highest) = (order[0], order[order.len() - 1]);
        let range = value(highest) - value(lowest);
        if range == 0.0 {
            continue;
        }
        distances[lowest] = f64::INFINITY;
        distances[highest] = f64::INFINITY;
        for neighbours in order.windows(3) {
            distances[neighbours[1]] += (value(neighbours[2]) - value(neighbours[0])) / range;
        }
    }
    distances
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_by_hand() {
        // Ranges 8 and 10. Second: (3-0)/8 + (10-4)/10; third: (8-1)/8 + (6-0)/10; both to rounding.
        let front: [&[f64]; 4] = [&[0.0, 10.0], &[1.0, 6.0], &[3.0, 4.0], &[8.0, 0.0]];
        let d = crowding_distances(&front);
        assert!(d[0].is_infinite() && d[3].is_infinite());
        approx::assert_relative_eq!(d[1], 0.375 + 0.6, max_relative = 1e-15);
        approx::assert_relative_eq!(d[2], 0.875 + 0.6, max_relative = 1e-15);
    }

    #[test]
    fn distances_do_not_depend_on_order_and_units() {
        let front: [&[f64]; 4] = [&[0.0, 10.0], &[1.0, 6.0], &[3.0, 4.0], &[8.0, 0.0]];
        // A power of two scales without rounding.
        let other: [&[f64]; 4] = [&[12.0, 4.0], &[32.0, 0.0], &[0.0, 10.0], &[4.0, 6.0]];
        let (d, e) = (crowding_distances(&front), crowding_distances(&other));
        assert_eq!([d[2], d[3], d[0], d[1]], e[..]);
    }

    #[test]
    fn fronts_without_extent() {
        assert!(crowding_distances(&[]).is_empty());
        assert_eq!(crowding_distances(&[&[1.0, 2.0]]), [0.0]);
        assert_eq!(crowding_distances(&[&[1.0, 2.0][..]; 3]), [0.0; 3]);
        let pair: [&[f64]; 2] = [&[0.0, 1.0], &[1.0, 0.0]];
        assert_eq!(crowding_distances(&pair), [f64::INFINITY; 2]);
    }
}
