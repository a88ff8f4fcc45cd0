//! Real vectors within bounds: the genomes of test functions, and what others are made of.

use rand::Rng;
use serde::{Deserialize, Serialize};

use super::representation::{Crossover, Mutation, Operators, Representation};
use super::variation::{
    adaptive_feasible_mutation, intermediate_crossover, polynomial_mutation, sbx_crossover,
    uniform_genome,
};

/// The closed interval of each gene; written as a list of pairs `[[lower, upper], ...]`.
///
/// As a [`Representation`] its genomes are the real vectors `[gene]` in it, which stand for
/// themselves. Equal bounds fix a gene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(into = "Vec<(f64, f64)>", try_from = "Vec<(f64, f64)>")]
pub struct Bounds {
    intervals: Vec<(f64, f64)>,
}

/// Bounds between which no gene can vary; one sentence says which and why.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct InvalidBounds(pub(super) String);

impl Bounds {
    /// The bounds `(lower, upper)` of each gene `[gene]`; equal ones fix a gene.
    ///
    /// # Errors
    /// [`InvalidBounds`] when a width is negative or not finite, or when no gene is free.
    pub fn new(intervals: Vec<(f64, f64)>) -> Result<Self, InvalidBounds> {
        for (gene, (lower, upper)) in intervals.iter().enumerate() {
            let width = upper - lower;
            if !(width.is_finite() && width >= 0.0) {
                return Err(InvalidBounds(format!(
                    "gene {gene} is bounded by {lower} and {upper}, but the second must be finite and not below the first"
                )));
            }
        }
        let bounds = Self { intervals };
        if bounds.free_genes().next().is_none() {
            return Err(InvalidBounds(
                "no gene is free: at least one upper bound must lie above its lower bound"
                    .to_owned(),
            ));
        }
        Ok(bounds)
    }

    /// The number of genes.
    #[must_use]
    pub fn genes(&self) -> usize {
        self.intervals.len()
    }

    /// The bounds `(lower, upper)` of each gene `[gene]`.
    #[must_use]
    pub fn intervals(&self) -> &[(f64, f64)] {
        &self.intervals
    }

    /// The indices of the genes that can vary, ascending.
    pub(super) fn free_genes(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.genes()).filter(|gene| self.intervals[*gene].0 < self.intervals[*gene].1)
    }
}

impl Representation for Bounds {
    type Genome = Vec<f64>;
    type Phenotype = Vec<f64>;

    fn key(&self) -> &'static str {
        "real-vector"
    }

    fn random(&self, rng: &mut impl Rng) -> Vec<f64> {
        uniform_genome(self, rng)
    }

    fn mix(
        &self,
        [first, second]: [&Vec<f64>; 2],
        operators: &Operators,
        rng: &mut impl Rng,
    ) -> Vec<f64> {
        match operators.crossover {
            Crossover::Sbx => {
                let eta = operators.crossover_eta;
                let [child, _] = sbx_crossover([first, second], self, eta, rng);
                child
            }
            Crossover::Intermediate => intermediate_crossover([first, second], rng),
        }
    }

    fn mutate(&self, parent: &Vec<f64>, operators: &Operators, rng: &mut impl Rng) -> Vec<f64> {
        match operators.mutation {
            Mutation::Polynomial => {
                let one_gene = 1.0 / self.genes() as f64;
                let probability = operators.mutation_probability.unwrap_or(one_gene);
                polynomial_mutation(parent, self, operators.mutation_eta, probability, rng)
            }
            Mutation::AdaptiveFeasible => {
                adaptive_feasible_mutation(parent, self, operators.step, rng)
            }
        }
    }

    /// Euclidean, in the unit of the genes.
    fn distance(&self, a: &Vec<f64>, b: &Vec<f64>) -> f64 {
        a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
    }

    /// Whether it has the right number of genes, each within its bounds.
    fn contains(&self, genome: &Vec<f64>) -> bool {
        let is_within =
            |(gene, (lower, upper)): (&f64, &(f64, f64))| (*lower..=*upper).contains(gene);
        genome.len() == self.genes() && genome.iter().zip(&self.intervals).all(is_within)
    }

    fn express(&self, genome: &Vec<f64>) -> Vec<f64> {
        genome.clone()
    }
}

impl From<Bounds> for Vec<(f64, f64)> {
    fn from(bounds: Bounds) -> Self {
        bounds.intervals
    }
}

impl TryFrom<Vec<(f64, f64)>> for Bounds {
    type Error = InvalidBounds;

    fn try_from(intervals: Vec<(f64, f64)>) -> Result<Self, InvalidBounds> {
        Self::new(intervals)
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    use super::*;

    #[test]
    fn impossible_bounds_are_refused() {
        for wrong in [
            vec![],
            vec![(1.0, 1.0)],
            vec![(0.0, 1.0), (1.0, 0.0)],
            vec![(0.0, f64::INFINITY)],
            vec![(f64::NAN, 1.0)],
            vec![(-f64::MAX, f64::MAX)],
        ] {
            assert!(Bounds::new(wrong.clone()).is_err(), "{wrong:?}");
        }
        assert!(serde_json::from_str::<Bounds>("[[1, 0]]").is_err());
    }

    #[test]
    fn bounds_contain_their_ends_and_nothing_beyond() {
        let bounds = Bounds::new(vec![(0.0, 1.0), (2.0, 2.0)]).unwrap();
        assert!(bounds.contains(&vec![0.0, 2.0]) && bounds.contains(&vec![1.0, 2.0]));
        assert!(!bounds.contains(&vec![1.0 + f64::EPSILON, 2.0]));
        assert!(!bounds.contains(&vec![f64::NAN, 2.0]));
        assert!(!bounds.contains(&vec![0.5]));
        assert_eq!(bounds.free_genes().collect::<Vec<_>>(), [0]);
    }

    #[test]
    fn random_genomes_fill_the_bounds_and_repeat_with_the_seed() {
        let bounds = Bounds::new(vec![(0.0, 1.0), (2.0, 2.0), (-30.0, 10.0)]).unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        let genomes: Vec<_> = (0..1000).map(|_| bounds.random(&mut rng)).collect();
        for (i, &(lower, upper)) in bounds.intervals().iter().enumerate() {
            let genes = || genomes.iter().map(|genome| genome[i]);
            assert!(genes().all(|gene| (lower..=upper).contains(&gene)));
            let mean = genes().sum::<f64>() / 1000.0;
            // Five standard errors of a uniform mean: 5 / sqrt(12 * 1000) of the width.
            assert!((mean - (lower + upper) / 2.0).abs() <= 0.046 * (upper - lower));
        }
        assert_eq!(bounds.random(&mut ChaCha8Rng::seed_from_u64(7)), genomes[0]);
    }
}
