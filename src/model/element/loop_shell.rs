//! The Kirchhoff-Love shell on Loop's subdivision surface, at large strain and in plane stress.
//!
//! At a quadrature point the control points `x_I` enter through five linear combinations,
//! `d = (a1, a2, x11, x22, x12)`, hence through two fundamental forms `a_ab` and `b_ab = x_ab . n`.
//! A layer at height `z` of the wall has the metric
//!
//! ```text
//! G(z) = A - 2 z B + z^2 B A^-1 B                 at rest
//! g(z) = a - 2 z l3 b + (z l3)^2 b a^-1 b         deformed; l3 = sqrt(det A / det a), the thickness stretch
//! W    = sum_points dA sum_layers w_z sqrt(det G / det A) psi(G(z), g(z))
//! ```
//!
//! The factor `l3` makes a stretched wall thinner in bending too. One barycentre for each triangle, three
//! Gauss points through the wall; the area `dA` is the limit surface's own, so that meshes of any valence
//! have their true area.
//!
//! Where a fold at rest is tighter than the wall allows (a crease, a sliver across a rim), the layers of the element
//! are drawn together until the innermost keeps [`TIGHTEST_FOLD`] of its area: its membrane stays whole, its
//! bending softens. [`LoopShell::creased_share`] says how much of the wall that is. True creases have no place
//! in this element: round them to a radius of the thickness or more.
//!
//! Source: Cirak & Ortiz (2001), finite-deformation thin shells by subdivision.

use std::rc::Rc;

use nalgebra::Matrix3;

use super::jet::{Jet, VARIABLES};
use super::kinematics::{Derivatives, Form, det, shifter, third_form};
use super::loop_patch::{LoopBasis, ascending};
use crate::math::{Rejected, Room, Vec3};
use crate::mesh::ShellMesh;
use crate::model::local::{LocalDerivatives, Term};
use crate::model::material::Material;
use crate::model::system::Inadmissible;

/// Abscissae and weights of the three-point Gauss rule on [-1, 1]; 0.6f64.sqrt() to the last digit.
const GAUSS: [(f64, f64); 3] =
    [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];

/// The least area of a layer at rest, as a share of the mid-surface's.
pub(super) const TIGHTEST_FOLD: f64 = 0.25;
/// The largest share of the wall that may be creased.
const MOST_CREASED: f64 = 0.1;

/// The stored energy of the wall.
#[derive(Clone, Debug)]
pub struct LoopShell {
    stencils: Vec<Vec<u32>>,
    points: Vec<Point>,
    /// `[,1 ,2 ,11 ,22 ,12]` of each node of each stencil at its barycentre.
    basis: Vec<Vec<[f64; 5]>>,
    material: Material,
    creased_share: f64,
}

/// A quadrature point's reference state.
#[derive(Clone, Debug)]
struct Point {
    sqrt_det_a: f64,
    layers: [Layer; 3],
}

/// A layer of the wall at rest.
#[derive(Clone, Copy, Debug)]
struct Layer {
    z: f64,
    /// Reference volume, mm^3.
    volume: f64,
    /// `(G^11, G^22, 2 G^12)`, so that `T` is a dot product with `(g11, g22, g12)`.
    inverse_metric: [f64; 3],
    inverse_det: f64,
}

impl LoopShell {
    /// The wall of `mesh` with control points at `x` at rest.
    ///
    /// # Errors
    /// [`Rejected`] when more than a tenth of the wall folds at rest more tightly than its thickness allows.
    pub fn new(
        mesh: &ShellMesh,
        bases: &[Rc<LoopBasis>],
        x: &[Vec3],
        material: Material,
    ) -> Result<Self, Rejected> {
        let mut shell = Self {
            stencils: Vec::with_capacity(bases.len()),
            points: Vec::with_capacity(bases.len()),
            basis: Vec::with_capacity(bases.len()),
            material,
            creased_share: 0.0,
        };
        let (mut whole_area, mut creased_area) = (0.0, 0.0);
        for (stencil, basis) in mesh.stencils.iter().zip(bases) {
            let positions: Vec<Vec3> = stencil.nodes.iter().map(|&v| x[v as usize]).collect();
            let area = basis.area(&positions);
            let depth = bending_depth(&basis.barycentre, &positions, mesh.thickness);
            let point = Point::new(&basis.barycentre, &positions, mesh.thickness, depth, area);
            shell.points.push(point.map_err(|Inadmissible(what)| {
                Rejected::new(Room::Model, "degenerate_element", what.to_owned(), 1.0)
            })?);
            whole_area += area;
            creased_area += if depth < 1.0 { area } else { 0.0 };
            let (nodes, weights) = ascending(&stencil.nodes, &basis.barycentre);
            shell.stencils.push(nodes);
            shell.basis.push(weights);
        }
        shell.creased_share = creased_area / whole_area;
        if shell.creased_share <= MOST_CREASED {
            return Ok(shell);
        }
        Err(Rejected::new(
            Room::Model,
            "folds_tighter_than_wall",
            format!(
                "{:.1} % of the wall folds tighter than its thickness allows, more than {:.0} %",
                100.0 * shell.creased_share,
                100.0 * MOST_CREASED
            ),
            shell.creased_share - MOST_CREASED,
        ))
    }

