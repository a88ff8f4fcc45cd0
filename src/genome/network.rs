//! Feed-forward computational networks (CPPNs): what a genome means as a formula.
//!
//! ```text
//! value(node) = activation( sum or product over links of weight * value(source) ) + bias
//! inputs      = x + bias_x, y + bias_y, z + bias_z, theta + bias_theta, r + bias_r
//! theta       = atan2(y, x) in (-pi, pi],   r = sqrt(x^2 + y^2),   z = the long axis
//! ```
//! The bias is added after the activation, as in the lab's CPPN2sim and SoRoForge (2022).
//! A node without links is a constant: an empty sum is 0, an empty product 1.
//! A [`Network`] is checked when it is made and cannot be wrong afterwards.
//! The value is an implicit function and not a distance; the cavity is where it is below 0.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};
use std::str::FromStr;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::activation::Activation;
use super::network_draft::{NetworkDraft, NodeDraft};

/// A checked network, its nodes in an order in which they can be evaluated.
#[derive(Clone, Debug, PartialEq)]
pub struct Network {
    length_unit_mm: f64,
    input_biases: [f64; 5],
    nodes: Vec<Node>,
    output: usize,
    wall: WallNodes<usize>,
}

/// The nodes that say what the wall is made of, at a point of its middle: by name, or by index.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WallNodes<N> {
    /// Its thickness, mm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub thickness: Option<N>,
    /// It is of the second material where this is positive.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material: Option<N>,
}

impl<N> WallNodes<N> {
    /// Whether none says anything.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.thickness.is_none() && self.material.is_none()
    }

    /// The same nodes, each told by what `other` makes of it.
    pub fn map<M>(self, other: impl Fn(N) -> M) -> WallNodes<M> {
        let WallNodes { thickness, material } = self;
        WallNodes { thickness: thickness.map(&other), material: material.map(&other) }
    }
}

/// One node of a checked network.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// Unique in its network.
    pub name: String,
    /// The function applied to the aggregate.
    pub activation: Activation,
    /// How the weighted sources are joined.
    pub aggregation: Aggregation,
    /// Ordered by the source's name; a node without any is a constant.
    pub links: Vec<Link>,
    /// Added after the activation.
    pub bias: f64,
}

/// A weighted source of a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link {
    /// Where the number comes from.
    pub source: Source,
    /// What it is multiplied by.
    pub weight: f64,
}

/// Where a link starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// A coordinate of the point.
    Input(Coordinate),
    /// An earlier node, by its index in [`Network::nodes`].
    Node(usize),
}

/// How a node joins its weighted sources.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Aggregation {
    /// Their sum.
    #[default]
    Sum,
    /// Their product.
    Product,
}

/// An input of every network.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coordinate {
    /// Across.
    X,
    /// Across.
    Y,
    /// Along the actuator.
    Z,
    /// Angle around the z axis, radians in (-pi, pi].
    Theta,
    /// Distance from the z axis.
    R,
}

/// Why a text is not a network.
#[derive(Debug, thiserror::Error)]
pub enum NetworkError {
    /// Not TOML, or not the fields of a network.
    #[error("{0}")]
    Syntax(#[from] toml::de::Error),
    /// No node, so no value.
    #[error("the network has no [[node]]")]
    Empty,
    /// The length unit is not a length.
    #[error("length_unit_mm must be a positive number of mm, not {0}")]
    LengthUnit(f64),
    /// A name that a link or a file could not carry.
    #[error("node name {0:?} must be letters, digits, `_` or `-`")]
    Name(String),
    /// A node hides a coordinate.
    #[error("node name `{0}` is taken by a coordinate (x, y, z, theta, r)")]
    Reserved(String),
    /// Two nodes of one name.
    #[error("two nodes are named `{0}`")]
    Duplicate(String),
    /// A link from nowhere.
    #[error("node `{node}` links from `{from}`, which is neither a coordinate nor a node{hint}")]
    UnknownSource {
        /// The node with the link.
        node: String,
        /// The name that was not found.
        from: String,
        /// A near name, as a clause, or nothing.
        hint: String,
    },
    /// The output is not a node.
    #[error("output `{name}` is not a node{hint}")]
    UnknownOutput {
        /// The name that was not found.
        name: String,
        /// A near name, as a clause, or nothing.
        hint: String,
    },
    /// The output is left out, and the last node is one of the wall.
    #[error(
        "node `{0}`, the last one, is the output where none is named, but [wall] names it too; name the `output`"
    )]
    OutputOfWall(String),
    /// A node that depends on itself.
    #[error("the links form a cycle: {0}")]
    Cycle(String),
    /// NaN or an infinity.
    #[error("{place} is {value}; every number of a network must be finite")]
    NotFinite {
        /// What carries the number.
        place: String,
        /// The number.
        value: f64,
    },
}

