//! What a path asks of a term, and a term in its place among others.
//!
//! A part is a list of placed terms: its wall, its loads, what it touches, and the bounds of its validity. Each loop over the list
//! is written once, in [`super::PartModel`]; a term overrides the hooks that concern it.

use std::any::Any;
use std::fmt::Debug;

use super::assembly::{Assembler, Slots};
use super::body::{Body, Configuration};
use super::local::{LocalDerivatives, Term};
use super::system::{Inadmissible, Limit};
use super::tie::Tied;
use crate::math::Vec3;

/// A term of a part, with the hooks that a path calls.
pub(super) trait PartTerm: Term + Any + Debug + Send + Sync {
    /// A copy of it.
    fn boxed(&self) -> Box<dyn PartTerm>;

    /// Whether a stencil may reach beyond those of the wall's elements.
    fn widens_pattern(&self) -> bool {
        true
    }

    /// Takes the load of the path.
    fn set_load(&mut self, load: f64) {
        let _ = load;
    }

    /// Whether nothing is to be evaluated.
    fn is_idle(&self) -> bool {
        false
    }

    /// Its energy, mJ, where that is not the sum over its stencils.
    fn whole_energy(&self, at: &Configuration<'_>) -> Option<f64> {
        let _ = at;
        None
    }

    /// On what a load of 1 works, mJ; 0 of a term that is no load.
    fn conjugate(&self, at: &Configuration<'_>) -> f64 {
        let _ = at;
        0.0
    }

    /// Adds the forces of a load of 1 to `direction`, one vector for each node, N.
    fn add_load_direction(&self, at: &Configuration<'_>, direction: &mut [Vec3]) {
        let _ = (at, direction);
    }

    /// Whether its gradient is that of an energy.
    fn has_potential(&self) -> bool {
        true
    }

    /// Adds the skew part of the derivative of its gradient times `v`, both one vector for each node, to `out`, N.
    fn add_circulation(&self, at: &Configuration<'_>, v: &[Vec3], out: &mut [Vec3]) {
        let _ = (at, v, out);
    }

    /// The largest part of the increment `step`, at most 1, that crosses no contact.
    fn longest_step(&self, from: &Configuration<'_>, step: &Configuration<'_>) -> f64 {
        let _ = (from, step);
        1.0
    }

    /// Brings its stencils up to a state that is to be evaluated; returns whether they changed.
    fn prepare(&mut self, at: &Configuration<'_>) -> bool {
        let _ = at;
        false
    }

    /// Stencils for which the pattern is to have room from now on, if they changed.
    fn room(&mut self) -> Option<Vec<Vec<u32>>> {
        None
    }

    /// Told of every accepted equilibrium; returns the energy given off as heat since the last, mJ.
    fn settle(&mut self, at: &Configuration<'_>) -> f64 {
        let _ = at;
        0.0
    }

    /// What it remembers of the accepted equilibrium at hand.
    fn memory(&self) -> Vec<f64> {
        Vec::new()
    }

    /// Goes back to an accepted equilibrium and what it remembered there; where that is nothing, it begins to remember there.
    fn recall(&mut self, at: &Configuration<'_>, memory: &[f64]) {
        let _ = memory;
        self.settle(at);
    }

    /// Brings what is constant during a solve up to an equilibrium; returns by which share it changed.
    fn refresh(&mut self, at: &Configuration<'_>) -> f64 {
        let _ = at;
        0.0
    }

    /// Takes back what was refreshed since the last accepted equilibrium.
    fn rewind(&mut self) {}

    /// Forgets what it remembers, because it is taken away or put back.
    fn release(&mut self) {}

    /// Whether it gives off heat without a snap.
    fn dissipates(&self) -> bool {
        false
    }

    /// Whether supports bear what it does to the nodes that they hold.
    fn acts_on_supports(&self) -> bool {
        true
    }

    /// The bound of the model's validity that was passed.
    fn passed_limit(&self, at: &Configuration<'_>) -> Option<Limit> {
        let _ = at;
        None
    }
}

impl Term for Box<dyn PartTerm> {
    fn stencils(&self) -> &[Vec<u32>] {
        (**self).stencils()
    }

    fn is_active(&self, s: usize, positions: &[Vec3]) -> bool {
        (**self).is_active(s, positions)
    }

    fn energy(&self, s: usize, x: &[Vec3]) -> Result<f64, Inadmissible> {
        (**self).energy(s, x)
    }

    fn derivatives(
        &self,
        s: usize,
        x: &[Vec3],
        local: &mut LocalDerivatives,
    ) -> Result<f64, Inadmissible> {
        (**self).derivatives(s, x, local)
    }
}

impl Clone for Box<dyn PartTerm> {
    fn clone(&self) -> Self {
        (**self).boxed()
    }
}

/// Makes a term of a type that acts by its hooks alone.
macro_rules! without_stencils {
    ($term:ty) => {
        impl $crate::model::local::Term for $term {
            fn stencils(&self) -> &[Vec<u32>] {
                &[]
            }

            fn energy(
                &self,
                _: usize,
                _: &[$crate::math::Vec3],
            ) -> Result<f64, $crate::model::system::Inadmissible> {
                Ok(0.0)
            }

            fn derivatives(
                &self,
                _: usize,
                _: &[$crate::math::Vec3],
                _: &mut $crate::model::local::LocalDerivatives,
            ) -> Result<f64, $crate::model::system::Inadmissible> {
                Ok(0.0)
            }
        }
    };
}
pub(super) use without_stencils;

