//! A system with a clock, and a note of whether the line search found it defined anywhere.

use super::decorator::Decorator;
use crate::math::cpu_seconds;
use crate::model::system::{Inadmissible, System};

/// A system as it is, adding up what its evaluations cost.
pub(super) struct Observed<'a> {
    system: &'a mut dyn System,
    seconds: f64,
    admissible: usize,
    inadmissible: usize,
}

impl<'a> Observed<'a> {
    pub(super) fn new(system: &'a mut dyn System) -> Self {
        Self { system, seconds: 0.0, admissible: 0, inadmissible: 0 }
    }

    /// CPU time of all evaluations, s.
    pub(super) fn seconds(&self) -> f64 {
        self.seconds
    }

    /// Starts counting admissible states anew.
    pub(super) fn forget_admissible(&mut self) {
        (self.admissible, self.inadmissible) = (0, 0);
    }

    /// Were there energies or residuals asked for, and none defined?
    pub(super) fn met_only_inadmissible(&self) -> bool {
        self.admissible == 0 && self.inadmissible > 0
    }

    fn note(&mut self, energy: Result<f64, Inadmissible>) -> Result<f64, Inadmissible> {
        match energy {
            Ok(_) => self.admissible += 1,
            Err(_) => self.inadmissible += 1,
        }
        energy
    }

    fn timed<T>(&mut self, evaluate: impl FnOnce(&mut dyn System) -> T) -> T {
        let start = cpu_seconds();
        let value = evaluate(self.system);
        self.seconds += cpu_seconds() - start;
        value
    }
}

impl<'a> Decorator for Observed<'a> {
    type Inner = dyn System + 'a;

    fn inner(&self) -> &Self::Inner {
        self.system
    }

    fn inner_mut(&mut self) -> &mut Self::Inner {
        self.system
    }

    fn energy(&mut self, x: &[f64]) -> Result<f64, Inadmissible> {
        let energy = self.timed(|system| system.energy(x));
        self.note(energy)
    }

    fn residual(&mut self, x: &[f64], residual: &mut [f64]) -> Result<f64, Inadmissible> {
        let energy = self.timed(|system| system.residual(x, residual));
        self.note(energy)
    }

    fn tangent(
        &mut self,
        x: &[f64],
        residual: &mut [f64],
        tangent: &mut [f64],
    ) -> Result<f64, Inadmissible> {
        self.timed(|system| system.tangent(x, residual, tangent))
    }

    fn make_room(&mut self, x: &[f64]) -> bool {
        self.timed(|system| system.make_room(x))
    }
}
