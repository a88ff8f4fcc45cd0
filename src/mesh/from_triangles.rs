//! From triangles of any shape to those of a shell: a surface as a CAD program, a scanner or a mesher wrote it.

use std::collections::BTreeSet;

use super::from_field::REMESH_ITERATIONS;
use crate::math::Rejected;
use crate::surface::{RemeshSettings, TriangleMesh, remesh_triangles};

/// A given surface in triangles of one edge.
#[derive(Clone, Debug)]
pub struct Remeshed {
    /// The new triangles.
    pub surface: TriangleMesh,
    /// Its sharp edges, by their vertices, the lesser first.
    pub sharp_edges: BTreeSet<[u32; 2]>,
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
            Ok((surface, sharp_edges)) => {
                return Ok(Remeshed { surface, sharp_edges, edge, sharp });
            }
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

/// The least turn of a sharp edge, degrees.
pub const SHARP_TURN: f64 = 40.0;
/// Degrees; 180 keeps none.
const SHARP: [f64; 3] = [SHARP_TURN, 60.0, 180.0];
/// Edge over thickness. The volume gained by a capped cylinder of 16 x 80 mm with a wall of 1.6 mm is 1494, 1476, 1472 and 1476 mm^3 at
/// 2, 1.5, 1.25 and 1.06 thicknesses, and by a square box of 20 x 20 x 80 mm 2660, 2511, 2493 and 2499.
const EDGE_SHARE: f64 = 1.5;
/// A shell of them takes some minutes.
const MOST_TRIANGLES: f64 = 40_000.0;
