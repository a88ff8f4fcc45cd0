//! Frictionless contact of the wall with a rigid plane, by a barrier.
//!
//! ```text
//! gap      d_i = n . x_i - floor_i
//! energy   sum_i A_i kappa_i b(d_i; h_i),   b(d; h) = -(d - h)^2 ln(d / h)  for 0 < d < h,  0 beyond
//! floor_i  = offset + t/2, but at most  n . x_i at rest - 2 t / 1000
//! h_i      = min(t / 10, d_i at rest / 2)          kappa_i h_i (ln 2 + 1/2) = 10 pressure
//! ```
//!
//! The barrier is infinite at zero gap, so no sample passes its floor; it pushes when the gap is below the activation
//! `h_i`, which is the error of the contact's position, and at half of it carries ten times the pressure that is
//! expected. At rest no sample is nearer than twice its activation, so that nothing pushes there, however near the plane
//! stands. What is nearer than 2 t / 1000 counts as that far: a barrier of less reach would be so steep that the rounding of
//! positions shows in its force.
//! Samples are the limit points of vertices and edge midpoints, weighted by their share of the reference area, so that
//! the contact pressure does not depend on the mesh. The face that looks at the plane, of an open wall the one or the
//! other, lies half the thickness at rest before the mid-surface; where the wall is inclined that is its rounded edge.
//! Source: Li et al. (2020), barrier of incremental potential contact. Friction is [`super::Friction`]'s.

use std::f64::consts::LN_2;

use nalgebra::Matrix3;

use crate::math::Vec3;
use crate::model::body::Configuration;
use crate::model::element::SampledSurface;
use crate::model::local::{LocalDerivatives, Term};
use crate::model::part_term::PartTerm;
use crate::model::system::Inadmissible;

/// Where the barrier begins at most, in thicknesses.
const ACTIVATION: f64 = 0.1;

/// Where the barrier begins at most, as a share of the gap at rest.
const SHARE_OF_REST_GAP: f64 = 0.5;

/// The least gap at rest, in thicknesses.
const LEAST_REST_GAP: f64 = 2e-3;

/// Pressure of the barrier at half its activation, as a multiple of what is expected.
const PRESSURE_MULTIPLE: f64 = 10.0;

/// The share of its gap that a sample may use up in one step.
const STEP_SHARE: f64 = 0.9;

/// A rigid plane; the part stays on the side to which the normal points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneSettings {
    /// Unit normal, pointing towards the part.
    pub normal: Vec3,
    /// Distance from the outermost point of the wall's face at rest, mm.
    pub distance: f64,
    /// The contact pressure that is expected, MPa; it sets the barrier's stiffness.
    pub pressure: f64,
    /// Coulomb's coefficient; at 0 no friction is computed.
    pub friction: f64,
    /// Elastic slip before friction is fully mobilised, in thicknesses.
    pub elastic_slip: f64,
}

impl PlaneSettings {
    /// A plane `distance` (mm) before the part with its barrier fit for `pressure` (MPa), without friction.
    #[must_use]
    pub fn new(normal: Vec3, distance: f64, pressure: f64) -> Self {
        Self { normal, distance, pressure, friction: 0.0, elastic_slip: 1e-3 }
    }
}

/// Where the samples of a wall's surface lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Samples {
    /// In the middle of the wall; its face is half the thickness beyond.
    InMiddle,
    /// On its face.
    OnFace,
}

/// The barrier between a wall's face and a rigid plane.
#[derive(Clone, Debug)]
pub struct PlaneContact {
    normal: Vec3,
    /// `normal . x` on the plane, mm.
    offset: f64,
    nodes: Vec<Vec<u32>>,
    weights: Vec<Vec<f64>>,
    /// Of each sample its share of the surface at rest, mm^2.
    areas: Vec<f64>,
    /// Of each sample `normal . x` where its gap is zero, mm.
    floors: Vec<f64>,
    /// Of each sample the gap at which the barrier begins to push, mm.
    activations: Vec<f64>,
    pressure: f64,
}

