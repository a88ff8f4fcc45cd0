//! A balanced tree of boxes over items in a row: each node halves its range.
//!
//! The tree is the order of the items and nothing else. What its nodes hold, boxes above all, stands in arrays beside it, so
//! that it is sorted once and its boxes are fitted to every state: what moves together stays together.

use std::cmp::Ordering;
use std::ops::Range;

use super::{Box3, Vec3};

/// The shape of a balanced tree over items in a row.
///
/// Node `k` has the children `2 k + 1` and `2 k + 2`; a node of few items is a leaf and has none.
#[derive(Clone, Copy, Debug)]
pub struct BoxTree {
    items: u32,
    leaf_size: u32,
}

/// A node and its range of items.
#[derive(Clone, Copy, Debug)]
pub struct Node {
    index: u32,
    first: u32,
    end: u32,
}

impl Node {
    /// Its place in arrays of what nodes hold.
    #[must_use]
    #[inline]
    pub fn index(self) -> usize {
        self.index as usize
    }

    /// The places of its items.
    #[must_use]
    #[inline]
    pub fn items(self) -> Range<usize> {
        self.first as usize..self.end as usize
    }
}

impl BoxTree {
    /// Over so many items, at most `leaf_size` of them in a leaf, which must not be 0.
    #[must_use]
    pub fn new(items: usize, leaf_size: usize) -> Self {
        Self { items: items as u32, leaf_size: leaf_size as u32 }
    }

    /// A tree over `places` (mm) with one in each leaf, and their numbers in the order of the leaves. Of places that are level
    /// along an axis the lesser number comes first.
    #[must_use]
    pub fn of_places(places: &[Vec3]) -> (Self, Vec<u32>) {
        let tree = Self::new(places.len(), 1);
        let mut numbers: Vec<u32> = (0..places.len() as u32).collect();
        let place = |number: &u32| places[*number as usize];
        tree.sort(
            &mut numbers,
            &mut |_, numbers| Box3::around(numbers.iter().map(place)),
            &|a, b, axis| place(a)[axis].total_cmp(&place(b)[axis]).then(a.cmp(b)),
        );
        (tree, numbers)
    }

    /// The root; `None` of a tree over nothing.
    #[must_use]
    pub fn root(&self) -> Option<Node> {
        (self.items > 0).then_some(Node { index: 0, first: 0, end: self.items })
    }

    /// The two halves of a node; `None` of a leaf.
    #[must_use]
    #[inline]
    pub fn children(&self, node: Node) -> Option<[Node; 2]> {
        let Node { index, first, end } = node;
        let middle = first + (end - first) / 2;
        (end - first > self.leaf_size).then_some([
            Node { index: 2 * index + 1, first, end: middle },
            Node { index: 2 * index + 2, first: middle, end },
        ])
    }

    /// The length of an array with a place for each node; some are of none.
    #[must_use]
    pub fn nodes(&self) -> usize {
        let (mut nodes, mut widest) = (1, self.items);
        while widest > self.leaf_size {
            (nodes, widest) = (2 * nodes + 1, widest.div_ceil(2));
        }
        nodes
    }

    /// Sorts `items` so that one half of each node comes before the other along the longest side of the box around it.
    ///
    /// `around` is that box, asked once of every node, the leaves too; `compare` says which of two items comes first along an
    /// axis.
    ///
    /// # Panics
    /// When the tree is over another number of items.
    pub fn sort<T>(
        &self,
        items: &mut [T],
        around: &mut impl FnMut(Node, &[T]) -> Box3,
        compare: &impl Fn(&T, &T, usize) -> Ordering,
    ) {
        assert_eq!(items.len(), self.items as usize, "the tree is over these items");
        if let Some(root) = self.root() {
            self.sort_within(root, items, around, compare);
        }
    }

    fn sort_within<T>(
        &self,
        node: Node,
        items: &mut [T],
        around: &mut impl FnMut(Node, &[T]) -> Box3,
        compare: &impl Fn(&T, &T, usize) -> Ordering,
    ) {
        let Box3 { low, high } = around(node, items);
        let Some([left, right]) = self.children(node) else { return };
        let axis = (high - low).imax();
        let half = left.items().len();
        items.select_nth_unstable_by(half, |a, b| compare(a, b, axis));
        let (before, after) = items.split_at_mut(half);
        self.sort_within(left, before, around, compare);
        self.sort_within(right, after, around, compare);
    }

