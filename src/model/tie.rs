//! Nodes that follow others: images in a plane of symmetry, and what a support ties to the inside.
//!
//! ```text
//! u_v = q_v + sum_k T_vk u_k       for a follower v;      u_v = q_v       for all others
//! ```
//!
//! The unknowns `q` are one displacement for each node, of which a support holds some at 0. Terms see displaced
//! positions; [`Tied`] turns their derivatives into those with respect to `q`.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Matrix3;

use super::local::{LocalDerivatives, Term};
use super::system::Inadmissible;
use crate::math::Vec3;

/// `sum_k T_k u_k`.
pub(super) type Combination = Vec<(u32, Matrix3<f64>)>;

/// The least factor with which a component is followed: each step along a chain of followers takes
/// about a tenth.
const LEAST: f64 = 1e-7;

/// Which nodes follow which.
#[derive(Clone, Debug, Default)]
pub(super) struct Ties {
    /// For each node what it follows; leaders follow nothing themselves. Empty for a part without ties.
    followed: Vec<Combination>,
}

impl Ties {
    /// Ties between nodes, in terms of nodes that may themselves be tied; those may follow each other in turn.
    ///
    /// A component that follows anything has no motion of its own. What is followed by less than
    /// [`LEAST`] is left out.
    ///
    /// # Panics
    /// When a component follows itself, by way of others, by all of its own motion.
    pub(super) fn new(direct: &[Combination]) -> Self {
        let rows = leaders_of(direct);
        let mut followed = vec![Combination::new(); direct.len()];
        for (follower, row) in rows {
            let (node, axis) = (follower as usize / 3, follower as usize % 3);
            for (leader, weight) in row {
                let (beside, column) = (leader / 3, leader as usize % 3);
                let place = match followed[node].binary_search_by_key(&beside, |entry| entry.0) {
                    Ok(place) => place,
                    Err(place) => {
                        followed[node].insert(place, (beside, Matrix3::zeros()));
                        place
                    }
                };
                followed[node][place].1[(axis, column)] = weight;
            }
        }
        Self { followed }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.followed.is_empty()
    }

    /// What `node` follows.
    fn of(&self, node: u32) -> &[(u32, Matrix3<f64>)] {
        self.followed.get(node as usize).map_or(&[], Vec::as_slice)
    }

    /// The nodes of `stencil` and what they follow, ascending.
    pub(super) fn stencil(&self, stencil: &[u32]) -> Vec<u32> {
        let mut nodes = stencil.to_vec();
        nodes.extend(stencil.iter().flat_map(|&v| self.of(v).iter().map(|&(leader, _)| leader)));
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }

    /// The nodes that follow or are followed, in no order and more than once.
    pub(super) fn bound(&self) -> impl Iterator<Item = u32> {
        let followers = (0u32..).zip(&self.followed).filter(|(_, leaders)| !leaders.is_empty());
        followers
            .flat_map(|(node, leaders)| leaders.iter().map(|&(leader, _)| leader).chain([node]))
    }

    /// Adds to the displacements `u`, which hold the unknowns, what the followers owe to their leaders.
    pub(super) fn displace(&self, u: &mut [Vec3]) {
        if self.is_empty() {
            return;
        }
        let own = u.to_vec();
        for (u, followed) in u.iter_mut().zip(&self.followed) {
            *u += followed.iter().map(|(leader, t)| t * own[*leader as usize]).sum::<Vec3>();
        }
    }

    /// Adds to a gradient with respect to displacements what followers pass on to their leaders.
    pub(super) fn reduce(&self, gradient: &mut [Vec3]) {
        if self.is_empty() {
            return;
        }
        let whole = gradient.to_vec();
        for (whole, followed) in whole.iter().zip(&self.followed) {
            for (leader, t) in followed {
                gradient[*leader as usize] += t.transpose() * whole;
            }
        }
    }
}

/// What a component (`3 node + axis`) follows: others and their weights.
type Row = BTreeMap<u32, f64>;

