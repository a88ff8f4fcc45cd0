//! Forces without a potential: those carried by the wall, and what a pressure on an open surface has besides one.
//!
//! A carried force keeps its components along an edge of the wall (t), its normal (n) and across (t x n):
//!
//! ```text
//! F = c_t t + c_n n + c_m t x n,    t = d1/|d1|,  n = d1 x d2/|d1 x d2|
//! ```
//!
//! A pressure p acts with `p n da` wherever the surface is. On facets `a, b, c` that is `p (a x b + b x c + c x a)/6` at
//! each corner, of which the gradient of the volume over an origin, `p V`, has the edge opposite to it. What the other two
//! leave cancels where facets meet; on the rim of an open surface it stays:
//!
//! ```text
//! p n da  =  p dV + p/6 (a x b)  at a and at b, for each edge a -> b of the rim
//! ```
//!
//! which does not depend on the origin together with `dV`. Schweizerhof & Ramm (1984, Computers & Structures 18:1099)
//! derive that boundary term. The derivative of these forces is split: its symmetric part goes to the tangent, and its
//! skew part is what [`FollowerLoads::add_skew_stiffness`] multiplies with.

use nalgebra::Matrix3;

use crate::math::Vec3;
use crate::mesh::Side;
use crate::model::body::Configuration;
use crate::model::local::{LocalDerivatives, Term};
use crate::model::part_term::PartTerm;
use crate::model::system::Inadmissible;

/// A force that keeps its angle to the wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FollowerForce {
    /// On a vertex.
    Point {
        /// Which.
        vertex: u32,
        /// Force at rest, N.
        force: Vec3,
    },
    /// Along a side of a patch.
    Edge {
        /// Which.
        side: Side,
        /// Force at rest per length of the side at rest, N/mm.
        per_length: Vec3,
    },
}

/// Forces without a potential on small stencils, as a term without energy.
#[derive(Clone, Debug)]
pub(in crate::model) struct FollowerLoads {
    /// Share of the loads that is applied.
    pub load_factor: f64,
    stencils: Vec<Vec<u32>>,
    followers: Vec<Follower>,
}

/// The forces on one stencil.
#[derive(Clone, Debug)]
pub(in crate::model) enum Follower {
    /// A force that keeps its angle to the wall.
    Carried(CarriedForce),
    /// An edge of the rim of a surface under pressure.
    OpenEdge(OpenEdge),
}

/// A force that keeps its angle to the wall.
#[derive(Clone, Debug)]
pub(in crate::model) struct CarriedForce {
    /// Of each node of the stencil: its share of the force, and its weights on the tangents `d1` and `d2`.
    rows: Vec<[f64; 3]>,
    /// Along `t`, `n` and `t x n`, N.
    components: Vec3,
}

/// An edge of the rim of a surface under pressure.
#[derive(Clone, Debug)]
pub(in crate::model) struct OpenEdge {
    /// Of each node of the stencil: its weights on the edge's start, middle and end, in the sense of its element.
    pub rows: Vec<[f64; 3]>,
    /// MPa.
    pub pressure: f64,
    /// From where the volume is measured, mm.
    pub origin: Vec3,
    /// Ones, but for a zero along the normal of the plane of symmetry in which the edge lies: there nothing moves.
    pub kept: Vec3,
}

impl FollowerLoads {
    /// The loads `followers` on the nodes `stencils`, each ascending.
    ///
    /// # Panics
    /// When there are not as many of both.
    #[must_use]
    pub(in crate::model) fn new(stencils: Vec<Vec<u32>>, followers: Vec<Follower>) -> Self {
        assert_eq!(stencils.len(), followers.len());
        Self { load_factor: 0.0, stencils, followers }
    }

    /// Adds the whole loads to `forces`, one vector for each node, where all nodes are at `positions`, N.
    pub(in crate::model) fn add_forces(&self, positions: &[Vec3], forces: &mut [Vec3]) {
        for (stencil, follower) in self.stencils.iter().zip(&self.followers) {
            for (&node, force) in stencil.iter().zip(follower.forces(&at(stencil, positions))) {
                forces[node as usize] += force;
            }
        }
    }

