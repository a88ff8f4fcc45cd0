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

use rand::Rng;
use serde::{Deserialize, Serialize};

use super::activation::Activation;
use super::bounds::{Bounds, InvalidBounds};
use super::network::{Aggregation, Network, WallNodes};
use super::network_draft::{InputBiases, NetworkDraft, NodeDraft};
use super::representation::{Operators, Representation};
use super::wall_genes::WallGenes;

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
    /// The network has the gene rounded to whole multiples of this.
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

/// The representation of the paper: real vectors of [`GENES`] within bounds, which stand for a network; behind them the genes of a wall
/// that is not the same everywhere, where a search wants them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Typed", into = "Typed")]
pub struct Paper {
    bounds: Bounds,
    wall: WallGenes,
}

/// A [`Paper`] as a file has it: its bounds alone where the wall has no genes.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(untagged)]
enum Typed {
    Plain(Bounds),
    WithWall { bounds: Bounds, wall: WallGenes },
}

/// A genome of [`Paper`]: one number per gene, all finite; written as their list.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<f64>", into = "Vec<f64>")]
pub struct PaperGenome {
    genes: Vec<f64>,
}

/// Why a list of numbers is not a genome.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum GenomeError {
    /// Too few or too many.
    #[error("a genome has {expected} genes, not {found}")]
    Length {
        /// How many the paper's has; those of a wall come on top.
        expected: usize,
        /// How many there were.
        found: usize,
    },
    /// NaN or an infinity.
    #[error("gene {place} is {value}; genes must be finite")]
    NotFinite {
        /// The gene's place, from 0.
        place: usize,
        /// The number.
        value: f64,
    },
}

impl Paper {
    /// Genomes within the bounds of [`GENES`], with those in `overrides` replaced: gene name to
    /// `[lower, upper]`. Equal bounds fix a gene.
    ///
    /// # Errors
    /// [`InvalidBounds`] for an unknown gene, for what is not an interval, and when no gene is free.
    pub fn new(overrides: &BTreeMap<String, [f64; 2]>) -> Result<Self, InvalidBounds> {
        Self::with_wall(WallGenes::default(), overrides)
    }

    /// As [`Self::new`], with genes of the `wall` behind those of the chamber.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_wall(
        wall: WallGenes,
        overrides: &BTreeMap<String, [f64; 2]>,
    ) -> Result<Self, InvalidBounds> {
        let genes: Vec<&Gene> = GENES.iter().chain(wall.genes()).collect();
        let mut intervals: Vec<_> = genes.iter().map(|gene| (gene.lower, gene.upper)).collect();
        for (name, &[lower, upper]) in overrides {
            let index = genes.iter().position(|gene| gene.name == name).ok_or_else(|| {
                let names: Vec<_> = genes.iter().map(|gene| gene.name).collect();
                let names = names.join(", ");
                InvalidBounds(format!("there is no gene `{name}`; the genes are {names}"))
            })?;
            if !((upper - lower).is_finite() && lower <= upper) {
                return Err(InvalidBounds(format!(
                    "gene {name}: [{lower}, {upper}] is not an interval of finite numbers"
                )));
            }
            intervals[index] = (lower, upper);
        }
        Ok(Self { bounds: Bounds::new(intervals)?, wall })
    }

    /// The genes, in the order of a genome: [`GENES`], then those of the wall.
    pub fn genes(&self) -> impl Iterator<Item = &'static Gene> {
        GENES.iter().chain(self.wall.genes())
    }

    /// Where each gene may lie, in the order of [`Self::genes`].
    #[must_use]
    pub fn bounds(&self) -> &Bounds {
        &self.bounds
    }
}

impl Default for Paper {
    fn default() -> Self {
        Self::new(&BTreeMap::new()).expect("the genes' own bounds are intervals")
    }
}

impl Representation for Paper {
    type Genome = PaperGenome;
    type Phenotype = Network;

