//! The planes of a scene: their terms, and what is read off them.

use std::hash::{DefaultHasher, Hash, Hasher};

use super::{Faces, Friction, PlaneContact, PlaneSettings};
use crate::math::Vec3;
use crate::model::PartModel;
use crate::model::assembly::{Assembler, Slots};
use crate::model::element::SampledSurface;
use crate::model::local::Term;
use crate::model::tie::{Tied, Ties};

/// The planes that a part may touch. `positions` are those of all nodes, ties included.
#[derive(Clone, Debug, Default)]
pub(in crate::model) struct Planes {
    planes: Vec<Plane>,
    lifted: bool,
}

#[derive(Clone, Debug)]
struct Plane {
    contact: Tied<PlaneContact>,
    contact_slots: Slots,
    friction: Option<(Tied<Friction>, Slots)>,
    /// Of each accepted state its key and the friction there, N: later the anchors are elsewhere.
    settled: Vec<(u64, Vec3)>,
}

/// How a part touches a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneState {
    /// The force with which the part presses on the plane, against its normal, N.
    pub force: Vec3,
    /// The force with which the part drags the plane along, in the plane, N.
    pub friction: Vec3,
    /// Centre of pressure in the plane, mm; none where the part does not touch it.
    pub centre: Option<Vec3>,
    /// Area at rest of the samples on which the barrier pushes, mm^2.
    pub area: f64,
    /// Area that would bear the force at a uniform pressure as its samples do, `(sum f)^2 / sum (f^2 / A)`, mm^2.
    pub bearing_area: f64,
    /// Smallest gap, mm.
    pub smallest_gap: f64,
}

impl Planes {
    /// The planes of `settings` before the wall with `faces` about `surface`, with nodes at `reference` at rest.
    pub(in crate::model) fn new(
        settings: &[PlaneSettings],
        surface: &SampledSurface,
        reference: &[Vec3],
        faces: Faces,
        ties: &Ties,
        assembler: &Assembler,
    ) -> Self {
        let plane = |settings: &PlaneSettings| {
            let contact = PlaneContact::new(surface, reference, faces, settings);
            let friction = (settings.friction > 0.0).then(|| {
                let slip = settings.elastic_slip * faces.thickness;
                let term = Friction::new(&contact, reference, settings.friction, slip);
                let term = Tied::new(term, ties, reference);
                let slots = assembler.slots(&term);
                (term, slots)
            });
            let contact = Tied::new(contact, ties, reference);
            let contact_slots = assembler.slots(&contact);
            Plane { contact, contact_slots, friction, settled: Vec::new() }
        };
        Self { planes: settings.iter().map(plane).collect(), lifted: false }
    }

    /// Finds the places of all terms in another pattern.
    pub(in crate::model) fn plan(&mut self, assembler: &Assembler) {
        for plane in &mut self.planes {
            plane.contact_slots = assembler.slots(&plane.contact);
            if let Some((friction, slots)) = &mut plane.friction {
                *slots = assembler.slots(friction);
            }
        }
    }

    /// Whether a plane in place has friction.
    pub(in crate::model) fn are_rough(&self) -> bool {
        self.in_place().any(|plane| plane.friction.is_some())
    }

    /// Takes the planes away, or puts them back; what held on to them lets go.
    pub(in crate::model) fn lift(&mut self, lifted: bool) {
        self.lifted = lifted;
        for (friction, _) in self.planes.iter_mut().filter_map(|plane| plane.friction.as_mut()) {
            friction.inner_mut().release();
        }
    }

    /// The terms of the planes in place.
    pub(in crate::model) fn terms(&self) -> impl Iterator<Item = (&dyn Term, &Slots)> {
        self.in_place().flat_map(|plane| {
            let contact: (&dyn Term, &Slots) = (&plane.contact, &plane.contact_slots);
            let friction = plane.friction.as_ref();
            let friction = friction.map(|(term, slots)| -> (&dyn Term, &Slots) { (term, slots) });
            [Some(contact), friction].into_iter().flatten()
        })
    }

    /// The barriers of the planes in place, over the displaced nodes themselves.
    pub(in crate::model) fn contacts(&self) -> impl Iterator<Item = &dyn Term> {
        self.in_place().map(|plane| -> &dyn Term { plane.contact.inner() })
    }

    /// Whether no plane is in place.
    pub(in crate::model) fn is_empty(&self) -> bool {
        self.in_place().len() == 0
    }

    /// The largest part of the displacement `dx` that leaves every sample on its side of the planes in place, at most 1.
    pub(in crate::model) fn longest_step(&self, positions: &[Vec3], dx: &[Vec3]) -> f64 {
        let steps = self.in_place().map(|plane| plane.contact.inner().longest_step(positions, dx));
        steps.fold(1.0, f64::min)
    }

    /// The smallest gap to a plane, lifted or not, mm; infinite without planes.
    pub(in crate::model) fn smallest_gap(&self, positions: &[Vec3]) -> f64 {
        let gaps = self.planes.iter().map(|plane| plane.contact.inner().smallest_gap(positions));
        gaps.fold(f64::INFINITY, f64::min)
    }

    /// Whether a plane, lifted or not, is near enough to push.
    pub(in crate::model) fn touch(&self, positions: &[Vec3]) -> bool {
        self.planes.iter().any(|plane| plane.contact.inner().touches(positions))
    }

    /// The sum of the sizes of the forces on the planes in place, N.
    pub(in crate::model) fn force(&self, positions: &[Vec3]) -> f64 {
        let forces = self.in_place().map(|plane| plane.contact.inner().force(positions));
        forces.fold(0.0, |sum, force| sum + force)
    }

