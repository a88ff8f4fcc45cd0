//! The wall at one point: its energy as a function of the two fundamental forms of its mid-surface.
//!
//! A layer at height `z` of the wall has the metric
//!
//! ```text
//! G(z) = A - 2 z B + z^2 B A^-1 B                 at rest
//! g(z) = a - 2 z l3 b + (z l3)^2 b a^-1 b         deformed; l3 = the thickness stretch of the mid-surface
//! W    = dA sum_layers w_z sqrt(det G / det A) psi(G(z), g(z))
//! ```
//!
//! The factor `l3` makes a stretched wall thinner in bending too. Three Gauss points stand through the wall.
//! Every element shares this; an element says only how the forms follow from its nodes.
//!
//! Where a fold at rest is tighter than the wall allows (a crease, a sliver across a rim), the layers are drawn
//! together until the innermost keeps [`TIGHTEST_FOLD`] of its area: the membrane stays whole, the bending softens.
//!
//! Source: Cirak & Ortiz (2001), finite-deformation thin shells by subdivision.

use super::jet::{Jet, VARIABLES};
use super::kinematics::{Form, det, shifter, third_form};
use crate::model::material::Material;
use crate::model::system::Inadmissible;

/// Abscissae and weights of the three-point Gauss rule on [-1, 1]; 0.6f64.sqrt() to the last digit.
const GAUSS: [(f64, f64); 3] =
    [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];

/// The least area of a layer at rest, as a share of the mid-surface's.
pub(super) const TIGHTEST_FOLD: f64 = 0.25;

/// The wall around one point of the mid-surface, at rest.
#[derive(Clone, Debug)]
pub(super) struct WallPoint {
    mid: Metric,
    layers: [Layer; 3],
}

/// A layer of the wall at rest.
#[derive(Clone, Copy, Debug)]
struct Layer {
    z: f64,
    /// Reference volume, mm^3.
    volume: f64,
    metric: Metric,
}

/// A reference metric, as the invariants need it.
#[derive(Clone, Copy, Debug)]
struct Metric {
    /// `(G^11, G^22, 2 G^12)`, so that `T` is a dot product with `(g11, g22, g12)`.
    inverse: Form,
    inverse_det: f64,
}

impl WallPoint {
    /// The wall of `thickness` (mm) whose mid-surface has the forms `a`, `b` and the area `area` (mm^2), its layers
    /// spread over the share `depth` of the thickness.
    pub(super) fn new([a, b]: [Form; 2], area: f64, thickness: f64, depth: f64) -> Self {
        let det_a = det(a);
        let third = third_form(a, b, det_a);
        let layers = GAUSS.map(|(abscissa, weight)| {
            let z = 0.5 * depth * thickness * abscissa;
            let volume = 0.5 * thickness * weight * area * shifter(z, a, b, det_a);
            Layer { z, volume, metric: Metric::new(layer_metric(a, b, third, z)) }
        });
        Self { mid: Metric::new(a), layers }
    }

    /// The wall's volume at rest, mm^3.
    pub(super) fn volume(&self) -> f64 {
        self.layers.iter().map(|layer| layer.volume).sum()
    }

    /// The stored energy, mJ.
    ///
    /// # Errors
    /// [`Inadmissible`] where a fold is tighter than half the wall.
    pub(super) fn energy(
        &self,
        [a, b]: [Form; 2],
        material: &Material,
    ) -> Result<f64, Inadmissible> {
        let det_a = det(a);
        let (t, j) = self.mid.invariants(a);
        let l3 = material.thickness_stretch(t, j).value;
        let third = third_form(a, b, det_a);
        let mut energy = 0.0;
        for layer in &self.layers {
            let z = layer.z * l3;
            check_shifter(z, a, b, det_a)?;
            let (t, j) = layer.metric.invariants(layer_metric(a, b, third, z));
            energy += layer.volume * material.energy(t, j);
        }
        Ok(energy)
    }

