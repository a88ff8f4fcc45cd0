//! The laws of rubber in three dimensions: what a solid's element needs of them.
//!
//! ```text
//! psi(F)  = psi_iso(F) + U(det F)        psi_iso(F) = psi_law(J^(-1/3) F),    J = det F         (Flory's split)
//! P       = d psi_iso / dF               A = d2 psi_iso / dF dF
//! ```
//!
//! Only `psi_iso` is made here, and it is the law of shape of the shell's [`super::Compressible`]: shell and solid are the
//! same rubber. `U = kappa/2 (J - 1)^2`, or the constraint `J = 1` where the rubber is incompressible, belongs to the
//! element, whose pressures carry it.
//!
//! The laws in the invariants of `C = F^T F` have closed tensor formulas (`of_invariants.rs`); Ogden's powers go through
//! the principal stretches (`of_stretches.rs`).
//!
//! Source: Flory (1961).

mod law;
pub(super) mod of_invariants;
pub(super) mod of_stretches;
mod response;
#[cfg(test)]
mod tests;

pub use law::SolidLaw;
pub use response::SolidResponse;
