//! A network as a flat list of instructions: what is evaluated a million times per design.
//!
//! Slots 0..5 hold x, y, z, theta, r with their biases; instruction `i` writes slot `5 + i`.
//! Nodes that do not reach the output are dropped. Nodes that do not depend on z come first,
//! so that a line of points along z evaluates them once. The last instruction is the output.

use crate::genome::{Activation, Aggregation, Coordinate, Network, Node, Source};

use super::quantity::Quantity;

/// A network ready to be evaluated in mm; a [`super::ScalarField`].
///
/// Where the network is singular the field is still finite:
/// - on the half-plane `y = 0, x < 0` theta jumps by 2 pi; the field jumps there unless every
///   weight on theta is a whole number inside a sine or cosine. The gradient is one-sided.
/// - towards the axis `r = 0` the dependence on theta fades to its mean (see `evaluate`); on the axis the
///   derivatives of theta and r count as 0.
/// - a value or derivative that overflows is replaced (value by +-1e30, not-a-number by +1e30,
///   which is outside; derivative by 0).
#[derive(Clone, Debug, PartialEq)]
pub struct CompiledNetwork {
    pub(super) length_unit_mm: f64,
    pub(super) input_biases: [f64; 5],
    pub(super) uses_theta: bool,
    instructions: Vec<Instruction>,
    /// Slot and weight.
    links: Vec<(usize, f64)>,
    /// How many of the first instructions do not depend on z.
    z_free: usize,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Instruction {
    first_link: usize,
    link_end: usize,
    aggregation: Aggregation,
    activation: Activation,
    bias: f64,
}

impl CompiledNetwork {
    /// The instructions for the field of `network`.
    #[must_use]
    pub fn new(network: &Network) -> Self {
        Self::of_node(network, network.output())
    }

    /// The instructions for the value of one node of `network`.
    ///
    /// # Panics
    /// When it has no such node.
    #[must_use]
    pub fn of_node(network: &Network, output: usize) -> Self {
        let nodes = network.nodes();
        let live = live_nodes(nodes, output);
        let on_z = depends_on(nodes, Coordinate::Z);
        let on_theta = depends_on(nodes, Coordinate::Theta);
        let (late, early): (Vec<_>, Vec<_>) =
            (0..nodes.len()).filter(|&i| live[i]).partition(|&i| on_z[i]);
        let mut compiled = Self {
            length_unit_mm: network.length_unit_mm(),
            input_biases: network.input_biases(),
            uses_theta: on_theta[output],
            instructions: Vec::new(),
            links: Vec::new(),
            z_free: early.len(),
        };
        let mut slots = vec![usize::MAX; nodes.len()];
        for index in early.into_iter().chain(late) {
            slots[index] = INPUTS + compiled.instructions.len();
            compiled.push(&nodes[index], &slots);
        }
        compiled
    }

    fn push(&mut self, node: &Node, slots: &[usize]) {
        let first_link = self.links.len();
        let slot = |source| match source {
            Source::Input(coordinate) => coordinate as usize,
            Source::Node(index) => slots[index],
        };
        self.links.extend(node.links.iter().map(|link| (slot(link.source), link.weight)));
        self.instructions.push(Instruction {
            first_link,
            link_end: self.links.len(),
            aggregation: node.aggregation,
            activation: node.activation,
            bias: node.bias,
        });
    }

    /// Inputs and instructions together.
    pub(super) fn slot_count(&self) -> usize {
        INPUTS + self.instructions.len()
    }

    /// Fills the slots that depend on x and y alone.
    pub(super) fn run_z_free<Q: Quantity>(&self, slots: &mut [Q]) {
        self.run(0, self.z_free, slots);
    }

    /// Fills the other slots; returns the field.
    pub(super) fn run_z_bound<Q: Quantity>(&self, slots: &mut [Q]) -> Q {
        self.run(self.z_free, self.instructions.len(), slots);
        slots[self.slot_count() - 1]
    }

    #[inline]
    fn run<Q: Quantity>(&self, from: usize, to: usize, slots: &mut [Q]) {
        for (i, step) in self.instructions[from..to].iter().enumerate() {
            let links = &self.links[step.first_link..step.link_end];
            let mut weighted = links.iter().map(|&(slot, weight)| slots[slot].scaled(weight));
            let total = match (weighted.next(), step.aggregation) {
                (Some(first), Aggregation::Sum) => weighted.fold(first, Q::plus),
                (Some(first), Aggregation::Product) => weighted.fold(first, Q::times),
                (None, Aggregation::Sum) => Q::constant(0.0),
                (None, Aggregation::Product) => Q::constant(1.0),
            };
            slots[INPUTS + from + i] = total.activated(step.activation).shifted(step.bias);
        }
    }
}

/// Whether each node reaches the output.
fn live_nodes(nodes: &[Node], output: usize) -> Vec<bool> {
    let mut live = vec![false; nodes.len()];
    live[output] = true;
    for index in (0..nodes.len()).rev().filter(|&i| i <= output) {
        if live[index] {
            for link in &nodes[index].links {
                if let Source::Node(source) = link.source {
                    live[source] = true;
                }
            }
        }
    }
    live
}

/// Whether each node depends on `coordinate`.
fn depends_on(nodes: &[Node], coordinate: Coordinate) -> Vec<bool> {
    let mut depends = vec![false; nodes.len()];
    for (index, node) in nodes.iter().enumerate() {
        depends[index] = node.links.iter().any(|link| match link.source {
            Source::Input(input) => input == coordinate,
            Source::Node(source) => depends[source],
        });
    }
    depends
}

pub(super) const INPUTS: usize = Coordinate::ALL.len();
