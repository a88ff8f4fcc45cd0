//! Who becomes a parent, and who lives on: both by rank, then by crowding.
//!
//! ```text
//! a precedes b  when  a's front is better, or the front is the same and a is more alone on it
//! ```
//!
//! Source: Deb et al. (2002), section III.C, the crowded-comparison operator; a front that has too many is thinned one by one.

use std::cmp::Ordering;

use rand::{Rng, RngExt};

use super::crowding::{crowding_distances, most_even};
use super::dominance::fronts;
use super::individual::Individual;

/// The standing of each individual of a population.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Ranking {
    /// The number of its front, 0 for the best `[individual]`.
    pub rank: Vec<usize>,
    /// How alone it is on its front; 0 for the infeasible, whose objectives do not count `[individual]`.
    pub crowding_distance: Vec<f64>,
}

impl Ranking {
    /// The standing of each member of `population`.
    pub(super) fn of<G>(population: &[Individual<G>]) -> Self {
        let evaluations: Vec<_> =
            population.iter().map(|individual| &individual.evaluation).collect();
        let mut rank = vec![0; population.len()];
        let mut crowding_distance = vec![0.0; population.len()];
        for (front_number, front) in fronts(&evaluations).iter().enumerate() {
            for member in front {
                rank[*member] = front_number;
            }
            if front.iter().all(|member| evaluations[*member].is_feasible()) {
                let objectives: Vec<&[f64]> =
                    front.iter().map(|member| &evaluations[*member].objectives[..]).collect();
                for (member, distance) in front.iter().zip(crowding_distances(&objectives)) {
                    crowding_distance[*member] = distance;
                }
            }
        }
        Self { rank, crowding_distance }
    }

    /// `Less` when individual `a` precedes individual `b`.
    fn compare(&self, a: usize, b: usize) -> Ordering {
        self.rank[a]
            .cmp(&self.rank[b])
            .then(self.crowding_distance[b].total_cmp(&self.crowding_distance[a]))
    }

    /// The winner of a binary tournament between two different individuals; of equals the first drawn.
    pub(super) fn parent(&self, rng: &mut impl Rng) -> usize {
        let first = rng.random_range(0..self.rank.len());
        let second = draw_another(self.rank.len(), first, rng);
        if self.compare(second, first).is_lt() { second } else { first }
    }

    /// The winners of two tournaments, the second repeated until its winner is another. Needs three individuals.
    pub(super) fn two_parents(&self, rng: &mut impl Rng) -> [usize; 2] {
        let first = self.parent(rng);
        loop {
            let second = self.parent(rng);
            if second != first {
                return [first, second];
            }
        }
    }
}

/// A number below `count` other than `taken`, each equally likely.
fn draw_another(count: usize, taken: usize, rng: &mut impl Rng) -> usize {
    let drawn = rng.random_range(0..count - 1);
    if drawn < taken { drawn } else { drawn + 1 }
}

/// The best `count` of `population`, the best first; of equals the younger. Of the front that has too many, those live that lie most
/// evenly ([`most_even`]).
pub(super) fn survivors<G: Clone>(
    population: Vec<Individual<G>>,
    count: usize,
) -> Vec<Individual<G>> {
    chosen(population, count, |left| left)
}

/// As [`survivors`], but each front of the feasible, the best first, takes at most this `share` of the places left, and at least one;
/// places that remain go to the best of those left over.
///
/// Source: Deb and Goel (2001), "Controlled elitist non-dominated sorting genetic algorithms for better convergence", EMO;
/// their reduction rate is `1 - share`.
pub(super) fn controlled_survivors<G: Clone>(
    population: Vec<Individual<G>>,
    count: usize,
    share: f64,
) -> Vec<Individual<G>> {
    chosen(population, count, |left| ((share * left as f64).round() as usize).max(1))
}

