//! The geometry of a surface at one point: from five derivative vectors to its two fundamental forms.
//!
//! ```text
//! d = (a1, a2, x11, x22, x12)     a_ab = a_a . a_b     b_ab = x_ab . n     n = a1 x a2 / |a1 x a2|
//! dn = P (da1 x a2 + a1 x da2) / |a1 x a2|             P = I - n n^T
//! ```
//!
//! A function of the forms, given with its derivatives, becomes a function of `d` by the chain rule.

use nalgebra::Matrix3;

use super::jet::{Jet, VARIABLES};
use crate::math::Vec3;
use crate::model::system::Inadmissible;

/// Symmetric 2x2 tensors as `(11, 22, 12)`.
pub(super) type Form = [f64; 3];

/// The five derivative vectors of the surface at a point, and its normal.
pub(super) struct Derivatives {
    d: [Vec3; 5],
    normal: Vec3,
    /// `|a1 x a2|`.
    jacobian: f64,
}

impl Derivatives {
    pub(super) fn new(basis: &[[f64; 5]], x: &[Vec3]) -> Self {
        let mut d = [Vec3::zeros(); 5];
        for (row, x) in basis.iter().zip(x) {
            for (d, weight) in d.iter_mut().zip(row) {
                *d += *weight * x;
            }
        }
        let normal = d[0].cross(&d[1]);
        let jacobian = normal.norm();
        Self { d, normal: normal / jacobian, jacobian }
    }

    /// First and second fundamental form.
    pub(super) fn forms(&self) -> Result<[Form; 2], Inadmissible> {
        let [a1, a2, x11, x22, x12] = &self.d;
        if !(self.jacobian > 0.0 && self.jacobian.is_finite()) {
            return Err(Inadmissible("an element has collapsed"));
        }
        let n = &self.normal;
        Ok([[a1.dot(a1), a2.dot(a2), a1.dot(a2)], [x11.dot(n), x22.dot(n), x12.dot(n)]])
    }

    /// The parts of `db_k` along `da1` and `da2`: `v x a` with `v = P x_k / j`.
    fn normal_parts(&self, k: usize) -> [Vec3; 2] {
        let x = &self.d[2 + k];
        let v = (x - self.normal * self.normal.dot(x)) / self.jacobian;
        [self.d[1].cross(&v), v.cross(&self.d[0])]
    }

    /// The energy's gradient with respect to `d`, from that with respect to `(a_ab, b_ab)`.
    pub(super) fn gradient(&self, q: &[f64; VARIABLES]) -> [Vec3; 5] {
        let [a1, a2, ..] = &self.d;
        let mut out = [
            2.0 * q[0] * a1 + q[2] * a2,
            2.0 * q[1] * a2 + q[2] * a1,
            q[3] * self.normal,
            q[4] * self.normal,
            q[5] * self.normal,
        ];
        for k in 0..3 {
            let [along_1, along_2] = self.normal_parts(k);
            out[0] += q[3 + k] * along_1;
            out[1] += q[3 + k] * along_2;
        }
        out
    }

    /// The energy's Hessian with respect to `d`.
    #[expect(clippy::needless_range_loop, reason = "indices of tensors")]
    pub(super) fn hessian(&self, energy: &Jet) -> [[Matrix3<f64>; 5]; 5] {
        let [a1, a2, ..] = &self.d;
        let q = &energy.gradient;
        let n = &self.normal;
        // Rows of dq/dd: which of the five vectors each form depends on, and how.
        let zero = Vec3::zeros();
        let mut rows = [[zero; 5]; VARIABLES];
        rows[0][0] = 2.0 * a1;
        rows[1][1] = 2.0 * a2;
        rows[2][0] = *a2;
        rows[2][1] = *a1;
        for k in 0..3 {
            let [along_1, along_2] = self.normal_parts(k);
            rows[3 + k][0] = along_1;
            rows[3 + k][1] = along_2;
            rows[3 + k][2 + k] = *n;
        }
        let full = |i: usize, j: usize| {
            let (i, j) = if i >= j { (i, j) } else { (j, i) };
            energy.hessian[i * (i + 1) / 2 + j]
        };
        let weighted: [[Vec3; 5]; VARIABLES] = std::array::from_fn(|i| {
            std::array::from_fn(|s| {
                (0..VARIABLES).fold(zero, |sum, j| sum + full(i, j) * rows[j][s])
            })
        });
        let mut h = [[Matrix3::zeros(); 5]; 5];
        for s in 0..5 {
            for t in 0..=s {
                for i in 0..VARIABLES {
                    h[s][t] += rows[i][s] * weighted[i][t].transpose();
                }
            }
        }
        // The forms' own second derivatives.
        h[0][0] += Matrix3::from_diagonal_element(2.0 * q[0]);
        h[1][1] += Matrix3::from_diagonal_element(2.0 * q[1]);
        h[1][0] += Matrix3::from_diagonal_element(q[2]);
        let projector = Matrix3::identity() - n * n.transpose();
        let per_area = projector / self.jacobian;
        let dn = [-(per_area * a2.cross_matrix()), per_area * a1.cross_matrix()];
        let mut moment = zero;
        for k in 0..3 {
            h[2 + k][0] += q[3 + k] * dn[0];
            h[2 + k][1] += q[3 + k] * dn[1];
            moment += q[3 + k] * self.d[2 + k];
        }
        let v = per_area * moment;
        let of_normal =
            -(v * n.transpose() + n * v.transpose() + projector * (moment.dot(n) / self.jacobian))
                / self.jacobian;
        let area = [-a2.cross_matrix(), a1.cross_matrix()];
        h[0][0] += area[0].transpose() * of_normal * area[0];
        h[1][1] += area[1].transpose() * of_normal * area[1];
        h[1][0] += area[1].transpose() * of_normal * area[0] + v.cross_matrix();
        for s in 0..5 {
            for t in 0..s {
                h[t][s] = h[s][t].transpose();
            }
        }
        h
    }
}

pub(super) fn det([f11, f22, f12]: Form) -> f64 {
    f11 * f22 - f12 * f12
}

/// `b a^-1 b = tr(a^-1 b) b - (det b / det a) a` (Cayley and Hamilton).
pub(super) fn third_form(a: Form, b: Form, det_a: f64) -> Form {
    let trace = (a[1] * b[0] + a[0] * b[1] - 2.0 * a[2] * b[2]) / det_a;
    let gauss = det(b) / det_a;
    std::array::from_fn(|k| trace * b[k] - gauss * a[k])
}

/// `(1 - z k1)(1 - z k2)`: the area of a layer at height `z` over that of the mid-surface.
pub(super) fn shifter(z: f64, a: Form, b: Form, det_a: f64) -> f64 {
    let trace = (a[1] * b[0] + a[0] * b[1] - 2.0 * a[2] * b[2]) / det_a;
    1.0 - z * trace + z * z * det(b) / det_a
}
