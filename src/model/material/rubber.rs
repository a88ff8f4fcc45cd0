//! What a law of incompressible rubber is, and what the list of all of them makes.
//!
//! The file of a law says how it is written in a run or scene file ([`NamedLaw`]) and what it stores
//! ([`IncompressibleLaw`], or for a law in the first invariant alone [`FirstInvariantLaw`]). A bulk modulus beside it
//! makes it compressible, and a solid takes the same law: neither asks anything more of it.

use nalgebra::Matrix3;

use super::keys::{InvalidMaterial, Key, LawKeys};
use super::neo_hookean::first_invariant;
use super::solid::{SolidResponse, of_invariants};
use super::{Compressible, Material, OfInvariants, Rubber};

/// A law as a run or scene file names it.
pub(super) trait NamedLaw: Sized + Into<Rubber> {
    /// Its name.
    const NAME: &'static str;

    /// The keys of its own numbers; `bulk_modulus` is every rubber's.
    const KEYS: &'static [Key];

    /// What it wants, for the lines that say that something is missing or surplus.
    const WANTS: &'static str;

    /// The law with the numbers of a file.
    ///
    /// # Errors
    /// [`InvalidMaterial`] when a number is missing or can be none of this law.
    fn read(keys: &LawKeys<'_>) -> Result<Self, InvalidMaterial>;

    /// The law with the numbers of a file and its bulk modulus, where there is one.
    ///
    /// # Errors
    /// As [`Self::read`]; and when a key is surplus, or the volume is softer than the laws are tested for.
    fn material(keys: &LawKeys<'_>) -> Result<Material, InvalidMaterial> {
        let own = Self::KEYS.iter().map(|key| key.name);
        keys.allow(&own.chain([BULK_MODULUS.name]).collect::<Vec<_>>())?;
        with_bulk_modulus(Self::read(keys)?.into(), keys)
    }
}

/// The rubber `law` with the bulk modulus of a file, where there is one.
///
/// # Errors
/// [`InvalidMaterial`] when the volume is softer than the laws are tested for.
pub(super) fn with_bulk_modulus(
    law: Rubber,
    keys: &LawKeys<'_>,
) -> Result<Material, InvalidMaterial> {
    if !keys.has(BULK_MODULUS.name) {
        return Ok(law.into());
    }
    let bulk_modulus = keys.positive(BULK_MODULUS.name)?;
    let least = SOFTEST_VOLUME * law.shear_modulus();
    if bulk_modulus >= least {
        return Ok(Material::Compressible(Compressible { law, bulk_modulus }));
    }
    Err(InvalidMaterial::from(format!(
        "[material] bulk_modulus is {bulk_modulus:?}, but it must be at least {least:.3}, {SOFTEST_VOLUME} of the shear modulus; leave it out for an incompressible wall"
    )))
}

/// The key that makes a rubber compressible.
pub(super) const BULK_MODULUS: Key =
    Key::number("bulk_modulus", "bulk modulus at rest, MPa; incompressible where it is left out");

/// Bulk over shear modulus, a Poisson's ratio of -0.29: the softest volume for which the laws are tested.
const SOFTEST_VOLUME: f64 = 0.3;

/// An incompressible law: in plane stress, and in space where a solid's pressures hold the volume.
pub(super) trait IncompressibleLaw {
    /// The energy density, MPa, at invariants `t` and `j`.
    fn density(&self, t: f64, j: f64) -> OfInvariants;

    /// The energy density alone, MPa.
    fn energy(&self, t: f64, j: f64) -> f64;

    /// The rate of the energy density, MPa, when the volume grows but the shape does not follow:
    /// `d/ds psi(e^(-2s/3) T, e^(-4s/3) J)` at `s = 0`.
    fn dilation_rate(&self, t: f64, j: f64) -> OfInvariants;

    /// The shear modulus at rest, MPa.
    fn shear_modulus(&self) -> f64;

    /// The energy density, MPa, of the shape of a deformation gradient, `J^(-1/3) F`, whose determinant is positive.
    fn solid_energy(&self, f: &Matrix3<f64>) -> f64;

    /// The same with its first, and if asked for its second derivatives.
    fn solid_response(&self, f: &Matrix3<f64>, with_moduli: bool) -> SolidResponse;
}

/// An incompressible law in the first invariant alone.
pub(super) trait FirstInvariantLaw {
    /// `psi` at `x = I1 - 3` and its first three derivatives by `x`, MPa; not a number where the law ends.
    fn of_first(&self, x: f64) -> [f64; 4];
}

impl<L: FirstInvariantLaw> IncompressibleLaw for L {
    fn density(&self, t: f64, j: f64) -> OfInvariants {
        let [psi, d, dd, _] = self.of_first(t + 1.0 / j - 3.0);
        first_invariant(t, j, [1.0, 1.0]).chain([psi, d, dd])
    }

