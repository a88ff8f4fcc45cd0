//! Values and derivatives of a compiled network.
//!
//! Derivatives are carried forward through the instructions (forward mode), from
//! ```text
//! d theta = (-y, x) / r^2        d r = (x, y) / r
//! ```
//!
//! Near the axis the dependence on theta fades: with `m` the mean of `f` over turns of theta at the same point,
//! ```text
//! f <- m + s(rho / LOBE_RADIUS) (f - m)
//! ```
//!
//! # Decisions
//! The published networks do not fade: their field has no value on the axis, and where its sign differs around it
//! (half of all random genomes, `basic_bend` among them) the surface ends in knife edges on the axis, which a mesh
//! resolves or not by chance. Outside 3 mm nothing changes; a wall of 1.6 mm leaves no room for lobes inside.

use std::f64::consts::PI;

use crate::math::Vec3;

use super::ScalarField;
use super::compile::CompiledNetwork;
use super::quantity::{Jet, LANES, Lanes, Quantity};

impl ScalarField for CompiledNetwork {
    fn value(&self, point: Vec3) -> f64 {
        let own = self.turned_value(point, 0.0);
        let Some(share) = self.lobe_share::<f64>(point) else {
            return own;
        };
        let turned = TURNS.map(|turn| self.turned_value(point, turn));
        let mean = turned.iter().sum::<f64>() / TURNS.len() as f64;
        mean + share * (own - mean)
    }

    fn value_and_gradient(&self, point: Vec3) -> (f64, Vec3) {
        let jet = self.jet::<0>(point);
        (jet.value, jet.first.into())
    }

    fn values_along_z(&self, origin: Vec3, step: f64, values: &mut [f64]) {
        if self.is_near_axis(origin) {
            for (i, value) in values.iter_mut().enumerate() {
                *value = self.value(origin + Vec3::new(0.0, 0.0, i as f64 * step));
            }
            return;
        }
        with_slots::<Lanes, _>(self.slot_count(), |slots| {
            for (slot, value) in slots.iter_mut().zip(self.coordinates(origin)) {
                *slot = Lanes::constant(value);
            }
            self.run_z_free(slots);
            for (chunk_index, chunk) in values.chunks_mut(LANES).enumerate() {
                slots[2] = std::array::from_fn(|lane| {
                    let i = chunk_index * LANES + lane;
                    self.z_input(origin.z + i as f64 * step)
                });
                let lanes = self.run_z_bound(slots).map(bounded_value);
                chunk.copy_from_slice(&lanes[..chunk.len()]);
            }
        });
    }
}

impl CompiledNetwork {
    /// The field and its derivatives per mm (and per mm^2 for `H = 6`) at `point` (mm).
    pub(super) fn jet<const H: usize>(&self, point: Vec3) -> Jet<H> {
        let own = self.turned_jet(point, 0.0);
        let Some(share) = self.lobe_share::<Jet<H>>(point) else {
            return self.bounded_jet(own);
        };
        let turned = TURNS.map(|turn| self.turned_jet(point, turn));
        let sum = turned[1..].iter().fold(turned[0], |sum, jet| sum.plus(*jet));
        let mean = sum.scaled(1.0 / TURNS.len() as f64);
        self.bounded_jet(mean.plus(share.times(own.plus(mean.scaled(-1.0)))))
    }

    /// The network with theta advanced by `turn`.
    fn turned_value(&self, point: Vec3, turn: f64) -> f64 {
        with_slots(self.slot_count(), |slots| {
            slots[..5].copy_from_slice(&self.coordinates(point));
            slots[3] += turn;
            self.run_z_free(slots);
            bounded_value(self.run_z_bound(slots))
        })
    }

    /// As [`Self::turned_value`], with derivatives per length unit.
    fn turned_jet<const H: usize>(&self, point: Vec3, turn: f64) -> Jet<H> {
        with_slots(self.slot_count(), |slots| {
            slots[..5].copy_from_slice(&self.coordinate_jets(point));
            slots[3].value += turn;
            self.run_z_free(slots);
            self.run_z_bound(slots)
        })
    }

