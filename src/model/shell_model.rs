//! The model of one part: a wall, the loads on it, and the planes it may touch.
//!
//! ```text
//! E(u) = W(u) - p V(u) - f . u - moments(u) + barriers(u)       u = displacement of the nodes
//! ```
//!
//! What a scene does not list is not assembled: without planes there is no contact term at all.

use super::assembly::{Assembler, Slots};
use super::contact::{PlaneContact, PlaneSettings};
use super::dirichlet::Dirichlet;
use super::discretization::{Discretization, Wall};
use super::element::{Sample, SampledSurface};
use super::load::{ChamberPressure, EdgeMoment};
use super::local::Term;
use super::material::Material;
use super::stretch_bound::StretchBound;
use super::system::{Inadmissible, Limit, LimitKind, LoadedSystem, SparsityPattern, System};
use super::tie::{Tied, Ties};
use crate::math::{Rejected, Vec3};
use crate::mesh::ShellMesh;

/// The energy of a loaded shell over the displacements of its nodes.
#[derive(Clone, Debug)]
pub struct ShellModel {
    /// Nodes at rest, mm.
    reference: Vec<Vec3>,
    ties: Ties,
    wall: Tied<Wall>,
    chamber: Option<Tied<ChamberPressure>>,
    /// Pressure at a load of 1, MPa.
    pub(super) pressure: f64,
    /// Dead forces at a load of 1, by node, N; empty where there are none.
    pub(super) forces: Vec<Vec3>,
    moments: Option<(Tied<EdgeMoment>, Slots)>,
    load: f64,
    planes: Vec<(PlaneContact, Slots)>,
    planes_lifted: bool,
    wall_slots: Slots,
    chamber_slots: Slots,
    assembler: Assembler,
    dirichlet: Dirichlet,
    pub(super) force_scale: f64,
    energy_rounding: f64,
    surface: SampledSurface,
    stretch_bound: StretchBound,
}

/// What a model of a closed part holds fixed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Support {
    /// The mesh's clamp: its vertices and their tangent planes do not move, because their rings are held too.
    Clamp,
    /// Single unknowns, `3 node + axis`; for free bodies in tests.
    Unknowns(Vec<u32>),
}

impl ShellModel {
    /// The wall of `mesh` made of `material`, held by `support`, with the planes of the scene; its load is the pressure.
    ///
    /// # Errors
    /// [`Rejected`] when a fold is tighter than half the wall, or the limit surface cannot follow the mesh.
    pub fn new(
        mesh: &ShellMesh,
        material: &Material,
        support: &Support,
        planes: &[PlaneSettings],
    ) -> Result<Self, Rejected> {
        let parts = Discretization::closed(mesh, material)?;
        let held = match support {
            Support::Clamp => {
                let near = |&v: &u32| mesh.rings.ring(v).iter().copied().chain([v]);
                let nodes = mesh.clamp.iter().flat_map(near);
                nodes.flat_map(|v| [3 * v, 3 * v + 1, 3 * v + 2]).collect()
            }
            Support::Unknowns(unknowns) => unknowns.clone(),
        };
        let planes: Vec<PlaneContact> = planes
            .iter()
            .map(|&plane| {
                PlaneContact::new(&parts.surface, &parts.reference, mesh.thickness, plane)
            })
            .collect();
        let chamber = ChamberPressure::new(&parts.points);
        let mut model = Self::assembled(parts, Some(chamber), None, held, material);
        model.pressure = 1.0;
        let slots = planes.into_iter().map(|plane| {
            let slots = model.assembler.slots(&plane);
            (plane, slots)
        });
        model.planes = slots.collect();
        Ok(model)
    }

