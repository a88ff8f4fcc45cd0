//! The contact of a wall with itself as a model sees it: which pairs are near, kept up to date while the wall moves.
//!
//! Pairs nearer than the barrier's reach and a margin are listed. The list stays complete until some node has moved by half
//! the margin; until then nothing is searched. The order of the list does not depend on when it was made, so the energy
//! of a state does not either.
//!
//! The tangent's pattern has room for the triangles that are or were listed, so that it seldom changes.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::SelfContactSettings;
use super::folds::FoldWatch;
use super::pair::Pair;
use super::pair_term::PairTerm;
use super::step::longest_step;
use super::wall_surface::{Couple, Search, WallSurface};
use crate::math::Vec3;
use crate::model::body::{Body, Configuration};
use crate::model::local::{LocalDerivatives, Term};
use crate::model::part_term::PartTerm;
use crate::model::system::Inadmissible;

/// How much farther than the barrier's reach pairs are listed, in thicknesses.
const MARGIN: f64 = 0.3;
/// How much farther than the barrier's reach the pattern has room, in thicknesses: beyond are neighbours in a flat wall.
const ROOM_MARGIN: f64 = 0.6;
/// Largest activation, in thicknesses: beyond, neighbours in a flat wall come within reach.
const LARGEST_ACTIVATION: f64 = 0.25;
/// Room for more than so many times the listed triangles is too much.
const ROOM_TO_SPARE: usize = 4;
/// Less room than this is never too much.
const LEAST_ROOM: usize = 200;

/// The barriers of a wall against itself, and where they are valid.
#[derive(Clone, Debug)]
pub(in crate::model) struct WallContact {
    surface: Arc<WallSurface>,
    settings: SelfContactSettings,
    term: PairTerm,
    /// Nodes where the pairs were listed, mm; empty while none are.
    listed_at: Vec<Vec3>,
    /// Triangles that the pattern has room for, ascending.
    room: Vec<[u32; 2]>,
}

impl WallContact {
    /// Barriers between the `folds` of the wall of `body`.
    pub(in crate::model) fn of_folds(
        folds: &FoldWatch,
        body: &Body,
        settings: SelfContactSettings,
    ) -> Self {
        Self::new(folds.surface(body), settings)
    }

    /// Barriers on `surface`.
    pub(super) fn new(surface: Arc<WallSurface>, settings: SelfContactSettings) -> Self {
        let activation = settings.activation.min(LARGEST_ACTIVATION * surface.thickness);
        let settings = SelfContactSettings { activation, ..settings };
        let reach = surface.thickness + activation;
        let term = PairTerm::new(surface.clone(), Vec::new(), reach);
        Self { surface, settings, term, listed_at: Vec::new(), room: Vec::new() }
    }

    /// Lists the pairs that are near where the nodes are at `positions` (mm), unless the last list is still complete;
    /// returns whether it made a new one.
    pub(super) fn list(&mut self, positions: &[Vec3]) -> bool {
        if self.is_listed(positions) {
            return false;
        }
        let listed = self.listed_near(positions);
        self.listed_at = positions.to_vec();
        // Nothing near before, nothing near now: nothing changes.
        if listed.stencils().is_empty() && self.term.stencils().is_empty() {
            return false;
        }
        self.term = listed;
        true
    }

    /// Makes the room that the listed pairs want; returns the stencils of all room, where it had to be changed.
    pub(super) fn make_room(&mut self) -> Option<Vec<Vec<u32>>> {
        let listed: Vec<[u32; 2]> = self.term.triangles().collect();
        let is_enough = listed.iter().all(|pair| self.room.binary_search(pair).is_ok());
        let is_too_much = self.room.len() > LEAST_ROOM.max(ROOM_TO_SPARE * listed.len());
        if is_enough && !is_too_much {
            return None;
        }
        let mut room = if is_too_much { Vec::new() } else { std::mem::take(&mut self.room) };
        let pose = self.surface.pose(&self.listed_at, None);
        let far = self.reach() + ROOM_MARGIN * self.surface.thickness;
        self.surface
            .visit_near(&pose, Search::within(far), &mut |triangles, _| room.push(triangles));
        room.sort_unstable();
        room.dedup();
        let pairs = room.iter().map(|&triangles| (triangles, Vec::new())).collect();
        let term = PairTerm::new(self.surface.clone(), pairs, self.reach());
        self.room = room;
        Some(term.stencils().to_vec())
    }

    /// The largest part of the displacement `dx` (mm) of the nodes at `positions` that keeps all gaps open, at most 1.
    pub(super) fn longest_part(&self, positions: &[Vec3], dx: &[Vec3]) -> f64 {
        let mut longest = 1.0_f64;
        let there: Vec<Vec3> = positions.iter().zip(dx).map(|(x, dx)| x + dx).collect();
        // Between two states whose list is complete it is complete too.
        if self.is_listed(positions) && self.is_listed(&there) {
            if self.term.stencils().is_empty() {
                return longest;
            }
            let [x, dx] = [positions, dx].map(|nodes| self.surface.samples_at(nodes));
            for (samples, pair) in self.term.pairs() {
                let [x, dx] = [&x, &dx].map(|all| at(all, &samples, pair));
                let closest = |x: &[Vec3; 4]| pair.closest(x);
                longest = longest_step(&x, &dx, pair.first(), pair.thickness, closest, longest);
            }
            return longest;
        }
        let pose = self.surface.pose(positions, Some(dx));
        let search = Search::within(self.surface.thickness);
        self.surface.visit_near(&pose, search, &mut |_, couple: Couple| {
            let [x, dx] =
                [&pose.samples, &pose.motion].map(|all| couple.samples.map(|v| all[v as usize]));
            let [thickness, _] = self.surface.thickness_of(&couple);
            let closest = |x: &[Vec3; 4]| couple.kind.closest(x);
            longest = longest_step(&x, &dx, couple.kind.first(), thickness, closest, longest);
            pose.share.set(longest);
        });
        longest
    }

