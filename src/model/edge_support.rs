//! How the sides of a patch are held: ties between the nodes at an edge, beyond it, and just inside.
//!
//! On the lattice of a [`Patch`] the subdivision surface along a side is a spline of three rows: the nodes beyond, the
//! side's own, and the first inside. A function is even or odd about the side when the rows beyond and inside are so,
//!
//! ```text
//! u_beyond = T u_inside        T = 1 even,  -1 odd,  1 - 2 e e^T mirrored in the plane with normal e
//! u_side   = -1/8 sum (four nodes of its ring that are not on the side)        where it is to vanish
//! ```
//!
//! The last line makes the limit `u/2 + sum ring / 12` vanish for what varies slowly along the side. The errors are of
//! second order in the width of a cell.

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

    /// How a node beyond the side follows its image inside, where the wall's normal is `normal`.
    fn image(self, normal: Vec3) -> Matrix3<f64> {
        match self {
            Self::Free => Matrix3::zeros(),
            Self::Clamped => 2.0 * normal * normal.transpose() - Matrix3::identity(),
            Self::Symmetry(axis) => mirror(axis),
            Self::Held(_) => -Matrix3::identity(),
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
                let t = rows * support(side).image(patch.normal(between(place, image)));
                direct[node].push((patch.node(image), t));
            }
        }
        for side in sides_of(patch, place) {
            let rows = taken(&mut own, support(side).held());
            if rows != Matrix3::zeros() {
                let off_side = off_side(side, place).map(|place| patch.node(place));
                direct[node].extend(off_side.map(|node| (node, -0.125 * rows)));
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

/// The neighbours of a vertex on `side` that are not on it.
fn off_side(side: Side, [i, j]: Place) -> [Place; 4] {
    match side {
        Side::S0 | Side::S1 => [[i + 1, j], [i + 1, j + 1], [i - 1, j], [i - 1, j - 1]],
        Side::T0 | Side::T1 => [[i, j + 1], [i + 1, j + 1], [i, j - 1], [i - 1, j - 1]],
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
