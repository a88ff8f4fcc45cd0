//! What is inherited? Computational networks, and the vector of genes that sets one.
//!
//! [`Network`] is any feed-forward network, read from and written to TOML.
//! [`Genome`] is the paper's fixed topology: 22 numbers that decode to a [`Network`].

mod activation;
mod bounds;
mod network;
mod network_draft;
mod paper;

pub use activation::Activation;
pub use bounds::{Bounds, BoundsError};
pub use network::{Aggregation, Coordinate, Link, Network, NetworkError, Node, Source, WallNodes};
pub use network_draft::{InputBiases, NetworkDraft, NodeDraft};
pub use paper::{GENES, Gene, Genome, GenomeError};
