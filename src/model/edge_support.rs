//! How the sides of a patch are held: ties between the nodes at an edge, beyond it, and just inside.
//!
//! On the lattice of a [`Patch`] the subdivision surface along a side is a spline of three rows: the nodes beyond (`-1`), the
//! side's own (`0`), and the first inside (`1`). What is even about the side, or odd, is so in these rows:
//!
//! ```text
//! even    u_-1 = u_1 + g           and where it vanishes on the side    u_0 = -1/4 (u_1,j + u_1,j+1)
//! odd     u_-1 = 2 u_0 - u_1       which vanishes where                 u_0 = (u_1,j-1 + u_1,j - 2 u_1,j+1) / 18
//! ```
//!
//! The right-hand column makes the limit `u/2 + sum ring / 12` vanish for what varies slowly along
//! the side. Of the odd, its integral along the side vanishes whatever the nodes do, so that a
//! constant stress does no work there: the rows telescope, and what is left where the side begins
//! (row 0) and where it ends (row m) is nothing when
//!
//! ```text
//! 0 = 222 u_0,0 + 6 u_0,-1 - 6 u_0,1 - 22 u_1,0 + 31 u_1,1 + 9 u_-1,-1
//! 0 = 138 u_0,m + 6 u_0,m+1 - 24 u_0,m-1 + 9 u_1,m+1 + 2 u_1,m - 11 u_1,m-1
//! ```
//!
//! by which the vertices at the ends follow the nodes beyond the next side, however that is held.
//! Where two odd sides meet, the vertex is the first one's. With the rows' rule at the ends as well, a
//! strip of 8 x 2 cells between two planes of symmetry was 0.3 % too soft in uniform stretch.
//!
//! The control points of an even or odd function are not so themselves on a lattice whose diagonals all run one way. Those of
//! an odd one are odd about their own values on the side, hence the 2 `u_0`, without which the curvature beside the edge
//! would be wrong by as much as the twist there. For an even one, the limit's slope across the side,
//! `(2 (u_1 - u_-1) + u_1,j+1 - u_-1,j-1 - u_0,j+1 + u_0,j-1) / 6`, has to vanish:
//!
//! ```text
//! 2 g_j + g_j-1 = d_j       d_j = u_1,j+1 - u_1,j-1 - u_0,j+1 + u_0,j-1       g_j = d_j / 2 - d_j-1 / 6,   g_0 = g_-1 = d_0 / 3
//! ```
//!
//! where `g_j` is exact for what varies slowly, and for anything in the first two rows; in the last, what is free beyond the
//! next side has no part in what is missing. Where the next side is even too, `d` vanishes on it, and is left out: the nodes
//! beyond both would follow each other. Without `g` a wall could kink in its plane of symmetry where it ends: a point
//! force there found it 33, 16 and 10 % too soft on 16, 32 and 48 cells. Limits at a held side vanish to second order in the
//! width of a cell.

use nalgebra::Matrix3;

use super::tie::{Combination, Ties};
use crate::math::{Reason, Rejected, Room, Vec3};
use crate::mesh::{BoundaryEdge, Patch, Place, Side};

/// How one side of a patch is held.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EdgeSupport {
    /// Not at all.
    #[default]
    Free,
    /// Neither displacement nor rotation.
    Clamped,
    /// It lies in a plane of symmetry, whose normal is this axis (0, 1, 2).
    Symmetry(usize),
    /// These components of the displacement vanish; the wall may turn about the side.
    Held([bool; 3]),
}

/// How each side is held, in the order of [`Side::ALL`].
pub type EdgeSupports = [EdgeSupport; 4];

impl EdgeSupport {
    /// Components of the displacement that vanish along the side.
    pub(super) fn held(self) -> [bool; 3] {
        match self {
            Self::Free => [false; 3],
            Self::Clamped => [true; 3],
            Self::Symmetry(axis) => std::array::from_fn(|k| k == axis),
            Self::Held(held) => held,
        }
    }

    /// Components for which the nodes beyond the side follow those inside.
    fn followed(self) -> [bool; 3] {
        match self {
            Self::Clamped | Self::Symmetry(_) => [true; 3],
            Self::Free | Self::Held(_) => self.held(),
        }
    }

    /// Whether something is even about the side.
    fn is_even(self) -> bool {
        matches!(self, Self::Clamped | Self::Symmetry(_))
    }

