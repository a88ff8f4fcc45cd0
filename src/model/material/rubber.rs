//! One of the incompressible laws.
//!
//! It is an enum, so that the innermost loop calls no function that it does not know.

use nalgebra::Matrix3;

use super::incompressible_law::IncompressibleLaw;
use super::named_law::NamedLaw;
use super::of_invariants::OfInvariants;
use super::solid::SolidResponse;

macro_rules! rubber {
    ($($Law:ident),+) => {
        /// One of the incompressible laws.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Rubber {
            $(#[doc = concat!("[`", stringify!($Law), "`](super::", stringify!($Law), ").")] $Law(super::$Law),)+
        }

        $(
            impl From<super::$Law> for Rubber {
                fn from(law: super::$Law) -> Self {
                    Self::$Law(law)
                }
            }
        )+

        impl Rubber {
            /// Its name in run and scene files.
            #[must_use]
            pub fn name(&self) -> &'static str {
                match self {
                    $(Self::$Law(_) => <super::$Law as NamedLaw>::NAME,)+
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
    };
}
for_rubbers!(rubber);
