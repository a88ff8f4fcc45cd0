//! Why a triangle list is not a closed surface.

use crate::math::{Reason, Rejected, Room};

/// The first property of a closed, outward-oriented 2-manifold that a triangle list lacks.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum MeshDefect {
    /// There is nothing to check.
    #[error("the surface has no triangles")]
    Empty,
    /// Triangles name vertices that do not exist.
    #[error("{triangles} triangles name a vertex beyond the last one")]
    IndexOutOfRange {
        /// Triangles with such an index.
        triangles: usize,
    },
    /// Triangles name one vertex twice.
    #[error("{triangles} triangles have two corners at the same vertex")]
    DegenerateTriangles {
        /// Triangles with a repeated index.
        triangles: usize,
    },
    /// Coordinates are NaN or infinite.
    #[error("{vertices} vertices have a coordinate that is not a finite number")]
    NotFinite {
        /// Vertices with such a coordinate.
        vertices: usize,
    },
    /// Vertices belong to no triangle.
    #[error("{vertices} vertices belong to no triangle")]
    Unreferenced {
        /// Vertices without a triangle.
        vertices: usize,
    },
    /// The surface has a boundary.
    #[error("{edges} edges have only one triangle: the surface has holes")]
    OpenEdges {
        /// Edges with one triangle.
        edges: usize,
    },
    /// Sheets meet along an edge.
    #[error("{edges} edges have more than two triangles: the surface branches there")]
    BranchingEdges {
        /// Edges with three or more triangles.
        edges: usize,
    },
    /// Neighbours disagree about which side is outside.
    #[error("{edges} edges are passed twice in the same direction: neighbours face opposite sides")]
    OpposedTriangles {
        /// Edges whose two triangles have opposite orientations.
        edges: usize,
    },
    /// Sheets touch in a point.
    #[error("{vertices} vertices join two or more separate fans of triangles")]
    PinchedVertices {
        /// Vertices with more than one fan.
        vertices: usize,
    },
    /// The triangles face inward.
    #[error("the enclosed volume is {volume:.3e} mm^3: the triangles must face outward")]
    FacesInward {
        /// The signed volume, mm^3.
        volume: f64,
    },
}

impl From<MeshDefect> for Rejected {
    fn from(defect: MeshDefect) -> Self {
        Self::new(Room::Surface, Reason::DefectiveSurface, defect.to_string(), 1.0)
    }
}
