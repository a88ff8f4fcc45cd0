//! The geometry of a surface at one point: from five derivative vectors to its two fundamental forms.
//!
//! ```text
//! d = (a1, a2, x11, x22, x12)       a_ab = a_a . a_b     b_ab = x_ab . n     n = a1 x a2 / |a1 x a2|
//! dn = -(n . da_c) a^c              a^c . a_b = 1 or 0   G^c_ab = x_ab . a^c
//! db_ab  = n . (dx_ab - G^c_ab da_c)
//! ddb_ab = 2 (dx_ab - G^c_ab da_c) . dn - b_ab dn . dn
//! ```
//!
//! A function of the forms, given with its derivatives, becomes a function of `d`, and of the nodes, by the chain rule.
//!
//! Source: Kiendl et al. (2009), isogeometric shell analysis with Kirchhoff-Love elements, for the variations.

use nalgebra::Matrix3;
use pulp::Simd;

use super::jet::{Jet, VARIABLES};
use crate::math::Vec3;
use crate::model::block::Block;
use crate::model::local::LocalDerivatives;
use crate::model::system::Inadmissible;

/// Symmetric 2x2 tensors as `(11, 22, 12)`.
pub(super) type Form = [f64; 3];

/// The weights `[,1 ,2 ,11 ,22 ,12]` of a node.
pub(super) type Row = [f64; 5];

/// The five derivative vectors of the surface at a point, and its normal.
pub(super) struct Derivatives {
    d: [Vec3; 5],
    normal: Vec3,
    /// `|a1 x a2|`.
    jacobian: f64,
}

impl Derivatives {
    #[inline(always)]
    pub(super) fn new(basis: &[Row], x: &[Vec3]) -> Self {
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
    #[inline(always)]
    pub(super) fn forms(&self) -> Result<[Form; 2], Inadmissible> {
        let [a1, a2, x11, x22, x12] = &self.d;
        if !(self.jacobian > 0.0 && self.jacobian.is_finite()) {
            return Err(Inadmissible("an element has collapsed"));
        }
        let n = &self.normal;
        Ok([[a1.dot(a1), a2.dot(a2), a1.dot(a2)], [x11.dot(n), x22.dot(n), x12.dot(n)]])
    }

    /// Adds the derivatives of an energy of the forms `(a_ab, b_ab)` to those of the nodes with weights `basis`.
    #[inline(always)]
    pub(super) fn chain<S: Simd>(
        &self,
        simd: S,
        energy: &Jet,
        basis: &[Row],
        local: &mut LocalDerivatives,
    ) {
        let frame = Frame::new(self);
        let h = self.gradient(&frame, &energy.gradient);
        for (gradient, row) in local.gradient_mut().iter_mut().zip(basis) {
            for (h, weight) in h.iter().zip(row) {
                *gradient += *weight * h;
            }
        }
        if local.with_hessian() {
            add_hessian(simd, &self.hessian(&frame, energy), basis, local);
        }
    }

    /// The energy's gradient with respect to `d`, from that with respect to the forms.
    #[inline(always)]
    fn gradient(&self, frame: &Frame, q: &[f64; VARIABLES]) -> [Vec3; 5] {
        let [a1, a2, ..] = &self.d;
        let n = &self.normal;
        let [along_1, along_2] = frame.moments(q);
        [
            2.0 * q[0] * a1 + q[2] * a2 - along_1 * n,
            2.0 * q[1] * a2 + q[2] * a1 - along_2 * n,
            q[3] * n,
            q[4] * n,
            q[5] * n,
        ]
    }

    /// The energy's Hessian with respect to `d`, in blocks.
    #[inline(always)]
    fn hessian(&self, frame: &Frame, energy: &Jet) -> [[Block; 5]; 5] {
        let [a1, a2, x11, x22, x12] = &self.d;
        let n = &self.normal;
        let q = &energy.gradient;
        let w: [[f64; VARIABLES]; VARIABLES] = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                energy.hessian[if i >= j { i * (i + 1) / 2 + j } else { j * (j + 1) / 2 + i }]
            })
        });
        let gamma = &frame.gamma;
        let dual = &frame.dual;
        let moments = frame.moments(q);
        let bend = (q[3] * x11 + q[4] * x22 + q[5] * x12).dot(n);
        // d2W/db_k da_c along the tangents, and d2W/db_k db_l G^c_l along the normal.
        let on_tangents: [[Vec3; 2]; 3] = std::array::from_fn(|k| {
            let w = &w[3 + k];
            [2.0 * w[0] * a1 + w[2] * a2, 2.0 * w[1] * a2 + w[2] * a1]
        });
        let on_normal: [[f64; 2]; 3] = std::array::from_fn(|k| {
            std::array::from_fn(|c| (0..3).map(|l| w[3 + k][3 + l] * gamma[l][c]).sum())
        });
        // The block of `da_b`, `da_c` is in_plane + n p_bc^T + p_cb n^T + normal_part n n^T.
        let p: [[Vec3; 2]; 2] = std::array::from_fn(|b| {
            std::array::from_fn(|c| {
                (0..3).fold(moments[c] * dual[b], |sum, k| sum - gamma[k][b] * on_tangents[k][c])
            })
        });
        let tangents = |b: usize, c: usize, in_plane: Matrix3<f64>, metric: f64| {
            let normal_part = (0..3).map(|k| gamma[k][b] * on_normal[k][c]).sum::<f64>()
                - bend * dual[b].dot(&dual[c]);
            let mut block =
                in_plane + n * (p[b][c] + normal_part * n).transpose() + p[c][b] * n.transpose();
            (0..3).for_each(|i| block[(i, i)] += metric);
            block
        };
        let [a11, a22] = [a1, a2].map(|a| a * a.transpose());
        let a21 = a2 * a1.transpose();
        let a12 = a21.transpose();

        let mut h = [[Block::default(); 5]; 5];
        let mut put = |s: usize, t: usize, block: Matrix3<f64>| {
            h[s][t] = Block::from(&block);
            h[t][s] = Block::from(&block.transpose());
        };
        let in_plane = 4.0 * w[0][0] * a11 + 2.0 * w[2][0] * (a12 + a21) + w[2][2] * a22;
        put(0, 0, tangents(0, 0, in_plane, 2.0 * q[0]));
        let in_plane = 4.0 * w[1][1] * a22 + 2.0 * w[2][1] * (a12 + a21) + w[2][2] * a11;
        put(1, 1, tangents(1, 1, in_plane, 2.0 * q[1]));
        let in_plane = 4.0 * w[1][0] * a21 + 2.0 * (w[2][1] * a22 + w[2][0] * a11) + w[2][2] * a12;
        put(1, 0, tangents(1, 0, in_plane, q[2]));
        let nn = n * n.transpose();
        for k in 0..3 {
            for c in 0..2 {
                let pull = on_tangents[k][c] - on_normal[k][c] * n;
                put(2 + k, c, n * pull.transpose() - q[3 + k] * dual[c] * n.transpose());
            }
            for l in 0..=k {
                put(2 + k, 2 + l, w[3 + k][3 + l] * nn);
            }
        }
        h
    }
}

