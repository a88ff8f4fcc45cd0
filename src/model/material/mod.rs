//! Constitutive laws of a hyperelastic wall in plane stress.
//!
//! The two in-plane principal stretches `l1, l2` enter through two smooth invariants of the in-plane metrics
//! `G` (reference) and `g` (current); the third stretch is the one at which the normal stress vanishes,
//! `1 / (l1 l2)` where the wall is incompressible.
//!
//! ```text
//! T = tr(G^-1 g) = l1^2 + l2^2          J = det g / det G = (l1 l2)^2
//! ```

mod compressible;
mod mooney_rivlin;
mod neo_hookean;
mod of_invariants;
mod ogden;
mod rubber;
mod solid;
mod st_venant_kirchhoff;
mod stability;
#[cfg(test)]
mod test_laws;
mod yeoh;

pub use compressible::Compressible;
pub use mooney_rivlin::MooneyRivlin;
pub use neo_hookean::NeoHookean;
pub use of_invariants::OfInvariants;
pub use ogden::{Ogden, OgdenTerm};
pub use rubber::Rubber;
pub use solid::{SolidLaw, SolidResponse};
pub use st_venant_kirchhoff::StVenantKirchhoff;
pub use stability::Loading;
pub use yeoh::Yeoh;

use rubber::IncompressibleLaw;

/// A hyperelastic law.
#[derive(Clone, Debug, PartialEq)]
pub enum Material {
    /// [`NeoHookean`].
    NeoHookean(NeoHookean),
    /// [`MooneyRivlin`].
    MooneyRivlin(MooneyRivlin),
    /// [`Yeoh`].
    Yeoh(Yeoh),
    /// [`Ogden`].
    Ogden(Ogden),
    /// [`Compressible`].
    Compressible(Compressible),
    /// [`StVenantKirchhoff`].
    StVenantKirchhoff(StVenantKirchhoff),
}

impl Material {
    /// The stored energy per reference volume, MPa, with derivatives at invariants `T` and `J`.
    #[must_use]
    #[inline]
    pub fn density(&self, t: f64, j: f64) -> OfInvariants {
        match self {
            Self::NeoHookean(law) => law.density(t, j),
            Self::MooneyRivlin(law) => law.density(t, j),
            Self::Yeoh(law) => law.density(t, j),
            Self::Ogden(law) => law.density(t, j),
            Self::Compressible(law) => law.density(t, j),
            Self::StVenantKirchhoff(law) => law.density(t, j),
        }
    }

    /// The stored energy per reference volume alone, MPa.
    #[must_use]
    #[inline]
    pub fn energy(&self, t: f64, j: f64) -> f64 {
        match self {
            Self::NeoHookean(law) => law.energy(t, j),
            Self::MooneyRivlin(law) => law.energy(t, j),
            Self::Yeoh(law) => law.energy(t, j),
            Self::Ogden(law) => law.energy(t, j),
            Self::Compressible(law) => law.energy(t, j),
            Self::StVenantKirchhoff(law) => law.energy(t, j),
        }
    }

    /// The stretch `l3` across the wall, with derivatives at invariants `T` and `J`.
    ///
    /// It is `1 / sqrt J` where the law is incompressible and 1 for [`StVenantKirchhoff`].
    #[must_use]
    #[inline]
    pub fn thickness_stretch(&self, t: f64, j: f64) -> OfInvariants {
        match self {
            Self::NeoHookean(_) | Self::MooneyRivlin(_) | Self::Yeoh(_) | Self::Ogden(_) => {
                let l3 = 1.0 / j.sqrt();
                OfInvariants::of_j([l3, -0.5 * l3 / j, 0.75 * l3 / (j * j)])
            }
            Self::Compressible(law) => law.thickness_stretch(t, j),
            Self::StVenantKirchhoff(_) => OfInvariants { value: 1.0, ..OfInvariants::default() },
        }
    }

    /// The shear modulus at rest, MPa.
    #[must_use]
    pub fn shear_modulus(&self) -> f64 {
        match self {
            Self::NeoHookean(law) => law.shear_modulus(),
            Self::MooneyRivlin(law) => law.shear_modulus(),
            Self::Yeoh(law) => law.shear_modulus(),
            Self::Ogden(law) => law.shear_modulus(),
            Self::Compressible(Compressible { law, .. }) => law.law().shear_modulus(),
            Self::StVenantKirchhoff(law) => 0.5 * law.young_modulus / (1.0 + law.poisson_ratio),
        }
    }

    /// Poisson's ratio at rest.
    #[must_use]
    pub fn poisson_ratio(&self) -> f64 {
        match self {
            Self::Compressible(law) => {
                let (k, mu) = (law.bulk_modulus, self.shear_modulus());
                0.5 * (3.0 * k - 2.0 * mu) / (3.0 * k + mu)
            }
            Self::StVenantKirchhoff(law) => law.poisson_ratio,
            _ => 0.5,
        }
    }

    /// Young's modulus at rest, MPa.
    #[must_use]
    pub fn young_modulus(&self) -> f64 {
        2.0 * self.shear_modulus() * (1.0 + self.poisson_ratio())
    }
}

impl From<Rubber> for Material {
    fn from(rubber: Rubber) -> Self {
        match rubber {
            Rubber::NeoHookean(law) => Self::NeoHookean(law),
            Rubber::MooneyRivlin(law) => Self::MooneyRivlin(law),
            Rubber::Yeoh(law) => Self::Yeoh(law),
            Rubber::Ogden(law) => Self::Ogden(law),
        }
    }
}
