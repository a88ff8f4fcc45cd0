//! The model of one part: a wall, of shells or of solid cells, the loads on it, and the planes it may touch.
//!
//! ```text
//! E(u) = W(u) - p V(u) - f . u - moments(u) + barriers(u) + friction(u)       u = displacement of the nodes
//! ```
//!
//! Follower forces of an open patch have no part in the energy: they act in the residual alone. The unknowns of solid cells are
//! displacements and then pressures.
//!
//! What a scene does not list is not assembled: without planes there is no contact term at all.

use std::ops::Range;

use super::assembly::{Assembler, Nodes, Slots};
use super::contact::self_contact::Folds;
use super::contact::{Faces, PlaneSettings, Planes};
use super::dirichlet::Dirichlet;
use super::discretization::{Discretization, Wall};
use super::element::{ElementPoints, Sample, SampledSurface, ascending};
use super::load::{ChamberPressure, EdgeMoment, FollowerLoads, LidFan};
use super::local::Term;
use super::material::Material;
use super::stretch_bound::StretchBound;
use super::system::{
    Inadmissible, Layout, Limit, LimitKind, LoadedSystem, Multiplier, SparsityPattern, System,
};
use super::tie::{Tied, Ties};
use crate::math::{Reason, Rejected, Room, Vec3};
use crate::mesh::{Location, ShellMesh, SolidMesh, quadratic_shapes};
use crate::surface::TriangleMesh;

/// The energy of a loaded part over the displacements of its nodes.
#[derive(Clone, Debug)]
pub struct PartModel {
    /// Nodes at rest, mm.
    pub(super) reference: Vec<Vec3>,
    pub(super) ties: Ties,
    pub(super) wall: Tied<Wall>,
    pub(super) chamber: Option<Tied<ChamberPressure>>,
    /// Pressure at a load of 1, MPa.
    pub(super) pressure: f64,
    /// Dead forces at a load of 1, by node, N; empty where there are none.
    pub(super) forces: Vec<Vec3>,
    /// Where there are ties: the same before followers pass them on.
    pub(super) untied_forces: Vec<Vec3>,
    pub(super) moments: Option<(Tied<EdgeMoment>, Slots)>,
    /// Forces without a potential.
    pub(super) followers: Option<(Tied<FollowerLoads>, Slots)>,
    pub(super) load: f64,
    pub(super) planes: Planes,
    pub(super) folds: Folds,
    /// None where they are to be found anew.
    pub(super) fold_slots: Option<Slots>,
    wall_slots: Slots,
    chamber_slots: Slots,
    pub(super) assembler: Assembler,
    pub(super) dirichlet: Dirichlet,
    pub(super) force_scale: f64,
    energy_rounding: f64,
    pub(super) surface: SampledSurface,
    /// Points whose displacements are shown.
    shown: Vec<Sample>,
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

impl PartModel {
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
        let chamber = ChamberPressure::new(&parts.points);
        let mut model = Self::assembled(parts, Some(chamber), None, held, material);
        model.pressure = 1.0;
        model.watch_folds(true);
        model.place(planes, Faces::about_middle(mesh.thickness));
        Ok(model)
    }

    /// The solid wall of `mesh`, about `thickness` (mm) thick, made of `material`, with the unknowns `held` (`3 node + axis`) and the planes of the scene;
    /// its load is the pressure in the chamber.
    ///
    /// What is shown are the corners of its boundary, until [`Self::show`] says otherwise.
    ///
    /// # Errors
    /// [`Rejected`] when a cell is inverted at rest, or the material has no law for solids.
    pub fn of_solid(
        mesh: &SolidMesh,
        thickness: f64,
        material: &Material,
        held: Vec<u32>,
        planes: &[PlaneSettings],
    ) -> Result<Self, Rejected> {
        let parts = Discretization::solid(mesh, thickness, material)?;
        let points: Vec<ElementPoints> =
            mesh.chamber.iter().map(|&face| ElementPoints::of_quadratic(face)).collect();
        let lids = mesh.lids.iter().map(|lid| LidFan::new(&lid.rim, &mesh.positions)).collect();
        let chamber = (!points.is_empty()).then(|| ChamberPressure::new(&points).with_lids(lids));
        let mut model = Self::assembled(parts, chamber, None, held, material);
        model.pressure = 1.0;
        model.place(planes, Faces::sampled(thickness));
        Ok(model)
    }