impl PlaneContact {
    /// The barrier for the wall whose `surface` has samples that lie as `lie` says, with nodes at `positions` at rest.
    ///
    /// # Panics
    /// When distance or pressure is not positive.
    #[must_use]
    pub fn new(
        surface: &SampledSurface,
        positions: &[Vec3],
        lie: Samples,
        settings: &PlaneSettings,
    ) -> Self {
        let &PlaneSettings { normal, distance, pressure, .. } = settings;
        assert!(distance > 0.0 && pressure > 0.0, "{settings:?}");
        let at_rest = surface.at(positions);
        let mut areas = vec![0.0; at_rest.len()];
        for facet in &surface.facets {
            let [a, b, c] = facet.map(|v| at_rest[v as usize]);
            let area = (b - a).cross(&(c - a)).norm() / 2.0;
            for v in facet {
                areas[*v as usize] += area / 3.0;
            }
        }
        let beyond = |thickness: f64| match lie {
            Samples::InMiddle => 0.5 * thickness,
            Samples::OnFace => 0.0,
        };
        // Each sample is lowered to where the face of the thickest wall would be as high as its own.
        let farthest = beyond(surface.thickest());
        let heights: Vec<f64> = (at_rest.iter().zip(&surface.thickness))
            .map(|(x, &thickness)| normal.dot(x) + (farthest - beyond(thickness)))
            .collect();
        let lowest = heights.iter().copied().fold(f64::INFINITY, f64::min);
        let offset = lowest - farthest - distance;
        let (mut floors, mut activations) = (Vec::new(), Vec::new());
        for (height, &thickness) in heights.iter().zip(&surface.thickness) {
            let floor = (lowest - distance).min(height - LEAST_REST_GAP * thickness);
            activations.push((ACTIVATION * thickness).min(SHARE_OF_REST_GAP * (height - floor)));
            floors.push(floor - (farthest - beyond(thickness)));
        }
        let samples = surface.samples.iter().map(|s| (s.nodes.clone(), s.weights.clone()));
        let (nodes, weights) = samples.unzip();
        Self { normal, offset, nodes, weights, areas, floors, activations, pressure }
    }

    /// Unit normal, pointing towards the part.
    #[must_use]
    pub fn normal(&self) -> Vec3 {
        self.normal
    }

    /// `normal . x` on the plane, mm.
    #[must_use]
    pub fn offset(&self) -> f64 {
        self.offset
    }

    /// The smallest gap between face and plane, mm.
    #[must_use]
    pub fn smallest_gap(&self, positions: &[Vec3]) -> f64 {
        self.samples().map(|s| self.gap(s, positions)).fold(f64::INFINITY, f64::min)
    }

    /// Whether the barrier pushes on a sample.
    #[must_use]
    pub fn touches(&self, positions: &[Vec3]) -> bool {
        self.samples().any(|s| self.is_active(s, positions))
    }

    /// The size of the force with which the part presses on the plane, N.
    #[must_use]
    pub fn force(&self, positions: &[Vec3]) -> f64 {
        self.samples().map(|s| self.normal_force(s, positions)).fold(0.0, |sum, force| sum + force)
    }

    /// The largest part of the displacement `dx` that leaves every sample on its side of the plane, at most 1.
    #[must_use]
    pub fn longest_part(&self, positions: &[Vec3], dx: &[Vec3]) -> f64 {
        let sample_step = |s: usize| {
            let approach = -self.height(s, dx);
            let gap = self.gap(s, positions);
            if approach > STEP_SHARE * gap { STEP_SHARE * gap / approach } else { 1.0 }
        };
        self.samples().map(sample_step).fold(1.0, f64::min)
    }

    /// The samples' numbers.
    pub(super) fn samples(&self) -> std::ops::Range<usize> {
        0..self.nodes.len()
    }

    /// For each sample the nodes and their weights.
    pub(super) fn weights(&self) -> &[Vec<f64>] {
        &self.weights
    }

    /// Reference area of sample `s`, mm^2.
    pub(super) fn area(&self, s: usize) -> f64 {
        self.areas[s]
    }

