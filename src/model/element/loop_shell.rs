//! The Kirchhoff-Love shell on Loop's subdivision surface, at large strain and in plane stress.
//!
//! At a quadrature point the control points `x_I` enter through five linear combinations,
//! `d = (a1, a2, x11, x22, x12)`, hence through two fundamental forms `a_ab` and `b_ab = x_ab . n`, whose energy is
//! [`super::wall_point`]'s. One barycentre for each triangle; its area is the limit surface's own, so that meshes of any
//! valence have their true area.
//!
//! Where a fold at rest is tighter than the wall allows, its bending softens; [`LoopShell::creased_share`] says how much
//! of the wall that is. True creases have no place in this element: round them to a radius of the thickness or more.
//!
//! Source: Cirak & Ortiz (2001), finite-deformation thin shells by subdivision.

use std::rc::Rc;

use pulp::{Simd, WithSimd};

use super::kinematics::{Derivatives, Form, Row};
use super::loop_patch::{LoopBasis, LoopPoint};
use super::points::ascending;
use super::wall_point::{Creases, WallPoint, bending_depth};
use super::wall_state::{PeakState, ShellState, states_of_triangles};
use crate::math::{Reason, Rejected, Room, Vec3};
use crate::mesh::{Section, SectionPoint, Stencil};
use crate::model::block::vectorize;
use crate::model::local::{LocalDerivatives, Term};
use crate::model::material::Material;
use crate::model::system::Inadmissible;

/// The stored energy of the wall.
#[derive(Clone, Debug)]
pub struct LoopShell {
    stencils: Vec<Vec<u32>>,
    points: Vec<WallPoint>,
    /// `[,1 ,2 ,11 ,22 ,12]` of each node of each stencil at its barycentre.
    basis: Vec<Vec<Row>>,
    /// Of each triangle how many points it has.
    counts: Vec<u8>,
    /// Of each point.
    sections: Vec<SectionPoint>,
    materials: Vec<Material>,
    creased_share: f64,
}

impl LoopShell {
    /// The wall of `section`, made of `materials`, over the triangles of `stencils`, with control points at `x` at rest.
    ///
    /// # Errors
    /// [`Rejected`] when more than a tenth of the wall folds at rest more tightly than its thickness allows.
    pub fn new(
        stencils: &[Stencil],
        bases: &[Rc<LoopBasis>],
        x: &[Vec3],
        section: &Section,
        materials: &[Material],
    ) -> Result<Self, Rejected> {
        let mut shell = Self {
            stencils: Vec::with_capacity(bases.len()),
            points: Vec::with_capacity(bases.len()),
            basis: Vec::with_capacity(bases.len()),
            counts: bases.iter().map(|basis| basis.points.len() as u8).collect(),
            sections: Vec::with_capacity(bases.len()),
            materials: materials.to_vec(),
            creased_share: 0.0,
        };
        let mut creases = Creases::default();
        for (triangle, (stencil, basis)) in stencils.iter().zip(bases).enumerate() {
            let corners = [stencil.nodes[0], stencil.nodes[1], stencil.nodes[2]];
            let positions: Vec<Vec3> = stencil.nodes.iter().map(|&v| x[v as usize]).collect();
            let area = basis.area(&positions);
            for LoopPoint { share, place, rows } in &basis.points {
                let forms = Derivatives::new(rows, &positions).forms();
                let forms = forms.map_err(|Inadmissible(what)| {
                    Rejected::new(Room::Model, Reason::DegenerateElement, what.to_owned(), 1.0)
                })?;
                let point = section.at(triangle, corners, *place);
                let depth = bending_depth(forms, point.thickness);
                let area = share * area;
                shell.points.push(WallPoint::new(forms, area, point.thickness, depth));
                shell.sections.push(point);
                creases.add(area, depth);
                let (nodes, weights) = ascending(&stencil.nodes, rows);
                shell.stencils.push(nodes);
                shell.basis.push(weights);
            }
        }
        shell.creased_share = creases.share()?;
        Ok(shell)
    }

    /// The share of the wall whose bending is softened because it folds tighter than its thickness allows.
    #[must_use]
    pub fn creased_share(&self) -> f64 {
        self.creased_share
    }

    /// The wall's volume at rest, mm^3.
    #[must_use]
    pub fn volume(&self) -> f64 {
        self.points.iter().map(WallPoint::volume).sum()
    }

    /// What the wall bears in each triangle, with its control points at `reference` at rest and `x` now.
    ///
    /// # Errors
    /// [`Inadmissible`] where an element has collapsed.
    pub fn states(&self, reference: &[Vec3], x: &[Vec3]) -> Result<Vec<ShellState>, Inadmissible> {
        let state = |s| {
            let [rest, now] = [self.forms(s, reference)?, self.forms(s, x)?];
            Ok(ShellState::new(rest, now, self.sections[s].thickness, self.material(s)))
        };
        states_of_triangles(&self.counts, state)
    }

