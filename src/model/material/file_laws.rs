//! The laws that a run or scene file can name.

use std::sync::LazyLock;

use super::keys::{InvalidMaterial, Key, KeyValue, LawKeys};
use super::material::Material;
use super::named_law::{BULK_MODULUS, NamedLaw};
use super::st_venant_kirchhoff::{self, StVenantKirchhoff};

/// A law as files name it.
#[derive(Clone, Copy, Debug)]
pub(super) struct FileLaw {
    pub(super) name: &'static str,
    pub(super) keys: &'static [Key],
    /// What it wants, in words.
    pub(super) wants: &'static str,
    pub(super) material: fn(&LawKeys<'_>) -> Result<Material, InvalidMaterial>,
}

macro_rules! laws {
    ($($Law:ident),+) => {
        /// The laws that a file can name.
        pub(super) const LAWS: &[FileLaw] = &[
            $(FileLaw {
                name: <super::$Law as NamedLaw>::NAME,
                keys: <super::$Law as NamedLaw>::KEYS,
                wants: <super::$Law as NamedLaw>::WANTS,
                material: |keys| {
                    let (law, bulk_modulus) = super::$Law::read_with_bulk_modulus(keys)?;
                    Ok(Material::of_rubber(law.into(), bulk_modulus))
                },
            },)+
            FileLaw {
                name: st_venant_kirchhoff::NAME,
                keys: st_venant_kirchhoff::KEYS,
                wants: st_venant_kirchhoff::WANTS,
                material: |keys| StVenantKirchhoff::read(keys).map(Material::StVenantKirchhoff),
            },
        ];
    };
}
for_rubbers!(laws);

/// Each law that a file can name, with what it wants, in words.
#[must_use]
pub fn laws_in_words() -> Vec<(&'static str, &'static str)> {
    LAWS.iter().map(|law| (law.name, law.wants)).collect()
}

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
        (law.material)(&LawKeys { law: law.name, wants: law.wants, given })
    }
}
