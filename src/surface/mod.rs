//! Which triangles bound it? Closed triangle surfaces.

mod primitives;
mod triangle_mesh;

pub use triangle_mesh::TriangleMesh;