    /// The place of sample `s` on the mid-surface, mm.
    pub(super) fn point(&self, s: usize, positions: &[Vec3]) -> Vec3 {
        let nodes = self.nodes[s].iter().zip(&self.weights[s]);
        nodes.map(|(&v, w)| *w * positions[v as usize]).sum()
    }

    /// The point of the plane nearest to `x`, mm.
    pub(super) fn foot(&self, x: Vec3) -> Vec3 {
        x - (self.normal.dot(&x) - self.offset) * self.normal
    }

    /// The gap between sample `s` and the plane, mm.
    pub(super) fn gap(&self, s: usize, positions: &[Vec3]) -> f64 {
        self.height(s, positions) - self.floors[s]
    }

    /// The gap at which the barrier begins to push on sample `s`, mm.
    pub(super) fn activation(&self, s: usize) -> f64 {
        self.activations[s]
    }

    /// The size of the force with which sample `s` presses on the plane, N.
    pub(super) fn normal_force(&self, s: usize, positions: &[Vec3]) -> f64 {
        let gap = self.gap(s, positions);
        if gap < self.activations[s] { -self.barrier(s, gap)[1] } else { 0.0 }
    }

    /// Moves the plane by `distance` towards the part, mm.
    #[cfg(test)]
    pub(in crate::model) fn raise(&mut self, distance: f64) {
        self.offset += distance;
        self.floors.iter_mut().for_each(|floor| *floor += distance);
    }

    fn height(&self, s: usize, x: &[Vec3]) -> f64 {
        let nodes = self.nodes[s].iter().zip(&self.weights[s]);
        nodes.map(|(&v, w)| w * self.normal.dot(&x[v as usize])).sum()
    }

    fn local_gap(&self, s: usize, x: &[Vec3]) -> Result<f64, Inadmissible> {
        let height: f64 = self.weights[s].iter().zip(x).map(|(w, x)| w * self.normal.dot(x)).sum();
        let gap = height - self.floors[s];
        if gap > 0.0 { Ok(gap) } else { Err(Inadmissible("a wall lies behind the plane")) }
    }

    /// The barrier of sample `s` with its first and second derivative at a gap below the activation.
    fn barrier(&self, s: usize, gap: f64) -> [f64; 3] {
        let h = self.activations[s];
        // -b'(h / 2) = (ln 2 + 1/2) h.
        let stiffness = PRESSURE_MULTIPLE * self.pressure / ((LN_2 + 0.5) * h);
        let weight = self.areas[s] * stiffness;
        let ln = (gap / h).ln();
        let below = gap - h;
        [
            -below * below * ln,
            -2.0 * below * ln - below * below / gap,
            -2.0 * ln - 4.0 * below / gap + below * below / (gap * gap),
        ]
        .map(|b| weight * b)
    }
}

impl Term for PlaneContact {
    fn stencils(&self) -> &[Vec<u32>] {
        &self.nodes
    }

    fn is_active(&self, s: usize, positions: &[Vec3]) -> bool {
        self.gap(s, positions) < self.activations[s]
    }

    fn energy(&self, s: usize, x: &[Vec3]) -> Result<f64, Inadmissible> {
        let gap = self.local_gap(s, x)?;
        Ok(if gap < self.activations[s] { self.barrier(s, gap)[0] } else { 0.0 })
    }

    fn derivatives(
        &self,
        s: usize,
        x: &[Vec3],
        local: &mut LocalDerivatives,
    ) -> Result<f64, Inadmissible> {
        let gap = self.local_gap(s, x)?;
        if gap >= self.activations[s] {
            return Ok(0.0);
        }
        let [value, slope, curvature] = self.barrier(s, gap);
        let nn: Matrix3<f64> = curvature * self.normal * self.normal.transpose();
        local.add_of_point(&self.weights[s], slope * self.normal, &nn);
        Ok(value)
    }
}

impl PartTerm for PlaneContact {
    fn boxed(&self) -> Box<dyn PartTerm> {
        Box::new(self.clone())
    }

    fn widens_pattern(&self) -> bool {
        false
    }

