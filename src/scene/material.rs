//! `[material]` of a run or scene file: a preset, or a law with its numbers.

use std::borrow::Cow;
use std::fmt;
use std::sync::LazyLock;

use anyhow::{Error, bail};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{DeserializeSeed, Deserializer, MapAccess, Visitor};
use serde::ser::{SerializeMap, Serializer};
use serde::{Deserialize, Serialize};
use serde_json::{Map, json};

use super::presets::{self, PRESETS, Preset};
use crate::model::material::{
    Key, KeyKind, KeyValue, Loading, Material, keys, laws_in_words, positive as is_positive,
    within as is_within,
};

/// What a file says about the material: a preset alone, or a law with its own keys.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MaterialSection {
    /// One of [`presets::PRESETS`].
    preset: Option<String>,
    /// One of the laws of [`crate::model::material`].
    law: Option<String>,
    /// The values of the law's keys, in the order of [`keys`].
    numbers: Vec<(&'static str, KeyValue)>,
}

impl Default for MaterialSection {
    fn default() -> Self {
        Self { preset: Some("ninjaflex-c2s".to_owned()), law: None, numbers: Vec::new() }
    }
}

impl MaterialSection {
    pub(crate) fn material(&self) -> anyhow::Result<Material> {
        match (&self.preset, &self.law) {
            (Some(preset), None) => self.of_preset(preset),
            (None, Some(law)) => Ok(Material::named(law, &self.numbers)?),
            (Some(_), Some(_)) => bail!("[material] has both `preset` and `law`; give one"),
            (None, None) => bail!("[material] has neither `preset` nor `law`; give one"),
        }
    }

    /// The preset, or the law.
    pub(crate) fn name(&self) -> &str {
        self.preset.as_deref().or(self.law.as_deref()).unwrap_or_default()
    }

    /// The preset, where there is one of this name.
    pub(crate) fn preset(&self) -> Option<&'static Preset> {
        presets::named(self.preset.as_deref()?)
    }

    /// The principal stretch that it is taken to bear where nobody says another: that of its preset, if that has one.
    pub(crate) fn assumed_stretch(&self) -> Option<f64> {
        self.preset()?.borne_stretch
    }

    fn of_preset(&self, preset: &str) -> anyhow::Result<Material> {
        if let Some((key, _)) = self.numbers.first() {
            bail!(
                "[material] takes no `{key}` beside `preset`; numbers of your own go with a `law`"
            );
        }
        match presets::named(preset) {
            Some(preset) => Ok((preset.material)()),
            None => bail!("[material] has no preset `{preset}`; it has {}", presets::names()),
        }
    }
}

impl Serialize for MaterialSection {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        for (word, value) in [("preset", &self.preset), ("law", &self.law)] {
            if let Some(value) = value {
                map.serialize_entry(word, value)?;
            }
        }
        for (key, value) in &self.numbers {
            map.serialize_entry(key, value)?;
        }
        map.end()
    }
}

impl<'de> Deserialize<'de> for MaterialSection {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(SectionVisitor)
    }
}

/// Reads a section key by key, so that a value of the wrong kind is told with its line.
struct SectionVisitor;

impl<'de> Visitor<'de> for SectionVisitor {
    type Value = MaterialSection;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a section with a preset, or a law and its keys")
    }

    fn visit_map<M: MapAccess<'de>>(self, mut map: M) -> Result<MaterialSection, M::Error> {
        let mut section = MaterialSection { preset: None, law: None, numbers: Vec::new() };
        while let Some(word) = map.next_key()? {
            match word {
                Word::Preset => section.preset = Some(map.next_value()?),
                Word::Law => section.law = Some(map.next_value()?),
                Word::Key(Key { name, kind, .. }) => {
                    section.numbers.push((name, map.next_value_seed(Kind(kind))?));
                }
            }
        }
        let place = |name| keys().iter().position(|key| key.name == name);
        section.numbers.sort_by_key(|(name, _)| place(*name));
        Ok(section)
    }
}

/// A word before `=`.
enum Word {
    Preset,
    Law,
    Key(Key),
}

