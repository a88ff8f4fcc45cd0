//! Follower pressure on a closed chamber: the potential `-p V`.
//!
//! ```text
//! V = sum_facets x0 . (x1 x x2) / 6        dV/dx0 = (x1 x x2) / 6        d2V/dx0dx1 = -[x2]x / 6
//! ```
//!
//! The facets join the limit points of corners and edge midpoints (four for each element), a closed surface:
//! the net force and moment of a uniform pressure vanish and the tangent is symmetric. Acting on the
//! mid-surface is exact for an incompressible wall: inner and middle volume differ by a constant.

use std::rc::Rc;

use crate::math::Vec3;
use crate::mesh::ShellMesh;
use crate::model::element::{LoopBasis, SUBTRIANGLES, ascending};
use crate::model::local::{LocalDerivatives, Term};
use crate::model::system::Inadmissible;

/// The potential of a uniform pressure inside the mid-surface.
#[derive(Clone, Debug)]
pub struct ChamberPressure {
    /// Pressure, MPa; positive inflates.
    pub pressure: f64,
    stencils: Vec<Vec<u32>>,
    /// Weights of each node on the element's corners and edge midpoints.
    limits: Vec<Vec<[f64; 6]>>,
}

impl ChamberPressure {
    /// The chamber inside `mesh`, at zero pressure.
    #[must_use]
    pub fn new(mesh: &ShellMesh, bases: &[Rc<LoopBasis>]) -> Self {
        let mut chamber = Self {
            pressure: 0.0,
            stencils: Vec::with_capacity(bases.len()),
            limits: Vec::with_capacity(bases.len()),
        };
        for (stencil, basis) in mesh.stencils.iter().zip(bases) {
            let (nodes, weights) = ascending(&stencil.nodes, &basis.limit);
            chamber.stencils.push(nodes);
            chamber.limits.push(weights);
        }
        chamber
    }

    /// The enclosed volume for control points at `positions`, mm^3.
    #[must_use]
    pub fn volume(&self, positions: &[Vec3]) -> f64 {
        let element_volume = |(stencil, limits): (&Vec<u32>, &Vec<[f64; 6]>)| {
            facet_volume(&limit_points(limits, stencil.iter().map(|&v| &positions[v as usize])))
        };
        self.stencils.iter().zip(&self.limits).map(element_volume).sum()
    }

    /// Adds `dV/dx` to `gradient`, one vector for each control point, mm^2.
    pub fn add_volume_gradient(&self, positions: &[Vec3], gradient: &mut [Vec3]) {
        for (stencil, limits) in self.stencils.iter().zip(&self.limits) {
            let points = limit_points(limits, stencil.iter().map(|&v| &positions[v as usize]));
            let by_point = facet_gradient(&points);
            for (&node, weights) in stencil.iter().zip(limits) {
                gradient[node as usize] += combine(&by_point, weights);
            }
        }
    }
}

impl Term for ChamberPressure {
    fn stencils(&self) -> &[Vec<u32>] {
        &self.stencils
    }

    fn energy(&self, s: usize, x: &[Vec3]) -> Result<f64, Inadmissible> {
        Ok(-self.pressure * facet_volume(&limit_points(&self.limits[s], x)))
    }

    fn derivatives(
        &self,
        s: usize,
        x: &[Vec3],
        local: &mut LocalDerivatives,
    ) -> Result<f64, Inadmissible> {
        let limits = &self.limits[s];
        let points = limit_points(limits, x);
        let by_point = facet_gradient(&points);
        for (gradient, weights) in local.gradient_mut().iter_mut().zip(limits) {
            *gradient -= self.pressure * combine(&by_point, weights);
        }
        if local.with_hessian() {
            let axes = facet_hessian_axes(&points);
            for (j, column) in limits.iter().enumerate() {
                let half: [Vec3; 6] = std::array::from_fn(|p| combine(&axes[p], column));
                for (i, row) in limits.iter().enumerate().skip(j) {
                    let axis = -self.pressure * combine(&half, row);
                    *local.block_mut(i, j) += axis.cross_matrix();
                }
            }
        }
        Ok(-self.pressure * facet_volume(&points))
    }
}

fn limit_points<'a>(limits: &[[f64; 6]], x: impl IntoIterator<Item = &'a Vec3>) -> [Vec3; 6] {
    let mut points = [Vec3::zeros(); 6];
    for (weights, x) in limits.iter().zip(x) {
        for (point, weight) in points.iter_mut().zip(weights) {
            *point += *weight * x;
        }
    }
    points
}

fn combine(vectors: &[Vec3; 6], weights: &[f64; 6]) -> Vec3 {
    vectors.iter().zip(weights).fold(Vec3::zeros(), |sum, (v, w)| sum + *w * v)
}

fn facet_volume(points: &[Vec3; 6]) -> f64 {
    SUBTRIANGLES.iter().map(|&[a, b, c]| points[a].dot(&points[b].cross(&points[c])) / 6.0).sum()
}

fn facet_gradient(points: &[Vec3; 6]) -> [Vec3; 6] {
    let mut gradient = [Vec3::zeros(); 6];
    for [a, b, c] in SUBTRIANGLES {
        for [a, b, c] in [[a, b, c], [b, c, a], [c, a, b]] {
            gradient[a] += points[b].cross(&points[c]) / 6.0;
        }
    }
    gradient
}

/// Axes `w_pq` of the skew blocks `d2V/dx_p dx_q = [w_pq]x`.
fn facet_hessian_axes(points: &[Vec3; 6]) -> [[Vec3; 6]; 6] {
    let mut axes = [[Vec3::zeros(); 6]; 6];
    for [a, b, c] in SUBTRIANGLES {
        for [a, b, c] in [[a, b, c], [b, c, a], [c, a, b]] {
            axes[a][b] -= points[c] / 6.0;
            axes[b][a] += points[c] / 6.0;
        }
    }
    axes
}
