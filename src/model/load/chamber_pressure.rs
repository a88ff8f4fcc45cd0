//! Follower pressure on a closed chamber: the potential `-p V`.
//!
//! ```text
//! V = sum_facets x0 . (x1 x x2) / 6        dV/dx0 = (x1 x x2) / 6        d2V/dx0dx1 = -[x2]x / 6
//! ```
//!
//! The facets join corners and edge midpoints on the surface, four small ones for each element, less those between its
//! corners alone: four thirds of one closed surface less a third of another (Richardson), which leaves an error of fourth
//! order. The net force and moment of a uniform pressure vanish and the tangent is symmetric. Acting on the
//! mid-surface is exact for an incompressible wall: inner and middle volume differ by a constant.
//!
//! A part cut off by planes of symmetry is closed by [`Fan`]s: the flat cut, as facets from an edge to a point of its plane.
//! A plane through the origin of the volumes needs none. Openings, as an air inlet, are closed by [`LidFan`]s.

use pulp::{Simd, WithSimd};

use super::lid::LidFan;
use crate::math::Vec3;
use crate::model::block::{add_combination, vectorize};
use crate::model::body::Configuration;
use crate::model::element::ElementPoints;
use crate::model::local::{LocalDerivatives, Term};
use crate::model::part_term::PartTerm;
use crate::model::system::Inadmissible;

/// The potential of a uniform pressure inside the mid-surface.
#[derive(Clone, Debug)]
pub(in crate::model) struct ChamberPressure {
    /// Pressure, MPa; positive inflates.
    pub pressure: f64,
    /// At a load of 1, MPa.
    whole_pressure: f64,
    stencils: Vec<Vec<u32>>,
    /// Weights of each node on the element's corners and edge midpoints.
    limits: Vec<Vec<[f64; 6]>>,
    /// Of the last stencils, those that are no elements.
    fans: Vec<Fan>,
    /// Of the stencils after them, one each.
    lids: Vec<LidFan>,
    /// From where volumes are measured, mm.
    origin: Vec3,
}

/// The facets between the edge of an element that lies in a plane of symmetry and a point of that plane.
#[derive(Clone, Debug)]
pub(in crate::model) struct Fan {
    /// The element whose edge it is.
    pub points: ElementPoints,
    /// The element's points along the edge, in the order of its triangle: one end, the middle, the other end.
    pub along: [usize; 3],
    /// The point of the plane, mm; it also lies in the planes that meet this one.
    pub apex: Vec3,
}

impl ChamberPressure {
    /// The chamber within the triangles of `points`, at zero pressure.
    #[must_use]
    pub(in crate::model) fn new(points: &[ElementPoints]) -> Self {
        Self::cut(points, Vec::new(), Vec3::zeros())
    }

    /// The chamber within the triangles of `points`, closed by `fans`, which miss only the planes through `origin`.
    #[must_use]
    pub(in crate::model) fn cut(points: &[ElementPoints], fans: Vec<Fan>, origin: Vec3) -> Self {
        let all = || points.iter().chain(fans.iter().map(|fan| &fan.points));
        Self {
            pressure: 0.0,
            whole_pressure: 1.0,
            stencils: all().map(|points| points.nodes.clone()).collect(),
            limits: all().map(|points| points.weights.clone()).collect(),
            fans,
            lids: Vec::new(),
            origin,
        }
    }

    /// The same chamber, closed by `lids` too.
    ///
    /// # Panics
    /// When volumes are measured from elsewhere than the origin of the places.
    #[must_use]
    pub(in crate::model) fn with_lids(mut self, lids: Vec<LidFan>) -> Self {
        assert_eq!(self.origin, Vec3::zeros());
        self.stencils.extend(lids.iter().map(|lid| lid.nodes.clone()));
        self.limits.extend(lids.iter().map(|_| Vec::new()));
        self.lids = lids;
        self
    }

