//! Coulomb friction on a rigid plane, from a potential.
//!
//! ```text
//! slip     s_i = (I - n n^T) (x_i - anchor_i),   y = |s_i|
//! energy   sum_i mu N_i f(y)
//! f        y^2/e - y^3/(3 e^2)  for y < e,   y - e/3  beyond;      f' rises from 0 to 1, and f'' is continuous
//! ```
//!
//! The normal forces `N_i` lag: they are constant during a solve and follow by [`Friction::take_forces`], so that the energy
//! exists and its Hessian is symmetric. The slip is elastic up to `e` and plastic beyond: in an accepted state
//! ([`Friction::accept`]) the anchors of samples that slid are pulled along until their slip is `e`, whose force is the same.
//! What sticks keeps its anchor, so that it does not creep with the number of steps. A sample that touches down is anchored
//! where it met the barrier between the last accepted state and this one; one that lifts off loses its anchor.
//! It acts on the mid-surface, without the lever of half the thickness.
//! Sources: Li et al. (2020), smoothed and lagged friction of incremental potential contact, there with the slip of one
//! time step; the anchors are the return mapping of elastic-perfectly plastic slip, Wriggers (2006), section 5.2.

use nalgebra::Matrix3;

use super::PlaneContact;
use crate::math::Vec3;
use crate::model::body::Configuration;
use crate::model::local::{LocalDerivatives, Term};
use crate::model::part_term::PartTerm;
use crate::model::system::Inadmissible;

/// Friction between a shell's samples and the plane of a [`PlaneContact`].
#[derive(Clone, Debug)]
pub struct Friction {
    coefficient: f64,
    /// mm.
    elastic_slip: f64,
    contact: PlaneContact,
    /// Of each sample that touches, or did so since the last accepted state.
    grips: Vec<Option<Grip>>,
    /// As they were in the last accepted state.
    settled_grips: Vec<Option<Grip>>,
    /// The samples in the last accepted state, mm.
    settled_points: Vec<Vec3>,
    /// On the plane in the last accepted state, before its anchors were pulled along, N.
    settled_force: Vec3,
}

/// How a sample holds on to the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Grip {
    /// From where its slip is measured, mm.
    anchor: Vec3,
    /// The lagged normal force, N.
    normal_force: f64,
}

impl Friction {
    /// Friction with Coulomb's `coefficient` on the plane of `contact`, whose samples stand at rest at nodes `positions`;
    /// it is mobilised within a slip of `elastic_slip`, mm.
    ///
    /// # Panics
    /// When a number is not positive.
    #[must_use]
    pub fn new(
        contact: PlaneContact,
        positions: &[Vec3],
        coefficient: f64,
        elastic_slip: f64,
    ) -> Self {
        assert!(coefficient > 0.0 && elastic_slip > 0.0, "{coefficient} {elastic_slip}");
        let none = vec![None; contact.samples().len()];
        Self {
            coefficient,
            elastic_slip,
            grips: none.clone(),
            settled_grips: none,
            settled_points: contact.samples().map(|s| contact.point(s, positions)).collect(),
            settled_force: Vec3::zeros(),
            contact,
        }
    }

    /// Takes the normal forces where the nodes are at `positions`; returns by how much they changed, as a share of their sum.
    pub fn take_forces(&mut self, positions: &[Vec3]) -> f64 {
        let (mut change, mut sum) = (0.0, 0.0);
        for s in self.contact.samples() {
            let force = self.contact.normal_force(s, positions);
            let before = self.grips[s].map_or(0.0, |grip| grip.normal_force);
            change += (force - before).abs();
            sum += force.max(before);
            if force > 0.0 && self.grips[s].is_none() {
                let anchor = self.touchdown(s, positions);
                self.grips[s] = Some(Grip { anchor, normal_force: force });
            } else if let Some(grip) = &mut self.grips[s] {
                grip.normal_force = force;
            }
        }
        if sum > 0.0 { change / sum } else { 0.0 }
    }

    /// Takes `positions` as the accepted state: pulls the anchors along, lets go what has lifted off; returns the energy
    /// that sliding gave off since the last, mJ.
    pub fn accept(&mut self, positions: &[Vec3]) -> f64 {
        self.settled_force = self.force(positions);
        let mut heat = 0.0;
        for s in self.contact.samples() {
            let point = self.contact.point(s, positions);
            if let Some(grip) = &mut self.grips[s] {
                let slip = tangential(self.contact.normal(), point - grip.anchor);
                let slid = slip.norm() - self.elastic_slip;
                if slid > 0.0 {
                    // While it slid, the normal force went from the one value to the other.
                    let before = self.settled_grips[s].map_or(0.0, |grip| grip.normal_force);
                    heat += self.coefficient * 0.5 * (before + grip.normal_force) * slid;
                    grip.anchor += slid / slip.norm() * slip;
                }
            }
            let force = self.contact.normal_force(s, positions);
            let anchor = self.grips[s].map_or(point, |grip| grip.anchor);
            self.grips[s] = (force > 0.0).then_some(Grip { anchor, normal_force: force });
            self.settled_points[s] = point;
        }
        self.settled_grips.clone_from(&self.grips);
        heat
    }