    /// Adds to `out` the skew part of the derivative of the applied loads, with the sign of the residual, times `v`, N.
    pub(in crate::model) fn add_skew_stiffness(
        &self,
        positions: &[Vec3],
        v: &[Vec3],
        out: &mut [Vec3],
    ) {
        for (stencil, follower) in self.stencils.iter().zip(&self.followers) {
            let stiffness = follower.stiffness(&at(stencil, positions));
            for (i, &row) in stencil.iter().enumerate() {
                for (j, &column) in stencil.iter().enumerate() {
                    let skew = stiffness.block(i, j) - stiffness.block(j, i).transpose();
                    out[row as usize] -= 0.5 * self.load_factor * skew * v[column as usize];
                }
            }
        }
    }
}

impl PartTerm for FollowerLoads {
    fn boxed(&self) -> Box<dyn PartTerm> {
        Box::new(self.clone())
    }

    fn widens_pattern(&self) -> bool {
        false
    }

    fn set_load(&mut self, load: f64) {
        self.load_factor = load;
    }

    fn has_potential(&self) -> bool {
        false
    }

    fn add_load_direction(&self, at: &Configuration<'_>, direction: &mut [Vec3]) {
        self.add_forces(at.positions(), direction);
    }

    fn add_circulation(&self, at: &Configuration<'_>, v: &[Vec3], out: &mut [Vec3]) {
        self.add_skew_stiffness(at.positions(), v, out);
    }
}

impl Term for FollowerLoads {
    fn stencils(&self) -> &[Vec<u32>] {
        &self.stencils
    }

    fn energy(&self, _: usize, _: &[Vec3]) -> Result<f64, Inadmissible> {
        Ok(0.0)
    }

    /// The forces with the sign of a gradient, and the symmetric part of their derivative.
    fn derivatives(
        &self,
        s: usize,
        x: &[Vec3],
        local: &mut LocalDerivatives,
    ) -> Result<f64, Inadmissible> {
        let follower = &self.followers[s];
        for (gradient, force) in local.gradient_mut().iter_mut().zip(follower.forces(x)) {
            *gradient -= self.load_factor * force;
        }
        if local.with_hessian() {
            let stiffness = follower.stiffness(x);
            for j in 0..x.len() {
                for i in j..x.len() {
                    let twice = stiffness.block(i, j) + stiffness.block(j, i).transpose();
                    *local.block_mut(i, j) += -0.5 * self.load_factor * twice;
                }
            }
        }
        Ok(0.0)
    }
}

/// `d force_i / d x_j` of the nodes of a stencil.
struct Stiffness {
    size: usize,
    blocks: Vec<Matrix3<f64>>,
}

impl Stiffness {
    fn new(size: usize, block: impl Fn(usize, usize) -> Matrix3<f64>) -> Self {
        let pairs = (0..size).flat_map(|i| (0..size).map(move |j| (i, j)));
        Self { size, blocks: pairs.map(|(i, j)| block(i, j)).collect() }
    }

    fn block(&self, i: usize, j: usize) -> Matrix3<f64> {
        self.blocks[i * self.size + j]
    }
}

impl Follower {
    fn forces(&self, x: &[Vec3]) -> Vec<Vec3> {
        match self {
            Self::Carried(carried) => {
                let force = Frame::new(carried.tangents(x)).vector(carried.components);
                carried.rows.iter().map(|[share, ..]| *share * force).collect()
            }
            Self::OpenEdge(edge) => {
                let points = edge.points(x);
                let mut by_point = [Vec3::zeros(); 3];
                for ([a, b], w) in CHORDS {
                    let normal = points[a].cross(&points[b]);
                    let force = edge.pressure * w / 6.0 * edge.kept.component_mul(&normal);
                    by_point[a] += force;
                    by_point[b] += force;
                }
                let combined = |row: &[f64; 3]| (0..3).map(|k| row[k] * by_point[k]).sum();
                edge.rows.iter().map(combined).collect()
            }
        }
    }