    /// The share of the wall whose bending is softened because it folds tighter than its thickness allows.
    #[must_use]
    pub fn creased_share(&self) -> f64 {
        self.creased_share
    }

    /// The wall's volume at rest, mm^3.
    #[must_use]
    pub fn volume(&self) -> f64 {
        self.points.iter().flat_map(|p| &p.layers).map(|layer| layer.volume).sum()
    }
}

/// The smallest area of a layer over that of the mid-surface, at a point of a wall at rest: 1 where it is flat,
/// 0 or less where it folds tighter than half the wall.
pub(super) fn least_shifter(basis: &[[f64; 5]], x: &[Vec3], thickness: f64) -> f64 {
    let Ok((a, b)) = Derivatives::new(basis, x).forms() else {
        return 0.0;
    };
    let of_layer = |(abscissa, _): &(f64, f64)| shifter(0.5 * thickness * abscissa, a, b, det(a));
    GAUSS.iter().map(of_layer).fold(1.0, f64::min)
}

/// The share of the wall's thickness over which the layers may spread without the innermost folding too tightly.
fn bending_depth(basis: &[[f64; 5]], x: &[Vec3], thickness: f64) -> f64 {
    const SHRINK: f64 = 0.9;
    let mut depth = 1.0;
    while depth > 1e-6 && least_shifter(basis, x, depth * thickness) < TIGHTEST_FOLD {
        depth *= SHRINK;
    }
    depth
}

impl Term for LoopShell {
    fn stencils(&self) -> &[Vec<u32>] {
        &self.stencils
    }

    fn energy(&self, s: usize, x: &[Vec3]) -> Result<f64, Inadmissible> {
        let point = &self.points[s];
        let (a, b) = Derivatives::new(&self.basis[s], x).forms()?;
        let det_a = det(a);
        let l3 = point.sqrt_det_a / det_a.sqrt();
        let third = third_form(a, b, det_a);
        let mut energy = 0.0;
        for layer in &point.layers {
            let z = layer.z * l3;
            check_shifter(z, a, b, det_a)?;
            let g = std::array::from_fn(|k| a[k] - 2.0 * z * b[k] + z * z * third[k]);
            let (t, j) = layer.invariants(g);
            energy += layer.volume * self.material.energy(t, j);
        }
        Ok(energy)
    }

    fn derivatives(
        &self,
        s: usize,
        x: &[Vec3],
        local: &mut LocalDerivatives,
    ) -> Result<f64, Inadmissible> {
        let basis = &self.basis[s];
        let derivatives = Derivatives::new(basis, x);
        let (a, b) = derivatives.forms()?;
        let of_forms = self.points[s].energy_of_forms(a, b, &self.material)?;
        let h = derivatives.gradient(&of_forms.gradient);
        for (gradient, row) in local.gradient_mut().iter_mut().zip(basis) {
            for (h, weight) in h.iter().zip(row) {
                *gradient += *weight * h;
            }
        }
        if local.with_hessian() {
            let hessian = derivatives.hessian(&of_forms);
            scatter(&hessian, basis, local);
        }
        Ok(of_forms.value)
    }
}

/// `K_IJ += sum_st B_sI B_tJ H_st` for the lower blocks.
fn scatter(hessian: &[[Matrix3<f64>; 5]; 5], basis: &[[f64; 5]], local: &mut LocalDerivatives) {
    for (j, column) in basis.iter().enumerate() {
        let half: [Matrix3<f64>; 5] = std::array::from_fn(|s| {
            let h = &hessian[s];
            h[0] * column[0]
                + h[1] * column[1]
                + h[2] * column[2]
                + h[3] * column[3]
                + h[4] * column[4]
        });
        for (i, row) in basis.iter().enumerate().skip(j) {
            *local.block_mut(i, j) += half[0] * row[0]
                + half[1] * row[1]
                + half[2] * row[2]
                + half[3] * row[3]
                + half[4] * row[4];
        }
    }
}

