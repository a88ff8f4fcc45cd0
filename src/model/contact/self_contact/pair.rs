//! The barrier between two parts of a wall: a point and a facet, or two edges.
//!
//! ```text
//! gap      d = D - xi                                   D = distance of the mid-surfaces, xi = how thick the wall counts
//! b(d)     = -(d - h)^2 ln(d / h)   for 0 < d < h,  0 beyond
//! point i and facet f      kappa A_i / 2 (b(d_f) - 1/2 sum_sides b(d_side) + sum_corners b(d_corner) / n_corner)
//! edges e and f            kappa A_ef m b(d_ef)
//! ```
//!
//! With a gap that begins at the thickness, a point is near many facets at once. Summed over the facets around it the
//! formula counts the nearest place once: facets less inner sides plus inner corners of what is near make one (Euler), each
//! facet bringing half of each side and `1 / n` of a corner where `n` facets meet. So the pressure between two walls is
//! that of the gap, `kappa |b'(d)|`, whatever their meshes. Both walls have points, hence the half.
//!
//! Edges that cross see what points and facets miss, and no more is asked of them than to stay apart; their share
//! `A_ef` is a twentieth. Where edges become parallel, their closest points jump and the ends take over:
//!
//! ```text
//! m = c / e (2 - c / e)   for c < e,  1 beyond,      c = |a x b|^2,  e = 1e-3 |a|^2 |b|^2 at rest
//! A_ef = 1/20 A_e A_f / ((A_e + A_f) / 2 + 0.9 xi h)       0.9 xi h = the area around a point that is near it
//! ```
//!
//! Source: Li et al. (2020), barrier and mollifier of incremental potential contact; Li et al. (2023), convergent
//! incremental potential contact: areas and sides as weights.

use nalgebra::Matrix3;

use super::distance::Closest;
use super::wall_surface::{Couple, Kind, WallSurface};
use crate::math::Vec3;
use crate::model::system::Inadmissible;

/// Two parts of a wall and the barrier between them.
#[derive(Clone, Debug)]
pub(super) struct Pair {
    /// Of the twelve points of two triangles.
    pub(super) points: [u8; 4],
    kind: Kind,
    /// MPa/mm mm^2.
    weight: f64,
    /// How thick the wall counts, mm.
    pub(super) thickness: f64,
    /// mm.
    activation: f64,
    /// `e` of two edges, mm^4.
    parallel: f64,
}

/// Energy of one pair, and its derivatives with respect to the four points.
#[derive(Clone, Debug, Default)]
pub(super) struct PairDerivatives {
    pub(super) energy: f64,
    pub(super) gradient: [Vec3; 4],
    pub(super) hessian: [[Matrix3<f64>; 4]; 4],
}

/// Share of the surface that edges answer for.
const EDGE_SHARE: f64 = 0.05;
/// `sin^2` of the angle below which the barrier of two edges fades.
const PARALLEL: f64 = 1e-3;
/// Of the facets around a point, the area that is near where the gap is half the activation, in `xi h`: the barrier's
/// integral over it is `2 pi xi b(h / 2) / |b'(h / 2)|` times its slope.
const NEAR_AREA: f64 = 0.9;

impl Pair {
    /// The barrier of `couple`, of `stiffness` (MPa/mm), that begins at a gap of `activation` (mm) or half of that at rest.
    pub(super) fn new(
        couple: &Couple,
        surface: &WallSurface,
        activation: f64,
        stiffness: f64,
    ) -> Self {
        let [thickness, room] = surface.thickness_of(couple);
        let activation = activation.min(0.5 * (room - thickness));
        let area = match couple.kind {
            Kind::PointFacet { .. } => 0.5 * surface.areas[couple.samples[0] as usize],
            Kind::Edges { areas: [e, f] } => {
                EDGE_SHARE * e * f / (0.5 * (e + f) + NEAR_AREA * thickness * activation)
            }
        };
        let rest = surface.at_rest(&couple.samples);
        let of_kind = Self::of_kind(couple.kind, stiffness * area, [thickness, activation], &rest);
        Self { points: couple.points, ..of_kind }
    }

    /// A barrier between the first points of all, which are at `rest` at rest.
    pub(super) fn of_kind(
        kind: Kind,
        weight: f64,
        [thickness, activation]: [f64; 2],
        rest: &[Vec3; 4],
    ) -> Self {
        let [a, b] = edge_vectors(rest);
        let parallel = PARALLEL * a.norm_squared() * b.norm_squared();
        Self { points: [0, 1, 2, 3], kind, weight, thickness, activation, parallel }
    }

    /// The closest points of the two parts whose corners are at `x`.
    pub(super) fn closest(&self, x: &[Vec3; 4]) -> Closest {
        self.kind.closest(x)
    }

    /// How many of the four points are on the first side.
    pub(super) fn first(&self) -> usize {
        self.kind.first()
    }

