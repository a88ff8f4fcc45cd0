//! What the designs of a run inherit, by one name for all that reads and writes a run.
//!
//! # Decisions
//! - Run files know one representation, so its type has a name here and is no parameter of the room.
//!   Where they are to choose among several, [`Inherited`] becomes an enum of them that implements
//!   [`Representation`] by asking the one chosen.

use crate::evolve;
use crate::genome::{Paper, Representation};

/// The representation of a run's designs; its genomes stand for networks.
pub(crate) type Inherited = Paper;

/// What one design has inherited.
pub(crate) type Genome = <Inherited as Representation>::Genome;

pub(crate) type Candidate = evolve::Candidate<Genome>;
pub(crate) type Individual = evolve::Individual<Genome>;
pub(crate) type Nsga2 = evolve::Nsga2<Inherited>;
pub(crate) type Checkpoint = evolve::Checkpoint<Inherited>;

/// The genes of `[genes]` in a run file: name and bounds `[lower, upper]` of each.
pub(crate) fn named_bounds(inherited: &Inherited) -> impl Iterator<Item = (String, [f64; 2])> {
    let intervals = inherited.bounds().intervals().iter();
    inherited
        .genes()
        .zip(intervals)
        .map(|(gene, &(lower, upper))| (gene.name.to_owned(), [lower, upper]))
}

/// What a reader is shown of `genome`: name and value of each gene.
#[cfg(feature = "monitor")]
pub(crate) fn named_genes(
    inherited: &Inherited,
    genome: &Genome,
) -> impl Iterator<Item = (&'static str, f64)> {
    inherited.genes().zip(genome.genes()).map(|(gene, &value)| (gene.name, value))
}
