//! The folds of a model's wall: they touch unseen, or are watched, or keep each other off.

use std::sync::{Arc, OnceLock};

use super::SelfContactSettings;
use super::wall_contact::{Frame, WallContact};
use super::wall_surface::{Search, WallSurface};
use crate::math::Vec3;
use crate::model::element::{ElementPoints, SampledSurface};

/// What a model knows of its folds. Nothing is made of the surface until it is asked for.
#[derive(Clone, Debug)]
pub(in crate::model) struct Folds {
    points: Vec<ElementPoints>,
    /// mm.
    pub(in crate::model) thickness: f64,
    surface: OnceLock<Arc<WallSurface>>,
    /// Whether a touch ends the model's validity, where there is no contact.
    pub(in crate::model) is_watched: bool,
    /// The barriers, where contact is modelled.
    pub(in crate::model) contact: Option<WallContact>,
}

/// How far apart parts may be that count as near, in thicknesses between their faces.
const NEAR: f64 = 0.5;

impl Folds {
    /// Of a wall with the triangles' `points`.
    pub(in crate::model) fn new(points: Vec<ElementPoints>, thickness: f64) -> Self {
        let surface = OnceLock::new();
        Self { points, thickness, surface, is_watched: false, contact: None }
    }

    /// Puts barriers between the folds of a wall with this `surface`.
    pub(in crate::model) fn keep_apart(
        &mut self,
        surface: &SampledSurface,
        settings: SelfContactSettings,
        frame: Frame<'_>,
    ) {
        let surface = self.surface(surface, frame).clone();
        self.contact = Some(WallContact::new(surface, settings, frame));
    }

    /// The smallest gap between faces that are no neighbours where the nodes are at `positions`, mm, and a node beside it;
    /// none where there is none below half the thickness.
    pub(in crate::model) fn smallest_gap(
        &self,
        positions: &[Vec3],
        surface: &SampledSurface,
        frame: Frame<'_>,
    ) -> Option<(f64, u32)> {
        let near = NEAR * self.thickness;
        let search = Search::within(self.thickness + near);
        self.smallest_gap_below(near, search, positions, surface, frame)
    }

    /// A node where faces that are no neighbours touch.
    pub(in crate::model) fn touch(
        &self,
        positions: &[Vec3],
        surface: &SampledSurface,
        frame: Frame<'_>,
    ) -> Option<u32> {
        let search = Search::for_touch(self.thickness);
        self.smallest_gap_below(0.0, search, positions, surface, frame).map(|(_, node)| node)
    }

    fn smallest_gap_below(
        &self,
        largest: f64,
        search: Search,
        positions: &[Vec3],
        surface: &SampledSurface,
        frame: Frame<'_>,
    ) -> Option<(f64, u32)> {
        let wall = self.surface(surface, frame);
        let pose = wall.pose(positions, None);
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

    fn surface(&self, surface: &SampledSurface, frame: Frame<'_>) -> &Arc<WallSurface> {
        self.surface.get_or_init(|| {
            let wall = WallSurface::new(&self.points, surface, frame.reference, self.thickness);
            Arc::new(wall)
        })
    }
}
