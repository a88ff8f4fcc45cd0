//! The nonlinear system that a solver sees: an energy over unknowns, its gradient and its Hessian.
//!
//! ```text
//! residual R(x) = dE/dx        tangent K(x) = dR/dx (symmetric, lower triangle stored)
//! ```
//!
//! Forces without a potential may be added to the residual: [`System::is_conservative`].

use std::ops::Range;

use crate::math::Vec3;

/// A state at which the energy is not defined: an element turned inside out, a wall behind the plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("inadmissible state: {0}")]
pub struct Inadmissible(pub &'static str);

/// The lower triangle of a symmetric sparse matrix by columns; row indices sorted, diagonal present.
///
/// Entries above the diagonal may be present (inside diagonal blocks); readers ignore them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SparsityPattern {
    /// Start of each column in `row_indices`, `[n + 1]`.
    pub column_starts: Vec<u32>,
    /// Row of each stored entry, `[stored]`.
    pub row_indices: Vec<u32>,
}

impl SparsityPattern {
    /// The order of the matrix.
    #[must_use]
    pub fn order(&self) -> usize {
        self.column_starts.len() - 1
    }

    /// Where each column's diagonal entry is stored.
    ///
    /// # Panics
    /// When a diagonal entry is missing.
    pub fn diagonal(&self) -> impl Iterator<Item = usize> {
        self.column_starts.windows(2).enumerate().map(|(column, bounds)| {
            let rows = &self.row_indices[bounds[0] as usize..bounds[1] as usize];
            let within = rows.binary_search(&(column as u32)).expect("the diagonal is stored");
            bounds[0] as usize + within
        })
    }

    /// The number of stored entries.
    #[must_use]
    pub fn stored(&self) -> usize {
        self.row_indices.len()
    }
}

/// Where the unknowns of a system act, for a solver that spreads it over several processes or coarsens it.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    /// Places at rest, mm, of the nodes `v` whose unknowns `3 v`, `3 v + 1`, `3 v + 2` are displacements.
    pub nodes: Vec<Vec3>,
    /// The multipliers, which are the unknowns after those.
    pub multipliers: Vec<Multiplier>,
}

/// What a solver may know of a multiplier.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Multiplier {
    /// The node at whose place it acts.
    pub node: u32,
    /// About what is left of its diagonal entry when the displacements are eliminated, with the sign changed: positive.
    pub complement: f64,
}

/// A potential energy over `n` unknowns, with derivatives.
pub trait System {
    /// The stored entries of the tangent; they change only in [`Self::make_room`].
    fn pattern(&self) -> &SparsityPattern;

    /// The energy at `x [n]`, mJ.
    ///
    /// # Errors
    /// [`Inadmissible`] where the energy is not defined.
    fn energy(&mut self, x: &[f64]) -> Result<f64, Inadmissible>;

    /// Writes the gradient at `x [n]` into `residual [n]`, N; returns the energy, mJ.
    ///
    /// # Errors
    /// [`Inadmissible`] where the energy is not defined.
    fn residual(&mut self, x: &[f64], residual: &mut [f64]) -> Result<f64, Inadmissible>;

    /// Writes gradient and Hessian at `x [n]` into `residual [n]` and `tangent [stored]`; returns the energy.
    ///
    /// # Errors
    /// [`Inadmissible`] where the energy is not defined.
    fn tangent(
        &mut self,
        x: &[f64],
        residual: &mut [f64],
        tangent: &mut [f64],
    ) -> Result<f64, Inadmissible>;

    /// The largest multiple of `dx [n]`, at most 1, that may be added to `x` without crossing a contact.
    fn longest_step(&self, x: &[f64], dx: &[f64]) -> f64 {
        let _ = (x, dx);
        1.0
    }

    /// The force against which a residual is small, N.
    fn force_scale(&self) -> f64;

    /// What rounding makes of an energy that vanishes, mJ: differences below it mean nothing.
    fn energy_rounding(&self) -> f64 {
        0.0
    }

    /// Makes room in the pattern for contacts that are near at `x [n]`; returns whether the pattern changed.
    ///
    /// A solver asks before each tangent, and plans its factorisation anew where it did. Energy and residual do not
    /// depend on it.
    fn make_room(&mut self, x: &[f64]) -> bool {
        let _ = x;
        false
    }

    /// The unknowns in which the energy of a stable equilibrium is largest, not least: the pressures of a mixed method.
    ///
    /// Where there are some, the energy is none to be lowered step by step, and Newton's method watches the residual.
    fn multipliers(&self) -> Range<usize> {
        0..0
    }

    /// The number of negative pivots of the tangent at a stable equilibrium: one for each multiplier.
    fn stable_negative_pivots(&self) -> usize {
        self.multipliers().len()
    }

