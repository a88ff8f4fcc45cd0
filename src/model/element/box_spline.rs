//! The quartic box spline on a regular triangle patch: the limit of Loop's scheme where every valence is six.
//!
//! Twelve control points around the triangle (4, 7, 8), whose corners have `u = 1`, `v = 1`, `w = 1`:
//!
//! ```text
//!        1   2
//!      3   4   5            12 N_k = sum of coefficient * u^i v^j w^k,  u = 1 - v - w
//!    6   7   8   9
//!     10  11  12
//! ```
//!
//! Source: Stam (1998), "Evaluation of Loop subdivision surfaces", appendix A.

/// One monomial of degree four: coefficient and the exponents of `u, v, w`.
type Monomial = (f64, [i32; 3]);

/// First and second derivatives `[,1 ,2 ,11 ,22 ,12]` of the twelve functions with respect to `v` and `w`.
pub(super) fn derivatives(v: f64, w: f64) -> [[f64; 5]; 12] {
    let point = [1.0 - v - w, v, w];
    // d/dv at fixed w moves u backwards: the directions are e_v - e_u and e_w - e_u.
    let first = |polynomial: &[Monomial], a: usize| {
        partial(polynomial, &[a], point) - partial(polynomial, &[0], point)
    };
    let second = |polynomial: &[Monomial], a: usize, b: usize| {
        let p = |order: [usize; 2]| partial(polynomial, &order, point);
        p([a, b]) - p([0, b]) - p([a, 0]) + p([0, 0])
    };
    FUNCTIONS.map(|f| {
        [first(f, 1), first(f, 2), second(f, 1, 1), second(f, 2, 2), second(f, 1, 2)]
            .map(|value| value / 12.0)
    })
}

/// The partial derivative of `polynomial` once along each variable of `order`, at `point`.
fn partial(polynomial: &[Monomial], order: &[usize], point: [f64; 3]) -> f64 {
    let monomial = |&(mut coefficient, mut exponents): &Monomial| {
        for &variable in order {
            coefficient *= f64::from(exponents[variable]);
            exponents[variable] -= 1;
        }
        if coefficient == 0.0 {
            return 0.0;
        }
        coefficient * (0..3).map(|i| point[i].powi(exponents[i])).product::<f64>()
    };
    polynomial.iter().map(monomial).sum()
}

#[rustfmt::skip]
const FUNCTIONS: [&[Monomial]; 12] = [
    &[(1., [4, 0, 0]), (2., [3, 1, 0])],
    &[(1., [4, 0, 0]), (2., [3, 0, 1])],
    &[(1., [4, 0, 0]), (2., [3, 0, 1]), (6., [3, 1, 0]), (6., [2, 1, 1]), (12., [2, 2, 0]),
      (6., [1, 2, 1]), (6., [1, 3, 0]), (2., [0, 3, 1]), (1., [0, 4, 0])],
    &[(6., [4, 0, 0]), (24., [3, 0, 1]), (24., [2, 0, 2]), (8., [1, 0, 3]), (1., [0, 0, 4]),
      (24., [3, 1, 0]), (60., [2, 1, 1]), (36., [1, 1, 2]), (6., [0, 1, 3]), (24., [2, 2, 0]),
      (36., [1, 2, 1]), (12., [0, 2, 2]), (8., [1, 3, 0]), (6., [0, 3, 1]), (1., [0, 4, 0])],
    &[(1., [4, 0, 0]), (6., [3, 0, 1]), (12., [2, 0, 2]), (6., [1, 0, 3]), (1., [0, 0, 4]),
      (2., [3, 1, 0]), (6., [2, 1, 1]), (6., [1, 1, 2]), (2., [0, 1, 3])],
    &[(2., [1, 3, 0]), (1., [0, 4, 0])],
    &[(1., [4, 0, 0]), (6., [3, 0, 1]), (12., [2, 0, 2]), (6., [1, 0, 3]), (1., [0, 0, 4]),
      (8., [3, 1, 0]), (36., [2, 1, 1]), (36., [1, 1, 2]), (8., [0, 1, 3]), (24., [2, 2, 0]),
      (60., [1, 2, 1]), (24., [0, 2, 2]), (24., [1, 3, 0]), (24., [0, 3, 1]), (6., [0, 4, 0])],
    &[(1., [4, 0, 0]), (8., [3, 0, 1]), (24., [2, 0, 2]), (24., [1, 0, 3]), (6., [0, 0, 4]),
      (6., [3, 1, 0]), (36., [2, 1, 1]), (60., [1, 1, 2]), (24., [0, 1, 3]), (12., [2, 2, 0]),
      (36., [1, 2, 1]), (24., [0, 2, 2]), (6., [1, 3, 0]), (8., [0, 3, 1]), (1., [0, 4, 0])],
    &[(2., [1, 0, 3]), (1., [0, 0, 4])],
    &[(2., [0, 3, 1]), (1., [0, 4, 0])],
    &[(2., [1, 0, 3]), (1., [0, 0, 4]), (6., [1, 1, 2]), (6., [0, 1, 3]), (6., [1, 2, 1]),
      (12., [0, 2, 2]), (2., [1, 3, 0]), (6., [0, 3, 1]), (1., [0, 4, 0])],
    &[(1., [0, 0, 4]), (2., [0, 1, 3])],
];

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    type Polynomial<'a> = &'a dyn Fn(f64, f64) -> f64;

    /// Positions of the twelve control points on the regular lattice, as (v, w).
    #[rustfmt::skip]
    const LATTICE: [[f64; 2]; 12] = [
        [0., -1.], [-1., 0.], [1., -1.], [0., 0.], [-1., 1.], [2., -1.],
        [1., 0.], [0., 1.], [-1., 2.], [2., 0.], [1., 1.], [0., 2.],
    ];

    /// Loop's scheme reproduces quadratics' second derivatives and linear functions exactly on a regular lattice.
    #[test]
    fn derivatives_of_polynomials_are_exact() {
        for (v, w) in [(1.0 / 3.0, 1.0 / 3.0), (0.1, 0.7), (0.5, 0.0)] {
            let basis = derivatives(v, w);
            let apply = |f: Polynomial| {
                let mut sum = [0.0; 5];
                for (values, [v, w]) in basis.iter().zip(LATTICE) {
                    for (sum, value) in sum.iter_mut().zip(values) {
                        *sum += value * f(v, w);
                    }
                }
                sum
            };
            let cases: [(Polynomial, [f64; 5]); 5] = [
                (&|_, _| 1.0, [0.0; 5]),
                (&|v, _| v, [1.0, 0.0, 0.0, 0.0, 0.0]),
                (&|_, w| w, [0.0, 1.0, 0.0, 0.0, 0.0]),
                (&|v, _| v * v, [2.0 * v, 0.0, 2.0, 0.0, 0.0]),
                (&|v, w| v * w, [w, v, 0.0, 0.0, 1.0]),
            ];
            for (f, exact) in cases {
                for (value, exact) in apply(f).iter().zip(exact) {
                    assert_relative_eq!(*value, exact, epsilon = 1e-13);
                }
            }
        }
    }
}