impl Network {
    /// The length in mm of one unit of x, y, z and r.
    #[must_use]
    pub fn length_unit_mm(&self) -> f64 {
        self.length_unit_mm
    }

    /// What is added to x, y, z, theta, r (length units, radians).
    #[must_use]
    pub fn input_biases(&self) -> [f64; 5] {
        self.input_biases
    }

    /// The nodes; each comes after all nodes it links from.
    #[must_use]
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// The index of the node whose value is the field.
    #[must_use]
    pub fn output(&self) -> usize {
        self.output
    }

    /// The indices of the nodes that say what the wall is made of.
    #[must_use]
    pub fn wall(&self) -> WallNodes<usize> {
        self.wall
    }

    /// The text of the network file, which parses back to the same network.
    #[must_use]
    pub fn to_toml(&self) -> String {
        NetworkDraft::from(self).to_toml()
    }

    /// The same network, its nodes in this `order`.
    fn reordered(self, order: &[usize]) -> Self {
        let mut place = vec![0; order.len()];
        for (new, &old) in order.iter().enumerate() {
            place[old] = new;
        }
        let mut numbered: Vec<_> = self.nodes.into_iter().enumerate().collect();
        numbered.sort_by_key(|&(old, _)| place[old]);
        let mut nodes: Vec<_> = numbered.into_iter().map(|(_, node)| node).collect();
        for link in nodes.iter_mut().flat_map(|node| &mut node.links) {
            if let Source::Node(index) = &mut link.source {
                *index = place[*index];
            }
        }
        let (output, wall) = (place[self.output], self.wall.map(|node| place[node]));
        Self { nodes, output, wall, ..self }
    }
}

impl FromStr for Network {
    type Err = NetworkError;

    fn from_str(text: &str) -> Result<Self, NetworkError> {
        Self::try_from(toml::from_str::<NetworkDraft>(text)?)
    }
}

impl TryFrom<NetworkDraft> for Network {
    type Error = NetworkError;

    fn try_from(draft: NetworkDraft) -> Result<Self, NetworkError> {
        if !(draft.length_unit_mm.is_finite() && draft.length_unit_mm > 0.0) {
            return Err(NetworkError::LengthUnit(draft.length_unit_mm));
        }
        let inputs = draft.inputs;
        let input_biases = [inputs.x, inputs.y, inputs.z, inputs.theta, inputs.r];
        for (coordinate, bias) in Coordinate::ALL.iter().zip(input_biases) {
            check_finite(bias, || format!("the bias of input `{}`", coordinate.name()))?;
        }
        let indices = node_indices(&draft.nodes)?;
        let nodes = draft
            .nodes
            .iter()
            .map(|node| checked_node(node, &indices))
            .collect::<Result<Vec<_>, _>>()?;
        let named = |name: &String| {
            indices.get(name.as_str()).copied().ok_or_else(|| {
                let hint = hint(name, indices.keys().copied());
                NetworkError::UnknownOutput { name: name.clone(), hint }
            })
        };
        let wall = WallNodes {
            thickness: draft.wall.thickness.as_ref().map(named).transpose()?,
            material: draft.wall.material.as_ref().map(named).transpose()?,
        };
        let output = match &draft.output {
            Some(name) => named(name)?,
            None => {
                let last = nodes.len().checked_sub(1).ok_or(NetworkError::Empty)?;
                if [wall.thickness, wall.material].contains(&Some(last)) {
                    return Err(NetworkError::OutputOfWall(nodes[last].name.clone()));
                }
                last
            }
        };
        let order = evaluation_order(&nodes)?;
        let network =
            Self { length_unit_mm: draft.length_unit_mm, input_biases, nodes, output, wall };
        Ok(network.reordered(&order))
    }
}

impl Coordinate {
    /// All five, in the order of [`Network::input_biases`].
    pub const ALL: [Self; 5] = [Self::X, Self::Y, Self::Z, Self::Theta, Self::R];

    /// The name in a network file.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::X => "x",
            Self::Y => "y",
            Self::Z => "z",
            Self::Theta => "theta",
            Self::R => "r",
        }
    }

    fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|coordinate| coordinate.name() == name)
    }
}

