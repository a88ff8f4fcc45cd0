//! What a genome is: how genomes are drawn, mixed, changed and compared, and what one stands for.
//!
//! Evolution knows a genome by this trait alone, and never asks what it stands for; an evaluation
//! wants a representation whose phenotype is a [`Network`](super::Network).

use std::fmt::Debug;

use rand::Rng;
use schemars::JsonSchema;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

/// A kind of genomes.
///
/// Its value holds what all genomes of a search have in common, such as bounds or a topology, and
/// is part of a checkpoint. All chance is that of the generators passed in.
pub trait Representation:
    Clone + Debug + PartialEq + Serialize + DeserializeOwned + Send + Sync
{
    /// What is inherited. Its JSON text must keep every bit, because a genome that is met again is
    /// known by it.
    type Genome: Clone + Debug + PartialEq + Serialize + DeserializeOwned + Send + Sync;

    /// What a genome stands for.
    type Phenotype;

    /// The name in checkpoints, which no other representation has.
    fn key(&self) -> &'static str;

    /// A genome of the first generation.
    fn random(&self, rng: &mut impl Rng) -> Self::Genome;

    /// A child of two parents (crossover).
    fn mix(
        &self,
        parents: [&Self::Genome; 2],
        operators: &Operators,
        rng: &mut impl Rng,
    ) -> Self::Genome;

    /// A child of one parent (mutation).
    fn mutate(
        &self,
        parent: &Self::Genome,
        operators: &Operators,
        rng: &mut impl Rng,
    ) -> Self::Genome;

    /// How different two genomes are: 0 for equal ones, in a unit of the representation's own.
    fn distance(&self, a: &Self::Genome, b: &Self::Genome) -> f64;

    /// Whether `genome` is one that this representation draws, mixes and changes.
    fn contains(&self, genome: &Self::Genome) -> bool;

    /// What `genome` stands for.
    fn express(&self, genome: &Self::Genome) -> Self::Phenotype;
}

/// How children are made, as settings choose; a representation follows what applies to its genomes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Operators {
    /// How two parents are mixed.
    pub crossover: Crossover,
    /// Spread of the simulated binary crossover: the larger, the nearer a child is to its parents.
    pub crossover_eta: f64,
    /// How one parent is changed.
    pub mutation: Mutation,
    /// Spread of the polynomial mutation: the larger, the nearer a child is to its parent.
    pub mutation_eta: f64,
    /// Probability that a gene mutates, in a child that does; one gene in the genome when not
    /// given.
    pub mutation_probability: Option<f64>,
    /// Length of an adaptive mutation, in widths of the bounds; 0 to 1.
    pub step: f64,
}

/// How two parents are mixed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Crossover {
    /// Simulated binary crossover.
    Sbx,
    /// A random point between the parents, gene by gene.
    Intermediate,
}

/// How one parent is changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Mutation {
    /// Some genes, each by a polynomially distributed step.
    Polynomial,
    /// All genes, by one step in a random direction, as long as the front's spread tells.
    AdaptiveFeasible,
}
