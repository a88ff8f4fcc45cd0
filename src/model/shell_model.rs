//! The model of one actuator: a wall, the pressure in its chamber, and the planes it may touch.
//!
//! ```text
//! E(u) = W(u) - p V(u) + barriers(u)       u = displacement of the control points
//! ```
//!
//! What a scene does not list is not assembled: without planes there is no contact term at all.

use super::assembly::{Assembler, Slots};
use super::contact::{PlaneContact, PlaneSettings};
use super::dirichlet::Dirichlet;
use super::element::{LoopBasis, LoopShell, Sample, fitted_control_points, samples};
use super::load::ChamberPressure;
use super::local::Term;
use super::material::Material;
use super::system::{Inadmissible, LoadedSystem, SparsityPattern, System};
use crate::math::{Rejected, Vec3};
use crate::mesh::ShellMesh;

/// The energy of a pressurised shell over the displacements of its control points.
#[derive(Clone, Debug)]
pub struct ShellModel {
    /// Control points at rest, mm.
    reference: Vec<Vec3>,
    wall: LoopShell,
    chamber: ChamberPressure,
    planes: Vec<(PlaneContact, Slots)>,
    planes_lifted: bool,
    wall_slots: Slots,
    assembler: Assembler,
    dirichlet: Dirichlet,
    force_scale: f64,
    positions: Vec<Vec3>,
    limit: Vec<Sample>,
    facets: Vec<[u32; 3]>,
    vertices: usize,
}

/// What a model holds fixed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Support {
    /// The mesh's clamp: its vertices and their tangent planes do not move, because their rings are held too.
    Clamp,
    /// Single unknowns, `3 node + axis`; for free bodies in tests.
    Unknowns(Vec<u32>),
}

impl ShellModel {
    /// The wall of `mesh` made of `material`, held by `support`, with the planes of the scene.
    ///
    /// # Errors
    /// [`Rejected`] when a fold is tighter than half the wall, or the limit surface cannot follow the mesh.
    pub fn new(
        mesh: &ShellMesh,
        material: &Material,
        support: &Support,
        planes: &[PlaneSettings],
    ) -> Result<Self, Rejected> {
        let bases = LoopBasis::of_stencils(&mesh.stencils);
        let reference = fitted_control_points(mesh, &bases)?;
        let wall = LoopShell::new(mesh, &bases, &reference, material.clone())?;
        let chamber = ChamberPressure::new(mesh, &bases);
        let planes: Vec<PlaneContact> = planes
            .iter()
            .map(|&plane| PlaneContact::new(mesh, &bases, &reference, plane))
            .collect();
        // Every plane's stencil lies within an element's, so the wall alone makes the pattern.
        let assembler = Assembler::new(reference.len(), &[&wall]);
        let held = match support {
            Support::Clamp => {
                let near = |&v: &u32| mesh.rings.ring(v).iter().copied().chain([v]);
                mesh.clamp
                    .iter()
                    .flat_map(near)
                    .flat_map(|v| [3 * v, 3 * v + 1, 3 * v + 2])
                    .collect()
            }
            Support::Unknowns(unknowns) => unknowns.clone(),
        };
        let wall_slots = assembler.slots(&wall);
        let planes = planes.into_iter().map(|plane| {
            let slots = assembler.slots(&plane);
            (plane, slots)
        });
        let element_size = (mesh.surface.area() / mesh.surface.triangles.len() as f64).sqrt();
        let (limit, facets) = samples(&mesh.stencils, &bases, &mesh.rings);
        Ok(Self {
            planes: planes.collect(),
            planes_lifted: false,
            wall_slots,
            dirichlet: Dirichlet::new(assembler.pattern(), held),
            force_scale: material.shear_modulus() * mesh.thickness * element_size,
            positions: reference.clone(),
            vertices: reference.len(),
            reference,
            wall,
            chamber,
            assembler,
            limit,
            facets,
        })
    }

    /// The number of unknowns.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        3 * self.reference.len()
    }

    /// The volume inside the mid-surface at displacement `u`, mm^3.
    #[must_use]
    pub fn volume(&self, u: &[f64]) -> f64 {
        self.chamber.volume(&self.displaced(u))
    }

    /// Takes the planes of the scene away, or puts them back; only [`Self::smallest_gap`] still sees lifted planes.
    pub fn lift_planes(&mut self, lifted: bool) {
        self.planes_lifted = lifted;
    }

    /// The share of the wall whose bending is softened because it folds tighter than its thickness allows.
    #[must_use]
    pub fn creased_share(&self) -> f64 {
        self.wall.creased_share()
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

    /// Displacements of the mesh's vertices on the limit surface, mm.
    #[must_use]
    pub fn vertex_displacements(&self, u: &[f64]) -> Vec<Vec3> {
        let u: Vec<Vec3> = u.as_chunks().0.iter().map(|&u: &[f64; 3]| u.into()).collect();
        self.limit[..self.vertices].iter().map(|sample| sample.point(&u)).collect()
    }

    /// The limit surface at displacement `u`: its points, and the facets that carry pressure and contact.
    #[must_use]
    pub fn limit_surface(&self, u: &[f64]) -> (Vec<Vec3>, &[[u32; 3]]) {
        let positions = self.displaced(u);
        (self.limit.iter().map(|sample| sample.point(&positions)).collect(), &self.facets)
    }

    fn displaced(&self, u: &[f64]) -> Vec<Vec3> {
        self.reference.iter().zip(u.as_chunks().0).map(|(x, &u)| x + Vec3::from(u)).collect()
    }

    fn displace(&mut self, u: &[f64]) {
        assert_eq!(u.len(), self.unknowns());
        let displaced = self.reference.iter().zip(u.as_chunks().0);
        for (position, (x, &u)) in self.positions.iter_mut().zip(displaced) {
            *position = x + Vec3::from(u);
        }
    }

    fn assemble(
        &mut self,
        u: &[f64],
        residual: &mut [f64],
        mut tangent: Option<&mut [f64]>,
    ) -> Result<f64, Inadmissible> {
        self.displace(u);
        residual.fill(0.0);
        if let Some(tangent) = tangent.as_deref_mut() {
            tangent.fill(0.0);
        }
        let (assembler, positions) = (&mut self.assembler, &self.positions);
        let mut add = |term: &dyn Term, slots: &Slots| {
            assembler.add(term, slots, positions, residual, tangent.as_deref_mut())
        };
        let mut energy = add(&self.wall, &self.wall_slots)?;
        if self.chamber.pressure != 0.0 {
            energy += add(&self.chamber, &self.wall_slots)?;
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
        self.displace(u);
        let mut energy = self.assembler.energy(&self.wall, &self.positions)?;
        energy -= self.chamber.pressure * self.chamber.volume(&self.positions);
        if !self.planes_lifted {
            for (plane, _) in &self.planes {
                energy += self.assembler.energy(plane, &self.positions)?;
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
}

impl LoadedSystem for ShellModel {
    fn set_load(&mut self, load: f64) {
        self.chamber.pressure = load;
    }

    fn conjugate(&self, u: &[f64]) -> f64 {
        self.volume(u)
    }

    fn load_direction(&self, u: &[f64], direction: &mut [f64]) {
        let mut gradient = vec![Vec3::zeros(); self.reference.len()];
        self.chamber.add_volume_gradient(&self.displaced(u), &mut gradient);
        for (out, gradient) in direction.as_chunks_mut().0.iter_mut().zip(gradient) {
            *out = gradient.into();
        }
        self.dirichlet.apply_to_residual(direction);
    }
}