    /// The stored energy (mJ) with its derivatives with respect to `(a11, a22, a12, b11, b22, b12)`.
    ///
    /// # Errors
    /// [`Inadmissible`] where a fold is tighter than half the wall.
    #[expect(clippy::needless_range_loop, reason = "indices of tensors")]
    pub(super) fn derivatives(
        &self,
        [a, b]: [Form; 2],
        material: &Material,
    ) -> Result<Jet, Inadmissible> {
        let det_a = det(a);
        let (l3, [p, q]) = self.thickness_scaled_forms(a, b, material);
        let mut energy = Jet::variable(0, 0.0);
        energy.gradient = [0.0; VARIABLES];
        // How much the second derivatives of P = l3 b and Q = l3^2 b a^-1 b count, summed over the layers.
        let mut p_weight = [0.0; 3];
        let mut q_weight = [0.0; 3];
        for layer in &self.layers {
            let z = layer.z;
            check_shifter(z * l3, a, b, det_a)?;
            let g = std::array::from_fn(|k| a[k] - 2.0 * z * p[k].value + z * z * q[k].value);
            let (t, j) = layer.metric.invariants(g);
            let density = material.density(t, j);
            let [psi_t, psi_j] = density.first;
            let [psi_tt, psi_tj, psi_jj] = density.second;
            let dt = layer.metric.inverse;
            let dj = [g[1], g[0], -2.0 * g[2]].map(|v| v * layer.metric.inverse_det);
            let first: Form =
                std::array::from_fn(|k| layer.volume * (psi_t * dt[k] + psi_j * dj[k]));
            let mut second: [[f64; 3]; 3] = std::array::from_fn(|k| {
                let on_t = layer.volume * (psi_tt * dt[k] + psi_tj * dj[k]);
                let on_j = layer.volume * (psi_tj * dt[k] + psi_jj * dj[k]);
                std::array::from_fn(|l| on_t * dt[l] + on_j * dj[l])
            });
            let curvature_of_j = layer.volume * psi_j * layer.metric.inverse_det;
            second[0][1] += curvature_of_j;
            second[1][0] += curvature_of_j;
            second[2][2] -= 2.0 * curvature_of_j;

            let dg: [[f64; VARIABLES]; 3] = std::array::from_fn(|k| {
                let mut row: [f64; VARIABLES] =
                    std::array::from_fn(|i| -2.0 * z * p[k].gradient[i] + z * z * q[k].gradient[i]);
                row[k] += 1.0;
                row
            });
            energy.value += layer.volume * density.value;
            for k in 0..3 {
                for (sum, dg) in energy.gradient.iter_mut().zip(&dg[k]) {
                    *sum += first[k] * dg;
                }
                p_weight[k] -= 2.0 * z * first[k];
                q_weight[k] += z * z * first[k];
            }
            let weighted: [[f64; VARIABLES]; 3] = std::array::from_fn(|k| {
                std::array::from_fn(|i| (0..3).map(|l| second[k][l] * dg[l][i]).sum())
            });
            let mut pair = 0;
            for i in 0..VARIABLES {
                for j in 0..=i {
                    energy.hessian[pair] += dg[0][i] * weighted[0][j]
                        + dg[1][i] * weighted[1][j]
                        + dg[2][i] * weighted[2][j];
                    pair += 1;
                }
            }
        }
        for k in 0..3 {
            for (sum, (p, q)) in
                energy.hessian.iter_mut().zip(p[k].hessian.iter().zip(&q[k].hessian))
            {
                *sum += p_weight[k] * p + q_weight[k] * q;
            }
        }
        Ok(energy)
    }

