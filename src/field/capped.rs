//! A network's field closed inside a design box, with rounded rims: a chamber that can be meshed.
//!
//! ```text
//! g = f / sqrt(|grad f|^2 + (f / ell)^2)             first-order distance, |g| <= ell
//! h = min(-r, max_i a_i) + |(max(r + a_i, 0))_i|     a = (g, x faces, y faces, z faces)
//! ```
//! g has the zero set of f (Taubin 1994, Distance approximations for rasterizing implicit curves).
//! h is the intersection of g < 0 with the box. Where one a_i exceeds -r it equals a_i exactly;
//! where two do, orthogonal planes meet in a circular fillet of radius r, and three in a spherical
//! corner. The result is no distance: h is first-order accurate at its zero set only.

use crate::math::Vec3;

use super::ScalarField;
use super::compile::CompiledNetwork;
use super::design_box::DesignBox;
use super::quantity::Jet;

/// A network's field with a flat cap at every box face that its cavity meets, and rounded rims.
///
/// With a rim radius of 0 the caps meet the wall at a sharp edge.
/// The gradient jumps where the nearest of several faces changes, and where the network's does.
#[derive(Clone, Debug, PartialEq)]
pub struct CappedField {
    network: CompiledNetwork,
    design_box: DesignBox,
    rim_radius: f64,
}

/// A rim radius that does not fit the design box.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "rim radius {rim_radius} mm is not in [0, {limit}): below half the box's shortest side, and 10 mm"
)]
pub struct RimError {
    rim_radius: f64,
    limit: f64,
}

impl CappedField {
    /// `network` inside `design_box`, with rims rounded at `rim_radius` mm.
    ///
    /// # Errors
    /// [`RimError`] when the radius is negative or opposite faces would meet in one rim.
    pub fn new(
        network: CompiledNetwork,
        design_box: DesignBox,
        rim_radius: f64,
    ) -> Result<Self, RimError> {
        Self::check_rim(design_box, rim_radius)?;
        Ok(Self { network, design_box, rim_radius })
    }

    /// Whether rims of `design_box` can be rounded at `rim_radius` mm.
    ///
    /// # Errors
    /// [`RimError`] when the radius is negative or opposite faces would meet in one rim.
    pub fn check_rim(design_box: DesignBox, rim_radius: f64) -> Result<(), RimError> {
        let limit = (design_box.sides().min() / 2.0).min(SATURATION);
        let fits = (0.0..limit).contains(&rim_radius);
        if fits { Ok(()) } else { Err(RimError { rim_radius, limit }) }
    }

    /// The box, mm.
    #[must_use]
    pub fn design_box(&self) -> &DesignBox {
        &self.design_box
    }

    /// The radius of the rims, mm.
    #[must_use]
    pub fn rim_radius(&self) -> f64 {
        self.rim_radius
    }

    fn capped(&self, point: Vec3, jet: Jet<0>) -> f64 {
        let norm = self.squared_norm(point, jet.value, jet.first).sqrt();
        let [x, y, z] = self.design_box.face_distances(point);
        let distances = [first_order_distance(jet.value, norm), x.0, y.0, z.0];
        self.rounded_max(distances)
    }

    fn rounded_max(&self, distances: [f64; 4]) -> f64 {
        let r = self.rim_radius;
        let nearest = distances.into_iter().fold(f64::NEG_INFINITY, f64::max);
        if nearest <= -r {
            return nearest;
        }
        distances.map(|a| (r + a).max(0.0)).iter().map(|e| e * e).sum::<f64>().sqrt() - r
    }

    /// `|grad f|^2 + (f / ell)^2`, with the tangential part of the gradient moderated near the axis
    /// of a network that uses theta (see [`AXIS_RADIUS`]).
    fn squared_norm(&self, p: Vec3, f: f64, [fx, fy, fz]: [f64; 3]) -> f64 {
        let across = if self.network.uses_theta {
            let rho = p.x.hypot(p.y).max(NEAREST);
            let radial = (p.x * fx + p.y * fy) / rho;
            let turning = p.x * fy - p.y * fx;
            radial * radial + turning * turning / (rho * rho + AXIS_RADIUS * AXIS_RADIUS)
        } else {
            fx * fx + fy * fy
        };
        across + fz * fz + (f / SATURATION) * (f / SATURATION)
    }