    /// Projectors on what is odd and on what is even about the side, where the wall's normal is `normal`.
    fn parity(self, normal: Vec3) -> [Matrix3<f64>; 2] {
        let one = Matrix3::identity();
        match self {
            Self::Free => [Matrix3::zeros(); 2],
            Self::Held(held) => {
                [Matrix3::from_diagonal(&Vec3::from(held.map(f64::from))), Matrix3::zeros()]
            }
            Self::Symmetry(axis) => {
                let even = 0.5 * (one + mirror(axis));
                [one - even, even]
            }
            Self::Clamped => {
                let even = normal * normal.transpose();
                [one - even, even]
            }
        }
    }
}

/// Ties between the nodes of a patch, and the unknowns (`3 node + axis`) that are held.
pub(super) struct Supported {
    pub(super) ties: Ties,
    pub(super) held: Vec<u32>,
}

/// The supports of a patch of Loop triangles.
///
/// # Errors
/// [`Rejected`] when a side that is said to lie in a plane of symmetry does not.
pub(super) fn supports_of_control_points(
    patch: &Patch,
    supports: &EdgeSupports,
    pins: &[(u32, usize)],
) -> Result<Supported, Rejected> {
    check_sides(patch, supports)?;
    let support = |side: Side| supports[side as usize];
    let mut direct = vec![Combination::new(); patch.nodes()];
    let mut held = Vec::new();
    for (node, place) in patch.node_places().into_iter().enumerate() {
        let mut own = [true; 3];
        for (side, image) in images(patch, place) {
            let rows = taken(&mut own, support(side).followed());
            if rows != Matrix3::zeros() {
                let on_side = between(place, image);
                let [odd, even] = support(side).parity(patch.normal(on_side));
                let follow = |place, t: Matrix3<f64>| (patch.node(place), rows * t);
                direct[node].extend([follow(image, even - odd), follow(on_side, 2.0 * odd)]);
                if even != Matrix3::zeros() {
                    let skew = skewness(patch, supports, side, on_side);
                    direct[node].extend(skew.map(|(place, weight)| follow(place, weight * even)));
                }
            }
        }
        for side in sides_of(patch, place) {
            let rows = taken(&mut own, support(side).held());
            if rows != Matrix3::zeros() {
                let [odd, even] = support(side).parity(patch.normal(place));
                let follow = |place, t: Matrix3<f64>| (patch.node(place), rows * t);
                let [_, beside, after] = inside(side, place);
                if odd != Matrix3::zeros() {
                    let vanishing = vanishing_odd(patch, side, place).into_iter();
                    direct[node]
                        .extend(vanishing.map(|(place, weight)| follow(place, weight * odd)));
                }
                if even != Matrix3::zeros() {
                    direct[node].extend([beside, after].map(|place| follow(place, even / -4.0)));
                }
            }
        }
        let rows = taken(&mut own, pinned(pins, node));
        if rows != Matrix3::zeros() {
            // The limit u/2 + sum ring / 12 vanishes.
            let ring = patch.rings.ring(node as u32);
            direct[node].extend(ring.iter().map(|&beside| (beside, -rows / 6.0)));
        }
        held.extend((0..3).filter(|&k| !own[k]).map(|k| (3 * node + k) as u32));
    }
    Ok(Supported { ties: Ties::new(&direct), held })
}

/// The supports of a patch of flat triangles, and its nodes at rest, mm.
///
/// A node beyond an edge only carries the normal across it: mirrored at a symmetry or a clamp; at a free or hinged edge the mean of
/// the slopes from both its ends, so that what lies beyond continues the slope that the triangle itself does not touch. With the
/// normal of the triangle alone, which is that at one end, a twist would bend the cells beside the edge: a strip of cells of `ds x dt`
/// along an edge would be too stiff by the share `0.7 ds^2 / (dt b)` of its width `b`.
///
/// # Errors
/// As [`supports_of_control_points`].
pub(super) fn supports_of_facets(
    patch: &Patch,
    supports: &EdgeSupports,
    pins: &[(u32, usize)],
) -> Result<(Supported, Vec<Vec3>), Rejected> {
    check_sides(patch, supports)?;
    let mut direct = vec![Combination::new(); patch.nodes()];
    let mut own = vec![[true; 3]; patch.nodes()];
    let places = patch.node_places();
    let mut reference: Vec<Vec3> = places.iter().map(|&place| patch.point(place)).collect();
    for (node, (own, &place)) in own.iter_mut().zip(&places).enumerate() {
        taken(own, pinned(pins, node));
        for side in sides_of(patch, place) {
            taken(own, supports[side as usize].held());
        }
    }
    for edge in patch.boundary_edges() {
        let BoundaryEdge { side, ends: [a, b], apex, beyond, .. } = edge;
        let [xa, xb, xc] = [a, b, apex].map(|v| reference[v as usize]);
        let support = supports[side as usize];
        let image = match support {
            EdgeSupport::Free | EdgeSupport::Held(_) => None,
            EdgeSupport::Symmetry(axis) => Some(mirror(axis)),
            EdgeSupport::Clamped => {
                let normal = [a, b].map(|v| patch.normal(places[v as usize])).iter().sum::<Vec3>();
                let across = normal.cross(&(xb - xa)).normalize();
                Some(Matrix3::identity() - 2.0 * across * across.transpose())
            }
        };
        let (position, follows) = match image {
            Some(t) => (xa + t * (xc - xa), vec![(apex, t)]),
            None => {
                // The end across from which the apex is not, and the vertex across from that end.
                let [pa, pb, pc] = [a, b, apex].map(|v| places[v as usize]);
                let step = |from: Place| [pc[0] - from[0], pc[1] - from[1]];
                let is_across = |[i, j]: Place| i == 0 || j == 0;
                let (end, [i, j], [di, dj]) =
                    if is_across(step(pb)) { (a, pa, step(pb)) } else { (b, pb, step(pa)) };
                let inside = patch.node([i + di, j + dj]);
                let one = Matrix3::identity();
                let [end_at, inside_at] = [end, inside].map(|v| reference[v as usize]);
                (2.0 * end_at - inside_at, vec![(end, 2.0 * one), (inside, -one)])
            }
        };
        reference[beyond as usize] = position;
        direct[beyond as usize] = follows;
        own[beyond as usize] = [false; 3];
    }
    let unknowns = own.iter().flatten().enumerate();
    let held = unknowns.filter_map(|(k, own)| (!own).then_some(k as u32)).collect();
    Ok((Supported { ties: Ties::new(&direct), held }, reference))
}

