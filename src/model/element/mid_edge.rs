//! The geometry of a triangle among its neighbours: from six nodes to two fundamental forms.
//!
//! Nodes are the corners `x0, x1, x2` and, across the edge opposite to each, the tips `o0, o1, o2` of the neighbours.
//! The wall's normal turns linearly over the triangle; at the middle of each edge it is the mean direction `m_i` of
//! the two unit normals that meet there. With `e1 = x1 - x0`, `e2 = x2 - x0`, `b_ab = -n,a . e_b`:
//!
//! ```text
//! a11 = e1 . e1           a22 = e2 . e2           a12 = e1 . e2
//! b11 = q0 + q1           b22 = q0 + q2           b12 = q0
//! q_i = 2 m_i . (x_i - edge i) = -2 h_i sin(theta_i / 2)
//! ```
//!
//! `theta_i` is the angle by which the surface turns over the edge, positive at a ridge, and `h_i` the height of `x_i`
//! over it. So curvature needs three functions of four nodes each, whose derivatives [`Hinge`] knows in closed form.
//!
//! A sharp edge is no curvature: there `theta_i` is the angle by which the surface turns further than at rest ([`HalfTurn`]).
//!
//! Source: Chen, Sageman-Furnas, Wardetzky & Vouga (2018), physical simulation of environmentally induced thin shell
//! deformation; the reduction to `q_i` and its derivatives are our own.

use nalgebra::Matrix3;

use super::jet::{Jet, VARIABLES};
use super::kinematics::Form;
use crate::math::Vec3;
use crate::model::system::Inadmissible;

/// The least `cos(theta / 2)` at an edge: neighbours may close up to an angle of 11 degrees.
///
/// Towards 0 the mean of their normals loses its direction. The sharpest sliver of the reference part has 0.16.
const LEAST_HALF_COSINE: f64 = 0.1;

/// Half the angle by which a surface turns over an edge, by its sine and cosine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct HalfTurn {
    sine: f64,
    cosine: f64,
}

impl HalfTurn {
    pub(super) const NONE: Self = Self { sine: 0.0, cosine: 1.0 };

    /// From `other` to here.
    fn beyond(self, other: Self) -> Self {
        Self {
            sine: self.sine * other.cosine - self.cosine * other.sine,
            cosine: self.cosine * other.cosine + self.sine * other.sine,
        }
    }
}

/// A triangle and how it is hinged to its neighbours.
pub(super) struct MidEdge {
    /// `x1 - x0`, `x2 - x0`.
    e: [Vec3; 2],
    hinges: [Hinge; 3],
}

/// The edge between a triangle and its neighbour. Its nodes are `[start, end, apex, tip]`: the edge's ends, with the
/// triangle on the left, the corner opposite to it, and that of the neighbour.
struct Hinge {
    /// Twice the height of the apex times the sine of half the turn, negative at a ridge.
    q: f64,
    half_turn: HalfTurn,
    length: f64,
    along: Vec3,
    own: Wing,
    other: Wing,
}

/// One of the two triangles at an edge.
struct Wing {
    normal: Vec3,
    /// Unit vector in the triangle, square to the edge, away from it.
    outward: Vec3,
    /// Of the far corner over the edge.
    height: f64,
    /// Where that corner stands along the edge: 0 at its start, 1 at its end.
    foot: f64,
}

impl MidEdge {
    /// The triangle with nodes at `x`, whose curvature counts from the turns `rest` over its edges.
    pub(super) fn new(x: &[Vec3; 6], rest: &[HalfTurn; 3]) -> Result<Self, Inadmissible> {
        let hinge =
            |i: usize| Hinge::new([x[(i + 1) % 3], x[(i + 2) % 3], x[i], x[3 + i]], rest[i]);
        let hinges = [hinge(0)?, hinge(1)?, hinge(2)?];
        Ok(Self { e: [x[1] - x[0], x[2] - x[0]], hinges })
    }

    /// Half the turns over the edges, from where they are counted.
    pub(super) fn half_turns(&self) -> [HalfTurn; 3] {
        self.hinges.each_ref().map(|hinge| hinge.half_turn)
    }

    /// First and second fundamental form, constant over the triangle.
    pub(super) fn forms(&self) -> [Form; 2] {
        let [e1, e2] = &self.e;
        let [q0, q1, q2] = self.hinges.each_ref().map(|hinge| hinge.q);
        [[e1.dot(e1), e2.dot(e2), e1.dot(e2)], [q0 + q1, q0 + q2, q0]]
    }

    /// The triangle's area.
    pub(super) fn area(&self) -> f64 {
        self.e[0].cross(&self.e[1]).norm() / 2.0
    }

