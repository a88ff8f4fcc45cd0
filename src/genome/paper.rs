//! The paper's topology (Smith et al., RoboSoft 2022, Fig. 1): 22 genes.
//!
//! ```text
//! A = cos(w3 (z + bz)) + bA                     rhythm of the pleats
//! B = cos(w4 (z + bz) + w5 A) + bB              pleats, phase-modulated by A
//! C = cos(w6 (theta + bt)) + bC                 lobes around the axis
//! I = w7 B + w8 C + bI
//! f = w9 [(w1 (x + bx))^2 + b1] + w10 [(w2 (y + by))^2 + b2] + w11 I + bO
//! ```
//! x, y, z in centimetres; the cavity is where f < 0.
//!
//! # Decisions
//! The paper states neither which nodes carry a bias nor any bound. Here every node carries one, and
//! [`GENES`] holds bounds of which most random genomes are one closed chamber along the whole box, and varied.
//! Measured on 400 of them in the default box: 79 % are one cavity from clamp to tip on a 2 mm grid
//! (a fifth of these touch the box's sides), and 53 % can be meshed with edges of 3 mm,
//! 8 to 32 mm wide (5 to 95 %), with 0 to 10 pleats and lobes that make them oval or lopsided.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::activation::Activation;
use super::network::{Aggregation, Network, WallNodes};
use super::network_draft::{InputBiases, NetworkDraft, NodeDraft};

/// One number of a genome.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gene {
    /// The letter in the formula above, which the run file uses.
    pub name: &'static str,
    /// What the gene does, in a few words.
    pub meaning: &'static str,
    /// Least value of a random gene, unless the run file says otherwise.
    pub lower: f64,
    /// Greatest value of a random gene, unless the run file says otherwise.
    pub upper: f64,
    /// Decoding rounds the gene to whole multiples of this.
    pub step: Option<f64>,
}

/// The genes in the order of a genome: 11 weights, 11 biases.
///
/// w6 is a whole number: only whole multiples of theta are single-valued around the axis.
pub const GENES: [Gene; 22] = [
    gene("w1", "scale of x inside its square, 1/cm", 0.7, 1.6),
    gene("w2", "scale of y inside its square, 1/cm", 0.7, 1.6),
    gene("w3", "wave number of the rhythm, rad/cm", 0.0, 3.0),
    gene("w4", "wave number of the pleats, rad/cm", 0.0, 6.0),
    gene("w5", "depth of the phase modulation, rad", -2.0, 2.0),
    Gene { step: Some(1.0), ..gene("w6", "lobes around the axis", 0.0, 4.0) },
    gene("w7", "height of the pleats", -1.0, 1.0),
    gene("w8", "height of the lobes", -1.0, 1.0),
    gene("w9", "share of x", 0.5, 1.5),
    gene("w10", "share of y", 0.5, 1.5),
    gene("w11", "share of pleats and lobes", 0.5, 1.5),
    gene("bx", "shift along x, cm", -0.5, 0.5),
    gene("by", "shift along y, cm", -0.5, 0.5),
    gene("bz", "shift along z, cm", -3.15, 3.15),
    gene("bt", "turn of the lobes, rad", -3.15, 3.15),
    gene("b1", "bias of the squared x", -0.2, 0.2),
    gene("b2", "bias of the squared y", -0.2, 0.2),
    gene("bA", "bias of the rhythm", -1.0, 1.0),
    gene("bB", "bias of the pleats", -0.3, 0.3),
    gene("bC", "bias of the lobes", -0.3, 0.3),
    gene("bI", "bias of pleats and lobes together", -0.3, 0.3),
    gene("bO", "bias of the field: more negative is wider", -1.5, -0.2),
];

/// A design as inherited: one number per entry of [`GENES`], all finite.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<f64>", into = "Vec<f64>")]
pub struct Genome {
    genes: Vec<f64>,
}

/// Why a list of numbers is not a genome.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum GenomeError {
    /// Too few or too many.
    #[error("a genome has {expected} genes, not {found}", expected = GENES.len())]
    Length {
        /// How many there were.
        found: usize,
    },
    /// NaN or an infinity.
    #[error("gene {name} is {value}; genes must be finite")]
    NotFinite {
        /// The gene's name.
        name: &'static str,
        /// The number.
        value: f64,
    },
}

impl Genome {
    /// The genes, in the order of [`GENES`].
    #[must_use]
    pub fn genes(&self) -> &[f64] {
        &self.genes
    }

