//! What holds a body that nothing holds: its six rigid motions, and no more.

use super::Support;
use crate::surface::TriangleMesh;

impl Support {
    /// Holds six unknowns of a free body with this `surface` (at least one vertex), against its
    /// rigid motions alone: 3 of the highest vertex, 2 of the lowest, 1 of that farthest along x. A
    /// self-equilibrated load meets no reaction there.
    ///
    /// # Panics
    /// When the surface has no vertices.
    #[must_use]
    pub fn of_free_body(surface: &TriangleMesh) -> Self {
        let farthest = |axis: usize, sign: f64| {
            let height = |v: &u32| sign * surface.positions[*v as usize][axis];
            let vertices = 0..surface.positions.len() as u32;
            vertices.max_by(|a, b| height(a).total_cmp(&height(b))).expect("a mesh has vertices")
        };
        let (top, bottom, side) = (farthest(2, 1.0), farthest(2, -1.0), farthest(0, 1.0));
        let pins = [3 * top, 3 * top + 1, 3 * top + 2, 3 * bottom, 3 * bottom + 1, 3 * side + 1];
        Self::Unknowns(pins.to_vec())
    }
}
