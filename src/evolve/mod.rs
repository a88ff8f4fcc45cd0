//! Who survives? NSGA-II on bounded real genes: several objectives made small, and one constraint violation.
//!
//! [`Nsga2`] is asked for candidates and told how good they are; where and how they are evaluated is not its affair,
//! and it never learns what a gene means.
//!
//! # Decisions
//! - All chance is keyed by (purpose, generation, individual): asking changes nothing, and a checkpoint holds no generator.
//! - Rank and crowding are a function of the population alone: those of the survivors are computed anew, where Deb's
//!   program keeps the crowding of the merged generations. So a checkpoint need not hold them.
//! - Of two individuals that tie in everything the younger survives: on a plateau of equal violation the search drifts on.

mod bounds;
mod crowding;
mod dominance;
mod hypervolume;
mod individual;
mod nsga2;
mod selection;
mod settings;
mod spread;
mod variation;

pub use bounds::{Bounds, InvalidBounds};
pub use crowding::crowding_distances;
pub use dominance::{dominates, fronts};
pub use hypervolume::hypervolume;
pub use individual::{Candidate, Evaluation, Individual, IndividualId, InvalidId};
pub use nsga2::{Checkpoint, InvalidCheckpoint, Nsga2};
pub use settings::{Breeding, Crossover, InvalidSettings, Mutation, Nsga2Settings, Survival};
pub use spread::{Adaptation, spread};
pub use variation::{
    adaptive_feasible_mutation, intermediate_crossover, polynomial_mutation, sbx_crossover,
    uniform_genome,
};
