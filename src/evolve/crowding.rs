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

/// The `count` members of one front that lie most evenly, from its `objectives [member][objective]`, in ascending order.
///
/// The most crowded leaves, again and again: the one with the smallest product of the distances to its nearest neighbours, as many
/// as there are objectives, each scaled to its range. All at once, two neighbours would both leave for being close to each other,
/// and beyond two objectives [`crowding_distances`] see neighbours that are far away. The first and the last in any objective stay
/// longest; of equals the last leaves.
///
/// Source: Kukkonen & Deb (2006), "A fast and effective method for pruning of non-dominated solutions in many-objective problems",
/// PPSN IX.
///
/// # Panics
/// When the members differ in their number of objectives.
#[must_use]
pub fn most_even(objectives: &[&[f64]], count: usize) -> Vec<usize> {
    let size = objectives.len();
    let mut kept: Vec<usize> = (0..size).collect();
    let Some(first) = objectives.first().filter(|_| count < size) else { return kept };
    let distances = scaled_distances(objectives);
    let is_end: Vec<bool> =
        crowding_distances(objectives).iter().map(|d| d.is_infinite()).collect();
    let near = |member: usize, kept: &[usize]| -> Vec<usize> {
        let mut others: Vec<usize> = kept.iter().copied().filter(|&one| one != member).collect();
        let wanted = first.len().min(others.len());
        let by_distance = |a: &usize, b: &usize| {
            distances[member * size + a].total_cmp(&distances[member * size + b])
        };
        if wanted < others.len() {
            others.select_nth_unstable_by(wanted, by_distance);
        }
        others.truncate(wanted);
        others
    };
    let mut neighbours: Vec<Vec<usize>> = (0..size).map(|member| near(member, &kept)).collect();
    while kept.len() > count {
        let room = |&at: &usize| -> f64 {
            let member = kept[at];
            let product = neighbours[member].iter().map(|one| distances[member * size + one]);
            if is_end[member] { f64::INFINITY } else { product.product() }
        };
        let crowded = (0..kept.len()).rev().min_by(|a, b| room(a).total_cmp(&room(b)));
        let gone = kept.remove(crowded.expect("there are more than wanted"));
        for &member in &kept {
            if neighbours[member].contains(&gone) {
                neighbours[member] = near(member, &kept);
            }
        }
    }
    kept
}

/// The squared distances between all members, each objective scaled to its range `[size * size]`.
fn scaled_distances(objectives: &[&[f64]]) -> Vec<f64> {
    let size = objectives.len();
    let mut distances = vec![0.0; size * size];
    for m in 0..objectives[0].len() {
        let values = objectives.iter().map(|member| member[m]);
        let lowest = values.clone().fold(f64::INFINITY, f64::min);
        let range = values.fold(f64::NEG_INFINITY, f64::max) - lowest;
        if range == 0.0 {
            continue;
        }
        for (a, row) in distances.chunks_exact_mut(size).enumerate() {
            for (distance, other) in row.iter_mut().zip(objectives) {
                *distance += ((objectives[a][m] - other[m]) / range).powi(2);
            }
        }
    }
    distances
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_two_neighbours_one_stays() {
        // On a line; 4.0 and 4.1 are each other's neighbours, and both more crowded than 8.0 as long as both are there.
        let places = [0.0, 4.0, 4.1, 8.0, 9.0_f64, 10.0];
        let front = places.map(|x| [x, 10.0 - x]);
        let front: Vec<&[f64]> = front.iter().map(|point| &point[..]).collect();
        // Distances to the two nearest: 4.0 * 0.1, 0.1 * 3.9, 1.0 * 2.0, 1.0 * 1.0; then 4.0 * 4.0, 1.0 * 2.0, 1.0 * 1.0; then 4.0 * 4.0
        // and 4.0 * 2.0. All at once, both 4.0 and 4.1 would leave first.
        let expected: [&[usize]; 5] = [&[0, 1, 3, 4, 5], &[0, 1, 3, 5], &[0, 1, 5], &[0, 5], &[0]];
        for (left, expected) in expected.into_iter().enumerate() {
            assert_eq!(most_even(&front, 5 - left), expected);
        }
        assert_eq!(most_even(&front, 9), [0, 1, 2, 3, 4, 5]);
        assert!(most_even(&[], 0).is_empty());
    }

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
