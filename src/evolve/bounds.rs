//! Where each gene may lie.

use serde::{Deserialize, Serialize};

/// The closed interval of each gene; written as a list of pairs `[[lower, upper], ...]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(into = "Vec<(f64, f64)>", try_from = "Vec<(f64, f64)>")]
pub struct Bounds {
    intervals: Vec<(f64, f64)>,
}

/// Bounds between which no gene can vary; one sentence says which and why.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct InvalidBounds(String);

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

    /// Whether `genome` has the right number of genes, each within its bounds.
    #[must_use]
    pub fn contain(&self, genome: &[f64]) -> bool {
        genome.len() == self.genes()
            && genome
                .iter()
                .zip(&self.intervals)
                .all(|(gene, (lower, upper))| (*lower..=*upper).contains(gene))
    }

    /// The indices of the genes that can vary, ascending.
    pub(super) fn free_genes(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.genes()).filter(|gene| self.intervals[*gene].0 < self.intervals[*gene].1)
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
        assert!(bounds.contain(&[0.0, 2.0]) && bounds.contain(&[1.0, 2.0]));
        assert!(!bounds.contain(&[1.0 + f64::EPSILON, 2.0]));
        assert!(!bounds.contain(&[f64::NAN, 2.0]));
        assert!(!bounds.contain(&[0.5]));
        assert_eq!(bounds.free_genes().collect::<Vec<_>>(), [0]);
    }
}
