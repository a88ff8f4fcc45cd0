//! One form of a law, fitted.
//!
//! ```text
//! min over x of  sum e_i(x)^2 + w^2 sum max(0, s mu - k_j(x))^2 / mu^2
//! ```
//!
//! with the errors `e` of [`Measured`], the stiffness `k` against the softest further strain at closely spaced stretches of each kind of
//! test ([`Rubber::stiffness`]), and a share `s` of the modulus `mu`. The second sum is a penalty from outside; its weight is so large that
//! what is missing of `s` at the end is far less than `s`, so that the law is stable there with a margin. A law that is not is dropped.

use nalgebra::DVector;

use super::least_squares::{Minimum, minimum};
use super::measured::Measured;
use crate::model::material::{FitForm, Loading, Material, Rubber};

/// A form of a law with the numbers that come nearest to what was measured.
#[derive(Clone, Debug, PartialEq)]
pub struct LawFit {
    /// The form's name.
    pub name: &'static str,
    /// How many numbers were sought.
    pub numbers: usize,
    /// Whether it depends on the first invariant alone.
    pub is_of_first_invariant: bool,
    /// The law.
    pub law: Rubber,
    /// The root of the mean square error over all points, MPa.
    pub rms: f64,
    /// The same of each test over its largest stress, the mean of the tests.
    pub relative: f64,
    /// The same of blocks of points that were left out of the fit; infinite where some law of those has no answer.
    pub left_out: f64,
    /// The stretches `[least, greatest]` within those looked at between which the law is stable in all three tests.
    pub stable: [f64; 2],
    /// Whether stability held the fit back: without it the law would come nearer, and be unstable.
    pub is_held: bool,
}

/// The stretches at which every law has to be stable, those of the data besides.
const EVERYDAY: [f64; 2] = [0.5, 2.0];
/// The stretches between which stability is looked for at least.
const LOOKED_AT: [f64; 2] = [0.3, 4.0];
/// The stiffness that is left, over the modulus at rest.
const MARGIN: f64 = 2e-3;
/// How near to its margin, over that, a stiffness is held.
const NEAR: f64 = 0.05;
/// Errors of 1 % push with 1e-2, and are met by what is missing times the square of this: 1e-8.
const WEIGHT: f64 = 1e3;
/// Stretches from one end to the other at which the stiffness is looked at.
const SAMPLES: usize = 40;
/// Into how many blocks each test is parted.
const BLOCKS: usize = 5;

/// The fit of `form` to `measured`; none where there are too few points or no stable law was found.
pub(super) fn law_fit(form: &FitForm, measured: &Measured) -> Option<LawFit> {
    if !are_enough(measured.len(), form.numbers()) {
        return None;
    }
    let modulus = measured.modulus();
    let range = required(measured);
    let starts = form.starts.iter();
    let found = starts.filter_map(|start| sought(form, modulus, measured, range, start));
    let best = found.min_by(|a, b| a.cost.total_cmp(&b.cost))?;
    let law = (form.rubber)(&best.x, modulus)?;
    let [least, greatest] = measured.stretches();
    let looked_at = [least.min(LOOKED_AT[0]), greatest.max(LOOKED_AT[1])];
    let stable = law.stable_stretches(looked_at);
    if stable[0] > range[0] || stable[1] < range[1] {
        return None;
    }
    let is_held = !form.is_always_stable && lacks(&law, range).any(|lack| lack > -NEAR * MARGIN);
    Some(LawFit {
        name: form.name,
        numbers: form.numbers(),
        is_of_first_invariant: form.is_of_first_invariant,
        rms: measured.rms(&law),
        relative: measured.errors(&law).map(|error| error * error).sum::<f64>().sqrt(),
        left_out: left_out(form, modulus, measured, range, &best.x),
        stable,
        is_held,
        law,
    })
}

/// Whether so many points are more than the numbers when a block of each test is left out.
pub(super) fn are_enough(points: usize, numbers: usize) -> bool {
    points - points.div_ceil(BLOCKS) > numbers
}

/// The stretches over which a law has to be stable.
fn required(measured: &Measured) -> [f64; 2] {
    let [least, greatest] = measured.stretches();
    [least.min(EVERYDAY[0]), greatest.max(EVERYDAY[1])]
}

/// The numbers near `start` that come nearest to `measured`.
fn sought(
    form: &FitForm,
    modulus: f64,
    measured: &Measured,
    range: [f64; 2],
    start: &[f64],
) -> Option<Minimum> {
    let residuals = |x: &[f64]| {
        let law = (form.rubber)(x, modulus)?;
        let mut all: Vec<f64> = measured.errors(&law).collect();
        if !form.is_always_stable {
            all.extend(lacks(&law, range).map(|lack| WEIGHT * lack.max(0.0)));
        }
        Some(DVector::from_vec(all))
    };
    minimum(residuals, start)
}

/// What the stiffness lacks of its margin at each stretch of each test, over the modulus; negative where it has more.
fn lacks(law: &Rubber, [least, greatest]: [f64; 2]) -> impl Iterator<Item = f64> {
    let modulus = Material::from(law.clone()).shear_modulus().abs().max(f64::MIN_POSITIVE);
    let stretch = move |k: usize| least * (greatest / least).powf(k as f64 / SAMPLES as f64);
    Loading::ALL.into_iter().flat_map(move |loading| {
        (0..=SAMPLES).map(move |k| MARGIN - law.stiffness(loading, stretch(k)) / modulus)
    })
}

/// The error in blocks of points that a fit to the others has not seen.
fn left_out(
    form: &FitForm,
    modulus: f64,
    measured: &Measured,
    range: [f64; 2],
    start: &[f64],
) -> f64 {
    let mut squares = 0.0;
    for block in 0..BLOCKS {
        let [others, hidden] = measured.without_block(block, BLOCKS);
        let law = sought(form, modulus, &others, range, start)
            .and_then(|found| (form.rubber)(&found.x, modulus));
        let Some(law) = law else { return f64::INFINITY };
        squares += hidden.errors_as_part(&law, measured).map(|error| error * error).sum::<f64>();
    }
    squares.sqrt()
}
