//! What is the energy, what must vanish, and its derivative?
//!
//! A model is a sum of terms over small stencils ([`local::Term`]); [`assembly`] turns terms into the global
//! gradient and Hessian that a solver sees through [`system::System`].

pub mod assembly;
pub mod block;
mod body;
pub mod contact;
mod dirichlet;
mod discretization;
mod edge_support;
pub mod element;
mod free_body;
mod load;
pub mod local;
pub mod material;
mod material_limits;
mod membrane;
mod part_folds;
mod part_limits;
mod part_model;
mod part_picture;
mod part_setup;
mod part_term;
mod patch_loads;
mod patch_model;
mod reaction;
mod rigid_motion;
mod solid_loads;
mod stretch_bound;
pub mod system;
#[cfg(test)]
mod term_suite;
#[cfg(test)]
mod test_shells;
mod tie;

pub use edge_support::{EdgeSupport, EdgeSupports};
pub use element::{Face, ShellState, SolidState};
pub use load::{DeadLoad, FollowerForce};
pub use material_limits::{LimitedQuantity, MaterialLimits, UsedLimit};
pub use membrane::{MembraneState, membrane_states};
pub use part_model::PartModel;
pub use part_picture::{BorneStates, ContactStates, PictureCells};
pub use part_setup::{FoldContact, PartSetup, Support};
pub use patch_loads::PatchLoads;
pub use reaction::Reaction;
pub use rigid_motion::free_motions;
pub use solid_loads::{Cut, SolidLoads};
pub use stretch_bound::DEFAULT_STRETCH_BOUND;