    /// The same chamber, whose pressure is `whole` (MPa) at a load of 1; otherwise it is the load.
    #[must_use]
    pub(in crate::model) fn under(self, whole: f64) -> Self {
        Self { whole_pressure: whole, ..self }
    }

    fn lid(&self, s: usize) -> Option<&LidFan> {
        let others = self.stencils.len() - self.lids.len();
        s.checked_sub(others).map(|lid| &self.lids[lid])
    }

    /// The six points of a stencil, seen from the origin of the volumes.
    #[inline(always)]
    fn points<'a>(&self, limits: &[[f64; 6]], x: impl IntoIterator<Item = &'a Vec3>) -> [Vec3; 6] {
        let mut points = [-self.origin; 6];
        for (weights, x) in limits.iter().zip(x) {
            for (point, weight) in points.iter_mut().zip(weights) {
                *point += *weight * x;
            }
        }
        points
    }

    #[inline(always)]
    fn fan(&self, s: usize) -> Option<&Fan> {
        let elements = self.stencils.len() - self.fans.len() - self.lids.len();
        s.checked_sub(elements).map(|fan| &self.fans[fan])
    }

    #[inline(always)]
    fn apex(&self, fan: &Fan) -> Vec3 {
        fan.apex - self.origin
    }

    #[inline(always)]
    fn volume_of(&self, s: usize, points: &[Vec3; 6]) -> f64 {
        let Some(fan) = self.fan(s) else {
            return facet_volume(points);
        };
        let volume = |([b, c], w): ([usize; 2], f64)| {
            w / 6.0 * self.apex(fan).dot(&points[b].cross(&points[c]))
        };
        fan.edges().map(volume).iter().sum()
    }

    #[inline(always)]
    fn gradient_of(&self, s: usize, points: &[Vec3; 6]) -> [Vec3; 6] {
        let Some(fan) = self.fan(s) else {
            return facet_gradient(points);
        };
        let mut gradient = [Vec3::zeros(); 6];
        for ([b, c], w) in fan.edges() {
            gradient[b] += w / 6.0 * points[c].cross(&self.apex(fan));
            gradient[c] += w / 6.0 * self.apex(fan).cross(&points[b]);
        }
        gradient
    }

    #[inline(always)]
    fn hessian_axes_of(&self, s: usize, points: &[Vec3; 6]) -> Axes {
        let Some(fan) = self.fan(s) else {
            return facet_hessian_axes(points);
        };
        let mut axes = Axes::default();
        for ([b, c], w) in fan.edges() {
            add_axis(&mut axes, [b, c], -w / 6.0 * self.apex(fan));
        }
        axes
    }

    /// The enclosed volume for control points at `positions`, mm^3.
    #[must_use]
    pub(in crate::model) fn volume(&self, positions: &[Vec3]) -> f64 {
        let stencil_volume = |(s, (stencil, limits)): (usize, (&Vec<u32>, &Vec<[f64; 6]>))| {
            if let Some(lid) = self.lid(s) {
                return lid.volume(&places(stencil, positions));
            }
            let x = stencil.iter().map(|&v| &positions[v as usize]);
            self.volume_of(s, &self.points(limits, x))
        };
        self.stencils.iter().zip(&self.limits).enumerate().map(stencil_volume).sum()
    }

    /// Adds `dV/dx` to `gradient`, one vector for each control point, mm^2.
    pub(in crate::model) fn add_volume_gradient(&self, positions: &[Vec3], gradient: &mut [Vec3]) {
        for (s, (stencil, limits)) in self.stencils.iter().zip(&self.limits).enumerate() {
            if let Some(lid) = self.lid(s) {
                let by_node = lid.gradient(&places(stencil, positions));
                for (&node, share) in stencil.iter().zip(by_node) {
                    gradient[node as usize] += share;
                }
                continue;
            }
            let points = self.points(limits, stencil.iter().map(|&v| &positions[v as usize]));
            let by_point = self.gradient_of(s, &points);
            for (&node, weights) in stencil.iter().zip(limits) {
                gradient[node as usize] += combine(&by_point, weights);
            }
        }
    }
}