fn node_indices(nodes: &[NodeDraft]) -> Result<BTreeMap<&str, usize>, NetworkError> {
    if nodes.is_empty() {
        return Err(NetworkError::Empty);
    }
    let mut indices = BTreeMap::new();
    for (index, node) in nodes.iter().enumerate() {
        let name = &node.name;
        let is_key = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
        if name.is_empty() || !name.chars().all(is_key) {
            return Err(NetworkError::Name(name.clone()));
        }
        if Coordinate::named(name).is_some() {
            return Err(NetworkError::Reserved(name.clone()));
        }
        if indices.insert(name.as_str(), index).is_some() {
            return Err(NetworkError::Duplicate(name.clone()));
        }
    }
    Ok(indices)
}

fn checked_node(node: &NodeDraft, indices: &BTreeMap<&str, usize>) -> Result<Node, NetworkError> {
    let name = &node.name;
    check_finite(node.bias, || format!("the bias of node `{name}`"))?;
    let mut links = Vec::with_capacity(node.links.len());
    for (from, &weight) in &node.links {
        check_finite(weight, || format!("the weight `{from}` of node `{name}`"))?;
        let source = match (Coordinate::named(from), indices.get(from.as_str())) {
            (Some(coordinate), _) => Source::Input(coordinate),
            (None, Some(&index)) => Source::Node(index),
            (None, None) => {
                let known = Coordinate::ALL.iter().map(|c| c.name()).chain(indices.keys().copied());
                let hint = hint(from, known);
                return Err(NetworkError::UnknownSource {
                    node: name.clone(),
                    from: from.clone(),
                    hint,
                });
            }
        };
        links.push(Link { source, weight });
    }
    Ok(Node {
        name: name.clone(),
        activation: node.activation,
        aggregation: node.aggregation,
        links,
        bias: node.bias,
    })
}

fn check_finite(value: f64, place: impl FnOnce() -> String) -> Result<(), NetworkError> {
    if value.is_finite() {
        return Ok(());
    }
    Err(NetworkError::NotFinite { place: place(), value })
}

/// `; did you mean ...?` for the nearest of the known names, if one is near.
fn hint<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> String {
    known
        .map(|other| (strsim::damerau_levenshtein(name, other), other))
        .min()
        .filter(|&(distance, _)| distance <= 2)
        .map_or_else(String::new, |(_, other)| format!("; did you mean `{other}`?"))
}

/// The topological order that departs least from the file's: always the earliest ready node (Kahn 1962).
fn evaluation_order(nodes: &[Node]) -> Result<Vec<usize>, NetworkError> {
    let mut waiting_for: Vec<usize> = nodes.iter().map(|n| node_sources(n).count()).collect();
    let mut followers = vec![Vec::new(); nodes.len()];
    for (index, node) in nodes.iter().enumerate() {
        node_sources(node).for_each(|source| followers[source].push(index));
    }
    let mut ready: BinaryHeap<_> =
        (0..nodes.len()).filter(|&i| waiting_for[i] == 0).map(Reverse).collect();
    let mut order = Vec::with_capacity(nodes.len());
    while let Some(Reverse(index)) = ready.pop() {
        order.push(index);
        for &follower in &followers[index] {
            waiting_for[follower] -= 1;
            if waiting_for[follower] == 0 {
                ready.push(Reverse(follower));
            }
        }
    }
    if order.len() == nodes.len() { Ok(order) } else { Err(cycle(nodes, &waiting_for)) }
}

/// Names one cycle: every waiting node waits for another one, so walking back must come around.
fn cycle(nodes: &[Node], waiting_for: &[usize]) -> NetworkError {
    let waits = |index: &usize| waiting_for[*index] > 0;
    let mut index = (0..nodes.len()).find(waits).expect("a node outside the order waits");
    let mut walk = Vec::new();
    while !walk.contains(&index) {
        walk.push(index);
        index = node_sources(&nodes[index]).find(waits).expect("it waits for a waiting node");
    }
    walk.push(index);
    let start = walk.iter().position(|&i| i == index).expect("the walk came back to it");
    let names: Vec<_> = walk[start..].iter().rev().map(|&i| nodes[i].name.as_str()).collect();
    NetworkError::Cycle(names.join(" -> "))
}

