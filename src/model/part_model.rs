//! The model of one part: a wall, of shells or of solid cells, the loads on it, and what it may touch.
//!
//! ```text
//! E(u) = W(u) - p V(u) - f . u - moments(u) + barriers(u) + friction(u)       u = displacement of the nodes
//! ```
//!
//! It is a list of terms ([`super::part_term`]): what a scene does not list is not assembled. Follower forces of an open patch have
//! no part in the energy: they act in the residual alone. The unknowns of solid cells are displacements and then pressures.

use std::ops::Range;

use super::assembly::{Assembler, Nodes};
use super::body::Body;
use super::contact::self_contact::{FoldWatch, WallContact};
use super::contact::{PlaneTerms, Samples};
use super::dirichlet::Dirichlet;
use super::discretization::{Discretization, Wall};
use super::element::{Sample, ascending};
use super::load::{ChamberPressure, DeadForces};
use super::material::Material;
use super::material_limits::MaterialLimits;
use super::part_setup::{FoldContact, PartSetup, Support};
use super::part_term::{PartTerm, Placed, in_place, in_place_mut};
use super::solid_loads::SolidLoads;
use super::stretch_bound::StretchBound;
use super::system::{
    Inadmissible, Layout, Limit, LoadedSystem, Memory, Multiplier, SparsityPattern, System,
    Utilization,
};
use crate::math::{Reason, Rejected, Room, Vec3};
use crate::mesh::{Location, ShellMesh, SolidMesh, quadratic_shapes};
use crate::surface::{MeshDefect, MidSurface};

/// The energy of a loaded part over the displacements of its nodes.
#[derive(Clone, Debug)]
pub struct PartModel {
    pub(super) body: Body,
    /// Loads, wall, contact, bounds, in the order in which they are summed.
    pub(super) terms: Vec<Placed>,
    pub(super) load: f64,
    pub(super) planes: Vec<PlaneTerms>,
    pub(super) fold_watch: FoldWatch,
    pub(super) assembler: Assembler,
    pub(super) dirichlet: Dirichlet,
    pub(super) force_scale: f64,
    /// Of each material, in the order of the list that the model was given.
    pub(super) limits: Vec<MaterialLimits>,
    energy_rounding: f64,
    /// Points whose displacements are shown.
    shown: Vec<Sample>,
}

/// The loads of a part, in the order in which they are summed.
#[derive(Default)]
pub(super) struct Loads {
    pub(super) dead: Option<DeadForces>,
    /// Terms over elements.
    pub(super) others: Vec<Box<dyn PartTerm>>,
}

impl PartModel {
    /// The wall of `mesh`, whose section names its materials by their places in `materials` (one alone is a list too), held by `support`,
    /// among what `setup` lists; its load is the pressure, MPa.
    ///
    /// # Errors
    /// [`Rejected`] when a fold is tighter than half the wall, or the limit surface cannot follow the mesh.
    pub fn new(
        mesh: &ShellMesh,
        materials: &(impl AsRef<[Material]> + ?Sized),
        support: &Support,
        setup: &PartSetup,
    ) -> Result<Self, Rejected> {
        let materials = materials.as_ref();
        let parts = Discretization::closed(mesh, materials)?;
        let held = match support {
            Support::Clamp => {
                let held = mesh.held_vertices();
                held.iter().flat_map(|v| [3 * v, 3 * v + 1, 3 * v + 2]).collect()
            }
            Support::Unknowns(unknowns) => unknowns.clone(),
        };
        let chamber = ChamberPressure::new(&parts.points);
        let loads = Loads { dead: None, others: vec![Box::new(chamber)] };
        let setup = PartSetup { folds: setup.folds.or(Some(FoldContact::Ends)), ..setup.clone() };
        Ok(Self::assembled(parts, loads, held, materials, Samples::InMiddle, &setup))
    }

    /// The solid wall of `mesh`, about `thickness` (mm) thick, whose cells name their materials by their places in `materials`, held and loaded by `loads`, among what `setup` lists;
    /// its load is the pressure in the chamber, MPa.
    ///
    /// What is shown are the corners of its boundary, unless `loads` says otherwise.
    ///
    /// # Errors
    /// [`Rejected`] when a cell is inverted at rest, the material has no law for solids, or a point that is to be shown lies far outside
    /// the body.
    pub fn of_solid(
        mesh: &SolidMesh,
        thickness: f64,
        materials: &(impl AsRef<[Material]> + ?Sized),
        loads: &SolidLoads<'_>,
        setup: &PartSetup,
    ) -> Result<Self, Rejected> {
        let materials = materials.as_ref();
        let parts = Discretization::solid(mesh, thickness, materials)?;
        let mut terms = Loads::default();
        if !loads.tractions.is_empty() {
            terms.dead = Some(DeadForces::new(loads.nodal_forces(mesh), &parts.ties));
        }
        if !mesh.chamber.is_empty() {
            terms.others.push(Box::new(loads.chamber(mesh)));
        }
        let held = loads.held.clone();
        let mut model = Self::assembled(parts, terms, held, materials, Samples::OnFace, setup);
        if let Some(points) = loads.shown {
            model.shown = samples_in(mesh, points)?;
        }
        Ok(model)
    }