    fn key(&self) -> &'static str {
        self.wall.key()
    }

    fn random(&self, rng: &mut impl Rng) -> PaperGenome {
        PaperGenome { genes: self.bounds.random(rng) }
    }

    fn mix(
        &self,
        parents: [&PaperGenome; 2],
        operators: &Operators,
        rng: &mut impl Rng,
    ) -> PaperGenome {
        let parents = parents.map(|parent| &parent.genes);
        PaperGenome { genes: self.bounds.mix(parents, operators, rng) }
    }

    fn mutate(
        &self,
        parent: &PaperGenome,
        operators: &Operators,
        rng: &mut impl Rng,
    ) -> PaperGenome {
        PaperGenome { genes: self.bounds.mutate(&parent.genes, operators, rng) }
    }

    fn distance(&self, a: &PaperGenome, b: &PaperGenome) -> f64 {
        self.bounds.distance(&a.genes, &b.genes)
    }

    fn contains(&self, genome: &PaperGenome) -> bool {
        self.bounds.contains(&genome.genes)
    }

    /// # Panics
    /// When it is no genome of this representation.
    fn express(&self, genome: &PaperGenome) -> Network {
        let [w1, w2, w3, w4, w5, w6, w7, w8, w9, w10, w11, biases @ ..] = genome.rounded();
        let [bx, by, bz, bt, b1, b2, b_a, b_b, b_c, b_i, b_o] = biases;
        let mut draft = NetworkDraft {
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
        self.wall.express(&genome.genes[GENES.len()..], &mut draft);
        Network::try_from(draft).expect("the topology is sound and genes are finite")
    }
}

impl TryFrom<Typed> for Paper {
    type Error = GenomeError;

    fn try_from(typed: Typed) -> Result<Self, GenomeError> {
        let (bounds, wall) = match typed {
            Typed::Plain(bounds) => (bounds, WallGenes::default()),
            Typed::WithWall { bounds, wall } => (bounds, wall),
        };
        let (found, expected) = (bounds.genes(), GENES.len() + wall.genes().count());
        if found == expected {
            return Ok(Self { bounds, wall });
        }
        Err(GenomeError::Length { expected, found })
    }
}

impl From<Paper> for Typed {
    fn from(Paper { bounds, wall }: Paper) -> Self {
        if wall == WallGenes::default() {
            Self::Plain(bounds)
        } else {
            Self::WithWall { bounds, wall }
        }
    }
}

impl PaperGenome {
    /// The genes, in the order of [`Paper::genes`].
    #[must_use]
    pub fn genes(&self) -> &[f64] {
        &self.genes
    }

    /// The genes as the formula sees them: those with a step are rounded to it.
    fn rounded(&self) -> [f64; GENES.len()] {
        std::array::from_fn(|i| match GENES[i].step {
            Some(step) => (self.genes[i] / step).round() * step,
            None => self.genes[i],
        })
    }
}

impl TryFrom<Vec<f64>> for PaperGenome {
    type Error = GenomeError;

    fn try_from(genes: Vec<f64>) -> Result<Self, GenomeError> {
        let (found, expected) = (genes.len(), GENES.len());
        if !WallGenes::ALL.iter().any(|wall| found == expected + wall.genes().count()) {
            return Err(GenomeError::Length { expected, found });
        }
        for (place, &value) in genes.iter().enumerate() {
            if !value.is_finite() {
                return Err(GenomeError::NotFinite { place, value });
            }
        }
        Ok(Self { genes })
    }
}

impl From<PaperGenome> for Vec<f64> {
    fn from(genome: PaperGenome) -> Self {
        genome.genes
    }
}

pub(super) const fn gene(
    name: &'static str,
    meaning: &'static str,
    lower: f64,
    upper: f64,
) -> Gene {
    Gene { name, meaning, lower, upper, step: None }
}

