//! Why a design can be rejected: one list, and the names that files have.

use std::fmt;

use serde::{Deserialize, Serialize};

macro_rules! reasons {
    ($($(#[$doc:meta])* $reason:ident = $name:literal,)+) => {
        /// Why a design is rejected; in files it is its name.
        #[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
        #[serde(from = "String", into = "String")]
        pub enum Reason {
            $($(#[$doc])* $reason,)+
            /// One that this program does not know, of a record by another version.
            Unknown(String),
        }

        impl Reason {
            /// Its name in tables and files, such as `no_surface`.
            #[must_use]
            pub fn name(&self) -> &str {
                match self {
                    $(Self::$reason => $name,)+
                    Self::Unknown(name) => name,
                }
            }
        }

        impl From<String> for Reason {
            fn from(name: String) -> Self {
                match name.as_str() {
                    $($name => Self::$reason,)+
                    _ => Self::Unknown(name),
                }
            }
        }

        #[cfg(test)]
        const REASONS: &[Reason] = &[$(Reason::$reason,)+];
    };
}

reasons! {
    /// The program failed on it: a panic.
    ProgramDefect = "program_defect",

    /// The field is nowhere below 0.
    NoSurface = "no_surface",
    /// The chamber does not begin at the clamp.
    NoChamberAtClamp = "no_chamber_at_clamp",
    /// The chamber ends below the tip.
    NotReachingTip = "not_reaching_tip",
    /// There is a second chamber.
    Islands = "islands",
    /// There is a void within the chamber.
    EnclosedVoid = "enclosed_void",
    /// The surface takes more triangles than fit.
    TooManyTriangles = "too_many_triangles",
    /// Triangles of the wanted size cannot follow the surface.
    UnresolvedSurface = "unresolved_surface",
    /// The surface passes through itself.
    SelfIntersecting = "self_intersecting",
    /// The triangles do not bound a body.
    DefectiveSurface = "defective_surface",

    /// The clamp holds no vertex.
    ClampHoldsNothing = "clamp_holds_nothing",
    /// The formula gives no regular surface.
    NoPatch = "no_patch",
    /// The wall is thicker than the chamber is wide.
    ChamberClosed = "chamber_closed",
    /// The wall parts the chamber.
    ChamberDivided = "chamber_divided",
    /// The wall encloses a pocket of the outside.
    EnclosedPocket = "enclosed_pocket",
    /// The faces of the wall touch, or come too near to its middle.
    WallBroken = "wall_broken",
    /// No mesher fills the wall.
    NoTetrahedra = "no_tetrahedra",

    /// A fold at rest is tighter than half the wall.
    FoldsTighterThanWall = "folds_tighter_than_wall",
    /// The limit surface cannot follow the mesh.
    NoInterpolatingSurface = "no_interpolating_surface",
    /// No facets enclose the volume of the smooth surface.
    NoVolumeMatch = "no_volume_match",
    /// An element has no area.
    DegenerateElement = "degenerate_element",
    /// A cell is inverted at rest.
    InvertedCell = "inverted_cell",
    /// The material has no law for solids.
    NoSolidLaw = "no_solid_law",
    /// The chamber is not closed.
    OpenChamber = "open_chamber",
    /// There is no axis to turn about.
    NoAxis = "no_axis",
    /// An edge does not lie in a plane of symmetry.
    NoSymmetry = "no_symmetry",
    /// An edge has no normal.
    NoNormal = "no_normal",
    /// A point that is to be shown lies outside the wall.
    OutsideWall = "outside_wall",
    /// The supports hold everything.
    NothingMoves = "nothing_moves",

    /// The path has no loaded sample, though it was walked to its end.
    Reached = "reached",
    /// As before, over a loss of stability.
    SnappedAndContinued = "snapped_and_continued",
    /// The wall reached the limit of its material.
    LimitReached = "limit_reached",
    /// No stable equilibrium was near.
    LimitPoint = "limit_point",
    /// The equilibrium was not stable.
    Unstable = "unstable",
    /// The wall was stretched beyond the bound.
    Ballooning = "ballooning",
    /// The part touched itself.
    SelfTouch = "self_touch",
    /// Elements were inverted.
    Inverted = "inverted",
    /// Newton's method did not converge.
    Stalled = "stalled",
    /// The budget of iterations was spent.
    BudgetSpent = "budget_spent",
    /// The walk was stopped.
    Interrupted = "interrupted",

    /// What was read off the paths is no number.
    NotFinite = "not_finite",
    /// An objective is doubted, and the run excludes such designs.
    Exploit = "exploit",

    /// The part has no base.
    NoBase = "no_base",
    /// The base is too small for the inlet.
    BaseTooSmall = "base_too_small",
    /// The base is not flat where the inlet should stand.
    BaseUneven = "base_uneven",
}

impl From<Reason> for String {
    fn from(reason: Reason) -> Self {
        match reason {
            Reason::Unknown(name) => name,
            known => known.name().to_owned(),
        }
    }
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reasons_are_read_by_their_names() {
        for reason in REASONS {
            let text = serde_json::to_string(reason).unwrap();
            assert_eq!(text, format!("\"{}\"", reason.name()));
            assert_eq!(serde_json::from_str::<Reason>(&text).unwrap(), *reason);
        }
        let other: Reason = serde_json::from_str("\"of_another_version\"").unwrap();
        assert_eq!(serde_json::to_string(&other).unwrap(), "\"of_another_version\"");
    }
}
