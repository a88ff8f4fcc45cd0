//! Which rank owns which unknowns, and how a tangent's lower triangle becomes the rows of a rank.
//!
//! Nodes are bisected along the longest side of their box until there are as many parts as ranks, with as many unknowns in each
//! as may be (recursive coordinate bisection, Berger & Bokhari 1987). A multiplier goes with its node.

use std::ops::Range;

use crate::math::Vec3;
use crate::model::system::{Layout, SparsityPattern};

/// The rows of a matrix that is spread over ranks.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Rows {
    /// The unknown of each row, rank after rank; of each rank the displacements before the multipliers, `[n]`.
    pub unknowns: Vec<u32>,
    /// The rows of this rank.
    pub own: Range<usize>,
    /// How many of them are not multipliers.
    pub displacements: usize,
}

/// The entries of the own rows.
pub(super) struct OwnEntries {
    /// Start of each row in `columns`, `[own + 1]`.
    pub starts: Vec<usize>,
    /// The column of each entry, numbered as rows are; sorted in each row.
    pub columns: Vec<u32>,
    /// The stored entry of the system that it is.
    pub stored: Vec<u32>,
    /// Where each row's diagonal is, `[own]`.
    pub diagonal: Vec<usize>,
}

impl Rows {
    /// The rows of `rank`, of `ranks`, in a system of this `order`; in blocks of equal length where there is no layout.
    pub(super) fn new(layout: Option<&Layout>, order: usize, rank: usize, ranks: usize) -> Self {
        let Some(layout) = layout else {
            let own = order * rank / ranks..order * (rank + 1) / ranks;
            let displacements = own.len();
            return Self { unknowns: (0..order as u32).collect(), own, displacements };
        };
        let mut multipliers = vec![Vec::new(); layout.nodes.len()];
        for (unknown, multiplier) in (3 * layout.nodes.len() as u32..).zip(&layout.multipliers) {
            multipliers[multiplier.node as usize].push(unknown);
        }
        let weights: Vec<usize> = multipliers.iter().map(|own| 3 + own.len()).collect();
        let mut nodes: Vec<u32> = (0..layout.nodes.len() as u32).collect();
        let mut rows = Self { unknowns: Vec::with_capacity(order), own: 0..0, displacements: 0 };
        let mut parts = Vec::new();
        bisect(&mut nodes, &layout.nodes, &weights, ranks, &mut parts);
        for (part, nodes) in parts.iter().enumerate() {
            let start = rows.unknowns.len();
            rows.unknowns.extend(nodes.iter().flat_map(|v| 3 * v..3 * v + 3));
            let displacements = rows.unknowns.len() - start;
            rows.unknowns.extend(nodes.iter().flat_map(|&v| &multipliers[v as usize]));
            if part == rank {
                rows.own = start..rows.unknowns.len();
                rows.displacements = displacements;
            }
        }
        assert!(rows.unknowns.len() == order, "the layout is not the system's");
        rows
    }

    /// The unknowns of the own rows.
    pub(super) fn own_unknowns(&self) -> &[u32] {
        &self.unknowns[self.own.clone()]
    }

    /// Which unknowns are owned, `[n]`.
    pub(super) fn share(&self) -> Vec<bool> {
        let mut share = vec![false; self.unknowns.len()];
        self.own_unknowns().iter().for_each(|&unknown| share[unknown as usize] = true);
        share
    }

    /// The own rows of the symmetric matrix whose lower triangle has this `pattern`.
    ///
    /// # Panics
    /// When a diagonal entry is missing.
    pub(super) fn entries(&self, pattern: &SparsityPattern) -> OwnEntries {
        let mut row_of = vec![0; self.unknowns.len()];
        for (row, &unknown) in self.unknowns.iter().enumerate() {
            row_of[unknown as usize] = row as u32;
        }
        let each = |visit: &mut dyn FnMut(usize, u32, u32)| {
            for (column, bounds) in pattern.column_starts.windows(2).enumerate() {
                let other = row_of[column];
                for stored in bounds[0]..bounds[1] {
                    let unknown = pattern.row_indices[stored as usize] as usize;
                    let row = row_of[unknown];
                    if unknown >= column && self.own.contains(&(row as usize)) {
                        visit(row as usize - self.own.start, other, stored);
                    }
                    if unknown > column && self.own.contains(&(other as usize)) {
                        visit(other as usize - self.own.start, row, stored);
                    }
                }
            }
        };
        let mut starts = vec![0; self.own.len() + 1];
        each(&mut |row, _, _| starts[row + 1] += 1);
        for row in 0..self.own.len() {
            starts[row + 1] += starts[row];
        }
        let mut filled = starts.clone();
        let mut entries = vec![(0, 0); starts[self.own.len()]];
        each(&mut |row, column, stored| {
            entries[filled[row]] = (column, stored);
            filled[row] += 1;
        });
        let mut diagonal = Vec::with_capacity(self.own.len());
        for (row, bounds) in starts.windows(2).enumerate() {
            let entries = &mut entries[bounds[0]..bounds[1]];
            entries.sort_unstable();
            let own = (self.own.start + row) as u32;
            let within = entries.binary_search_by_key(&own, |&(column, _)| column);
            diagonal.push(bounds[0] + within.expect("the diagonal is stored"));
        }
        let (columns, stored) = entries.into_iter().unzip();
        OwnEntries { starts, columns, stored, diagonal }
    }
}

