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
use crate::math::{Reason, Rejected, Room};
use crate::model::material::{Material, OfInvariants};
use crate::model::system::Inadmissible;

/// Abscissae and weights of the three-point Gauss rule on [-1, 1]; 0.6f64.sqrt() to the last digit.
const GAUSS: [(f64, f64); 3] =
    [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];

/// The least area of a layer at rest, as a share of the mid-surface's.
pub(super) const TIGHTEST_FOLD: f64 = 0.25;

/// The largest share of the wall that may be creased.
const MOST_CREASED: f64 = 0.1;

/// How much of a wall folds tighter than its thickness allows.
#[derive(Default)]
pub(super) struct Creases {
    whole: f64,
    creased: f64,
}

impl Creases {
    /// Counts a point's area (mm^2), whose layers spread over the share `depth` of the thickness.
    pub(super) fn add(&mut self, area: f64, depth: f64) {
        self.whole += area;
        self.creased += if depth < 1.0 { area } else { 0.0 };
    }

    /// The creased share of the wall.
    ///
    /// # Errors
    /// [`Rejected`] when it is more than a tenth.
    pub(super) fn share(&self) -> Result<f64, Rejected> {
        let share = self.creased / self.whole;
        if share <= MOST_CREASED {
            return Ok(share);
        }
        Err(Rejected::new(
            Room::Model,
            Reason::FoldsTighterThanWall,
            format!(
                "{:.1} % of the wall folds tighter than its thickness allows, more than {:.0} %",
                100.0 * share,
                100.0 * MOST_CREASED
            ),
            share - MOST_CREASED,
        ))
    }
}

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

    /// The stored energy (mJ) with its derivatives with respect to `(a11, a22, a12, b11, b22, b12)`; the Hessian only
    /// `with_hessian`, else zero.
    ///
    /// ```text
    /// g = a - 2 zl b + (zl)^2 c      l(a) = thickness stretch      c(a, b) = b a^-1 b
    /// m = a^-1 b       dc = db m + m^T db - m^T da m       ddc = 2 e^T a^-1 e,   e = db - da m
    /// ```
    ///
    /// # Errors
    /// [`Inadmissible`] where a fold is tighter than half the wall.
    #[inline(always)]
    pub(super) fn derivatives(
        &self,
        [a, b]: [Form; 2],
        material: &Material,
        with_hessian: bool,
    ) -> Result<Jet, Inadmissible> {
        let det_a = det(a);
        let (t, j) = self.mid.invariants(a);
        let stretch = material.thickness_stretch(t, j);
        let (dl, ddl) = self.mid.chain(a, &stretch);
        let third = ThirdForm::new(a, b, det_a);
        let c = third.value;

        let mut value = 0.0;
        let mut gradient = [0.0; VARIABLES];
        let mut hessian = [[0.0; VARIABLES]; VARIABLES];
        // Sums of z dW/dg and z^2 dW/dg, which weigh the second derivatives of g.
        let (mut first_moment, mut second_moment) = ([0.0; 3], [0.0; 3]);
        for layer in &self.layers {
            let z = layer.z * stretch.value;
            check_shifter(z, a, b, det_a)?;
            let g = layer_metric(a, b, c, z);
            let (t, j) = layer.metric.invariants(g);
            let density = material.density(t, j);
            let (stress, stiffness) = layer.metric.chain(g, &density);
            value += layer.volume * density.value;
            let dg: [[f64; VARIABLES]; 3] = std::array::from_fn(|k| {
                let by_stretch = layer.z * 2.0 * (z * c[k] - b[k]);
                let mut row: [f64; VARIABLES] = std::array::from_fn(|i| z * z * third.first[k][i]);
                for (row, dl) in row.iter_mut().zip(dl) {
                    *row += by_stretch * dl;
                }
                row[k] += 1.0;
                row[3 + k] -= 2.0 * z;
                row
            });
            let stress = stress.map(|s| layer.volume * s);
            for (i, sum) in gradient.iter_mut().enumerate() {
                *sum += stress[0] * dg[0][i] + stress[1] * dg[1][i] + stress[2] * dg[2][i];
            }
            if !with_hessian {
                continue;
            }
            let weighted: [[f64; VARIABLES]; 3] = std::array::from_fn(|k| {
                let [d0, d1, d2] = stiffness[k].map(|d| layer.volume * d);
                std::array::from_fn(|i| d0 * dg[0][i] + d1 * dg[1][i] + d2 * dg[2][i])
            });
            for i in 0..VARIABLES {
                for j in 0..VARIABLES {
                    hessian[i][j] += dg[0][i] * weighted[0][j]
                        + dg[1][i] * weighted[1][j]
                        + dg[2][i] * weighted[2][j];
                }
            }
            for k in 0..3 {
                first_moment[k] += layer.z * stress[k];
                second_moment[k] += layer.z * layer.z * stress[k];
            }
        }

        if !with_hessian {
            return Ok(Jet::new(value, gradient, &hessian));
        }
        let by_c = second_moment.map(|s| stretch.value * stretch.value * s);
        third.add_second(by_c, &mut hessian);
        // By the stretch: once, twice, and once with b and c.
        let twice = 2.0 * dot(second_moment, c);
        let once = stretch.value * twice - 2.0 * dot(first_moment, b);
        let by_stretch: [f64; VARIABLES] = std::array::from_fn(|i| {
            let column = third.first.map(|row| row[i]);
            let own = if i < 3 { 0.5 * twice * dl[i] } else { -2.0 * first_moment[i - 3] };
            own + 2.0 * stretch.value * dot(second_moment, column)
        });
        for i in 0..3 {
            for j in 0..VARIABLES {
                hessian[i][j] += dl[i] * by_stretch[j];
                hessian[j][i] += dl[i] * by_stretch[j];
            }
            for j in 0..3 {
                hessian[i][j] += once * ddl[i][j];
            }
        }
        Ok(Jet::new(value, gradient, &hessian))
    }
}

