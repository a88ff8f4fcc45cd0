//! From triangles of any shape to those of a shell: a surface as a CAD program, a scanner or a mesher wrote it.

use super::from_field::REMESH_ITERATIONS;
use crate::math::Rejected;
use crate::surface::{RemeshSettings, TriangleMesh, remesh_triangles};

/// A given surface in triangles of one edge.
#[derive(Clone, Debug)]
pub struct Remeshed {
    /// The new triangles.
    pub surface: TriangleMesh,
    /// The edge length wanted, mm.
    pub edge: f64,
    /// Edges that turn by more degrees than this were kept sharp; 180 where none could be.
    pub sharp: f64,
}

/// The surface of `given`, a closed manifold, in triangles of `edge` (mm).
///
/// Sharp edges are kept where triangles of this edge can follow them: those of 40 degrees and more, else of 60 and more, else none.
///
/// # Errors
/// [`Rejected`] when the triangles cannot follow the surface, for the reason that the first trial met.
///
/// # Panics
/// When the edge is not a positive number.
pub fn surface_of_triangles(given: &TriangleMesh, edge: f64) -> Result<Remeshed, Rejected> {
    let settings = RemeshSettings { edge, iterations: REMESH_ITERATIONS };
    let mut first = None;
    for sharp in SHARP {
        match remesh_triangles(given, &settings, sharp) {
            Ok(surface) => return Ok(Remeshed { surface, edge, sharp }),
            Err(rejected) => drop(first.get_or_insert(rejected)),
        }
    }
    Err(first.expect("there is a first trial"))
}

/// The edge (mm) of triangles by which a shell of `thickness` (mm) follows `given` surfaces, of which some are too large for it.
#[must_use]
pub fn edge_for(given: &TriangleMesh, thickness: f64) -> f64 {
    let finest = (given.area() / (0.75_f64.sqrt() / 2.0 * MOST_TRIANGLES)).sqrt();
    (EDGE_SHARE * thickness).max(finest)
}

/// Degrees; 180 keeps none.
const SHARP: [f64; 3] = [40.0, 60.0, 180.0];
/// Edge over thickness. Along sharp edges shorter ones fold tighter than the wall allows: of three triangulations of a capped cylinder
/// (a square box) of 16 x 80 mm with a wall of 1.6 mm the volume gained is 273 to 290 mm^3 (1572 to 2990) at 1.25 thicknesses and 287
/// to 296 (1722 to 1911) at 1.5; even meshes that follow the edges converge to some 290 (1850).
const EDGE_SHARE: f64 = 1.5;
/// A shell of them takes some minutes.
const MOST_TRIANGLES: f64 = 40_000.0;
