//! The folds of a wall: how near they are, and a bound of the model's validity where they touch.

use std::sync::{Arc, OnceLock};

use super::wall_surface::{Search, WallSurface};
use crate::model::body::{Body, Configuration};
use crate::model::element::ElementPoints;
use crate::model::part_term::{PartTerm, without_stencils};
use crate::model::system::{Limit, LimitKind};

/// What a model knows of its folds; as a term, their touch is a limit that was passed.
///
/// Nothing is made of the surface until it is asked for, and copies share it.
#[derive(Clone, Debug)]
pub(in crate::model) struct FoldWatch {
    points: Arc<[ElementPoints]>,
    surface: Arc<OnceLock<Arc<WallSurface>>>,
}

/// How far apart parts may be that count as near, in thicknesses between their faces.
const NEAR: f64 = 0.5;

impl FoldWatch {
    /// Of a wall with the triangles' `points`.
    pub(in crate::model) fn new(points: Vec<ElementPoints>) -> Self {
        Self { points: points.into(), surface: Arc::default() }
    }

    /// The surface of the wall of `body`.
    pub(super) fn surface(&self, body: &Body) -> Arc<WallSurface> {
        let made = || WallSurface::new(&self.points, &body.surface, &body.reference).into();
        self.surface.get_or_init(made).clone()
    }

    /// The smallest gap between faces that are no neighbours, mm; `None` if none is below half the greatest thickness.
    pub(in crate::model) fn smallest_gap(&self, at: &Configuration<'_>) -> Option<f64> {
        let thickest = at.body.surface.thickest();
        let near = NEAR * thickest;
        let search = Search::within(thickest + near);
        self.smallest_gap_below(near, search, at).map(|(gap, _)| gap)
    }

    /// The smallest gap below `largest`, mm, and a node beside it.
    fn smallest_gap_below(
        &self,
        largest: f64,
        search: Search,
        at: &Configuration<'_>,
    ) -> Option<(f64, u32)> {
        let wall = self.surface(at.body);
        let pose = wall.pose(at.positions(), None);
        let mut smallest = (largest, None);
        wall.visit_near(&pose, search, &mut |_, couple| {
            let [thickness, _] = wall.thickness_of(&couple);
            let gap = couple.closest(&pose.samples).distance - thickness;
            if gap < smallest.0 {
                smallest = (gap, Some(couple.samples[0]));
            }
        });
        let (gap, sample) = smallest;
        sample.map(|sample| (gap, wall.node_of(sample)))
    }
}

without_stencils!(FoldWatch);

impl PartTerm for FoldWatch {
    fn boxed(&self) -> Box<dyn PartTerm> {
        Box::new(self.clone())
    }

    fn passed_limit(&self, at: &Configuration<'_>) -> Option<Limit> {
        let search = Search::for_touch(at.body.surface.thickest());
        let (_, node) = self.smallest_gap_below(0.0, search, at)?;
        Some(Limit { kind: LimitKind::SelfTouch, unknown: 3 * node as usize })
    }
}