pub(super) fn sum(
    name: &str,
    activation: Activation,
    links: &[(&str, f64)],
    bias: f64,
) -> NodeDraft {
    let links: BTreeMap<_, _> = links.iter().map(|&(from, w)| (from.to_owned(), w)).collect();
    NodeDraft { name: name.to_owned(), activation, aggregation: Aggregation::Sum, links, bias }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    use super::*;

    fn genome_of(values: &[(&str, f64)]) -> PaperGenome {
        let value = |gene: &Gene| values.iter().find(|v| v.0 == gene.name).map_or(0.0, |v| v.1);
        PaperGenome::try_from(GENES.iter().map(value).collect::<Vec<_>>()).unwrap()
    }

    #[test]
    fn the_shipped_network_is_what_a_genome_stands_for() {
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
        assert_eq!(Paper::default().express(&genome_of(&genes)), shipped);
    }

    #[test]
    fn every_gene_reaches_the_network() {
        let base: Vec<f64> = (0..GENES.len()).map(|i| 0.1 + i as f64).collect();
        let express =
            |genes: Vec<f64>| Paper::default().express(&PaperGenome::try_from(genes).unwrap());
        let network = express(base.clone());
        for i in 0..GENES.len() {
            let mut genes = base.clone();
            genes[i] += 1.0;
            assert_ne!(express(genes), network, "{}", GENES[i].name);
        }
    }

    #[test]
    fn genomes_survive_serialization_and_refuse_wrong_lists() {
        let genome = genome_of(&[("w1", 0.1 + 0.2), ("bO", -1e-17)]);
        let text = serde_json::to_string(&genome).unwrap();
        assert_eq!(serde_json::from_str::<PaperGenome>(&text).unwrap(), genome);
        let network = Paper::default().express(&genome);
        assert_eq!(network.to_toml().parse::<Network>().unwrap(), network);
        let message = PaperGenome::try_from(vec![0.0; 21]).unwrap_err().to_string();
        assert_eq!(message, "a genome has 22 genes, not 21");
        let message = PaperGenome::try_from(vec![f64::NAN; 22]).unwrap_err().to_string();
        assert_eq!(message, "gene 0 is NaN; genes must be finite");
    }

    #[test]
    fn overrides_replace_named_intervals_only() {
        let paper = Paper::new(&BTreeMap::from([("w6".to_owned(), [2.0, 2.0])])).unwrap();
        let own = Paper::default();
        let (changed, own) = (paper.bounds().intervals(), own.bounds().intervals());
        let changed: Vec<_> = (0..GENES.len()).filter(|&i| changed[i] != own[i]).collect();
        assert_eq!(changed, [5]);
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let [a, b] = [paper.random(&mut rng), paper.random(&mut rng)];
        assert!(a != b && a.genes()[5] == 2.0 && b.genes()[5] == 2.0);
    }

    #[test]
    fn wrong_overrides_are_named() {
        let message = |name: &str, interval| {
            Paper::new(&BTreeMap::from([(name.to_owned(), interval)])).unwrap_err().to_string()
        };
        assert!(
            message("w12", [0.0, 1.0]).starts_with("there is no gene `w12`; the genes are w1, ")
        );
        assert!(message("w1", [1.0, 0.0]).starts_with("gene w1: [1, 0] is not an interval"));
        assert!(message("w1", [0.0, f64::INFINITY]).contains("[0, inf]"));
        assert!(message("w1", [-f64::MAX, f64::MAX]).contains("not an interval"));
    }

    #[test]
    fn the_representation_is_written_as_its_bounds() {
        let paper = Paper::new(&BTreeMap::from([("w6".to_owned(), [2.0, 2.0])])).unwrap();
        let text = serde_json::to_string(&paper).unwrap();
        assert_eq!(text, serde_json::to_string(paper.bounds()).unwrap());
        assert_eq!(serde_json::from_str::<Paper>(&text).unwrap(), paper);
        let error = serde_json::from_str::<Paper>("[[0.0, 1.0]]").unwrap_err().to_string();
        assert!(error.starts_with("a genome has 22 genes, not 1"), "{error}");
    }
}