    fn longest_step(&self, from: &Configuration<'_>, step: &Configuration<'_>) -> f64 {
        self.longest_part(from.positions(), step.displacements())
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Isometry3, Translation3, Unit, UnitQuaternion};
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::model::term_suite::{Case, term_suite};
    use crate::model::test_shells::{TestShell, difference, random_matrix};

    const NORMAL: Vec3 = Vec3::new(0.48, -0.6, 0.64);
    /// Of all samples whose distance at rest is twice as much; the wall is 0.8 mm thick.
    const LARGEST_ACTIVATION: f64 = 0.08;

    fn contact(shell: &TestShell, distance: f64) -> PlaneContact {
        let settings = PlaneSettings::new(NORMAL, distance, 0.7);
        PlaneContact::new(&shell.surface(), &shell.reference, Samples::InMiddle, &settings)
    }

    /// A tilted plane so near to the deformed shell that the closest sample has a gap of 0.4 mm and many are below the
    /// activation, which is made large for that.
    fn touching(shell: &TestShell) -> Case<PlaneContact> {
        let mut term = contact(shell, 1.0);
        term.activations.fill(4.0);
        term.raise(term.smallest_gap(&shell.deformed) - 0.4);
        // In the plane, and about its normal.
        let rotation = UnitQuaternion::from_axis_angle(&Unit::new_normalize(NORMAL), 0.8);
        let slide = Translation3::from(NORMAL.cross(&Vec3::new(2.0, 5.0, -1.0)));
        let motion = Isometry3::from_parts(slide, rotation);
        Case { term, positions: shell.deformed.clone(), motion }
    }

    term_suite!(plane, touching);

    fn energy(contact: &PlaneContact, positions: &[Vec3]) -> f64 {
        let stencil_energy = |(s, nodes): (usize, &Vec<u32>)| {
            let x: Vec<Vec3> = nodes.iter().map(|&v| positions[v as usize]).collect();
            contact.energy(s, &x).unwrap()
        };
        contact.nodes.iter().enumerate().map(stencil_energy).sum()
    }

    /// `b` and its first two derivatives vanish at the activation, as `e^3`, `e^2` and `e` at a share `e` below it.
    #[test]
    fn barrier_starts_smoothly() {
        let contact = touching(&TestShell::new(0)).term;
        let h = contact.activation(0);
        let weight = contact.area(0) * 10.0 * 0.7 / ((LN_2 + 0.5) * h);
        for share in [1e-3, 1e-4, 1e-5] {
            let [value, slope, curvature] = contact.barrier(0, h * (1.0 - share));
            // -(h e)^2 ln(1 - e) to leading order; what is left out is of relative size 2 e.
            let close =
                |value: f64, leading: f64| (value / (weight * leading) - 1.0).abs() < 2.0 * share;
            assert!(close(value, share.powi(3) * h * h), "{value}");
            assert!(close(slope, -3.0 * share * share * h), "{slope}");
            assert!(close(curvature, 6.0 * share), "{curvature}");
        }
    }

    /// Half the activation carries ten times the pressure.
    #[test]
    fn barrier_is_fit_for_the_pressure() {
        let contact = touching(&TestShell::new(0)).term;
        let pressure = -contact.barrier(3, 0.5 * contact.activation(3))[1] / contact.area(3);
        assert!((pressure / 7.0 - 1.0).abs() < 1e-14, "{pressure}");
    }

    /// However near the plane stands, no sample pushes at rest; far ones have the whole activation.
    #[test]
    fn nothing_pushes_at_rest() {
        let shell = TestShell::new(5);
        for distance in [1e-6, 1e-2, 10.0] {
            let contact = contact(&shell, distance);
            // Rounding of coordinates of 10 mm; the wall is 0.8 mm thick.
            let gap = contact.smallest_gap(&shell.reference);
            assert!((gap - f64::max(distance, 0.0016)).abs() < 1e-14, "{gap}");
            assert!(!contact.touches(&shell.reference));
            for s in contact.samples() {
                let (gap, h) = (contact.gap(s, &shell.reference), contact.activation(s));
                assert!((h - LARGEST_ACTIVATION.min(0.5 * gap)).abs() < 1e-14);
            }
        }
    }