    /// Shows the displacements of the body at `points` (mm, at rest) from now on; `mesh` is that of the model.
    ///
    /// # Errors
    /// [`Rejected`] when a point lies far outside the body.
    pub fn show(&mut self, mesh: &SolidMesh, points: &[Vec3]) -> Result<(), Rejected> {
        let sample = |(location, point): (Option<Location>, &Vec3)| {
            let Location { cell, barycentric } = location.ok_or_else(|| {
                let detail = format!(
                    "({:.3}, {:.3}, {:.3}) mm lies in no cell of the wall",
                    point.x, point.y, point.z
                );
                Rejected::new(Room::Model, Reason::OutsideWall, detail, 1.0)
            })?;
            let weights = quadratic_shapes(&barycentric).map(|weight| [weight]);
            let (nodes, weights) = ascending(&mesh.tetrahedra[cell], &weights);
            Ok(Sample { nodes, weights: weights.iter().map(|[weight]| *weight).collect() })
        };
        self.shown = mesh
            .locate(points)
            .into_iter()
            .zip(points)
            .map(sample)
            .collect::<Result<_, Rejected>>()?;
        Ok(())
    }

    /// Places `planes` before the wall with `faces`.
    pub(super) fn place(&mut self, planes: &[PlaneSettings], faces: Faces) {
        let Self { surface, reference, ties, assembler, .. } = self;
        self.planes = Planes::new(planes, surface, reference, faces, ties, assembler);
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
        // The stencils of all other terms but lids lie within those of elements, so the wall alone makes the pattern.
        let nodes = Nodes { places: reference.len(), numbers: parts.pressures };
        let assembler = match &chamber {
            Some(chamber) if chamber.inner().has_lids() => Assembler::new(nodes, &[&wall, chamber]),
            _ => Assembler::new(nodes, &[&wall]),
        };
        let mut is_used = vec![false; nodes.count()];
        wall.stencils().iter().flatten().for_each(|&v| is_used[v as usize] = true);
        held.extend(parts.held);
        let unused = (0..nodes.count()).filter(|&node| !is_used[node]);
        held.extend(unused.flat_map(|node| {
            nodes.first_unknown(node) as u32..nodes.first_unknown(node + 1) as u32
        }));
        Self {
            wall_slots: assembler.slots(&wall),
            chamber_slots: chamber.as_ref().map(|term| assembler.slots(term)).unwrap_or_default(),
            moments: moments.map(|term| {
                let slots = assembler.slots(&term);
                (term, slots)
            }),
            followers: None,
            pressure: 0.0,
            forces: Vec::new(),
            untied_forces: Vec::new(),
            load: 0.0,
            planes: Planes::default(),
            folds: Folds::new(parts.points, parts.thickness),
            fold_slots: None,
            dirichlet: Dirichlet::new(assembler.pattern(), held),
            force_scale: material.shear_modulus() * parts.thickness * element_size,
            // Invariants of an undeformed wall carry a rounding of 1e-16 each, of either sign.
            energy_rounding: 1e-17 * material.young_modulus() * parts.thickness * area,
            stretch_bound: StretchBound::new(&surface, &reference),
            shown: surface.samples[..surface.vertices].to_vec(),
            surface,
            ties,
            wall,
            chamber,
            assembler,
            reference,
        }
    }

    /// Encloses another chamber, with stencils within those of elements.
    pub(super) fn replace_chamber(&mut self, chamber: ChamberPressure) {
        let chamber = Tied::new(chamber, &self.ties, &self.reference);
        self.chamber_slots = self.assembler.slots(&chamber);
        self.chamber = Some(chamber);
    }

    /// Adds forces without a potential.
    pub(super) fn follow_with(&mut self, followers: FollowerLoads) {
        let term = Tied::new(followers, &self.ties, &self.reference);
        let slots = self.assembler.slots(&term);
        self.followers = Some((term, slots));
    }

    /// The number of unknowns, held ones included.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        self.assembler.nodes().unknowns()
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

    /// Sets the stretch beyond which the part is said to balloon; [`super::DEFAULT_STRETCH_BOUND`] unless set.
    pub fn set_stretch_bound(&mut self, bound: f64) {
        self.stretch_bound.bound = bound;
    }

