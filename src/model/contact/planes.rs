//! What is read off the planes of a scene.

use super::plane_terms::PlaneTerms;
use super::{Friction, PlaneContact};
use crate::math::Vec3;
use crate::model::PartModel;
use crate::model::system::Memory;

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

impl PartModel {
    /// Takes the planes of the scene away, or puts them back; only [`Self::smallest_gap`] and [`Self::touches_plane`] still
    /// see lifted planes. What held on to them lets go.
    pub fn lift_planes(&mut self, lifted: bool) {
        for PlaneTerms { contact, friction } in &self.planes {
            self.terms[*contact].is_lifted = lifted;
            if let Some(friction) = friction {
                self.terms[*friction].is_lifted = lifted;
                self.terms[*friction].term_mut().release();
            }
        }
    }

    /// Of each plane of the scene the unit normal, pointing towards the part, and `normal . x` on it, mm.
    #[must_use]
    pub fn plane_places(&self) -> Vec<(Vec3, f64)> {
        self.contacts().map(|contact| (contact.normal(), contact.offset())).collect()
    }

    /// The sum of the sizes of the forces with which the part presses on the planes of the scene, N.
    #[must_use]
    pub fn plane_force(&self, u: &[f64]) -> f64 {
        let at = self.body.at(u);
        let forces = self.each::<PlaneContact>().map(|contact| contact.force(at.positions()));
        forces.fold(0.0, |sum, force| sum + force)
    }

    /// How the part touches each plane in place at the unknowns `u`; friction is that of the `memory` of an accepted state, and where
    /// there is none, that of now.
    #[must_use]
    pub fn plane_states(&self, u: &[f64], memory: &Memory) -> Vec<PlaneState> {
        let at = self.body.at(u);
        let in_place = self.planes.iter().filter(|plane| !self.terms[plane.contact].is_lifted);
        let state = |plane: &PlaneTerms| {
            let mut state = self.contact(plane).state(at.positions());
            if let (Some(place), true) = (plane.friction, state.centre.is_some()) {
                let accepted = Friction::accepted_force(memory.of_term(place));
                let now = || self.friction(place).force(at.positions());
                state.friction = accepted.unwrap_or_else(now);
            }
            state
        };
        in_place.map(state).collect()
    }

    /// The smallest gap to a plane of the scene, lifted or not, mm; infinite without planes.
    #[must_use]
    pub fn smallest_gap(&self, u: &[f64]) -> f64 {
        let at = self.body.at(u);
        let gaps = self.contacts().map(|contact| contact.smallest_gap(at.positions()));
        gaps.fold(f64::INFINITY, f64::min)
    }

    /// Whether a plane of the scene, lifted or not, is near enough to push.
    #[must_use]
    pub fn touches_plane(&self, u: &[f64]) -> bool {
        let at = self.body.at(u);
        self.contacts().any(|contact| contact.touches(at.positions()))
    }

    /// The barriers of all planes, lifted or not.
    fn contacts(&self) -> impl Iterator<Item = &PlaneContact> {
        self.planes.iter().map(|plane| self.contact(plane))
    }

    fn friction(&self, place: usize) -> &Friction {
        self.terms[place].as_kind().expect("it is friction")
    }

    fn contact(&self, plane: &PlaneTerms) -> &PlaneContact {
        self.terms[plane.contact].as_kind().expect("it is a contact")
    }
}

impl PlaneContact {
    /// How the part presses on the plane where the nodes are at `positions`, without friction.
    fn state(&self, positions: &[Vec3]) -> PlaneState {
        let (mut force, mut moment, mut squares, mut area) = (0.0, Vec3::zeros(), 0.0, 0.0);
        for s in self.samples() {
            let sample_force = self.normal_force(s, positions);
            if sample_force > 0.0 {
                force += sample_force;
                moment += sample_force * self.point(s, positions);
                squares += sample_force * sample_force / self.area(s);
                area += self.area(s);
            }
        }
        PlaneState {
            force: -force * self.normal(),
            friction: Vec3::zeros(),
            centre: (force > 0.0).then(|| self.foot(moment / force)),
            area,
            bearing_area: if force > 0.0 { force * force / squares } else { 0.0 },
            smallest_gap: self.smallest_gap(positions),
        }
    }

    /// Adds what the plane does to each sample: its gap, mm, where it is smaller than before or that was none, and its pressure, MPa.
    pub(in crate::model) fn add_contact(
        &self,
        positions: &[Vec3],
        gaps: &mut [f64],
        pressures: &mut [f64],
    ) {
        for s in self.samples() {
            gaps[s] = self.gap(s, positions).min(gaps[s]);
            let force = self.normal_force(s, positions);
            if force > 0.0 {
                pressures[s] += force / self.area(s);
            }
        }
    }
}