    /// Whether `point` is where the lobes of a network that uses theta fade.
    fn is_near_axis(&self, point: Vec3) -> bool {
        self.uses_theta && point.xy().norm() < LOBE_RADIUS
    }

    /// How much of its dependence on theta the field keeps at `point`: `s(rho / LOBE_RADIUS)` with
    /// `s(t) = 6 t^5 - 15 t^4 + 10 t^3`; `None` where it keeps all.
    fn lobe_share<Q: Quantity + FromDistance>(&self, point: Vec3) -> Option<Q> {
        if !self.is_near_axis(point) {
            return None;
        }
        let t = Q::from_distance(self, point).scaled(self.length_unit_mm / LOBE_RADIUS);
        let square = t.times(t);
        let factor = square.scaled(6.0).plus(t.scaled(-15.0)).shifted(10.0);
        Some(square.times(t).times(factor))
    }

    /// Passes `visit` the index, z (mm), and jet of every point of a line along z.
    pub(super) fn jets_along_z(
        &self,
        origin: Vec3,
        step: f64,
        count: usize,
        mut visit: impl FnMut(usize, f64, Jet<0>),
    ) {
        if self.is_near_axis(origin) {
            for i in 0..count {
                let z = origin.z + i as f64 * step;
                visit(i, z, self.jet(Vec3::new(origin.x, origin.y, z)));
            }
            return;
        }
        with_slots::<Jet<0>, _>(self.slot_count(), |slots| {
            slots[..5].copy_from_slice(&self.coordinate_jets(origin));
            self.run_z_free(slots);
            for i in 0..count {
                let z = origin.z + i as f64 * step;
                slots[2].value = self.z_input(z);
                visit(i, z, self.bounded_jet(self.run_z_bound(slots)));
            }
        });
    }

    /// x, y, z, theta, r with their biases, in length units.
    fn coordinates(&self, point: Vec3) -> [f64; 5] {
        let [x, y, theta, r] = self.unbiased(point);
        let b = self.input_biases;
        [x + b[0], y + b[1], self.z_input(point.z), theta + b[3], r + b[4]]
    }

    fn z_input(&self, z: f64) -> f64 {
        z / self.length_unit_mm + self.input_biases[2]
    }

    /// x, y, theta, r in length units.
    fn unbiased(&self, point: Vec3) -> [f64; 4] {
        // Adding 0.0 turns -0.0 into 0.0, so that theta on the half-plane y = 0, x < 0 is always +pi.
        let x = point.x / self.length_unit_mm + 0.0;
        let y = point.y / self.length_unit_mm + 0.0;
        [x, y, y.atan2(x), (x * x + y * y).sqrt()]
    }

    fn coordinate_jets<const H: usize>(&self, point: Vec3) -> [Jet<H>; 5] {
        let values = self.coordinates(point);
        let [x, y, _, r] = self.unbiased(point);
        let none = [0.0; 6];
        let mut theta_jet = Jet::constant(values[3]);
        let mut r_jet = Jet::constant(values[4]);
        if r > AXIS {
            let (c, s) = (x / r, y / r);
            let (turn, bend) = ((s * s - c * c) / (r * r), 2.0 * s * c / (r * r));
            theta_jet =
                Jet::new(values[3], [-s / r, c / r, 0.0], [bend, -bend, 0.0, 0.0, 0.0, turn]);
            let round = [s * s / r, c * c / r, 0.0, 0.0, 0.0, -s * c / r];
            r_jet = Jet::new(values[4], [c, s, 0.0], round);
        }
        [
            Jet::new(values[0], [1.0, 0.0, 0.0], none),
            Jet::new(values[1], [0.0, 1.0, 0.0], none),
            Jet::new(values[2], [0.0, 0.0, 1.0], none),
            theta_jet,
            r_jet,
        ]
    }

    /// In mm, and finite.
    fn bounded_jet<const H: usize>(&self, jet: Jet<H>) -> Jet<H> {
        let per_mm = 1.0 / self.length_unit_mm;
        Jet {
            value: bounded_value(jet.value),
            first: jet.first.map(|d| bounded_derivative(d * per_mm)),
            second: jet.second.map(|d| bounded_derivative(d * per_mm * per_mm)),
        }
    }
}

