//! `[mesh]` of a scene: how finely its part is meshed.

use std::fmt;

use anyhow::ensure;
use schemars::JsonSchema;
use serde::de::{Error, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::checks::check_mesh;
use super::material::positive;
use super::part::Part;
use crate::field::DesignBox;
use crate::mesh::MeshSettings;

/// How finely a network, an ellipsoid or a surface of one's own is meshed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct MeshSection {
    /// Edge length of the shell's triangles, mm; for an STL file 1.5 wall thicknesses where it is left out, or `"as given"`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<TypedEdge>")]
    pub edge: Option<Edge>,
    /// For a network: radius to which the rims of the flat caps are rounded, mm.
    pub rim_radius: f64,
}

impl Default for MeshSection {
    fn default() -> Self {
        Self { edge: None, rim_radius: MeshSettings::default().rim_radius }
    }
}

/// The triangles of a shell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Edge {
    /// Of this edge, mm.
    Length(f64),
    /// As the file has them.
    AsGiven,
}

/// An [`Edge`] as it stands in a file.
#[derive(JsonSchema)]
#[serde(untagged)]
#[expect(dead_code, reason = "only its schema is read")]
enum TypedEdge {
    Length(f64),
    Word(String),
}

impl MeshSection {
    /// As a network or an ellipsoid is meshed.
    pub(crate) fn settings(&self) -> MeshSettings {
        let edge = match self.edge {
            Some(Edge::Length(edge)) => edge,
            Some(Edge::AsGiven) | None => MeshSettings::default().edge,
        };
        MeshSettings { edge, rim_radius: self.rim_radius }
    }

    /// Checks the section for a `part`, a network's in its `design_box`.
    pub(crate) fn check(&self, part: &Part, design_box: DesignBox) -> anyhow::Result<()> {
        if part.stl.is_none() {
            ensure!(
                self.edge != Some(Edge::AsGiven),
                "[mesh] edge = {AS_GIVEN:?} wants a [part] with an `stl`; other parts want a length in mm"
            );
            return check_mesh(design_box, &self.settings());
        }
        if let Some(Edge::Length(edge)) = self.edge {
            positive("[mesh] edge", edge)?;
        }
        Ok(())
    }
}

const AS_GIVEN: &str = "as given";

impl Serialize for Edge {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Length(edge) => serializer.serialize_f64(*edge),
            Self::AsGiven => serializer.serialize_str(AS_GIVEN),
        }
    }
}

impl<'de> Deserialize<'de> for Edge {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(LengthOrWords)
    }
}

struct LengthOrWords;

impl Visitor<'_> for LengthOrWords {
    type Value = Edge;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "a number or {AS_GIVEN:?}")
    }

    fn visit_f64<E: Error>(self, edge: f64) -> Result<Edge, E> {
        Ok(Edge::Length(edge))
    }

    fn visit_i64<E: Error>(self, edge: i64) -> Result<Edge, E> {
        Ok(Edge::Length(edge as f64))
    }

    fn visit_u64<E: Error>(self, edge: u64) -> Result<Edge, E> {
        Ok(Edge::Length(edge as f64))
    }

    fn visit_str<E: Error>(self, words: &str) -> Result<Edge, E> {
        if words == AS_GIVEN {
            return Ok(Edge::AsGiven);
        }
        Err(E::invalid_value(serde::de::Unexpected::Str(words), &self))
    }
}
