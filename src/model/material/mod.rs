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
mod keys;
mod of_invariants;
mod rubber;
mod solid;
mod st_venant_kirchhoff;
mod stability;
#[cfg(test)]
mod test_laws;

pub use compressible::Compressible;
pub use keys::{InvalidMaterial, Key, KeyKind, KeyValue, keys, laws_in_words, positive, within};
pub use of_invariants::OfInvariants;
pub use ogden::OgdenTerm;
pub use solid::{SolidLaw, SolidResponse};
pub use st_venant_kirchhoff::StVenantKirchhoff;
pub use stability::Loading;

use nalgebra::Matrix3;

use keys::FileLaw;
use rubber::{IncompressibleLaw, NamedLaw, rubbers};

// The laws of rubber: each a file beside this one, and a line here.
rubbers! {
    neo_hookean: NeoHookean,
    mooney_rivlin: MooneyRivlin,
    yeoh: Yeoh,
    ogden: Ogden,
}

/// A wall of one material.
impl AsRef<[Material]> for Material {
    fn as_ref(&self) -> &[Material] {
        std::slice::from_ref(self)
    }
}

impl Material {
    /// The one of `materials` with the greatest Young's modulus at rest.
    ///
    /// # Panics
    /// When there is none.
    #[must_use]
    pub fn stiffest(materials: &[Self]) -> &Self {
        let modulus = |material: &&Self| material.young_modulus();
        let stiffest = materials.iter().max_by(|a, b| modulus(a).total_cmp(&modulus(b)));
        stiffest.expect("a wall has a material")
    }

    /// The stretch `l3` across the wall, with derivatives at invariants `T` and `J`.
    ///
    /// It is `1 / sqrt J` where the law is incompressible and 1 for [`StVenantKirchhoff`].
    #[must_use]
    #[inline]
    pub fn thickness_stretch(&self, t: f64, j: f64) -> OfInvariants {
        match self {
            Self::Compressible(law) => law.thickness_stretch(t, j),
            Self::StVenantKirchhoff(_) => OfInvariants { value: 1.0, ..OfInvariants::default() },
            _ => {
                let l3 = 1.0 / j.sqrt();
                OfInvariants::of_j([l3, -0.5 * l3 / j, 0.75 * l3 / (j * j)])
            }
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
