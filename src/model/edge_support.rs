//! How the sides of a patch are held: ties between the nodes at an edge, beyond it, and just inside.
//!
//! On the lattice of a [`Patch`] the subdivision surface along a side is a spline of three rows: the nodes beyond (`-1`), the
//! side's own (`0`), and the first inside (`1`). What is even about the side, or odd, is so in these rows:
//!
//! ```text
//! even    u_-1 = u_1               and where it vanishes on the side    u_0 = -1/8 (2 u_1,j + u_1,j+1 + u_1,j-1)
//! odd     u_-1 = 2 u_0 - u_1       which vanishes where                 u_0 = -1/12 (u_1,j+1 - u_1,j-1)
//! ```
//!
//! The right-hand column makes the limit `u/2 + sum ring / 12` vanish for what varies slowly along the side. The
//! control points of an odd function are not odd themselves on a lattice whose diagonals all run one way: they are so
//! about their own values on the side, hence the 2 `u_0`, without which the curvature beside the edge would be wrong
//! by as much as the twist there. The errors are of second order in the width of a cell.

use nalgebra::Matrix3;

use super::tie::{Combination, Ties};
use crate::math::{Rejected, Room, Vec3};
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
    fn held(self) -> [bool; 3] {
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
) -> Result<Supported, Rejected> {
    check_symmetry(patch, supports)?;
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
            }
        }
        for side in sides_of(patch, place) {
            let rows = taken(&mut own, support(side).held());
            if rows != Matrix3::zeros() {
                let [odd, even] = support(side).parity(patch.normal(place));
                let follow = |place, t: Matrix3<f64>| (patch.node(place), rows * t);
                let [before, beside, after] = inside(side, place);
                direct[node].extend([
                    follow(before, odd / 12.0 - even / 8.0),
                    follow(beside, -even / 4.0),
                    follow(after, -odd / 12.0 - even / 8.0),
                ]);
            }
        }
        held.extend((0..3).filter(|&k| !own[k]).map(|k| (3 * node + k) as u32));
    }
    Ok(Supported { ties: Ties::new(&direct), held })
}

/// The supports of a patch of flat triangles, and its nodes at rest, mm.
///
/// A node beyond an edge only carries the normal across it: that of the triangle itself, turned by nothing at a free
/// or hinged edge, mirrored at a symmetry or a clamp.
///
/// # Errors
/// As [`supports_of_control_points`].
pub(super) fn supports_of_facets(
    patch: &Patch,
    supports: &EdgeSupports,
) -> Result<(Supported, Vec<Vec3>), Rejected> {
    check_symmetry(patch, supports)?;
    let mut direct = vec![Combination::new(); patch.nodes()];
    let mut own = vec![[true; 3]; patch.nodes()];
    let places = patch.node_places();
    let mut reference: Vec<Vec3> = places.iter().map(|&place| patch.point(place)).collect();
    for (own, &place) in own.iter_mut().zip(&places) {
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
                let one = Matrix3::identity();
                (xa + xb - xc, vec![(a, one), (b, one), (apex, -one)])
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

fn between([i, j]: Place, [k, l]: Place) -> Place {
    [(i + k) / 2, (j + l) / 2]
}

fn check_symmetry(patch: &Patch, supports: &EdgeSupports) -> Result<(), Rejected> {
    let size = patch.surface.positions.iter().map(|x| x.amax()).fold(0.0, f64::max);
    for place in patch.node_places() {
        for (side, image) in images(patch, place) {
            let EdgeSupport::Symmetry(axis) = supports[side as usize] else { continue };
            let on_side = patch.point(between(place, image));
            let mirrored = on_side + mirror(axis) * (patch.point(image) - on_side);
            if (patch.point(place) - mirrored).norm() > 1e-6 * size {
                return Err(Rejected::new(
                    Room::Model,
                    "no_symmetry",
                    format!(
                        "side {side:?} is no plane of symmetry with normal {}: beyond it the formula is not the mirror image",
                        ["x", "y", "z"][axis]
                    ),
                    1.0,
                ));
            }
        }
    }
    Ok(())
}