    fn stiffness(&self, x: &[Vec3]) -> Stiffness {
        match self {
            Self::Carried(carried) => {
                let frame = Frame::new(carried.tangents(x));
                let [by_d1, by_d2] = frame.vector_derivatives(carried.components);
                Stiffness::new(x.len(), |i, j| {
                    let [_, w1, w2] = carried.rows[j];
                    carried.rows[i][0] * (w1 * by_d1 + w2 * by_d2)
                })
            }
            Self::OpenEdge(edge) => {
                let points = edge.points(x);
                let mut by_point = [[Matrix3::zeros(); 3]; 3];
                for ([a, b], w) in CHORDS {
                    let factor = edge.pressure * w / 6.0 * Matrix3::from_diagonal(&edge.kept);
                    for row in [a, b] {
                        by_point[row][a] -= factor * points[b].cross_matrix();
                        by_point[row][b] += factor * points[a].cross_matrix();
                    }
                }
                Stiffness::new(x.len(), |i, j| {
                    let mut block = Matrix3::zeros();
                    for (by_row, wi) in by_point.iter().zip(edge.rows[i]) {
                        for (by_column, wj) in by_row.iter().zip(edge.rows[j]) {
                            block += wi * wj * by_column;
                        }
                    }
                    block
                })
            }
        }
    }
}

impl CarriedForce {
    /// The force that is `force` where the stencil's nodes are at `reference`; `rows` are each node's share of it and its
    /// weights on two tangents of the wall, of which the first is carried along.
    #[must_use]
    pub(in crate::model) fn new(rows: Vec<[f64; 3]>, force: Vec3, reference: &[Vec3]) -> Self {
        let mut carried = Self { rows, components: Vec3::zeros() };
        let Frame { t, n, .. } = Frame::new(carried.tangents(reference));
        carried.components = Vec3::new(force.dot(&t), force.dot(&n), force.dot(&t.cross(&n)));
        carried
    }

    fn tangents(&self, x: &[Vec3]) -> [Vec3; 2] {
        let sum = |k: usize| self.rows.iter().zip(x).map(|(row, x)| row[k] * x).sum();
        [sum(1), sum(2)]
    }
}

impl OpenEdge {
    /// The edge's start, middle and end, seen from the origin.
    fn points(&self, x: &[Vec3]) -> [Vec3; 3] {
        let mut points = [-self.origin; 3];
        for (row, x) in self.rows.iter().zip(x) {
            for (point, weight) in points.iter_mut().zip(row) {
                *point += *weight * x;
            }
        }
        points
    }
}

/// Chords over an edge's start, middle and end, with their weights: those of the facets of a chamber.
const CHORDS: [([usize; 2], f64); 3] =
    [([0, 1], 4.0 / 3.0), ([1, 2], 4.0 / 3.0), ([0, 2], -1.0 / 3.0)];

/// A frame that the wall carries along.
struct Frame {
    d: [Vec3; 2],
    t: Vec3,
    n: Vec3,
}

impl Frame {
    fn new(d: [Vec3; 2]) -> Self {
        Self { d, t: d[0].normalize(), n: d[0].cross(&d[1]).normalize() }
    }

    fn vector(&self, c: Vec3) -> Vec3 {
        c.x * self.t + c.y * self.n + c.z * self.t.cross(&self.n)
    }

    /// Derivatives of [`Self::vector`] with respect to the two tangents.
    fn vector_derivatives(&self, c: Vec3) -> [Matrix3<f64>; 2] {
        let one = Matrix3::identity();
        let Self { d: [d1, d2], t, n } = self;
        let dt = (one - t * t.transpose()) / d1.norm();
        let dn = (one - n * n.transpose()) / d1.cross(d2).norm();
        let by_t = (c.x * one - c.z * n.cross_matrix()) * dt;
        let by_n = (c.y * one + c.z * t.cross_matrix()) * dn;
        [by_t - by_n * d2.cross_matrix(), by_n * d1.cross_matrix()]
    }
}

