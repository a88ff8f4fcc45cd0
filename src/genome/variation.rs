//! How children are made: pure functions of parents, bounds and a source of chance.
//!
//! A genome made here lies within its bounds exactly. The functions do not check that the parents do.

use nalgebra::{DMatrix, DVector};
use rand::seq::SliceRandom;
use rand::{Rng, RngExt};

use super::bounds::Bounds;
use super::representation::Representation;

/// A genome `[gene]` drawn uniformly between the bounds.
#[must_use]
pub fn uniform_genome(bounds: &Bounds, rng: &mut impl Rng) -> Vec<f64> {
    bounds
        .intervals()
        .iter()
        .map(|(lower, upper)| {
            let u: f64 = rng.random();
            (lower + u * (upper - lower)).clamp(*lower, *upper)
        })
        .collect()
}

/// Two children `[gene]` of two parents `[gene]` by simulated binary crossover; each gene takes part with probability 1/2.
///
/// ```text
/// c1, c2 = (x1 + x2)/2 -+ b (x2 - x1)/2                                with x1 < x2
/// density of b ~ b^eta below 1, b^-(eta+2) above, cut at b_max = 1 + 2 min(x1 - lower, upper - x2) / (x2 - x1)
/// ```
///
/// The children have the parents' mean, gene by gene: the cut is that of the nearer bound on both sides.
/// Source: Deb, Agrawal (1999), "A niched-penalty approach for constraint handling in genetic algorithms", eq. (3).
#[must_use]
pub fn sbx_crossover(
    parents: [&[f64]; 2],
    bounds: &Bounds,
    eta: f64,
    rng: &mut impl Rng,
) -> [Vec<f64>; 2] {
    let mut children = parents.map(<[f64]>::to_vec);
    for (gene, (lower, upper)) in bounds.intervals().iter().enumerate() {
        let (x1, x2) = min_max(parents[0][gene], parents[1][gene]);
        if !rng.random_bool(0.5) || x1 == x2 {
            continue;
        }
        let b_max = 1.0 + 2.0 * (x1 - lower).min(upper - x2) / (x2 - x1);
        let half_spread = 0.5 * spread_factor(b_max, eta, rng.random()) * (x2 - x1);
        let mean = 0.5 * (x1 + x2);
        let near_first = usize::from(rng.random_bool(0.5));
        children[near_first][gene] = (mean - half_spread).clamp(*lower, *upper);
        children[1 - near_first][gene] = (mean + half_spread).clamp(*lower, *upper);
    }
    children
}

/// The spread `b` in `[0, b_max]` below which a share `u` in `[0, 1)` of the crossover's density lies.
fn spread_factor(b_max: f64, eta: f64, u: f64) -> f64 {
    let alpha = 2.0 - b_max.powf(-(eta + 1.0));
    let share = u * alpha;
    let power = if share <= 1.0 { share } else { 1.0 / (2.0 - share) };
    power.powf(1.0 / (eta + 1.0))
}

fn min_max(a: f64, b: f64) -> (f64, f64) {
    if a <= b { (a, b) } else { (b, a) }
}

/// A child `[gene]` at a random point of the box between two parents `[gene]`.
///
/// ```text
/// c = x1 + u (x2 - x1)        u uniform in [0, 1), drawn for each gene
/// ```
///
/// Source: MATLAB's `crossoverintermediate` with ratio 1, as documented.
#[must_use]
pub fn intermediate_crossover(parents: [&[f64]; 2], rng: &mut impl Rng) -> Vec<f64> {
    parents[0]
        .iter()
        .zip(parents[1])
        .map(|(x1, x2)| {
            let u: f64 = rng.random();
            let (least, most) = min_max(*x1, *x2);
            (x1 + u * (x2 - x1)).clamp(least, most)
        })
        .collect()
}

