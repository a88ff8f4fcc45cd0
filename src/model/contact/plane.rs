//! Frictionless contact of the wall's outer face with a rigid plane, by a barrier.
//!
//! ```text
//! gap      d = n . x - offset - t/2
//! energy   sum_samples A kappa b(d),   b(d) = -(d - h)^2 ln(d / h)  for 0 < d < h,  0 beyond
//! ```
//!
//! The barrier is infinite at zero gap, so no sample of the outer face passes the plane; it pushes when the gap is
//! below `h`, which is the error of the contact's position. Samples are the limit points of vertices and edge
//! midpoints, weighted by their share of the reference area, so that the contact pressure does not depend
//! on the mesh. The outer face keeps half the thickness at rest. Source: Li et al. (2020), barrier of
//! incremental potential contact.

use nalgebra::Matrix3;
use serde::{Deserialize, Serialize};

use crate::math::Vec3;
use crate::mesh::ShellMesh;
use crate::model::element::SampledSurface;
use crate::model::local::{LocalDerivatives, Term};
use crate::model::system::Inadmissible;

/// Where the barrier begins, in thicknesses.
const ACTIVATION: f64 = 0.1;

/// The share of its gap that a sample may use up in one step.
const STEP_SHARE: f64 = 0.9;

/// A rigid plane; the part stays on the side to which the normal points.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlaneSettings {
    /// Unit normal, pointing towards the part.
    pub normal: [f64; 3],
    /// `normal . x` on the plane, mm.
    pub offset: f64,
    /// Gap at which the barrier begins to push, mm.
    pub activation: f64,
    /// Barrier stiffness, MPa/mm.
    pub stiffness: f64,
}

impl PlaneSettings {
    /// A plane `distance` (mm) before the outermost point of `mesh`'s outer wall, its barrier fit for `pressure` (MPa).
    ///
    /// # Decisions
    /// The barrier begins a tenth of the thickness before the plane, which is the error of the contact's
    /// position; half that gap carries ten times the pressure.
    #[must_use]
    pub fn before(mesh: &ShellMesh, normal: Vec3, distance: f64, pressure: f64) -> Self {
        let heights = mesh.surface.positions.iter().map(|x| normal.dot(x));
        let outermost = heights.fold(f64::INFINITY, f64::min) - 0.5 * mesh.thickness;
        let activation = ACTIVATION * mesh.thickness;
        // -b'(h / 2) = (ln 2 + 1/2) h.
        let stiffness = 10.0 * pressure / ((std::f64::consts::LN_2 + 0.5) * activation);
        Self { normal: normal.into(), offset: outermost - distance, activation, stiffness }
    }
}

/// The barrier between a shell's outer face and a rigid plane.
#[derive(Clone, Debug)]
pub struct PlaneContact {
    settings: PlaneSettings,
    half_thickness: f64,
    nodes: Vec<Vec<u32>>,
    weights: Vec<Vec<f64>>,
    areas: Vec<f64>,
}

impl PlaneContact {
    /// The barrier for the wall of `thickness` (mm) around `surface`, with nodes at `positions` at rest.
    #[must_use]
    pub fn new(
        surface: &SampledSurface,
        positions: &[Vec3],
        thickness: f64,
        settings: PlaneSettings,
    ) -> Self {
        let at_rest = surface.at(positions);
        let mut areas = vec![0.0; at_rest.len()];
        for facet in &surface.facets {
            let [a, b, c] = facet.map(|v| at_rest[v as usize]);
            let area = (b - a).cross(&(c - a)).norm() / 2.0;
            for v in facet {
                areas[*v as usize] += area / 3.0;
            }
        }
        let samples = surface.samples.iter().map(|s| (s.nodes.clone(), s.weights.clone()));
        let (nodes, weights) = samples.unzip();
        Self { settings, half_thickness: 0.5 * thickness, nodes, weights, areas }
    }

    /// The smallest gap between outer face and plane, mm.
    #[must_use]
    pub fn smallest_gap(&self, positions: &[Vec3]) -> f64 {
        (0..self.nodes.len()).map(|s| self.gap(s, positions)).fold(f64::INFINITY, f64::min)
    }