    /// The energy's gradient with respect to the nodes, from that with respect to the forms.
    pub(super) fn gradient(&self, of_forms: &[f64; VARIABLES]) -> [Vec3; 6] {
        let mut out = [Vec3::zeros(); 6];
        let of_variables = by_turns(of_forms);
        let (metric, turns) = of_variables.split_at(3);
        for (slope, row) in metric.iter().zip(self.metric_gradients()) {
            for (out, row) in out.iter_mut().zip(row) {
                *out += *slope * row;
            }
        }
        for (i, (slope, hinge)) in turns.iter().zip(&self.hinges).enumerate() {
            for (node, row) in nodes_of_hinge(i).into_iter().zip(hinge.gradient()) {
                out[node] += *slope * row;
            }
        }
        out
    }

    /// The energy's Hessian with respect to the nodes: blocks `[i][j]`, `i >= j`, the others zero.
    pub(super) fn hessian(&self, energy: &Jet) -> [[Matrix3<f64>; 6]; 6] {
        let mut out = [[Matrix3::zeros(); 6]; 6];
        let slopes = by_turns(&energy.gradient);
        let second = second_by_turns(energy);

        // What the six variables change by when a corner moves; a tip moves its own turn only.
        let mut corners = [[Vec3::zeros(); 3]; VARIABLES];
        let mut tips = [Vec3::zeros(); 3];
        corners[..3].copy_from_slice(&self.metric_gradients());
        for (i, hinge) in self.hinges.iter().enumerate() {
            let [start, end, apex, tip] = hinge.gradient();
            let nodes = nodes_of_hinge(i);
            for (node, row) in nodes.into_iter().zip([start, end, apex]) {
                corners[3 + i][node] = row;
            }
            tips[i] = tip;
        }
        let weighted: [[Vec3; 3]; VARIABLES] = std::array::from_fn(|k| {
            std::array::from_fn(|c| {
                (0..VARIABLES).fold(Vec3::zeros(), |sum, l| sum + second[k][l] * corners[l][c])
            })
        });
        for i in 0..3 {
            for j in 0..3 {
                out[3 + i][j] = tips[i] * weighted[3 + i][j].transpose();
            }
            for j in 0..=i {
                out[3 + i][3 + j] = tips[i] * (second[3 + i][3 + j] * tips[j]).transpose();
                for k in 0..VARIABLES {
                    out[i][j] += corners[k][i] * weighted[k][j].transpose();
                }
            }
        }

        // The variables' own second derivatives.
        let [s11, s22, s12, ..] = slopes;
        let of_metric = [
            (0, 0, 2.0 * (s11 + s22 + s12)),
            (1, 0, -2.0 * s11 - s12),
            (2, 0, -2.0 * s22 - s12),
            (1, 1, 2.0 * s11),
            (2, 1, s12),
            (2, 2, 2.0 * s22),
        ];
        for (i, j, entry) in of_metric {
            out[i][j] += Matrix3::from_diagonal_element(entry);
        }
        for (i, hinge) in self.hinges.iter().enumerate() {
            let nodes = nodes_of_hinge(i);
            let of_turn = hinge.hessian(slopes[3 + i]);
            for (r, &row) in nodes.iter().enumerate() {
                for (c, &column) in nodes.iter().enumerate().take(r + 1) {
                    let block = of_turn[r][c];
                    if row >= column {
                        out[row][column] += block;
                    } else {
                        out[column][row] += block.transpose();
                    }
                }
            }
        }
        out
    }

    /// Gradients of `a11`, `a22`, `a12` at the corners.
    fn metric_gradients(&self) -> [[Vec3; 3]; 3] {
        let [e1, e2] = &self.e;
        let zero = Vec3::zeros();
        [[-2.0 * e1, 2.0 * e1, zero], [-2.0 * e2, zero, 2.0 * e2], [-e1 - e2, *e2, *e1]]
    }
}

/// The nodes of hinge `i` among the six.
fn nodes_of_hinge(i: usize) -> [usize; 4] {
    [(i + 1) % 3, (i + 2) % 3, i, 3 + i]
}

/// A gradient by `(a11, a22, a12, q0, q1, q2)` from that by the forms.
fn by_turns(&[a11, a22, a12, b11, b22, b12]: &[f64; VARIABLES]) -> [f64; VARIABLES] {
    [a11, a22, a12, b11 + b22 + b12, b11, b22]
}

/// The Hessian by `(a11, a22, a12, q0, q1, q2)` from that by the forms.
fn second_by_turns(energy: &Jet) -> [[f64; VARIABLES]; VARIABLES] {
    let by_forms: [[f64; VARIABLES]; VARIABLES] = std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let (i, j) = if i >= j { (i, j) } else { (j, i) };
            energy.hessian[i * (i + 1) / 2 + j]
        })
    });
    let rows = by_forms.map(|row| by_turns(&row));
    std::array::from_fn(|j| by_turns(&std::array::from_fn(|i| rows[i][j])))
}

