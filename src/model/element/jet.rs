//! Second-order jets: a value with its exact gradient and Hessian in six variables.
//!
//! The arithmetic of truncated Taylor series; a formula typed once gives all its derivatives to rounding.

use std::ops::{Add, Mul, Sub};

/// Variables of a jet: the two fundamental forms of a surface have six components.
pub(super) const VARIABLES: usize = 6;
/// Packed lower triangle of the Hessian.
pub(super) const PAIRS: usize = VARIABLES * (VARIABLES + 1) / 2;

/// A value, its gradient, and the packed lower triangle of its Hessian: `(i, j), j <= i` at `i (i + 1) / 2 + j`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Jet {
    pub value: f64,
    pub gradient: [f64; VARIABLES],
    pub hessian: [f64; PAIRS],
}

impl Jet {
    /// The jet of these derivatives; of the Hessian only the lower triangle is read.
    pub(super) fn new(
        value: f64,
        gradient: [f64; VARIABLES],
        hessian: &[[f64; VARIABLES]; VARIABLES],
    ) -> Self {
        let mut packed = [0.0; PAIRS];
        let mut pair = 0;
        for (i, row) in hessian.iter().enumerate() {
            packed[pair..=pair + i].copy_from_slice(&row[..=i]);
            pair += i + 1;
        }
        Self { value, gradient, hessian: packed }
    }

    /// The `index`-th variable itself.
    pub(super) fn variable(index: usize, value: f64) -> Self {
        let mut gradient = [0.0; VARIABLES];
        gradient[index] = 1.0;
        Self { value, gradient, hessian: [0.0; PAIRS] }
    }

    /// `f(self)`, given `f`, `f'` and `f''` at the value.
    pub(super) fn chain(&self, [f, df, ddf]: [f64; 3]) -> Self {
        let mut out = Self { value: f, ..*self };
        let mut pair = 0;
        for i in 0..VARIABLES {
            out.gradient[i] = df * self.gradient[i];
            for j in 0..=i {
                out.hessian[pair] =
                    df * self.hessian[pair] + ddf * self.gradient[i] * self.gradient[j];
                pair += 1;
            }
        }
        out
    }

    /// `f(self, other)`, given `f`, its first derivatives, and its second ones by self, by both, by other.
    pub(super) fn chain_with(&self, other: &Self, f: f64, df: [f64; 2], ddf: [f64; 3]) -> Self {
        let mut out = Self { value: f, ..*self };
        let (x, y) = (&self.gradient, &other.gradient);
        let mut pair = 0;
        for i in 0..VARIABLES {
            out.gradient[i] = df[0] * x[i] + df[1] * y[i];
            let on_x = ddf[0] * x[i] + ddf[1] * y[i];
            let on_y = ddf[1] * x[i] + ddf[2] * y[i];
            for j in 0..=i {
                out.hessian[pair] = df[0] * self.hessian[pair]
                    + df[1] * other.hessian[pair]
                    + on_x * x[j]
                    + on_y * y[j];
                pair += 1;
            }
        }
        out
    }

    /// `self` to the power `exponent`; the value must be positive.
    pub(super) fn powf(&self, exponent: f64) -> Self {
        let f = self.value.powf(exponent);
        let df = exponent * f / self.value;
        self.chain([f, df, (exponent - 1.0) * df / self.value])
    }

    /// `self` times a constant.
    pub(super) fn scale(&self, factor: f64) -> Self {
        self.chain([factor * self.value, factor, 0.0])
    }
}

impl Mul for &Jet {
    type Output = Jet;

    fn mul(self, other: &Jet) -> Jet {
        let mut out = Jet { value: self.value * other.value, ..*self };
        let mut pair = 0;
        for i in 0..VARIABLES {
            out.gradient[i] = self.value * other.gradient[i] + other.value * self.gradient[i];
            for j in 0..=i {
                out.hessian[pair] = self.value * other.hessian[pair]
                    + other.value * self.hessian[pair]
                    + self.gradient[i] * other.gradient[j]
                    + self.gradient[j] * other.gradient[i];
                pair += 1;
            }
        }
        out
    }
}

impl Add for &Jet {
    type Output = Jet;

    fn add(self, other: &Jet) -> Jet {
        let mut out = *self;
        out.value += other.value;
        out.gradient.iter_mut().zip(&other.gradient).for_each(|(a, b)| *a += b);
        out.hessian.iter_mut().zip(&other.hessian).for_each(|(a, b)| *a += b);
        out
    }
}

impl Sub for &Jet {
    type Output = Jet;

    fn sub(self, other: &Jet) -> Jet {
        self + &other.scale(-1.0)
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    /// `x y^2` as a function of two jets, `x^2` and `y / z`, at (3, 5, 2).
    #[test]
    fn chain_of_two_jets_is_the_product_rule() {
        let [x, y, z] = [(0, 3.0), (1, 5.0), (2, 2.0)].map(|(i, v)| Jet::variable(i, v));
        let (p, q) = (&x * &x, &y * &z.powf(-1.0));
        let (a, b) = (p.value, q.value);
        let chained = p.chain_with(&q, a * b * b, [b * b, 2.0 * a * b], [0.0, 2.0 * b, 2.0 * a]);
        let product = &(&p * &q) * &q;
        for (one, other) in chained.gradient.iter().zip(&product.gradient) {
            assert_relative_eq!(one, other, max_relative = 1e-14);
        }
        for (one, other) in chained.hessian.iter().zip(&product.hessian) {
            assert_relative_eq!(one, other, max_relative = 1e-14);
        }
    }

    /// Of `x^2 y / z` at (3, 5, 2) every derivative is known by hand.
    #[test]
    fn derivatives_of_a_rational_function_are_exact() {
        let [x, y, z] = [(0, 3.0), (1, 5.0), (2, 2.0)].map(|(i, v)| Jet::variable(i, v));
        let f = &(&(&x * &x) * &y) * &z.powf(-1.0);
        assert_relative_eq!(f.value, 22.5, epsilon = 1e-14);
        for (entry, exact) in f.gradient.iter().zip([15.0, 4.5, -11.25, 0.0, 0.0, 0.0]) {
            assert_relative_eq!(*entry, exact, epsilon = 1e-14);
        }
        for (entry, exact) in f.hessian.iter().zip([5.0, 3.0, 0.0, -7.5, -2.25, 11.25]) {
            assert_relative_eq!(*entry, exact, epsilon = 1e-13);
        }
    }
}