    /// The force with which the part presses on the plane, N.
    #[must_use]
    pub fn force(&self, positions: &[Vec3]) -> f64 {
        let sample_force = |s: usize| {
            let gap = self.gap(s, positions);
            if gap < self.settings.activation {
                -self.weight(s) * self.barrier(gap)[1]
            } else {
                0.0
            }
        };
        (0..self.nodes.len()).map(sample_force).fold(0.0, |sum, force| sum + force)
    }

    /// The largest part of the displacement `dx` that leaves every sample on its side of the plane, at most 1.
    #[must_use]
    pub fn longest_step(&self, positions: &[Vec3], dx: &[Vec3]) -> f64 {
        let normal = Vec3::from(self.settings.normal);
        let sample_step = |s: usize| {
            let approach: f64 = self.nodes[s]
                .iter()
                .zip(&self.weights[s])
                .map(|(&v, w)| -w * normal.dot(&dx[v as usize]))
                .sum();
            let gap = self.gap(s, positions);
            if approach > STEP_SHARE * gap { STEP_SHARE * gap / approach } else { 1.0 }
        };
        (0..self.nodes.len()).map(sample_step).fold(1.0, f64::min)
    }

    fn gap(&self, s: usize, positions: &[Vec3]) -> f64 {
        let normal = Vec3::from(self.settings.normal);
        let height: f64 = self.nodes[s]
            .iter()
            .zip(&self.weights[s])
            .map(|(&v, w)| w * normal.dot(&positions[v as usize]))
            .sum();
        height - self.settings.offset - self.half_thickness
    }

    fn weight(&self, s: usize) -> f64 {
        self.areas[s] * self.settings.stiffness
    }

    fn local_gap(&self, s: usize, x: &[Vec3]) -> Result<f64, Inadmissible> {
        let normal = Vec3::from(self.settings.normal);
        let height: f64 = self.weights[s].iter().zip(x).map(|(w, x)| w * normal.dot(x)).sum();
        let gap = height - self.settings.offset - self.half_thickness;
        if gap > 0.0 { Ok(gap) } else { Err(Inadmissible("a wall lies behind the plane")) }
    }

    /// The barrier with its first and second derivative at a gap below the activation.
    fn barrier(&self, gap: f64) -> [f64; 3] {
        let h = self.settings.activation;
        let ln = (gap / h).ln();
        let below = gap - h;
        [
            -below * below * ln,
            -2.0 * below * ln - below * below / gap,
            -2.0 * ln - 4.0 * below / gap + below * below / (gap * gap),
        ]
    }
}

impl Term for PlaneContact {
    fn stencils(&self) -> &[Vec<u32>] {
        &self.nodes
    }

    fn is_active(&self, s: usize, positions: &[Vec3]) -> bool {
        self.gap(s, positions) < self.settings.activation
    }

    fn energy(&self, s: usize, x: &[Vec3]) -> Result<f64, Inadmissible> {
        let gap = self.local_gap(s, x)?;
        Ok(if gap < self.settings.activation { self.weight(s) * self.barrier(gap)[0] } else { 0.0 })
    }

