//! Scalar functions of the invariants with exact derivatives.

use std::ops::{Add, Mul};

/// A function of the invariants `T` and `J` at one point, with its first and second derivatives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OfInvariants {
    /// The value itself: MPa for an energy density, 1 for a stretch.
    pub value: f64,
    /// d/dT, d/dJ.
    pub first: [f64; 2],
    /// d2/dT2, d2/dTdJ, d2/dJ2.
    pub second: [f64; 3],
}

impl OfInvariants {
    /// A function of `J` alone, given `f`, `f'` and `f''` at it.
    #[inline]
    pub(super) fn of_j([f, df, ddf]: [f64; 3]) -> Self {
        Self { value: f, first: [0.0, df], second: [0.0, 0.0, ddf] }
    }

    /// `f` of this function, given `f`, `f'` and `f''` at its value.
    #[inline]
    pub(super) fn chain(&self, [f, df, ddf]: [f64; 3]) -> Self {
        let [t, j] = self.first;
        let [tt, tj, jj] = self.second;
        Self {
            value: f,
            first: [df * t, df * j],
            second: [df * tt + ddf * t * t, df * tj + ddf * t * j, df * jj + ddf * j * j],
        }
    }
}

/// The two parts of `I1`, each with its own factor: `a T + b / J`.
#[inline]
pub(super) fn first_invariant(t: f64, j: f64, [a, b]: [f64; 2]) -> OfInvariants {
    let third = b / j;
    OfInvariants {
        value: a * t + third,
        first: [a, -third / j],
        second: [0.0, 0.0, 2.0 * third / (j * j)],
    }
}

impl Add for OfInvariants {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            first: std::array::from_fn(|k| self.first[k] + other.first[k]),
            second: std::array::from_fn(|k| self.second[k] + other.second[k]),
        }
    }
}

impl Mul for OfInvariants {
    type Output = Self;

    #[inline]
    fn mul(self, other: Self) -> Self {
        let (f, g) = (&self, &other);
        let [f_t, f_j] = f.first;
        let [g_t, g_j] = g.first;
        Self {
            value: f.value * g.value,
            first: [f_t * g.value + f.value * g_t, f_j * g.value + f.value * g_j],
            second: [
                f.second[0] * g.value + 2.0 * f_t * g_t + f.value * g.second[0],
                f.second[1] * g.value + f_t * g_j + f_j * g_t + f.value * g.second[1],
                f.second[2] * g.value + 2.0 * f_j * g_j + f.value * g.second[2],
            ],
        }
    }
}