/// Takes `components` from those that are still `own`; a diagonal of ones where it did.
fn taken(own: &mut [bool; 3], components: [bool; 3]) -> Matrix3<f64> {
    let mut rows = Vec3::zeros();
    for k in 0..3 {
        if own[k] && components[k] {
            own[k] = false;
            rows[k] = 1.0;
        }
    }
    Matrix3::from_diagonal(&rows)
}

/// Components of the displacement that pins hold at `node`.
fn pinned(pins: &[(u32, usize)], node: usize) -> [bool; 3] {
    std::array::from_fn(|axis| pins.contains(&(node as u32, axis)))
}

fn mirror(axis: usize) -> Matrix3<f64> {
    Matrix3::from_diagonal(&Vec3::from_fn(|k, _| if k == axis { -1.0 } else { 1.0 }))
}

/// For a place beyond one or two sides: each side, and the image of the place inside of it.
fn images(patch: &Patch, [i, j]: Place) -> Vec<(Side, Place)> {
    let [n, m] = patch.cells().map(|cells| cells as isize);
    let all = [
        (i < 0, Side::S0, [-i, j]),
        (i > n, Side::S1, [2 * n - i, j]),
        (j < 0, Side::T0, [i, -j]),
        (j > m, Side::T1, [i, 2 * m - j]),
    ];
    all.into_iter().filter(|it| it.0).map(|(_, side, image)| (side, image)).collect()
}

/// The sides on which a vertex lies.
fn sides_of(patch: &Patch, [i, j]: Place) -> Vec<Side> {
    let [n, m] = patch.cells().map(|cells| cells as isize);
    if !(0..=n).contains(&i) || !(0..=m).contains(&j) {
        return Vec::new();
    }
    let all = [(i == 0, Side::S0), (i == n, Side::S1), (j == 0, Side::T0), (j == m, Side::T1)];
    all.into_iter().filter(|it| it.0).map(|(_, side)| side).collect()
}

/// The row inside of a vertex on `side`: one step before it, beside it, and one step after it, in the sense in which the
/// diagonal from the side's vertex leads to the last.
fn inside(side: Side, [i, j]: Place) -> [Place; 3] {
    match side {
        Side::S0 => [-1, 0, 1].map(|step| [i + 1, j + step]),
        Side::S1 => [1, 0, -1].map(|step| [i - 1, j + step]),
        Side::T0 => [-1, 0, 1].map(|step| [i + step, j + 1]),
        Side::T1 => [1, 0, -1].map(|step| [i + step, j - 1]),
    }
}

/// What the node at `on_side` follows, where all is odd about the side and vanishes on it: places and their weights.
fn vanishing_odd(patch: &Patch, side: Side, on_side: Place) -> Vec<(Place, f64)> {
    let [before, beside, after] = inside(side, on_side);
    let [back, on] = [-1, 1].map(|step| along(side, on_side, step));
    let (weights, over) = match row_of(patch, side, on_side) {
        (0, _) => {
            let beyond_both = [2 * back[0] - before[0], 2 * back[1] - before[1]];
            let row =
                [(back, -6.0), (on, 6.0), (beside, 22.0), (after, -31.0), (beyond_both, -9.0)];
            (row.to_vec(), 222.0)
        }
        (row, rows) if row == rows => {
            (vec![(on, -6.0), (back, 24.0), (after, -9.0), (beside, -2.0), (before, 11.0)], 138.0)
        }
        _ => (vec![(before, 1.0), (beside, 1.0), (after, -2.0)], 18.0),
    };
    weights.into_iter().map(|(place, weight)| (place, weight / over)).collect()
}

