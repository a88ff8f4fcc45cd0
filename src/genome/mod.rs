//! What is inherited? Genomes, how they come from each other, and the networks that they stand for.
//!
//! [`Network`] is any feed-forward network, read from and written to TOML.
//! [`Representation`] is what a genome is; [`Bounds`] is that of real vectors, and [`Paper`] that of
//! the paper's fixed topology, whose genomes of 22 numbers stand for a [`Network`].
//!
//! # Decisions
//! - One trait has both what evolution does with a genome and what a genome stands for, so that a new
//!   kind of genome is one file. It is in this room because a network is, and every room that needs
//!   it is to the right. Evolution is generic in the trait and never asks for the phenotype, so test
//!   functions have genomes without a network.
//! - Operators on real vectors are functions of parents and bounds (`variation.rs`), from which a
//!   representation that contains numbers chooses as settings say.

mod activation;
mod bounds;
mod network;
mod network_draft;
mod paper;
mod representation;
mod variation;
mod wall_genes;

pub use activation::Activation;
pub use bounds::{Bounds, InvalidBounds};
pub use network::{Aggregation, Coordinate, Link, Network, NetworkError, Node, Source, WallNodes};
pub use network_draft::{InputBiases, NetworkDraft, NodeDraft};
pub use paper::{GENES, Gene, GenomeError, Paper, PaperGenome};
pub use representation::{Crossover, Mutation, Operators, Representation};
pub use variation::{
    adaptive_feasible_mutation, intermediate_crossover, polynomial_mutation, sbx_crossover,
    uniform_genome,
};
pub use wall_genes::{MATERIAL_GENES, THICKNESS_GENES, WallGenes};