    /// The largest stretch and stress at the faces of each point, with its control points at `reference` at rest and `x` now.
    ///
    /// # Errors
    /// [`Inadmissible`] where an element has collapsed.
    pub fn peaks(&self, reference: &[Vec3], x: &[Vec3]) -> Result<Vec<PeakState>, Inadmissible> {
        let of_triangle = |(t, &count): (usize, &u8)| std::iter::repeat_n(t, usize::from(count));
        let triangles = self.counts.iter().enumerate().flat_map(of_triangle);
        let mut peaks = Vec::with_capacity(2 * self.points.len());
        for (s, triangle) in triangles.enumerate() {
            let forms = [self.forms(s, reference)?, self.forms(s, x)?];
            let material = self.material(s);
            peaks.extend(PeakState::of_faces(triangle, self.sections[s], forms, material));
        }
        Ok(peaks)
    }

    /// The fundamental forms at a point, with all control points at `x`.
    fn forms(&self, s: usize, x: &[Vec3]) -> Result<[Form; 2], Inadmissible> {
        let nodes: Vec<Vec3> = self.stencils[s].iter().map(|&v| x[v as usize]).collect();
        Derivatives::new(&self.basis[s], &nodes).forms()
    }

    fn material(&self, s: usize) -> &Material {
        &self.materials[usize::from(self.sections[s].material)]
    }
}

impl Term for LoopShell {
    fn stencils(&self) -> &[Vec<u32>] {
        &self.stencils
    }

    fn energy(&self, s: usize, x: &[Vec3]) -> Result<f64, Inadmissible> {
        let forms = Derivatives::new(&self.basis[s], x).forms()?;
        self.points[s].energy(forms, self.material(s))
    }

    fn derivatives(
        &self,
        s: usize,
        x: &[Vec3],
        local: &mut LocalDerivatives,
    ) -> Result<f64, Inadmissible> {
        vectorize(DerivativesOf { shell: self, s, x, local })
    }
}

/// The derivatives of one stencil's energy.
struct DerivativesOf<'a> {
    shell: &'a LoopShell,
    s: usize,
    x: &'a [Vec3],
    local: &'a mut LocalDerivatives,
}

impl WithSimd for DerivativesOf<'_> {
    type Output = Result<f64, Inadmissible>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Self { shell, s, x, local } = self;
        let basis = &shell.basis[s];
        let surface = Derivatives::new(basis, x);
        let (forms, material) = (surface.forms()?, shell.material(s));
        let energy = shell.points[s].derivatives(forms, material, local.with_hessian())?;
        surface.chain(simd, &energy, basis, local);
        Ok(energy.value)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Isometry3, Matrix2, UnitQuaternion};
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::model::material::{NeoHookean, Ogden};
    use crate::model::term_suite::{Case, term_suite};
    use crate::model::test_shells::TestShell;

    const NEO_HOOKEAN: Material = Material::NeoHookean(NeoHookean { mu: 1.3 });

    fn wall(shell: &TestShell, material: Material) -> Case<LoopShell> {
        let term = shell.wall(material);
        assert_eq!(term.creased_share(), 0.0);
        let motion = Isometry3::new(Vec3::new(3.0, -5.0, 2.0), Vec3::new(0.4, 1.9, -0.7));
        Case { term, positions: shell.deformed.clone(), motion }
    }

    term_suite!(neo_hookean, |shell| wall(shell, NEO_HOOKEAN));
    term_suite!(ogden, |shell| wall(shell, Material::Ogden(Ogden::ninjaflex_c2s())));

    /// The kernel without wide registers and fused products differs by rounding: sums of some ten thousand products.
    #[test]
    fn derivatives_are_those_of_the_plain_kernel() {
        let shell = TestShell::new(0);
        let wall = shell.wall(NEO_HOOKEAN);
        let [mut wide, mut plain] = [0, 0].map(|_| LocalDerivatives::default());
        for (s, stencil) in wall.stencils().iter().enumerate() {
            let x: Vec<Vec3> = stencil.iter().map(|&v| shell.deformed[v as usize]).collect();
            [&mut wide, &mut plain].into_iter().for_each(|local| local.reset(x.len(), true));
            let energy = wall.derivatives(s, &x, &mut wide).unwrap();
            let kernel = DerivativesOf { shell: &wall, s, x: &x, local: &mut plain };
            assert!((kernel.with_simd(pulp::Scalar).unwrap() / energy - 1.0).abs() < 1e-13);
            let blocks = || (0..x.len()).flat_map(|j| (j..x.len()).map(move |i| (i, j)));
            let largest = blocks().map(|(i, j)| plain.block(i, j).amax()).fold(0.0, f64::max);
            let error = blocks().map(|(i, j)| (wide.block(i, j) - plain.block(i, j)).amax());
            assert!(largest > 0.0 && error.fold(0.0, f64::max) < 1e-13 * largest);
        }
    }

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
            let forms = Derivatives::new(rows, &flat).forms().unwrap();
            let point = WallPoint::new(forms, area, thickness, 1.0);
            let shell = LoopShell {
                counts: vec![1],
                stencils: vec![(0..flat.len() as u32).collect()],
                points: vec![point],
                basis: vec![rows.clone()],
                sections: vec![SectionPoint { thickness, material: 0 }],
                materials: vec![NEO_HOOKEAN],
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
}