    /// Energy and derivatives where the four points are at `x`; the Hessian only `with_hessian`. None where it does not act.
    ///
    /// # Errors
    /// [`Inadmissible`] where there is no gap.
    pub(super) fn derivatives(
        &self,
        x: &[Vec3; 4],
        with_hessian: bool,
    ) -> Result<Option<PairDerivatives>, Inadmissible> {
        let closest = self.kind.closest(x);
        let gap = closest.distance - self.thickness;
        if gap <= 0.0 || gap.is_nan() {
            return Err(Inadmissible("folds of the wall touch"));
        }
        if gap >= self.activation {
            return Ok(None);
        }
        let mut sum = PairDerivatives::default();
        match self.kind {
            Kind::PointFacet { sides, tips } => {
                self.add(&closest, 1.0, with_hessian, &mut sum);
                for (ends, count) in [[1, 2], [2, 3], [3, 1]].into_iter().zip(sides) {
                    let closest = Closest::of_point_and_edge(x, 0, ends, 1.0);
                    self.add(&closest, count, with_hessian, &mut sum);
                }
                for (corner, count) in (1..4).zip(tips) {
                    let closest = Closest::of_points(x, 0, corner, 1.0);
                    self.add(&closest, count, with_hessian, &mut sum);
                }
            }
            Kind::Edges { .. } => {
                self.add(&closest, 1.0, with_hessian, &mut sum);
                self.mollify(x, with_hessian, &mut sum);
            }
        }
        Ok(Some(sum))
    }

    /// Adds `count` barriers of the distance of `closest`.
    fn add(&self, closest: &Closest, count: f64, with_hessian: bool, sum: &mut PairDerivatives) {
        let gap = closest.distance - self.thickness;
        if gap >= self.activation || count == 0.0 {
            return;
        }
        let [value, slope, curvature] =
            barrier(gap, self.activation).map(|b| count * self.weight * b);
        sum.energy += value;
        let w = closest.weights;
        for (gradient, w) in sum.gradient.iter_mut().zip(w) {
            *gradient += slope * w * closest.normal;
        }
        if with_hessian {
            let nn = curvature * closest.normal * closest.normal.transpose();
            for (i, row) in sum.hessian.iter_mut().enumerate() {
                for (j, block) in row.iter_mut().enumerate() {
                    *block += slope * closest.hessian(i, j) + w[i] * w[j] * nn;
                }
            }
        }
    }

    /// Multiplies the barrier of two edges by what fades as they become parallel.
    fn mollify(&self, x: &[Vec3; 4], with_hessian: bool, sum: &mut PairDerivatives) {
        let [a, b] = edge_vectors(x);
        let c = a.cross(&b).norm_squared();
        if c >= self.parallel {
            return;
        }
        let share = c / self.parallel;
        let [m, slope, curvature] = [
            share * (2.0 - share),
            2.0 * (1.0 - share) / self.parallel,
            -2.0 / (self.parallel * self.parallel),
        ];
        // c = a.a b.b - (a.b)^2 of a = x1 - x0, b = x3 - x2.
        let (aa, bb, ab) = (a.norm_squared(), b.norm_squared(), a.dot(&b));
        let (of_a, of_b) = (2.0 * (bb * a - ab * b), 2.0 * (aa * b - ab * a));
        let c_gradient = [-of_a, of_a, -of_b, of_b];
        let (energy, gradient) = (sum.energy, sum.gradient);
        if with_hessian {
            let identity = Matrix3::identity();
            let aa_block = 2.0 * (bb * identity - b * b.transpose());
            let bb_block = 2.0 * (aa * identity - a * a.transpose());
            let ab_block = 4.0 * a * b.transpose() - 2.0 * b * a.transpose() - 2.0 * ab * identity;
            let c_hessian = |i: usize, j: usize| {
                let sign = if (i + j).is_multiple_of(2) { 1.0 } else { -1.0 };
                sign * match (i < 2, j < 2) {
                    (true, true) => aa_block,
                    (false, false) => bb_block,
                    (true, false) => ab_block,
                    (false, true) => ab_block.transpose(),
                }
            };
            for (i, row) in sum.hessian.iter_mut().enumerate() {
                for (j, block) in row.iter_mut().enumerate() {
                    let mixed = gradient[i] * c_gradient[j].transpose()
                        + c_gradient[i] * gradient[j].transpose();
                    let cc = c_gradient[i] * c_gradient[j].transpose();
                    *block = m * *block
                        + slope * (mixed + energy * c_hessian(i, j))
                        + curvature * energy * cc;
                }
            }
        }
        sum.energy *= m;
        for ((sum, gradient), c) in sum.gradient.iter_mut().zip(gradient).zip(c_gradient) {
            *sum = m * gradient + slope * energy * c;
        }
    }
}

fn edge_vectors(x: &[Vec3; 4]) -> [Vec3; 2] {
    [x[1] - x[0], x[3] - x[2]]
}

/// The barrier `b` with its first and second derivative at a gap `d` below the activation `h`.
pub(super) fn barrier(d: f64, h: f64) -> [f64; 3] {
    let ln = (d / h).ln();
    let below = d - h;
    [
        -below * below * ln,
        -2.0 * below * ln - below * below / d,
        -2.0 * ln - 4.0 * below / d + below * below / (d * d),
    ]
}
