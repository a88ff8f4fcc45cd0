//! `[pattern]`: what a network may say of its wall.

use anyhow::ensure;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::limits::{LimitsSection, OfMaterial};
use super::material::{MaterialSection, positive};
use crate::fitness::WallPattern;
use crate::genome::{Network, WallGenes};

/// What a network says of its wall, with the nodes that its `[wall]` names.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct PatternSection {
    /// The least and the greatest thickness that it may ask for, mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub thickness: Option<[f64; 2]>,
    /// A second material: the wall is of it where the network's node for the material is positive.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub material: Option<MaterialSection>,
    /// What the second material may bear, as `[limits]` says of the first: `limits = { stretch = 1.2 }`; as `[limits]` where it is left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limits: Option<LimitsSection>,
}

impl PatternSection {
    /// What it means.
    ///
    /// # Errors
    /// When it says nothing, or its numbers are none of a wall.
    pub(crate) fn pattern(&self) -> anyhow::Result<WallPattern> {
        ensure!(
            self.thickness.is_some() || self.material.is_some(),
            "[pattern] wants a `thickness` or a `material`"
        );
        if let Some([least, most]) = self.thickness {
            positive("[pattern] thickness", least)?;
            positive("[pattern] thickness", most)?;
            ensure!(
                least < most,
                "[pattern] thickness is [{least:?}, {most:?}], but the smaller one comes first"
            );
        }
        let material = self.material.as_ref().map(MaterialSection::material).transpose()?;
        Ok(WallPattern { thickness: self.thickness, material })
    }

    /// What it says of its second material.
    pub(crate) fn limited(&self) -> OfMaterial<'_> {
        let (material, limits) = (self.material.as_ref(), self.limits.as_ref());
        OfMaterial { section: "[pattern] limits", material, limits }
    }

    /// The genes that a search has for it.
    pub(crate) fn genes(&self) -> WallGenes {
        WallGenes { thickness: self.thickness.is_some(), material: self.material.is_some() }
    }

    /// Checks that `network` says what a pattern, if there is one, lets it say, and no more.
    pub(crate) fn check(pattern: Option<&Self>, network: &Network) -> anyhow::Result<()> {
        let (nodes, given) = (network.wall(), pattern.map(Self::genes).unwrap_or_default());
        for (name, is_node, is_given, example) in [
            ("thickness", nodes.thickness.is_some(), given.thickness, "[0.8, 2.4]"),
            (
                "material",
                nodes.material.is_some(),
                given.material,
                "{ law = \"neo-hookean\", mu = 5.0 }",
            ),
        ] {
            ensure!(
                !is_node || is_given,
                "the network's [wall] names a node for the {name}; the file wants [pattern] {name} = {example}"
            );
            ensure!(
                is_node || !is_given,
                "[pattern] {name} wants a network whose [wall] names a node for the {name}"
            );
        }
        Ok(())
    }
}