    /// The force with which the wall presses on itself where the nodes are at `positions`, N: that of all points on
    /// facets, and of edges on edges.
    pub(in crate::model) fn force(&self, positions: &[Vec3]) -> f64 {
        let x = self.surface.samples_at(positions);
        let mut of_points: BTreeMap<u32, Vec3> = BTreeMap::new();
        let mut of_edges = 0.0;
        for (samples, pair) in self.listed_near(positions).pairs() {
            if let Ok(Some(derivatives)) = pair.derivatives(&at(&x, &samples, pair), false) {
                let force: Vec3 = derivatives.gradient[..pair.first()].iter().sum();
                if pair.first() == 1 {
                    *of_points.entry(samples[pair.points[0] as usize]).or_default() += force;
                } else {
                    of_edges += force.norm();
                }
            }
        }
        of_points.values().map(|force| force.norm()).fold(of_edges, |sum, force| sum + force)
    }

    /// Adds what the wall does to itself to each sample: its gap, mm, where it is smaller than before or that was none, and its
    /// pressure, MPa, of force over area at rest.
    pub(in crate::model) fn add_contact(
        &self,
        positions: &[Vec3],
        gaps: &mut [f64],
        pressures: &mut [f64],
    ) {
        let x = self.surface.samples_at(positions);
        let mut forces = vec![Vec3::zeros(); gaps.len()];
        for (samples, pair) in self.listed_near(positions).pairs() {
            let corners = at(&x, &samples, pair);
            let gap = pair.closest(&corners).distance - pair.thickness;
            let of_pair = pair.points.map(|point| samples[point as usize] as usize);
            for sample in of_pair {
                gaps[sample] = gap.min(gaps[sample]);
            }
            if let Ok(Some(derivatives)) = pair.derivatives(&corners, false) {
                for (sample, force) in of_pair.into_iter().zip(derivatives.gradient) {
                    forces[sample] += force;
                }
            }
        }
        for ((pressure, force), area) in pressures.iter_mut().zip(forces).zip(&self.surface.areas) {
            *pressure += force.norm() / area;
        }
    }

    /// Gap of the mid-surfaces below which a barrier may act, mm.
    fn reach(&self) -> f64 {
        self.surface.thickness + self.settings.activation
    }

    fn is_listed(&self, positions: &[Vec3]) -> bool {
        // Points are means of nodes: none moves farther than the farthest node.
        let farthest = 0.5 * MARGIN * self.surface.thickness;
        self.listed_at.len() == positions.len()
            && (self.listed_at.iter().zip(positions))
                .all(|(at, x)| (x - at).norm_squared() <= farthest * farthest)
    }

    /// The barriers between all pairs that are near where the nodes are at `positions`.
    pub(super) fn listed_near(&self, positions: &[Vec3]) -> PairTerm {
        let SelfContactSettings { activation, stiffness } = self.settings;
        let pose = self.surface.pose(positions, None);
        let mut pairs: BTreeMap<[u32; 2], Vec<Pair>> = BTreeMap::new();
        let far = self.reach() + MARGIN * self.surface.thickness;
        self.surface.visit_near(&pose, Search::within(far), &mut |triangles, couple| {
            let pair = Pair::new(&couple, &self.surface, activation, stiffness);
            pairs.entry(triangles).or_default().push(pair);
        });
        PairTerm::new(self.surface.clone(), pairs.into_iter().collect(), self.reach())
    }
}

impl Term for WallContact {
    fn stencils(&self) -> &[Vec<u32>] {
        self.term.stencils()
    }

    fn is_active(&self, s: usize, positions: &[Vec3]) -> bool {
        self.term.is_active(s, positions)
    }

    fn energy(&self, s: usize, x: &[Vec3]) -> Result<f64, Inadmissible> {
        self.term.energy(s, x)
    }

    fn derivatives(
        &self,
        s: usize,
        x: &[Vec3],
        local: &mut LocalDerivatives,
    ) -> Result<f64, Inadmissible> {
        self.term.derivatives(s, x, local)
    }
}

impl PartTerm for WallContact {
    fn boxed(&self) -> Box<dyn PartTerm> {
        Box::new(self.clone())
    }

    /// Its stencils lie within the room that it asks for.
    fn widens_pattern(&self) -> bool {
        false
    }

    fn prepare(&mut self, at: &Configuration<'_>) -> bool {
        self.list(at.positions())
    }

    fn room(&mut self) -> Option<Vec<Vec<u32>>> {
        self.make_room()
    }

    fn longest_step(&self, from: &Configuration<'_>, step: &Configuration<'_>) -> f64 {
        self.longest_part(from.positions(), step.displacements())
    }
}

fn at(all: &[Vec3], samples: &[u32; 12], pair: &Pair) -> [Vec3; 4] {
    pair.points.map(|point| all[samples[point as usize] as usize])
}