impl PartTerm for ChamberPressure {
    fn boxed(&self) -> Box<dyn PartTerm> {
        Box::new(self.clone())
    }

    /// Lids span their rims; all else lies within elements.
    fn widens_pattern(&self) -> bool {
        !self.lids.is_empty()
    }

    fn set_load(&mut self, load: f64) {
        self.pressure = load * self.whole_pressure;
    }

    fn is_idle(&self) -> bool {
        self.pressure == 0.0
    }

    fn whole_energy(&self, at: &Configuration<'_>) -> Option<f64> {
        Some(-self.pressure * self.volume(at.positions()))
    }

    fn conjugate(&self, at: &Configuration<'_>) -> f64 {
        self.whole_pressure * self.volume(at.positions())
    }

    fn add_load_direction(&self, at: &Configuration<'_>, direction: &mut [Vec3]) {
        let mut gradient = vec![Vec3::zeros(); direction.len()];
        self.add_volume_gradient(at.positions(), &mut gradient);
        for (sum, gradient) in direction.iter_mut().zip(gradient) {
            *sum += self.whole_pressure * gradient;
        }
    }
}

impl Term for ChamberPressure {
    fn stencils(&self) -> &[Vec<u32>] {
        &self.stencils
    }

    fn energy(&self, s: usize, x: &[Vec3]) -> Result<f64, Inadmissible> {
        let volume = match self.lid(s) {
            Some(lid) => lid.volume(x),
            None => self.volume_of(s, &self.points(&self.limits[s], x)),
        };
        Ok(-self.pressure * volume)
    }

    fn derivatives(
        &self,
        s: usize,
        x: &[Vec3],
        local: &mut LocalDerivatives,
    ) -> Result<f64, Inadmissible> {
        if let Some(lid) = self.lid(s) {
            self.add_derivatives_of_lid(lid, x, local);
            return Ok(-self.pressure * lid.volume(x));
        }
        vectorize(DerivativesOf { chamber: self, s, x, local })
    }
}

/// The derivatives of one stencil's energy.
struct DerivativesOf<'a> {
    chamber: &'a ChamberPressure,
    s: usize,
    x: &'a [Vec3],
    local: &'a mut LocalDerivatives,
}

impl WithSimd for DerivativesOf<'_> {
    type Output = Result<f64, Inadmissible>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Self { chamber, s, x, local } = self;
        let (limits, pressure) = (&chamber.limits[s], chamber.pressure);
        let points = chamber.points(limits, x);
        let by_point = chamber.gradient_of(s, &points);
        for (gradient, weights) in local.gradient_mut().iter_mut().zip(limits) {
            *gradient -= pressure * combine(&by_point, weights);
        }
        if local.with_hessian() {
            let axes = chamber.hessian_axes_of(s, &points);
            for (j, weights) in limits.iter().enumerate() {
                let mut half = [Axis::default(); 6];
                for (half, axes) in half.iter_mut().zip(&axes) {
                    add_combination(simd, half, axes.each_ref(), &weights.map(|w| -pressure * w));
                }
                for (block, row) in local.column_mut(j).iter_mut().zip(&limits[j..]) {
                    let mut axis = Axis::default();
                    add_combination(simd, &mut axis, half.each_ref(), row);
                    block.add_cross(axis);
                }
            }
        }
        Ok(-pressure * chamber.volume_of(s, &points))
    }
}

impl ChamberPressure {
    fn add_derivatives_of_lid(&self, lid: &LidFan, x: &[Vec3], local: &mut LocalDerivatives) {
        for (sum, share) in local.gradient_mut().iter_mut().zip(lid.gradient(x)) {
            *sum -= self.pressure * share;
        }
        if local.with_hessian() {
            lid.hessian_axes(x, |i, j, axis| {
                let [x, y, z] = (-self.pressure * axis).into();
                local.block_mut(i, j).add_cross([x, y, z, 0.0]);
            });
        }
    }
}