    /// The force on the plane in the accepted state of which `memory` is what friction remembers, N; none of an empty one.
    pub(super) fn accepted_force(memory: &[f64]) -> Option<Vec3> {
        memory.first_chunk().map(|&force: &[f64; 3]| force.into())
    }

    /// Moves the plane by `distance` towards the part, mm.
    #[cfg(test)]
    pub(in crate::model) fn raise(&mut self, distance: f64) {
        self.contact.raise(distance);
    }

    /// The force with which the part drags the plane along, N.
    #[must_use]
    pub fn force(&self, positions: &[Vec3]) -> Vec3 {
        let sample_force = |s: usize| {
            let point = self.contact.point(s, positions);
            self.grips[s].map_or(Vec3::zeros(), |grip| {
                let slip = tangential(self.contact.normal(), point - grip.anchor);
                self.coefficient * grip.normal_force * self.force_per_slip(slip.norm()) * slip
            })
        };
        self.contact.samples().map(sample_force).sum()
    }

    /// Where sample `s`, now at `positions`, met the barrier since the last accepted state; there, if it did before.
    fn touchdown(&self, s: usize, positions: &[Vec3]) -> Vec3 {
        let contact = &self.contact;
        let (from, to) = (self.settled_points[s], contact.point(s, positions));
        let gap = contact.gap(s, positions);
        let approach = contact.normal().dot(&(from - to));
        let free = gap + approach - contact.activation(s);
        if free > 0.0 && approach > 0.0 {
            from + (free / approach).min(1.0) * (to - from)
        } else {
            from
        }
    }

    fn slip(&self, s: usize, x: &[Vec3], grip: &Grip) -> Vec3 {
        let weights = &self.contact.weights()[s];
        let point: Vec3 = weights.iter().zip(x).map(|(w, x)| *w * x).sum();
        tangential(self.contact.normal(), point - grip.anchor)
    }

    /// `f(y)`, mm.
    fn potential(&self, y: f64) -> f64 {
        let e = self.elastic_slip;
        if y < e { y * y / e - y.powi(3) / (3.0 * e * e) } else { y - e / 3.0 }
    }

    /// `f'(y) / y`, 1/mm.
    fn force_per_slip(&self, y: f64) -> f64 {
        let e = self.elastic_slip;
        if y < e { 2.0 / e - y / (e * e) } else { 1.0 / y }
    }

    /// `(f''(y) - f'(y) / y) / y^2`, which softens the direction of the slip; 1/mm^3.
    fn softening(&self, y: f64) -> f64 {
        let e = self.elastic_slip;
        if y == 0.0 {
            // It multiplies y^2.
            0.0
        } else if y < e {
            -1.0 / (e * e * y)
        } else {
            -1.0 / y.powi(3)
        }
    }
}

impl Term for Friction {
    fn stencils(&self) -> &[Vec<u32>] {
        self.contact.stencils()
    }

    fn is_active(&self, s: usize, _: &[Vec3]) -> bool {
        self.grips[s].is_some_and(|grip| grip.normal_force > 0.0)
    }

    fn energy(&self, s: usize, x: &[Vec3]) -> Result<f64, Inadmissible> {
        Ok(self.grips[s].map_or(0.0, |grip| {
            let slip = self.slip(s, x, &grip).norm();
            self.coefficient * grip.normal_force * self.potential(slip)
        }))
    }

    fn derivatives(
        &self,
        s: usize,
        x: &[Vec3],
        local: &mut LocalDerivatives,
    ) -> Result<f64, Inadmissible> {
        let Some(grip) = self.grips[s] else {
            return Ok(0.0);
        };
        let force = self.coefficient * grip.normal_force;
        let slip = self.slip(s, x, &grip);
        let y = slip.norm();
        let per_slip = force * self.force_per_slip(y);
        let normal = self.contact.normal();
        let projector = Matrix3::identity() - normal * normal.transpose();
        let hessian = per_slip * projector + force * self.softening(y) * slip * slip.transpose();
        local.add_of_point(&self.contact.weights()[s], per_slip * slip, &hessian);
        Ok(force * self.potential(y))
    }
}

/// Numbers that are remembered of each sample: its anchor and its normal force, which is 0 where it holds on to nothing.
const REMEMBERED: usize = 4;

impl PartTerm for Friction {
    fn boxed(&self) -> Box<dyn PartTerm> {
        Box::new(self.clone())
    }

