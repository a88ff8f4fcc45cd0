//! A system's tangent as PETSc's matrix, and how linear systems with it are solved.

use std::ops::Range;
use std::sync::Arc;

use super::library::{Exchange, Factor, Inertia, Iteration, Matrix, Session};
use super::rows::Rows;
use crate::model::system::{Layout, SparsityPattern, System};
use crate::solve::shift::{LastShift, mean_diagonal};
use crate::solve::{LinearMethod, SolverFailure, lanczos};

/// Who does what with the tangents of a system.
#[derive(Debug)]
pub(super) enum Plan {
    /// This process factorises alone.
    Alone,
    /// All ranks together, each with its rows.
    Together {
        exchange: Arc<Exchange>,
        /// Where the unknowns act, when an iteration wants to know it.
        layout: Option<Layout>,
    },
}

impl Plan {
    /// The plan for a system of this `order` before more is known of it; `None` where more must be known.
    pub(super) fn of_order(session: &Session, order: usize, method: LinearMethod) -> Option<Self> {
        let (_, ranks) = session.rank();
        let alone = match method {
            LinearMethod::Iterative => false,
            LinearMethod::Direct => ranks == 1 || order < LEAST_TO_SHARE,
            LinearMethod::Automatic => {
                order < LEAST_TO_SHARE || ranks == 1 && order < LEAST_TO_ITERATE
            }
        };
        alone.then_some(Self::Alone)
    }

    /// The plan for `system`.
    pub(super) fn new(
        session: &Session,
        system: &dyn System,
        method: LinearMethod,
    ) -> Result<Self, SolverFailure> {
        let order = system.pattern().order();
        if let Some(plan) = Self::of_order(session, order, method) {
            return Ok(plan);
        }
        let (rank, ranks) = session.rank();
        let layout = system.layout();
        let rows = Rows::new(layout.as_ref(), order, rank, ranks);
        let may_iterate = method == LinearMethod::Iterative
            || method == LinearMethod::Automatic && order >= LEAST_TO_ITERATE;
        let layout = layout.filter(|layout| may_iterate && !layout.multipliers.is_empty());
        if ranks == 1 && layout.is_none() {
            return Ok(Self::Alone);
        }
        Ok(Self::Together { exchange: Arc::new(Exchange::new(session, rows)?), layout })
    }

    /// What the ranks tell each other.
    pub(super) fn exchange(&self) -> Option<&Arc<Exchange>> {
        match self {
            Self::Alone => None,
            Self::Together { exchange, .. } => Some(exchange),
        }
    }
}

/// Below so many unknowns each rank solves alone what all have to solve: they would wait for each other longer.
const LEAST_TO_SHARE: usize = 20_000;
/// From so many unknowns on a solid is solved by iteration. At 307,820 two states and the count of lost directions take 189 s on two
/// ranks where factorisations take 250 s, 387 s where they take 309 s on one, and a fraction of the memory.
const LEAST_TO_ITERATE: usize = 250_000;

/// The system's tangent, and how it becomes PETSc's matrix.
///
/// Alone, the lower column `j` of the pattern is the upper row `j` of the matrix.
#[derive(Debug)]
pub(super) struct Tangent {
    pub pattern: SparsityPattern,
    /// The system's stored entries, `[stored]`.
    pub entries: Vec<f64>,
    /// Which of them the matrix has on this rank, in its order.
    kept: Vec<u32>,
    /// Where in `kept` the diagonal entries are, and their unknowns.
    diagonal: Vec<(usize, u32)>,
    solver: Solver,
    exchange: Option<Arc<Exchange>>,
    last_shift: LastShift,
    /// Since it was made, or since the one was that it came after.
    pub factorizations: usize,
}

#[derive(Debug)]
enum Solver {
    Factor(Factor),
    Iteration(Box<Iteration>),
}