/// The places of a stencil's nodes.
fn places(stencil: &[u32], positions: &[Vec3]) -> Vec<Vec3> {
    stencil.iter().map(|&v| positions[v as usize]).collect()
}

impl Fan {
    /// Chords of the edge between the element's points, against the element's own turn, with their weights: as [`FACETS`].
    fn edges(&self) -> [([usize; 2], f64); 3] {
        let [a, middle, b] = self.along;
        [([middle, a], 4.0 / 3.0), ([b, middle], 4.0 / 3.0), ([b, a], -1.0 / 3.0)]
    }
}

#[inline(always)]
fn combine(vectors: &[Vec3; 6], weights: &[f64; 6]) -> Vec3 {
    vectors.iter().zip(weights).fold(Vec3::zeros(), |sum, (v, w)| sum + *w * v)
}

/// Facets over an element's corners (0, 1, 2) and edge midpoints (3, 4, 5), with their weights: four thirds of the small
/// ones, less a third of the large one.
const FACETS: [([usize; 3], f64); 5] = [
    ([0, 5, 4], 4.0 / 3.0),
    ([1, 3, 5], 4.0 / 3.0),
    ([2, 4, 3], 4.0 / 3.0),
    ([3, 4, 5], 4.0 / 3.0),
    ([0, 1, 2], -1.0 / 3.0),
];

#[inline(always)]
fn facet_volume(points: &[Vec3; 6]) -> f64 {
    let volume =
        |&([a, b, c], w): &([usize; 3], f64)| w / 6.0 * points[a].dot(&points[b].cross(&points[c]));
    FACETS.iter().map(volume).sum()
}

#[inline(always)]
fn facet_gradient(points: &[Vec3; 6]) -> [Vec3; 6] {
    let mut gradient = [Vec3::zeros(); 6];
    for ([a, b, c], w) in FACETS {
        for [a, b, c] in [[a, b, c], [b, c, a], [c, a, b]] {
            gradient[a] += w / 6.0 * points[b].cross(&points[c]);
        }
    }
    gradient
}

/// A vector, and one number that is never read: a register of four.
type Axis = [f64; 4];

/// Axes `w_pq` of the skew blocks `d2V/dx_p dx_q = [w_pq]x`, as `[p][q]`.
type Axes = [[Axis; 6]; 6];

#[inline(always)]
fn facet_hessian_axes(points: &[Vec3; 6]) -> Axes {
    let mut axes = Axes::default();
    for ([a, b, c], w) in FACETS {
        for [a, b, c] in [[a, b, c], [b, c, a], [c, a, b]] {
            add_axis(&mut axes, [a, b], -w / 6.0 * points[c]);
        }
    }
    axes
}