    /// What every node holds, `[node]`, joined from what its leaves hold.
    pub fn fitted<T: Copy>(
        &self,
        of_leaf: &dyn Fn(Range<usize>) -> T,
        join: &dyn Fn(&T, &T) -> T,
    ) -> Vec<T> {
        let Some(root) = self.root() else { return Vec::new() };
        let first_leaf = 0..self.leaf_size.min(self.items) as usize;
        let mut all = vec![of_leaf(first_leaf); self.nodes()];
        self.fit(root, of_leaf, join, &mut all);
        all
    }

    fn fit<T: Copy>(
        &self,
        node: Node,
        of_leaf: &dyn Fn(Range<usize>) -> T,
        join: &dyn Fn(&T, &T) -> T,
        all: &mut [T],
    ) {
        all[node.index()] = match self.children(node) {
            None => of_leaf(node.items()),
            Some([left, right]) => {
                self.fit(left, of_leaf, join, all);
                self.fit(right, of_leaf, join, all);
                join(&all[left.index()], &all[right.index()])
            }
        };
    }

    /// Calls `visit` with every two leaves for all of whose nodes `near` holds; also of a node and itself, for pairs of
    /// leaves within it.
    pub fn pairs(&self, near: &dyn Fn(usize, usize) -> bool, visit: &mut dyn FnMut(Node, Node)) {
        if let Some(root) = self.root() {
            self.pairs_within(root, near, visit);
        }
    }

    fn pairs_within(
        &self,
        node: Node,
        near: &dyn Fn(usize, usize) -> bool,
        visit: &mut dyn FnMut(Node, Node),
    ) {
        if let Some([left, right]) = self.children(node)
            && near(node.index(), node.index())
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
        visit: &mut dyn FnMut(Node, Node),
    ) {
        if !near(a.index(), b.index()) {
            return;
        }
        let (larger, other) = if a.items().len() >= b.items().len() { (a, b) } else { (b, a) };
        match self.children(larger) {
            Some([left, right]) => {
                self.pairs_between(left, other, near, visit);
                self.pairs_between(right, other, near, visit);
            }
            None => visit(a, b),
        }
    }
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
        for count in [0, 1, 2, 3, 7, 60] {
            let mut point = || Vec3::from_fn(|_, _| chance.random_range(-4.0..4.0));
            let centres: Vec<Vec3> = (0..count).map(|_| point()).collect();
            let (tree, numbers) = BoxTree::of_places(&centres);
            let boxes: Vec<Box3> = (0..count)
                .map(|_| point())
                .map(|x| Box3::around([x, x + Vec3::new(0.5, 1.0, 0.1)]))
                .collect();
            let number_of = |leaf: Range<usize>| numbers[leaf.start];
            let fitted = tree.fitted(&|leaf| boxes[number_of(leaf) as usize], &Box3::join);
            let near = |a: &Box3, b: &Box3| a.gap_squared(b) < 1.0;
            let mut found = Vec::new();
            tree.pairs(&|a, b| near(&fitted[a], &fitted[b]), &mut |a, b| {
                let [a, b] = [a, b].map(|leaf| number_of(leaf.items()));
                found.push([a.min(b), a.max(b)]);
            });
            found.sort_unstable();
            let all = (0..count as u32).flat_map(|a| (a + 1..count as u32).map(move |b| [a, b]));
            let exact: Vec<[u32; 2]> =
                all.filter(|p| near(&boxes[p[0] as usize], &boxes[p[1] as usize])).collect();
            assert_eq!(found, exact);
            assert!(count < 60 || !exact.is_empty());
        }
    }

    /// Leaves of up to four: every item is in one, and every node has a place of its own.
    #[test]
    fn leaves_share_the_items() {
        for count in 1..70 {
            let tree = BoxTree::new(count, 4);
            let mut open = vec![tree.root().expect("there are items")];
            let (mut taken, mut met) = (vec![false; tree.nodes()], 0);
            while let Some(node) = open.pop() {
                assert!(!std::mem::replace(&mut taken[node.index()], true));
                match tree.children(node) {
                    Some(children) => open.extend(children),
                    None => {
                        assert!((1..=4).contains(&node.items().len()));
                        met += node.items().len();
                    }
                }
            }
            assert_eq!(met, count);
        }
    }
}