    fn energy(&self, t: f64, j: f64) -> f64 {
        self.of_first(t + 1.0 / j - 3.0)[0]
    }

    fn dilation_rate(&self, t: f64, j: f64) -> OfInvariants {
        let [_, d, dd, ddd] = self.of_first(t + 1.0 / j - 3.0);
        let slope = first_invariant(t, j, [1.0, 1.0]).chain([d, dd, ddd]);
        slope * first_invariant(t, j, [-2.0 / 3.0, 4.0 / 3.0])
    }

    fn shear_modulus(&self) -> f64 {
        2.0 * self.of_first(0.0)[1]
    }

    fn solid_energy(&self, f: &Matrix3<f64>) -> f64 {
        of_invariants::energy(f, |x| self.of_first(x)[0], 0.0)
    }

    fn solid_response(&self, f: &Matrix3<f64>, with_moduli: bool) -> SolidResponse {
        let of_first = |x| {
            let [psi, d, dd, _] = self.of_first(x);
            [psi, d, dd]
        };
        of_invariants::response(f, with_moduli, of_first, 0.0)
    }
}

/// Makes of a list `module: Law, ..` the modules, the choices [`Rubber`] and [`Material`], and the table of the laws
/// that files can name. An enum, so that the innermost loop calls no function that it does not know.
macro_rules! rubbers {
    ($($module:ident: $Law:ident),+ $(,)?) => {
        $(
            mod $module;
            pub use $module::$Law;
        )+

        /// One of the incompressible laws.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Rubber {
            $(#[doc = concat!("[`", stringify!($Law), "`].")] $Law($Law),)+
        }

        /// A hyperelastic law.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Material {
            $(#[doc = concat!("[`", stringify!($Law), "`].")] $Law($Law),)+
            /// [`Compressible`].
            Compressible(Compressible),
            /// [`StVenantKirchhoff`].
            StVenantKirchhoff(StVenantKirchhoff),
        }

        /// The laws that a file can name.
        const LAWS: &[FileLaw] = &[
            $(FileLaw {
                name: <$Law as NamedLaw>::NAME,
                keys: <$Law as NamedLaw>::KEYS,
                wants: <$Law as NamedLaw>::WANTS,
                material: <$Law as NamedLaw>::material,
            },)+
            st_venant_kirchhoff::FILE_LAW,
        ];

        $(
            impl From<$Law> for Rubber {
                fn from(law: $Law) -> Self {
                    Self::$Law(law)
                }
            }
        )+

        impl From<Rubber> for Material {
            fn from(rubber: Rubber) -> Self {
                match rubber {
                    $(Rubber::$Law(law) => Self::$Law(law),)+
                }
            }
        }

        impl Rubber {
            /// Its name in run and scene files.
            #[must_use]
            pub fn name(&self) -> &'static str {
                match self {
                    $(Self::$Law(_) => <$Law as NamedLaw>::NAME,)+
                }
            }
        }

        impl IncompressibleLaw for Rubber {
            #[inline]
            fn density(&self, t: f64, j: f64) -> OfInvariants {
                match self {
                    $(Self::$Law(law) => law.density(t, j),)+
                }
            }

            #[inline]
            fn energy(&self, t: f64, j: f64) -> f64 {
                match self {
                    $(Self::$Law(law) => law.energy(t, j),)+
                }
            }

            #[inline]
            fn dilation_rate(&self, t: f64, j: f64) -> OfInvariants {
                match self {
                    $(Self::$Law(law) => law.dilation_rate(t, j),)+
                }
            }

            fn shear_modulus(&self) -> f64 {
                match self {
                    $(Self::$Law(law) => law.shear_modulus(),)+
                }
            }

            #[inline]
            fn solid_energy(&self, f: &Matrix3<f64>) -> f64 {
                match self {
                    $(Self::$Law(law) => law.solid_energy(f),)+
                }
            }

            #[inline]
            fn solid_response(&self, f: &Matrix3<f64>, with_moduli: bool) -> SolidResponse {
                match self {
                    $(Self::$Law(law) => law.solid_response(f, with_moduli),)+
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

        /// The rubbers of the shared tests, as the file of each law has them.
        #[cfg(test)]
        pub(crate) fn rubbers() -> Vec<Rubber> {
            use test_laws::Example;
            let mut rubbers = Vec::new();
            $(rubbers.extend($Law::examples().into_iter().map(Rubber::$Law));)+
            rubbers
        }

        /// An incompressible law in stretches whose product is 1, as the books write it, MPa.
        #[cfg(test)]
        fn energy_of_shape<D: num_dual::DualNum<Primitive = f64> + Copy>(law: &Rubber, l: [D; 3]) -> D {
            use test_laws::Example;
            match law {
                $(Rubber::$Law(law) => law.energy_of_stretches(l),)+
            }
        }
    };
}
pub(super) use rubbers;
