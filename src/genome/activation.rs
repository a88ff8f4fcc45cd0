//! The functions that a node may apply to its weighted inputs.
//!
//! The set is that of the lab's published tools (CPPN2sim, SoRoForge and the CASE 2021 library), and what other tools
//! for such networks draw from (Stanley 2007, the HyperNEAT family): the hyperbolic tangent, the logistic function, a bell and `|s|`.
//! Every function is defined on all real numbers: where the textbook function is not,
//! the argument is clamped to its domain and the derivatives there are 0.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A node's function of one number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Activation {
    /// `s`
    #[default]
    Identity,
    /// `sin s`
    Sine,
    /// `cos s`
    Cosine,
    /// `atan s`
    Atan,
    /// `s^2`
    Squared,
    /// `s^4`
    Fourth,
    /// `asin s`, `s` clamped to [-1, 1]
    Asin,
    /// `acos s`, `s` clamped to [-1, 1]
    Acos,
    /// `1 / s`, `|s|` clamped to at least 1e-9
    Inverse,
    /// `sqrt s`, `s` clamped to at least 0
    SquareRoot,
    /// `atan(20 sin s)`, a square wave with soft edges
    Atsn,
    /// `tanh s`
    Tanh,
    /// `1 / (1 + exp(-s))`
    Sigmoid,
    /// `exp(-s^2)`
    Gaussian,
    /// `|s|`; its slope at 0 counts as 0
    Abs,
}

impl Activation {
    /// The function at `s`.
    #[must_use]
    #[inline]
    pub fn value(self, s: f64) -> f64 {
        match self {
            Self::Identity => s,
            Self::Sine => s.sin(),
            Self::Cosine => s.cos(),
            Self::Atan => s.atan(),
            Self::Squared => s * s,
            Self::Fourth => (s * s) * (s * s),
            Self::Asin => s.clamp(-1.0, 1.0).asin(),
            Self::Acos => s.clamp(-1.0, 1.0).acos(),
            Self::Inverse => {
                if s.abs() < LEAST_DIVISOR {
                    1.0f64.copysign(s) / LEAST_DIVISOR
                } else {
                    1.0 / s
                }
            }
            Self::SquareRoot => s.max(0.0).sqrt(),
            Self::Atsn => (20.0 * s.sin()).atan(),
            Self::Tanh => s.tanh(),
            Self::Sigmoid => logistic(s),
            Self::Gaussian => (-s * s).exp(),
            Self::Abs => s.abs(),
        }
    }

    /// The first and second derivative at `s`.
    #[must_use]
    #[inline]
    pub fn derivatives(self, s: f64) -> [f64; 2] {
        match self {
            Self::Identity => [1.0, 0.0],
            Self::Sine => [s.cos(), -s.sin()],
            Self::Cosine => [-s.sin(), -s.cos()],
            Self::Atan => {
                let slope = 1.0 / (1.0 + s * s);
                [slope, -2.0 * s * slope * slope]
            }
            Self::Squared => [2.0 * s, 2.0],
            Self::Fourth => [4.0 * s * s * s, 12.0 * s * s],
            Self::Asin => arcsine_derivatives(s),
            Self::Acos => arcsine_derivatives(s).map(|d| -d),
            Self::Inverse if s.abs() < LEAST_DIVISOR => [0.0, 0.0],
            Self::Inverse => [-1.0 / (s * s), 2.0 / (s * s * s)],
            Self::SquareRoot if s <= 0.0 => [0.0, 0.0],
            Self::SquareRoot => [0.5 / s.sqrt(), -0.25 / (s * s.sqrt())],
            Self::Atsn => {
                let [u, du] = [20.0 * s.sin(), 20.0 * s.cos()];
                let slope = 1.0 / (1.0 + u * u);
                [du * slope, -u * slope - 2.0 * u * (du * slope) * (du * slope)]
            }
            Self::Tanh => {
                let t = s.tanh();
                let slope = 1.0 - t * t;
                [slope, -2.0 * t * slope]
            }
            Self::Sigmoid => {
                let [y, rest] = [logistic(s), logistic(-s)];
                [y * rest, y * rest * (rest - y)]
            }
            // Where the bell is 0, so is what s^2 would make of it.
            Self::Gaussian if s.abs() > GAUSSIAN_REACH => [0.0, 0.0],
            Self::Gaussian => {
                let bell = (-s * s).exp();
                [-2.0 * s * bell, (4.0 * s * s - 2.0) * bell]
            }
            Self::Abs if s == 0.0 => [0.0, 0.0],
            Self::Abs => [s.signum(), 0.0],
        }
    }
}