/// `c = b a^-1 b` with its derivatives by `(a, b)`.
struct ThirdForm {
    value: Form,
    first: [[f64; VARIABLES]; 3],
    /// `a^-1`.
    inverse: [[f64; 2]; 2],
    /// `m = a^-1 b`.
    mixed: [[f64; 2]; 2],
}

impl ThirdForm {
    #[inline(always)]
    fn new(a: Form, b: Form, det_a: f64) -> Self {
        let off = -a[2] / det_a;
        let inverse = [[a[1] / det_a, off], [off, a[0] / det_a]];
        let mixed = product(&inverse, &[[b[0], b[2]], [b[2], b[1]]]);
        let [[m11, m12], [m21, m22]] = mixed;
        let first = [
            [-m11 * m11, -m21 * m21, -2.0 * m11 * m21, 2.0 * m11, 0.0, 2.0 * m21],
            [-m12 * m12, -m22 * m22, -2.0 * m12 * m22, 0.0, 2.0 * m22, 2.0 * m12],
            [-m11 * m12, -m21 * m22, -m11 * m22 - m12 * m21, m12, m21, m11 + m22],
        ];
        Self { value: third_form(a, b, det_a), first, inverse, mixed }
    }

    /// Adds the second derivatives of `weights . c` to `hessian`: `2 tr(W e^T a^-1 e)`.
    #[inline(always)]
    fn add_second(&self, weights: Form, hessian: &mut [[f64; VARIABLES]; VARIABLES]) {
        let [m1, m2] = self.mixed;
        // e = db - da m by each variable.
        let e: [[[f64; 2]; 2]; VARIABLES] = [
            [m1.map(|m| -m), [0.0; 2]],
            [[0.0; 2], m2.map(|m| -m)],
            [m2.map(|m| -m), m1.map(|m| -m)],
            [[1.0, 0.0], [0.0, 0.0]],
            [[0.0, 0.0], [0.0, 1.0]],
            [[0.0, 1.0], [1.0, 0.0]],
        ];
        let [w1, w2, w12] = weights;
        let twice = [[2.0 * w1, w12], [w12, 2.0 * w2]];
        for (row, one) in hessian.iter_mut().zip(&e) {
            let [[p11, p12], [p21, p22]] = product(&product(&self.inverse, one), &twice);
            for (entry, other) in row.iter_mut().zip(&e) {
                *entry +=
                    p11 * other[0][0] + p12 * other[0][1] + p21 * other[1][0] + p22 * other[1][1];
            }
        }
    }
}

#[inline(always)]
fn product(a: &[[f64; 2]; 2], b: &[[f64; 2]; 2]) -> [[f64; 2]; 2] {
    a.map(|[one, two]| [0, 1].map(|j| one * b[0][j] + two * b[1][j]))
}

