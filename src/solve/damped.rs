//! A system held back by viscosity: one implicit step of the overdamped motion `damping dx/dt = -R`.
//!
//! ```text
//! E(x) + damping / 2 |x - anchor|^2
//! ```
//!
//! Multipliers are not held back: they do not move, they only bear on what does.

use super::decorator::Decorator;
use crate::model::system::{Inadmissible, LoadedSystem};

/// A system on a viscous bed that lets it rest at `anchor`.
pub(super) struct Damped<'a> {
    pub(super) system: &'a mut dyn LoadedSystem,
    pub(super) anchor: Vec<f64>,
    /// N/mm.
    pub(super) damping: f64,
}

impl Damped<'_> {
    fn energy_of_bed(&self, x: &[f64]) -> f64 {
        let moved = self.moving().map(|i| x[i] - self.anchor[i]);
        0.5 * self.damping * moved.map(|moved| moved * moved).sum::<f64>()
    }

    fn add_force_of_bed(&self, x: &[f64], residual: &mut [f64]) {
        for i in self.moving() {
            residual[i] += self.damping * (x[i] - self.anchor[i]);
        }
    }

    fn moving(&self) -> impl Iterator<Item = usize> + use<> {
        let multipliers = self.system.multipliers();
        (0..self.anchor.len()).filter(move |i| !multipliers.contains(i))
    }
}

impl<'a> Decorator for Damped<'a> {
    type Inner = dyn LoadedSystem + 'a;

    fn inner(&self) -> &Self::Inner {
        self.system
    }

    fn inner_mut(&mut self) -> &mut Self::Inner {
        self.system
    }

    fn energy(&mut self, x: &[f64]) -> Result<f64, Inadmissible> {
        Ok(self.system.energy(x)? + self.energy_of_bed(x))
    }

    fn residual(&mut self, x: &[f64], residual: &mut [f64]) -> Result<f64, Inadmissible> {
        let energy = self.system.residual(x, residual)?;
        self.add_force_of_bed(x, residual);
        Ok(energy + self.energy_of_bed(x))
    }

    fn tangent(
        &mut self,
        x: &[f64],
        residual: &mut [f64],
        tangent: &mut [f64],
    ) -> Result<f64, Inadmissible> {
        let energy = self.system.tangent(x, residual, tangent)?;
        self.add_force_of_bed(x, residual);
        let multipliers = self.system.multipliers();
        for (i, diagonal) in self.system.pattern().diagonal().enumerate() {
            if !multipliers.contains(&i) {
                tangent[diagonal] += self.damping;
            }
        }
        Ok(energy + self.energy_of_bed(x))
    }
}
