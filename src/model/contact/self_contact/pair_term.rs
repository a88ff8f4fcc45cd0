//! The barriers between triangles as a term: a stencil is the nodes of two triangles, with all their pairs.
//!
//! ```text
//! y = P x         the twelve points of two triangles, linear in their nodes
//! gradient P^T e'(y)        Hessian P^T e''(y) P
//! ```

use std::sync::Arc;

use nalgebra::Matrix3;

use super::pair::Pair;
use super::wall_surface::WallSurface;
use crate::math::{Box3, Vec3};
use crate::model::local::{LocalDerivatives, Term};
use crate::model::system::Inadmissible;

/// The barriers of listed pairs.
#[derive(Clone, Debug)]
pub(in crate::model) struct PairTerm {
    surface: Arc<WallSurface>,
    stencils: Vec<Vec<u32>>,
    groups: Vec<Group>,
    /// Gap between boxes around the triangles beyond which no pair of them acts, mm.
    reach: f64,
}

/// The pairs of two triangles.
#[derive(Clone, Debug)]
struct Group {
    triangles: [u32; 2],
    /// Weights of each node of the stencil on the twelve points.
    weights: Vec<[f64; 12]>,
    pairs: Vec<Pair>,
}

impl PairTerm {
    /// Of `pairs` by triangles, ascending; barriers act nearer than `reach` (mm).
    pub(super) fn new(
        surface: Arc<WallSurface>,
        pairs: Vec<([u32; 2], Vec<Pair>)>,
        reach: f64,
    ) -> Self {
        let group = |(triangles, pairs): ([u32; 2], Vec<Pair>)| {
            let [a, b] = triangles.map(|t| &surface.points[t as usize]);
            let mut nodes: Vec<u32> = a.nodes.iter().chain(&b.nodes).copied().collect();
            nodes.sort_unstable();
            nodes.dedup();
            let mut weights = vec![[0.0; 12]; nodes.len()];
            for (points, first) in [(a, 0), (b, 6)] {
                for (node, of_points) in points.nodes.iter().zip(&points.weights) {
                    let place = nodes.partition_point(|other| other < node);
                    weights[place][first..first + 6].copy_from_slice(of_points);
                }
            }
            (nodes, Group { triangles, weights, pairs })
        };
        let (stencils, groups) = pairs.into_iter().map(group).unzip();
        Self { surface, stencils, groups, reach }
    }

    /// The triangles of each stencil, ascending.
    pub(super) fn triangles(&self) -> impl Iterator<Item = [u32; 2]> {
        self.groups.iter().map(|group| group.triangles)
    }

    /// The pairs with their samples' numbers among the twelve points of their triangles.
    pub(super) fn pairs(&self) -> impl Iterator<Item = ([u32; 12], &Pair)> {
        self.groups.iter().flat_map(|group| {
            let samples = self.surface.samples_of(group.triangles);
            group.pairs.iter().map(move |pair| (samples, pair))
        })
    }
}

impl Group {
    fn points(&self, x: &[Vec3]) -> [Vec3; 12] {
        let mut points = [Vec3::zeros(); 12];
        for (x, weights) in x.iter().zip(&self.weights) {
            for (point, weight) in points.iter_mut().zip(weights) {
                *point += *weight * x;
            }
        }
        points
    }
}

impl Term for PairTerm {
    fn stencils(&self) -> &[Vec<u32>] {
        &self.stencils
    }

    fn is_active(&self, s: usize, positions: &[Vec3]) -> bool {
        let around = |triangle: u32| {
            let points = &self.surface.points[triangle as usize];
            let at = points.at(points.nodes.iter().map(|&node| &positions[node as usize]));
            Box3::around(at)
        };
        let [a, b] = self.groups[s].triangles.map(around);
        // A little more than the reach: these points are rounded otherwise.
        a.gap_squared(&b) < (1.001 * self.reach).powi(2)
    }

    fn energy(&self, s: usize, x: &[Vec3]) -> Result<f64, Inadmissible> {
        let group = &self.groups[s];
        let points = group.points(x);
        group.pairs.iter().try_fold(0.0, |sum, pair| {
            let at = pair.points.map(|point| points[point as usize]);
            Ok(sum + pair.derivatives(&at, false)?.map_or(0.0, |it| it.energy))
        })
    }

    fn derivatives(
        &self,
        s: usize,
        x: &[Vec3],
        local: &mut LocalDerivatives,
    ) -> Result<f64, Inadmissible> {
        let group = &self.groups[s];
        let points = group.points(x);
        let mut energy = 0.0;
        let mut gradient = [Vec3::zeros(); 12];
        let mut hessian = [[Matrix3::<f64>::zeros(); 12]; 12];
        let mut is_moved = [false; 12];
        for pair in &group.pairs {
            let at = pair.points.map(|point| points[point as usize]);
            let Some(of_pair) = pair.derivatives(&at, local.with_hessian())? else { continue };
            energy += of_pair.energy;
            for (i, &point) in pair.points.iter().enumerate() {
                is_moved[point as usize] = true;
                gradient[point as usize] += of_pair.gradient[i];
                if local.with_hessian() {
                    for (j, &other) in pair.points.iter().enumerate() {
                        hessian[point as usize][other as usize] += of_pair.hessian[i][j];
                    }
                }
            }
        }
        let moved: Vec<usize> = (0..12).filter(|&point| is_moved[point]).collect();
        for (sum, weights) in local.gradient_mut().iter_mut().zip(&group.weights) {
            for &point in &moved {
                *sum += weights[point] * gradient[point];
            }
        }
        if local.with_hessian() {
            for (j, of_j) in group.weights.iter().enumerate() {
                let mut column = [Matrix3::<f64>::zeros(); 12];
                for &point in &moved {
                    for &other in moved.iter().filter(|&&other| of_j[other] != 0.0) {
                        column[point] += of_j[other] * hessian[point][other];
                    }
                }
                for (i, of_i) in group.weights.iter().enumerate().skip(j) {
                    let block = local.block_mut(i, j);
                    for &point in moved.iter().filter(|&&point| of_i[point] != 0.0) {
                        *block += of_i[point] * column[point];
                    }
                }
            }
        }
        Ok(energy)
    }
}
