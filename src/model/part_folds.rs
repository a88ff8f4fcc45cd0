//! How near the folds of a model's wall are to each other, and how they press.

use super::contact::self_contact::WallContact;
use super::part_model::PartModel;

impl PartModel {
    /// The smallest gap at displacement `u` between faces of the wall that are no neighbours, mm; infinite where none is
    /// below half the thickness, negative where they overlap.
    ///
    /// Where parts are so near at rest that they would all but touch, the wall counts as a tenth thinner than their distance.
    #[must_use]
    pub fn smallest_wall_gap(&self, u: &[f64]) -> f64 {
        self.fold_watch.smallest_gap(&self.body.at(u)).unwrap_or(f64::INFINITY)
    }

    /// The force with which the wall presses on itself at displacement `u`, N; 0 where that is not modelled.
    #[must_use]
    pub fn self_contact_force(&self, u: &[f64]) -> f64 {
        let at = self.body.at(u);
        self.each::<WallContact>().fold(0.0, |sum, contact| sum + contact.force(at.positions()))
    }

    /// Whether the wall's own contact is modelled.
    #[must_use]
    pub fn keeps_folds_apart(&self) -> bool {
        self.each::<WallContact>().next().is_some()
    }
}
