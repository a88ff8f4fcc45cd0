//! The terms of a plane in the list of a part.

use super::{Friction, PlaneContact, PlaneSettings, Samples};
use crate::model::body::Body;
use crate::model::part_term::Placed;

/// Where the terms of a plane stand among those of a part.
#[derive(Clone, Copy, Debug)]
pub(in crate::model) struct PlaneTerms {
    pub(super) contact: usize,
    pub(super) friction: Option<usize>,
}

impl PlaneTerms {
    /// Adds the terms of the plane of `settings` before the wall of `body`, whose samples lie as `lie` says.
    pub(in crate::model) fn add(
        settings: &PlaneSettings,
        lie: Samples,
        body: &Body,
        terms: &mut Vec<Placed>,
    ) -> Self {
        let place = terms.len();
        let contact = PlaneContact::new(&body.surface, &body.reference, lie, settings);
        let thinnest = body.surface.thickness.iter().copied().fold(f64::INFINITY, f64::min);
        let friction = (settings.friction > 0.0).then(|| {
            let slip = settings.elastic_slip * thinnest;
            Friction::new(contact.clone(), &body.reference, settings.friction, slip)
        });
        terms.push(Placed::new(contact, body));
        let is_rough = friction.is_some();
        terms.extend(friction.map(|friction| Placed::new(friction, body)));
        Self { contact: place, friction: is_rough.then_some(place + 1) }
    }
}