/// For each component that follows, the components that follow nothing on which it depends: Gauss's
/// and Jordan's elimination, one follower after the other.
fn leaders_of(direct: &[Combination]) -> BTreeMap<u32, Row> {
    let mut rows: BTreeMap<u32, Row> = BTreeMap::new();
    for (node, combination) in (0..).zip(direct) {
        for (leader, t) in combination {
            for (axis, column) in (0..3).flat_map(|axis| (0..3).map(move |k| (axis, k))) {
                let weight = t[(axis as usize, column as usize)];
                if weight != 0.0 {
                    let row = rows.entry(3 * node + axis).or_default();
                    *row.entry(3 * leader + column).or_default() += weight;
                }
            }
        }
    }
    let mut followers_of: BTreeMap<u32, BTreeSet<u32>> = BTreeMap::new();
    for (&follower, row) in &rows {
        for leader in row.keys().filter(|leader| rows.contains_key(leader)) {
            followers_of.entry(*leader).or_default().insert(follower);
        }
    }
    let followers: Vec<u32> = rows.keys().copied().collect();
    for follower in followers {
        let mut row = rows.remove(&follower).unwrap_or_default();
        let itself = row.remove(&follower).unwrap_or_default();
        assert!((1.0 - itself).abs() > LEAST, "a node follows itself by less than all it follows");
        row.values_mut().for_each(|weight| *weight /= 1.0 - itself);
        row.retain(|_, weight| weight.abs() >= LEAST);
        for other in followers_of.remove(&follower).unwrap_or_default() {
            let Some(others) = rows.get_mut(&other) else { continue };
            let Some(by) = others.remove(&follower) else { continue };
            for (&leader, weight) in &row {
                *others.entry(leader).or_default() += by * weight;
                if let Some(dependents) = followers_of.get_mut(&leader) {
                    dependents.insert(other);
                }
            }
        }
        rows.insert(follower, row);
    }
    for row in rows.values_mut() {
        row.retain(|_, weight| weight.abs() >= LEAST);
    }
    rows
}

/// A term whose stencils' derivatives are with respect to the unknowns.
#[derive(Clone, Debug)]
pub(super) struct Tied<T> {
    term: T,
    /// The tied stencils; empty for a part without ties.
    stencils: Vec<Vec<u32>>,
    maps: Vec<Option<StencilMap>>,
}

/// How the nodes of one stencil follow from the unknowns' nodes.
#[derive(Clone, Debug)]
struct StencilMap {
    /// For each node of the term's own stencil: its position less what `rows` give at rest.
    offsets: Vec<Vec3>,
    /// `(node of the own stencil, node of the tied stencil, T)`.
    rows: Vec<(usize, usize, Matrix3<f64>)>,
}

impl<T: Term> Tied<T> {
    /// `term` for nodes at `reference` at rest, tied by `ties`.
    pub(super) fn new(term: T, ties: &Ties, reference: &[Vec3]) -> Self {
        let mut tied = Self { term, stencils: Vec::new(), maps: Vec::new() };
        tied.tie(ties, reference);
        tied
    }

    /// Ties the stencils that the term has now, as [`Self::new`].
    pub(super) fn tie(&mut self, ties: &Ties, reference: &[Vec3]) {
        self.stencils.clear();
        self.maps.clear();
        if ties.is_empty() {
            return;
        }
        for stencil in self.term.stencils() {
            let nodes = ties.stencil(stencil);
            let map = (nodes != *stencil || stencil.iter().any(|&v| !ties.of(v).is_empty()))
                .then(|| StencilMap::new(stencil, &nodes, ties, reference));
            self.stencils.push(nodes);
            self.maps.push(map);
        }
    }

    /// The term itself.
    pub(super) fn inner(&self) -> &T {
        &self.term
    }

    /// The term itself.
    pub(super) fn inner_mut(&mut self) -> &mut T {
        &mut self.term
    }

    fn map(&self, s: usize) -> Option<&StencilMap> {
        self.maps.get(s).and_then(Option::as_ref)
    }
}

impl StencilMap {
    fn new(stencil: &[u32], nodes: &[u32], ties: &Ties, reference: &[Vec3]) -> Self {
        let place = |node: u32| nodes.binary_search(&node).expect("the tied stencil has it");
        let mut rows = Vec::new();
        let mut offsets = vec![Vec3::zeros(); stencil.len()];
        for (i, &node) in stencil.iter().enumerate() {
            rows.push((i, place(node), Matrix3::identity()));
            for &(leader, t) in ties.of(node) {
                rows.push((i, place(leader), t));
                offsets[i] -= t * reference[leader as usize];
            }
        }
        Self { offsets, rows }
    }

    /// Positions of the term's own stencil, where the tied one's nodes are at `x`: at rest, plus the unknowns.
    fn positions(&self, x: &[Vec3]) -> Vec<Vec3> {
        let mut positions = self.offsets.clone();
        for &(i, a, t) in &self.rows {
            positions[i] += t * x[a];
        }
        positions
    }

    /// Adds derivatives with respect to the own stencil to those with respect to the tied one.
    fn reduce(&self, own: &LocalDerivatives, tied: &mut LocalDerivatives) {
        for &(i, a, t) in &self.rows {
            tied.gradient_mut()[a] += t.transpose() * own.gradient()[i];
        }
        if !tied.with_hessian() {
            return;
        }
        for &(i, a, ti) in &self.rows {
            for &(j, b, tj) in &self.rows {
                if a >= b {
                    let block = if i >= j { own.block(i, j) } else { own.block(j, i).transpose() };
                    *tied.block_mut(a, b) += ti.transpose() * block * tj;
                }
            }
        }
    }
}