    /// Half the gradient of [`Self::squared_norm`].
    fn half_gradient_of_squared_norm(&self, p: Vec3, jet: &Jet<6>) -> Vec3 {
        let gradient = Vec3::from(jet.first);
        let [fx, fy, fz] = jet.first;
        let [fxx, fyy, fzz, fyz, fxz, fxy] = jet.second;
        let rows = [Vec3::new(fxx, fxy, fxz), Vec3::new(fxy, fyy, fyz), Vec3::new(fxz, fyz, fzz)];
        let across = if self.network.uses_theta {
            let rho = p.x.hypot(p.y).max(NEAREST);
            let moderated = rho * rho + AXIS_RADIUS * AXIS_RADIUS;
            let outward = Vec3::new(p.x, p.y, 0.0);
            let radial = (p.x * fx + p.y * fy) / rho;
            let d_radial = (Vec3::new(fx, fy, 0.0) + rows[0] * p.x + rows[1] * p.y) / rho
                - outward * (radial / (rho * rho));
            let turning = p.x * fy - p.y * fx;
            let d_turning = Vec3::new(fy, -fx, 0.0) + rows[1] * p.x - rows[0] * p.y;
            d_radial * radial + d_turning * (turning / moderated)
                - outward * (turning / moderated * (turning / moderated))
        } else {
            rows[0] * fx + rows[1] * fy
        };
        across + rows[2] * fz + gradient * (jet.value / (SATURATION * SATURATION))
    }
}

impl ScalarField for CappedField {
    fn value(&self, point: Vec3) -> f64 {
        self.capped(point, self.network.jet(point))
    }

    fn value_and_gradient(&self, point: Vec3) -> (f64, Vec3) {
        let jet = self.network.jet::<6>(point);
        let norm = self.squared_norm(point, jet.value, jet.first).sqrt();
        let g = first_order_distance(jet.value, norm);
        let g_gradient = if norm > FLAT {
            let d_norm = self.half_gradient_of_squared_norm(point, &jet) / norm;
            (Vec3::from(jet.first) - d_norm * g) / norm
        } else {
            Vec3::zeros()
        };
        let faces = self.design_box.face_distances(point);
        let distances = [g, faces[0].0, faces[1].0, faces[2].0];
        let value = self.rounded_max(distances);
        let share = |i: usize| {
            if value <= -self.rim_radius {
                let nearest = distances.iter().position(|&a| a == value);
                if nearest == Some(i) { 1.0 } else { 0.0 }
            } else {
                (self.rim_radius + distances[i]).max(0.0) / (self.rim_radius + value)
            }
        };
        let face_shares = std::array::from_fn(|i| faces[i].1 * share(i + 1));
        (value, g_gradient * share(0) + Vec3::from(face_shares))
    }

    fn values_along_z(&self, origin: Vec3, step: f64, values: &mut [f64]) {
        self.network.jets_along_z(origin, step, values.len(), |i, z, jet| {
            values[i] = self.capped(Vec3::new(origin.x, origin.y, z), jet);
        });
    }
}

fn first_order_distance(f: f64, norm: f64) -> f64 {
    if norm > FLAT { f / norm } else { 0.0 }
}

/// `ell`: what |g| tends to where the gradient vanishes, mm; well above any rim radius.
const SATURATION: f64 = 10.0;

/// Theta's gradient grows as 1/rho, which would make g vanish on the axis deep inside a chamber and
/// dent the caps there. Below this distance from the axis the growth is stopped, mm. On a wall at
/// 8 mm it lengthens g by at most sqrt(1 + (2/8)^2), 3 %, and moves no zero.
const AXIS_RADIUS: f64 = 2.0;

/// Replaces a distance of 0 from the axis, mm.
const NEAREST: f64 = 1e-8;

/// A field whose value and gradient are both below this has no distance; g is 0.
const FLAT: f64 = 1e-60;

#[cfg(test)]
mod tests {
    use super::*;
    use approx::{assert_abs_diff_eq, assert_relative_eq};

