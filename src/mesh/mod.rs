//! Which cells carry the computation? The shell mesh: control points, stencils, clamp and tip. The solid mesh: tetrahedra.

mod curved;
mod ends;
mod from_field;
mod from_triangles;
mod layers;
mod lid;
mod locate;
mod patch;
mod rings;
mod section;
mod shell;
mod shell_settings;
mod solid;
pub mod tetrahedra;
mod wall;

pub use ends::{EndSets, Ends};
pub use from_field::{MeshSettings, shell_of_field, surface_of_field};
pub use from_triangles::{Remeshed, SHARP_TURN, edge_for, surface_of_triangles};
pub use layers::unit_lattice;
pub use lid::{Lid, RimDefect};
pub use locate::Location;
pub use patch::{BoundaryEdge, Patch, Place, Side};
pub use rings::{Rings, Stencil};
pub use section::{Section, SectionPoint};
pub use shell::ShellMesh;
pub use shell_settings::{ShellElement, ShellSettings};
pub use solid::{
    FACE_EDGES, SolidMesh, TET_EDGES, TetMesh, WallSurfaces, quadratic_shapes, quadratic_slopes,
};
pub use wall::{WallSettings, wall_surfaces};
