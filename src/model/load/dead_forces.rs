//! Forces on the unknowns that are the same in every state: `E = -f . u`.

use crate::math::Vec3;
use crate::model::body::Configuration;
use crate::model::part_term::{PartTerm, without_stencils};
use crate::model::tie::Ties;

/// Dead forces on nodes, as a term without stencils: they are linear in the unknowns.
#[derive(Clone, Debug)]
pub(in crate::model) struct DeadForces {
    /// Share of them that is applied.
    pub load_factor: f64,
    /// Whether they grow with the load; a weight is there from the start.
    is_load: bool,
    /// On the unknowns of each node, N.
    on_unknowns: Vec<Vec3>,
    /// On each displaced node, N.
    on_nodes: Vec<Vec3>,
}

impl DeadForces {
    /// The forces `on_nodes` (N), one for each, of nodes tied by `ties`.
    #[must_use]
    pub(in crate::model) fn new(on_nodes: Vec<Vec3>, ties: &Ties) -> Self {
        let mut on_unknowns = on_nodes.clone();
        ties.reduce(&mut on_unknowns);
        Self { load_factor: 0.0, is_load: true, on_unknowns, on_nodes }
    }

    /// Forces that act whole, whatever the load.
    #[must_use]
    pub(in crate::model) fn weight(on_nodes: Vec<Vec3>, ties: &Ties) -> Self {
        Self { load_factor: 1.0, is_load: false, ..Self::new(on_nodes, ties) }
    }

    /// Whether they grow with the load.
    #[must_use]
    pub(in crate::model) fn is_load(&self) -> bool {
        self.is_load
    }

    /// The whole forces on the unknowns of each node, N.
    #[must_use]
    pub(in crate::model) fn on_unknowns(&self) -> &[Vec3] {
        &self.on_unknowns
    }

    /// The whole forces on the unknowns of each node, N.
    #[cfg(test)]
    pub(in crate::model) fn on_unknowns_mut(&mut self) -> &mut [Vec3] {
        &mut self.on_unknowns
    }

    /// The whole forces on each displaced node, N.
    #[must_use]
    pub(in crate::model) fn on_nodes(&self) -> &[Vec3] {
        &self.on_nodes
    }

    /// The work of the whole forces on the unknowns `u`, mJ.
    fn work(&self, u: &[f64]) -> f64 {
        self.on_unknowns.iter().zip(u.as_chunks().0).map(|(f, &u)| f.dot(&Vec3::from(u))).sum()
    }
}

without_stencils!(DeadForces);

impl PartTerm for DeadForces {
    fn boxed(&self) -> Box<dyn PartTerm> {
        Box::new(self.clone())
    }

    fn set_load(&mut self, load: f64) {
        if self.is_load {
            self.load_factor = load;
        }
    }

    fn whole_energy(&self, at: &Configuration<'_>) -> Option<f64> {
        Some(-self.load_factor * self.work(at.unknowns))
    }

    fn conjugate(&self, at: &Configuration<'_>) -> f64 {
        if self.is_load { self.work(at.unknowns) } else { 0.0 }
    }
}