    /// `x^2 + y^2 - R^2` for R = 8 mm, in mm.
    const CYLINDER: &str = "length_unit_mm = 1
        [[node]]
        name = 'x2'
        activation = 'squared'
        links = { x = 1 }
        [[node]]
        name = 'y2'
        activation = 'squared'
        links = { y = 1 }
        [[node]]
        name = 'cylinder'
        links = { x2 = 1, y2 = 1 }
        bias = -64";

    fn capped(text: &str, rim_radius: f64) -> CappedField {
        let network = CompiledNetwork::new(&text.parse().unwrap());
        CappedField::new(network, DesignBox::default(), rim_radius).unwrap()
    }

    fn shipped(name: &str, rim_radius: f64) -> CappedField {
        let text = match name {
            "paper" => include_str!("../../examples/networks/paper.toml"),
            "pneunet" => include_str!("../../examples/networks/pneunet.toml"),
            _ => include_str!("../../examples/networks/gyroid.toml"),
        };
        capped(text, rim_radius)
    }

    /// The zero of `field` between `inside` and `outside`, by bisection to round-off.
    fn zero_between(field: &CappedField, mut inside: Vec3, mut outside: Vec3) -> Vec3 {
        for _ in 0..60 {
            let middle = (inside + outside) / 2.0;
            *(if field.value(middle) < 0.0 { &mut inside } else { &mut outside }) = middle;
        }
        outside
    }

    /// Greatest distance of the fillet from the circle of radius r around its centre, in units of r.
    fn fillet_deviation(rim_radius: f64) -> f64 {
        let field = capped(CYLINDER, rim_radius);
        let centre = Vec3::new(8.0 - rim_radius, 0.0, 62.8 - rim_radius);
        let deviation = |i: i32| {
            let angle = std::f64::consts::FRAC_PI_2 * f64::from(i) / 20.0;
            let ray = Vec3::new(angle.cos(), 0.0, angle.sin()) * (2.0 * rim_radius);
            let rim = zero_between(&field, centre, centre + ray);
            ((rim - centre).norm() / rim_radius - 1.0).abs()
        };
        (0..=20).map(deviation).fold(0.0, f64::max)
    }

    #[test]
    fn rims_are_circles_to_first_order() {
        // g exceeds the distance d by d^2 / 2R, so the deviation in units of r is of order r / 2R,
        // and halves with r up to the next order.
        let [coarse, fine] = [fillet_deviation(1.0), fillet_deviation(0.5)];
        assert!(coarse < 1.0 / 16.0, "{coarse}");
        assert_relative_eq!(coarse / fine, 2.0, max_relative = 0.1);
    }

    #[test]
    fn caps_are_exact_planes_and_walls_the_network_s_zero() {
        for rim_radius in [0.0, 1.5] {
            let field = capped(CYLINDER, rim_radius);
            for (z, sign) in [(62.8, 1.0), (0.0, -1.0)] {
                for rho in [0.0, 2.0, 6.0] {
                    for offset in [-1e-3, 0.0, 0.7] {
                        let point = Vec3::new(rho, 0.0, z + sign * offset);
                        // Positions of 63 mm carry 7e-15 mm of round-off.
                        assert_abs_diff_eq!(field.value(point), offset, epsilon = 2e-14);
                        let gradient = field.value_and_gradient(point).1;
                        assert_abs_diff_eq!(gradient, Vec3::z() * sign, epsilon = 1e-12);
                    }
                }
            }
            assert_abs_diff_eq!(field.value(Vec3::new(4.8, -6.4, 30.0)), 0.0, epsilon = 1e-14);
            let beside = field.value(Vec3::new(8.01, 0.0, 30.0));
            // g - d = d^2 / 2R = 6e-6.
            assert_abs_diff_eq!(beside, 0.01, epsilon = 1e-5);
        }
    }

    #[test]
    fn without_a_radius_the_field_is_the_sharp_intersection() {
        let [sharp, network] = [capped(CYLINDER, 0.0), capped(CYLINDER, 1.0)];
        for z in [61.0, 62.5, 62.7] {
            for x in [7.2, 7.7, 7.9] {
                let g = network.value(Vec3::new(x, 0.0, 30.0));
                let expected = g.max(z - 62.8);
                let value = sharp.value(Vec3::new(x, 0.0, z));
                if expected < -1.0 {
                    assert_eq!(network.value(Vec3::new(x, 0.0, z)), expected);
                }
                // The plane's distance is a difference of numbers of order 63.
                assert_abs_diff_eq!(value, expected, epsilon = 2e-14);
            }
        }
    }

