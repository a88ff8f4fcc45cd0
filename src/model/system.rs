//! The nonlinear system that a solver sees: an energy over unknowns, its gradient and its Hessian.
//!
//! ```text
//! residual R(x) = dE/dx        tangent K(x) = dR/dx (symmetric, lower triangle stored)
//! ```

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

/// A potential energy over `n` unknowns, with derivatives.
pub trait System {
    /// The stored entries of the tangent; fixed for the life of the system.
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

    /// The number of negative pivots of the tangent at a stable equilibrium (0 unless there are multipliers).
    fn stable_negative_pivots(&self) -> usize {
        0
    }
}

/// A system whose energy depends on one load linearly: `E(x; load) = W(x) - load * conjugate(x)`.
pub trait LoadedSystem: System {
    /// Sets the load (for a chamber: the pressure, MPa).
    fn set_load(&mut self, load: f64);

    /// The quantity on which the load works (for a chamber: the volume, mm^3).
    fn conjugate(&self, x: &[f64]) -> f64;

    /// Writes the gradient of the conjugate into `direction [n]`, zero where unknowns are held: `K dx/dload = direction`.
    fn load_direction(&self, x: &[f64], direction: &mut [f64]);

    /// Told of every accepted equilibrium `x [n]`, for what has a history; returns the energy given off as heat since the
    /// last, mJ.
    fn settle(&mut self, x: &[f64]) -> f64 {
        let _ = x;
        0.0
    }

    /// Brings what the energy takes as constant during a solve (the normal forces of friction) up to the equilibrium
    /// `x [n]`; returns how far it was off, as a share of its size. 0 where there is nothing of the kind.
    fn refresh(&mut self, x: &[f64]) -> f64 {
        let _ = x;
        0.0
    }

    /// The first bound of the model's validity that `x [n]` has passed.
    fn passed_limit(&self, x: &[f64]) -> Option<Limit> {
        let _ = x;
        None
    }
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
