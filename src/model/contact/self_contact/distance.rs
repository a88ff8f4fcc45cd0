//! Distance of a point from a facet, and of an edge from an edge, with exact derivatives.
//!
//! ```text
//! D^2 = min over s of |r|^2,   r = sum_i w_i(s) x_i,   w_i = alpha_i + beta_i . s      (x: four points)
//! grad_i D^2 = 2 w_i r                                                     (envelope theorem)
//! hess_ij D^2 = 2 w_i w_j I - 2 sum_kl (beta_ik r + w_i T_k) G^-1_kl (beta_jl r + w_j T_l)^T
//! T_k = sum_i beta_ik x_i,   G_kl = T_k . T_l
//! ```
//!
//! `s` are the parameters of the two features that are closest: none of point and point, one of point and edge, two of
//! point and facet or edge and edge. The distance and its gradient are continuous where the features change.

use nalgebra::Matrix3;

use crate::math::Vec3;

/// The closest points of two simplices of four points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Closest {
    /// Weights of the four points in the difference `r`.
    pub(super) weights: [f64; 4],
    /// The unit vector along `r`.
    pub(super) normal: Vec3,
    /// mm.
    pub(super) distance: f64,
    r: Vec3,
    beta: [[f64; 2]; 4],
    tangents: [Vec3; 2],
    /// Of `G`; zero where a parameter is not free.
    inverse: [[f64; 2]; 2],
}

/// The difference of two features as a function of their parameters.
#[derive(Clone, Copy, Default)]
struct Features {
    alpha: [f64; 4],
    beta: [[f64; 2]; 4],
}

/// `sin^2` of the angle under which two edges, or two sides of a facet, count as parallel: there ends are as close.
const PARALLEL: f64 = 1e-12;