impl Point {
    /// The reference state, its layers spread over `depth` of the thickness.
    fn new(
        basis: &[[f64; 5]],
        x: &[Vec3],
        thickness: f64,
        depth: f64,
        area: f64,
    ) -> Result<Self, Inadmissible> {
        let (a, b) = Derivatives::new(basis, x).forms()?;
        let det_a = det(a);
        let third = third_form(a, b, det_a);
        let layers = GAUSS.map(|(abscissa, weight)| {
            let z = 0.5 * depth * thickness * abscissa;
            let g: Form = std::array::from_fn(|k| a[k] - 2.0 * z * b[k] + z * z * third[k]);
            let inverse_det = 1.0 / det(g);
            Layer {
                z,
                volume: 0.5 * thickness * weight * area * shifter(z, a, b, det_a),
                inverse_metric: [g[1] * inverse_det, g[0] * inverse_det, -2.0 * g[2] * inverse_det],
                inverse_det,
            }
        });
        Ok(Self { sqrt_det_a: det_a.sqrt(), layers })
    }

    /// The point's energy with its derivatives with respect to `(a11, a22, a12, b11, b22, b12)`.
    #[expect(clippy::needless_range_loop, reason = "indices of tensors")]
    fn energy_of_forms(&self, a: Form, b: Form, material: &Material) -> Result<Jet, Inadmissible> {
        let det_a = det(a);
        let l3 = self.sqrt_det_a / det_a.sqrt();
        let (p, q) = self.thickness_scaled_forms(a, b);
        let mut energy = Jet::variable(0, 0.0);
        energy.gradient = [0.0; VARIABLES];
        // How much the second derivatives of P = l3 b and Q = l3^2 b a^-1 b count, summed over the layers.
        let mut p_weight = [0.0; 3];
        let mut q_weight = [0.0; 3];
        for layer in &self.layers {
            let z = layer.z;
            check_shifter(z * l3, a, b, det_a)?;
            let g = std::array::from_fn(|k| a[k] - 2.0 * z * p[k].value + z * z * q[k].value);
            let (t, j) = layer.invariants(g);
            let density = material.density(t, j);
            let [psi_t, psi_j] = density.first;
            let [psi_tt, psi_tj, psi_jj] = density.second;
            let dt = layer.inverse_metric;
            let dj = [g[1], g[0], -2.0 * g[2]].map(|v| v * layer.inverse_det);
            let first: Form =
                std::array::from_fn(|k| layer.volume * (psi_t * dt[k] + psi_j * dj[k]));
            let mut second: [[f64; 3]; 3] = std::array::from_fn(|k| {
                let on_t = layer.volume * (psi_tt * dt[k] + psi_tj * dj[k]);
                let on_j = layer.volume * (psi_tj * dt[k] + psi_jj * dj[k]);
                std::array::from_fn(|l| on_t * dt[l] + on_j * dj[l])
            });
            let curvature_of_j = layer.volume * psi_j * layer.inverse_det;
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

    /// `P = l3 b` and `Q = l3^2 b a^-1 b` as jets in the six form components.
    fn thickness_scaled_forms(&self, a: Form, b: Form) -> ([Jet; 3], [Jet; 3]) {
        let [a11, a22, a12]: [Jet; 3] = std::array::from_fn(|k| Jet::variable(k, a[k]));
        let [b11, b22, b12]: [Jet; 3] = std::array::from_fn(|k| Jet::variable(3 + k, b[k]));
        let det_a = &(&a11 * &a22) - &(&a12 * &a12);
        let l3 = det_a.powf(-0.5).scale(self.sqrt_det_a);
        let p = [&l3 * &b11, &l3 * &b22, &l3 * &b12];
        // b adj(a) b / det a, and l3^2 / det a = l3^4 / det A.
        let m11 = &(&a22 * &b11) - &(&a12 * &b12);
        let m12 = &(&a22 * &b12) - &(&a12 * &b22);
        let m21 = &(&a11 * &b12) - &(&a12 * &b11);
        let m22 = &(&a11 * &b22) - &(&a12 * &b12);
        let factor = det_a.powf(-2.0).scale(self.sqrt_det_a * self.sqrt_det_a);
        let third = [
            &(&b11 * &m11) + &(&b12 * &m21),
            &(&b12 * &m12) + &(&b22 * &m22),
            &(&b11 * &m12) + &(&b12 * &m22),
        ];
        (p, third.map(|form| &factor * &form))
    }
}

impl Layer {
    /// `T = tr(G^-1 g)` and `J = det g / det G`.
    fn invariants(&self, g: Form) -> (f64, f64) {
        let t = (0..3).map(|k| self.inverse_metric[k] * g[k]).sum();
        (t, det(g) * self.inverse_det)
    }
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
    use nalgebra::{Isometry3, Matrix2, UnitQuaternion};
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::model::element::loop_patch::regular_lattice;
    use crate::model::material::{NeoHookean, Ogden};
    use crate::model::term_suite::{Case, term_suite};
    use crate::model::test_shells::TestShell;

    const NEO_HOOKEAN: Material = Material::NeoHookean(NeoHookean { mu: 1.3 });

    fn wall(shell: &TestShell, material: Material) -> Case<LoopShell> {
        let term = LoopShell::new(&shell.mesh, &shell.bases, &shell.reference, material).unwrap();
        assert_eq!(term.creased_share(), 0.0);
        let motion = Isometry3::new(Vec3::new(3.0, -5.0, 2.0), Vec3::new(0.4, 1.9, -0.7));
        Case { term, positions: shell.deformed.clone(), motion }
    }

    term_suite!(neo_hookean, |shell| wall(shell, NEO_HOOKEAN));
    term_suite!(ogden, |shell| wall(shell, Material::Ogden(Ogden::ninjaflex_c2s())));

    /// Control points anywhere in a plane, stretched alike: `W = psi t A` for any valences (the patch test).
    #[test]
    fn membrane_patch_has_the_exact_energy() {
        let mut chance = ChaCha8Rng::seed_from_u64(3);
        let (mu, thickness) = (1.3, 0.7);
        for valences in [[6, 6, 6], [5, 6, 7], [4, 8, 5], [3, 9, 4]] {
            let basis = LoopBasis::new(valences);
            let angle = |k: usize| 2.4 * k as f64;
            let flat: Vec<Vec3> = (0..basis.barycentre.len())
                .map(|k| Vec3::new(angle(k).cos(), angle(k).sin(), 0.0) * (k as f64 + 1.0).sqrt())
                .map(|x| x + 0.1 * Vec3::new(chance.random(), chance.random(), 0.0))
                .collect();
            let area = basis.area(&flat);
            let rows = &basis.barycentre;
            let point = Point::new(rows, &flat, thickness, 1.0, area).unwrap();
            let shell = LoopShell {
                stencils: vec![(0..flat.len() as u32).collect()],
                points: vec![point],
                basis: vec![rows.clone()],
                material: NEO_HOOKEAN,
                creased_share: 0.0,
            };
            for stretch in [Matrix2::new(1.0, 0.0, 0.0, 1.0), Matrix2::new(1.5, 0.3, -0.2, 0.8)] {
                let turn = UnitQuaternion::from_scaled_axis(Vec3::new(0.3, -1.0, 0.5));
                let stretched: Vec<Vec3> =
                    flat.iter().map(|x| turn * (stretch * x.xy()).push(0.0)).collect();
                let (trace, det) = (stretch.norm_squared(), stretch.determinant());
                let exact = mu / 2.0 * (trace + det.powi(-2) - 3.0) * thickness * area;
                let energy = shell.energy(0, &stretched).unwrap();
                assert!((energy - exact).abs() < 1e-13 * mu * thickness * area, "{energy} {exact}");
            }
        }
    }

    /// A flat wall bent to the curvature `k` at constant length stores `D k^2 / 2` with `D = 4 mu t^3 / 12`.
    #[test]
    fn bending_stiffness_is_that_of_a_plate() {
        let (mu, thickness) = (1.3, 0.7);
        let basis = LoopBasis::new([6; 3]);
        let mut point =
            Point::new(&basis.barycentre, &regular_lattice(), thickness, 1.0, 1.0).unwrap();
        point.sqrt_det_a = 1.0;
        for layer in &mut point.layers {
            (layer.inverse_metric, layer.inverse_det) = ([1.0, 1.0, 0.0], 1.0);
        }
        let metric = [1.0, 1.0, 0.0];
        for bend in [1e-2, 1e-3] {
            let k = bend / thickness;
            for form in [[k, 0.0, 0.0], [0.0, -k, 0.0]] {
                let exact = mu * thickness.powi(3) * k * k / 6.0;
                let energy = point.energy_of_forms(metric, form, &NEO_HOOKEAN).unwrap().value;
                // Of second order in the bend; rounding is relative to mu t.
                let tolerance = bend * bend + 1e-15 * mu * thickness / exact;
                assert!((energy / exact - 1.0).abs() < tolerance, "{energy} {exact}");
            }
        }
    }
}
