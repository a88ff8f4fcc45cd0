//! How a fit to tests seeks the numbers of a law.
//!
//! A law says it in its own file, by [`FittedLaw`]. The coordinates of a fit are any real numbers of the order of 1: what must be positive
//! enters as its logarithm, and what is a stress as a multiple of the modulus that the tests show.

use super::keys::KeyValue;
use super::named_law::NamedLaw;
use super::rubber::Rubber;

/// A form of a law with a fixed count of numbers.
#[derive(Clone, Copy, Debug)]
pub struct FitForm {
    /// Its name: the law's, with the count of its terms where that may differ.
    pub name: &'static str,
    /// Coordinates to begin with.
    pub starts: &'static [&'static [f64]],
    /// Whether every law of this form is stable in Drucker's sense at all stretches; if not, a fit has to see to it.
    pub is_always_stable: bool,
    /// Whether the law depends on the first invariant alone.
    pub is_of_first_invariant: bool,
    /// The law at coordinates, with a modulus in MPa; none where a number is out of all bounds.
    pub rubber: fn(&[f64], f64) -> Option<Rubber>,
}

impl FitForm {
    /// How many numbers the law has in this form.
    #[must_use]
    pub fn numbers(&self) -> usize {
        self.starts[0].len()
    }
}

/// A law whose numbers can be sought.
pub(super) trait FittedLaw: NamedLaw {
    /// Its forms, the one with the fewest numbers first.
    const FORMS: &'static [FitForm];

    /// The keys of [`NamedLaw::KEYS`] that say this law, with their values.
    fn values(&self) -> Vec<(&'static str, KeyValue)>;
}

macro_rules! forms {
    ($($Law:ident),+) => {
        /// Every form in which a fit seeks a law, in the order of the laws.
        #[must_use]
        pub fn fit_forms() -> Vec<FitForm> {
            [$(<super::$Law as FittedLaw>::FORMS),+].concat()
        }

        impl Rubber {
            /// The keys of a run or scene file that say this law, with their values.
            #[must_use]
            pub fn values(&self) -> Vec<(&'static str, KeyValue)> {
                match self {
                    $(Self::$Law(law) => law.values(),)+
                }
            }
        }
    };
}
for_rubbers!(forms);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::material::{Loading, Material, example_rubbers};

    /// What a law says of itself is read as the same law.
    #[test]
    fn values_are_read_back() {
        for rubber in example_rubbers() {
            let read = Material::named(rubber.name(), &rubber.values()).unwrap();
            assert_eq!(read, rubber.into());
        }
    }

    /// Each start is a stable law with a modulus of the order of what it was given.
    #[test]
    fn a_fit_begins_at_stable_laws() {
        for form in fit_forms() {
            for start in form.starts {
                assert_eq!(start.len(), form.numbers(), "{}", form.name);
                let law = (form.rubber)(start, 0.7).unwrap();
                let ratio = Material::from(law.clone()).shear_modulus() / 0.7;
                assert!((0.3..3.0).contains(&ratio), "{} {start:?} {ratio}", form.name);
                assert!(form.name.starts_with(law.name()));
                for loading in Loading::ALL {
                    assert!(law.stiffness(loading, 1.7) > 0.0, "{} {start:?}", form.name);
                }
            }
        }
    }
}
