//! The keys of a law in a run or scene file: which there are, what they hold, and the lines that say what is wrong with them.

use serde::Serialize;

use super::ogden_term::OgdenTerm;

/// A key of `[material]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Key {
    /// Its name.
    pub name: &'static str,
    /// What it holds.
    pub kind: KeyKind,
    /// What it is, in a few words, with its unit.
    pub meaning: &'static str,
}

/// What a key holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeyKind {
    /// A number.
    Number,
    /// A list of three numbers.
    Triple,
    /// A list of terms of Ogden's law.
    Terms,
}

impl Key {
    /// A key that holds a number.
    pub(super) const fn number(name: &'static str, meaning: &'static str) -> Self {
        Self { name, kind: KeyKind::Number, meaning }
    }
}

/// The value of a key.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum KeyValue {
    /// A number.
    Number(f64),
    /// Three numbers.
    Triple([f64; 3]),
    /// Terms of Ogden's law.
    Terms(Vec<OgdenTerm>),
}

impl KeyValue {
    fn number(&self) -> Option<f64> {
        if let Self::Number(number) = self { Some(*number) } else { None }
    }

    fn triple(&self) -> Option<[f64; 3]> {
        if let Self::Triple(triple) = self { Some(*triple) } else { None }
    }

    fn terms(&self) -> Option<&[OgdenTerm]> {
        if let Self::Terms(terms) = self { Some(terms) } else { None }
    }
}

/// Young's modulus at rest.
pub(super) const YOUNG_MODULUS: Key = Key::number("young_modulus", "Young's modulus at rest, MPa");

/// Poisson's ratio at rest.
pub(super) const POISSON_RATIO: Key = Key::number("poisson_ratio", "Poisson's ratio at rest");

/// A material that cannot be; one line says why.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct InvalidMaterial(String);

impl From<String> for InvalidMaterial {
    fn from(line: String) -> Self {
        Self(line)
    }
}

/// The numbers that a file gives for a law.
#[derive(Clone, Copy, Debug)]
pub(super) struct LawKeys<'a> {
    /// The law's name.
    pub(super) law: &'static str,
    /// What it wants, in words.
    pub(super) wants: &'static str,
    pub(super) given: &'a [(&'static str, KeyValue)],
}

impl LawKeys<'_> {
    /// Checks that no other keys are given than these.
    pub(super) fn allow(&self, keys: &[&str]) -> Result<(), InvalidMaterial> {
        let surplus = self.given.iter().find(|(key, _)| !keys.contains(key));
        surplus.map_or(Ok(()), |(key, _)| {
            let Self { law, wants, .. } = self;
            Err(format!("[material] {law} takes no `{key}` here; it wants {wants}").into())
        })
    }

    /// Whether this key is given.
    pub(super) fn has(&self, key: &str) -> bool {
        self.given.iter().any(|(given, _)| *given == key)
    }

    /// The number that this key holds.
    pub(super) fn number(&self, key: &str) -> Result<f64, InvalidMaterial> {
        self.wanted(key, KeyValue::number)
    }

    /// The number that this key holds, which must be positive.
    pub(super) fn positive(&self, key: &str) -> Result<f64, InvalidMaterial> {
        Ok(positive(&format!("[material] {key}"), self.number(key)?)?)
    }

    /// The number that this key holds, of either sign.
    pub(super) fn coefficient(&self, key: &str) -> Result<f64, InvalidMaterial> {
        Ok(coefficient(&format!("[material] {key}"), self.number(key)?)?)
    }

    /// The number that this key holds, from `least` to `most`.
    pub(super) fn within(&self, key: &str, least: f64, most: f64) -> Result<f64, InvalidMaterial> {
        Ok(within(&format!("[material] {key}"), self.number(key)?, least, most)?)
    }

    /// The three numbers that this key holds.
    pub(super) fn triple(&self, key: &str) -> Result<[f64; 3], InvalidMaterial> {
        self.wanted(key, KeyValue::triple)
    }

    /// The terms that this key holds.
    pub(super) fn terms(&self, key: &str) -> Result<&[OgdenTerm], InvalidMaterial> {
        self.wanted(key, KeyValue::terms)
    }

    /// The value of a key that the law cannot do without.
    fn wanted<'a, T>(
        &'a self,
        key: &str,
        of_kind: impl Fn(&'a KeyValue) -> Option<T>,
    ) -> Result<T, InvalidMaterial> {
        let value = self.given.iter().find(|(given, _)| *given == key);
        value.and_then(|(_, value)| of_kind(value)).ok_or_else(|| {
            let Self { law, wants, .. } = self;
            format!("[material] {law} has no `{key}`; it wants {wants}").into()
        })
    }
}

/// Checks that `value` is a positive number of a size that mm, N and MPa can have.
///
/// # Errors
/// The line that says what is wrong with `what`.
pub fn positive(what: &str, value: f64) -> Result<f64, String> {
    if value > 0.0 && value.is_finite() {
        return within(what, value, 1e-9, 1e12);
    }
    Err(format!("{what} is {value:?}, but it must be a positive number"))
}

/// Checks that `value`, of either sign, has a size that MPa can have.
pub(super) fn coefficient(what: &str, value: f64) -> Result<f64, String> {
    within(what, value, -1e12, 1e12)
}

/// Checks that `value` lies from `least` to `most`.
///
/// # Errors
/// The line that says what is wrong with `what`.
pub fn within(what: &str, value: f64, least: f64, most: f64) -> Result<f64, String> {
    if (least..=most).contains(&value) {
        return Ok(value);
    }
    Err(format!("{what} is {value:?}, but it must lie between {least:?} and {most:?}"))
}