/// The best `count`, where a front of the feasible takes at most `quota` of the places left.
fn chosen<G: Clone>(
    mut population: Vec<Individual<G>>,
    count: usize,
    quota: impl Fn(usize) -> usize,
) -> Vec<Individual<G>> {
    population.sort_by_key(|individual| std::cmp::Reverse(individual.id));
    let ranking = Ranking::of(&population);
    let mut order: Vec<usize> = (0..population.len()).collect();
    order.sort_by(|&a, &b| ranking.compare(a, b));
    let mut left = count.min(population.len());
    let mut lives = vec![false; population.len()];
    for front in order.chunk_by(|&a, &b| ranking.rank[a] == ranking.rank[b]) {
        if left == 0 || !population[front[0]].evaluation.is_feasible() {
            break;
        }
        let objectives = |&member: &usize| &population[member].evaluation.objectives[..];
        let objectives: Vec<&[f64]> = front.iter().map(objectives).collect();
        for member in most_even(&objectives, quota(left)) {
            lives[front[member]] = true;
            left -= 1;
        }
    }
    for &member in &order {
        if left > 0 && !lives[member] {
            lives[member] = true;
            left -= 1;
        }
    }
    order.retain(|&member| lives[member]);
    order.into_iter().map(|member| population[member].clone()).collect()
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    use super::super::individual::{Evaluation, IndividualId};
    use super::*;

    fn population(evaluations: Vec<Evaluation>) -> Vec<Individual<()>> {
        evaluations
            .into_iter()
            .enumerate()
            .map(|(index, evaluation)| Individual {
                id: IndividualId { generation: 0, index },
                genome: (),
                evaluation,
            })
            .collect()
    }

    fn mixed() -> Vec<Individual<()>> {
        population(vec![
            Evaluation::infeasible(2.0),
            Evaluation::feasible(vec![0.0, 10.0]),
            Evaluation::feasible(vec![1.0, 6.0]),
            Evaluation::feasible(vec![3.0, 4.0]),
            Evaluation::feasible(vec![8.0, 0.0]),
            Evaluation::feasible(vec![9.0, 9.0]),
            Evaluation::infeasible(1.0),
            Evaluation::infeasible(1.0),
        ])
    }

    fn indices(population: &[Individual<()>]) -> Vec<usize> {
        population.iter().map(|individual| individual.id.index).collect()
    }

    #[test]
    fn the_best_survive_in_order() {
        // The two ends tie, the younger first; then 3 with crowding 1.475 before 2 with 0.975;
        // the dominated one; the infeasible by violation, the younger of equals first.
        let expected = [4, 1, 3, 2, 5, 7, 6, 0];
        for count in 0..=8 {
            assert_eq!(indices(&survivors(mixed(), count)), expected[..count]);
        }
    }

    #[test]
    fn a_front_takes_its_share_and_leaves_the_rest() {
        // Six places: the front of four may take half, 3; its front of one the next; two of the infeasible fill up after the fourth.
        let indices = |share| indices(&controlled_survivors(mixed(), 6, share));
        assert_eq!(indices(0.5), [4, 1, 3, 2, 5, 7]);
        let crowd = |count| {
            let fronts = [0.0, 1.0, 2.0].into_iter().flat_map(|worse| {
                (0..4).map(move |i| {
                    let x = f64::from(i);
                    Evaluation::feasible(vec![x + worse, 3.0 - x + worse])
                })
            });
            controlled_survivors(population(fronts.collect()), count, 0.5)
        };
        // Of twelve in fronts of four: half of six, half of the three left, and the one.
        let front_of = |one: &Individual<()>| one.id.index / 4;
        assert_eq!(crowd(6).iter().map(front_of).collect::<Vec<_>>(), [0, 0, 0, 1, 1, 2]);
        assert_eq!(crowd(12).len(), 12);
        assert_eq!(controlled_survivors(mixed(), 8, 1.0), survivors(mixed(), 8));
    }

    #[test]
    fn survival_does_not_depend_on_the_order_given() {
        let mut reversed = mixed();
        reversed.reverse();
        assert_eq!(survivors(reversed, 6), survivors(mixed(), 6));
    }

    #[test]
    fn a_tournament_is_won_as_often_as_pairs_say() {
        // Each of the 28 pairs is as likely; the k-th best of 8 wins 8 - k of them, and the two ends and the
        // two twins share the pair in which they meet.
        // 28 000 draws: four standard errors of a share are below 4 * 0.5 / 167 = 0.012.
        let ranking = Ranking::of(&mixed());
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let n = 28_000;
        let mut wins = [0_u32; 8];
        for _ in 0..n {
            wins[ranking.parent(&mut rng)] += 1;
        }
        let expected = [0.0, 6.5, 4.0, 5.0, 6.5, 3.0, 1.5, 1.5].map(|pairs| pairs / 28.0);
        for (wins, expected) in wins.iter().zip(expected) {
            assert!((f64::from(*wins) / f64::from(n) - expected).abs() < 0.012);
        }
        assert_eq!(wins[0], 0);
    }

    #[test]
    fn two_parents_differ() {
        let ranking = Ranking::of(&mixed()[..4]);
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        for _ in 0..1000 {
            let [a, b] = ranking.two_parents(&mut rng);
            assert_ne!(a, b);
        }
    }
}
