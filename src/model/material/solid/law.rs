//! A rubber as a solid's element has it.

use nalgebra::Matrix3;

use super::response::SolidResponse;
use crate::model::material::incompressible_law::IncompressibleLaw;
use crate::model::material::rubber::Rubber;

/// A rubber's resistance to changes of shape, and what it says about its volume.
#[derive(Clone, Debug, PartialEq)]
pub struct SolidLaw {
    rubber: Rubber,
    shear_modulus: f64,
    bulk_modulus: Option<f64>,
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
