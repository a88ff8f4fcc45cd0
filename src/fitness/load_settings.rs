//! The loading programme of a run, and the keys of `[load]` behind it.

use std::borrow::Cow;
use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::de::{Error, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::model::contact::PlaneSettings;
use crate::model::{DEFAULT_STRETCH_BOUND, PartSetup};
use crate::solve::PathSettings;

/// The loading programme.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "LoadKeys", into = "LoadKeys")]
pub struct LoadSettings {
    /// Largest chamber pressure, MPa.
    pub pressure: f64,
    /// Where each design is judged at the pressure that its material bears, up to the largest.
    pub rated: Option<RatedSettings>,
    /// The stretch of the wall beyond which a path ends as ballooning.
    pub stretch_bound: f64,
    /// How the path is walked.
    pub path: PathSettings,
}

/// How designs are told that are judged each at a pressure of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RatedSettings {
    /// The pressure at which all are told besides, MPa.
    pub reference: f64,
}

impl Default for LoadSettings {
    fn default() -> Self {
        Self {
            pressure: 0.2,
            rated: None,
            stretch_bound: DEFAULT_STRETCH_BOUND,
            path: PathSettings::default(),
        }
    }
}

impl LoadSettings {
    /// The setup of a part among `planes`, with the bound on its stretch.
    #[must_use]
    pub fn setup(&self, planes: Vec<PlaneSettings>) -> PartSetup {
        PartSetup { planes, stretch_bound: self.stretch_bound, ..PartSetup::default() }
    }
}

/// The loading programme.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
struct LoadKeys {
    /// Largest chamber pressure, MPa; or "rated": each design is walked to the limit of its material, which `[limits]` sets, and judged there.
    #[schemars(with = "f64")]
    pressure: PressureKey,
    /// With `pressure = "rated"`: where the path of a design ends that comes to no limit, MPa; 0.4 where it is left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    largest_pressure: Option<f64>,
    /// With `pressure = "rated"`: the pressure at which each design that comes to it is told besides, MPa; 0.2 where it is left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    reference_pressure: Option<f64>,
    /// The stretch of the wall beyond which a path ends as ballooning.
    stretch_bound: f64,
    /// How the path is walked.
    path: PathSettings,
}

/// What `pressure` is.
#[derive(Clone, Copy, Debug)]
enum PressureKey {
    /// MPa.
    Given(f64),
    Rated,
}

/// MPa.
const LARGEST_RATED: f64 = 0.4;

const RATED: &str = "rated";

impl Default for LoadKeys {
    fn default() -> Self {
        LoadSettings::default().into()
    }
}

impl From<LoadSettings> for LoadKeys {
    fn from(load: LoadSettings) -> Self {
        let LoadSettings { pressure, rated, stretch_bound, path } = load;
        Self {
            pressure: if rated.is_some() {
                PressureKey::Rated
            } else {
                PressureKey::Given(pressure)
            },
            largest_pressure: rated.map(|_| pressure),
            reference_pressure: rated.map(|rated| rated.reference),
            stretch_bound,
            path,
        }
    }
}

impl TryFrom<LoadKeys> for LoadSettings {
    type Error = &'static str;

    fn try_from(keys: LoadKeys) -> Result<Self, Self::Error> {
        let LoadKeys { largest_pressure, reference_pressure, stretch_bound, path, .. } = keys;
        let (pressure, rated) = match keys.pressure {
            PressureKey::Rated => {
                let reference = reference_pressure.unwrap_or(Self::default().pressure);
                (largest_pressure.unwrap_or(LARGEST_RATED), Some(RatedSettings { reference }))
            }
            PressureKey::Given(pressure) => {
                if largest_pressure.is_some() || reference_pressure.is_some() {
                    return Err(
                        "[load] largest_pressure and reference_pressure want pressure = \"rated\"; the pressure of all designs is [load] pressure",
                    );
                }
                (pressure, None)
            }
        };
        Ok(Self { pressure, rated, stretch_bound, path })
    }
}

impl JsonSchema for LoadSettings {
    fn schema_name() -> Cow<'static, str> {
        "LoadSettings".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        LoadKeys::json_schema(generator)
    }
}

impl Serialize for PressureKey {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Given(pressure) => serializer.serialize_f64(*pressure),
            Self::Rated => serializer.serialize_str(RATED),
        }
    }
}

impl<'de> Deserialize<'de> for PressureKey {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(NumberOrRated)
    }
}

struct NumberOrRated;

impl Visitor<'_> for NumberOrRated {
    type Value = PressureKey;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a number (MPa) or \"rated\"")
    }

    fn visit_f64<E: Error>(self, pressure: f64) -> Result<PressureKey, E> {
        Ok(PressureKey::Given(pressure))
    }

    fn visit_i64<E: Error>(self, pressure: i64) -> Result<PressureKey, E> {
        Ok(PressureKey::Given(pressure as f64))
    }

    fn visit_u64<E: Error>(self, pressure: u64) -> Result<PressureKey, E> {
        Ok(PressureKey::Given(pressure as f64))
    }

    fn visit_str<E: Error>(self, word: &str) -> Result<PressureKey, E> {
        if word == RATED {
            return Ok(PressureKey::Rated);
        }
        Err(E::invalid_value(serde::de::Unexpected::Str(word), &self))
    }
}