    /// The model of `parts`; the loads are still to be set.
    pub(super) fn assembled(
        parts: Discretization,
        chamber: Option<ChamberPressure>,
        moments: Option<EdgeMoment>,
        mut held: Vec<u32>,
        material: &Material,
    ) -> Self {
        let Discretization { reference, ties, surface, .. } = parts;
        let area = parts.areas.iter().sum::<f64>();
        let element_size = (area / parts.areas.len() as f64).sqrt();
        let tied = |term| Tied::new(term, &ties, &reference);
        let wall = Tied::new(parts.wall, &ties, &reference);
        let chamber = chamber.map(tied);
        let moments = moments.map(|term| Tied::new(term, &ties, &reference));
        // The stencils of all other terms lie within those of elements, so the wall alone makes the pattern.
        let assembler = Assembler::new(reference.len(), &[&wall]);
        let mut is_used = vec![false; reference.len()];
        wall.stencils().iter().flatten().for_each(|&v| is_used[v as usize] = true);
        held.extend(parts.held);
        held.extend(
            (0..3 * reference.len() as u32).filter(|unknown| !is_used[*unknown as usize / 3]),
        );
        Self {
            wall_slots: assembler.slots(&wall),
            chamber_slots: chamber.as_ref().map(|term| assembler.slots(term)).unwrap_or_default(),
            moments: moments.map(|term| {
                let slots = assembler.slots(&term);
                (term, slots)
            }),
            pressure: 0.0,
            forces: Vec::new(),
            load: 0.0,
            planes: Vec::new(),
            planes_lifted: false,
            dirichlet: Dirichlet::new(assembler.pattern(), held),
            force_scale: material.shear_modulus() * parts.thickness * element_size,
            // Invariants of an undeformed wall carry a rounding of 1e-16 each, of either sign.
            energy_rounding: 1e-17 * material.young_modulus() * parts.thickness * area,
            stretch_bound: StretchBound::new(&surface, &reference),
            surface,
            ties,
            wall,
            chamber,
            assembler,
            reference,
        }
    }

    /// The number of unknowns, held ones included.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        3 * self.reference.len()
    }

    /// The number of unknowns that may move.
    #[must_use]
    pub fn free_unknowns(&self) -> usize {
        self.unknowns() - self.dirichlet.held()
    }

    /// The volume inside the mid-surface at displacement `u`, mm^3; 0 where there is no chamber.
    #[must_use]
    pub fn volume(&self, u: &[f64]) -> f64 {
        self.chamber.as_ref().map_or(0.0, |chamber| chamber.inner().volume(&self.displaced(u)))
    }

    /// Takes the planes of the scene away, or puts them back; only [`Self::smallest_gap`] still sees lifted planes.
    pub fn lift_planes(&mut self, lifted: bool) {
        self.planes_lifted = lifted;
    }

    /// Sets the stretch beyond which the part is said to balloon; [`super::DEFAULT_STRETCH_BOUND`] unless set.
    pub fn set_stretch_bound(&mut self, bound: f64) {
        self.stretch_bound.bound = bound;
    }

    /// Where the unknown `unknown` acts, at displacement `u`: the position of its node, mm.
    #[must_use]
    pub fn place_of(&self, unknown: usize, u: &[f64]) -> Vec3 {
        self.displaced(u)[unknown / 3]
    }

    /// The share of the wall whose bending is softened because it folds tighter than its thickness allows.
    #[must_use]
    pub fn creased_share(&self) -> f64 {
        self.wall.inner().creased_share()
    }

    /// The force with which the part presses on the planes of the scene, N.
    #[must_use]
    pub fn plane_force(&self, u: &[f64]) -> f64 {
        if self.planes_lifted {
            return 0.0;
        }
        let positions = self.displaced(u);
        self.planes
            .iter()
            .map(|(plane, _)| plane.force(&positions))
            .fold(0.0, |sum, force| sum + force)
    }

    /// The smallest gap to a plane of the scene, mm; infinite without planes.
    #[must_use]
    pub fn smallest_gap(&self, u: &[f64]) -> f64 {
        let positions = self.displaced(u);
        self.planes.iter().map(|(p, _)| p.smallest_gap(&positions)).fold(f64::INFINITY, f64::min)
    }

    /// Displacements of the mesh's vertices, mm.
    #[must_use]
    pub fn vertex_displacements(&self, u: &[f64]) -> Vec<Vec3> {
        let mut u: Vec<Vec3> = u.as_chunks().0.iter().map(|&u: &[f64; 3]| u.into()).collect();
        self.ties.displace(&mut u);
        self.surface.samples[..self.surface.vertices].iter().map(|s| s.point(&u)).collect()
    }

    /// Positions of all nodes, mm.
    fn displaced(&self, u: &[f64]) -> Vec<Vec3> {
        let mut x: Vec<Vec3> = u.as_chunks().0.iter().map(|&u: &[f64; 3]| u.into()).collect();
        assert_eq!(x.len(), self.reference.len());
        self.ties.displace(&mut x);
        x.iter_mut().zip(&self.reference).for_each(|(x, reference)| *x += reference);
        x
    }

    /// Positions as the tied terms take them: at rest, plus the unknowns.
    fn untied(&self, u: &[f64]) -> Vec<Vec3> {
        assert_eq!(u.len(), self.unknowns());
        self.reference.iter().zip(u.as_chunks().0).map(|(x, &u)| x + Vec3::from(u)).collect()
    }

    /// The work of the dead forces at a load of 1, mJ.
    fn work_of_forces(&self, u: &[f64]) -> f64 {
        self.forces.iter().zip(u.as_chunks().0).map(|(f, &u)| f.dot(&Vec3::from(u))).sum()
    }

    fn assemble(
        &mut self,
        u: &[f64],
        residual: &mut [f64],
        mut tangent: Option<&mut [f64]>,
    ) -> Result<f64, Inadmissible> {
        let positions = self.untied(u);
        residual.fill(0.0);
        if let Some(tangent) = tangent.as_deref_mut() {
            tangent.fill(0.0);
        }
        let mut energy = -self.load * self.work_of_forces(u);
        for (residual, force) in residual.as_chunks_mut::<3>().0.iter_mut().zip(&self.forces) {
            *residual = (-self.load * force).into();
        }
        let assembler = &mut self.assembler;
        let mut add = |term: &dyn Term, slots: &Slots| {
            assembler.add(term, slots, &positions, residual, tangent.as_deref_mut())
        };
        energy += add(&self.wall, &self.wall_slots)?;
        if let Some(chamber) = &self.chamber
            && chamber.inner().pressure != 0.0
        {
            energy += add(chamber, &self.chamber_slots)?;
        }
        if let Some((moments, slots)) = &self.moments {
            energy += add(moments, slots)?;
        }
        if !self.planes_lifted {
            for (plane, slots) in &self.planes {
                energy += add(plane, slots)?;
            }
        }
        self.dirichlet.apply_to_residual(residual);
        if let Some(tangent) = tangent {
            self.dirichlet.apply_to_tangent(tangent);
        }
        Ok(energy)
    }
}