    /// Where the unknown `unknown` acts, at displacement `u`: the position of its node, mm.
    #[must_use]
    pub fn place_of(&self, unknown: usize, u: &[f64]) -> Vec3 {
        let node = unknown / 3;
        let corner = || unknown - 3 * self.reference.len();
        self.displaced(u)[if node < self.reference.len() { node } else { corner() }]
    }

    /// Extent at rest along x, y and z of the surface that carries pressure and contact, mm.
    #[must_use]
    pub fn rest_size(&self) -> Vec3 {
        let points = self.surface.at(&self.reference);
        let low = points.iter().fold(Vec3::repeat(f64::INFINITY), |low, x| low.inf(x));
        let high = points.iter().fold(Vec3::repeat(f64::NEG_INFINITY), |high, x| high.sup(x));
        high - low
    }

    /// The surface at rest that carries pressure and contact, in facets of about `edge` (mm): of a Loop shell its limit surface, of
    /// quadratic pieces.
    #[must_use]
    pub fn rest_surface(&self, edge: f64) -> TriangleMesh {
        let coarse = self.surface.quadratic(&self.reference, 1);
        let mean = (coarse.area() / (0.433 * coarse.triangles.len() as f64)).sqrt();
        self.surface.quadratic(&self.reference, (mean / edge).ceil().max(2.0) as usize)
    }

    /// The share of the wall whose bending is softened because it folds tighter than its thickness allows.
    #[must_use]
    pub fn creased_share(&self) -> f64 {
        self.wall.inner().creased_share()
    }

    /// Displacements of the mesh's vertices, or of what a solid shows, mm.
    #[must_use]
    pub fn vertex_displacements(&self, u: &[f64]) -> Vec<Vec3> {
        let u = self.displacements(u);
        self.shown.iter().map(|sample| sample.point(&u)).collect()
    }

    /// Displacements of all nodes, mm.
    pub(super) fn displacements(&self, u: &[f64]) -> Vec<Vec3> {
        assert_eq!(u.len(), self.unknowns());
        let (places, _) = u.split_at(3 * self.reference.len());
        let mut u: Vec<Vec3> = places.as_chunks().0.iter().map(|&u: &[f64; 3]| u.into()).collect();
        self.ties.displace(&mut u);
        u
    }

    /// Positions of all nodes, mm.
    pub(super) fn displaced(&self, u: &[f64]) -> Vec<Vec3> {
        let mut x = self.displacements(u);
        x.iter_mut().zip(&self.reference).for_each(|(x, reference)| *x += reference);
        x
    }

    /// Positions as the tied terms take them: at rest, plus the unknowns; then the pressures.
    pub(super) fn untied(&self, u: &[f64]) -> Vec<Vec3> {
        assert_eq!(u.len(), self.unknowns());
        let (places, pressures) = u.split_at(3 * self.reference.len());
        let places = self.reference.iter().zip(places.as_chunks().0);
        let places = places.map(|(x, &u)| x + Vec3::from(u));
        places.chain(pressures.iter().map(|&q| Vec3::new(q, 0.0, 0.0))).collect()
    }

    /// Plans the tangent anew, with `room` (stencils) besides what the wall's elements couple.
    pub(super) fn plan(&mut self, room: &[Vec<u32>]) {
        let stencils = self.wall.stencils().iter().chain(room);
        self.assembler = Assembler::of_stencils(self.assembler.nodes(), stencils);
        let assembler = &self.assembler;
        self.wall_slots = assembler.slots(&self.wall);
        if let Some(chamber) = &self.chamber {
            self.chamber_slots = assembler.slots(chamber);
        }
        if let Some((moments, slots)) = &mut self.moments {
            *slots = assembler.slots(moments);
        }
        if let Some((followers, slots)) = &mut self.followers {
            *slots = assembler.slots(followers);
        }
        self.planes.plan(assembler);
        self.fold_slots = None;
        self.dirichlet = self.dirichlet.with_pattern(self.assembler.pattern());
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
        self.list_folds(u);
        if let (Some(contact), None, true) =
            (&self.folds.contact, &self.fold_slots, tangent.is_some())
        {
            self.fold_slots = Some(self.assembler.slots(contact.term()));
        }
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
        if let Some((followers, slots)) = &self.followers {
            add(followers, slots)?;
        }
        for (term, slots) in self.planes.terms() {
            energy += add(term, slots)?;
        }
        if let Some(contact) = &self.folds.contact {
            let none = Slots::default();
            energy += add(contact.term(), self.fold_slots.as_ref().unwrap_or(&none))?;
        }
        self.dirichlet.apply_to_residual(residual);
        if let Some(tangent) = tangent {
            self.dirichlet.apply_to_tangent(tangent);
        }
        Ok(energy)
    }
}

