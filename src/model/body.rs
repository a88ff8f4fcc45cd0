//! The nodes of a part, what follows from its unknowns, and the state that its terms are asked about.

use std::cell::OnceCell;

use super::element::SampledSurface;
use super::tie::Ties;
use crate::math::Vec3;

/// The nodes of a part at rest, which of them follow others, and the surface over them.
#[derive(Clone, Debug)]
pub(super) struct Body {
    /// Nodes at rest, mm.
    pub(super) reference: Vec<Vec3>,
    pub(super) ties: Ties,
    /// What carries pressure and contact.
    pub(super) surface: SampledSurface,
}

impl Body {
    /// The configuration with the unknowns `u`.
    pub(super) fn at<'a>(&'a self, u: &'a [f64]) -> Configuration<'a> {
        let [displacements, positions, samples] = [(); 3].map(|()| OnceCell::new());
        Configuration { body: self, unknowns: u, displacements, positions, samples }
    }

    /// Displacements of all nodes, mm.
    pub(super) fn displacements(&self, u: &[f64]) -> Vec<Vec3> {
        let (places, _) = u.split_at(3 * self.reference.len());
        let mut u: Vec<Vec3> = places.as_chunks().0.iter().map(|&u: &[f64; 3]| u.into()).collect();
        self.ties.displace(&mut u);
        u
    }

    /// Positions of all nodes, mm.
    pub(super) fn displaced(&self, u: &[f64]) -> Vec<Vec3> {
        let mut x = self.displacements(u);
        x.iter_mut().zip(&self.reference).for_each(|(x, reference)| *x += reference);
        x
    }

    /// Positions as tied terms take them: at rest, plus the unknowns; then the pressures.
    pub(super) fn untied(&self, u: &[f64]) -> Vec<Vec3> {
        let (places, pressures) = u.split_at(3 * self.reference.len());
        let places = self.reference.iter().zip(places.as_chunks().0);
        let places = places.map(|(x, &u)| x + Vec3::from(u));
        places.chain(pressures.iter().map(|&q| Vec3::new(q, 0.0, 0.0))).collect()
    }
}

/// A state of a part; what nobody asks for is not computed.
pub(super) struct Configuration<'a> {
    pub(super) body: &'a Body,
    /// `[n]`; of an increment its entries.
    pub(super) unknowns: &'a [f64],
    displacements: OnceCell<Vec<Vec3>>,
    positions: OnceCell<Vec<Vec3>>,
    samples: OnceCell<Vec<Vec3>>,
}

impl Configuration<'_> {
    /// Displacements of all nodes, ties included, mm.
    pub(super) fn displacements(&self) -> &[Vec3] {
        self.displacements.get_or_init(|| self.body.displacements(self.unknowns))
    }

    /// Positions of all nodes, ties included, mm.
    pub(super) fn positions(&self) -> &[Vec3] {
        self.positions.get_or_init(|| self.body.displaced(self.unknowns))
    }

    /// Positions of the surface's samples, mm.
    pub(super) fn samples(&self) -> &[Vec3] {
        self.samples.get_or_init(|| self.body.surface.at(self.positions()))
    }
}
