//! A network as a person writes it: unchecked, in the order and with the names of the file.
//!
//! ```toml
//! length_unit_mm = 10.0     # coordinates are centimetres (the default)
//! output = "chamber"        # the last node of the file if not given
//!
//! [wall]                    # nodes that say what the wall is made of, on its middle; left out, it is the same everywhere
//! thickness = "relief"      # mm
//! material = "side"         # the second material where it is positive
//!
//! [inputs]                  # a bias added to each coordinate: x, y, z, theta, r; 0 if not given
//! z = 0.5
//!
//! [[node]]
//! name = "pleats"
//! activation = "cosine"     # identity if not given
//! aggregation = "sum"       # or "product", over weight * source; sum if not given
//! links = { z = 3.2 }       # source = weight; a source is a coordinate or another node; a constant if not given
//! bias = -0.6               # added AFTER the activation; 0 if not given
//!
//! [[node]]
//! name = "chamber"
//! links = { pleats = 1.0, x = 0.1 }
//! ```

use std::collections::BTreeMap;
use std::fmt::Write;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::activation::Activation;
use super::network::{Aggregation, Coordinate, Network, Source, WallNodes};

/// A network file: becomes a [`Network`] by `Network::try_from`, which checks it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NetworkDraft {
    /// The length in mm of one unit of x, y, z and r.
    #[serde(default = "centimetre")]
    pub length_unit_mm: f64,
    /// The name of the node whose value is the field; the last node of the file where it is left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub output: Option<String>,
    /// What the wall is made of; it is the same everywhere where it is left out.
    #[serde(default, skip_serializing_if = "WallNodes::is_empty")]
    pub wall: WallNodes<String>,
    /// What is added to each coordinate.
    #[serde(default)]
    pub inputs: InputBiases,
    /// The nodes, in any order.
    #[serde(default, rename = "node")]
    pub nodes: Vec<NodeDraft>,
}

/// What is added to each coordinate before any node sees it (length units; theta in radians).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct InputBiases {
    /// Across.
    pub x: f64,
    /// Across.
    pub y: f64,
    /// Along the actuator.
    pub z: f64,
    /// `atan2(y, x)` of the unbiased coordinates.
    pub theta: f64,
    /// `sqrt(x^2 + y^2)` of the unbiased coordinates.
    pub r: f64,
}

/// One node: `activation(aggregation of weight * source) + bias`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NodeDraft {
    /// Letters, digits, `_` and `-`; not a coordinate's name.
    pub name: String,
    /// The function applied to the aggregate.
    #[serde(default)]
    pub activation: Activation,
    /// How the weighted sources are joined.
    #[serde(default)]
    pub aggregation: Aggregation,
    /// Weight of each source; without any the node is a constant.
    #[serde(default)]
    pub links: BTreeMap<String, f64>,
    /// Added after the activation.
    #[serde(default)]
    pub bias: f64,
}

impl From<&Network> for NetworkDraft {
    fn from(network: &Network) -> Self {
        let [x, y, z, theta, r] = network.input_biases();
        let name = |source| match source {
            Source::Input(coordinate) => coordinate.name().to_owned(),
            Source::Node(index) => network.nodes()[index].name.clone(),
        };
        let draft = |node: &super::network::Node| NodeDraft {
            name: node.name.clone(),
            activation: node.activation,
            aggregation: node.aggregation,
            links: node.links.iter().map(|link| (name(link.source), link.weight)).collect(),
            bias: node.bias,
        };
        Self {
            length_unit_mm: network.length_unit_mm(),
            output: Some(network.nodes()[network.output()].name.clone()),
            wall: network.wall().map(|node| network.nodes()[node].name.clone()),
            inputs: InputBiases { x, y, z, theta, r },
            nodes: network.nodes().iter().map(draft).collect(),
        }
    }
}

impl NetworkDraft {
    /// The text of the network file, which parses back to the same bits.
    #[must_use]
    pub fn to_toml(&self) -> String {
        let mut text = format!("length_unit_mm = {:?}\n", self.length_unit_mm);
        if let Some(output) = &self.output {
            push_line(&mut text, format_args!("output = \"{output}\""));
        }
        if !self.wall.is_empty() {
            text.push_str("\n[wall]\n");
            let WallNodes { thickness, material } = &self.wall;
            for (name, node) in [("thickness", thickness), ("material", material)] {
                if let Some(node) = node {
                    push_line(&mut text, format_args!("{name} = \"{node}\""));
                }
            }
        }
        text.push_str("\n[inputs]\n");
        let InputBiases { x, y, z, theta, r } = self.inputs;
        for (coordinate, bias) in Coordinate::ALL.iter().zip([x, y, z, theta, r]) {
            push_line(&mut text, format_args!("{} = {bias:?}", coordinate.name()));
        }
        for node in &self.nodes {
            push_node(&mut text, node);
        }
        text
    }
}

fn push_node(text: &mut String, node: &NodeDraft) {
    push_line(text, format_args!("\n[[node]]\nname = \"{}\"", node.name));
    push_line(text, format_args!("activation = \"{}\"", serde_name(node.activation)));
    push_line(text, format_args!("aggregation = \"{}\"", serde_name(node.aggregation)));
    let links: Vec<_> = node.links.iter().map(|(from, w)| format!("{from} = {w:?}")).collect();
    push_line(text, format_args!("links = {{ {} }}", links.join(", ")));
    push_line(text, format_args!("bias = {:?}", node.bias));
}

fn push_line(text: &mut String, line: std::fmt::Arguments<'_>) {
    writeln!(text, "{line}").expect("writing to a string does not fail");
}

/// The name under which a unit variant is serialized.
fn serde_name(variant: impl Serialize) -> String {
    let value = toml::Value::try_from(variant).expect("unit variants serialize to strings");
    value.as_str().expect("unit variants serialize to strings").to_owned()
}

fn centimetre() -> f64 {
    10.0
}