impl System for ShellModel {
    fn pattern(&self) -> &SparsityPattern {
        self.assembler.pattern()
    }

    fn energy(&mut self, u: &[f64]) -> Result<f64, Inadmissible> {
        let positions = self.untied(u);
        let mut energy = self.assembler.energy(&self.wall, &positions)?;
        energy -= self.load * self.work_of_forces(u);
        if let Some(chamber) = &self.chamber {
            energy -= chamber.inner().pressure * self.volume(u);
        }
        if let Some((moments, _)) = &self.moments {
            energy += self.assembler.energy(moments, &positions)?;
        }
        if !self.planes_lifted {
            for (plane, _) in &self.planes {
                energy += self.assembler.energy(plane, &positions)?;
            }
        }
        Ok(energy)
    }

    fn residual(&mut self, u: &[f64], residual: &mut [f64]) -> Result<f64, Inadmissible> {
        self.assemble(u, residual, None)
    }

    fn tangent(
        &mut self,
        u: &[f64],
        residual: &mut [f64],
        tangent: &mut [f64],
    ) -> Result<f64, Inadmissible> {
        self.assemble(u, residual, Some(tangent))
    }

    fn longest_step(&self, u: &[f64], du: &[f64]) -> f64 {
        if self.planes.is_empty() || self.planes_lifted {
            return 1.0;
        }
        let positions = self.displaced(u);
        let du: Vec<Vec3> = du.as_chunks().0.iter().map(|&du: &[f64; 3]| du.into()).collect();
        self.planes.iter().map(|(p, _)| p.longest_step(&positions, &du)).fold(1.0, f64::min)
    }

    fn force_scale(&self) -> f64 {
        self.force_scale
    }

    fn energy_rounding(&self) -> f64 {
        self.energy_rounding
    }
}

impl LoadedSystem for ShellModel {
    fn set_load(&mut self, load: f64) {
        self.load = load;
        if let Some(chamber) = &mut self.chamber {
            chamber.inner_mut().pressure = load * self.pressure;
        }
        if let Some((moments, _)) = &mut self.moments {
            moments.inner_mut().load_factor = load;
        }
    }

    fn conjugate(&self, u: &[f64]) -> f64 {
        let mut conjugate = self.work_of_forces(u);
        if self.chamber.is_some() {
            conjugate += self.pressure * self.volume(u);
        }
        if let Some((moments, _)) = &self.moments {
            conjugate += moments.inner().work(&self.displaced(u));
        }
        conjugate
    }

