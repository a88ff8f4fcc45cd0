//! The neo-Hookean law.
//!
//! ```text
//! psi = mu/2 (T + 1/J - 3)
//! ```

use super::EnergyDensity;

/// Incompressible neo-Hookean rubber. Source: Treloar (1943).
#[derive(Clone, Debug, PartialEq)]
pub struct NeoHookean {
    /// Shear modulus, MPa.
    pub mu: f64,
}

impl NeoHookean {
    #[inline]
    pub(super) fn density(&self, t: f64, j: f64) -> EnergyDensity {
        let half_mu = 0.5 * self.mu;
        EnergyDensity {
            value: self.energy(t, j),
            first: [half_mu, -half_mu / (j * j)],
            second: [0.0, 0.0, self.mu / (j * j * j)],
        }
    }

    #[inline]
    pub(super) fn energy(&self, t: f64, j: f64) -> f64 {
        0.5 * self.mu * (t + 1.0 / j - 3.0)
    }
}
