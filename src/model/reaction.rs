//! What holds a part, and with which force: the residual where its supports are.
//!
//! ```text
//! F = sum g_i        M = sum (x_i - c) x g_i        g = dE/dx of wall, chamber, loads and planes, before anything is held
//! ```
//!
//! The sums are over the nodes that a support holds or ties. At an equilibrium `g` vanishes at all others, and the wall's own
//! forces are in balance wherever it is cut; so `F` and `M` balance the loads and the planes, and are none under a pressure alone.
//! `x_i` are the nodes of the element (of a Loop shell its control points), whose motions as a rigid body are those of the wall.
//! What a rough plane drags a clamped node itself along with is left out: it passes through no wall.

use super::assembly::Slots;
use super::load::DeadForces;
use super::local::Term;
use super::part_model::PartModel;
use super::part_term::in_place;
use super::system::LoadedSystem;
use crate::math::Vec3;

/// The force and the moment with which all supports together hold a part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reaction {
    /// Of the supports on the part, N.
    pub force: Vec3,
    /// About [`Self::about`], N mm.
    pub moment: Vec3,
    /// The mean place at rest of the nodes that are held, mm.
    pub about: Vec3,
}

impl PartModel {
    /// How the supports hold the part at the displacement `u`, an equilibrium under `load`; none where nothing holds it.
    ///
    /// From then on this process evaluates all of the part, whatever its share was.
    ///
    /// # Panics
    /// When `u` is not admissible.
    pub fn reaction(&mut self, u: &[f64], load: f64) -> Option<Reaction> {
        let held = self.held_nodes();
        // Beyond the sides of a patch are nodes that are no places of it.
        let is_place = |node: &&u32| {
            self.body.ties.is_empty() || (**node as usize) < self.body.surface.vertices
        };
        let places: Vec<Vec3> =
            held.iter().filter(is_place).map(|&node| self.body.reference[node as usize]).collect();
        if places.is_empty() {
            return None;
        }
        let about = places.iter().sum::<Vec3>() / places.len() as f64;
        let before = self.load;
        self.set_load(load);
        let supported = self.supported_nodes(held);
        let (forces, positions) = self.forces_before_supports(&supported, u);
        self.set_load(before);
        let (mut force, mut moment) = (Vec3::zeros(), Vec3::zeros());
        for node in supported.into_iter().map(|node| node as usize) {
            force += forces[node];
            moment += (positions[node] - about).cross(&forces[node]);
        }
        Some(Reaction { force, moment, about })
    }

    /// Nodes of the wall of which an unknown is held.
    fn held_nodes(&self) -> Vec<u32> {
        let mut is_used = vec![false; self.body.reference.len()];
        let places = |node: &&u32| (**node as usize) < self.body.reference.len();
        for &node in self.wall().stencils().iter().flatten().filter(places) {
            is_used[node as usize] = true;
        }
        let nodes = self.dirichlet.unknowns().iter().map(|unknown| unknown / 3);
        let mut held: Vec<u32> =
            nodes.filter(|&node| is_used.get(node as usize) == Some(&true)).collect();
        held.dedup();
        held
    }

    /// The nodes `held`, and all that ties bind to others.
    fn supported_nodes(&self, mut held: Vec<u32>) -> Vec<u32> {
        held.extend(self.body.ties.bound());
        held.sort_unstable();
        held.dedup();
        held
    }

    /// `dE/dx` of `nodes`, N, with the positions of all, mm; what does not concern them is not evaluated.
    fn forces_before_supports(&mut self, nodes: &[u32], u: &[f64]) -> (Vec<Vec3>, Vec<Vec3>) {
        self.prepare(u);
        let Self { body, terms, assembler, .. } = self;
        let mut positions = body.displaced(u);
        let pressures = &u[3 * positions.len()..];
        positions.extend(pressures.iter().map(|&q| Vec3::new(q, 0.0, 0.0)));
        let mut gradient = vec![0.0; u.len()];
        let mut share = vec![false; u.len()];
        nodes.iter().for_each(|&node| share[3 * node as usize..][..3].fill(true));
        assembler.set_share(Some(&share));
        for term in in_place(terms).filter(|term| term.acts_on_supports()) {
            let none = Slots::default();
            let added = assembler.add(term, &none, &positions, &mut gradient, None);
            added.expect("an equilibrium is admissible");
        }
        assembler.set_share(None);
        let places = gradient[..3 * self.body.reference.len()].as_chunks().0;
        let mut forces: Vec<Vec3> = places.iter().map(|&g: &[f64; 3]| g.into()).collect();
        for dead in self.each::<DeadForces>() {
            for (sum, force) in forces.iter_mut().zip(dead.on_nodes()) {
                *sum -= dead.load_factor * force;
            }
        }
        (forces, positions)
    }
}