    /// The model of `parts` under `loads`.
    pub(super) fn assembled(
        parts: Discretization,
        loads: Loads,
        mut held: Vec<u32>,
        materials: &[Material],
        lie: Samples,
        setup: &PartSetup,
    ) -> Self {
        let volumes = parts.node_volumes();
        let Discretization { reference, ties, surface, .. } = parts;
        let area = parts.areas.iter().sum::<f64>();
        let element_size = (area / parts.areas.len() as f64).sqrt();
        let body = Body { reference, ties, surface };
        let wall = Placed::new(parts.wall, &body);
        let nodes = Nodes { places: body.reference.len(), numbers: parts.pressures };
        let mut is_used = vec![false; nodes.count()];
        wall.tied().stencils().iter().flatten().for_each(|&v| is_used[v as usize] = true);
        held.extend(parts.held);
        let unused = (0..nodes.count()).filter(|&node| !is_used[node]);
        held.extend(unused.flat_map(|node| {
            nodes.first_unknown(node) as u32..nodes.first_unknown(node + 1) as u32
        }));
        let mut terms: Vec<Placed> = Vec::new();
        terms.extend(loads.dead.map(|dead| Placed::new(dead, &body)));
        if setup.body_force != Vec3::zeros() {
            let weights = volumes.iter().map(|volume| *volume * setup.body_force).collect();
            terms.push(Placed::new(DeadForces::weight(weights, &body.ties), &body));
        }
        terms.push(wall);
        terms.extend(loads.others.into_iter().map(|term| Placed::of_boxed(term, &body)));
        let planes =
            setup.planes.iter().map(|plane| PlaneTerms::add(plane, lie, &body, &mut terms));
        let planes = planes.collect();
        let fold_watch = FoldWatch::new(parts.points);
        terms.push(Placed::new(StretchBound::new(&body, setup.stretch_bound), &body));
        match setup.folds {
            None | Some(FoldContact::Unseen) => {}
            Some(FoldContact::Ends) => terms.push(Placed::new(fold_watch.clone(), &body)),
            Some(FoldContact::Barrier(settings)) => {
                let contact = WallContact::of_folds(&fold_watch, &body, settings);
                terms.push(Placed::new(contact, &body));
            }
        }
        let stencils = terms.iter().flat_map(Placed::pattern_stencils);
        let assembler = Assembler::of_stencils(nodes, stencils);
        let (stiffest, thickest) = (Material::stiffest(materials), body.surface.thickest());
        Self {
            load: 0.0,
            limits: setup.limits.clone(),
            planes,
            fold_watch,
            dirichlet: Dirichlet::new(assembler.pattern(), held),
            force_scale: stiffest.shear_modulus() * thickest * element_size,
            // Invariants of an undeformed wall carry a rounding of 1e-16 each, of either sign.
            energy_rounding: 1e-17 * stiffest.young_modulus() * thickest * area,
            shown: body.surface.samples[..body.surface.vertices].to_vec(),
            body,
            terms,
            assembler,
        }
    }

    /// The terms of one kind that are in place.
    pub(super) fn each<T: PartTerm>(&self) -> impl Iterator<Item = &T> {
        self.terms.iter().filter(|placed| !placed.is_lifted).filter_map(Placed::as_kind)
    }

    /// The wall.
    pub(super) fn wall(&self) -> &Wall {
        self.each().next().expect("a part has a wall")
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
        let at = self.body.at(u);
        self.each::<ChamberPressure>()
            .fold(0.0, |sum, chamber| sum + chamber.volume(at.positions()))
    }

    /// Where the unknown `unknown` acts, at displacement `u`: the position of its node, mm.
    #[must_use]
    pub fn place_of(&self, unknown: usize, u: &[f64]) -> Vec3 {
        let node = unknown / 3;
        let nodes = self.body.reference.len();
        let corner = || unknown - 3 * nodes;
        self.body.displaced(u)[if node < nodes { node } else { corner() }]
    }

