//! Which rigid motions do the supports of a part leave free?
//!
//! ```text
//! u(x) = t + w x (x - c)             a translation t, a rotation w about the centre c of the part
//! held along d at x                  d . t + ((x - c) x d) . w = 0
//! held against turning about e       e . w = 0
//! ```
//!
//! The free motions are the null space of these rows, with `w` in turns of the part's size. That is a question of geometry, with one
//! answer on every mesh. The pivots of a tangent cannot answer it: what a free motion leaves of one is rounding, of either sign.
//!
//! Planes are not among the supports: they push, and hold nothing that does not press on them.

use nalgebra::{DMatrix, Matrix6, SymmetricEigen, Vector6};

use super::edge_support::EdgeSupport;
use super::patch_loads::PatchLoads;
use crate::math::Vec3;
use crate::mesh::Patch;

/// What supports hold of the rigid motions of a part.
struct Holds {
    centre: Vec3,
    size: f64,
    /// Sum of the squares of the rows.
    normal: Matrix6<f64>,
}

/// A rigid motion `t + w x (x - centre)`.
#[derive(Clone, Copy, Debug)]
struct Motion {
    translation: Vec3,
    rotation: Vec3,
}

impl PatchLoads {
    /// The rigid motions that sides and pins leave free to `patch`, in words; none where it is held.
    #[must_use]
    pub fn free_motions(&self, patch: &Patch) -> Option<String> {
        let positions = &patch.surface.positions;
        let mut holds = Holds::of(&positions[..patch.vertices()]);
        let axes = [Vec3::x(), Vec3::y(), Vec3::z()];
        for edge in patch.boundary_edges() {
            let support = self.supports[edge.side as usize];
            for (axis, _) in axes.iter().zip(support.held()).filter(|(_, is_held)| *is_held) {
                edge.ends.iter().for_each(|&v| holds.hold(positions[v as usize], *axis));
            }
            let turns = match support {
                EdgeSupport::Clamped => [true; 3],
                EdgeSupport::Symmetry(axis) => std::array::from_fn(|k| k != axis),
                EdgeSupport::Free | EdgeSupport::Held(_) => [false; 3],
            };
            for (axis, _) in axes.iter().zip(turns).filter(|(_, is_held)| *is_held) {
                holds.hold_turn(*axis);
            }
        }
        for &(vertex, axis) in &self.pins {
            holds.hold(positions[vertex as usize], axes[axis]);
        }
        holds.free_motions()
    }
}

/// The rigid motions that are free where the unknowns `held` (`3 node + axis`) of nodes at `positions` (mm) are held, in words; none where
/// the body is held.
#[must_use]
pub fn free_motions(positions: &[Vec3], held: &[u32]) -> Option<String> {
    let mut holds = Holds::of(positions);
    for &unknown in held {
        let (node, axis) = (unknown as usize / 3, unknown as usize % 3);
        if let Some(&place) = positions.get(node) {
            holds.hold(place, Vec3::ith(axis, 1.0));
        }
    }
    holds.free_motions()
}

impl Holds {
    /// Nothing is held yet of a part at `positions`.
    fn of(positions: &[Vec3]) -> Self {
        let low = positions.iter().fold(Vec3::repeat(f64::INFINITY), |low, x| low.inf(x));
        let high = positions.iter().fold(Vec3::repeat(f64::NEG_INFINITY), |high, x| high.sup(x));
        Self {
            centre: 0.5 * (low + high),
            size: 0.5 * (high - low).norm(),
            normal: Matrix6::zeros(),
        }
    }

    fn hold(&mut self, place: Vec3, along: Vec3) {
        let arm = (place - self.centre) / self.size;
        self.add(along, arm.cross(&along));
    }

    fn hold_turn(&mut self, about: Vec3) {
        self.add(Vec3::zeros(), about);
    }

    fn add(&mut self, t: Vec3, w: Vec3) {
        let row = Vector6::new(t.x, t.y, t.z, w.x, w.y, w.z);
        self.normal += row * row.transpose();
    }

    /// Of the null space, translations first.
    fn free_motions(&self) -> Option<String> {
        let SymmetricEigen { eigenvalues, eigenvectors } = self.normal.symmetric_eigen();
        let bound = FREE * self.normal.trace();
        let null: Vec<Vector6<f64>> = (0..6)
            .filter(|&k| eigenvalues[k] <= bound)
            .map(|k| eigenvectors.column(k).into_owned())
            .collect();
        if null.is_empty() {
            return None;
        }
        if null.len() == 6 {
            return Some("translations and rotations of every kind".to_owned());
        }
        // Rotations as rows: eliminating them leaves rows of translations alone.
        let rows = DMatrix::from_fn(null.len(), 6, |i, k| null[i][(k + 3) % 6]);
        let reduced = reduced_rows(rows);
        let motions = reduced.row_iter().map(|row| Motion {
            rotation: Vec3::new(row[0], row[1], row[2]) / self.size,
            translation: Vec3::new(row[3], row[4], row[5]),
        });
        let words: Vec<String> = motions.map(|motion| self.in_words(motion)).collect();
        Some(words.join(" and "))
    }

