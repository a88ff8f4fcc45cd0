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

pub(super) mod of_invariants;
pub(super) mod of_stretches;
#[cfg(test)]
mod tests;

use nalgebra::Matrix3;

use super::rubber::IncompressibleLaw;
use super::{Material, Rubber};

/// A rubber's resistance to changes of shape, and what it says about its volume.
#[derive(Clone, Debug, PartialEq)]
pub struct SolidLaw {
    rubber: Rubber,
    shear_modulus: f64,
    bulk_modulus: Option<f64>,
}

/// How a law resists a change of shape at one deformation gradient.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolidResponse {
    /// `psi_iso`, MPa.
    pub energy: f64,
    /// The first Piola-Kirchhoff stress `P = d psi_iso / dF`, MPa.
    pub stress: Matrix3<f64>,
    /// `moduli[J][L](i, k) = d P_iJ / d F_kL`, MPa; `moduli[L][J]` is the transpose of `moduli[J][L]`.
    ///
    /// Zero unless they were asked for.
    pub moduli: [[Matrix3<f64>; 3]; 3],
}

impl SolidLaw {
    /// The law of a rubber with this bulk modulus, MPa; none where it is incompressible.
    #[must_use]
    pub fn new(rubber: &Rubber, bulk_modulus: Option<f64>) -> Self {
        Self { rubber: rubber.clone(), shear_modulus: rubber.shear_modulus(), bulk_modulus }
    }

    /// The bulk modulus, MPa; none where the rubber is incompressible.
    #[must_use]
    pub fn bulk_modulus(&self) -> Option<f64> {
        self.bulk_modulus
    }

    /// The shear modulus at rest, MPa.
    #[must_use]
    pub fn shear_modulus(&self) -> f64 {
        self.shear_modulus
    }

    /// `psi_iso` at a deformation gradient whose determinant is positive, MPa.
    #[must_use]
    #[inline]
    pub fn energy(&self, f: &Matrix3<f64>) -> f64 {
        self.rubber.solid_energy(f)
    }

    /// `psi_iso` with its first, and if asked for its second derivatives, at a deformation gradient whose determinant
    /// is positive.
    #[must_use]
    #[inline]
    pub fn response(&self, f: &Matrix3<f64>, with_moduli: bool) -> SolidResponse {
        self.rubber.solid_response(f, with_moduli)
    }
}

impl Material {
    /// The law in three dimensions; none of [`Material::StVenantKirchhoff`], which is a law of thin walls.
    #[must_use]
    pub fn solid(&self) -> Option<SolidLaw> {
        self.rubber().map(|(rubber, bulk_modulus)| SolidLaw::new(&rubber, bulk_modulus))
    }
}

/// The blocks of moduli on and below the diagonal.
const LOWER: [[usize; 2]; 6] = [[0, 0], [1, 0], [1, 1], [2, 0], [2, 1], [2, 2]];

/// Fills the blocks above the diagonal.
#[inline]
fn mirror(moduli: &mut [[Matrix3<f64>; 3]; 3]) {
    for [j, l] in [[1, 0], [2, 0], [2, 1]] {
        moduli[l][j] = moduli[j][l].transpose();
    }
}