/// The dual tangents `a^c`, and `G^c_ab` for `ab` = 11, 22, 12.
struct Frame {
    dual: [Vec3; 2],
    gamma: [[f64; 2]; 3],
}

impl Frame {
    #[inline(always)]
    fn new(surface: &Derivatives) -> Self {
        let [a1, a2, second @ ..] = &surface.d;
        let dual =
            [a2.cross(&surface.normal), surface.normal.cross(a1)].map(|a| a / surface.jacobian);
        Self { gamma: second.map(|x| dual.map(|a| x.dot(&a))), dual }
    }

    /// `dW/db_ab G^c_ab`.
    #[inline(always)]
    fn moments(&self, q: &[f64; VARIABLES]) -> [f64; 2] {
        std::array::from_fn(|c| (0..3).map(|k| q[3 + k] * self.gamma[k][c]).sum())
    }
}

/// `K_IJ += sum_st B_sI B_tJ H_st` for the lower blocks.
#[inline(always)]
fn add_hessian<S: Simd>(
    simd: S,
    hessian: &[[Block; 5]; 5],
    basis: &[Row],
    local: &mut LocalDerivatives,
) {
    for (j, column) in basis.iter().enumerate() {
        let mut half = [Block::default(); 5];
        for (half, row) in half.iter_mut().zip(hessian) {
            half.add_combination(simd, row, column);
        }
        for (block, row) in local.column_mut(j).iter_mut().zip(&basis[j..]) {
            block.add_combination(simd, &half, row);
        }
    }
}

#[inline(always)]
pub(super) fn det([f11, f22, f12]: Form) -> f64 {
    f11 * f22 - f12 * f12
}

/// `b a^-1 b = tr(a^-1 b) b - (det b / det a) a` (Cayley and Hamilton).
#[inline(always)]
pub(super) fn third_form(a: Form, b: Form, det_a: f64) -> Form {
    let trace = (a[1] * b[0] + a[0] * b[1] - 2.0 * a[2] * b[2]) / det_a;
    let gauss = det(b) / det_a;
    std::array::from_fn(|k| trace * b[k] - gauss * a[k])
}

/// `(1 - z k1)(1 - z k2)`: the area of a layer at height `z` over that of the mid-surface.
#[inline(always)]
pub(super) fn shifter(z: f64, a: Form, b: Form, det_a: f64) -> f64 {
    let trace = (a[1] * b[0] + a[0] * b[1] - 2.0 * a[2] * b[2]) / det_a;
    1.0 - z * trace + z * z * det(b) / det_a
}