    /// Extent at rest along x, y and z of the surface that carries pressure and contact, mm.
    #[must_use]
    pub fn rest_size(&self) -> Vec3 {
        let points = self.body.surface.at(&self.body.reference);
        let low = points.iter().fold(Vec3::repeat(f64::INFINITY), |low, x| low.inf(x));
        let high = points.iter().fold(Vec3::repeat(f64::NEG_INFINITY), |high, x| high.sup(x));
        high - low
    }

    /// The surface at rest that carries pressure and contact, in facets of about `edge` (mm), as the middle of the wall: of a Loop shell
    /// its limit surface, of quadratic pieces. The facets of each triangle of the mesh follow each other.
    ///
    /// # Errors
    /// [`MeshDefect`] unless the surface is closed.
    pub fn mid_surface(&self, edge: f64) -> Result<MidSurface, MeshDefect> {
        let Body { reference, surface, .. } = &self.body;
        let (coarse, _) = surface.quadratic(reference, 1);
        let mean = (coarse.area() / (0.433 * coarse.triangles.len() as f64)).sqrt();
        let n = (mean / edge).ceil().max(2.0) as usize;
        let (fine, thickness) = surface.quadratic(reference, n);
        MidSurface::new(fine, &thickness)
    }

    /// The share of the wall whose bending is softened because it folds tighter than its thickness allows.
    #[must_use]
    pub fn creased_share(&self) -> f64 {
        self.wall().creased_share()
    }

    /// Displacements of the mesh's vertices, or of what a solid shows, mm.
    #[must_use]
    pub fn vertex_displacements(&self, u: &[f64]) -> Vec<Vec3> {
        let u = self.body.displacements(u);
        self.shown.iter().map(|sample| sample.point(&u)).collect()
    }

    /// Plans the tangent anew, with the room that terms want.
    fn plan(&mut self) {
        let stencils = self.terms.iter().flat_map(Placed::pattern_stencils);
        self.assembler = Assembler::of_stencils(self.assembler.nodes(), stencils);
        self.terms.iter_mut().for_each(Placed::forget_slots);
        self.dirichlet = self.dirichlet.with_pattern(self.assembler.pattern());
    }

    /// Brings the stencils of all terms up to the state `u`.
    pub(super) fn prepare(&mut self, u: &[f64]) {
        let at = self.body.at(u);
        self.terms.iter_mut().for_each(|placed| placed.prepare(&at));
    }

    fn assemble(
        &mut self,
        u: &[f64],
        residual: &mut [f64],
        mut tangent: Option<&mut [f64]>,
    ) -> Result<f64, Inadmissible> {
        assert_eq!(u.len(), self.unknowns());
        self.prepare(u);
        let Self { body, terms, assembler, dirichlet, .. } = self;
        let (at, positions) = (body.at(u), body.untied(u));
        residual.fill(0.0);
        if let Some(tangent) = tangent.as_deref_mut() {
            tangent.fill(0.0);
        }
        let mut energy = 0.0;
        for alike in terms.chunk_by_mut(|one, next| next.is_alike(one)) {
            let tangent = tangent.as_deref_mut();
            energy += Placed::assemble(alike, assembler, &positions, residual, tangent)?;
        }
        for placed in terms.iter().filter(|placed| !placed.is_lifted) {
            let Some(dead) = placed.as_kind::<DeadForces>() else { continue };
            energy += placed.term().whole_energy(&at).unwrap_or_default();
            let forces = dead.on_unknowns().iter();
            for (residual, force) in residual.as_chunks_mut().0.iter_mut().zip(forces) {
                *residual = (Vec3::from(*residual) - dead.load_factor * force).into();
            }
        }
        dirichlet.apply_to_residual(residual);
        if let Some(tangent) = tangent {
            dirichlet.apply_to_tangent(tangent);
        }
        Ok(energy)
    }
}

/// The points (mm, at rest) as samples of the nodes of `mesh`.
fn samples_in(mesh: &SolidMesh, points: &[Vec3]) -> Result<Vec<Sample>, Rejected> {
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
    mesh.locate(points).into_iter().zip(points).map(sample).collect()
}

impl System for PartModel {
    fn pattern(&self) -> &SparsityPattern {
        self.assembler.pattern()
    }