/// The row of a place along `side`, in the sense of [`inside`], and the last vertex's.
fn row_of(patch: &Patch, side: Side, [i, j]: Place) -> (isize, isize) {
    let [n, m] = patch.cells().map(|cells| cells as isize);
    match side {
        Side::S0 => (j, m),
        Side::S1 => (m - j, m),
        Side::T0 => (i, n),
        Side::T1 => (n - i, n),
    }
}

/// What the node beyond `on_side` has more than its image, where all is even about the side: places and their weights.
fn skewness(
    patch: &Patch,
    supports: &EdgeSupports,
    side: Side,
    on_side: Place,
) -> impl Iterator<Item = (Place, f64)> + use<> {
    let (row, rows) = row_of(patch, side, on_side);
    let next = match side {
        Side::S0 => [Side::T0, Side::T1],
        Side::S1 => [Side::T1, Side::T0],
        Side::T0 => [Side::S0, Side::S1],
        Side::T1 => [Side::S1, Side::S0],
    };
    let [begins_even, ends_even] = next.map(|side| supports[side as usize].is_even());
    let differences = match row {
        // No triangle has it.
        _ if row > rows => [(0, 0.0); 2],
        ..=0 if begins_even => [(0, 0.0); 2],
        ..=0 => [(-row, 1.0 / 3.0), (0, 0.0)],
        _ if row == rows && ends_even => [(0, 0.0); 2],
        1 if begins_even => [(0, 0.5), (0, 0.0)],
        _ => [(0, 0.5), (-1, -1.0 / 6.0)],
    };
    let weighted = differences.into_iter().filter(|(_, weight)| *weight != 0.0);
    weighted.flat_map(move |(from_here, weight)| {
        let here = along(side, on_side, from_here);
        let [before, _, after] = inside(side, here);
        let [back, on] = [-1, 1].map(|step| along(side, here, step));
        [(after, weight), (before, -weight), (on, -weight), (back, weight)]
    })
}

/// The place `steps` further along `side`, in the sense of [`inside`].
fn along(side: Side, [i, j]: Place, steps: isize) -> Place {
    match side {
        Side::S0 => [i, j + steps],
        Side::S1 => [i, j - steps],
        Side::T0 => [i + steps, j],
        Side::T1 => [i - steps, j],
    }
}

fn between([i, j]: Place, [k, l]: Place) -> Place {
    [(i + k) / 2, (j + l) / 2]
}

fn check_sides(patch: &Patch, supports: &EdgeSupports) -> Result<(), Rejected> {
    let size = patch.surface.positions.iter().map(|x| x.amax()).fold(0.0, f64::max);
    let no_symmetry = |side: Side, axis: usize, why: &str| {
        let normal = ["x", "y", "z"][axis];
        let detail = format!("side {side:?} is no plane of symmetry with normal {normal}: {why}");
        Rejected::new(Room::Model, Reason::NoSymmetry, detail, 1.0)
    };
    let mut planes = [None; 4];
    for place in patch.node_places() {
        for side in sides_of(patch, place) {
            match supports[side as usize] {
                EdgeSupport::Symmetry(axis) => {
                    let here = patch.point(place)[axis];
                    let plane: f64 = *planes[side as usize].get_or_insert(here);
                    if (here - plane).abs() > 1e-6 * size {
                        return Err(no_symmetry(side, axis, "it does not lie in a plane"));
                    }
                }
                EdgeSupport::Clamped if !patch.normal(place).iter().all(|n| n.is_finite()) => {
                    let detail = format!(
                        "side {side:?} cannot be clamped: the surface has no normal at {:.4?}",
                        patch.point(place)
                    );
                    return Err(Rejected::new(Room::Model, Reason::NoNormal, detail, 1.0));
                }
                _ => {}
            }
        }
        for (side, image) in images(patch, place) {
            let EdgeSupport::Symmetry(axis) = supports[side as usize] else { continue };
            let on_side = patch.point(between(place, image));
            let mirrored = on_side + mirror(axis) * (patch.point(image) - on_side);
            if (patch.point(place) - mirrored).norm() > 1e-6 * size {
                let why = "beyond it the formula is not the mirror image";
                return Err(no_symmetry(side, axis, why));
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