/// A child `[gene]` of one `parent [gene]` by polynomial mutation; each gene takes part with `probability`.
///
/// ```text
/// c = x + d (upper - lower)
/// density of d ~ (1 - |d|)^eta, on each side cut at the bound and scaled to 1/2
/// ```
///
/// When no gene was drawn to take part, one free gene does: a child equal to its parent is an evaluation wasted.
/// Source: Deb, Goyal (1996), Computer Science and Informatics 26:30-45; the cut as in Deb's NSGA-II program.
#[must_use]
pub fn polynomial_mutation(
    parent: &[f64],
    bounds: &Bounds,
    eta: f64,
    probability: f64,
    rng: &mut impl Rng,
) -> Vec<f64> {
    let free: Vec<usize> = bounds.free_genes().collect();
    let mut drawn: Vec<usize> =
        free.iter().copied().filter(|_| rng.random_bool(probability)).collect();
    if drawn.is_empty() {
        drawn.push(free[rng.random_range(0..free.len())]);
    }
    let mut child = parent.to_vec();
    for gene in drawn {
        let (lower, upper) = bounds.intervals()[gene];
        let x = parent[gene];
        let width = upper - lower;
        let step = mutation_step((x - lower) / width, (upper - x) / width, eta, rng.random());
        child[gene] = (x + step * width).clamp(lower, upper);
    }
    child
}

/// A child `[gene]` of one `parent [gene]`, a `step` (in widths of the bounds) away in a random direction.
///
/// The directions of a random orthonormal basis of the free genes and, where genes stand on a bound, of those genes alone, are
/// tried in random order, each with a random sign and then all with the other. The first child within the bounds is taken; where
/// there is none, the child is its parent.
///
/// Source: MATLAB's `mutationadaptfeasible`, as documented.
#[must_use]
pub fn adaptive_feasible_mutation(
    parent: &[f64],
    bounds: &Bounds,
    step: f64,
    rng: &mut impl Rng,
) -> Vec<f64> {
    let free: Vec<usize> = bounds.free_genes().collect();
    let n = free.len();
    let drawn = DMatrix::from_fn(n, n, |_, _| rng.random_range(-1.0..1.0));
    let basis = drawn.qr().q();
    let mut directions: Vec<DVector<f64>> = basis.column_iter().map(|c| c.into_owned()).collect();
    for (k, &gene) in free.iter().enumerate() {
        let (lower, upper) = bounds.intervals()[gene];
        if parent[gene] == lower || parent[gene] == upper {
            directions.push(DVector::from_fn(n, |row, _| f64::from(u8::from(row == k))));
        }
    }
    directions.shuffle(rng);
    for direction in &mut directions {
        if rng.random_bool(0.5) {
            direction.neg_mut();
        }
    }
    let moved = |direction: &DVector<f64>, step: f64| {
        let mut child = parent.to_vec();
        for (&gene, way) in free.iter().zip(direction) {
            let (lower, upper) = bounds.intervals()[gene];
            child[gene] += step * way * (upper - lower);
        }
        bounds.contains(&child).then_some(child)
    };
    let ahead = directions.iter().find_map(|direction| moved(direction, step));
    ahead
        .or_else(|| directions.iter().find_map(|direction| moved(direction, -step)))
        .unwrap_or_else(|| parent.to_vec())
}

