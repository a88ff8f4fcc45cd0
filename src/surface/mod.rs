//! Which triangles bound it? Closed triangle surfaces.
//!
//! ```text
//! field -> isosurface -> chamber check -> remesh -> quality
//! ```
//! Every surface that leaves this room is a closed, oriented 2-manifold
//! ([`TriangleMesh::check_closed_manifold`]); what stays a property of the field, such as a wall
//! thinner than the printer can make, is not judged here.

mod chamber;
mod distance;
mod facet_tree;
mod half_edges;
mod isosurface;
mod mesh_defect;
mod mid_surface;
mod offset;
mod orientation;
mod primitives;
mod quality;
mod remesh;
mod self_intersection;
#[cfg(test)]
pub(crate) mod test_fields;
mod triangle_mesh;

pub use chamber::Chamber;
pub use distance::SignedDistance;
pub use half_edges::HalfEdges;
pub use isosurface::{interpolated_isosurface, isosurface};
pub use mesh_defect::MeshDefect;
pub use mid_surface::{MidSurface, WallFace};
pub use offset::{Filleted, Offset};
pub use orientation::turned_outward;
pub use quality::{SurfaceQuality, radius_ratio};
pub use remesh::{Grading, RemeshSettings, remesh, remesh_graded, remesh_triangles, sharp_edges};
pub use self_intersection::intersecting_pairs;
pub use triangle_mesh::{TriangleMesh, over_used_vertices};