    /// Where the unknowns act; none where a system has no places.
    fn layout(&self) -> Option<Layout> {
        None
    }

    /// Until told otherwise, [`Self::residual`] and [`Self::tangent`] may leave incomplete what no unknown of the `share [n]` has a
    /// part in: other entries of the residual, entries of the tangent of which neither end is in the share, and the energy they return.
    ///
    /// So several processes evaluate a system together. A system that does all nonetheless is right, and slower.
    fn set_share(&mut self, share: Option<&[bool]>) {
        let _ = share;
    }

    /// Whether the residual is the energy's gradient and the tangent its whole derivative.
    ///
    /// Otherwise forces without a potential act: the residual has them, the energy has not, and
    /// `dR/dx = tangent + N` with the tangent symmetric still. A line search on the energy and the count of negative
    /// pivots then decide nothing.
    fn is_conservative(&self) -> bool {
        true
    }

    /// Adds `N v` to `out [n]`: what `dR/dx` at `x [n]` has besides the tangent, times `v [n]`. Zero where unknowns are held.
    fn add_circulatory_tangent(&self, x: &[f64], v: &[f64], out: &mut [f64]) {
        let _ = (x, v, out);
    }
}

/// A system whose energy depends on one load linearly: `E(x; load) = W(x) - load * conjugate(x)`.
pub trait LoadedSystem: System {
    /// Sets the load (for a chamber: the pressure, MPa).
    fn set_load(&mut self, load: f64);

    /// The quantity on which the load works (for a chamber: the volume, mm^3); of the loads that have a potential.
    fn conjugate(&self, x: &[f64]) -> f64;

    /// Writes the forces of a load of 1, `-dR/dload`, into `direction [n]`, zero where unknowns are held:
    /// `dR/dx dx/dload = direction`. In a conservative system it is the gradient of the conjugate.
    fn load_direction(&self, x: &[f64], direction: &mut [f64]);

    /// Told of every accepted equilibrium `x [n]`, for what has a history; returns the energy given off as heat since the
    /// last, mJ.
    fn settle(&mut self, x: &[f64]) -> f64 {
        let _ = x;
        0.0
    }

    /// What it remembers of the accepted equilibrium at hand.
    fn memory(&self) -> Memory {
        Memory::default()
    }

    /// Goes back to the accepted equilibrium `x [n]` and its `memory`; where that is empty, the history begins there.
    fn recall(&mut self, x: &[f64], memory: &Memory) {
        let _ = memory;
        self.settle(x);
    }

    /// Brings what the energy takes as constant during a solve (the normal forces of friction) up to the equilibrium
    /// `x [n]`; returns how far it was off, as a share of its size. 0 where there is nothing of the kind.
    fn refresh(&mut self, x: &[f64]) -> f64 {
        let _ = x;
        0.0
    }

    /// Takes back what was refreshed since the last accepted equilibrium: the attempt was given up.
    fn rewind(&mut self) {}

    /// Whether some of the work may be given off as heat on a path without snaps.
    fn dissipates(&self) -> bool {
        false
    }

    /// The first bound of the model's validity that `x [n]` has passed.
    fn passed_limit(&self, x: &[f64]) -> Option<Limit> {
        let _ = x;
        None
    }

    /// How much of what its material may bear is used at `x [n]`, where most is; none where no limit is set.
    fn utilization(&self, x: &[f64]) -> Option<Utilization> {
        let _ = x;
        None
    }
}

/// What a system remembers of an accepted equilibrium beside its unknowns, as where its friction holds on: numbers of each of its
/// terms; empty of a system without a history.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Memory(Vec<Vec<f64>>);

impl Memory {
    /// What the terms of a system remember, in their order.
    #[must_use]
    pub fn of(terms: impl Iterator<Item = Vec<f64>>) -> Self {
        let terms: Vec<_> = terms.collect();
        if terms.iter().all(Vec::is_empty) { Self::default() } else { Self(terms) }
    }

    /// What the term at `place` remembers.
    #[must_use]
    pub fn of_term(&self, place: usize) -> &[f64] {
        self.0.get(place).map_or(&[], Vec::as_slice)
    }
}

/// How much of a limit of the material is used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Utilization {
    /// 0 at rest, 1 at the limit, more past it.
    pub share: f64,
    /// An unknown where it is so.
    pub unknown: usize,
}

/// A bound of a model's validity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limit {
    /// Which bound.
    pub kind: LimitKind,
    /// An unknown where it was passed.
    pub unknown: usize,
}

/// What ends a model's validity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LimitKind {
    /// The wall is stretched beyond the bound that was set.
    Ballooning,
    /// The part touches itself, which is not modelled.
    SelfTouch,
}