    #[test]
    fn a_field_that_fills_the_box_gives_a_box_with_round_edges_and_corners() {
        let full = "[[node]]\nname = 'full'\nlinks = { z = 0 }\nbias = -1";
        let field = capped(full, 3.0);
        let corner_centre = Vec3::new(17.0, 17.0, 59.8);
        for direction in [Vec3::new(1.0, 1.0, 1.0), Vec3::new(1.0, 2.0, 0.0), Vec3::x()] {
            let point = corner_centre + direction.normalize() * 3.0;
            // Round-off of positions of order 60.
            assert_abs_diff_eq!(field.value(point), 0.0, epsilon = 2e-14);
            let gradient = field.value_and_gradient(point).1;
            assert_abs_diff_eq!(gradient, direction.normalize(), epsilon = 1e-13);
        }
    }

    #[test]
    fn gradients_match_central_differences() {
        let h = 1e-5;
        for (name, rim_radius) in [("paper", 1.5), ("pneunet", 0.8), ("gyroid", 1.0)] {
            let field = shipped(name, rim_radius);
            for i in 0..200 {
                // A low-discrepancy walk through the box and somewhat beyond.
                let at = |scale: f64, from: f64, to: f64| {
                    from + (to - from) * (f64::from(i) * scale).fract()
                };
                let point = Vec3::new(
                    at(0.8191725, -21.0, 21.0),
                    at(0.6710436, -21.0, 21.0),
                    at(0.5497005, -2.0, 65.0),
                );
                let (value, gradient) = field.value_and_gradient(point);
                assert_eq!(value.to_bits(), field.value(point).to_bits());
                let difference = Vec3::from_fn(|k, _| {
                    let mut step = Vec3::zeros();
                    step[k] = h;
                    (field.value(point + step) - field.value(point - step)) / (2.0 * h)
                });
                // Truncation is h^2 times third derivatives, largest (about 1e3 / mm^2) at the
                // PneuNet's edges, which are a sine of 100 theta inside an arctangent.
                assert_abs_diff_eq!(gradient, difference, epsilon = 1e-5 * (1.0 + gradient.norm()));
            }
        }
    }

    #[test]
    fn lines_have_the_bits_of_points_and_are_finite_on_the_axis_and_the_cut() {
        for name in ["paper", "pneunet", "gyroid"] {
            let field = shipped(name, 1.0);
            for (x, y) in [(0.0, 0.0), (-3.0, 0.0), (-3.0, -0.0), (1e-12, 0.0), (4.0, -5.0)] {
                let origin = Vec3::new(x, y, -1.3);
                let mut line = [f64::NAN; 37];
                field.values_along_z(origin, 1.7, &mut line);
                for (i, value) in line.iter().enumerate() {
                    let point = origin + Vec3::new(0.0, 0.0, i as f64 * 1.7);
                    assert_eq!(value.to_bits(), field.value(point).to_bits());
                    let (value, gradient) = field.value_and_gradient(point);
                    assert!(value.is_finite() && gradient.iter().all(|d| d.is_finite()));
                }
            }
        }
    }

    #[test]
    fn theta_does_not_dent_the_caps_on_the_axis() {
        let field = shipped("paper", 1.5);
        for i in 0..40 {
            let (rho, angle) = (0.1 * f64::from(i % 8), 0.7 * f64::from(i));
            let on_cap = Vec3::new(rho * angle.cos(), rho * angle.sin(), 62.8);
            assert_abs_diff_eq!(field.value(on_cap), 0.0, epsilon = 1e-14);
        }
    }

    #[test]
    fn a_rim_radius_that_does_not_fit_is_refused() {
        let network = CompiledNetwork::new(&CYLINDER.parse().unwrap());
        for rim_radius in [-0.1, 10.0, f64::NAN] {
            assert!(CappedField::new(network.clone(), DesignBox::default(), rim_radius).is_err());
        }
    }
}