impl Tangent {
    pub(super) fn new(
        session: &Session,
        pattern: &SparsityPattern,
        plan: &Plan,
    ) -> Result<Self, SolverFailure> {
        match plan {
            Plan::Alone => Self::alone(session, pattern),
            Plan::Together { exchange, layout } => {
                Self::together(session, pattern, exchange, layout.as_ref())
            }
        }
    }

    fn alone(session: &Session, pattern: &SparsityPattern) -> Result<Self, SolverFailure> {
        let rows = &pattern.row_indices;
        let (mut kept, mut columns, mut starts) = (Vec::new(), Vec::new(), vec![0]);
        for (column, bounds) in pattern.column_starts.windows(2).enumerate() {
            kept.extend((bounds[0]..bounds[1]).filter(|&at| rows[at as usize] as usize >= column));
            columns.extend(kept[starts[column]..].iter().map(|&at| rows[at as usize] as usize));
            starts.push(kept.len());
        }
        let factor = Factor::new(session, Matrix::alone(session, &starts, &columns)?)?;
        starts.pop();
        Ok(Self {
            pattern: pattern.clone(),
            entries: vec![0.0; pattern.stored()],
            kept,
            diagonal: starts.into_iter().zip(0..).collect(),
            solver: Solver::Factor(factor),
            exchange: None,
            last_shift: LastShift::default(),
            factorizations: 0,
        })
    }

    fn together(
        session: &Session,
        pattern: &SparsityPattern,
        exchange: &Arc<Exchange>,
        layout: Option<&Layout>,
    ) -> Result<Self, SolverFailure> {
        let rows = exchange.rows();
        let own = rows.entries(pattern);
        let matrix = Matrix::spread(session, pattern.order(), &own.starts, &own.columns)?;
        let solver = match layout {
            Some(layout) => Solver::Iteration(Box::new(iteration(session, matrix, rows, layout)?)),
            None => Solver::Factor(Factor::new(session, matrix)?),
        };
        let unknowns = rows.own_unknowns().iter().copied();
        Ok(Self {
            pattern: pattern.clone(),
            entries: vec![0.0; pattern.stored()],
            kept: own.stored,
            diagonal: own.diagonal.into_iter().zip(unknowns).collect(),
            solver,
            exchange: Some(Arc::clone(exchange)),
            last_shift: LastShift::default(),
            factorizations: 0,
        })
    }

    /// The inertia of the entries, which are then ready to [`Self::solve`] with; `None` where they cannot be inverted.
    ///
    /// An iteration has no pivots: lost directions are looked for (`lanczos.rs`).
    pub(super) fn inertia(
        &mut self,
        session: &Session,
        multipliers: &Range<usize>,
    ) -> Result<Option<Inertia>, SolverFailure> {
        let inertia = self.factorize(session, 0.0, &(0..0))?;
        if matches!(self.solver, Solver::Factor(_)) {
            return Ok(inertia);
        }
        let order = self.pattern.order();
        let solve = |b: &mut [f64]| match self.solve(session, b, lanczos::TOLERANCE) {
            Ok(true) => Ok(()),
            Ok(false) => Err(None),
            Err(failure) => Err(Some(failure)),
        };
        match lanczos::lost_directions(order, multipliers, solve) {
            Ok(lost) => Ok(Some(Inertia { negative: multipliers.len() + lost, zero: 0 })),
            Err(None) => Ok(None),
            Err(Some(failure)) => Err(failure),
        }
    }

    /// Factorises the entries with the `shift` on the diagonal of all but `multipliers`, and returns the inertia, `None` where
    /// there is no factor. An iteration takes the entries as they are, and finds nothing to count.
    fn factorize(
        &mut self,
        session: &Session,
        shift: f64,
        multipliers: &Range<usize>,
    ) -> Result<Option<Inertia>, SolverFailure> {
        self.factorizations += 1;
        let Self { kept, entries, diagonal, solver, .. } = self;
        let fill = |values: &mut [f64]| {
            for (value, &entry) in values.iter_mut().zip(&*kept) {
                *value = entries[entry as usize];
            }
            for &(at, unknown) in diagonal.iter() {
                if !multipliers.contains(&(unknown as usize)) {
                    values[at] += shift;
                }
            }
        };
        match solver {
            Solver::Factor(factor) => factor.factorize(session, fill),
            Solver::Iteration(iteration) => {
                iteration.update(session, fill)?;
                Ok(Some(Inertia { negative: 0, zero: 0 }))
            }
        }
    }

