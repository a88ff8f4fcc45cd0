//! Which triangles are near each other: a tree of boxes, sorted once at rest and fitted to every state.
//!
//! Parts of a wall that are far apart are told apart by a few boxes; what moves together stays together in the tree, so it
//! need not be sorted again.

use crate::math::Vec3;

/// A box along the axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Box3 {
    pub(super) low: Vec3,
    pub(super) high: Vec3,
}

/// The order of the leaves of a balanced tree: each node halves its range of leaves.
///
/// Node `k` has the children `2 k + 1` and `2 k + 2`; a node of one leaf has none.
#[derive(Clone, Debug)]
pub(super) struct Tree {
    leaves: Vec<u32>,
}

/// A node and its range of leaves.
#[derive(Clone, Copy)]
struct Node {
    index: usize,
    first: usize,
    end: usize,
}

impl Tree {
    /// Over leaves with `centres`.
    pub(super) fn new(centres: &[Vec3]) -> Self {
        let mut leaves: Vec<u32> = (0..centres.len() as u32).collect();
        sort(&mut leaves, centres);
        Self { leaves }
    }

    /// What every node holds, joined from what its leaves hold.
    pub(super) fn fitted<T: Copy>(
        &self,
        of_leaf: &dyn Fn(u32) -> T,
        join: &dyn Fn(&T, &T) -> T,
    ) -> Vec<T> {
        let Some(root) = self.root() else { return Vec::new() };
        let mut all = vec![of_leaf(self.leaves[0]); 2 * self.leaves.len().next_power_of_two()];
        self.fit(root, of_leaf, join, &mut all);
        all
    }

    /// Calls `visit` with every two leaves, the smaller first, for all of whose nodes `near` holds; also of a node and
    /// itself, for pairs of leaves within it.
    pub(super) fn pairs(
        &self,
        near: &dyn Fn(usize, usize) -> bool,
        visit: &mut dyn FnMut(u32, u32),
    ) {
        if let Some(root) = self.root() {
            self.pairs_within(root, near, visit);
        }
    }

    fn root(&self) -> Option<Node> {
        let end = self.leaves.len();
        (end > 0).then_some(Node { index: 0, first: 0, end })
    }

    fn fit<T: Copy>(
        &self,
        node: Node,
        of_leaf: &dyn Fn(u32) -> T,
        join: &dyn Fn(&T, &T) -> T,
        all: &mut [T],
    ) {
        all[node.index] = match node.children() {
            None => of_leaf(self.leaves[node.first]),
            Some([left, right]) => {
                self.fit(left, of_leaf, join, all);
                self.fit(right, of_leaf, join, all);
                join(&all[left.index], &all[right.index])
            }
        };
    }

    fn pairs_within(
        &self,
        node: Node,
        near: &dyn Fn(usize, usize) -> bool,
        visit: &mut dyn FnMut(u32, u32),
    ) {
        if let Some([left, right]) = node.children()
            && near(node.index, node.index)
        {
            self.pairs_within(left, near, visit);
            self.pairs_within(right, near, visit);
            self.pairs_between(left, right, near, visit);
        }
    }

    fn pairs_between(
        &self,
        a: Node,
        b: Node,
        near: &dyn Fn(usize, usize) -> bool,
        visit: &mut dyn FnMut(u32, u32),
    ) {
        if !near(a.index, b.index) {
            return;
        }
        let (larger, other) = if a.end - a.first >= b.end - b.first { (a, b) } else { (b, a) };
        match larger.children() {
            Some([left, right]) => {
                self.pairs_between(left, other, near, visit);
                self.pairs_between(right, other, near, visit);
            }
            None => {
                let [a, b] = [a, b].map(|node| self.leaves[node.first]);
                visit(a.min(b), a.max(b));
            }
        }
    }
}

impl Node {
    fn children(self) -> Option<[Self; 2]> {
        let Self { index, first, end } = self;
        let middle = first.midpoint(end);
        (end - first > 1).then_some([
            Self { index: 2 * index + 1, first, end: middle },
            Self { index: 2 * index + 2, first: middle, end },
        ])
    }
}