/// The step `d` in `[-below, above]` below which a share `u` in `[0, 1)` of the mutation's density lies.
///
/// `below` and `above` are the distances to the bounds, in widths.
fn mutation_step(below: f64, above: f64, eta: f64, u: f64) -> f64 {
    let kept = |share: f64, room: f64| {
        (share + (1.0 - share) * (1.0 - room).powf(eta + 1.0)).powf(1.0 / (eta + 1.0))
    };
    if u < 0.5 { kept(2.0 * u, below) - 1.0 } else { 1.0 - kept(2.0 * (1.0 - u), above) }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    use super::*;

    /// Bounds and two genomes within them, often on a bound, with fixed genes among them.
    fn family() -> impl Strategy<Value = (Bounds, Vec<f64>, Vec<f64>)> {
        let place = || prop_oneof![Just(0.0), Just(1.0), 0.0..1.0];
        let interval = (-1e3..1e3, prop_oneof![Just(0.0), Just(1e-9), 0.0..1e3])
            .prop_map(|(lower, width)| (lower, lower + width));
        prop::collection::vec((interval, place(), place()), 1..12).prop_map(|mut genes| {
            genes[0].0.1 += 1.0;
            let between = |(lower, upper): (f64, f64), place: f64| {
                (lower + place * (upper - lower)).clamp(lower, upper)
            };
            (
                Bounds::new(genes.iter().map(|gene| gene.0).collect()).unwrap(),
                genes.iter().map(|gene| between(gene.0, gene.1)).collect(),
                genes.iter().map(|gene| between(gene.0, gene.2)).collect(),
            )
        })
    }

    proptest! {
        #[test]
        fn every_operator_stays_within_the_bounds(
            (bounds, a, b) in family(),
            eta in 0.0..1000.0,
            probability in 0.0..=1.0,
            seed: u64,
        ) {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            prop_assert!(bounds.contains(&a) && bounds.contains(&b));
            prop_assert!(bounds.contains(&uniform_genome(&bounds, &mut rng)));
            let [c, d] = sbx_crossover([&a, &b], &bounds, eta, &mut rng);
            prop_assert!(bounds.contains(&c) && bounds.contains(&d));
            prop_assert!(bounds.contains(&intermediate_crossover([&a, &b], &mut rng)));
            let mutant = polynomial_mutation(&a, &bounds, eta, probability, &mut rng);
            prop_assert!(bounds.contains(&mutant));
            let mutant = adaptive_feasible_mutation(&a, &bounds, probability, &mut rng);
            prop_assert!(bounds.contains(&mutant));
        }

        #[test]
        fn sbx_keeps_the_mean_of_the_parents((bounds, a, b) in family(), eta in 0.0..100.0, seed: u64) {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let [c, d] = sbx_crossover([&a, &b], &bounds, eta, &mut rng);
            for gene in 0..bounds.genes() {
                // Four roundings, each below 1.2e-16 of numbers below 2e3.
                approx::assert_abs_diff_eq!(c[gene] + d[gene], a[gene] + b[gene], epsilon = 1e-12);
            }
        }
    }

    /// The share of `n` seeded draws for which `hit` holds.
    fn share(n: u64, mut hit: impl FnMut(&mut ChaCha8Rng) -> bool) -> f64 {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        (0..n).filter(|_| hit(&mut rng)).count() as f64 / n as f64
    }

    /// Four standard errors of a share of 10 000 draws, at most.
    const SHARE_ERROR: f64 = 4.0 * 0.5 / 100.0;

    #[test]
    fn sbx_spreads_as_its_density_says() {
        // Far from the bounds half the crossed genes contract, and a share of (1 - k^-(eta+1))/2 grows by up to k.
        let bounds = Bounds::new(vec![(-1e6, 1e6)]).unwrap();
        let eta = 2.0;
        let spread = |rng: &mut ChaCha8Rng| {
            let [c, d] = sbx_crossover([&[-1.0], &[1.0]], &bounds, eta, rng);
            0.5 * (c[0] - d[0]).abs()
        };
        // Half the genes do not take part and keep a spread of exactly 1.
        assert!((share(10_000, |rng| spread(rng) < 1.0) - 0.25).abs() < SHARE_ERROR);
        assert!(
            (share(10_000, |rng| spread(rng) > 2.0) - 0.25 * 2_f64.powi(-3)).abs() < SHARE_ERROR
        );
    }

    #[test]
    fn spread_and_step_reach_their_bounds_and_no_further() {
        // The largest u below 1 gives the whole spread, up to the rounding of 1 - u, 1e-16, over the
        // density there: 5e-15 for the spread, 2e-12 for the step with (1/4)^4 of the density left.
        let last = 1.0 - f64::EPSILON / 2.0;
        approx::assert_relative_eq!(spread_factor(3.0, 2.0, last), 3.0, max_relative = 1e-13);
        assert_eq!(spread_factor(3.0, 2.0, 0.0), 0.0);
        approx::assert_relative_eq!(
            mutation_step(0.25, 0.75, 3.0, 0.0),
            -0.25,
            max_relative = 1e-14
        );
        approx::assert_relative_eq!(
            mutation_step(0.25, 0.75, 3.0, last),
            0.75,
            max_relative = 1e-11
        );
        assert_eq!(mutation_step(0.25, 0.75, 3.0, 0.5), 0.0);
        assert_eq!(mutation_step(0.0, 1.0, 20.0, 0.3), 0.0);
    }

    #[test]
    fn mutation_is_as_often_down_as_up_and_mostly_small() {
        let bounds = Bounds::new(vec![(0.0, 1.0)]).unwrap();
        let mutant = |rng: &mut ChaCha8Rng| polynomial_mutation(&[0.2], &bounds, 20.0, 1.0, rng)[0];
        assert!((share(10_000, |rng| mutant(rng) < 0.2) - 0.5).abs() < SHARE_ERROR);
        // Above, a share (1 - 0.95^21)/2 = 0.33 of the steps is below 1/20; the cut at the bound is beyond 1e-15.
        let small_steps = 0.5 * (1.0 - 0.95_f64.powi(21));
        let small = |rng: &mut ChaCha8Rng| (0.2..0.25).contains(&mutant(rng));
        assert!((share(10_000, small) - small_steps).abs() < SHARE_ERROR);
    }

    #[test]
    fn mutation_changes_at_least_one_free_gene() {
        let bounds = Bounds::new(vec![(5.0, 5.0), (0.0, 1.0), (0.0, 1.0)]).unwrap();
        let parent = [5.0, 0.4, 0.6];
        let changed = |probability: f64| {
            let mut rng = ChaCha8Rng::seed_from_u64(3);
            (0..1000)
                .map(|_| polynomial_mutation(&parent, &bounds, 20.0, probability, &mut rng))
                .map(|child| child.iter().zip(&parent).filter(|(c, p)| c != p).count())
                .collect::<Vec<_>>()
        };
        assert!(changed(0.0).iter().all(|count| *count == 1));
        assert!(changed(1.0).iter().all(|count| *count == 2));
    }

    #[test]
    fn adaptive_mutation_takes_one_step_of_the_length_asked_for() {
        let bounds =
            Bounds::new(vec![(0.0, 1.0), (7.0, 7.0), (-10.0, 10.0), (0.0, 100.0)]).unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(4);
        // A corner: of two opposite directions both may lead out, but the edges do not.
        for parent in [[0.5, 7.0, 0.0, 50.0], [0.0, 7.0, 10.0, 100.0]] {
            for step in [0.3, 1e-6] {
                let child = adaptive_feasible_mutation(&parent, &bounds, step, &mut rng);
                let parts = [0, 2, 3].map(|k| {
                    let (lower, upper) = bounds.intervals()[k];
                    (child[k] - parent[k]) / (upper - lower)
                });
                let length = parts.map(|part| part * part).iter().sum::<f64>().sqrt();
                // Numbers up to 100 lose 1e-14 where steps are as short as 1e-6.
                approx::assert_relative_eq!(length, step, max_relative = 1e-7);
            }
        }
        assert_eq!(
            adaptive_feasible_mutation(&[0.5, 7.0, 0.0, 50.0], &bounds, 9.0, &mut rng)[..],
            [0.5, 7.0, 0.0, 50.0]
        );
    }

    #[test]
    fn intermediate_crossover_fills_the_box_between_the_parents() {
        let child = |rng: &mut ChaCha8Rng| intermediate_crossover([&[1.0, 8.0], &[3.0, 4.0]], rng);
        assert!((share(10_000, |rng| child(rng)[0] < 1.5) - 0.25).abs() < SHARE_ERROR);
        assert!((share(10_000, |rng| child(rng)[1] < 5.0) - 0.25).abs() < SHARE_ERROR);
    }
}
