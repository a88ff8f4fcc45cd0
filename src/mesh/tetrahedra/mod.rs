//! How is a wall filled with tetrahedra? By programs of others, of which one may fail: a ladder of attempts, each judged here.
//!
//! A mesher is a [`TetMesher`]: it may hang, crash or answer nonsense, and says so in a [`MesherFailure`]. What it answers is
//! believed only after [`check()`]. This room starts no process; `io` implements the trait.

mod boundary;
mod check;
mod defect;
mod interior;
mod ladder;
mod pieces;
mod quality;
#[cfg(test)]
pub(crate) mod test_walls;

use serde::{Deserialize, Serialize};

use super::{TetMesh, WallSurfaces};
use crate::math::Vec3;

pub use boundary::Numbered;
pub use check::check;
pub use defect::TetDefect;
pub use ladder::{Attempt, AttemptFailure, Filled, Unfilled, filled_wall};
pub use pieces::{net_edges, turns_around};
pub use quality::TetQuality;

/// A program that fills walls with tetrahedra.
pub trait TetMesher: Sync {
    /// The name in records, such as `tetgen`.
    fn name(&self) -> &str;

    /// Tetrahedra between the `wall`'s surfaces, whose vertices and triangles they keep, with the points `interior` among their vertices.
    ///
    /// # Errors
    /// [`MesherFailure`] when there is no answer to read. The answer itself is not checked.
    fn tetrahedra(
        &self,
        wall: &WallSurfaces,
        interior: &[Vec3],
        settings: &TetSettings,
    ) -> Result<TetMesh, MesherFailure>;
}

/// What is asked of the tetrahedra.
///
/// # Decisions
/// One element through the wall where it is thinner than 1.5 edges: quadratic displacements bend within an element
/// (one P2-P1 element of aspect 2.4 errs by 0.4 %). Optimising towards 120 degrees instead of the 165 that TetGen
/// chooses by itself costs 0.1 s and lifts the 1 % quantile of the smallest dihedral angles from 11 to 32 degrees
/// (`basic_bend`, edge 2 mm, wall 1.6 mm).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TetSettings {
    /// Edge length of the wall's surfaces, mm.
    pub edge: f64,
    /// Elements through the wall.
    pub layers: usize,
    /// Largest circumscribed radius over shortest edge; looked for, not promised.
    pub radius_edge: f64,
    /// The mesher improves tetrahedra with larger dihedral angles than this, degrees; looked for, not promised.
    pub dihedral_max: f64,
    /// Below this smallest dihedral angle (degrees) a better mesh is looked for.
    pub dihedral_min: f64,
}

impl Default for TetSettings {
    fn default() -> Self {
        Self { edge: 2.0, layers: 1, radius_edge: 1.4, dihedral_max: 120.0, dihedral_min: 1.0 }
    }
}

impl TetSettings {
    /// For a wall of `thickness` (mm) at `edge` (mm): as many elements through the wall as make them as high as wide, at least one.
    #[must_use]
    pub fn for_wall(thickness: f64, edge: f64) -> Self {
        Self { edge, layers: (thickness / edge).round().max(1.0) as usize, ..Self::default() }
    }
}

/// Why a mesher gave no answer, or none that can be used; displays as one line.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MesherFailure {
    /// It was ended at its time limit.
    #[error("still running after {seconds} s")]
    TimedOut {
        /// The limit.
        seconds: f64,
    },
    /// It needed more memory than its limit.
    #[error("needed more than {mebibytes} MiB of memory")]
    OutOfMemory {
        /// The limit.
        mebibytes: u64,
    },
    /// A signal ended it.
    #[error("crashed with signal {signal}: {words}")]
    Crashed {
        /// The signal's number.
        signal: i32,
        /// The last lines it wrote.
        words: String,
    },
    /// It ended by itself without tetrahedra.
    #[error("refused with exit code {code}: {words}")]
    Refused {
        /// Its exit code.
        code: i32,
        /// The last lines it wrote.
        words: String,
    },
    /// It wrote something else than tetrahedra.
    #[error("its answer cannot be read: {0}")]
    Unreadable(String),
    /// Its tetrahedra do not fill the wall.
    #[error("its answer is wrong: {0}")]
    Wrong(#[from] TetDefect),
    /// It could not be run at all: a fault of the machine, not of the wall.
    #[error("{0}")]
    Machine(String),
}