impl Box3 {
    /// Around `points`.
    pub(super) fn around(points: impl IntoIterator<Item = Vec3>) -> Self {
        let empty =
            Self { low: Vec3::repeat(f64::INFINITY), high: Vec3::repeat(f64::NEG_INFINITY) };
        let add = |sum: Self, x: Vec3| Self { low: sum.low.inf(&x), high: sum.high.sup(&x) };
        points.into_iter().fold(empty, add)
    }

    /// Around two boxes.
    pub(super) fn join(&self, other: &Self) -> Self {
        Self { low: self.low.inf(&other.low), high: self.high.sup(&other.high) }
    }

    /// The square of the distance between two boxes, mm^2.
    pub(super) fn gap_squared(&self, other: &Self) -> f64 {
        let apart = (other.low - self.high).sup(&(self.low - other.high));
        apart.iter().map(|apart| apart.max(0.0) * apart.max(0.0)).sum()
    }

    /// The least product of a vector to one box and a vector to the other.
    pub(super) fn least_dot(&self, other: &Self) -> f64 {
        let least = |axis: usize| {
            let ends = |at: &Self| [at.low[axis], at.high[axis]];
            let [[a, b], [c, d]] = [ends(self), ends(other)];
            (a * c).min(a * d).min(b * c).min(b * d)
        };
        least(0) + least(1) + least(2)
    }

    /// The largest distance between a point of one box and a point of another, mm.
    pub(super) fn reach(&self, other: &Self) -> f64 {
        (other.high - self.low).sup(&(self.high - other.low)).norm()
    }
}

/// Sorts so that each half of a range lies to one side of the other along its longest axis, and each half of the halves.
fn sort(leaves: &mut [u32], centres: &[Vec3]) {
    if leaves.len() < 2 {
        return;
    }
    let around = Box3::around(leaves.iter().map(|&leaf| centres[leaf as usize]));
    let axis = (around.high - around.low).imax();
    let middle = leaves.len() / 2;
    leaves.select_nth_unstable_by(middle, |&a, &b| {
        let place = |leaf: u32| centres[leaf as usize][axis];
        place(a).total_cmp(&place(b)).then(a.cmp(&b))
    });
    let (left, right) = leaves.split_at_mut(middle);
    sort(left, centres);
    sort(right, centres);
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    /// As all pairs of boxes compared, in states other than the one that was sorted.
    #[test]
    fn pairs_are_those_of_all_boxes_compared() {
        let mut chance = ChaCha8Rng::seed_from_u64(5);
        for leaves in [0, 1, 2, 3, 7, 60] {
            let mut point = || Vec3::from_fn(|_, _| chance.random_range(-4.0..4.0));
            let centres: Vec<Vec3> = (0..leaves).map(|_| point()).collect();
            let tree = Tree::new(&centres);
            let boxes: Vec<Box3> = (0..leaves)
                .map(|_| point())
                .map(|x| Box3::around([x, x + Vec3::new(0.5, 1.0, 0.1)]))
                .collect();
            let fitted = tree.fitted(&|leaf| boxes[leaf as usize], &Box3::join);
            let near = |a: &Box3, b: &Box3| a.gap_squared(b) < 1.0;
            let mut found = Vec::new();
            tree.pairs(&|a, b| near(&fitted[a], &fitted[b]), &mut |a, b| found.push([a, b]));
            found.sort_unstable();
            let all = (0..leaves as u32).flat_map(|a| (a + 1..leaves as u32).map(move |b| [a, b]));
            let exact: Vec<[u32; 2]> =
                all.filter(|p| near(&boxes[p[0] as usize], &boxes[p[1] as usize])).collect();
            assert_eq!(found, exact);
            assert!(leaves < 60 || !exact.is_empty());
        }
    }

    #[test]
    fn distances_of_boxes() {
        let boxes = [[0.0, 1.0], [3.0, 5.0]].map(|range| Box3::around(range.map(Vec3::repeat)));
        assert_eq!(boxes[0].gap_squared(&boxes[1]), 12.0);
        assert_eq!(boxes[0].gap_squared(&boxes[0]), 0.0);
        assert!((boxes[0].reach(&boxes[1]) - 75.0_f64.sqrt()).abs() < 1e-14);
        let either = Box3::around([Vec3::new(-1.0, 2.0, 0.0), Vec3::new(3.0, 4.0, 0.5)]);
        assert_eq!(either.least_dot(&boxes[1]), -5.0 + 6.0);
    }
}