    /// How the part with the unknowns `u` touches each plane in place; friction as it was where `u` was accepted, or else
    /// with the grips of now.
    pub(in crate::model) fn states(&self, u: &[f64], positions: &[Vec3]) -> Vec<PlaneState> {
        let key = key(u);
        self.in_place().map(|plane| plane.state(key, positions)).collect()
    }

    /// Adds what the planes in place do to each sample: its gap, mm, where it is smaller than before or that was none, and its
    /// pressure, MPa.
    pub(in crate::model) fn add_contact(
        &self,
        positions: &[Vec3],
        gaps: &mut [f64],
        pressures: &mut [f64],
    ) {
        for contact in self.in_place().map(|plane| plane.contact.inner()) {
            for s in contact.samples() {
                gaps[s] = contact.gap(s, positions).min(gaps[s]);
                let force = contact.normal_force(s, positions);
                if force > 0.0 {
                    pressures[s] += force / contact.area(s);
                }
            }
        }
    }

    /// Brings the normal forces of friction up to `positions`; returns the largest share by which a plane's changed.
    pub(in crate::model) fn refresh(&mut self, positions: &[Vec3]) -> f64 {
        let refresh = |(contact, friction): (&PlaneContact, &mut Friction)| {
            friction.refresh(contact, positions)
        };
        self.rough().map(refresh).fold(0.0, f64::max)
    }

    /// Takes the unknowns `u` as an accepted state; returns the energy that sliding gave off, mJ.
    pub(in crate::model) fn settle(&mut self, u: &[f64], positions: &[Vec3]) -> f64 {
        if self.lifted {
            return 0.0;
        }
        let mut heat = 0.0;
        for plane in &mut self.planes {
            if let Some((friction, _)) = &mut plane.friction {
                plane.settled.push((key(u), friction.inner().force(positions)));
                heat += friction.inner_mut().settle(plane.contact.inner(), positions);
            }
        }
        heat
    }

    /// Takes back what was refreshed since the last accepted state.
    pub(in crate::model) fn rewind(&mut self) {
        self.rough().for_each(|(_, friction)| friction.rewind());
    }

    /// Moves the first plane by `distance` towards the part, mm.
    #[cfg(test)]
    pub(in crate::model) fn raise(&mut self, distance: f64) {
        self.planes[0].contact.inner_mut().raise(distance);
    }

    fn in_place(&self) -> std::slice::Iter<'_, Plane> {
        let count = if self.lifted { 0 } else { self.planes.len() };
        self.planes[..count].iter()
    }

    /// The planes in place that have friction.
    fn rough(&mut self) -> impl Iterator<Item = (&PlaneContact, &mut Friction)> {
        let count = if self.lifted { 0 } else { self.planes.len() };
        self.planes[..count].iter_mut().filter_map(|plane| {
            let (friction, _) = plane.friction.as_mut()?;
            Some((plane.contact.inner(), friction.inner_mut()))
        })
    }
}

impl Plane {
    fn state(&self, key: u64, positions: &[Vec3]) -> PlaneState {
        let contact = self.contact.inner();
        let (mut force, mut moment, mut squares, mut area) = (0.0, Vec3::zeros(), 0.0, 0.0);
        for s in contact.samples() {
            let sample_force = contact.normal_force(s, positions);
            if sample_force > 0.0 {
                force += sample_force;
                moment += sample_force * contact.point(s, positions);
                squares += sample_force * sample_force / contact.area(s);
                area += contact.area(s);
            }
        }
        let friction = self.friction.as_ref().filter(|_| force > 0.0);
        let friction = friction.map_or(Vec3::zeros(), |(friction, _)| {
            let settled = self.settled.iter().rev().find(|(settled, _)| *settled == key);
            settled.map_or_else(|| friction.inner().force(positions), |(_, force)| *force)
        });
        PlaneState {
            force: -force * contact.normal(),
            friction,
            centre: (force > 0.0).then(|| contact.foot(moment / force)),
            area,
            bearing_area: if force > 0.0 { force * force / squares } else { 0.0 },
            smallest_gap: contact.smallest_gap(positions),
        }
    }
}

impl PartModel {
    /// Takes the planes of the scene away, or puts them back; only [`Self::smallest_gap`] and [`Self::touches_plane`] still
    /// see lifted planes.
    pub fn lift_planes(&mut self, lifted: bool) {
        self.planes.lift(lifted);
    }

    /// Of each plane of the scene the unit normal, pointing towards the part, and `normal . x` on it, mm.
    #[must_use]
    pub fn plane_places(&self) -> Vec<(Vec3, f64)> {
        let planes = self.planes.planes.iter().map(|plane| plane.contact.inner());
        planes.map(|contact| (contact.normal(), contact.offset())).collect()
    }

    /// The sum of the sizes of the forces with which the part presses on the planes of the scene, N.
    #[must_use]
    pub fn plane_force(&self, u: &[f64]) -> f64 {
        self.planes.force(&self.displaced(u))
    }

    /// How the part touches each plane of the scene; in a state that was settled the friction is that of then.
    #[must_use]
    pub fn plane_states(&self, u: &[f64]) -> Vec<PlaneState> {
        self.planes.states(u, &self.displaced(u))
    }

    /// The smallest gap to a plane of the scene, mm; infinite without planes.
    #[must_use]
    pub fn smallest_gap(&self, u: &[f64]) -> f64 {
        self.planes.smallest_gap(&self.displaced(u))
    }

    /// Whether a plane of the scene is near enough to push.
    #[must_use]
    pub fn touches_plane(&self, u: &[f64]) -> bool {
        self.planes.touch(&self.displaced(u))
    }
}

/// A number that tells states apart by their bits.
fn key(u: &[f64]) -> u64 {
    let mut hasher = DefaultHasher::new();
    u.iter().for_each(|u| u.to_bits().hash(&mut hasher));
    hasher.finish()
}