    fn widens_pattern(&self) -> bool {
        false
    }

    fn refresh(&mut self, at: &Configuration<'_>) -> f64 {
        self.take_forces(at.positions())
    }

    fn settle(&mut self, at: &Configuration<'_>) -> f64 {
        self.accept(at.positions())
    }

    fn memory(&self) -> Vec<f64> {
        let of_grip = |grip: &Option<Grip>| {
            grip.map_or([0.0; REMEMBERED], |Grip { anchor, normal_force }| {
                [anchor.x, anchor.y, anchor.z, normal_force]
            })
        };
        let force: [f64; 3] = self.settled_force.into();
        force.into_iter().chain(self.settled_grips.iter().flat_map(of_grip)).collect()
    }

    fn recall(&mut self, at: &Configuration<'_>, memory: &[f64]) {
        let Some(force) = Self::accepted_force(memory) else {
            self.accept(at.positions());
            return;
        };
        self.settled_force = force;
        let grips = memory[3..].as_chunks::<REMEMBERED>().0.iter();
        self.settled_grips = grips
            .map(|&[x, y, z, normal_force]| {
                (normal_force > 0.0).then_some(Grip { anchor: Vec3::new(x, y, z), normal_force })
            })
            .collect();
        self.grips.clone_from(&self.settled_grips);
        let contact = &self.contact;
        self.settled_points = contact.samples().map(|s| contact.point(s, at.positions())).collect();
    }

    fn rewind(&mut self) {
        self.grips.clone_from(&self.settled_grips);
    }

    fn release(&mut self) {
        self.grips.fill(None);
        self.settled_grips.fill(None);
    }

    fn dissipates(&self) -> bool {
        true
    }

    /// It passes through no wall: a node that is held is dragged along by nothing else.
    fn acts_on_supports(&self) -> bool {
        false
    }
}

/// The part of `x` in the plane.
fn tangential(normal: Vec3, x: Vec3) -> Vec3 {
    x - normal.dot(&x) * normal
}

#[cfg(test)]
mod tests {
    use nalgebra::{Isometry3, Translation3, UnitQuaternion};

    use super::*;
    use crate::model::contact::{PlaneSettings, Samples};
    use crate::model::element::{Sample, SampledSurface};
    use crate::model::term_suite::{Case, term_suite};
    use crate::model::test_shells::TestShell;

    const NORMAL: Vec3 = Vec3::new(0.48, -0.6, 0.64);
    const MU: f64 = 0.4;

    /// Slips from 0.2 to 1.9 times the elastic one of 0.5 mm, in all directions and none near 0 or 1, where the third
    /// derivative jumps and differences are of lower order.
    fn gripping(shell: &TestShell) -> Case<Friction> {
        let settings = PlaneSettings::new(NORMAL, 1.0, 0.7);
        let contact =
            PlaneContact::new(&shell.surface(), &shell.reference, Samples::InMiddle, &settings);
        let mut term = Friction::new(contact.clone(), &shell.reference, MU, 0.5);
        let [along, across] = [Vec3::x(), Vec3::y()].map(|axis| NORMAL.cross(&axis).normalize());
        for s in contact.samples() {
            let share = [0.2, 0.6, 0.9, 1.2, 1.9][s % 5];
            let direction = ((s as f64).cos() * along + (s as f64).sin() * across).normalize();
            // What lies along the normal is no slip.
            let slip = share * 0.5 * direction + 0.3 * NORMAL;
            let anchor = contact.point(s, &shell.deformed) - slip;
            let normal_force = if s % 3 == 0 { 0.0 } else { 0.1 + s as f64 / 100.0 };
            term.grips[s] = (s % 7 != 0).then_some(Grip { anchor, normal_force });
        }
        let lift = Translation3::from(2.0 * NORMAL);
        let motion = Isometry3::from_parts(lift, UnitQuaternion::identity());
        Case { term, positions: shell.deformed.clone(), motion }
    }

    term_suite!(friction, gripping);

    const ELASTIC_SLIP: f64 = 1e-3;

    /// A facet of 3 mm^2 before a plane z = 0 at a distance of 0.1 mm; its corners are its samples.
    fn facet() -> (PlaneContact, Friction, Vec<Vec3>) {
        let samples = (0..3).map(|node| Sample { nodes: vec![node], weights: vec![1.0] }).collect();
        let surface = SampledSurface {
            samples,
            facets: vec![[0, 1, 2]],
            vertices: 3,
            thickness: vec![1.0; 3],
        };
        let positions = vec![Vec3::zeros(), Vec3::new(2.0, 0.0, 0.0), Vec3::new(0.0, 3.0, 0.0)];
        let settings = PlaneSettings::new(Vec3::z(), 0.1, 0.7);
        let contact = PlaneContact::new(&surface, &positions, Samples::InMiddle, &settings);
        let friction = Friction::new(contact.clone(), &positions, MU, ELASTIC_SLIP);
        (contact, friction, positions)
    }

