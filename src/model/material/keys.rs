//! The keys of a law in a run or scene file: which there are, what they hold, and the lines that say what is wrong with them.

use std::sync::LazyLock;

use serde::Serialize;

use super::rubber::BULK_MODULUS;
use super::{LAWS, Material, OgdenTerm};

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

/// Each law that a file can name, with what it wants, in words.
#[must_use]
pub fn laws_in_words() -> Vec<(&'static str, &'static str)> {
    LAWS.iter().map(|law| (law.name, law.wants)).collect()
}

/// Young's modulus at rest.
pub(super) const YOUNG_MODULUS: Key = Key::number("young_modulus", "Young's modulus at rest, MPa");

/// Poisson's ratio at rest.
pub(super) const POISSON_RATIO: Key = Key::number("poisson_ratio", "Poisson's ratio at rest");

/// Every key that some law has, in the order of the laws.
#[must_use]
pub fn keys() -> &'static [Key] {
    static KEYS: LazyLock<Vec<Key>> = LazyLock::new(|| {
        let mut keys: Vec<Key> = Vec::new();
        for key in LAWS.iter().flat_map(|law| law.keys).chain([&BULK_MODULUS]) {
            if !keys.iter().any(|known| known.name == key.name) {
                keys.push(*key);
            }
        }
        keys
    });
    &KEYS
}

/// A material that cannot be; one line says why.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct InvalidMaterial(String);

impl From<String> for InvalidMaterial {
    fn from(line: String) -> Self {
        Self(line)
    }
}

/// A law as files name it.
#[derive(Clone, Copy, Debug)]
pub(super) struct FileLaw {
    pub(super) name: &'static str,
    pub(super) keys: &'static [Key],
    /// What it wants, in words.
    pub(super) wants: &'static str,
    pub(super) material: fn(&LawKeys<'_>) -> Result<Material, InvalidMaterial>,
}

/// The numbers that a file gives for a law.
#[derive(Clone, Copy, Debug)]
pub(super) struct LawKeys<'a> {
    law: &'a FileLaw,
    given: &'a [(&'static str, KeyValue)],
}

impl Material {
    /// The law of this name with the values `given` for its keys, each key once.
    ///
    /// # Errors
    /// [`InvalidMaterial`] when there is no such law, when a key is missing or surplus, or a value is no law's.
    pub fn named(name: &str, given: &[(&'static str, KeyValue)]) -> Result<Self, InvalidMaterial> {
        let Some(law) = LAWS.iter().find(|law| law.name == name) else {
            let names: Vec<&str> = LAWS.iter().map(|law| law.name).collect();
            let names = names.join(", ");
            return Err(format!("[material] has no law `{name}`; it has {names}").into());
        };
        (law.material)(&LawKeys { law, given })
    }
}

impl LawKeys<'_> {
    /// Checks that no other keys are given than these.
    pub(super) fn allow(&self, keys: &[&str]) -> Result<(), InvalidMaterial> {
        let surplus = self.given.iter().find(|(key, _)| !keys.contains(key));
        surplus.map_or(Ok(()), |(key, _)| {
            let FileLaw { name, wants, .. } = self.law;
            Err(format!("[material] {name} takes no `{key}` here; it wants {wants}").into())
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
            let FileLaw { name, wants, .. } = self.law;
            format!("[material] {name} has no `{key}`; it wants {wants}").into()
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
