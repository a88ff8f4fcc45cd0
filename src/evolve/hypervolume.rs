//! How good a front of two objectives is, in one number.
//!
//! ```text
//! HV = area of { z : some point p has p <= z <= reference }
//! ```
//!
//! Both objectives are made small, so a larger area is a better front. The area is exact, but it is a property of
//! the reference point too: only values with the same one can be compared.
//! Source: Zitzler, Thiele (1999), IEEE Trans. Evol. Comput. 3:257-271.

/// The area that `points [n]` dominate below `reference`, in the product of the objectives' units.
///
/// Points that are dominated, or not better than the reference in both objectives, add nothing.
///
/// # Panics
/// When a number is not finite.
#[must_use]
pub fn hypervolume(points: &[[f64; 2]], reference: [f64; 2]) -> f64 {
    assert!(
        points.iter().chain([&reference]).flatten().all(|number| number.is_finite()),
        "points and reference are finite"
    );
    let mut points: Vec<[f64; 2]> = points
        .iter()
        .copied()
        .filter(|point| point[0] < reference[0] && point[1] < reference[1])
        .collect();
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut area = 0.0;
    let mut ceiling = reference[1];
    for [first, second] in points {
        if second < ceiling {
            area += (reference[0] - first) * (ceiling - second);
            ceiling = second;
        }
    }
    area
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn boxes_and_staircases() {
        assert_eq!(hypervolume(&[], [1.0, 1.0]), 0.0);
        assert_eq!(hypervolume(&[[0.0, 0.0]], [2.0, 3.0]), 6.0);
        // 3 x 1 + 2 x 1 + 1 x 1 below (4, 4).
        let staircase = [[3.0, 1.0], [1.0, 3.0], [2.0, 2.0]];
        assert_eq!(hypervolume(&staircase, [4.0, 4.0]), 6.0);
        assert_eq!(hypervolume(&[[5.0, 0.0], [0.0, 4.0]], [4.0, 4.0]), 0.0);
        assert_eq!(hypervolume(&[[-1.0, -1.0]], [0.0, 0.0]), 1.0);
    }

    #[test]
    fn dominated_points_and_twins_add_nothing() {
        let front = [[1.0, 3.0], [2.0, 2.0]];
        let more = [[2.0, 2.0], [1.0, 3.0], [2.5, 2.5], [1.0, 3.5], [2.0, 2.0]];
        assert_eq!(hypervolume(&front, [4.0, 4.0]), hypervolume(&more, [4.0, 4.0]));
    }

    #[test]
    fn a_fine_front_fills_the_area_under_its_curve() {
        // f2 = 1 - f1 on n + 1 even points: the unit square less its lower half, less n steps of 1/(2 n^2).
        let n = 1000;
        let line: Vec<[f64; 2]> =
            (0..=n).map(|i| f64::from(i) / f64::from(n)).map(|t| [t, 1.0 - t]).collect();
        let expected = 0.5 - 0.5 / f64::from(n);
        // A thousand terms of rounding error 1e-16 each.
        approx::assert_abs_diff_eq!(hypervolume(&line, [1.0, 1.0]), expected, epsilon = 1e-13);
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
            prop_assert_eq!(hypervolume(&points, [8.0, 8.0]), cells as f64);
        }
    }
}