/// Appends `ranks` parts of `nodes` to `parts`, each with about the same sum of `weights`; each ascending.
fn bisect(
    nodes: &mut [u32],
    places: &[Vec3],
    weights: &[usize],
    ranks: usize,
    parts: &mut Vec<Vec<u32>>,
) {
    if ranks == 1 {
        nodes.sort_unstable();
        return parts.push(nodes.to_vec());
    }
    let (mut low, mut high) = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    for &node in &*nodes {
        low = low.inf(&places[node as usize]);
        high = high.sup(&places[node as usize]);
    }
    let axis = (high - low).imax();
    let along = |&node: &u32| places[node as usize][axis];
    nodes.sort_unstable_by(|a, b| along(a).total_cmp(&along(b)).then(a.cmp(b)));
    let first = ranks / 2;
    let total: usize = nodes.iter().map(|&node| weights[node as usize]).sum();
    let mut sum = 0;
    let below = nodes.iter().position(|&node| {
        sum += weights[node as usize];
        sum * ranks > total * first
    });
    let (left, right) = nodes.split_at_mut(below.unwrap_or_default());
    bisect(left, places, weights, first, parts);
    bisect(right, places, weights, ranks - first, parts);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::system::Multiplier;

    /// Nodes on a bar, a multiplier on every third of them.
    fn bar(nodes: u32) -> Layout {
        let places = (0..nodes).map(|v| Vec3::new(1.0, -2.0, f64::from(v * 7 % nodes)));
        let multipliers = (0..nodes).step_by(3).map(|node| Multiplier { node, complement: 1.0 });
        Layout { nodes: places.collect(), multipliers: multipliers.collect() }
    }

    #[test]
    fn unknowns_are_shared_out_once_and_evenly_along_the_bar() {
        let layout = bar(50);
        let order = 150 + layout.multipliers.len();
        for ranks in 1..6 {
            let rows: Vec<Rows> =
                (0..ranks).map(|rank| Rows::new(Some(&layout), order, rank, ranks)).collect();
            let mut unknowns = rows[0].unknowns.clone();
            unknowns.sort_unstable();
            assert!(unknowns.iter().copied().eq(0..order as u32));
            let mut end = (0, f64::NEG_INFINITY);
            for rows in &rows {
                assert_eq!(rows.own.start, end.0);
                // A node with its multiplier is 4 unknowns.
                assert!(rows.own.len().abs_diff(order / ranks) <= 8, "{:?} of {order}", rows.own);
                let (displacements, multipliers) = rows.own_unknowns().split_at(rows.displacements);
                let along =
                    displacements.iter().map(|&unknown| layout.nodes[unknown as usize / 3].z);
                let (low, high) = along
                    .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), z| {
                        (low.min(z), high.max(z))
                    });
                assert!(low > end.1, "parts do not overlap");
                for &multiplier in multipliers {
                    let node = layout.multipliers[multiplier as usize - 150].node;
                    assert!(displacements.contains(&(3 * node)));
                }
                end = (rows.own.end, high);
            }
            assert_eq!(end.0, order);
        }
    }

    /// Rows of all ranks together are the symmetric matrix, entries above the diagonal left out.
    #[test]
    fn rows_are_those_of_the_symmetric_matrix() {
        let pattern = SparsityPattern {
            column_starts: vec![0, 3, 6, 8, 9],
            row_indices: vec![0, 1, 3, 0, 1, 2, 2, 3, 3],
        };
        for ranks in 1..4 {
            let mut found = Vec::new();
            for rank in 0..ranks {
                let rows = Rows::new(None, 4, rank, ranks);
                let own = rows.entries(&pattern);
                for (row, bounds) in own.starts.windows(2).enumerate() {
                    let row = rows.own.start + row;
                    assert_eq!(own.columns[own.diagonal[row - rows.own.start]] as usize, row);
                    for at in bounds[0]..bounds[1] {
                        found.push((row as u32, own.columns[at], own.stored[at]));
                    }
                }
            }
            let stored = [
                (0, 0, 0),
                (1, 0, 1),
                (3, 0, 2),
                (1, 1, 4),
                (2, 1, 5),
                (2, 2, 6),
                (3, 2, 7),
                (3, 3, 8),
            ];
            let mirrored = stored.iter().filter(|(row, column, _)| row != column);
            let mut expected: Vec<(u32, u32, u32)> = stored.to_vec();
            expected.extend(mirrored.map(|&(row, column, at)| (column, row, at)));
            expected.sort_unstable();
            assert_eq!(found, expected, "{ranks} ranks");
        }
    }
}