impl Hinge {
    fn new([start, end, apex, tip]: [Vec3; 4], rest: HalfTurn) -> Result<Self, Inadmissible> {
        let edge = end - start;
        let length = edge.norm();
        let along = edge / length;
        let own = Wing::left(&along, length, &(apex - start));
        let other = Wing::right(&along, length, &(tip - start));
        if !(own.height > 0.0 && other.height > 0.0 && length.is_finite()) {
            return Err(Inadmissible("an element has collapsed"));
        }
        let cosine = (0.5 + 0.5 * own.normal.dot(&other.normal)).sqrt();
        if cosine < LEAST_HALF_COSINE {
            return Err(Inadmissible("two elements fold onto each other"));
        }
        let sine = -other.normal.dot(&own.outward) / (2.0 * cosine);
        let half_turn = HalfTurn { sine, cosine }.beyond(rest);
        Ok(Self { q: -2.0 * own.height * half_turn.sine, half_turn, length, along, own, other })
    }

    /// The gradients of `q` at the apex and at the tip; the edge takes the reactions at their feet.
    fn forces(&self) -> [Vec3; 2] {
        let Self { half_turn: HalfTurn { sine, cosine }, own, other, .. } = self;
        let apex = *cosine * own.normal - 2.0 * sine * own.outward;
        [apex, (own.height / other.height * cosine) * other.normal]
    }

    /// The gradient of `q` at `[start, end, apex, tip]`.
    fn gradient(&self) -> [Vec3; 4] {
        let [apex, tip] = self.forces();
        let end = -self.own.foot * apex - self.other.foot * tip;
        [-end - apex - tip, end, apex, tip]
    }

    /// The Hessian of `scale q` at `[start, end, apex, tip]`: blocks `[i][j]`, `i >= j`, the others zero.
    ///
    /// With `d`, `f`, `g` the ways from the start to the end, the apex and the tip, `t` along the edge of length `l`,
    /// `n`, `c` the normal and the outward direction of a wing of height `h` (primed: the neighbour's):
    ///
    /// ```text
    /// dq  = F . phi + G . gamma           phi = df - foot dd      gamma = dg - foot' dd
    /// d2q = -(3/2) (s / h) (n . phi)^2 + (h / h'^2) (n' . gamma) (s n' / 2 - 2 cos c') . gamma
    ///     + (1 / h') (n' . gamma) (s n + 2 cos c) . phi
    ///     - (2 / l) ((t . phi) (F . dd) + (t . gamma) (G . dd))
    ///     - (1 / l^2) (h (c . dd) (F . dd) + h' (c' . dd) (G . dd))
    /// ```
    fn hessian(&self, scale: f64) -> [[Matrix3<f64>; 4]; 4] {
        let Self { length, along, own, other, .. } = self;
        let [sine, cosine] = [scale * self.half_turn.sine, scale * self.half_turn.cosine];
        let [apex, tip] = self.forces().map(|force| scale * force);

        let phi_phi = (-1.5 * sine / own.height * own.normal) * own.normal.transpose();
        let bent = (0.5 * sine * own.normal + cosine * own.outward) / other.height;
        let gamma_phi = other.normal * bent.transpose();
        let bent = (own.height / other.height.powi(2))
            * (0.25 * sine * other.normal - cosine * other.outward);
        let gamma_gamma = plus_transposed(other.normal * bent.transpose());
        let turned = -along / *length;
        let d_phi = apex * turned.transpose();
        let d_gamma = tip * turned.transpose();
        let shift = -0.5 / (length * length);
        let d_d = plus_transposed(
            apex * (shift * own.height * own.outward).transpose()
                + tip * (shift * other.height * other.outward).transpose(),
        );

        // From (dd, phi, gamma) to (dd, df, dg).
        let (foot, other_foot) = (own.foot, other.foot);
        let f_d = d_phi.transpose() - foot * phi_phi - other_foot * gamma_phi.transpose();
        let g_d = d_gamma.transpose() - foot * gamma_phi - other_foot * gamma_gamma;
        let d_d = d_d - foot * (d_phi + f_d) - other_foot * (d_gamma + g_d);
        // The start takes what leaves translations free.
        let end_start = -(d_d + f_d.transpose() + g_d.transpose());
        let apex_start = -(f_d + phi_phi + gamma_phi.transpose());
        let tip_start = -(g_d + gamma_phi + gamma_gamma);
        let start_start = -(end_start + apex_start + tip_start);
        let zero = Matrix3::zeros();
        [
            [start_start, zero, zero, zero],
            [end_start, d_d, zero, zero],
            [apex_start, f_d, phi_phi, zero],
            [tip_start, g_d, gamma_phi, gamma_gamma],
        ]
    }
}

impl Wing {
    /// The wing on the left of an edge with the unit vector `along`, whose far corner is `far` from the edge's start.
    fn left(along: &Vec3, length: f64, far: &Vec3) -> Self {
        let normal = along.cross(far);
        let height = normal.norm();
        let normal = normal / height;
        Self { normal, outward: normal.cross(along), height, foot: far.dot(along) / length }
    }

    /// The wing on the right of that edge.
    fn right(along: &Vec3, length: f64, far: &Vec3) -> Self {
        let left = Self::left(along, length, far);
        Self { normal: -left.normal, ..left }
    }
}

fn plus_transposed(matrix: Matrix3<f64>) -> Matrix3<f64> {
    matrix + matrix.transpose()
}