fn at(stencil: &[u32], positions: &[Vec3]) -> Vec<Vec3> {
    stencil.iter().map(|&v| positions[v as usize]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::element::ElementPoints;
    use crate::model::load::ChamberPressure;
    use crate::model::test_shells::{TestShell, difference};

    const PRESSURE: f64 = 0.03;

    /// Forces and rims on the triangles of an egg.
    fn loads(shell: &TestShell) -> FollowerLoads {
        let (mut stencils, mut followers) = (Vec::new(), Vec::new());
        for (k, points) in shell.points().into_iter().enumerate().step_by(9) {
            let reference: Vec<Vec3> = at(&points.nodes, &shell.reference);
            followers.push(if k % 2 == 0 {
                // The tangents are chords between the element's corners.
                let row = |w: &[f64; 6]| [w[5], w[1] - w[0], w[2] - w[0]];
                let rows = points.weights.iter().map(row).collect();
                Follower::Carried(CarriedForce::new(rows, Vec3::new(0.3, -0.5, 0.7), &reference))
            } else {
                Follower::OpenEdge(rim(&points, [0, 5, 1], Vec3::new(3.0, -2.0, 5.0)))
            });
            stencils.push(points.nodes);
        }
        FollowerLoads { load_factor: 0.6, ..FollowerLoads::new(stencils, followers) }
    }

    fn rim(points: &ElementPoints, along: [usize; 3], origin: Vec3) -> OpenEdge {
        let rows = points.weights.iter().map(|w| along.map(|point| w[point])).collect();
        let kept = Vec3::repeat(1.0);
        OpenEdge { rows, pressure: PRESSURE, origin, kept }
    }

    /// Symmetric and skew part together are the derivative of the forces, and each is what its name says.
    #[test]
    fn both_parts_are_the_derivative_of_the_forces() {
        for seed in 0..3 {
            let shell = TestShell::new(seed);
            let loads = loads(&shell);
            let x = &shell.deformed;
            let wave = |phase: f64| -> Vec<Vec3> {
                let wave = |k: usize| ((k as f64) * 1.7 + phase).sin();
                (0..x.len()).map(|v| Vec3::from_fn(|axis, _| wave(3 * v + axis))).collect()
            };
            let [v, w] = [wave(0.0), wave(1.0)];
            let residual = |h: f64| -> nalgebra::DVector<f64> {
                let moved: Vec<Vec3> = x.iter().zip(&v).map(|(x, v)| x + h * v).collect();
                let mut forces = vec![Vec3::zeros(); x.len()];
                loads.add_forces(&moved, &mut forces);
                let flat = forces.iter().flat_map(|f| [f.x, f.y, f.z]);
                -loads.load_factor * nalgebra::DVector::from_iterator(3 * x.len(), flat)
            };
            let exact = difference(1e-3, residual);
            let symmetric = |v: &[Vec3]| {
                let mut out = vec![Vec3::zeros(); x.len()];
                for (s, stencil) in loads.stencils.iter().enumerate() {
                    let mut local = LocalDerivatives::with_capacity(stencil.len());
                    local.reset(stencil.len(), true);
                    loads.derivatives(s, &at(stencil, x), &mut local).unwrap();
                    for (i, &row) in stencil.iter().enumerate() {
                        for (j, &column) in stencil.iter().enumerate() {
                            let block = if i >= j {
                                local.block(i, j)
                            } else {
                                local.block(j, i).transpose()
                            };
                            out[row as usize] += block * v[column as usize];
                        }
                    }
                }
                out
            };
            let skew = |v: &[Vec3]| {
                let mut out = vec![Vec3::zeros(); x.len()];
                loads.add_skew_stiffness(x, v, &mut out);
                out
            };
            let dot =
                |a: &[Vec3], b: &[Vec3]| -> f64 { a.iter().zip(b).map(|(a, b)| a.dot(b)).sum() };
            let (kv, nv) = (symmetric(&v), skew(&v));
            for (k, (sum, exact)) in kv
                .iter()
                .zip(&nv)
                .map(|(k, n)| k + n)
                .zip(exact.as_slice().as_chunks::<3>().0)
                .enumerate()
            {
                // Fourth order in 1e-3 over elements of some 3 mm, and the rounding of forces of 1 over the step.
                assert!((sum - Vec3::from(*exact)).norm() < 1e-10, "{k}: {sum} {exact:?}");
            }
            assert!(dot(&nv, &nv) > 1e-3 && dot(&kv, &kv) > 1e-3);
            assert!((dot(&w, &kv) - dot(&v, &symmetric(&w))).abs() < 1e-12);
            assert!(
                (dot(&w, &nv) + dot(&v, &skew(&w))).abs() < 1e-12 && dot(&v, &nv).abs() < 1e-12
            );
        }
    }

    /// A force turns as the body that carries it.
    #[test]
    fn carried_forces_turn_with_the_wall() {
        let shell = TestShell::new(1);
        let loads = loads(&shell);
        let turn = nalgebra::UnitQuaternion::from_scaled_axis(Vec3::new(0.4, 1.9, -0.7));
        for (stencil, follower) in loads.stencils.iter().zip(&loads.followers) {
            let Follower::Carried(_) = follower else { continue };
            let at_rest = follower.forces(&at(stencil, &shell.reference));
            let whole: Vec3 = at_rest.iter().sum();
            assert!((whole - Vec3::new(0.3, -0.5, 0.7)).norm() < 1e-14, "{whole}");
            let turned: Vec<Vec3> = shell.reference.iter().map(|x| turn * x).collect();
            let moved: Vec3 = follower.forces(&at(stencil, &turned)).iter().sum();
            assert!((moved - turn * whole).norm() < 1e-14, "{moved}");
        }
    }

    /// On a single open element with its whole rim, gradient of the volume and rim add up to the pressure on its facets, a third
    /// to each corner; wherever the origin is.
    #[test]
    fn pressure_on_an_open_surface_is_normal_to_it() {
        let shell = TestShell::new(2);
        let points = &shell.points()[17];
        let x = at(&points.nodes, &shell.deformed);
        let corners = points.at(&x);
        let mut exact = [Vec3::zeros(); 6];
        let small = [[0, 5, 4], [1, 3, 5], [2, 4, 3], [3, 4, 5]].map(|facet| (facet, 4.0 / 3.0));
        for ([a, b, c], w) in small.into_iter().chain([([0, 1, 2], -1.0 / 3.0)]) {
            let area = 0.5 * (corners[b] - corners[a]).cross(&(corners[c] - corners[a]));
            for k in [a, b, c] {
                exact[k] += w * PRESSURE / 3.0 * area;
            }
        }
        for origin in [Vec3::zeros(), Vec3::new(30.0, -70.0, 20.0)] {
            let chamber = ChamberPressure::cut(std::slice::from_ref(points), Vec::new(), origin);
            let mut gradient = vec![Vec3::zeros(); shell.deformed.len()];
            chamber.add_volume_gradient(&shell.deformed, &mut gradient);
            gradient.iter_mut().for_each(|gradient| *gradient *= PRESSURE);
            let edges = [[0, 5, 1], [1, 3, 2], [2, 4, 0]];
            let followers = edges.map(|along| Follower::OpenEdge(rim(points, along, origin)));
            let rim = FollowerLoads::new(vec![points.nodes.clone(); 3], followers.to_vec());
            rim.add_forces(&shell.deformed, &mut gradient);
            for (&node, weights) in points.nodes.iter().zip(&points.weights) {
                let exact: Vec3 = exact.iter().zip(weights).map(|(f, w)| *w * f).sum();
                // Rounding of squares of 80 mm.
                let miss = (gradient[node as usize] - exact).norm();
                assert!(miss < 1e-13 * PRESSURE * 6400.0, "{miss:e}");
            }
        }
    }
}
