//! The law of a wall.

use super::compressible::Compressible;
use super::incompressible_law::IncompressibleLaw;
use super::of_invariants::OfInvariants;
use super::rubber::Rubber;
use super::solid::SolidLaw;
use super::st_venant_kirchhoff::StVenantKirchhoff;

macro_rules! material {
    ($($Law:ident),+) => {
        /// A hyperelastic law.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Material {
            $(#[doc = concat!("[`", stringify!($Law), "`](super::", stringify!($Law), ").")] $Law(super::$Law),)+
            /// [`Compressible`].
            Compressible(Compressible),
            /// [`StVenantKirchhoff`].
            StVenantKirchhoff(StVenantKirchhoff),
        }

        impl From<Rubber> for Material {
            fn from(rubber: Rubber) -> Self {
                match rubber {
                    $(Rubber::$Law(law) => Self::$Law(law),)+
                }
            }
        }

        impl Material {
            /// The stored energy per reference volume, MPa, with derivatives at invariants `T` and `J`.
            #[must_use]
            #[inline]
            pub fn density(&self, t: f64, j: f64) -> OfInvariants {
                match self {
                    $(Self::$Law(law) => law.density(t, j),)+
                    Self::Compressible(law) => law.density(t, j),
                    Self::StVenantKirchhoff(law) => law.density(t, j),
                }
            }

            /// The stored energy per reference volume alone, MPa.
            #[must_use]
            #[inline]
            pub fn energy(&self, t: f64, j: f64) -> f64 {
                match self {
                    $(Self::$Law(law) => law.energy(t, j),)+
                    Self::Compressible(law) => law.energy(t, j),
                    Self::StVenantKirchhoff(law) => law.energy(t, j),
                }
            }

            /// The shear modulus at rest, MPa.
            #[must_use]
            pub fn shear_modulus(&self) -> f64 {
                match self {
                    $(Self::$Law(law) => law.shear_modulus(),)+
                    Self::Compressible(law) => law.law.shear_modulus(),
                    Self::StVenantKirchhoff(law) => law.shear_modulus(),
                }
            }

            /// The law of shape and the bulk modulus, MPa, `None` of an incompressible rubber; `None` of
            /// [`StVenantKirchhoff`], which is a law of thin walls.
            #[must_use]
            pub fn rubber(&self) -> Option<(Rubber, Option<f64>)> {
                match self.clone() {
                    $(Self::$Law(law) => Some((Rubber::$Law(law), None)),)+
                    Self::Compressible(Compressible { law, bulk_modulus }) => Some((law, Some(bulk_modulus))),
                    Self::StVenantKirchhoff(_) => None,
                }
            }
        }
    };
}
for_rubbers!(material);

/// A wall of one material.
impl AsRef<[Material]> for Material {
    fn as_ref(&self) -> &[Material] {
        std::slice::from_ref(self)
    }
}

impl Material {
    /// The law of a rubber with this bulk modulus, MPa; none where it is incompressible.
    pub(super) fn of_rubber(law: Rubber, bulk_modulus: Option<f64>) -> Self {
        match bulk_modulus {
            None => law.into(),
            Some(bulk_modulus) => Self::Compressible(Compressible { law, bulk_modulus }),
        }
    }

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

    /// The law in three dimensions; none of [`Material::StVenantKirchhoff`], which is a law of thin walls.
    #[must_use]
    pub fn solid(&self) -> Option<SolidLaw> {
        self.rubber().map(|(rubber, bulk_modulus)| SolidLaw::new(&rubber, bulk_modulus))
    }
}