/// The distance from the axis, in length units.
trait FromDistance {
    fn from_distance(network: &CompiledNetwork, point: Vec3) -> Self;
}

impl FromDistance for f64 {
    fn from_distance(network: &CompiledNetwork, point: Vec3) -> Self {
        network.unbiased(point)[3]
    }
}

impl<const H: usize> FromDistance for Jet<H> {
    fn from_distance(network: &CompiledNetwork, point: Vec3) -> Self {
        network.coordinate_jets(point)[4].shifted(-network.input_biases[4])
    }
}

fn bounded_value(value: f64) -> f64 {
    if value.is_nan() { LARGEST } else { value.clamp(-LARGEST, LARGEST) }
}

fn bounded_derivative(derivative: f64) -> f64 {
    if derivative.is_finite() { derivative.clamp(-LARGEST, LARGEST) } else { 0.0 }
}

/// Lends zeroed slots, from the stack for networks of ordinary size.
fn with_slots<Q: Quantity, T>(count: usize, body: impl FnOnce(&mut [Q]) -> T) -> T {
    const ON_STACK: usize = 24;
    if count <= ON_STACK {
        body(&mut [Q::constant(0.0); ON_STACK][..count])
    } else {
        body(&mut vec![Q::constant(0.0); count])
    }
}

/// Far beyond any wall, and its fourth power is still finite.
const LARGEST: f64 = 1e30;

/// Within this distance of the axis (mm) a field's dependence on theta fades to its mean.
///
/// Theta has no value on the axis: where the sign of the field depends on it there, lobes would meet in a point
/// and the surface would end in knife edges that no mesh resolves.
const LOBE_RADIUS: f64 = 3.0;

/// Turns over which the mean is taken: it leaves no lobes of order 1 to 7.
const TURNS: [f64; 8] = [0.0, 0.25 * PI, 0.5 * PI, 0.75 * PI, PI, 1.25 * PI, 1.5 * PI, 1.75 * PI];

