//! Angles, areas and how they are mapped.

use nalgebra::Matrix3;

use super::Vec3;

/// The angle between two vectors, rad, in [0, pi], exact to rounding for small angles too; 0 where
/// either vector is zero.
#[must_use]
#[inline]
pub fn angle_between(a: Vec3, b: Vec3) -> f64 {
    a.cross(&b).norm().atan2(a.dot(&b))
}

/// The normal of a triangle times its area, mm^2; it points to where the corners are seen to turn
/// counter-clockwise.
#[must_use]
#[inline]
pub fn area_vector([a, b, c]: [Vec3; 3]) -> Vec3 {
    (b - a).cross(&(c - a)) / 2.0
}

/// `det(F) F^-T`, which maps area vectors as `F` maps lines.
#[must_use]
#[inline]
pub fn cofactor(f: &Matrix3<f64>) -> Matrix3<f64> {
    let [a, b, c] = [0, 1, 2].map(|k| f.column(k).into_owned());
    Matrix3::from_columns(&[b.cross(&c), c.cross(&a), a.cross(&b)])
}
