//! Small systems with known answers.

use std::cmp::Ordering;

use super::decorator::Decorator;
use crate::model::system::{Inadmissible, SparsityPattern, System};

/// A chain of unknowns: a term on each, a term on each difference of neighbours, `x[-1] = 0` if held.
///
/// ```text
/// E = sum_i own(x_i) + sum_i link(x_i - x_(i-1))
/// ```
///
/// Columns hold 2 x 2 diagonal blocks, so that there are entries above the diagonal, to be ignored.
pub(super) struct Chain {
    own: Term,
    link: Term,
    held: bool,
    /// Force on the last unknown.
    load: f64,
    pattern: SparsityPattern,
    /// What is written above the diagonal.
    pub(super) above: f64,
    pub(super) force_scale: f64,
    longest_step: f64,
}

/// Energy, derivative and second derivative of one number.
pub(super) type Term = fn(f64) -> Result<[f64; 3], Inadmissible>;

impl Chain {
    pub(super) fn new(order: usize, own: Term, link: Term, held: bool) -> Self {
        let (mut column_starts, mut row_indices) = (vec![0], Vec::new());
        for column in 0..order {
            let block = column - column % 2;
            row_indices.extend((block..order.min(column + 2)).map(|row| row as u32));
            column_starts.push(row_indices.len() as u32);
        }
        let pattern = SparsityPattern { column_starts, row_indices };
        let (load, above, force_scale) = (0.0, f64::NAN, 1.0);
        Self { own, link, held, load, pattern, above, force_scale, longest_step: 1.0 }
    }

    /// Cubic springs from a wall; the force `e + e^3` stretches each by `e`.
    pub(super) fn hardening(order: usize, load: f64) -> Self {
        let spring: Term =
            |e| Ok([e * e / 2.0 + e.powi(4) / 4.0, e + e.powi(3), 1.0 + 3.0 * e * e]);
        Self { load, ..Self::new(order, nothing, spring, true) }
    }

    /// Bistable unknowns, weakly tied: minima at all +1 and at all -1, a maximum at 0.
    pub(super) fn double_well(order: usize) -> Self {
        let well: Term = |x| Ok([(x * x - 1.0).powi(2) / 4.0, x.powi(3) - x, 3.0 * x * x - 1.0]);
        let tie: Term = |e| Ok([0.05 * e * e, 0.1 * e, 0.1]);
        Self::new(order, well, tie, false)
    }

    /// `x - ln x` on each unknown, defined for `x > 0`; equilibrium at all 1.
    pub(super) fn barrier(order: usize) -> Self {
        let barrier: Term = |x| {
            if x > 0.0 {
                Ok([x - x.ln(), 1.0 - 1.0 / x, 1.0 / (x * x)])
            } else {
                Err(Inadmissible("behind the barrier"))
            }
        };
        Self::new(order, barrier, nothing, false)
    }

    /// Linear springs, and soft or negative springs to the ground: eigenvalues `g + 2 - 2 cos(k pi / (n + 1))`.
    pub(super) fn linear(order: usize, own: Term) -> Self {
        let spring: Term = |e| Ok([e * e / 2.0, e, 1.0]);
        Self::new(order, own, spring, true)
    }

    fn link_ends(&self, index: usize, x: &[f64]) -> f64 {
        if index > 0 { x[index] - x[index - 1] } else { x[0] }
    }

    fn first_link(&self) -> usize {
        usize::from(!self.held)
    }
}

impl System for Chain {
    fn pattern(&self) -> &SparsityPattern {
        &self.pattern
    }

    fn energy(&mut self, x: &[f64]) -> Result<f64, Inadmissible> {
        let mut energy = -self.load * x[x.len() - 1];
        for &value in x {
            energy += (self.own)(value)?[0];
        }
        for index in self.first_link()..x.len() {
            energy += (self.link)(self.link_ends(index, x))?[0];
        }
        Ok(energy)
    }

    fn residual(&mut self, x: &[f64], residual: &mut [f64]) -> Result<f64, Inadmissible> {
        for (residual, &value) in residual.iter_mut().zip(x) {
            *residual = (self.own)(value)?[1];
        }
        residual[x.len() - 1] -= self.load;
        for index in self.first_link()..x.len() {
            let [_, force, _] = (self.link)(self.link_ends(index, x))?;
            residual[index] += force;
            if index > 0 {
                residual[index - 1] -= force;
            }
        }
        self.energy(x)
    }

    fn tangent(
        &mut self,
        x: &[f64],
        residual: &mut [f64],
        tangent: &mut [f64],
    ) -> Result<f64, Inadmissible> {
        let order = x.len();
        let stiffness = |index: usize| -> Result<f64, Inadmissible> {
            if index < self.first_link() || index == order {
                return Ok(0.0);
            }
            Ok((self.link)(self.link_ends(index, x))?[2])
        };
        let bounds = self.pattern.column_starts.windows(2);
        for ((column, &value), bounds) in x.iter().enumerate().zip(bounds) {
            let stored = bounds[0] as usize..bounds[1] as usize;
            let rows = &self.pattern.row_indices[stored.clone()];
            for (entry, &row) in tangent[stored].iter_mut().zip(rows) {
                let row = row as usize;
                *entry = match row.cmp(&column) {
                    Ordering::Less => self.above,
                    Ordering::Equal => {
                        (self.own)(value)?[2] + stiffness(column)? + stiffness(column + 1)?
                    }
                    Ordering::Greater => -stiffness(row)?,
                };
            }
        }
        self.residual(x, residual)
    }

    fn longest_step(&self, _: &[f64], _: &[f64]) -> f64 {
        self.longest_step
    }

    fn force_scale(&self) -> f64 {
        self.force_scale
    }
}

