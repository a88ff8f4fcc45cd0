//! What a law of incompressible rubber stores, in plane stress and in space.
//!
//! Its file says so by [`IncompressibleLaw`], or for a law in the first invariant alone by [`FirstInvariantLaw`]. A bulk modulus
//! beside it makes it compressible, and a solid takes the same law: neither asks anything more of it.

use nalgebra::Matrix3;

use super::of_invariants::{OfInvariants, first_invariant};
use super::solid::{SolidResponse, of_invariants};

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
