//! A moment along an edge, about an axis that stays where it is.
//!
//! ```text
//! E = -sum_edges m L theta        theta = atan2(N . q, N . p),   N = a1 x a2 at the edge's middle
//! ```
//!
//! `p` is the wall's normal at rest and `q = axis x p`: `theta` is how far the normal has turned about the axis, which
//! is conservative as long as the edge stays parallel to the axis, as in a strip that is rolled up. Turns beyond 180
//! degrees are counted from where the edge last was in equilibrium.

use std::f64::consts::TAU;

use nalgebra::Matrix3;

use crate::math::Vec3;
use crate::model::body::Configuration;
use crate::model::local::{LocalDerivatives, Term};
use crate::model::part_term::PartTerm;
use crate::model::system::Inadmissible;

/// The potential of moments along edges.
#[derive(Clone, Debug)]
pub(in crate::model) struct EdgeMoment {
    /// Share of the moment that is applied.
    pub load_factor: f64,
    stencils: Vec<Vec<u32>>,
    edges: Vec<MomentEdge>,
}

/// One edge of a triangle that carries a moment.
#[derive(Clone, Debug)]
pub(in crate::model) struct MomentEdge {
    /// `[,1 ,2]` of each node at the edge's middle, the nodes ascending.
    pub rows: Vec<[f64; 2]>,
    /// Moment on the edge, N mm.
    pub moment: f64,
    /// The normal at rest.
    pub p: Vec3,
    /// The axis crossed with it.
    pub q: Vec3,
    /// The turn at the last equilibrium, rad.
    pub settled: f64,
}

impl EdgeMoment {
    /// The moments on `edges`, whose nodes are `stencils`.
    #[must_use]
    pub(in crate::model) fn new(stencils: Vec<Vec<u32>>, edges: Vec<MomentEdge>) -> Self {
        Self { load_factor: 0.0, stencils, edges }
    }

    /// The work that the whole moment has done where all nodes are at `positions`, mJ.
    #[must_use]
    pub(in crate::model) fn work(&self, positions: &[Vec3]) -> f64 {
        let on_edge = |(edge, stencil): (&MomentEdge, &Vec<u32>)| {
            edge.moment * edge.turn(&edge.tangents(stencil.iter().map(|&v| &positions[v as usize])))
        };
        self.edges.iter().zip(&self.stencils).map(on_edge).sum()
    }

    /// Adds the gradient of [`Self::work`] to `gradient`, one vector for each node, N.
    pub(in crate::model) fn add_work_gradient(&self, positions: &[Vec3], gradient: &mut [Vec3]) {
        for (edge, stencil) in self.edges.iter().zip(&self.stencils) {
            let tangents = edge.tangents(stencil.iter().map(|&v| &positions[v as usize]));
            let [along_1, along_2] = edge.turn_gradient(&tangents);
            for (&node, [w1, w2]) in stencil.iter().zip(&edge.rows) {
                gradient[node as usize] += edge.moment * (*w1 * along_1 + *w2 * along_2);
            }
        }
    }

    /// Counts turns from where all nodes are at `positions` (mm).
    pub(in crate::model) fn count_from(&mut self, positions: &[Vec3]) {
        for (edge, stencil) in self.edges.iter_mut().zip(&self.stencils) {
            let tangents = edge.tangents(stencil.iter().map(|&v| &positions[v as usize]));
            edge.settled = edge.turn(&tangents);
        }
    }
}

impl MomentEdge {
    fn tangents<'a>(&self, x: impl IntoIterator<Item = &'a Vec3>) -> [Vec3; 2] {
        let mut tangents = [Vec3::zeros(); 2];
        for (x, row) in x.into_iter().zip(&self.rows) {
            tangents[0] += row[0] * x;
            tangents[1] += row[1] * x;
        }
        tangents
    }

    fn turn(&self, [d1, d2]: &[Vec3; 2]) -> f64 {
        let normal = d1.cross(d2);
        let turn = normal.dot(&self.q).atan2(normal.dot(&self.p));
        turn + TAU * ((self.settled - turn) / TAU).round()
    }

    fn turn_gradient(&self, tangents: &[Vec3; 2]) -> [Vec3; 2] {
        let [x, y] = [self.p, self.q].map(|axis| Component::new(axis, tangents));
        let square = x.value * x.value + y.value * y.value;
        [0, 1].map(|s| (x.value * y.gradient[s] - y.value * x.gradient[s]) / square)
    }

    fn turn_hessian(&self, tangents: &[Vec3; 2]) -> [[Matrix3<f64>; 2]; 2] {
        let [x, y] = [self.p, self.q].map(|axis| Component::new(axis, tangents));
        let square = x.value * x.value + y.value * y.value;
        let turn = self.turn_gradient(tangents);
        // `N . axis` is bilinear in the tangents.
        let mixed = -(x.value * self.q - y.value * self.p).cross_matrix() / square;
        let block = |s: usize, t: usize| {
            let own = match (s, t) {
                (0, 1) => mixed,
                (1, 0) => mixed.transpose(),
                _ => Matrix3::zeros(),
            };
            let growth = 2.0 * (x.value * x.gradient[t] + y.value * y.gradient[t]);
            own + (y.gradient[s] * x.gradient[t].transpose()
                - x.gradient[s] * y.gradient[t].transpose()
                - turn[s] * growth.transpose())
                / square
        };
        [0, 1].map(|s| [0, 1].map(|t| block(s, t)))
    }
}