    /// Raising the plane by `s` costs `force * s`; the wall is pushed along the normal with that force.
    #[test]
    fn force_is_what_raising_the_plane_costs() {
        let case = touching(&TestShell::new(1));
        let force = case.term.force(&case.positions);
        let slope = difference(1e-3, |s| {
            let mut raised = case.term.clone();
            raised.raise(s);
            energy(&raised, &case.positions)
        });
        // (step / gap)^4 = 4e-11.
        assert!((force / slope - 1.0).abs() < 1e-9, "{force} {slope}");
        let lifted = difference(1e-3, |s| {
            let lifted: Vec<Vec3> = case.positions.iter().map(|x| x + s * NORMAL).collect();
            energy(&case.term, &lifted)
        });
        assert!((force / lifted + 1.0).abs() < 1e-9, "{force} {lifted}");
    }

    #[test]
    fn far_plane_does_nothing() {
        let shell = TestShell::new(2);
        let mut far = contact(&shell, 1.0);
        far.raise(far.smallest_gap(&shell.deformed) - LARGEST_ACTIVATION - 1e-9);
        assert!(!far.touches(&shell.deformed));
        assert_eq!((energy(&far, &shell.deformed), far.force(&shell.deformed)), (0.0, 0.0));
        far.raise(2e-9);
        assert!(far.touches(&shell.deformed) && far.force(&shell.deformed) > 0.0);
    }

    #[test]
    fn wall_behind_the_plane_is_inadmissible() {
        let shell = TestShell::new(3);
        let mut behind = contact(&shell, 1.0);
        behind.raise(behind.smallest_gap(&shell.deformed) + 1e-9);
        let admissible = |(s, nodes): (usize, &Vec<u32>)| {
            let x: Vec<Vec3> = nodes.iter().map(|&v| shell.deformed[v as usize]).collect();
            assert!(behind.is_active(s, &shell.deformed) || behind.energy(s, &x) == Ok(0.0));
            behind.energy(s, &x).is_ok()
        };
        let inadmissible = behind.nodes.iter().enumerate().filter(|&it| !admissible(it)).count();
        assert_eq!(inadmissible, 1);
    }

    /// The longest step leaves every sample a tenth of its gap, and some sample no more.
    #[test]
    fn longest_step_keeps_every_gap() {
        let mut chance = ChaCha8Rng::seed_from_u64(7);
        let case = touching(&TestShell::new(4));
        for size in [0.01, 1.0, 30.0] {
            for _ in 0..10 {
                let dx: Vec<Vec3> = (case.positions.iter())
                    .map(|_| random_matrix(&mut chance, size).column(0).into_owned())
                    .collect();
                let step = case.term.longest_part(&case.positions, &dx);
                assert!(0.0 < step && step <= 1.0);
                assert!(size > 0.01 || step == 1.0);
                let there: Vec<Vec3> =
                    case.positions.iter().zip(&dx).map(|(x, dx)| x + step * dx).collect();
                let left = |s| case.term.gap(s, &there) / case.term.gap(s, &case.positions);
                let least = case.term.samples().map(left).fold(f64::INFINITY, f64::min);
                // Rounding of a gap of 0.4 mm at coordinates of 10 mm.
                assert!(least >= 0.1 - 1e-12, "{least}");
                assert!(step == 1.0 || least <= 0.1 + 1e-12, "{least}");
            }
        }
    }

    /// The samples' areas are all of the limit surface's facets, whatever the mesh.
    #[test]
    fn areas_of_the_samples_add_up() {
        let shell = TestShell::new(6);
        let contact = touching(&shell).term;
        let surface = shell.surface();
        let positions = surface.at(&shell.reference);
        let facets = crate::surface::TriangleMesh { positions, triangles: surface.facets };
        assert_eq!(facets.check_closed_manifold(), Ok(()));
        let sum: f64 = contact.areas.iter().sum();
        assert!((sum / facets.area() - 1.0).abs() < 1e-13, "{sum}");
    }
}