    fn derivatives(
        &self,
        s: usize,
        x: &[Vec3],
        local: &mut LocalDerivatives,
    ) -> Result<f64, Inadmissible> {
        let gap = self.local_gap(s, x)?;
        if gap >= self.settings.activation {
            return Ok(0.0);
        }
        let [value, slope, curvature] = self.barrier(gap).map(|b| self.weight(s) * b);
        let normal = Vec3::from(self.settings.normal);
        let weights = &self.weights[s];
        for (gradient, weight) in local.gradient_mut().iter_mut().zip(weights) {
            *gradient += slope * weight * normal;
        }
        if local.with_hessian() {
            let nn: Matrix3<f64> = curvature * normal * normal.transpose();
            for (j, wj) in weights.iter().enumerate() {
                for (i, wi) in weights.iter().enumerate().skip(j) {
                    *local.block_mut(i, j) += wi * wj * nn;
                }
            }
        }
        Ok(value)
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

    const NORMAL: [f64; 3] = [0.48, -0.6, 0.64];
    const ACTIVATION: f64 = 4.0;

    fn contact(shell: &TestShell, offset: f64, activation: f64) -> PlaneContact {
        let settings = PlaneSettings { normal: NORMAL, offset, activation, stiffness: 0.7 };
        PlaneContact::new(&shell.surface(), &shell.reference, shell.mesh.thickness, settings)
    }

    /// A tilted plane so near that the closest sample has a gap of 0.4 mm.
    fn touching(shell: &TestShell) -> Case<PlaneContact> {
        let offset = contact(shell, 0.0, ACTIVATION).smallest_gap(&shell.deformed) - 0.4;
        let term = contact(shell, offset, ACTIVATION);
        // In the plane, and about its normal.
        let normal = Vec3::from(NORMAL);
        let rotation = UnitQuaternion::from_axis_angle(&Unit::new_normalize(normal), 0.8);
        let slide = Translation3::from(normal.cross(&Vec3::new(2.0, 5.0, -1.0)));
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
        for share in [1e-3, 1e-4, 1e-5] {
            let [value, slope, curvature] = contact.barrier(ACTIVATION * (1.0 - share));
            let h = ACTIVATION;
            // -(h e)^2 ln(1 - e) to leading order; what is left out is of relative size 2 e.
            let close = |value: f64, leading: f64| (value / leading - 1.0).abs() < 2.0 * share;
            assert!(close(value, share.powi(3) * h * h), "{value}");
            assert!(close(slope, -3.0 * share * share * h), "{slope}");
            assert!(close(curvature, 6.0 * share), "{curvature}");
        }
    }

    /// Raising the plane by `s` costs `force * s`; the wall is pushed along the normal with that force.
    #[test]
    fn force_is_what_raising_the_plane_costs() {
        let shell = TestShell::new(1);
        let case = touching(&shell);
        let offset = case.term.settings.offset;
        let force = case.term.force(&case.positions);
        let slope =
            difference(1e-3, |s| energy(&contact(&shell, offset + s, ACTIVATION), &case.positions));
        // (step / gap)^4 = 4e-11.
        assert!((force / slope - 1.0).abs() < 1e-9, "{force} {slope}");
        let lifted = difference(1e-3, |s| {
            let lifted: Vec<Vec3> =
                case.positions.iter().map(|x| x + s * Vec3::from(NORMAL)).collect();
            energy(&case.term, &lifted)
        });
        assert!((force / lifted + 1.0).abs() < 1e-9, "{force} {lifted}");
    }

    #[test]
    fn far_plane_does_nothing() {
        let shell = TestShell::new(2);
        let offset = contact(&shell, 0.0, ACTIVATION).smallest_gap(&shell.deformed) - ACTIVATION;
        let far = contact(&shell, offset - 1e-9, ACTIVATION);
        assert!((0..far.nodes.len()).all(|s| !far.is_active(s, &shell.deformed)));
        assert_eq!((energy(&far, &shell.deformed), far.force(&shell.deformed)), (0.0, 0.0));
    }

    #[test]
    fn wall_behind_the_plane_is_inadmissible() {
        let shell = TestShell::new(3);
        let offset = contact(&shell, 0.0, ACTIVATION).smallest_gap(&shell.deformed);
        let behind = contact(&shell, offset + 1e-9, ACTIVATION);
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
                let step = case.term.longest_step(&case.positions, &dx);
                assert!(0.0 < step && step <= 1.0);
                assert!(size > 0.01 || step == 1.0);
                let there: Vec<Vec3> =
                    case.positions.iter().zip(&dx).map(|(x, dx)| x + step * dx).collect();
                let left = |s| case.term.gap(s, &there) / case.term.gap(s, &case.positions);
                let least = (0..case.term.nodes.len()).map(left).fold(f64::INFINITY, f64::min);
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