/// `N . axis` and its gradient with respect to the two tangents.
struct Component {
    value: f64,
    gradient: [Vec3; 2],
}

impl Component {
    fn new(axis: Vec3, [d1, d2]: &[Vec3; 2]) -> Self {
        let gradient = [d2.cross(&axis), axis.cross(d1)];
        Self { value: d1.dot(&gradient[0]), gradient }
    }
}

impl PartTerm for EdgeMoment {
    fn boxed(&self) -> Box<dyn PartTerm> {
        Box::new(self.clone())
    }

    fn widens_pattern(&self) -> bool {
        false
    }

    fn set_load(&mut self, load: f64) {
        self.load_factor = load;
    }

    fn conjugate(&self, at: &Configuration<'_>) -> f64 {
        self.work(at.positions())
    }

    fn add_load_direction(&self, at: &Configuration<'_>, direction: &mut [Vec3]) {
        self.add_work_gradient(at.positions(), direction);
    }

    fn settle(&mut self, at: &Configuration<'_>) -> f64 {
        self.count_from(at.positions());
        0.0
    }

    fn memory(&self) -> Vec<f64> {
        self.edges.iter().map(|edge| edge.settled).collect()
    }

    fn recall(&mut self, at: &Configuration<'_>, memory: &[f64]) {
        if memory.is_empty() {
            self.count_from(at.positions());
        }
        self.edges.iter_mut().zip(memory).for_each(|(edge, settled)| edge.settled = *settled);
    }
}

impl Term for EdgeMoment {
    fn stencils(&self) -> &[Vec<u32>] {
        &self.stencils
    }

    fn energy(&self, s: usize, x: &[Vec3]) -> Result<f64, Inadmissible> {
        let edge = &self.edges[s];
        Ok(-self.load_factor * edge.moment * edge.turn(&edge.tangents(x)))
    }

    fn derivatives(
        &self,
        s: usize,
        x: &[Vec3],
        local: &mut LocalDerivatives,
    ) -> Result<f64, Inadmissible> {
        let edge = &self.edges[s];
        let factor = -self.load_factor * edge.moment;
        let tangents = edge.tangents(x);
        let [along_1, along_2] = edge.turn_gradient(&tangents);
        for (gradient, [w1, w2]) in local.gradient_mut().iter_mut().zip(&edge.rows) {
            *gradient += factor * (*w1 * along_1 + *w2 * along_2);
        }
        if local.with_hessian() {
            let [[h11, h12], [h21, h22]] = edge.turn_hessian(&tangents);
            for (j, [j1, j2]) in edge.rows.iter().enumerate() {
                for (i, [i1, i2]) in edge.rows.iter().enumerate().skip(j) {
                    *local.block_mut(i, j) +=
                        factor * ((h11 * *j1 + h12 * *j2) * *i1 + (h21 * *j1 + h22 * *j2) * *i2);
                }
            }
        }
        Ok(factor * edge.turn(&tangents))
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Isometry3, UnitQuaternion};

    use super::*;
    use crate::model::term_suite::{Case, term_suite};
    use crate::model::test_shells::TestShell;

    /// A moment on the facets of an egg, about its own axes: turned as a body, the energy changes by the turn.
    fn moments(shell: &TestShell) -> Case<EdgeMoment> {
        let axis = Vec3::new(0.6, 0.0, 0.8);
        let (mut stencils, mut edges) = (Vec::new(), Vec::new());
        for &triangle in shell.mesh.surface.triangles.iter().step_by(5) {
            let mut nodes = triangle.to_vec();
            nodes.sort_unstable();
            let rows = nodes.iter().map(|v| match triangle.iter().position(|w| w == v) {
                Some(0) => [-1.0, -1.0],
                Some(1) => [1.0, 0.0],
                _ => [0.0, 1.0],
            });
            let [a, b, c] = triangle.map(|v| shell.reference[v as usize]);
            let p = (b - a).cross(&(c - a));
            let q = axis.cross(&p);
            edges.push(MomentEdge { rows: rows.collect(), moment: 0.7, p, q, settled: 0.0 });
            stencils.push(nodes);
        }
        let mut term = EdgeMoment::new(stencils, edges);
        term.load_factor = 0.5;
        let motion = Isometry3::translation(3.0, -5.0, 2.0);
        Case { term, positions: shell.deformed.clone(), motion }
    }

    term_suite!(moments, moments);

    /// A turn about the axis is counted as it is, through more than a whole turn.
    #[test]
    fn turns_are_counted() {
        let edge = |settled| MomentEdge {
            rows: vec![[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]],
            moment: 1.0,
            p: Vec3::z(),
            q: Vec3::y().cross(&Vec3::z()),
            settled,
        };
        let corners = [Vec3::zeros(), Vec3::x(), Vec3::y()];
        let mut settled = 0.0;
        for step in 1..=20 {
            let angle = 0.4 * f64::from(step);
            let turn = UnitQuaternion::from_scaled_axis(angle * Vec3::y());
            let turned = corners.map(|x| turn * x);
            let edge = edge(settled);
            settled = edge.turn(&edge.tangents(&turned));
            assert!((settled - angle).abs() < 1e-12, "{settled} {angle}");
        }
    }
}
