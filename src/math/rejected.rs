//! A design that cannot be built or evaluated: a value, not an error.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::Reason;

/// The room in which a design was found impossible.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Room {
    /// The inherited network.
    Genome,
    /// The implicit function.
    Field,
    /// The triangle surface.
    Surface,
    /// The computational mesh.
    Mesh,
    /// The energy.
    Model,
    /// The equilibrium path.
    Solve,
    /// The objectives.
    Fitness,
    /// The printed part.
    Printing,
}

/// What a design failed to become, the farthest last.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// Any surface at all.
    Nothing,
    /// One chamber from clamp to tip.
    Chamber,
    /// Triangles that can be computed with.
    Triangles,
    /// A wall that can be computed.
    Shell,
    /// A path to the largest pressure.
    Path,
}

/// Why a design failed, and where. Evolution treats it as data (a constraint violation).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rejected {
    /// The room that refused the design.
    pub room: Room,
    /// Why.
    pub reason: Reason,
    /// One sentence for a person: what was found, and what would have been right.
    pub detail: String,
    /// How far the design is from acceptable, >= 0 and comparable within one reason.
    pub violation: f64,
}

impl Rejected {
    /// A rejection by `room`; a violation that is no number counts as the largest.
    #[must_use]
    pub fn new(room: Room, reason: Reason, detail: String, violation: f64) -> Self {
        let violation = if violation.is_finite() { violation } else { f64::MAX };
        Self { room, reason, detail, violation }
    }

    /// How far the design came.
    #[must_use]
    pub fn stage(&self) -> Stage {
        match (self.room, &self.reason) {
            (Room::Solve | Room::Fitness | Room::Printing, _) => Stage::Path,
            (Room::Mesh | Room::Model, _) => Stage::Shell,
            (
                _,
                Reason::UnresolvedSurface | Reason::SelfIntersecting | Reason::TooManyTriangles,
            ) => Stage::Triangles,
            (_, Reason::NoSurface) => Stage::Nothing,
            (Room::Genome | Room::Field | Room::Surface, _) => Stage::Chamber,
        }
    }
}

impl fmt::Display for Rejected {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}: {} ({})", self.room, self.reason, self.detail)
    }
}