pub(super) fn nothing(_: f64) -> Result<[f64; 3], Inadmissible> {
    Ok([0.0; 3])
}

/// A system whose answers are changed on their way: to fail, to lie, to panic.
pub(super) struct Changed<S> {
    pub(super) system: S,
    pub(super) energy: fn(f64, &[f64]) -> Result<f64, Inadmissible>,
    pub(super) residual: fn(&mut [f64]),
    pub(super) tangent: fn(&mut [f64]) -> Result<(), Inadmissible>,
}

impl<S> Changed<S> {
    pub(super) fn new(system: S) -> Self {
        Self { system, energy: |energy, _| Ok(energy), residual: |_| {}, tangent: |_| Ok(()) }
    }
}

impl<S: System> Decorator for Changed<S> {
    type Inner = S;

    fn inner(&self) -> &S {
        &self.system
    }

    fn inner_mut(&mut self) -> &mut S {
        &mut self.system
    }

    fn energy(&mut self, x: &[f64]) -> Result<f64, Inadmissible> {
        (self.energy)(self.system.energy(x)?, x)
    }

    fn residual(&mut self, x: &[f64], residual: &mut [f64]) -> Result<f64, Inadmissible> {
        let energy = self.system.residual(x, residual)?;
        (self.residual)(residual);
        (self.energy)(energy, x)
    }

    fn tangent(
        &mut self,
        x: &[f64],
        residual: &mut [f64],
        tangent: &mut [f64],
    ) -> Result<f64, Inadmissible> {
        let energy = self.system.tangent(x, residual, tangent)?;
        (self.residual)(residual);
        (self.tangent)(tangent)?;
        (self.energy)(energy, x)
    }
}

/// `E = sum x_i^2 / 2 + p (sum x_i - 1)`: the last unknown is a multiplier with a zero on the diagonal.
pub(super) struct Constrained(pub(super) SparsityPattern);

impl System for Constrained {
    fn pattern(&self) -> &SparsityPattern {
        &self.0
    }

    fn energy(&mut self, x: &[f64]) -> Result<f64, Inadmissible> {
        let [a, b, p] = [x[0], x[1], x[2]];
        Ok((a * a + b * b) / 2.0 + p * (a + b - 1.0))
    }

    fn residual(&mut self, x: &[f64], residual: &mut [f64]) -> Result<f64, Inadmissible> {
        let [a, b, p] = [x[0], x[1], x[2]];
        residual.copy_from_slice(&[a + p, b + p, a + b - 1.0]);
        self.energy(x)
    }

    fn tangent(
        &mut self,
        x: &[f64],
        residual: &mut [f64],
        tangent: &mut [f64],
    ) -> Result<f64, Inadmissible> {
        tangent.copy_from_slice(&[1.0, 1.0, 1.0, 1.0, 0.0]);
        self.residual(x, residual)
    }

    fn force_scale(&self) -> f64 {
        1.0
    }

    fn stable_negative_pivots(&self) -> usize {
        1
    }
}

/// A hardening chain of which the last unknown is hooked to the first once they are a gap apart.
///
/// ```text
/// E = chain + stiffness / 6 max(0, x_last - x_first - gap)^3
/// ```
///
/// The pattern has room for the hook only after it was asked to make it.
pub(super) struct Hooked {
    pub(super) chain: Chain,
    pub(super) stiffness: f64,
    pub(super) gap: f64,
    pattern: SparsityPattern,
    /// Where the hook's entry stands, once it has room.
    pub(super) room: Option<usize>,
}

impl Hooked {
    pub(super) fn new(order: usize, load: f64, stiffness: f64, gap: f64) -> Self {
        let chain = Chain::hardening(order, load);
        let pattern = chain.pattern.clone();
        Self { chain, stiffness, gap, pattern, room: None }
    }

    fn opening(&self, x: &[f64]) -> f64 {
        (x[x.len() - 1] - x[0] - self.gap).max(0.0)
    }
}

impl System for Hooked {
    fn pattern(&self) -> &SparsityPattern {
        &self.pattern
    }

    fn energy(&mut self, x: &[f64]) -> Result<f64, Inadmissible> {
        Ok(self.chain.energy(x)? + self.stiffness / 6.0 * self.opening(x).powi(3))
    }

    fn residual(&mut self, x: &[f64], residual: &mut [f64]) -> Result<f64, Inadmissible> {
        self.chain.residual(x, residual)?;
        let force = self.stiffness / 2.0 * self.opening(x).powi(2);
        residual[x.len() - 1] += force;
        residual[0] -= force;
        self.energy(x)
    }

    fn tangent(
        &mut self,
        x: &[f64],
        residual: &mut [f64],
        tangent: &mut [f64],
    ) -> Result<f64, Inadmissible> {
        let stiffness = self.stiffness * self.opening(x);
        assert!(stiffness == 0.0 || self.room.is_some(), "no room was made for the hook");
        let mut own = vec![0.0; self.chain.pattern.stored()];
        self.chain.tangent(x, residual, &mut own)?;
        if let Some(room) = self.room {
            own.insert(room, -stiffness);
        }
        tangent.copy_from_slice(&own);
        tangent[0] += stiffness;
        *tangent.last_mut().expect("the last diagonal") += stiffness;
        self.residual(x, residual)
    }

    fn make_room(&mut self, x: &[f64]) -> bool {
        let is_due = self.room.is_none() && self.opening(x) > 0.0;
        if is_due {
            let end = self.pattern.column_starts[1];
            self.room = Some(end as usize);
            self.pattern.row_indices.insert(end as usize, x.len() as u32 - 1);
            self.pattern.column_starts[1..].iter_mut().for_each(|start| *start += 1);
        }
        is_due
    }

    fn force_scale(&self) -> f64 {
        1.0
    }
}
