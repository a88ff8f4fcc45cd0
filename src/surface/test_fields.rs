//! Fields with known surfaces, for the tests of this room.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::field::ScalarField;
use crate::math::Vec3;

/// A closure as a field; the gradient by central differences.
pub(crate) struct Analytic<F>(pub(crate) F);

impl<F: Fn(Vec3) -> f64 + Sync> ScalarField for Analytic<F> {
    fn value(&self, point: Vec3) -> f64 {
        (self.0)(point)
    }

    fn value_and_gradient(&self, point: Vec3) -> (f64, Vec3) {
        let slope =
            |axis: Vec3| (self.value(point + 1e-6 * axis) - self.value(point - 1e-6 * axis)) / 2e-6;
        (self.value(point), Vec3::new(slope(Vec3::x()), slope(Vec3::y()), slope(Vec3::z())))
    }
}

/// The signed distance to a sphere about the origin.
pub(crate) fn sphere(radius: f64) -> impl ScalarField {
    Analytic(move |p: Vec3| p.norm() - radius)
}

/// The signed distance to a torus about the z axis.
pub(crate) fn torus(major: f64, minor: f64) -> impl ScalarField {
    Analytic(move |p: Vec3| (p.x.hypot(p.y) - major).hypot(p.z) - minor)
}

/// The part of `field`'s inside that lies in the box.
pub(crate) fn capped(field: impl ScalarField, lower: Vec3, upper: Vec3) -> impl ScalarField {
    Analytic(move |p: Vec3| (lower - p).sup(&(p - upper)).max().max(field.value(p)))
}

/// A sum of cosines with random wave vectors and phases, positive outside a ball of radius 7.5 mm.
pub(crate) struct Ripples {
    waves: Vec<(Vec3, f64)>,
}

impl Ripples {
    /// `waves`: the largest wave number times 8 mm.
    pub(crate) fn new(seed: u64, waves: f64) -> Self {
        let mut chance = ChaCha8Rng::seed_from_u64(seed);
        let mut component = || chance.random_range(-1.0..1.0) * waves / 8.0;
        let waves =
            (0..8).map(|_| (Vec3::from_fn(|_, _| component()), 8.0 * component())).collect();
        Self { waves }
    }
}

impl ScalarField for Ripples {
    fn value(&self, point: Vec3) -> f64 {
        self.value_and_gradient(point).0
    }

    fn value_and_gradient(&self, point: Vec3) -> (f64, Vec3) {
        let mut value = (point.norm_squared() - 40.0) / 20.0;
        let mut gradient = point / 10.0;
        for (wave, phase) in &self.waves {
            let angle = wave.dot(&point) + phase;
            value += angle.cos();
            gradient -= wave * angle.sin();
        }
        (value, gradient)
    }
}
