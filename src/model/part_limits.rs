//! How much of what its materials may bear a part uses, and where.

use super::discretization::Wall;
use super::element::PeakState;
use super::local::Term;
use super::material_limits::{MaterialLimits, UsedLimit};
use super::part_model::PartModel;
use crate::math::Vec3;

impl PartModel {
    /// The limit of which most is used at the unknowns `u`, and where; none where no limit is set, or an element has collapsed.
    #[must_use]
    pub fn used_limit(&self, u: &[f64]) -> Option<UsedLimit> {
        if self.limits.iter().all(|limits| *limits == MaterialLimits::default()) {
            return None;
        }
        let wall = self.wall();
        let reference = &self.body.reference;
        let states = match wall {
            Wall::Solid(body) => body.peaks(&self.body.untied(u)),
            Wall::Loop(shell) => shell.peaks(reference, &self.body.displaced(u)).ok()?,
            Wall::MidEdge(shell) => shell.peaks(reference, &self.body.displaced(u)).ok()?,
        };
        let used = |state: &PeakState| {
            let limits = self.limits.get(usize::from(state.material))?;
            limits.used_by(state).map(|used| (used, *state))
        };
        let most = states.iter().filter_map(used).max_by(|a, b| a.0.2.total_cmp(&b.0.2))?;
        let ((quantity, [allowed, value], share), state) = most;
        let (at_rest, node) = if matches!(wall, Wall::Solid(_)) {
            let nodes = &wall.stencils()[state.place][..NODES];
            let middle = nodes.iter().map(|&v| reference[v as usize]).sum::<Vec3>();
            (middle / NODES as f64, nodes[0])
        } else {
            // The last facet of each triangle stands between the midpoints of its edges.
            let facets = self.body.surface.facets.as_chunks::<4>().0;
            let samples = facets[state.place][3].map(|k| &self.body.surface.samples[k as usize]);
            let middle = samples.iter().map(|sample| sample.point(reference)).sum::<Vec3>();
            (middle / 3.0, samples[0].heaviest())
        };
        let material = usize::from(state.material);
        Some(UsedLimit {
            quantity,
            allowed,
            value,
            share,
            material,
            face: state.face,
            at_rest,
            node,
        })
    }
}

/// Of a quadratic tetrahedron; its stencil has pressures behind them.
const NODES: usize = 10;