impl<T: Term> Term for Tied<T> {
    fn stencils(&self) -> &[Vec<u32>] {
        if self.maps.is_empty() { self.term.stencils() } else { &self.stencils }
    }

    fn is_active(&self, s: usize, positions: &[Vec3]) -> bool {
        self.map(s).is_some() || self.term.is_active(s, positions)
    }

    fn energy(&self, s: usize, x: &[Vec3]) -> Result<f64, Inadmissible> {
        match self.map(s) {
            None => self.term.energy(s, x),
            Some(map) => self.term.energy(s, &map.positions(x)),
        }
    }

    fn derivatives(
        &self,
        s: usize,
        x: &[Vec3],
        local: &mut LocalDerivatives,
    ) -> Result<f64, Inadmissible> {
        let Some(map) = self.map(s) else {
            return self.term.derivatives(s, x, local);
        };
        // Only along edges with ties: the room for the own derivatives may be made anew.
        let mut own = LocalDerivatives::with_capacity(map.offsets.len());
        own.reset(map.offsets.len(), local.with_hessian());
        let energy = self.term.derivatives(s, &map.positions(x), &mut own)?;
        map.reduce(&own, local);
        Ok(energy)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Isometry3;

    use super::*;
    use crate::model::element::LoopShell;
    use crate::model::material::{Material, NeoHookean};
    use crate::model::term_suite::{Case, term_suite};
    use crate::model::test_shells::TestShell;

    /// Node 3 mirrors node 5; node 7 follows the mean of 3 and 11.
    fn ties(nodes: usize) -> Ties {
        let mut direct = vec![Combination::new(); nodes];
        let mirror = Matrix3::from_diagonal(&Vec3::new(-1.0, 1.0, 1.0));
        direct[3] = vec![(5, mirror)];
        let half = Matrix3::from_diagonal_element(0.5);
        direct[7] = vec![(3, half), (11, half)];
        Ties::new(&direct)
    }

    fn tied_wall(shell: &TestShell) -> Case<Tied<LoopShell>> {
        let wall = shell.wall(Material::NeoHookean(NeoHookean { mu: 1.3 }));
        let ties = ties(shell.reference.len());
        let term = Tied::new(wall, &ties, &shell.reference);
        let mut positions = shell.deformed.clone();
        // The mean's own motion is that of the mean: no unknown of its own.
        positions[7] = shell.reference[7];
        positions[3] = shell.reference[3];
        Case { term, positions, motion: Isometry3::identity() }
    }

    term_suite!(tied, tied_wall);

    #[test]
    fn followers_of_followers_follow_the_leaders() {
        let ties = ties(12);
        let mut u: Vec<Vec3> = (0..12).map(|k| Vec3::new(k as f64, 1.0, 0.0)).collect();
        (u[3], u[7]) = (Vec3::zeros(), Vec3::zeros());
        ties.displace(&mut u);
        assert_eq!(u[3], Vec3::new(-5.0, 1.0, 0.0));
        assert_eq!(u[7], Vec3::new(3.0, 1.0, 0.0));
    }

    /// Three nodes that follow each other and one more: `u = A u + b u_3` solved by hand.
    #[test]
    fn followers_may_follow_each_other() {
        let times = |weight: f64| Matrix3::from_diagonal_element(weight);
        let mut direct = vec![Combination::new(); 4];
        direct[0] = vec![(1, times(0.5)), (2, times(0.25))];
        direct[1] = vec![(0, times(0.5)), (3, times(0.25))];
        direct[2] = vec![(0, times(1.0)), (1, times(-1.0)), (3, times(0.5))];
        let mut u = vec![Vec3::zeros(); 4];
        u[3] = Vec3::new(14.0, -28.0, 7.0);
        Ties::new(&direct).displace(&mut u);
        // (1 - 1/4 - 1/8) u_0 = (1/16 + 1/8) u_3.
        for (u_k, share) in u.iter().zip([0.3, 0.4, 0.4]) {
            assert!((u_k - share * u[3]).norm() < 1e-14, "{u:?}");
        }
    }

    /// `reduce` is the transpose of `displace`.
    #[test]
    fn virtual_work_is_kept() {
        let ties = ties(12);
        let q: Vec<Vec3> =
            (0..12).map(|k| Vec3::new(1.0 + k as f64, 0.3 * k as f64, -1.0)).collect();
        let force: Vec<Vec3> = (0..12).map(|k| Vec3::new(0.7, -2.0, k as f64)).collect();
        let (mut u, mut reduced) = (q.clone(), force.clone());
        ties.displace(&mut u);
        ties.reduce(&mut reduced);
        let work = |f: &[Vec3], u: &[Vec3]| -> f64 { f.iter().zip(u).map(|(f, u)| f.dot(u)).sum() };
        assert!((work(&force, &u) - work(&reduced, &q)).abs() < 1e-12);
    }
}