    /// The thickness stretch, and `P = l3 b`, `Q = l3^2 b a^-1 b` as jets in the six form components.
    fn thickness_scaled_forms(
        &self,
        a: Form,
        b: Form,
        material: &Material,
    ) -> (f64, [[Jet; 3]; 2]) {
        let [a11, a22, a12]: [Jet; 3] = std::array::from_fn(|k| Jet::variable(k, a[k]));
        let [b11, b22, b12]: [Jet; 3] = std::array::from_fn(|k| Jet::variable(3 + k, b[k]));
        let det_a = &(&a11 * &a22) - &(&a12 * &a12);
        let l3 = {
            let [g11, g22, g12] = self.mid.inverse;
            let t = &(&a11.scale(g11) + &a22.scale(g22)) + &a12.scale(g12);
            let j = det_a.scale(self.mid.inverse_det);
            let stretch = material.thickness_stretch(t.value, j.value);
            t.chain_with(&j, stretch.value, stretch.first, stretch.second)
        };
        // b adj(a) b / det a.
        let m11 = &(&a22 * &b11) - &(&a12 * &b12);
        let m12 = &(&a22 * &b12) - &(&a12 * &b22);
        let m21 = &(&a11 * &b12) - &(&a12 * &b11);
        let m22 = &(&a11 * &b22) - &(&a12 * &b12);
        let third = [
            &(&b11 * &m11) + &(&b12 * &m21),
            &(&b12 * &m12) + &(&b22 * &m22),
            &(&b11 * &m12) + &(&b12 * &m22),
        ];
        let factor = &(&l3 * &l3) * &det_a.powf(-1.0);
        let scaled = [&l3 * &b11, &l3 * &b22, &l3 * &b12];
        (l3.value, [scaled, third.map(|form| &factor * &form)])
    }
}

impl Metric {
    fn new(g: Form) -> Self {
        let inverse_det = 1.0 / det(g);
        Self { inverse: [g[1], g[0], -2.0 * g[2]].map(|v| v * inverse_det), inverse_det }
    }

    /// `T = tr(G^-1 g)` and `J = det g / det G`.
    fn invariants(&self, g: Form) -> (f64, f64) {
        let t = (0..3).map(|k| self.inverse[k] * g[k]).sum();
        (t, det(g) * self.inverse_det)
    }
}

/// The smallest area of a layer over that of the mid-surface with forms `a`, `b`: 1 where it is flat, 0 or less
/// where it folds tighter than half the wall.
pub(super) fn least_shifter([a, b]: [Form; 2], thickness: f64) -> f64 {
    let of_layer = |(abscissa, _): &(f64, f64)| shifter(0.5 * thickness * abscissa, a, b, det(a));
    GAUSS.iter().map(of_layer).fold(1.0, f64::min)
}

/// The share of the wall's thickness over which the layers may spread without the innermost folding too tightly.
pub(super) fn bending_depth(forms: [Form; 2], thickness: f64) -> f64 {
    const SHRINK: f64 = 0.9;
    let mut depth = 1.0;
    while depth > 1e-6 && least_shifter(forms, depth * thickness) < TIGHTEST_FOLD {
        depth *= SHRINK;
    }
    depth
}

fn layer_metric(a: Form, b: Form, third: Form, z: f64) -> Form {
    std::array::from_fn(|k| a[k] - 2.0 * z * b[k] + z * z * third[k])
}

fn check_shifter(z: f64, a: Form, b: Form, det_a: f64) -> Result<(), Inadmissible> {
    if shifter(z, a, b, det_a) > 0.0 {
        Ok(())
    } else {
        Err(Inadmissible("a fold is tighter than half the wall"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::material::NeoHookean;

    /// A flat wall bent to the curvature `k` at constant length stores `D k^2 / 2` with `D = 4 mu t^3 / 12`.
    #[test]
    fn bending_stiffness_is_that_of_a_plate() {
        let (mu, thickness) = (1.3, 0.7);
        let material = Material::NeoHookean(NeoHookean { mu });
        let metric = [1.0, 1.0, 0.0];
        let point = WallPoint::new([metric, [0.0; 3]], 1.0, thickness, 1.0);
        for bend in [1e-2, 1e-3] {
            let k = bend / thickness;
            for form in [[k, 0.0, 0.0], [0.0, -k, 0.0]] {
                let exact = mu * thickness.powi(3) * k * k / 6.0;
                let energy = point.derivatives([metric, form], &material).unwrap().value;
                // Of second order in the bend; rounding is relative to mu t.
                let tolerance = bend * bend + 1e-15 * mu * thickness / exact;
                assert!((energy / exact - 1.0).abs() < tolerance, "{energy} {exact}");
            }
        }
    }
}
