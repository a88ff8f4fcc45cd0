//! Why a list of tetrahedra does not fill a wall.

use crate::surface::MeshDefect;

/// The first property of tetrahedra that fill a wall which a list of them lacks.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum TetDefect {
    /// There is nothing to check.
    #[error("there is no tetrahedron")]
    Empty,
    /// Tetrahedra name vertices that do not exist.
    #[error("{tetrahedra} tetrahedra name a vertex beyond the last one")]
    IndexOutOfRange {
        /// Tetrahedra with such an index.
        tetrahedra: usize,
    },
    /// Coordinates are NaN or infinite.
    #[error("{vertices} vertices have a coordinate that is not a finite number")]
    NotFinite {
        /// Vertices with such a coordinate.
        vertices: usize,
    },
    /// Tetrahedra have no volume.
    #[error("{tetrahedra} tetrahedra have no volume")]
    Flat {
        /// Tetrahedra without volume.
        tetrahedra: usize,
    },
    /// Tetrahedra are turned inside out.
    #[error("{tetrahedra} tetrahedra have a negative volume")]
    Inverted {
        /// Tetrahedra with negative volume.
        tetrahedra: usize,
    },
    /// Faces belong to three or more tetrahedra.
    #[error("{faces} faces belong to more than two tetrahedra")]
    CrowdedFaces {
        /// Such faces.
        faces: usize,
    },
    /// Neighbours lie on the same side of their common face.
    #[error("{faces} faces have both their tetrahedra on the same side")]
    Overlapping {
        /// Such faces.
        faces: usize,
    },
    /// What is listed as boundary is not the boundary.
    #[error("{faces} faces are on the boundary and not listed so, or the other way round")]
    WrongBoundary {
        /// Faces that differ.
        faces: usize,
    },
    /// The outside is not a closed surface.
    #[error("the outside: {0}")]
    Outer(MeshDefect),
    /// The chamber is not a closed surface.
    #[error("the chamber: {0}")]
    Chamber(MeshDefect),
    /// A surface encloses another volume than that of the wall.
    #[error("the {surface} encloses {found} mm^3 instead of {asked}")]
    OtherVolume {
        /// `outside` or `chamber`.
        surface: &'static str,
        /// The volume within the tetrahedra's surface, mm^3.
        found: f64,
        /// The volume within the wall's surface, mm^3.
        asked: f64,
    },
    /// A surface has another area than that of the wall.
    #[error("the {surface} has {found} mm^2 instead of {asked}")]
    OtherArea {
        /// `outside` or `chamber`.
        surface: &'static str,
        /// The area of the tetrahedra's surface, mm^2.
        found: f64,
        /// The area of the wall's surface, mm^2.
        asked: f64,
    },
}
