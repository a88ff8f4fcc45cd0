//! A system around another that changes some of its answers and passes on all others.
//!
//! A decorator says what it is around and what it changes; the two implementations here pass on the rest. They name every
//! method of [`System`] and [`LoadedSystem`]: one that is missing is an error of the lints, so that a method with a default
//! never answers for the system inside.

use std::ops::Range;

use crate::model::system::{
    Inadmissible, Layout, Limit, LoadedSystem, Memory, SparsityPattern, System, Utilization,
};

/// What a decorator is around, and the answers that it may change.
///
/// To let a decorator change another answer, add it here with the inner system's as its default, and ask it below.
pub(super) trait Decorator {
    /// The system inside.
    type Inner: System + ?Sized;

    /// The system inside.
    fn inner(&self) -> &Self::Inner;

    /// The system inside.
    fn inner_mut(&mut self) -> &mut Self::Inner;

    /// [`System::energy`].
    fn energy(&mut self, x: &[f64]) -> Result<f64, Inadmissible> {
        self.inner_mut().energy(x)
    }

    /// [`System::residual`].
    fn residual(&mut self, x: &[f64], residual: &mut [f64]) -> Result<f64, Inadmissible> {
        self.inner_mut().residual(x, residual)
    }

    /// [`System::tangent`].
    fn tangent(
        &mut self,
        x: &[f64],
        residual: &mut [f64],
        tangent: &mut [f64],
    ) -> Result<f64, Inadmissible> {
        self.inner_mut().tangent(x, residual, tangent)
    }

    /// [`System::make_room`].
    fn make_room(&mut self, x: &[f64]) -> bool {
        self.inner_mut().make_room(x)
    }
}

#[deny(clippy::missing_trait_methods)]
impl<D: Decorator> System for D {
    fn pattern(&self) -> &SparsityPattern {
        self.inner().pattern()
    }

    fn energy(&mut self, x: &[f64]) -> Result<f64, Inadmissible> {
        Decorator::energy(self, x)
    }

    fn residual(&mut self, x: &[f64], residual: &mut [f64]) -> Result<f64, Inadmissible> {
        Decorator::residual(self, x, residual)
    }

    fn tangent(
        &mut self,
        x: &[f64],
        residual: &mut [f64],
        tangent: &mut [f64],
    ) -> Result<f64, Inadmissible> {
        Decorator::tangent(self, x, residual, tangent)
    }

    fn longest_step(&self, x: &[f64], dx: &[f64]) -> f64 {
        self.inner().longest_step(x, dx)
    }

    fn force_scale(&self) -> f64 {
        self.inner().force_scale()
    }

    fn energy_rounding(&self) -> f64 {
        self.inner().energy_rounding()
    }

    fn make_room(&mut self, x: &[f64]) -> bool {
        Decorator::make_room(self, x)
    }

    fn multipliers(&self) -> Range<usize> {
        self.inner().multipliers()
    }

    fn stable_negative_pivots(&self) -> usize {
        self.inner().stable_negative_pivots()
    }

    fn layout(&self) -> Option<Layout> {
        self.inner().layout()
    }

    fn set_share(&mut self, share: Option<&[bool]>) {
        self.inner_mut().set_share(share);
    }

    fn is_conservative(&self) -> bool {
        self.inner().is_conservative()
    }

    fn add_circulatory_tangent(&self, x: &[f64], v: &[f64], out: &mut [f64]) {
        self.inner().add_circulatory_tangent(x, v, out);
    }
}

#[deny(clippy::missing_trait_methods)]
impl<D: Decorator<Inner: LoadedSystem>> LoadedSystem for D {
    fn set_load(&mut self, load: f64) {
        self.inner_mut().set_load(load);
    }

    fn conjugate(&self, x: &[f64]) -> f64 {
        self.inner().conjugate(x)
    }

    fn load_direction(&self, x: &[f64], direction: &mut [f64]) {
        self.inner().load_direction(x, direction);
    }

    fn settle(&mut self, x: &[f64]) -> f64 {
        self.inner_mut().settle(x)
    }

    fn memory(&self) -> Memory {
        self.inner().memory()
    }

    fn recall(&mut self, x: &[f64], memory: &Memory) {
        self.inner_mut().recall(x, memory);
    }

    fn refresh(&mut self, x: &[f64]) -> f64 {
        self.inner_mut().refresh(x)
    }

    fn rewind(&mut self) {
        self.inner_mut().rewind();
    }

    fn dissipates(&self) -> bool {
        self.inner().dissipates()
    }

    fn passed_limit(&self, x: &[f64]) -> Option<Limit> {
        self.inner().passed_limit(x)
    }

    fn utilization(&self, x: &[f64]) -> Option<Utilization> {
        self.inner().utilization(x)
    }
}
