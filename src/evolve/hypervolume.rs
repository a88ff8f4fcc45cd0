//! How good a front is, in one number.
//!
//! ```text
//! HV = volume of { z : some point p has p <= z <= reference in every objective }
//! ```
//!
//! All objectives are made small, so a larger volume is a better front. It is exact, but it is a property of the reference point too:
//! only values with the same one can be compared. Of two objectives it is a sum of rectangles; of more, of slices along the last one
//! (Zitzler, Thiele 1999, IEEE Trans. Evol. Comput. 3:257-271; While et al. 2006, IEEE Trans. Evol. Comput. 10:29-38).

/// The volume that `points` dominate below `reference`, in the product of the objectives' units.
///
/// Points that are dominated, or not better than the reference in every objective, add nothing. With `n` points of `m` objectives it
/// takes some `n^(m-1)` operations.
///
/// # Panics
/// When a number is not finite, points and reference are not of one length, or there are fewer than two objectives.
#[must_use]
pub fn hypervolume<P: AsRef<[f64]>>(points: &[P], reference: &[f64]) -> f64 {
    let points: Vec<&[f64]> = points.iter().map(AsRef::as_ref).collect();
    assert!(reference.len() >= 2, "a front has at least two objectives");
    assert!(
        points.iter().all(|point| point.len() == reference.len()),
        "points and reference are of one length"
    );
    assert!(
        points.iter().copied().chain([reference]).flatten().all(|number| number.is_finite()),
        "points and reference are finite"
    );
    let is_below = |point: &&[f64]| point.iter().zip(reference).all(|(one, most)| one < most);
    dominated(points.into_iter().filter(is_below).collect(), reference)
}

/// The volume below `reference` that `points`, which all lie below it, dominate.
fn dominated(mut points: Vec<&[f64]>, reference: &[f64]) -> f64 {
    let [first, second] = *reference else { return sliced(points, reference) };
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut area = 0.0;
    let mut ceiling = second;
    for point in points {
        if point[1] < ceiling {
            area += (first - point[0]) * (ceiling - point[1]);
            ceiling = point[1];
        }
    }
    area
}

/// As [`dominated`], from one point to the next along the last objective.
fn sliced(mut points: Vec<&[f64]>, reference: &[f64]) -> f64 {
    let last = reference.len() - 1;
    points.sort_by(|a, b| a[last].total_cmp(&b[last]));
    let slice = |k: usize| {
        let top = points.get(k + 1).map_or(reference[last], |next| next[last]);
        let height = top - points[k][last];
        if height == 0.0 {
            return 0.0;
        }
        let below: Vec<&[f64]> = points[..=k].iter().map(|point| &point[..last]).collect();
        height * dominated(below, &reference[..last])
    };
    (0..points.len()).map(slice).sum()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn boxes_and_staircases() {
        assert_eq!(hypervolume::<[f64; 2]>(&[], &[1.0, 1.0]), 0.0);
        assert_eq!(hypervolume(&[[0.0, 0.0]], &[2.0, 3.0]), 6.0);
        // 3 x 1 + 2 x 1 + 1 x 1 below (4, 4).
        let staircase = [[3.0, 1.0], [1.0, 3.0], [2.0, 2.0]];
        assert_eq!(hypervolume(&staircase, &[4.0, 4.0]), 6.0);
        assert_eq!(hypervolume(&[[5.0, 0.0], [0.0, 4.0]], &[4.0, 4.0]), 0.0);
        assert_eq!(hypervolume(&[[-1.0, -1.0]], &[0.0, 0.0]), 1.0);
    }

    #[test]
    fn dominated_points_and_twins_add_nothing() {
        let front = [[1.0, 3.0], [2.0, 2.0]];
        let more = [[2.0, 2.0], [1.0, 3.0], [2.5, 2.5], [1.0, 3.5], [2.0, 2.0]];
        assert_eq!(hypervolume(&front, &[4.0, 4.0]), hypervolume(&more, &[4.0, 4.0]));
    }

    #[test]
    fn a_fine_front_fills_the_area_under_its_curve() {
        // f2 = 1 - f1 on n + 1 even points: the unit square less its lower half, less n steps of 1/(2 n^2).
        let n = 1000;
        let line: Vec<[f64; 2]> =
            (0..=n).map(|i| f64::from(i) / f64::from(n)).map(|t| [t, 1.0 - t]).collect();
        let expected = 0.5 - 0.5 / f64::from(n);
        // A thousand terms of rounding error 1e-16 each.
        approx::assert_abs_diff_eq!(hypervolume(&line, &[1.0, 1.0]), expected, epsilon = 1e-13);
    }

    /// Two boxes of 2 x 2 x 2 and 3 x 1 x 1 that share 2 x 1 x 1; a third point has nothing below the reference.
    #[test]
    fn boxes_of_three_and_four_objectives() {
        let boxes = [[1.0, 1.0, 1.0], [0.0, 2.0, 2.0], [1.0, 1.0, 3.0]];
        assert_eq!(hypervolume(&boxes, &[3.0; 3]), 8.0 + 3.0 - 2.0);
        assert_eq!(hypervolume(&[[0.5, 0.0, 1.0, 1.5]], &[2.0; 4]), 1.5 * 2.0 * 1.0 * 0.5);
    }

    proptest! {
        #[test]
        fn area_is_the_count_of_dominated_cells(
            points in prop::collection::vec((0_u8..10, 0_u8..10), 0..12)
        ) {
            let points: Vec<[f64; 2]> =
                points.iter().map(|(a, b)| [f64::from(*a), f64::from(*b)]).collect();
            let cells = (0..8_u8)
                .flat_map(|i| (0..8_u8).map(move |j| [f64::from(i), f64::from(j)]))
                .filter(|cell| points.iter().any(|p| p[0] <= cell[0] && p[1] <= cell[1]))
                .count();
            prop_assert_eq!(hypervolume(&points, &[8.0, 8.0]), cells as f64);
        }

        #[test]
        fn volume_is_the_count_of_dominated_cubes(
            points in prop::collection::vec(prop::array::uniform3(0_u8..8), 0..10)
        ) {
            let cubes = (0..216_u8)
                .map(|k| [k / 36, k / 6 % 6, k % 6])
                .filter(|cube| points.iter().any(|p| p.iter().zip(cube).all(|(p, c)| p <= c)))
                .count();
            let points: Vec<[f64; 3]> = points.iter().map(|point| point.map(f64::from)).collect();
            prop_assert_eq!(hypervolume(&points, &[6.0; 3]), cubes as f64);
        }
    }
}
