//! What every incompressible rubber has, and the choice among them.

use super::{MooneyRivlin, NeoHookean, OfInvariants, Ogden, Yeoh};

/// An incompressible law in plane stress.
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
}

/// One of the incompressible laws.
#[derive(Clone, Debug, PartialEq)]
pub enum Rubber {
    /// [`NeoHookean`].
    NeoHookean(NeoHookean),
    /// [`MooneyRivlin`].
    MooneyRivlin(MooneyRivlin),
    /// [`Yeoh`].
    Yeoh(Yeoh),
    /// [`Ogden`].
    Ogden(Ogden),
}

impl Rubber {
    #[inline]
    pub(super) fn law(&self) -> &dyn IncompressibleLaw {
        match self {
            Self::NeoHookean(law) => law,
            Self::MooneyRivlin(law) => law,
            Self::Yeoh(law) => law,
            Self::Ogden(law) => law,
        }
    }
}