/// Nearer to the axis than this (length units) the derivatives of theta and r count as 0.
const AXIS: f64 = 1e-9;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::genome::Network;
    use approx::{assert_abs_diff_eq, assert_relative_eq};

    fn points() -> impl Iterator<Item = Vec3> {
        (0..60).map(|i| {
            let at = |scale: f64, from: f64, to: f64| {
                from + (to - from) * (0.37 + f64::from(i) * scale).fract()
            };
            let (x, y) = (at(0.8191725, -20.0, 20.0), at(0.6710436, -20.0, 20.0));
            Vec3::new(x, y, at(0.5497005, 0.0, 62.8))
        })
    }

    type Formula = fn(f64, f64, f64) -> f64;

    /// The shipped network files, and their formulas in x, y, z (cm).
    fn shipped() -> [(&'static str, Formula); 4] {
        [
            (include_str!("../../examples/networks/basic_bend.toml"), |x, y, z| {
                x.powi(4) + y * y + (3.2 * z).sin() + y.atan2(x).cos() - 0.6
            }),
            (include_str!("../../examples/networks/gyroid.toml"), |x, y, z| {
                x.sin() * y.cos() + y.sin() * z.cos() + z.sin() * x.cos() + 1.0
            }),
            (include_str!("../../examples/networks/pneunet.toml"), |x, y, z| {
                let (theta, r) = (y.atan2(x), x.hypot(y));
                let soft_sign = |s: f64| s.atan().sin();
                let gaps = soft_sign(20.0 * ((4.5 * z).sin() - 0.8)) + 1.0;
                let side = soft_sign(100.0 * (theta.sin() + 0.3)) + 1.0;
                let [height, breadth] = [r * theta.sin() - 0.3, r * (theta + 15_708e-4).sin()];
                0.5 * gaps * side + height.powi(4) + breadth.powi(4) - 1.0
            }),
            (include_str!("../../examples/networks/paper.toml"), |x, y, z| {
                let pleats = (5.0 * z + 0.4 * z.cos()).cos();
                x * x + y * y + 0.3 * pleats + 0.25 * y.atan2(x).cos() - 0.9
            }),
        ]
    }

    #[test]
    fn shipped_networks_are_their_formulas() {
        for (text, formula) in shipped() {
            let network = CompiledNetwork::new(&text.parse().unwrap());
            for p in points().filter(|p| p.xy().norm() >= LOBE_RADIUS) {
                let expected = formula(p.x / 10.0, p.y / 10.0, p.z / 10.0);
                // Round-off, magnified by slopes of up to 100 in the PneuNet.
                assert_relative_eq!(
                    network.value(p),
                    expected,
                    epsilon = 1e-12,
                    max_relative = 1e-12
                );
            }
        }
    }

    #[test]
    fn derivatives_match_central_differences() {
        let h = 1e-4;
        for (text, _) in shipped() {
            let network = CompiledNetwork::new(&text.parse().unwrap());
            for p in points() {
                let jet = network.jet::<6>(p);
                let (value, gradient) = network.value_and_gradient(p);
                assert_eq!((value, gradient), (jet.value, Vec3::from(jet.first)));
                assert_eq!(value.to_bits(), network.value(p).to_bits());
                let [fxx, fyy, fzz, fyz, fxz, fxy] = jet.second;
                let rows = [[fxx, fxy, fxz], [fxy, fyy, fyz], [fxz, fyz, fzz]];
                for (k, row) in rows.into_iter().enumerate() {
                    let mut step = Vec3::zeros();
                    step[k] = h;
                    let ahead = network.value_and_gradient(p + step);
                    let behind = network.value_and_gradient(p - step);
                    let slope = (ahead.0 - behind.0) / (2.0 * h);
                    let curvature = (ahead.1 - behind.1) / (2.0 * h);
                    // Truncation: h^2 / 6 times 3rd (4th) derivatives, which reach 1e2 / mm^3
                    // (1e4 / mm^4) at the PneuNet's edges; elsewhere far less.
                    assert_abs_diff_eq!(slope, gradient[k], epsilon = 1e-6);
                    assert_abs_diff_eq!(curvature, Vec3::from(row), epsilon = 1e-4);
                }
            }
        }
    }

    #[test]
    fn lines_have_the_bits_of_points() {
        for (text, _) in shipped() {
            let network = CompiledNetwork::new(&text.parse().unwrap());
            for (x, y) in [(3.0, -4.0), (0.0, 0.0), (-2.0, -0.0)] {
                let origin = Vec3::new(x, y, -0.7);
                let mut line = [f64::NAN; 2 * LANES + 5];
                network.values_along_z(origin, 0.9, &mut line);
                for (i, value) in line.iter().enumerate() {
                    let point = origin + Vec3::new(0.0, 0.0, i as f64 * 0.9);
                    assert_eq!(value.to_bits(), network.value(point).to_bits());
                }
            }
        }
    }

    #[test]
    fn a_network_too_long_for_the_stack_gives_the_same_answers() {
        let mut text = String::from("[[node]]\nname = 'n0'\nlinks = { z = 1, x = 0.5 }\n");
        for i in 1..60 {
            let node = format!("[[node]]\nname = 'n{i}'\nlinks = {{ n{} = 1 }}\nbias = 1\n", i - 1);
            text.push_str(&node);
        }
        let network = CompiledNetwork::new(&text.parse().unwrap());
        let (value, gradient) = network.value_and_gradient(Vec3::new(20.0, 0.0, 10.0));
        assert_eq!(value, 0.5 * 2.0 + 1.0 + 59.0);
        assert_eq!(gradient, Vec3::new(0.05, 0.0, 0.1));
    }

    #[test]
    fn unbounded_networks_stay_finite() {
        let text = "
            [[node]]
            name = 'pole'
            activation = 'inverse'
            links = { x = 1 }
            [[node]]
            name = 'a'
            activation = 'fourth'
            links = { pole = 1e60 }
            [[node]]
            name = 'b'
            activation = 'fourth'
            links = { a = 1e60 }
            [[node]]
            name = 'c'
            aggregation = 'product'
            links = { b = 1, a = -1, r = 1, theta = 1 }
            [[node]]
            name = 'infinity-less-infinity'
            links = { b = 1, c = 1 }";
        let network: Network = text.parse().unwrap();
        let field = CompiledNetwork::new(&network);
        for point in [Vec3::zeros(), Vec3::new(-1.0, 0.0, 0.0), Vec3::new(1e-300, 1e-300, 5.0)] {
            let jet = field.jet::<6>(point);
            assert!(jet.value.is_finite(), "{point:?}");
            assert!(jet.first.iter().chain(&jet.second).all(|d| d.is_finite()), "{point:?}");
        }
    }

    #[test]
    fn the_axis_and_the_cut_are_as_documented() {
        let theta = "[[node]]\nname = 't'\nlinks = { theta = 1 }";
        let field = CompiledNetwork::new(&theta.parse().unwrap());
        assert_eq!(field.value(Vec3::new(-4.0, 0.0, 0.0)), PI);
        assert_eq!(field.value(Vec3::new(-4.0, -0.0, 0.0)), PI);
        // On the axis only the mean over the turns is left, 7/8 pi.
        assert_eq!(field.value_and_gradient(Vec3::zeros()), (0.875 * PI, Vec3::zeros()));
    }

    /// Lobes of every order up to 7 leave one value on the axis, and none of them a jump at the fading's edge.
    #[test]
    fn lobes_fade_on_the_axis() {
        for order in 1..=7 {
            let text = format!(
                "[[node]]\nname = 'lobes'\nactivation = 'cosine'\nlinks = {{ theta = {order} }}\nbias = 0.25"
            );
            let field = CompiledNetwork::new(&text.parse().unwrap());
            for turn in 0..12 {
                let (s, c) = (f64::from(turn) * 0.5).sin_cos();
                let at = |rho: f64| field.value(Vec3::new(rho * c, rho * s, 1.0));
                // Rounding of eight cosines; the fading begins with the third power of 1e-4 mm.
                assert_abs_diff_eq!(at(1e-4), 0.25, epsilon = 1e-11);
                let outside = (f64::from(order) * s.atan2(c)).cos() + 0.25;
                assert_abs_diff_eq!(at(LOBE_RADIUS - 1e-6), outside, epsilon = 1e-9);
                assert_abs_diff_eq!(at(LOBE_RADIUS), outside, epsilon = 1e-12);
            }
        }
    }

    #[test]
    fn dead_nodes_change_nothing() {
        let text = include_str!("../../examples/networks/paper.toml");
        let dead = "[[node]]\nname = 'dead'\nactivation = 'inverse'\nlinks = { lobes = 1, z = 9 }";
        let with_dead: Network = format!("{text}\n{dead}").parse().unwrap();
        let without: Network = text.parse().unwrap();
        assert_eq!(CompiledNetwork::new(&with_dead), CompiledNetwork::new(&without));
    }

    /// `x (0.5 + tanh 0 + 1 / (1 + exp 0)) - exp(-1)`: constants with an activation, of an empty sum and of an empty product.
    #[test]
    fn nodes_without_links_are_constants() {
        let text = "
            [[node]]
            name = 'half'
            bias = 0.5
            [[node]]
            name = 'flat'
            activation = 'sigmoid'
            links = {}
            [[node]]
            name = 'bell'
            activation = 'gaussian'
            aggregation = 'product'
            [[node]]
            name = 'slope'
            links = { half = 1, flat = 1 }
            [[node]]
            name = 'product'
            aggregation = 'product'
            links = { x = 1, slope = 1 }
            [[node]]
            name = 'out'
            links = { product = 1, bell = -1 }";
        let network: Network = text.parse().unwrap();
        assert_eq!(network.to_toml().parse::<Network>().unwrap(), network);
        let field = CompiledNetwork::new(&network);
        // x is in cm.
        let (value, gradient) = field.value_and_gradient(Vec3::new(20.0, 3.0, -4.0));
        assert_abs_diff_eq!(value, 2.0 - (-1.0_f64).exp(), epsilon = 1e-15);
        assert_abs_diff_eq!(gradient, Vec3::new(0.1, 0.0, 0.0), epsilon = 1e-15);
        let constant: Network = "[[node]]\nname = 'c'\nbias = -1".parse().unwrap();
        let field = CompiledNetwork::new(&constant);
        assert_eq!(field.value_and_gradient(Vec3::new(1.0, 2.0, 3.0)), (-1.0, Vec3::zeros()));
    }
}