    fn energy(&mut self, u: &[f64]) -> Result<f64, Inadmissible> {
        assert_eq!(u.len(), self.unknowns());
        self.prepare(u);
        let Self { body, terms, assembler, .. } = self;
        let (at, positions) = (body.at(u), body.untied(u));
        let mut energy = 0.0;
        for placed in terms.iter().filter(|placed| !placed.is_lifted) {
            let whole = placed.term().whole_energy(&at);
            energy += whole.map_or_else(|| assembler.energy(placed.tied(), &positions), Ok)?;
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
        let (from, step) = (self.body.at(u), self.body.at(du));
        in_place(&self.terms).map(|term| term.longest_step(&from, &step)).fold(1.0, f64::min)
    }

    fn force_scale(&self) -> f64 {
        self.force_scale
    }

    fn energy_rounding(&self) -> f64 {
        self.energy_rounding
    }

    fn make_room(&mut self, u: &[f64]) -> bool {
        self.prepare(u);
        let mut is_changed = false;
        for placed in &mut self.terms {
            is_changed |= placed.make_room(&self.body);
        }
        if is_changed {
            self.plan();
        }
        is_changed
    }

    fn multipliers(&self) -> Range<usize> {
        3 * self.body.reference.len()..self.unknowns()
    }

    fn layout(&self) -> Option<Layout> {
        let multipliers = match self.wall() {
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
        Some(Layout { nodes: self.body.reference.clone(), multipliers })
    }

    fn set_share(&mut self, share: Option<&[bool]>) {
        self.assembler.set_share(share);
    }

    fn is_conservative(&self) -> bool {
        in_place(&self.terms).all(PartTerm::has_potential)
    }

    fn add_circulatory_tangent(&self, u: &[f64], v: &[f64], out: &mut [f64]) {
        if self.is_conservative() {
            return;
        }
        let mut free = v.to_vec();
        self.dirichlet.apply_to_residual(&mut free);
        let moved = self.body.displacements(&free);
        let mut change = vec![Vec3::zeros(); moved.len()];
        let at = self.body.at(u);
        in_place(&self.terms).for_each(|term| term.add_circulation(&at, &moved, &mut change));
        self.body.ties.reduce(&mut change);
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
        self.terms.iter_mut().for_each(|placed| placed.term_mut().set_load(load));
    }

    fn conjugate(&self, u: &[f64]) -> f64 {
        let at = self.body.at(u);
        in_place(&self.terms).fold(0.0, |sum, term| sum + term.conjugate(&at))
    }

    fn load_direction(&self, u: &[f64], direction: &mut [f64]) {
        let at = self.body.at(u);
        let mut forces = vec![Vec3::zeros(); self.body.reference.len()];
        in_place(&self.terms).for_each(|term| term.add_load_direction(&at, &mut forces));
        self.body.ties.reduce(&mut forces);
        for dead in self.each::<DeadForces>().filter(|dead| dead.is_load()) {
            forces.iter_mut().zip(dead.on_unknowns()).for_each(|(sum, force)| *sum += force);
        }
        direction.fill(0.0);
        for (out, force) in direction.as_chunks_mut().0.iter_mut().zip(forces) {
            *out = force.into();
        }
        self.dirichlet.apply_to_residual(direction);
    }

    fn settle(&mut self, u: &[f64]) -> f64 {
        let at = self.body.at(u);
        in_place_mut(&mut self.terms).fold(0.0, |heat, term| heat + term.settle(&at))
    }

    fn memory(&self) -> Memory {
        let of_term = |placed: &Placed| {
            if placed.is_lifted { Vec::new() } else { placed.term().memory() }
        };
        Memory::of(self.terms.iter().map(of_term))
    }

    fn recall(&mut self, u: &[f64], memory: &Memory) {
        let at = self.body.at(u);
        for (term, placed) in self.terms.iter_mut().enumerate().filter(|(_, one)| !one.is_lifted) {
            placed.term_mut().recall(&at, memory.of_term(term));
        }
    }

    fn refresh(&mut self, u: &[f64]) -> f64 {
        let at = self.body.at(u);
        in_place_mut(&mut self.terms).map(|term| term.refresh(&at)).fold(0.0, f64::max)
    }

    fn rewind(&mut self) {
        in_place_mut(&mut self.terms).for_each(PartTerm::rewind);
    }

    fn dissipates(&self) -> bool {
        in_place(&self.terms).any(PartTerm::dissipates)
    }

    fn passed_limit(&self, u: &[f64]) -> Option<Limit> {
        let at = self.body.at(u);
        in_place(&self.terms).find_map(|term| term.passed_limit(&at))
    }

    fn utilization(&self, u: &[f64]) -> Option<Utilization> {
        let used = self.used_limit(u)?;
        Some(Utilization { share: used.share, unknown: 3 * used.node as usize })
    }
}

#[cfg(test)]
mod tests;