    fn load_direction(&self, u: &[f64], direction: &mut [f64]) {
        let positions = self.displaced(u);
        let mut gradient = vec![Vec3::zeros(); self.reference.len()];
        if let Some(chamber) = &self.chamber {
            chamber.inner().add_volume_gradient(&positions, &mut gradient);
            gradient.iter_mut().for_each(|gradient| *gradient *= self.pressure);
        }
        if let Some((moments, _)) = &self.moments {
            moments.inner().add_work_gradient(&positions, &mut gradient);
        }
        self.ties.reduce(&mut gradient);
        for (gradient, force) in gradient.iter_mut().zip(&self.forces) {
            *gradient += force;
        }
        for (out, gradient) in direction.as_chunks_mut().0.iter_mut().zip(gradient) {
            *out = gradient.into();
        }
        self.dirichlet.apply_to_residual(direction);
    }

    fn settle(&mut self, u: &[f64]) -> f64 {
        let positions = self.displaced(u);
        if let Some((moments, _)) = &mut self.moments {
            moments.inner_mut().settle(&positions);
        }
        0.0
    }

    fn passed_limit(&self, u: &[f64]) -> Option<Limit> {
        let at = |sample: u32| {
            let Sample { nodes, weights } = &self.surface.samples[sample as usize];
            let heaviest = (0..nodes.len()).max_by(|&a, &b| weights[a].total_cmp(&weights[b]));
            3 * nodes[heaviest.expect("a sample has nodes")] as usize
        };
        let samples = self.surface.at(&self.displaced(u));
        let stretched = self.stretch_bound.passed(&samples);
        stretched.map(|sample| Limit { kind: LimitKind::Ballooning, unknown: at(sample) })
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::mesh::ShellSettings;
    use crate::model::material::NeoHookean;
    use crate::model::test_shells::{TestShell, difference};
    use crate::surface::TriangleMesh;

    const MATERIAL: Material = Material::NeoHookean(NeoHookean { mu: 1.3 });
    const STEP: f64 = 1e-3;

    /// A clamped, pressurised shell near a plane, far from rest; its state; which unknowns are held.
    fn loaded(seed: u64) -> (ShellModel, Vec<f64>, Vec<bool>) {
        let shell = TestShell::new(seed);
        let plane = |offset| PlaneSettings {
            normal: [0.48, -0.6, 0.64],
            offset,
            activation: 3.0,
            stiffness: 0.7,
        };
        let new = |offset| {
            ShellModel::new(&shell.mesh, &MATERIAL, &Support::Clamp, &[plane(offset)]).unwrap()
        };
        let moved = shell.deformed.iter().zip(&shell.reference).map(|(x, rest)| x - rest);
        let mut u: Vec<f64> = moved.flat_map(|u| [u.x, u.y, u.z]).collect();
        let mut held = vec![false; u.len()];
        for &v in &shell.mesh.clamp {
            for w in shell.mesh.rings.ring(v).iter().chain([&v]) {
                for unknown in 3 * *w as usize..3 * *w as usize + 3 {
                    held[unknown] = true;
                    u[unknown] = 0.0;
                }
            }
        }
        let mut model = new(new(0.0).smallest_gap(&u) - 0.4);
        model.set_load(0.03);
        assert!(held.contains(&true) && held.contains(&false));
        (model, u, held)
    }

    fn energy_at(model: &mut ShellModel, u: &DVector<f64>) -> f64 {
        model.energy(u.as_slice()).unwrap()
    }

    fn residual_at(model: &mut ShellModel, u: &DVector<f64>) -> DVector<f64> {
        let mut residual = DVector::zeros(u.len());
        model.residual(u.as_slice(), residual.as_mut_slice()).unwrap();
        residual
    }

    fn tangent_at(model: &mut ShellModel, u: &DVector<f64>) -> DMatrix<f64> {
        let pattern = model.pattern().clone();
        let mut values = vec![0.0; pattern.stored()];
        let mut residual = DVector::zeros(u.len());
        model.tangent(u.as_slice(), residual.as_mut_slice(), &mut values).unwrap();
        assert_eq!(residual, residual_at(model, u));
        let mut tangent = DMatrix::zeros(u.len(), u.len());
        for column in 0..u.len() {
            let stored = pattern.column_starts[column]..pattern.column_starts[column + 1];
            for entry in stored.map(|entry| entry as usize) {
                let row = pattern.row_indices[entry] as usize;
                if row >= column {
                    tangent[(row, column)] = values[entry];
                    tangent[(column, row)] = values[entry];
                }
            }
        }
        tangent
    }

    /// Central differences of fourth order are some 1e-11 wrong, as in the suite of single terms.
    #[test]
    fn residual_is_the_difference_of_the_energy() {
        let (mut model, u, held) = loaded(0);
        let u = DVector::from_vec(u);
        let residual = residual_at(&mut model, &u);
        for unknown in 0..u.len() {
            if held[unknown] {
                assert_eq!(residual[unknown], 0.0);
                continue;
            }
            let slope = difference(STEP, |h| {
                let mut moved = u.clone();
                moved[unknown] += h;
                energy_at(&mut model, &moved)
            });
            let error = (slope - residual[unknown]).abs();
            assert!(error < 1e-10 * residual.amax(), "{:e}", error / residual.amax());
        }
    }

    #[test]
    fn tangent_is_the_difference_of_the_residual() {
        let (mut model, u, held) = loaded(1);
        let u = DVector::from_vec(u);
        let tangent = tangent_at(&mut model, &u);
        for unknown in (0..u.len()).filter(|&unknown| held[unknown]) {
            let identity = DVector::from_fn(u.len(), |row, _| f64::from(row == unknown));
            assert_eq!(tangent.column(unknown), identity);
        }
        let mut chance = ChaCha8Rng::seed_from_u64(1);
        for _ in 0..20 {
            let direction = DVector::from_fn(u.len(), |unknown, _| {
                if held[unknown] { 0.0 } else { chance.random_range(-1.0..1.0) }
            });
            let slope = difference(STEP, |h| residual_at(&mut model, &(&u + h * &direction)));
            let exact = &tangent * &direction;
            let error = (slope - &exact).amax() / exact.amax();
            assert!(error < 1e-10, "{error:e}");
        }
    }

    #[test]
    fn load_direction_is_the_difference_of_the_volume() {
        let (model, u, held) = loaded(2);
        let mut direction = vec![0.0; u.len()];
        model.load_direction(&u, &mut direction);
        for unknown in 0..u.len() {
            let slope = difference(1e-2, |h| {
                let mut moved = u.clone();
                moved[unknown] += h;
                model.conjugate(&moved)
            });
            let expected = if held[unknown] { 0.0 } else { slope };
            // A volume of 4,000 mm^3 is rounded to 1e-12, over a step of 1e-2.
            assert!((direction[unknown] - expected).abs() < 1e-9);
        }
    }

    /// The clamp holds its vertices on the limit surface wherever the rest goes.
    #[test]
    fn clamped_vertices_stay() {
        let shell = TestShell::new(0);
        let (model, u, _) = loaded(0);
        let moved = model.vertex_displacements(&u);
        assert!(shell.mesh.clamp.iter().all(|&v| moved[v as usize] == Vec3::zeros()));
        assert!(moved.iter().any(|u| u.norm() > 1.0));
        assert!(model.smallest_gap(&u) > 0.0 && model.plane_force(&u) > 0.0);
    }

    /// A free shell at rest is free of force, and its six rigid motions are the only ones that cost nothing.
    #[test]
    fn free_shell_has_six_rigid_motions() {
        let settings = ShellSettings { thickness: 0.8, clamp_height: 6.0, ..Default::default() };
        let sphere = ShellMesh::new(TriangleMesh::sphere(10.0, 1), &settings).unwrap();
        let eggs = [0, 1, 2].map(|seed| TestShell::new(seed).mesh);
        for mesh in eggs.iter().chain([&sphere]) {
            let free = Support::Unknowns(Vec::new());
            let mut model = ShellModel::new(mesh, &MATERIAL, &free, &[]).unwrap();
            let rest = DVector::zeros(model.unknowns());
            let residual = residual_at(&mut model, &rest).amax();
            assert!(residual < 1e-13 * model.force_scale(), "{residual:e}");
            let tangent = tangent_at(&mut model, &rest);
            let mut eigenvalues = tangent.symmetric_eigenvalues();
            eigenvalues.as_mut_slice().sort_by(f64::total_cmp);
            let stiffest = eigenvalues.amax();
            // Rounding of a matrix of order 126; then the softest bending mode, a hundredth of the stiffest.
            assert!(eigenvalues.rows(0, 6).amax() < 1e-14 * stiffest, "{eigenvalues}");
            assert!(eigenvalues[6] > 5e-3 * stiffest, "{eigenvalues}");
        }
    }
}