#[inline(always)]
fn dot(a: Form, b: Form) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl Metric {
    fn new(g: Form) -> Self {
        let inverse_det = 1.0 / det(g);
        Self { inverse: [g[1], g[0], -2.0 * g[2]].map(|v| v * inverse_det), inverse_det }
    }

    /// `T = tr(G^-1 g)` and `J = det g / det G`.
    #[inline(always)]
    fn invariants(&self, g: Form) -> (f64, f64) {
        let t = (0..3).map(|k| self.inverse[k] * g[k]).sum();
        (t, det(g) * self.inverse_det)
    }

    /// First and second derivatives by `g` of a function of the invariants.
    #[inline(always)]
    fn chain(&self, g: Form, f: &OfInvariants) -> (Form, [Form; 3]) {
        let dt = self.inverse;
        let dj = [g[1], g[0], -2.0 * g[2]].map(|v| v * self.inverse_det);
        let [f_t, f_j] = f.first;
        let [f_tt, f_tj, f_jj] = f.second;
        let first = std::array::from_fn(|k| f_t * dt[k] + f_j * dj[k]);
        let mut second: [Form; 3] = std::array::from_fn(|k| {
            let on_t = f_tt * dt[k] + f_tj * dj[k];
            let on_j = f_tj * dt[k] + f_jj * dj[k];
            std::array::from_fn(|l| on_t * dt[l] + on_j * dj[l])
        });
        let curvature_of_j = f_j * self.inverse_det;
        second[0][1] += curvature_of_j;
        second[1][0] += curvature_of_j;
        second[2][2] -= 2.0 * curvature_of_j;
        (first, second)
    }
}

/// The smallest area of a layer over that of the mid-surface with forms `a`, `b`: 1 where it is flat, 0 or less
/// where it folds tighter than half the wall.
pub(super) fn least_shifter([a, b]: [Form; 2], thickness: f64) -> f64 {
    let of_layer = |(abscissa, _): &(f64, f64)| unfolded(0.5 * thickness * abscissa, a, b, det(a));
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

#[inline(always)]
fn layer_metric(a: Form, b: Form, third: Form, z: f64) -> Form {
    std::array::from_fn(|k| a[k] - 2.0 * z * b[k] + z * z * third[k])
}

/// [`shifter`], negative also where the layer is turned inside out along both directions: `1 - z k1` and `1 - z k2` are.
#[inline(always)]
fn unfolded(z: f64, a: Form, b: Form, det_a: f64) -> f64 {
    let area = shifter(z, a, b, det_a);
    // Both factors are positive only where their mean is.
    let mean = 0.5 * (1.0 + area - z * z * det(b) / det_a);
    if mean > 0.0 { area } else { -area.abs() }
}

#[inline(always)]
fn check_shifter(z: f64, a: Form, b: Form, det_a: f64) -> Result<(), Inadmissible> {
    if unfolded(z, a, b, det_a) > 0.0 {
        Ok(())
    } else {
        Err(Inadmissible("a fold is tighter than half the wall"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::material::{Compressible, NeoHookean, Ogden};
    use crate::model::test_shells::difference;

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
                let energy = point.derivatives([metric, form], &material, true).unwrap().value;
                // Of second order in the bend; rounding is relative to mu t.
                let tolerance = bend * bend + 1e-15 * mu * thickness / exact;
                assert!((energy / exact - 1.0).abs() < tolerance, "{energy} {exact}");
            }
        }
    }

    /// Differences of the energy and of the gradient by the six form components, strongly bent and stretched.
    #[test]
    fn derivatives_equal_differences() {
        let forms = [[1.0, 1.3, 0.2], [0.3, -0.2, 0.15]];
        let point = WallPoint::new(forms, 2.0, 0.7, 1.0);
        let state = [1.4, 1.6, -0.3, -0.35, 0.5, 0.25];
        let at = |state: [f64; VARIABLES]| {
            [[state[0], state[1], state[2]], [state[3], state[4], state[5]]]
        };
        for material in [
            Material::NeoHookean(NeoHookean { mu: 1.3 }),
            Material::Ogden(Ogden::ninjaflex_c2s()),
            Material::Compressible(Compressible::ninjaflex_c2s()),
        ] {
            let jet = point.derivatives(at(state), &material, true).unwrap();
            let energy = point.energy(at(state), &material).unwrap();
            assert!((jet.value / energy - 1.0).abs() < 1e-14, "{} {energy}", jet.value);
            let first_only = point.derivatives(at(state), &material, false).unwrap();
            assert_eq!((first_only.value, first_only.gradient), (jet.value, jet.gradient));
            let scale = jet.hessian.iter().fold(0.0_f64, |most, h| most.max(h.abs()));
            // Of fourth order: (step / 1)^4, and rounding over the step.
            let step = 1e-3;
            for i in 0..VARIABLES {
                let moved = |h: f64| {
                    let mut state = state;
                    state[i] += h;
                    at(state)
                };
                let slope = difference(step, |h| point.energy(moved(h), &material).unwrap());
                assert!((slope - jet.gradient[i]).abs() < 1e-10 * scale, "{i}: {slope}");
                for j in 0..=i {
                    let of_gradient =
                        |h| point.derivatives(moved(h), &material, false).unwrap().gradient[j];
                    let slope = difference(step, of_gradient);
                    let exact = jet.hessian[i * (i + 1) / 2 + j];
                    assert!((slope - exact).abs() < 1e-10 * scale, "{i} {j}: {slope} {exact}");
                }
            }
        }
    }
}