    /// Factorises with the smallest shift, or `unshifted`, that leaves at most `negative` negative pivots; returns that
    /// shift.
    pub(super) fn factorize_stable(
        &mut self,
        session: &Session,
        negative: usize,
        unshifted: bool,
        multipliers: &Range<usize>,
    ) -> Result<Option<f64>, SolverFailure> {
        let stable = |inertia: Option<Inertia>| {
            inertia.is_some_and(|inertia| inertia.negative <= negative && inertia.zero == 0)
        };
        let mean = if unshifted {
            0.0
        } else {
            mean_diagonal(self.whole_diagonal(session)?.into_iter(), multipliers)
        };
        let mut last = self.last_shift;
        let found = last.smallest(mean, unshifted, |shift| {
            Ok(stable(self.factorize(session, shift, multipliers)?))
        });
        self.last_shift = last;
        found
    }

    /// The diagonal of all ranks, `[n]`.
    fn whole_diagonal(&self, session: &Session) -> Result<Vec<f64>, SolverFailure> {
        let own = self.diagonal.iter().map(|&(at, _)| self.entries[self.kept[at] as usize]);
        let own: Vec<f64> = own.collect();
        let Some(exchange) = &self.exchange else { return Ok(own) };
        let mut whole = vec![0.0; self.pattern.order()];
        exchange.gather(session, &own, &mut whole)?;
        Ok(whole)
    }

    /// Solves with the last factor, or iterates until the residual is `tolerance` of `b [n]`, which is overwritten by the solution;
    /// whether it got there.
    pub(super) fn solve(
        &mut self,
        session: &Session,
        b: &mut [f64],
        tolerance: f64,
    ) -> Result<bool, SolverFailure> {
        let Some(exchange) = &self.exchange else {
            return self.solver.solve(session, b, tolerance);
        };
        let mut own = exchange.own(b);
        let solved = self.solver.solve(session, &mut own, tolerance)?;
        exchange.gather(session, &own, b)?;
        Ok(solved)
    }

    /// Whether all entries of all ranks are numbers.
    pub(super) fn is_finite(&self, session: &Session) -> bool {
        let own = self.kept.iter().all(|&entry| self.entries[entry as usize].is_finite());
        self.exchange.as_ref().map_or(own, |exchange| exchange.all(session, own))
    }

    /// Iterations since it was made.
    pub(super) fn iterations(&self) -> usize {
        match &self.solver {
            Solver::Factor(_) => 0,
            Solver::Iteration(iteration) => iteration.iterations,
        }
    }
}

impl Solver {
    fn solve(
        &mut self,
        session: &Session,
        b: &mut [f64],
        tolerance: f64,
    ) -> Result<bool, SolverFailure> {
        match self {
            Self::Factor(factor) => factor.solve(session, b).map(|()| true),
            Self::Iteration(iteration) => iteration.solve(session, b, tolerance),
        }
    }
}

/// The iteration over `matrix` for the own `rows` of `layout`.
fn iteration(
    session: &Session,
    matrix: Matrix,
    rows: &Rows,
    layout: &Layout,
) -> Result<Iteration, SolverFailure> {
    let (displacements, multipliers) = rows.own_unknowns().split_at(rows.displacements);
    let nodes = displacements.iter().step_by(3);
    let places: Vec<_> = nodes.map(|&unknown| layout.nodes[unknown as usize / 3]).collect();
    let first = 3 * layout.nodes.len();
    let complement = |&unknown: &u32| layout.multipliers[unknown as usize - first].complement;
    let complements: Vec<f64> = multipliers.iter().map(complement).collect();
    Iteration::new(session, matrix, rows, &places, &complements)
}