impl Closest {
    /// Of the point `x[0]` and the facet `x[1..4]`.
    pub(super) fn of_point_and_facet(x: &[Vec3; 4]) -> Self {
        let mut inside = Features { alpha: [1.0, -1.0, 0.0, 0.0], ..Features::default() };
        inside.beta = [[0.0; 2], [1.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];
        let over_facet = inside.solve_two(x);
        over_facet.filter(|it| it.weights[1..].iter().all(|w| *w <= 0.0)).unwrap_or_else(|| {
            Self::nearest(x, [[1, 2], [2, 3], [3, 1]].map(|ends| (0, ends, 1.0)))
        })
    }

    /// Of the edges `x[0..2]` and `x[2..4]`.
    pub(super) fn of_edges(x: &[Vec3; 4]) -> Self {
        let mut inside = Features { alpha: [1.0, 0.0, -1.0, 0.0], ..Features::default() };
        inside.beta = [[-1.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, -1.0]];
        let crossing = inside.solve_two(x).filter(|it| {
            let [a, b, c, d] = it.weights;
            a >= 0.0 && b >= 0.0 && c <= 0.0 && d <= 0.0
        });
        crossing.unwrap_or_else(|| {
            let ends = [(0, [2, 3], 1.0), (1, [2, 3], 1.0), (2, [0, 1], -1.0), (3, [0, 1], -1.0)];
            Self::nearest(x, ends)
        })
    }

    /// Of the nearest of several points and edges, each as in [`Self::of_point_and_edge`].
    fn nearest<const N: usize>(x: &[Vec3; 4], all: [(usize, [usize; 2], f64); N]) -> Self {
        let squares = all.map(|(point, [a, b], _)| squared_distance(x[point], x[a], x[b]));
        let nearest = (1..N).fold(0, |best, k| if squares[k] < squares[best] { k } else { best });
        let (point, ends, sign) = all[nearest];
        Self::of_point_and_edge(x, point, ends, sign)
    }

    /// Of the point `x[point]` and the edge between `x[ends]`; `sign` is that of the point in `r`.
    pub(super) fn of_point_and_edge(
        x: &[Vec3; 4],
        point: usize,
        [a, b]: [usize; 2],
        sign: f64,
    ) -> Self {
        let (along, from) = (x[b] - x[a], x[point] - x[a]);
        let squared = along.norm_squared();
        let s = along.dot(&from) / squared;
        if s <= 0.0 || s >= 1.0 || squared == 0.0 {
            return Self::of_points(x, point, if s >= 1.0 { b } else { a }, sign);
        }
        let mut features = Features::default();
        features.alpha[point] = sign;
        features.alpha[a] = -sign;
        features.beta[a][0] = sign;
        features.beta[b][0] = -sign;
        features.at(x, [s, 0.0], [[1.0 / squared, 0.0], [0.0; 2]])
    }

    /// Of the points `x[point]` and `x[other]`.
    pub(super) fn of_points(x: &[Vec3; 4], point: usize, other: usize, sign: f64) -> Self {
        let mut features = Features::default();
        features.alpha[point] = sign;
        features.alpha[other] = -sign;
        features.at(x, [0.0; 2], [[0.0; 2]; 2])
    }

    /// Half the Hessian of `D^2`, block of points `i` and `j`.
    fn half_hessian(&self, i: usize, j: usize) -> Matrix3<f64> {
        let w = self.weights;
        let mut block = Matrix3::from_diagonal_element(w[i] * w[j]);
        let mixed = |i: usize, k: usize| self.beta[i][k] * self.r + w[i] * self.tangents[k];
        for (k, row) in self.inverse.iter().enumerate() {
            for (l, &inverse) in row.iter().enumerate() {
                if inverse != 0.0 {
                    block -= inverse * mixed(i, k) * mixed(j, l).transpose();
                }
            }
        }
        block
    }

    /// The Hessian of `D`, block of points `i` and `j`, 1/mm.
    pub(super) fn hessian(&self, i: usize, j: usize) -> Matrix3<f64> {
        let along = self.weights[i] * self.weights[j] * self.normal * self.normal.transpose();
        (self.half_hessian(i, j) - along) / self.distance
    }
}

impl Features {
    /// The closest points where both parameters are free; none where they are not determined.
    fn solve_two(&self, x: &[Vec3; 4]) -> Option<Closest> {
        let [t, u] = self.tangents(x);
        let r: Vec3 = self.alpha.iter().zip(x).map(|(alpha, x)| *alpha * x).sum();
        let (tt, tu, uu) = (t.norm_squared(), t.dot(&u), u.norm_squared());
        let determinant = tt * uu - tu * tu;
        if determinant <= PARALLEL * tt * uu {
            return None;
        }
        let inverse =
            [[uu, -tu], [-tu, tt]].map(|row: [f64; 2]| row.map(|entry| entry / determinant));
        let s = inverse.map(|row| -(row[0] * t.dot(&r) + row[1] * u.dot(&r)));
        Some(self.at(x, s, inverse))
    }

    fn at(&self, x: &[Vec3; 4], s: [f64; 2], inverse: [[f64; 2]; 2]) -> Closest {
        let weight = |i: usize| self.alpha[i] + self.beta[i][0] * s[0] + self.beta[i][1] * s[1];
        let weights = [0, 1, 2, 3].map(weight);
        // From one of the points: small against their distance from the origin.
        let r: Vec3 = weights.iter().zip(x).map(|(w, at)| *w * (at - x[0])).sum();
        let distance = r.norm();
        let normal = if distance > 0.0 { r / distance } else { Vec3::zeros() };
        let (beta, tangents) = (self.beta, self.tangents(x));
        Closest { weights, normal, distance, r, beta, tangents, inverse }
    }

    fn tangents(&self, x: &[Vec3; 4]) -> [Vec3; 2] {
        [0, 1].map(|k| self.beta.iter().zip(x).map(|(beta, x)| beta[k] * x).sum())
    }
}

/// The square of the distance of a point from the edge between `a` and `b`, mm^2.
fn squared_distance(point: Vec3, a: Vec3, b: Vec3) -> f64 {
    let (along, from) = (b - a, point - a);
    let s = along.dot(&from) / along.norm_squared();
    // An edge without length is its end.
    let s = if s > 0.0 { s.min(1.0) } else { 0.0 };
    (from - s * along).norm_squared()
}
