//! A system held back by viscosity: one implicit step of the overdamped motion `damping dx/dt = -R`.
//!
//! ```text
//! E(x) + damping / 2 |x - anchor|^2
//! ```
//!
//! Multipliers are not held back: they do not move, they only bear on what does.

use std::ops::Range;

use crate::model::system::{
    Inadmissible, Layout, Limit, LoadedSystem, Memory, SparsityPattern, System,
};

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

impl System for Damped<'_> {
    fn pattern(&self) -> &SparsityPattern {
        self.system.pattern()
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

    fn longest_step(&self, x: &[f64], dx: &[f64]) -> f64 {
        self.system.longest_step(x, dx)
    }

    fn force_scale(&self) -> f64 {
        self.system.force_scale()
    }

    fn energy_rounding(&self) -> f64 {
        self.system.energy_rounding()
    }

    fn is_conservative(&self) -> bool {
        self.system.is_conservative()
    }

    fn add_circulatory_tangent(&self, x: &[f64], v: &[f64], out: &mut [f64]) {
        self.system.add_circulatory_tangent(x, v, out);
    }

    fn make_room(&mut self, x: &[f64]) -> bool {
        self.system.make_room(x)
    }

    fn multipliers(&self) -> Range<usize> {
        self.system.multipliers()
    }

    fn stable_negative_pivots(&self) -> usize {
        self.system.stable_negative_pivots()
    }

    fn layout(&self) -> Option<Layout> {
        self.system.layout()
    }

    fn set_share(&mut self, share: Option<&[bool]>) {
        self.system.set_share(share);
    }
}

impl LoadedSystem for Damped<'_> {
    fn set_load(&mut self, load: f64) {
        self.system.set_load(load);
    }

    fn conjugate(&self, x: &[f64]) -> f64 {
        self.system.conjugate(x)
    }

    fn load_direction(&self, x: &[f64], direction: &mut [f64]) {
        self.system.load_direction(x, direction);
    }

    fn settle(&mut self, x: &[f64]) -> f64 {
        self.system.settle(x)
    }

    fn memory(&self) -> Memory {
        self.system.memory()
    }

    fn recall(&mut self, x: &[f64], memory: &Memory) {
        self.system.recall(x, memory);
    }

    fn refresh(&mut self, x: &[f64]) -> f64 {
        self.system.refresh(x)
    }

    fn rewind(&mut self) {
        self.system.rewind();
    }

    fn dissipates(&self) -> bool {
        self.system.dissipates()
    }

    fn passed_limit(&self, x: &[f64]) -> Option<Limit> {
        self.system.passed_limit(x)
    }
}
