//! The angle of a direction that turns away from an axis, past half a turn too.
//!
//! ```text
//! chord angle    atan2(u_r, L + u_z),  u_r = |(u_x, u_y)| of the tip
//! ```

use std::f64::consts::TAU;

use crate::math::Vec3;

/// A direction that turns away from an axis, followed from state to state of a path.
#[derive(Clone, Debug, Default)]
pub struct Turning {
    across: Vec3,
    past_half: bool,
}

impl Turning {
    /// The angle, rad, in [0, 2 pi), to the axis of the direction with these parts across and along it.
    ///
    /// Half a turn is passed where the direction points backwards and its part across reverses.
    pub fn angle(&mut self, across: Vec3, along: f64) -> f64 {
        self.past_half ^= along < 0.0 && across.dot(&self.across) < 0.0;
        self.across = across;
        let folded = across.norm().atan2(along);
        if self.past_half { TAU - folded } else { folded }
    }

    /// The chord angle, rad, of a part whose `tip` has moved by so much (mm) from its place at `length` (mm) along z.
    pub fn chord(&mut self, length: f64, tip: Vec3) -> f64 {
        self.angle(Vec3::new(tip.x, tip.y, 0.0), length + tip.z)
    }

    /// [`Self::chord`], and its rate where the tip moves at `rate`.
    pub fn chord_and_rate(&mut self, length: f64, tip: Vec3, rate: Vec3) -> [f64; 2] {
        let angle = self.chord(length, tip);
        let (across, along) = (tip.xy().norm(), length + tip.z);
        let across_rate =
            if across > 0.0 { tip.xy().dot(&rate.xy()) / across } else { rate.xy().norm() };
        let folded_rate = (along * across_rate - across * rate.z) / across.hypot(along).powi(2);
        [angle, if self.past_half { -folded_rate } else { folded_rate }]
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use approx::assert_relative_eq;

    use super::*;

    /// A direction that turns past 180 degrees keeps growing although `atan2` of a length folds back, and it shrinks
    /// again on the way home.
    #[test]
    fn angles_go_on_past_half_a_turn() {
        let mut turning = Turning::default();
        let way = (0..=18).chain((0..18).rev());
        for exact in way.map(|step| f64::from(step) * PI / 10.5) {
            let across = Vec3::new(0.6, 0.8, 0.0) * exact.sin();
            let angle = turning.angle(across, exact.cos());
            assert_relative_eq!(angle, exact, epsilon = 1e-12);
        }
    }

    /// A right angle where the tip has come level with the base; the rate against a central difference of second order.
    #[test]
    fn chord_angle_has_its_rate() {
        let of = |tip, rate| Turning::default().chord_and_rate(10.0, tip, rate);
        let exact = of(Vec3::new(3.0, 4.0, -10.0), Vec3::zeros());
        assert!((exact[0] - FRAC_PI_2).abs() < 1e-14 && exact[1] == 0.0);
        let way = |load: f64| Vec3::new(3.0 * load, 4.0 * load * load, -2.0 * load);
        let rate = |load: f64| Vec3::new(3.0, 8.0 * load, -2.0);
        let at = |load: f64| of(way(load), rate(load));
        for load in [0.0, 0.7] {
            // From rest the angle grows whichever way the tip moves: one side only, of first order.
            let (low, high, reach) =
                if load == 0.0 { (0.0, 1e-6, 1e-5) } else { (-1e-4, 1e-4, 2e-7) };
            let difference = (at(load + high)[0] - at(load + low)[0]) / (high - low);
            assert!((at(load)[1] - difference).abs() < reach, "{load}: {difference}");
        }
    }

    /// On a circle about the base the angle is the path's parameter and its rate is 1, before half a turn and after it.
    #[test]
    fn rates_go_on_past_half_a_turn() {
        let mut turning = Turning::default();
        for exact in (1..=18).map(|step| f64::from(step) * PI / 10.5) {
            let tip = Vec3::new(10.0 * exact.sin(), 0.0, 10.0 * exact.cos() - 10.0);
            let rate = Vec3::new(10.0 * exact.cos(), 0.0, -10.0 * exact.sin());
            let [angle, rate] = turning.chord_and_rate(10.0, tip, rate);
            assert_relative_eq!(angle, exact, epsilon = 1e-12);
            assert_relative_eq!(rate, 1.0, epsilon = 1e-12);
        }
    }
}
