//! Second-order jets: a value with its gradient and Hessian in six variables.

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
    #[inline(always)]
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
}