impl JsonSchema for MaterialSection {
    fn schema_name() -> Cow<'static, str> {
        "MaterialSection".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let mut properties = Map::new();
        let preset = |preset: &Preset| format!("{} ({})", preset.name, preset.range());
        let presets: Vec<String> = PRESETS.iter().map(preset).collect();
        let preset = format!(
            "A material with its numbers, and the test behind them: {}. `pneumorph material presets` tells the sources.",
            presets.join("; ")
        );
        let default = Self::default().preset;
        let preset = json!({ "type": "string", "description": preset, "default": default });
        properties.insert("preset".to_owned(), preset);
        let mut add = |name: &str, kind: &str, meaning: String| {
            properties.insert(name.to_owned(), json!({ "type": kind, "description": meaning }));
        };
        let laws: Vec<String> =
            laws_in_words().iter().map(|(law, wants)| format!("{law} ({wants})")).collect();
        let laws = laws.join("; ");
        add("law", "string", format!("Instead of a preset: a law, with keys of its own: {laws}."));
        for Key { name, kind, meaning } in keys() {
            let kind = if *kind == KeyKind::Number { "number" } else { "array" };
            add(name, kind, format!("Of a law: {meaning}."));
        }
        json_schema!({
            "description": "What the wall is made of.",
            "type": "object",
            "properties": properties,
        })
    }
}

/// All that a section knows, in the order in which a message lists them.
static WORDS: LazyLock<Vec<&'static str>> = LazyLock::new(|| {
    ["preset", "law"].into_iter().chain(keys().iter().map(|key| key.name)).collect()
});

impl<'de> Deserialize<'de> for Word {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct WordVisitor;
        impl Visitor<'_> for WordVisitor {
            type Value = Word;

            fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
                formatter.write_str("a key")
            }

            fn visit_str<E: serde::de::Error>(self, word: &str) -> Result<Word, E> {
                let key = || keys().iter().find(|key| key.name == word).copied();
                match word {
                    "preset" => Ok(Word::Preset),
                    "law" => Ok(Word::Law),
                    _ => key().map(Word::Key).ok_or_else(|| E::unknown_field(word, &WORDS)),
                }
            }
        }
        deserializer.deserialize_identifier(WordVisitor)
    }
}

/// Reads a value of its kind.
struct Kind(KeyKind);

impl<'de> DeserializeSeed<'de> for Kind {
    type Value = KeyValue;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<KeyValue, D::Error> {
        match self.0 {
            KeyKind::Number => Deserialize::deserialize(deserializer).map(KeyValue::Number),
            KeyKind::Triple => Deserialize::deserialize(deserializer).map(KeyValue::Triple),
            KeyKind::Terms => Deserialize::deserialize(deserializer).map(KeyValue::Terms),
        }
    }
}

/// Where a rubber gives way within everyday stretches, a line that says so.
pub(crate) fn instability(material: &Material) -> Option<String> {
    const EVERYDAY: [f64; 2] = [0.5, 2.0];
    let is_rubber = !matches!(material, Material::StVenantKirchhoff(_));
    let [least, most] =
        Loading::ALL.iter().filter(|_| is_rubber).fold(EVERYDAY, |range, &loading| {
            let [least, most] = material.stable_stretches(loading);
            [range[0].max(least), range[1].min(most)]
        });
    // A law that is unstable at rest fails by itself, and says so.
    ([least, most] != EVERYDAY && least < most).then(|| {
        format!(
            "[material] is stable between stretches of {least:.2} and {most:.2} only (Drucker); beyond, its answers are no material's"
        )
    })
}

/// Checks that `value` is a positive number of a size that mm, N and MPa can have.
pub(crate) fn positive(what: &str, value: f64) -> anyhow::Result<f64> {
    is_positive(what, value).map_err(Error::msg)
}

