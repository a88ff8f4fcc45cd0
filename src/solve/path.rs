//! The loading path: its programme, its points, and how it is to be walked (`follow.rs`).

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::counts::SolveCounts;
use super::ending::Ending;
use super::newton::NewtonSettings;
use super::supply::Supply;
use crate::model::system::Memory;

/// How a path is walked.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct PathSettings {
    /// Number of equal parts of the programme, at whose ends states are sampled.
    pub steps: usize,
    /// The largest step, as a share of one of these parts; no step passes a sample.
    pub largest_step: f64,
    /// How often a part may be halved before the path loses its stability or ends.
    pub halvings: u32,
    /// A step is halved while work done and energy stored differ by more than this share of the work so far.
    pub work_tolerance: f64,
    /// Newton iterations that a whole path may use, those of failed attempts too; in a search, all paths of a candidate together.
    pub iteration_budget: usize,
    /// When Newton's method stops.
    pub newton: NewtonSettings,
}

impl Default for PathSettings {
    fn default() -> Self {
        Self {
            steps: 10,
            largest_step: 1.0,
            halvings: 5,
            work_tolerance: 1e-3,
            iteration_budget: 1000,
            newton: NewtonSettings::default(),
        }
    }
}

/// What a path is driven through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Programme {
    /// A supply is driven from rest to its end: a load, a volume (mm^3), an amount of gas.
    Driven {
        /// Which equation binds load and conjugate.
        supply: Supply,
        /// The last value of the drive.
        end: f64,
    },
    /// All equilibria on the curve from rest to where it first reaches this load, stable or not.
    Curve {
        /// The load at which the curve ends.
        end: f64,
    },
}

impl From<f64> for Programme {
    /// A load that is given, and rises to `end`.
    fn from(end: f64) -> Self {
        Self::Driven { supply: Supply::Load, end }
    }
}

/// A loss of stability that a path went over, on the way to the point that carries it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Snap {
    /// Energy given off on the way, mJ.
    pub released: f64,
    /// Whether the equilibrium went on, but unstable: a bifurcation, and the part buckled away from it.
    pub from_bifurcation: bool,
}

/// An equilibrium on a path.
#[derive(Clone, Debug, PartialEq)]
pub struct PathPoint {
    /// Where on the path: the drive of the supply, or the length of the arc.
    pub drive: f64,
    /// Whether it lies on an arc, where `drive` is a length.
    pub on_arc: bool,
    /// The load (pressure, MPa).
    pub load: f64,
    /// Its conjugate (volume, mm^3).
    pub conjugate: f64,
    /// Work done by the load since the start of the path, mJ.
    pub work: f64,
    /// Potential energy without the load's own, mJ: what the wall and the barriers store.
    pub stored_energy: f64,
    /// Energy given off by snaps and friction since the start of the path, mJ.
    pub dissipated: f64,
    /// The unknowns, `[n]`.
    pub x: Vec<f64>,
    /// What the system remembers there; with it a path goes on from here.
    pub memory: Memory,
    /// Derivative of the unknowns with respect to the drive, `[n]`.
    pub rate: Vec<f64>,
    /// The load's derivative with respect to the drive.
    pub load_rate: f64,
    /// The conjugate's derivative with respect to the drive.
    pub conjugate_rate: f64,
    /// Negative pivots of the tangent beyond those of a stable system: directions that are lost where the load is given.
    pub negative_pivots: usize,
    /// Whether no direction is lost under the path's own supply.
    pub is_stable: bool,
    /// Whether it stands at a sample of the programme.
    pub is_sample: bool,
    /// Newton iterations spent since the point before, on steps that were given up too.
    pub newton_iterations: usize,
    /// Steps given up since the point before.
    pub cuts: usize,
    /// The loss of stability on the way here from the point before.
    pub snap: Option<Snap>,
}

impl PathPoint {
    /// A point with `order` unknowns that has not moved, at `drive`.
    #[must_use]
    pub fn at_rest(drive: f64, order: usize) -> Self {
        Self {
            drive,
            on_arc: false,
            load: 0.0,
            conjugate: 0.0,
            work: 0.0,
            stored_energy: 0.0,
            dissipated: 0.0,
            x: vec![0.0; order],
            memory: Memory::default(),
            rate: vec![0.0; order],
            load_rate: 1.0,
            conjugate_rate: 0.0,
            negative_pivots: 0,
            is_stable: true,
            is_sample: true,
            newton_iterations: 0,
            cuts: 0,
            snap: None,
        }
    }
}

/// A walked path, its start included.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    /// Equilibria in the order of the walk.
    pub points: Vec<PathPoint>,
    /// Why there are no more.
    pub ending: Ending,
    /// An unknown where the path ended: where a bound was passed, or else what moved fastest there.
    pub place: Option<usize>,
    /// Whether the last point had lost its stability, and the fall from it found no stable state.
    pub fell: bool,
    /// What the whole walk asked of the solver, after the last point too.
    pub counts: SolveCounts,
}

impl Path {
    /// The points that the part snapped or buckled to, with the points before.
    pub fn snaps(&self) -> impl Iterator<Item = [&PathPoint; 2]> {
        self.points.windows(2).map(|pair| [&pair[0], &pair[1]]).filter(|[_, to]| to.snap.is_some())
    }
}