    /// The network that the genes stand for.
    ///
    /// # Panics
    /// Never: the topology is fixed and the genes are finite.
    #[must_use]
    pub fn decode(&self) -> Network {
        let [w1, w2, w3, w4, w5, w6, w7, w8, w9, w10, w11, biases @ ..] = self.expressed();
        let [bx, by, bz, bt, b1, b2, b_a, b_b, b_c, b_i, b_o] = biases;
        let draft = NetworkDraft {
            length_unit_mm: 10.0,
            output: Some("chamber".to_owned()),
            wall: WallNodes::default(),
            inputs: InputBiases { x: bx, y: by, z: bz, theta: bt, r: 0.0 },
            nodes: vec![
                sum("x-squared", Activation::Squared, &[("x", w1)], b1),
                sum("y-squared", Activation::Squared, &[("y", w2)], b2),
                sum("rhythm", Activation::Cosine, &[("z", w3)], b_a),
                sum("pleats", Activation::Cosine, &[("z", w4), ("rhythm", w5)], b_b),
                sum("lobes", Activation::Cosine, &[("theta", w6)], b_c),
                sum("relief", Activation::Identity, &[("pleats", w7), ("lobes", w8)], b_i),
                sum(
                    "chamber",
                    Activation::Identity,
                    &[("x-squared", w9), ("y-squared", w10), ("relief", w11)],
                    b_o,
                ),
            ],
        };
        Network::try_from(draft).expect("the topology is sound and genes are finite")
    }

    /// The genes as the formula sees them: those with a step are rounded to it.
    fn expressed(&self) -> [f64; GENES.len()] {
        std::array::from_fn(|i| match GENES[i].step {
            Some(step) => (self.genes[i] / step).round() * step,
            None => self.genes[i],
        })
    }
}

impl TryFrom<Vec<f64>> for Genome {
    type Error = GenomeError;

    fn try_from(genes: Vec<f64>) -> Result<Self, GenomeError> {
        if genes.len() != GENES.len() {
            return Err(GenomeError::Length { found: genes.len() });
        }
        for (gene, &value) in GENES.iter().zip(&genes) {
            if !value.is_finite() {
                return Err(GenomeError::NotFinite { name: gene.name, value });
            }
        }
        Ok(Self { genes })
    }
}

impl From<Genome> for Vec<f64> {
    fn from(genome: Genome) -> Self {
        genome.genes
    }
}

const fn gene(name: &'static str, meaning: &'static str, lower: f64, upper: f64) -> Gene {
    Gene { name, meaning, lower, upper, step: None }
}

fn sum(name: &str, activation: Activation, links: &[(&str, f64)], bias: f64) -> NodeDraft {
    let links: BTreeMap<_, _> = links.iter().map(|&(from, w)| (from.to_owned(), w)).collect();
    NodeDraft { name: name.to_owned(), activation, aggregation: Aggregation::Sum, links, bias }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn genome_of(values: &[(&str, f64)]) -> Genome {
        let value = |gene: &Gene| values.iter().find(|v| v.0 == gene.name).map_or(0.0, |v| v.1);
        Genome::try_from(GENES.iter().map(value).collect::<Vec<_>>()).unwrap()
    }

    #[test]
    fn the_shipped_network_is_a_genome_decoded() {
        let genes = [
            ("w1", 1.0),
            ("w2", 1.0),
            ("w3", 1.0),
            ("w4", 5.0),
            ("w5", 0.4),
            ("w6", 1.2), // rounded to 1
            ("w7", 0.3),
            ("w8", 0.25),
            ("w9", 1.0),
            ("w10", 1.0),
            ("w11", 1.0),
            ("bO", -0.9),
        ];
        let shipped = include_str!("../../examples/networks/paper.toml").parse().unwrap();
        assert_eq!(genome_of(&genes).decode(), shipped);
    }

    #[test]
    fn every_gene_reaches_the_network() {
        let base: Vec<f64> = (0..GENES.len()).map(|i| 0.1 + i as f64).collect();
        let network = Genome::try_from(base.clone()).unwrap().decode();
        for i in 0..GENES.len() {
            let mut genes = base.clone();
            genes[i] += 1.0;
            assert_ne!(Genome::try_from(genes).unwrap().decode(), network, "{}", GENES[i].name);
        }
    }

    #[test]
    fn genomes_survive_serialization_and_refuse_wrong_lists() {
        let genome = genome_of(&[("w1", 0.1 + 0.2), ("bO", -1e-17)]);
        let text = serde_json::to_string(&genome).unwrap();
        assert_eq!(serde_json::from_str::<Genome>(&text).unwrap(), genome);
        assert_eq!(genome.decode().to_toml().parse::<Network>().unwrap(), genome.decode());
        let message = Genome::try_from(vec![0.0; 21]).unwrap_err().to_string();
        assert_eq!(message, "a genome has 22 genes, not 21");
        let message = Genome::try_from(vec![f64::NAN; 22]).unwrap_err().to_string();
        assert_eq!(message, "gene w1 is NaN; genes must be finite");
    }
}