/// A term of a part, tied, with the places of its blocks in the tangent.
#[derive(Clone, Debug)]
pub(super) struct Placed {
    term: Tied<Box<dyn PartTerm>>,
    /// None until a tangent asks for them.
    slots: Option<Slots>,
    /// Tied stencils for which the pattern has room.
    room: Vec<Vec<u32>>,
    /// Whether it is taken away for now.
    pub(super) is_lifted: bool,
}

impl Placed {
    /// `term` over the nodes of `body`.
    pub(super) fn new(term: impl PartTerm, body: &Body) -> Self {
        Self::of_boxed(Box::new(term), body)
    }

    /// `term` over the nodes of `body`.
    pub(super) fn of_boxed(term: Box<dyn PartTerm>, body: &Body) -> Self {
        let term = Tied::new(term, &body.ties, &body.reference);
        Self { term, slots: None, room: Vec::new(), is_lifted: false }
    }

    /// The term over the displaced nodes themselves.
    pub(super) fn term(&self) -> &dyn PartTerm {
        &**self.term.inner()
    }

    /// The term over the displaced nodes themselves.
    pub(super) fn term_mut(&mut self) -> &mut dyn PartTerm {
        &mut **self.term.inner_mut()
    }

    /// The term over the unknowns.
    pub(super) fn tied(&self) -> &dyn Term {
        &self.term
    }

    /// The term as what it is.
    pub(super) fn as_kind<T: PartTerm>(&self) -> Option<&T> {
        let term: &dyn Any = self.term();
        term.downcast_ref()
    }

    /// The stencils over the unknowns that the pattern holds for it.
    pub(super) fn pattern_stencils(&self) -> impl Iterator<Item = &Vec<u32>> {
        let own = if self.term().widens_pattern() { self.term.stencils() } else { &[] };
        own.iter().chain(&self.room)
    }

    /// Whether its stencils are those of `other`, so that both may be assembled in one pass.
    pub(super) fn is_alike(&self, other: &Self) -> bool {
        let stencils = self.term.stencils();
        !stencils.is_empty() && stencils == other.term.stencils()
    }

    /// Adds the gradients of `terms`, which are alike, and, where asked for, their Hessians; returns their energy, mJ.
    pub(super) fn assemble(
        terms: &mut [Self],
        assembler: &mut Assembler,
        positions: &[Vec3],
        residual: &mut [f64],
        tangent: Option<&mut [f64]>,
    ) -> Result<f64, Inadmissible> {
        if tangent.is_some() && terms[0].slots.is_none() {
            terms[0].slots = Some(assembler.slots(&terms[0].term));
        }
        let working = terms.iter().filter(|placed| !placed.is_lifted && !placed.term().is_idle());
        let sum = Sum(working.map(Self::tied).collect());
        if sum.0.is_empty() {
            return Ok(0.0);
        }
        let slots = terms[0].slots.as_ref().filter(|_| tangent.is_some());
        assembler.add(&sum, slots.unwrap_or(&Slots::default()), positions, residual, tangent)
    }

    /// Brings the stencils up to a state.
    pub(super) fn prepare(&mut self, at: &Configuration<'_>) {
        if self.term_mut().prepare(at) {
            self.term.tie(&at.body.ties, &at.body.reference);
            self.slots = None;
        }
    }

    /// Takes the room that the term wants in the pattern; returns whether it changed.
    pub(super) fn make_room(&mut self, body: &Body) -> bool {
        let Some(room) = self.term_mut().room() else { return false };
        self.room = room.iter().map(|stencil| body.ties.stencil(stencil)).collect();
        true
    }

    /// The pattern is another one.
    pub(super) fn forget_slots(&mut self) {
        self.slots = None;
    }
}

/// Terms over the same stencils, whose derivatives are summed before they are scattered.
struct Sum<'a>(Vec<&'a dyn Term>);

impl Term for Sum<'_> {
    fn stencils(&self) -> &[Vec<u32>] {
        self.0[0].stencils()
    }

    fn is_active(&self, s: usize, positions: &[Vec3]) -> bool {
        self.0.iter().any(|term| term.is_active(s, positions))
    }

    fn energy(&self, s: usize, x: &[Vec3]) -> Result<f64, Inadmissible> {
        self.0.iter().map(|term| term.energy(s, x)).sum()
    }

    fn derivatives(
        &self,
        s: usize,
        x: &[Vec3],
        local: &mut LocalDerivatives,
    ) -> Result<f64, Inadmissible> {
        self.0.iter().map(|term| term.derivatives(s, x, local)).sum()
    }
}

/// The terms that are not lifted.
pub(super) fn in_place(terms: &[Placed]) -> impl Iterator<Item = &dyn PartTerm> {
    terms.iter().filter(|placed| !placed.is_lifted).map(Placed::term)
}

/// The terms that are not lifted.
pub(super) fn in_place_mut(terms: &mut [Placed]) -> impl Iterator<Item = &mut dyn PartTerm> {
    terms.iter_mut().filter(|placed| !placed.is_lifted).map(Placed::term_mut)
}
