//! Every law fitted, and the one to use.

use rayon::prelude::*;

use super::law_fit::{LawFit, are_enough, law_fit};
use super::measured::Measured;
use crate::model::material::{FitForm, fit_forms};

/// What the fits of all laws come to.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// Every law that could be fitted, in the order of the laws.
    pub fits: Vec<LawFit>,
    /// The place of the one to use.
    pub best: usize,
    /// Those that could not, each with the reason.
    pub dropped: Vec<(&'static str, String)>,
    /// Whether one kind of test was all there is, so that only laws of the first invariant were chosen from.
    pub is_of_one_test: bool,
}

impl Choice {
    /// The law to use.
    #[must_use]
    pub fn best(&self) -> &LawFit {
        &self.fits[self.best]
    }
}

/// How much worse a law with fewer numbers may predict what was left out and is still preferred.
const PREFERENCE: f64 = 1.1;

/// Fits every law to `measured` and chooses: of those whose error in what was left out is at most 1.1 times the least, the one with the
/// fewest numbers. None where no law could be fitted.
///
/// Of one kind of test alone only laws of the first invariant are chosen from. What such a test leaves open of the others can be beyond all
/// measure: the term of Ogden's that comes nearest to a printed polyurethane under tension has twenty times the stress where it is pulled
/// alike in two directions. Laws of the first invariant carry over.
///
/// Source: Stone (1974) for the criterion; Breiman et al. (1984) for preferring the simpler of near equals; Yeoh (1993) for the first
/// invariant.
#[must_use]
pub fn fit_laws(measured: &Measured) -> Option<Choice> {
    let forms = fit_forms();
    let found: Vec<(FitForm, Option<LawFit>)> =
        forms.into_par_iter().map(|form| (form, law_fit(&form, measured))).collect();
    let (mut fits, mut dropped) = (Vec::new(), Vec::new());
    for (form, fit) in found {
        match fit {
            Some(fit) => fits.push(fit),
            None if are_enough(measured.len(), form.numbers()) => {
                dropped.push((form.name, "no stable law was found".to_owned()));
            }
            None => {
                let (points, numbers) = (measured.len(), form.numbers());
                dropped.push((
                    form.name,
                    format!("{points} points are too few for {numbers} numbers"),
                ));
            }
        }
    }
    let is_of_one_test = measured.tests().count() == 1;
    let is_choice = |fit: &LawFit| !is_of_one_test || fit.is_of_first_invariant;
    let places: Vec<(usize, &LawFit)> =
        fits.iter().enumerate().filter(|(_, fit)| is_choice(fit)).collect();
    let least = places.iter().map(|(_, fit)| fit.left_out).fold(f64::INFINITY, f64::min);
    let near = |fit: &&(usize, &LawFit)| fit.1.left_out <= PREFERENCE * least;
    let best = places
        .iter()
        .filter(near)
        .min_by(|(_, a), (_, b)| a.numbers.cmp(&b.numbers).then(a.left_out.total_cmp(&b.left_out)));
    let best = best.map(|(place, _)| *place)?;
    Some(Choice { fits, best, dropped, is_of_one_test })
}