    fn moved(positions: &[Vec3], by: Vec3) -> Vec<Vec3> {
        positions.iter().map(|x| x + by).collect()
    }

    /// Dragged to and fro under a constant force, friction is `mu N` against the motion, and its heat is `mu N` times the
    /// way less the elastic slip that is wound up: `e` on the first way, `2 e` at each reversal. All of it exactly,
    /// whatever the number of steps.
    #[test]
    fn dragged_to_and_fro_it_gives_off_its_force_times_the_way() {
        for steps in [1, 7, 100] {
            let (contact, mut friction, rest) = facet();
            // Straight down on the plane.
            let down = Vec3::new(0.0, 0.0, -0.1 + 0.5 * contact.activation(0));
            let direction = Vec3::new(0.6, -0.8, 0.0);
            let at = |way: f64| moved(&rest, down + way * direction);
            assert_eq!(friction.take_forces(&at(0.0)), 1.0);
            assert_eq!(friction.accept(&at(0.0)), 0.0);
            let limit = MU * contact.force(&at(0.0));
            let mut heat = 0.0;
            for (from, to) in [(0.0, 5.0), (5.0, -2.0), (-2.0, 1.0)] {
                let mut given = 0.0;
                for k in 1..=steps {
                    let x = at(from + (to - from) * f64::from(k) / f64::from(steps));
                    assert_eq!(friction.take_forces(&x), 0.0);
                    let force = friction.force(&x);
                    given += friction.accept(&x);
                    let along = f64::signum(to - from) * direction;
                    // Rounding of 5 mm in an elastic slip of 0.001 mm; in an accepted state it is the same.
                    assert!((force - limit * along).norm() < 1e-11 * limit, "{force}");
                    assert!((friction.force(&x) - force).norm() < 1e-11 * limit);
                }
                let wound = if from == 0.0 { ELASTIC_SLIP } else { 2.0 * ELASTIC_SLIP };
                let slid = f64::abs(to - from) - wound;
                assert!((given / (limit * slid) - 1.0).abs() < 1e-12, "{given}");
                heat += given;
            }
            // What is said of the regularisation: 5 elastic slips in 15 mm.
            assert!((heat / (limit * 15.0) - 1.0).abs() < 1e-3);
        }
    }

    /// Within the elastic slip nothing creeps, however often the state is accepted: the way back leads to where it came from.
    #[test]
    fn what_sticks_does_not_creep() {
        let (contact, mut friction, rest) = facet();
        let down = Vec3::new(0.0, 0.0, -0.1 + 0.5 * contact.activation(0));
        let at = |share: f64| moved(&rest, down + share * ELASTIC_SLIP * Vec3::x());
        friction.take_forces(&at(0.0));
        friction.accept(&at(0.0));
        for k in 0..1000 {
            let x = at(0.99 * f64::from(k % 2));
            friction.take_forces(&x);
            assert_eq!(friction.accept(&x), 0.0);
        }
        assert!(friction.force(&at(0.0)).norm() == 0.0);
        let half = friction.force(&at(0.5)).x / (MU * contact.force(&at(0.5)));
        // f'(e / 2) = 3/4.
        assert!((half - 0.75).abs() < 1e-12, "{half}");
    }

    /// A sample that comes down on a slant is anchored where it met the barrier; given up, it has no anchor; lifted off,
    /// neither.
    #[test]
    fn grips_begin_at_the_touchdown_and_end_with_the_contact() {
        let (contact, mut friction, rest) = facet();
        let h = contact.activation(0);
        // From a gap of 0.1 to half the activation, which is half of 0.1.
        assert_eq!(h, 0.05);
        let fall = 0.075;
        let x = moved(&rest, Vec3::new(3.0, 0.0, -fall));
        assert_eq!(friction.take_forces(&x), 1.0);
        let touchdown = 3.0 * (0.1 - h) / fall;
        for (grip, rest) in friction.grips.iter().zip(&rest) {
            assert!((grip.unwrap().anchor.x - rest.x - touchdown).abs() < 1e-12);
        }
        friction.rewind();
        assert!(friction.grips.iter().all(Option::is_none));
        friction.take_forces(&x);
        assert!(friction.accept(&x) > 0.0);
        assert!(friction.grips.iter().all(Option::is_some));
        let away = moved(&rest, Vec3::new(3.0, 0.0, -0.04));
        assert_eq!(friction.take_forces(&away), 1.0);
        friction.accept(&away);
        assert!(friction.grips.iter().all(Option::is_none));
        assert_eq!((friction.take_forces(&away), friction.force(&away)), (0.0, Vec3::zeros()));
    }
}