fn arcsine_derivatives(s: f64) -> [f64; 2] {
    if s.abs() >= 1.0 {
        return [0.0, 0.0];
    }
    let slope = 1.0 / (1.0 - s * s).sqrt();
    [slope, s * slope * slope * slope]
}

fn logistic(s: f64) -> f64 {
    1.0 / (1.0 + (-s).exp())
}

const LEAST_DIVISOR: f64 = 1e-9;
/// `exp(-s^2)` is 0 from 27.3 on.
const GAUSSIAN_REACH: f64 = 30.0;

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    const ALL: [Activation; 15] = [
        Activation::Identity,
        Activation::Sine,
        Activation::Cosine,
        Activation::Atan,
        Activation::Squared,
        Activation::Fourth,
        Activation::Asin,
        Activation::Acos,
        Activation::Inverse,
        Activation::SquareRoot,
        Activation::Atsn,
        Activation::Tanh,
        Activation::Sigmoid,
        Activation::Gaussian,
        Activation::Abs,
    ];

    #[test]
    fn derivatives_match_central_differences() {
        let h = 1e-4;
        for activation in ALL {
            for s in [0.31, 0.47, 0.83] {
                let [below, at, above] = [s - h, s, s + h].map(|s| activation.value(s));
                let [first, second] = activation.derivatives(s);
                // Truncation is h^2 times the 3rd (4th) derivative, at most about 1e4 (1e5) here;
                // round-off of the second difference is 1e-16 / h^2 = 1e-8.
                assert_relative_eq!(first, (above - below) / (2.0 * h), epsilon = 1e-4);
                let curvature = (above - 2.0 * at + below) / (h * h);
                assert_relative_eq!(second, curvature, epsilon = 1e-3, max_relative = 1e-4);
            }
        }
    }

    /// Abramowitz & Stegun, tables 4.15 and 7.1: tanh 0.5, exp(-0.25); the logistic function is `(1 + tanh(s / 2)) / 2`.
    #[test]
    fn bells_and_steps_have_their_tabulated_values() {
        let rows = [
            (Activation::Tanh, 0.5, 0.462_117_157_260_009_8),
            (Activation::Sigmoid, 1.0, 0.731_058_578_630_004_9),
            (Activation::Sigmoid, -1.0, 0.268_941_421_369_995_1),
            (Activation::Gaussian, -0.5, 0.778_800_783_071_404_9),
            (Activation::Abs, -0.25, 0.25),
        ];
        for (activation, s, exact) in rows {
            assert_relative_eq!(activation.value(s), exact, max_relative = 1e-15);
        }
        // Far out they are flat, without a number that is none: 0 times an infinity.
        for activation in [Activation::Tanh, Activation::Sigmoid, Activation::Gaussian] {
            for s in [-1e200, -800.0, 800.0, 1e200] {
                assert_eq!(
                    activation.derivatives(s).map(f64::abs),
                    [0.0; 2],
                    "{activation:?}({s})"
                );
            }
        }
        assert_eq!([-0.0, 0.0, -2.0].map(|s| Activation::Abs.derivatives(s)[0]), [0.0, 0.0, -1.0]);
    }

    #[test]
    fn every_function_is_finite_on_all_numbers() {
        for activation in ALL {
            for s in [-1e30, -1.0, -1e-12, 0.0, 1e-12, 1.0, 1e30] {
                assert!(activation.value(s).is_finite(), "{activation:?}({s})");
                assert!(activation.derivatives(s)[0].is_finite(), "{activation:?}'({s})");
            }
        }
    }
}
