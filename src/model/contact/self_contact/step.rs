//! How far two parts of a wall may move before they would touch.
//!
//! Additive continuous collision detection: no motion closes a gap faster than `speed`, so a step of `share gap / speed` is
//! free; the gap is measured there, and again, until less than `1 - share` of the first gap is left.
//! Source: Li, Kaufman, Jiang (2021), algorithm 1.

use super::distance::Closest;
use super::wall_surface::closing_speed;
use crate::math::Vec3;

/// The share of its gap that a pair may use up in one step.
const STEP_SHARE: f64 = 0.9;
/// Measurements of one pair; a step that wants more is shortened.
const MOST_MEASUREMENTS: usize = 100;

/// The largest multiple of the motion `dx`, at most `longest`, that keeps the four points, now at `x`, apart.
///
/// `first` of the points are on one side, and `thickness` is to be left between the closest points.
pub(super) fn longest_step(
    x: &[Vec3; 4],
    dx: &[Vec3; 4],
    first: usize,
    thickness: f64,
    closest: impl Fn(&[Vec3; 4]) -> Closest,
    longest: f64,
) -> f64 {
    let speed = closing_speed(dx, first);
    let gap_at = |step: f64| {
        let there: [Vec3; 4] = std::array::from_fn(|i| x[i] + step * dx[i]);
        closest(&there).distance - thickness
    };
    let at_start = gap_at(0.0);
    let (mut step, mut gap) = (0.0, at_start);
    for _ in 0..MOST_MEASUREMENTS {
        let next = step + STEP_SHARE * gap.max(0.0) / speed;
        if next >= longest || next.is_nan() {
            return longest;
        }
        gap = gap_at(next);
        if step > 0.0 && gap < (1.0 - STEP_SHARE) * at_start {
            break;
        }
        step = next;
    }
    step
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    /// Parts that cross in their motion stop before it; parts that pass by each other, or move together, do not.
    #[test]
    fn steps_end_before_a_touch() {
        let mut chance = ChaCha8Rng::seed_from_u64(3);
        let mut point = |size: f64| Vec3::from_fn(|_, _| chance.random_range(-1.0..1.0)) * size;
        let of_edges: fn(&[Vec3; 4]) -> Closest = Closest::of_edges;
        let of_facet: fn(&[Vec3; 4]) -> Closest = Closest::of_point_and_facet;
        let (mut shortened, mut whole) = (0, 0);
        for first in [1, 2] {
            let closest = if first == 1 { of_facet } else { of_edges };
            for _ in 0..300 {
                let x = [0; 4].map(|_| point(2.0));
                let dx = [0; 4].map(|_| point(3.0));
                let at = |a: f64| -> [Vec3; 4] { std::array::from_fn(|i| x[i] + a * dx[i]) };
                let thickness = 0.5 * closest(&x).distance;
                let step = longest_step(&x, &dx, first, thickness, closest, 1.0);
                let gap = |a: f64| closest(&at(a)).distance - thickness;
                assert!(0.0 < step && step <= 1.0);
                let least = (0..=400).map(|k| gap(step * f64::from(k) / 400.0));
                let least = least.fold(f64::INFINITY, f64::min);
                // A tenth of a tenth: between two measurements a gap may shrink once more.
                assert!(least >= 0.01 * gap(0.0), "{least}");
                if step < 1.0 {
                    shortened += 1;
                    // Not much farther the gap is used up.
                    let ahead = (0..200).map(|k| gap(step + 0.3 * f64::from(k) / 200.0));
                    let ahead = ahead.fold(f64::INFINITY, f64::min);
                    assert!(ahead < 0.2 * gap(0.0), "{ahead} {}", gap(0.0));
                } else {
                    whole += 1;
                }
                let moved = [point(1.0) * 50.0; 4];
                assert_eq!(longest_step(&x, &moved, first, thickness, closest, 1.0), 1.0);
            }
        }
        assert!(shortened > 100 && whole > 100, "{shortened} {whole}");
    }
}
