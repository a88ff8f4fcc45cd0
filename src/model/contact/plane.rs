//! Frictionless contact of the wall's outer face with a rigid plane, by a barrier.
//!
//! ```text
//! gap      d = n . x - offset - t/2
//! energy   sum_samples A kappa b(d),   b(d) = -(d - h)^2 ln(d / h)  for 0 < d < h,  0 beyond
//! ```
//!
//! The barrier is infinite at zero gap, so the outer face never passes the plane; it pushes when the gap is
//! below `h`, which is the error of the contact's position. Samples are the limit points of vertices and edge
//! midpoints, weighted by their share of the reference area, so that the contact pressure does not depend
//! on the mesh. The outer face keeps half the thickness at rest. Source: Li et al. (2020), barrier of
//! incremental potential contact.

use std::rc::Rc;

use nalgebra::Matrix3;
use serde::{Deserialize, Serialize};

use crate::math::Vec3;
use crate::mesh::ShellMesh;
use crate::model::element::{LoopBasis, Sample, samples};
use crate::model::local::{LocalDerivatives, Term};
use crate::model::system::Inadmissible;

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
        let activation = 0.1 * mesh.thickness;
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
    /// The barrier for `mesh` with control points at `positions` at rest.
    #[must_use]
    pub fn new(
        mesh: &ShellMesh,
        bases: &[Rc<LoopBasis>],
        positions: &[Vec3],
        settings: PlaneSettings,
    ) -> Self {
        let (samples, facets) = samples(&mesh.stencils, bases, &mesh.rings);
        let at_rest: Vec<Vec3> = samples.iter().map(|sample| sample.point(positions)).collect();
        let mut areas = vec![0.0; samples.len()];
        for facet in facets {
            let [a, b, c] = facet.map(|v| at_rest[v as usize]);
            let area = (b - a).cross(&(c - a)).norm() / 2.0;
            for v in facet {
                areas[v as usize] += area / 3.0;
            }
        }
        let (nodes, weights) = samples.into_iter().map(Sample::ascending).unzip();
        Self { settings, half_thickness: 0.5 * mesh.thickness, nodes, weights, areas }
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