/// Checks that `value` lies from `least` to `most`.
pub(crate) fn within(what: &str, value: f64, least: f64, most: f64) -> anyhow::Result<f64> {
    is_within(what, value, least, most).map_err(Error::msg)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::io::toml_file;
    use crate::model::material::{
        Compressible, MooneyRivlin, NeoHookean, Ogden, OgdenTerm, Rubber, StVenantKirchhoff, Yeoh,
    };

    fn section(text: &str) -> MaterialSection {
        toml_file::parse(text, Path::new("run.toml")).unwrap()
    }

    #[test]
    fn every_law_is_read() {
        let neo_hookean = Rubber::NeoHookean(NeoHookean { mu: 1.5 });
        let mooney_rivlin = Rubber::MooneyRivlin(MooneyRivlin { c1: 0.5, c2: 0.25 });
        let yeoh = Rubber::Yeoh(Yeoh { c: [1.0, -0.5, 0.25] });
        let ogden = Rubber::Ogden(Ogden::new(&[OgdenTerm { mu: 2.0, alpha: -3.0 }]));
        for (text, law) in [
            ("law = 'neo-hookean'\nmu = 1.5\n", neo_hookean),
            ("law = 'mooney-rivlin'\nc1 = 0.5\nc2 = 0.25\n", mooney_rivlin),
            ("law = 'yeoh'\nc = [1, -0.5, 0.25]\n", yeoh),
            ("law = 'ogden'\nterms = [{ mu = 2, alpha = -3 }]\n", ogden),
        ] {
            assert_eq!(section(text).material().unwrap(), law.clone().into());
            let text = format!("{text}bulk_modulus = 20\n");
            let compressible = Compressible { law, bulk_modulus: 20.0 };
            assert_eq!(section(&text).material().unwrap(), Material::Compressible(compressible));
        }
        let plate = StVenantKirchhoff { young_modulus: 3.0, poisson_ratio: -0.25 };
        let text = "law = 'st-venant-kirchhoff'\nyoung_modulus = 3\npoisson_ratio = -0.25\n";
        assert_eq!(section(text).material().unwrap(), Material::StVenantKirchhoff(plate));
    }

    /// `mu = E / 2.5` and `kappa = E / 1.5` at a Poisson's ratio of a quarter; `mu = E / 3` at a half.
    #[test]
    fn neo_hookean_is_read_by_its_moduli_at_rest() {
        let of_ratio = |poisson_ratio: f64| {
            let text = format!(
                "law = 'neo-hookean'\nyoung_modulus = 3\npoisson_ratio = {poisson_ratio:?}\n"
            );
            section(&text).material().unwrap()
        };
        let law = Rubber::NeoHookean(NeoHookean { mu: 1.2 });
        assert_eq!(of_ratio(0.25), Material::Compressible(Compressible { law, bulk_modulus: 2.0 }));
        assert_eq!(of_ratio(0.5), Material::NeoHookean(NeoHookean { mu: 1.0 }));
        let nearly = of_ratio(0.499_999);
        assert!((nearly.young_modulus() - 3.0).abs() < 1e-12, "{nearly:?}");
        assert!((nearly.poisson_ratio() - 0.499_999).abs() < 1e-12, "{nearly:?}");
    }

    #[test]
    fn every_preset_is_read_and_written() {
        for (preset, shear, ratio) in [
            ("ninjaflex-c2s", 5.211_656, 0.5),
            ("ninjaflex-c2s-compressible", 5.211_656, 0.380_121),
            ("ninjaflex-yap2016", 6.212, 0.5),
            ("dragon-skin-30", 0.178_802, 0.5),
            ("filaflex-70a", 2.761_062, 0.5),
        ] {
            let section = section(&format!("preset = '{preset}'\n"));
            let material = section.material().unwrap();
            assert!((material.shear_modulus() - shear).abs() < 1e-6, "{preset}");
            assert!((material.poisson_ratio() - ratio).abs() < 1e-6, "{preset}");
            assert_eq!(toml::to_string(&section).unwrap(), format!("preset = \"{preset}\"\n"));
        }
    }

    /// A second term of the other sign and a larger exponent wins at a stretch that tension alone reaches.
    #[test]
    fn laws_that_give_way_are_told() {
        let unstable =
            Ogden::new(&[OgdenTerm { mu: 2.0, alpha: 2.0 }, OgdenTerm { mu: -0.2, alpha: 6.0 }]);
        assert!(
            instability(&Material::Ogden(unstable)).is_some_and(|line| line.contains("stretches"))
        );
        assert_eq!(instability(&Material::Ogden(Ogden::ninjaflex_c2s())), None);
        assert_eq!(instability(&Material::Ogden(Ogden::ninjaflex_yap2016())), None);
    }
}