    fn in_words(&self, Motion { translation, rotation }: Motion) -> String {
        if rotation.norm() * self.size < 1e-6 * translation.norm() {
            return format!("translation along {}", direction(translation));
        }
        let through = self.centre + rotation.cross(&translation) / rotation.norm_squared();
        // Adding 0 makes a zero of -0.
        let [x, y, z] =
            [through.x, through.y, through.z].map(|x| (100.0 * x).round() / 100.0 + 0.0);
        format!("rotation about {} through ({x}, {y}, {z}) mm", direction(rotation))
    }
}

/// Squares of rows add up to this share of all at most where a motion is free: formulas close a part to some 1e-6 of its size.
const FREE: f64 = 1e-10;

/// The row echelon form with ones at the head of rows and zeros above and below them.
fn reduced_rows(mut rows: DMatrix<f64>) -> DMatrix<f64> {
    let mut top = 0;
    for column in 0..rows.ncols() {
        let size = |row: usize| rows[(row, column)].abs();
        let pivot = (top..rows.nrows()).max_by(|&a, &b| size(a).total_cmp(&size(b)));
        let Some(pivot) = pivot.filter(|&row| size(row) > 1e-6) else { continue };
        rows.swap_rows(top, pivot);
        let head = rows[(top, column)];
        rows.row_mut(top).scale_mut(1.0 / head);
        for row in (0..rows.nrows()).filter(|&row| row != top) {
            let factor = rows[(row, column)];
            for k in 0..rows.ncols() {
                let taken = factor * rows[(top, k)];
                rows[(row, k)] -= taken;
            }
        }
        top += 1;
    }
    rows
}

/// `z`, or where it is no axis `(0.60, 0.00, 0.80)`.
fn direction(v: Vec3) -> String {
    let unit = v.normalize();
    let axis = (0..3).find(|&k| unit[k].abs() > 1.0 - 1e-9);
    axis.map_or_else(
        || {
            let [x, y, z] = [unit.x, unit.y, unit.z].map(|x| (100.0 * x).round() / 100.0 + 0.0);
            format!("({x:.2}, {y:.2}, {z:.2})")
        },
        |k| ["x", "y", "z"][k].to_owned(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::edge_support::EdgeSupports;

    /// Half a ring about the y axis, from its lowest point to its highest.
    fn half_ring(cells: usize) -> Patch {
        let ring = |s: f64, t: f64| Vec3::new(20.0 * s.sin(), t, 7.0 - 20.0 * s.cos());
        Patch::new([cells, 2], [0.0, std::f64::consts::PI], [0.0, 2.0], 0.5, &ring).unwrap()
    }

    fn free(supports: EdgeSupports, pins: &[(u32, usize)]) -> Option<String> {
        let loads = PatchLoads { supports, pins: pins.to_vec(), ..PatchLoads::default() };
        let answers = [4, 24, 96].map(|cells| {
            let patch = half_ring(cells);
            let vertex = |v| if v == 1 { patch.vertex(0.0, 2.0).unwrap() } else { 0 };
            let pins = loads.pins.iter().map(|&(v, axis)| (vertex(v), axis)).collect();
            PatchLoads { pins, ..loads.clone() }.free_motions(&patch)
        });
        assert!(answers.iter().all(|answer| *answer == answers[0]), "{answers:?}");
        answers[0].clone()
    }

    /// The motions that mechanics teaches, the same on every mesh.
    #[test]
    fn free_motions_are_named_on_every_mesh() {
        use EdgeSupport::{Clamped, Free, Held, Symmetry};
        let named = |supports, pins: &[_]| free(supports, pins).unwrap_or_default();
        let between = [Symmetry(0), Symmetry(0), Symmetry(1), Free];
        assert_eq!(named(between, &[]), "translation along z");
        assert_eq!(free(between, &[(0, 2)]), None);
        // Without the third plane it also slides, and nothing else: planes of symmetry hold all turning but about their normal.
        let two = [Symmetry(0), Symmetry(0), Free, Free];
        assert_eq!(
            named(two, &[]),
            "rotation about x through (10, 1, 7) mm and translation along y and translation along z"
        );
        // A hinge lets it turn about itself.
        let hinge = [Held([true; 3]), Free, Free, Free];
        assert_eq!(named(hinge, &[]), "rotation about y through (0, 1, -13) mm");
        assert_eq!(free([Clamped, Free, Free, Free], &[]), None);
        assert_eq!(named([Free; 4], &[]), "translations and rotations of every kind");
        // Two pins are a hinge too.
        let pins = [(0, 0), (0, 1), (0, 2), (1, 0), (1, 2)];
        assert_eq!(named([Free; 4], &pins), "rotation about y through (0, 1, -13) mm");
    }

    /// Nodes in a row hold all but turning about it.
    #[test]
    fn nodes_in_a_row_are_a_hinge() {
        let positions: Vec<Vec3> =
            [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [2.0, 2.0, 0.0], [0.0, 0.0, 5.0]]
                .map(Vec3::from)
                .to_vec();
        let row: Vec<u32> = (0..9).collect();
        let answer = free_motions(&positions, &row).unwrap();
        assert_eq!(answer, "rotation about (0.71, 0.71, 0.00) through (1, 1, 0) mm");
        let all: Vec<u32> = (0..12).collect();
        assert_eq!(free_motions(&positions, &all), None);
    }
}
