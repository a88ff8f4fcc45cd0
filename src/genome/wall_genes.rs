//! Genes for a wall that is not the same everywhere, behind those of the chamber.
//!
//! ```text
//! thickness = tx (x + bx) + tp B + tl C + tO          mm, within the run file's bounds
//! side      = mx (x + bx) + mp B + ml C + mO          the second material where it is positive
//! ```
//! x in centimetres; B and C are the pleats and the lobes of the chamber ([`super::paper`]).
//!
//! # Decisions
//! - Nodes of the chamber's own network carry the pattern, so that it follows pleats and lobes and evolves with them. What a pattern
//!   needs to be worth having is a side (`x`, along which the plane stands) and a rhythm: four genes each.
//! - Only the sign of `side` counts, so that one of its four genes is redundant; without it one weight would have to be fixed, and
//!   a wall whose two materials meet on a plane across that axis could not be reached.

use serde::{Deserialize, Serialize};

use super::activation::Activation;
use super::network::WallNodes;
use super::network_draft::{NetworkDraft, NodeDraft};
use super::paper::{Gene, gene, sum};

/// Which properties of the wall are inherited.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WallGenes {
    /// Its thickness.
    pub thickness: bool,
    /// Which of two materials it is of.
    pub material: bool,
}

/// The genes of the thickness.
pub const THICKNESS_GENES: [Gene; 4] = [
    gene("tx", "change of the thickness along x, mm/cm", -0.8, 0.8),
    gene("tp", "change of the thickness over the pleats, mm", -0.5, 0.5),
    gene("tl", "change of the thickness over the lobes, mm", -0.5, 0.5),
    gene("tO", "thickness where these are 0, mm", 0.8, 2.4),
];

/// The genes of the material.
pub const MATERIAL_GENES: [Gene; 4] = [
    gene("mx", "share of x in the choice of the material, 1/cm", -1.0, 1.0),
    gene("mp", "share of the pleats in it", -1.0, 1.0),
    gene("ml", "share of the lobes in it", -1.0, 1.0),
    gene("mO", "bias of it: more positive is more of the second material", -1.0, 1.0),
];

impl WallGenes {
    /// Every choice, none first.
    pub(super) const ALL: [Self; 4] = [
        Self { thickness: false, material: false },
        Self { thickness: true, material: false },
        Self { thickness: false, material: true },
        Self { thickness: true, material: true },
    ];

    /// The genes, in the order of a genome.
    pub fn genes(self) -> impl Iterator<Item = &'static Gene> {
        let of_thickness = self.thickness.then_some(&THICKNESS_GENES).into_iter().flatten();
        of_thickness.chain(self.material.then_some(&MATERIAL_GENES).into_iter().flatten())
    }

    /// The name of a representation that has these genes besides the paper's.
    pub(super) fn key(self) -> &'static str {
        match (self.thickness, self.material) {
            (false, false) => "paper-22",
            (true, false) => "paper-22-thickness",
            (false, true) => "paper-22-material",
            (true, true) => "paper-22-thickness-material",
        }
    }

    /// Adds the nodes of the wall that `genes` stand for to the network of the chamber.
    pub(super) fn express(self, mut genes: &[f64], chamber: &mut NetworkDraft) {
        let mut add = |name: &str| {
            let (own, rest) = genes.split_at(4);
            genes = rest;
            chamber.nodes.push(node(name, own));
            Some(name.to_owned())
        };
        chamber.wall = WallNodes {
            thickness: self.thickness.then(|| add("thickness")).flatten(),
            material: self.material.then(|| add("side")).flatten(),
        };
    }
}

fn node(name: &str, genes: &[f64]) -> NodeDraft {
    let links = [("x", genes[0]), ("pleats", genes[1]), ("lobes", genes[2])];
    sum(name, Activation::Identity, &links, genes[3])
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::genome::{GENES, Paper, PaperGenome, Representation};

    fn paper(wall: WallGenes) -> Paper {
        Paper::with_wall(wall, &BTreeMap::new()).unwrap()
    }

    fn genome(paper: &Paper, shift: f64) -> PaperGenome {
        let genes: Vec<f64> = (0..paper.genes().count()).map(|i| shift + i as f64).collect();
        PaperGenome::try_from(genes).unwrap()
    }

    /// The wall's genes are links and bias of its own node, and change nothing of the chamber's.
    #[test]
    fn genes_of_the_wall_are_a_node_each() {
        let both = paper(WallGenes { thickness: true, material: true });
        let network = both.express(&genome(&both, 0.5));
        let node = |name: &str| network.nodes().iter().find(|node| node.name == name).unwrap();
        let first = GENES.len() as f64 + 0.5;
        for (k, name) in [(0.0, "thickness"), (4.0, "side")] {
            let node = node(name);
            let mut weights: Vec<f64> = node.links.iter().map(|link| link.weight).collect();
            weights.sort_by(f64::total_cmp);
            assert_eq!(weights, [0.0, 1.0, 2.0].map(|i| first + k + i), "{name}");
            assert_eq!(node.bias, first + k + 3.0);
        }
        let wall = network.wall().map(|index| network.nodes()[index].name.as_str());
        assert_eq!((wall.thickness, wall.material), (Some("thickness"), Some("side")));

        let none = paper(WallGenes::default());
        let plain = none.express(&genome(&none, 0.5));
        assert!(plain.wall().is_empty());
        assert_eq!(plain.nodes()[..], network.nodes()[..plain.nodes().len()]);
    }

    #[test]
    fn each_choice_is_told_from_the_others() {
        for wall in WallGenes::ALL {
            let own = paper(wall);
            let text = serde_json::to_string(&own).unwrap();
            assert_eq!(serde_json::from_str::<Paper>(&text).unwrap(), own);
            let others = WallGenes::ALL.into_iter().filter(|other| *other != wall);
            for other in others.map(paper) {
                assert_ne!(other.key(), own.key());
                let found = other.genes().count();
                let is_told = found == own.genes().count() || !other.contains(&genome(&own, 0.5));
                assert!(is_told, "{wall:?}");
            }
        }
        let overrides = BTreeMap::from([("tO".to_owned(), [1.0, 2.0])]);
        let error = Paper::new(&overrides).unwrap_err().to_string();
        assert!(error.starts_with("there is no gene `tO`"), "{error}");
    }
}
