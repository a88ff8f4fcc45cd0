//! The box in gene space from which genomes are drawn.

use std::collections::BTreeMap;

use rand::{Rng, RngExt};

use super::paper::{GENES, Genome};

/// Least and greatest value of each gene, in the order of [`GENES`].
#[derive(Clone, Debug, PartialEq)]
pub struct Bounds {
    intervals: Vec<[f64; 2]>,
}

/// Why bounds are refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BoundsError {
    /// Not a gene.
    #[error("there is no gene `{name}`; the genes are {}", gene_names())]
    UnknownGene {
        /// The name that was not found.
        name: String,
    },
    /// Not an interval.
    #[error("gene {name}: [{lower}, {upper}] is not an interval of finite numbers")]
    Interval {
        /// The gene.
        name: String,
        /// Its least value.
        lower: f64,
        /// Its greatest value.
        upper: f64,
    },
}

impl Default for Bounds {
    fn default() -> Self {
        Self { intervals: GENES.iter().map(|gene| [gene.lower, gene.upper]).collect() }
    }
}

impl Bounds {
    /// The default bounds with those in `overrides` replaced: gene name to `[lower, upper]`.
    ///
    /// # Errors
    /// [`BoundsError`] for an unknown gene, and for what is not an interval. `lower = upper` fixes a gene.
    pub fn with_overrides(overrides: &BTreeMap<String, [f64; 2]>) -> Result<Self, BoundsError> {
        let mut bounds = Self::default();
        for (name, &[lower, upper]) in overrides {
            let index = GENES
                .iter()
                .position(|gene| gene.name == name)
                .ok_or_else(|| BoundsError::UnknownGene { name: name.clone() })?;
            if !((upper - lower).is_finite() && lower <= upper) {
                return Err(BoundsError::Interval { name: name.clone(), lower, upper });
            }
            bounds.intervals[index] = [lower, upper];
        }
        Ok(bounds)
    }

    /// `[lower, upper]` of each gene, in the order of [`GENES`].
    #[must_use]
    pub fn intervals(&self) -> &[[f64; 2]] {
        &self.intervals
    }

    /// A genome drawn uniformly from the box.
    ///
    /// # Panics
    /// Never: the bounds are finite intervals.
    pub fn uniform(&self, rng: &mut impl Rng) -> Genome {
        let genes: Vec<f64> =
            self.intervals.iter().map(|&[lower, upper]| rng.random_range(lower..=upper)).collect();
        Genome::try_from(genes).expect("one finite number was drawn for each gene")
    }
}

fn gene_names() -> String {
    GENES.map(|gene| gene.name).join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    #[test]
    fn overrides_replace_named_intervals_only() {
        let overrides = BTreeMap::from([("w6".to_owned(), [2.0, 2.0])]);
        let bounds = Bounds::with_overrides(&overrides).unwrap();
        let changed: Vec<_> = (0..GENES.len())
            .filter(|&i| bounds.intervals()[i] != Bounds::default().intervals()[i])
            .collect();
        assert_eq!(changed, [5]);
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        assert_eq!(bounds.uniform(&mut rng).genes()[5], 2.0);
    }

    #[test]
    fn wrong_overrides_are_named() {
        let message = |name: &str, interval| {
            let overrides = BTreeMap::from([(name.to_owned(), interval)]);
            Bounds::with_overrides(&overrides).unwrap_err().to_string()
        };
        assert!(
            message("w12", [0.0, 1.0]).starts_with("there is no gene `w12`; the genes are w1, ")
        );
        assert!(message("w1", [1.0, 0.0]).starts_with("gene w1: [1, 0] is not an interval"));
        assert!(message("w1", [0.0, f64::INFINITY]).contains("[0, inf]"));
        assert!(message("w1", [-f64::MAX, f64::MAX]).contains("not an interval"));
    }

    #[test]
    fn uniform_genomes_fill_the_box_and_repeat_with_the_seed() {
        let bounds = Bounds::default();
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        let genomes: Vec<_> = (0..1000).map(|_| bounds.uniform(&mut rng)).collect();
        for (i, &[lower, upper]) in bounds.intervals().iter().enumerate() {
            let genes = || genomes.iter().map(|genome| genome.genes()[i]);
            assert!(genes().all(|gene| (lower..=upper).contains(&gene)));
            let mean = genes().sum::<f64>() / 1000.0;
            // Five standard errors of a uniform mean: 5 / sqrt(12 * 1000) of the width.
            assert!((mean - (lower + upper) / 2.0).abs() < 0.046 * (upper - lower));
        }
        assert_eq!(bounds.uniform(&mut ChaCha8Rng::seed_from_u64(7)), genomes[0]);
    }
}
