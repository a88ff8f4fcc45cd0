//! Where a model's wall meets itself: watched, so that a path knows where its model ends, or kept apart by barriers.

use super::contact::SelfContactSettings;
use super::contact::self_contact::Frame;
use super::part_model::PartModel;
use super::system::{Limit, LimitKind};

impl PartModel {
    /// Keeps the folds of the wall apart by barriers from now on.
    pub fn keep_folds_apart(&mut self, settings: SelfContactSettings) {
        let frame = Frame { ties: &self.ties, reference: &self.reference };
        self.folds.keep_apart(&self.surface, settings, frame);
        self.fold_slots = None;
    }

    /// Whether a touch of the wall with itself is a limit that was passed, where it is not kept apart; so it is for closed
    /// parts unless told otherwise.
    pub fn watch_folds(&mut self, is_watched: bool) {
        self.folds.is_watched = is_watched;
    }

    /// The smallest gap at displacement `u` between faces of the wall that are no neighbours, mm; infinite where none is
    /// below half the thickness, negative where they overlap.
    ///
    /// Where parts are so near at rest that they would all but touch, the wall counts as a tenth thinner than their distance.
    #[must_use]
    pub fn smallest_wall_gap(&self, u: &[f64]) -> f64 {
        let frame = Frame { ties: &self.ties, reference: &self.reference };
        let gap = self.folds.smallest_gap(&self.displaced(u), &self.surface, frame);
        gap.map_or(f64::INFINITY, |(gap, _)| gap)
    }

    /// The force with which the wall presses on itself at displacement `u`, N; 0 where that is not modelled.
    #[must_use]
    pub fn self_contact_force(&self, u: &[f64]) -> f64 {
        self.folds.contact.as_ref().map_or(0.0, |contact| contact.force(&self.displaced(u)))
    }

    /// Whether the wall's own contact is modelled.
    #[must_use]
    pub fn keeps_folds_apart(&self) -> bool {
        self.folds.contact.is_some()
    }

    /// Brings the list of near pairs up to the displacement `u`.
    pub(super) fn list_folds(&mut self, u: &[f64]) {
        if self.folds.contact.is_none() {
            return;
        }
        let positions = self.displaced(u);
        let frame = Frame { ties: &self.ties, reference: &self.reference };
        if let Some(contact) = &mut self.folds.contact
            && contact.list(&positions, frame)
        {
            self.fold_slots = None;
        }
    }

    /// Makes room in the pattern for folds that are near at `u`; whether it had to.
    pub(super) fn make_room_for_folds(&mut self, u: &[f64]) -> bool {
        self.list_folds(u);
        let frame = Frame { ties: &self.ties, reference: &self.reference };
        let contact = self.folds.contact.as_mut();
        let room = contact.and_then(|contact| contact.make_room(frame));
        room.map(|room| self.plan(&room)).is_some()
    }

    /// The largest part of `du` that keeps all folds apart, at most 1.
    pub(super) fn longest_step_of_folds(&self, u: &[f64], du: &[f64]) -> f64 {
        let Some(contact) = &self.folds.contact else { return 1.0 };
        contact.longest_step(&self.displaced(u), &self.displacements(du))
    }

    /// Where the wall touches itself at `u` and nothing keeps it apart, if that is watched.
    pub(super) fn self_touch(&self, u: &[f64]) -> Option<Limit> {
        if !self.folds.is_watched || self.folds.contact.is_some() {
            return None;
        }
        let frame = Frame { ties: &self.ties, reference: &self.reference };
        let node = self.folds.touch(&self.displaced(u), &self.surface, frame)?;
        Some(Limit { kind: LimitKind::SelfTouch, unknown: 3 * node as usize })
    }
}
