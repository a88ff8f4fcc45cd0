//! The kinds of number that a compiled network computes with: numbers, lanes of numbers, and jets.
//!
//! All kinds run the same operations in the same order, so their values agree to the last bit.

use crate::genome::Activation;

/// What one instruction of a compiled network may do.
pub(super) trait Quantity: Copy {
    /// The same everywhere.
    fn constant(value: f64) -> Self;
    fn plus(self, other: Self) -> Self;
    fn times(self, other: Self) -> Self;
    fn scaled(self, weight: f64) -> Self;
    fn shifted(self, bias: f64) -> Self;
    fn activated(self, activation: Activation) -> Self;
}

impl Quantity for f64 {
    #[inline]
    fn constant(value: f64) -> Self {
        value
    }
    #[inline]
    fn plus(self, other: Self) -> Self {
        self + other
    }
    #[inline]
    fn times(self, other: Self) -> Self {
        self * other
    }
    #[inline]
    fn scaled(self, weight: f64) -> Self {
        self * weight
    }
    #[inline]
    fn shifted(self, bias: f64) -> Self {
        self + bias
    }
    #[inline]
    fn activated(self, activation: Activation) -> Self {
        activation.value(self)
    }
}

/// Points of one line, evaluated together so that each instruction is decoded once for all.
pub(super) type Lanes = [f64; LANES];
pub(super) const LANES: usize = 16;

impl Quantity for Lanes {
    #[inline]
    fn constant(value: f64) -> Self {
        [value; LANES]
    }
    #[inline]
    fn plus(self, other: Self) -> Self {
        std::array::from_fn(|i| self[i] + other[i])
    }
    #[inline]
    fn times(self, other: Self) -> Self {
        std::array::from_fn(|i| self[i] * other[i])
    }
    #[inline]
    fn scaled(self, weight: f64) -> Self {
        self.map(|value| value * weight)
    }
    #[inline]
    fn shifted(self, bias: f64) -> Self {
        self.map(|value| value + bias)
    }
    #[inline]
    fn activated(self, activation: Activation) -> Self {
        match activation {
            Activation::Identity => self,
            _ => self.map(|value| activation.value(value)),
        }
    }
}

/// A value with its first derivatives, and with `H` second derivatives (0 or 6, ordered as [`PAIRS`]).
#[derive(Clone, Copy, Debug)]
pub(super) struct Jet<const H: usize> {
    pub(super) value: f64,
    pub(super) first: [f64; 3],
    pub(super) second: [f64; H],
}

/// The coordinates of each stored second derivative.
pub(super) const PAIRS: [[usize; 2]; 6] = [[0, 0], [1, 1], [2, 2], [1, 2], [0, 2], [0, 1]];

impl<const H: usize> Jet<H> {
    #[inline]
    pub(super) fn new(value: f64, first: [f64; 3], second: [f64; 6]) -> Self {
        Self { value, first, second: std::array::from_fn(|k| second[k]) }
    }
}

impl<const H: usize> Quantity for Jet<H> {
    #[inline]
    fn constant(value: f64) -> Self {
        Self { value, first: [0.0; 3], second: [0.0; H] }
    }
    #[inline]
    fn plus(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            first: std::array::from_fn(|i| self.first[i] + other.first[i]),
            second: std::array::from_fn(|k| self.second[k] + other.second[k]),
        }
    }
    #[inline]
    fn times(self, other: Self) -> Self {
        let (a, b) = (&self, &other);
        Self {
            value: a.value * b.value,
            first: std::array::from_fn(|i| a.first[i] * b.value + a.value * b.first[i]),
            second: std::array::from_fn(|k| {
                let [i, j] = PAIRS[k];
                let mixed = a.first[i] * b.first[j] + a.first[j] * b.first[i];
                a.second[k] * b.value + a.value * b.second[k] + mixed
            }),
        }
    }
    #[inline]
    fn scaled(self, weight: f64) -> Self {
        Self {
            value: self.value * weight,
            first: self.first.map(|d| d * weight),
            second: self.second.map(|d| d * weight),
        }
    }
    #[inline]
    fn shifted(self, bias: f64) -> Self {
        Self { value: self.value + bias, ..self }
    }
    #[inline]
    fn activated(self, activation: Activation) -> Self {
        if activation == Activation::Identity {
            return self;
        }
        let [slope, curvature] = activation.derivatives(self.value);
        let first = self.first;
        Self {
            value: activation.value(self.value),
            first: first.map(|d| slope * d),
            second: std::array::from_fn(|k| {
                let [i, j] = PAIRS[k];
                slope * self.second[k] + curvature * first[i] * first[j]
            }),
        }
    }
}