/// Adds `axis` to that of points `p, q`, and takes it from that of `q, p`.
#[inline(always)]
fn add_axis(axes: &mut Axes, [p, q]: [usize; 2], axis: Vec3) {
    for (k, component) in axis.iter().enumerate() {
        axes[p][q][k] += component;
        axes[q][p][k] -= component;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::term_suite::{Case, term_suite};
    use crate::model::test_shells::{TestShell, difference};
    use nalgebra::Isometry3;

    const PRESSURE: f64 = 0.03;

    fn pressurised(shell: &TestShell) -> Case<ChamberPressure> {
        let mut term = ChamberPressure::new(&shell.points());
        term.pressure = PRESSURE;
        let motion = Isometry3::new(Vec3::new(3.0, -5.0, 2.0), Vec3::new(0.4, 1.9, -0.7));
        Case { term, positions: shell.deformed.clone(), motion }
    }

    term_suite!(chamber, pressurised);

    /// An egg with fans on some of its edges, about an origin of its own.
    fn fanned(shell: &TestShell) -> Case<ChamberPressure> {
        let points = shell.points();
        let fan = |points: &ElementPoints| Fan {
            points: points.clone(),
            along: [0, 5, 1],
            apex: Vec3::new(3.0, -20.0, 1.0),
        };
        let fans = points.iter().step_by(7).map(fan).collect();
        let mut term = ChamberPressure::cut(&points, fans, Vec3::new(1.0, 2.0, -30.0));
        term.pressure = PRESSURE;
        Case { term, positions: shell.deformed.clone(), motion: Isometry3::identity() }
    }

    term_suite!(cut_chamber, fanned);

    /// Force and moment of the pressure vanish to rounding against pressure times area (times 10 mm), as on any
    /// closed surface.
    #[test]
    fn pressure_is_in_balance() {
        for seed in 0..4 {
            let shell = TestShell::new(seed);
            let chamber = ChamberPressure::new(&shell.points());
            let mut gradient = vec![Vec3::zeros(); shell.deformed.len()];
            chamber.add_volume_gradient(&shell.deformed, &mut gradient);
            let area: f64 = gradient.iter().map(|g| g.norm()).sum();
            let force: Vec3 = gradient.iter().sum();
            let moment: Vec3 = shell.deformed.iter().zip(&gradient).map(|(x, g)| x.cross(g)).sum();
            assert!(force.norm() <= 1e-15 * area, "{:e}", force.norm() / area);
            assert!(moment.norm() <= 1e-15 * area * 10.0, "{:e}", moment.norm() / area);
            // Euler: the volume is of degree three.
            let virial: f64 = shell.deformed.iter().zip(&gradient).map(|(x, g)| x.dot(g)).sum();
            let volume = chamber.volume(&shell.deformed);
            assert!((virial / (3.0 * volume) - 1.0).abs() < 1e-13);
        }
    }

    #[test]
    fn volume_gradient_is_the_difference_of_the_volume() {
        let shell = TestShell::new(5);
        let chamber = ChamberPressure::new(&shell.points());
        let mut gradient = vec![Vec3::zeros(); shell.deformed.len()];
        chamber.add_volume_gradient(&shell.deformed, &mut gradient);
        for (v, gradient) in gradient.iter().enumerate() {
            for axis in 0..3 {
                let slope = difference(1e-2, |h| {
                    let mut x = shell.deformed.clone();
                    x[v][axis] += h;
                    chamber.volume(&x)
                });
                // Exact for a cubic; a volume of 4,000 mm^3 is rounded to 1e-12, over a step of 1e-2.
                assert!((slope - gradient[axis]).abs() < 1e-9, "{slope} {}", gradient[axis]);
            }
        }
    }

    /// The chamber of a fitted sphere: what facets between points of the limit surface lose with the square of their edges is
    /// extrapolated away.
    #[test]
    fn volume_of_spheres_converges_to_fourth_order() {
        use crate::mesh::{ShellMesh, ShellSettings};
        use crate::model::element::{LoopBasis, fitted_control_points};
        use crate::surface::TriangleMesh;

        let settings = ShellSettings { thickness: 0.5, clamp_height: 8.0, ..Default::default() };
        let errors = [1, 2, 3].map(|subdivisions| {
            let mesh = ShellMesh::new(TriangleMesh::sphere(10.0, subdivisions), &settings).unwrap();
            let bases = LoopBasis::of_stencils(&mesh.stencils);
            let control = fitted_control_points(&mesh, &bases).unwrap();
            let exact = 4000.0 / 3.0 * std::f64::consts::PI;
            let points = ElementPoints::of_stencils(&mesh.stencils, &bases);
            1.0 - ChamberPressure::new(&points).volume(&control) / exact
        });
        for pair in errors.windows(2) {
            let order = (pair[0] / pair[1]).abs().log2();
            assert!(order > 3.5, "{errors:?}");
        }
        assert!(errors[2].abs() < 1e-4, "{errors:?}");
    }
}