fn node_sources(node: &Node) -> impl Iterator<Item = usize> + '_ {
    node.links.iter().filter_map(|link| match link.source {
        Source::Node(index) => Some(index),
        Source::Input(_) => None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHUFFLED: &str = r#"
        output = "sum"
        [[node]]
        name = "unused"
        links = { b = 1, theta = 2 }
        [[node]]
        name = "sum"
        links = { a = 1.5, b = -2 }
        bias = 0.25
        [[node]]
        name = "b"
        activation = "cosine"
        links = { a = 1, z = 3 }
        [[node]]
        name = "a"
        activation = "squared"
        aggregation = "product"
        links = { x = 1, r = 0.1 }
    "#;

    #[test]
    fn nodes_are_ordered_by_dependence_then_by_place_in_the_file() {
        let network: Network = SHUFFLED.parse().unwrap();
        let names: Vec<_> = network.nodes().iter().map(|n| n.name.as_str()).collect();
        assert_eq!(names, ["a", "b", "unused", "sum"]);
        assert_eq!(network.output(), 3);
        let sources: Vec<_> = network.nodes()[3].links.iter().map(|l| l.source).collect();
        assert_eq!(sources, [Source::Node(0), Source::Node(1)]);
        assert_eq!(network.length_unit_mm(), 10.0);
    }

    #[test]
    fn writing_and_reading_gives_the_same_network() {
        let network: Network = SHUFFLED.parse().unwrap();
        let again: Network = network.to_toml().parse().unwrap();
        assert_eq!(again, network);
        assert_eq!(again.to_toml(), network.to_toml());
    }

    /// Nodes of the wall are found in the new order, written and read; a name that is no node is told.
    #[test]
    fn the_wall_has_nodes_of_its_own() {
        let with =
            |wall: &str| SHUFFLED.replacen("[[node]]", &format!("[wall]\n{wall}\n[[node]]"), 1);
        let network: Network = with("thickness = \"a\"\nmaterial = \"b\"").parse().unwrap();
        assert_eq!(network.wall(), WallNodes { thickness: Some(0), material: Some(1) });
        assert_eq!(network.to_toml().parse::<Network>().unwrap(), network);
        let error = with("thickness = \"bb\"").parse::<Network>().unwrap_err().to_string();
        assert_eq!(error, "output `bb` is not a node; did you mean `b`?");
    }

    #[test]
    fn the_last_node_is_the_output_if_none_is_named() {
        let text = SHUFFLED.replace("output = \"sum\"", "");
        let network: Network = text.parse().unwrap();
        assert_eq!(network.nodes()[network.output()].name, "a");
    }

    #[test]
    fn each_fault_is_named_in_one_line() {
        let node = |name: &str, links: &str| format!("[[node]]\nname='{name}'\nlinks={links}\n");
        let cases = [
            (String::new(), "the network has no [[node]]"),
            (node("a", "{ b = 1 }") + &node("b", "{ a = 1 }"), "cycle: a -> b -> a"),
            (node("a", "{ a = 1 }"), "cycle: a -> a"),
            (node("a", "{ x = 1 }") + &node("a", "{ y = 1 }"), "two nodes are named `a`"),
            (node("a", "{ x = nan }"), "the weight `x` of node `a` is NaN"),
            (node("a", "{ x = 1 }") + "bias = inf", "the bias of node `a` is inf"),
            (
                node("a", "{ teta = 1 }"),
                "links from `teta`, which is neither a coordinate nor a node; did you mean `theta`?",
            ),
            (node("a", "{ nothing = 1 }"), "which is neither a coordinate nor a node"),
            (node("theta", "{ x = 1 }"), "node name `theta` is taken by a coordinate"),
            (node("a b", "{ x = 1 }"), "node name \"a b\" must be letters"),
            (
                "output = 'b'\n".to_owned() + &node("a", "{ x = 1 }"),
                "output `b` is not a node; did you mean `a`?",
            ),
            (
                "[wall]\nmaterial = 'b'\n".to_owned()
                    + &node("a", "{ x = 1 }")
                    + &node("b", "{ y = 1 }"),
                "node `b`, the last one, is the output where none is named, but [wall] names it too",
            ),
            (
                "length_unit_mm = 0\n".to_owned() + &node("a", "{ x = 1 }"),
                "length_unit_mm must be a positive number of mm, not 0",
            ),
            (
                "[inputs]\nz = -inf\n".to_owned() + &node("a", "{ x = 1 }"),
                "the bias of input `z` is -inf",
            ),
        ];
        for (text, expected) in cases {
            let message = text.parse::<Network>().unwrap_err().to_string();
            assert!(message.contains(expected), "{message:?} should contain {expected:?}");
            assert_eq!(message.lines().count(), 1, "{message:?}");
        }
    }

    #[test]
    fn unknown_fields_are_refused_by_name() {
        let text = "[[node]]\nname = 'a'\nlinks = { x = 1 }\nbais = 1\n";
        let message = text.parse::<Network>().unwrap_err().to_string();
        assert!(message.contains("bais") && message.contains("line 4"), "{message}");
    }
}