impl System for PartModel {
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
        for (term, _) in self.planes.terms() {
            energy += self.assembler.energy(term, &positions)?;
        }
        self.list_folds(u);
        if let Some(contact) = &self.folds.contact {
            energy += self.assembler.energy(contact.term(), &positions)?;
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
        let of_folds = self.longest_step_of_folds(u, du);
        if self.planes.is_empty() {
            return of_folds;
        }
        self.planes.longest_step(&self.displaced(u), &self.displacements(du)).min(of_folds)
    }

    fn force_scale(&self) -> f64 {
        self.force_scale
    }

    fn energy_rounding(&self) -> f64 {
        self.energy_rounding
    }

    fn make_room(&mut self, u: &[f64]) -> bool {
        self.make_room_for_folds(u)
    }

    fn multipliers(&self) -> Range<usize> {
        3 * self.reference.len()..self.unknowns()
    }

    fn layout(&self) -> Option<Layout> {
        let multipliers = match self.wall.inner() {
            Wall::Solid(body) => {
                let nodes = 0..self.multipliers().len() as u32;
                let complements = body.pressure_complements(nodes.len());
                nodes
                    .zip(complements)
                    .map(|(node, complement)| Multiplier { node, complement })
                    .collect()
            }
            Wall::Loop(_) | Wall::MidEdge(_) => Vec::new(),
        };
        Some(Layout { nodes: self.reference.clone(), multipliers })
    }

    fn set_share(&mut self, share: Option<&[bool]>) {
        self.assembler.set_share(share);
    }

    fn is_conservative(&self) -> bool {
        self.followers.is_none()
    }

    fn add_circulatory_tangent(&self, u: &[f64], v: &[f64], out: &mut [f64]) {
        let Some((followers, _)) = &self.followers else { return };
        let mut free = v.to_vec();
        self.dirichlet.apply_to_residual(&mut free);
        let moved = self.displacements(&free);
        let mut change = vec![Vec3::zeros(); moved.len()];
        followers.inner().add_circulation(&self.displaced(u), &moved, &mut change);
        self.ties.reduce(&mut change);
        for (free, change) in free.as_chunks_mut().0.iter_mut().zip(change) {
            *free = change.into();
        }
        self.dirichlet.apply_to_residual(&mut free);
        out.iter_mut().zip(free).for_each(|(out, change)| *out += change);
    }
}

impl LoadedSystem for PartModel {
    fn set_load(&mut self, load: f64) {
        self.load = load;
        if let Some(chamber) = &mut self.chamber {
            chamber.inner_mut().pressure = load * self.pressure;
        }
        if let Some((moments, _)) = &mut self.moments {
            moments.inner_mut().load_factor = load;
        }
        if let Some((followers, _)) = &mut self.followers {
            followers.inner_mut().load_factor = load;
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
        if let Some((followers, _)) = &self.followers {
            followers.inner().add_forces(&positions, &mut gradient);
        }
        self.ties.reduce(&mut gradient);
        for (gradient, force) in gradient.iter_mut().zip(&self.forces) {
            *gradient += force;
        }
        direction.fill(0.0);
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
        self.planes.settle(u, &positions)
    }

    fn refresh(&mut self, u: &[f64]) -> f64 {
        let positions = self.displaced(u);
        self.planes.refresh(&positions)
    }

    fn rewind(&mut self) {
        self.planes.rewind();
    }

    fn dissipates(&self) -> bool {
        self.planes.are_rough()
    }

    fn passed_limit(&self, u: &[f64]) -> Option<Limit> {
        let samples = self.surface.at(&self.displaced(u));
        let at = |sample| self.surface.samples[sample as usize].heaviest();
        let stretched = self.stretch_bound.passed(&samples).map(at);
        let ballooning = |node| Limit { kind: LimitKind::Ballooning, unknown: 3 * node as usize };
        stretched.map(ballooning).or_else(|| self.self_touch(u))
    }
}

#[cfg(test)]
mod tests;
