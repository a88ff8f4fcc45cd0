//! Which state makes the residual vanish? Newton's method, linear solvers, and the loading path.
//!
//! Two solvers stand behind [`EquilibriumSolver`]: ours with `faer`, and PETSc's SNES with MUMPS.
//! Both run the same line search on the energy, so that they walk through the same iterates.

mod at_limit;
mod backend;
mod bordered;
mod confined;
mod counts;
mod curve;
mod damped;
mod decorator;
mod ending;
mod equilibrium_solver;
mod factor;
mod follow;
mod hermite;
mod job;
mod krylov;
#[cfg(feature = "petsc")]
mod lanczos;
mod limit_search;
#[cfg(test)]
mod limit_tests;
mod line_search;
mod linear;
mod linear_method;
mod message;
mod native;
mod newton;
mod observed;
mod past;
mod past_limit;
mod path;
#[cfg(test)]
mod path_tests;
#[cfg(feature = "petsc")]
mod petsc;
mod prediction;
mod secants;
mod shift;
mod snap;
#[cfg(test)]
mod solver_suite;
mod stability_loss;
mod stop;
mod supply;
#[cfg(test)]
mod test_systems;
mod vectors;
mod walk;

pub use backend::Backend;
pub use confined::confined;
pub use counts::SolveCounts;
pub use ending::Ending;
pub use equilibrium_solver::{EquilibriumSolver, SolveTimes, SolverFailure};
pub use follow::{follow, follow_from, follow_watched};
pub use hermite::{Cubic, Segment, hermite_basis};
pub use job::Job;
pub use krylov::{KrylovReport, solve_unsymmetric};
pub use linear::linear_path;
pub use linear_method::LinearMethod;
pub use message::Message;
pub use native::NativeSolver;
pub use newton::{NewtonEnding, NewtonReport, NewtonSettings};
pub use path::{Path, PathPoint, PathSettings, Programme, Snap};
#[cfg(feature = "petsc")]
pub use petsc::Snes;
pub use stop::Stop;
pub use supply::Supply;
