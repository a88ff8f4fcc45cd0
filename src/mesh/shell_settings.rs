//! What a shell is to be: its element, its thickness, how it is held and watched.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The finite element of a shell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ShellElement {
    /// Loop's subdivision surface: the accurate one.
    #[default]
    Loop,
    /// Flat triangles whose normals are averaged across edges: the draft, half the price for each unknown.
    MidEdge,
}

impl ShellElement {
    /// Its name in files and tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Loop => "loop",
            Self::MidEdge => "mid-edge",
        }
    }
}

/// How a mid-surface becomes a shell.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ShellSettings {
    /// Wall thickness, mm; the surface is the middle of the wall.
    pub thickness: f64,
    /// Height of the clamp above the lowest vertex, in thicknesses.
    pub clamp_height: f64,
    /// Length of the tip set below the highest vertex, as a fraction of the length along z.
    pub tip_fraction: f64,
    /// The finite element of the wall; by default `loop`, and `mid-edge` for a surface of one's own that has sharp edges.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub element: Option<ShellElement>,
}

impl Default for ShellSettings {
    /// A wall of 1.6 mm clamped over 1.5 thicknesses, as in the public Abaqus decks of the 2022 work.
    fn default() -> Self {
        Self { thickness: 1.6, clamp_height: 1.5, tip_fraction: 0.05, element: None }
    }
}
