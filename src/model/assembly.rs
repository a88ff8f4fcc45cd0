//! From stencils to the global gradient and Hessian.
//!
//! Three unknowns for each node, and one for each of the last nodes of a mixed method ([`Nodes`]); the tangent's lower triangle by
//! columns in 3x3 blocks. A column of blocks is stored as three columns of equal length, so that the place of a block follows from
//! two numbers.
//!
//! Where the current `rayon` pool has several threads, stencils are evaluated side by side, and then every thread adds
//! to the nodes that are its own. Each entry is a sum in the order of the stencils either way: its bits are the same
//! for any number of threads.

use std::ops::Range;

use rayon::prelude::*;

use super::block::Block;
use super::local::{LocalDerivatives, Term};
use super::system::{Inadmissible, SparsityPattern};
use crate::math::Vec3;

/// Stencils that a thread evaluates before they are added up: 370 kB of derivatives, which its cache holds.
const CHUNK_OF_A_THREAD: usize = 64;
/// Fewer stencils than this are not worth waking a thread.
const LEAST_FOR_A_THREAD: usize = 16;
/// Ranges of nodes for each thread: neighbours in a chunk are neighbours in the mesh, and their cost is uneven.
const RANGES_OF_A_THREAD: usize = 2;

/// The nodes of a model: first those with a place, then those with a single number.
///
/// A number (a pressure) is the first component of its node's vector in stencils, gradients and blocks; the others are
/// not read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Nodes {
    /// Nodes with a place: three unknowns each.
    pub places: usize,
    /// Nodes with a number: one unknown each.
    pub numbers: usize,
}

impl Nodes {
    /// All nodes.
    #[must_use]
    pub fn count(self) -> usize {
        self.places + self.numbers
    }

    /// The number of unknowns.
    #[must_use]
    pub fn unknowns(self) -> usize {
        3 * self.places + self.numbers
    }

    /// The first unknown of `node`; after the last node, the number of unknowns.
    #[must_use]
    #[inline]
    pub fn first_unknown(self, node: usize) -> usize {
        if node <= self.places { 3 * node } else { 2 * self.places + node }
    }
}

impl From<usize> for Nodes {
    /// Nodes that all have a place.
    fn from(places: usize) -> Self {
        Self { places, numbers: 0 }
    }
}

/// The sparsity of a set of terms, and where each stencil's blocks go.
#[derive(Clone, Debug)]
pub struct Assembler {
    nodes: Nodes,
    pattern: SparsityPattern,
    /// Start of each node's block column in `block_rows`, [nodes + 1].
    block_starts: Vec<u32>,
    block_rows: Vec<u32>,
    /// Of the stencils at hand: one, or a chunk where there are several threads.
    evaluations: Vec<Evaluation>,
    /// The nodes for which derivatives are wanted; empty: for all.
    share: Vec<bool>,
}

/// One stencil's part of the sums.
#[derive(Clone, Debug, Default)]
struct Evaluation {
    x: Vec<Vec3>,
    local: LocalDerivatives,
    /// None where the stencil is not active.
    energy: Option<Result<f64, Inadmissible>>,
}

/// What is asked of a stencil.
#[derive(Clone, Copy, PartialEq)]
enum Order {
    Energy,
    Gradient,
    Hessian,
}

/// For each stencil of a term, the position of its lower blocks within their block columns: in blocks for nodes with a place, in
/// rows for numbers.
#[derive(Clone, Debug, Default)]
pub struct Slots(Vec<Vec<u32>>);

impl Assembler {
    /// The union of the stencils of all terms over `nodes`.
    #[must_use]
    pub fn new(nodes: impl Into<Nodes>, terms: &[&dyn Term]) -> Self {
        Self::of_stencils(nodes.into(), terms.iter().flat_map(|term| term.stencils()))
    }

    /// The union of `stencils` (each ascending) over `nodes`.
    pub(super) fn of_stencils<'a>(
        nodes: Nodes,
        stencils: impl Iterator<Item = &'a Vec<u32>>,
    ) -> Self {
        let mut columns: Vec<Vec<u32>> = (0..nodes.count() as u32).map(|v| vec![v]).collect();
        for stencil in stencils {
            for (j, &column) in stencil.iter().enumerate() {
                columns[column as usize].extend_from_slice(&stencil[j..]);
            }
        }
        let mut block_starts = vec![0];
        let mut block_rows = Vec::new();
        let mut column_starts = vec![0];
        let mut row_indices = Vec::new();
        let unknowns = |node: usize| nodes.first_unknown(node)..nodes.first_unknown(node + 1);
        for (node, column) in columns.iter_mut().enumerate() {
            column.sort_unstable();
            column.dedup();
            block_rows.extend_from_slice(column);
            block_starts.push(block_rows.len() as u32);
            for _ in unknowns(node) {
                let rows = column.iter().flat_map(|&v| unknowns(v as usize));
                row_indices.extend(rows.map(|row| row as u32));
                column_starts.push(row_indices.len() as u32);
            }
        }
        Self {
            nodes,
            pattern: SparsityPattern { column_starts, row_indices },
            block_starts,
            block_rows,
            evaluations: vec![Evaluation::default()],
            share: Vec::new(),
        }
    }

    /// The nodes over which it sums.
    #[must_use]
    pub fn nodes(&self) -> Nodes {
        self.nodes
    }

    /// From now on, derivatives leave out stencils without a node whose unknowns are in `share [unknowns]`.
    pub fn set_share(&mut self, share: Option<&[bool]>) {
        let nodes = 0..self.nodes.count();
        self.share.clear();
        if let Some(share) = share {
            self.share.extend(nodes.map(|node| share[self.nodes.first_unknown(node)]));
        }
    }

    /// The stored entries of the tangent.
    #[must_use]
    pub fn pattern(&self) -> &SparsityPattern {
        &self.pattern
    }

    /// Where the blocks of `term`'s stencils are stored.
    ///
    /// # Panics
    /// When the term was not among those that made the assembler.
    #[must_use]
    pub fn slots(&self, term: &dyn Term) -> Slots {
        let place = |column: u32, row: u32| {
            let rows = &self.block_rows[self.block_range(column)];
            let found = rows.binary_search(&row);
            let block = found.expect("the pattern holds every stencil's pairs");
            let places = |rows: &[u32]| rows.partition_point(|&v| (v as usize) < self.nodes.places);
            let row = if (row as usize) < self.nodes.places { 0 } else { 2 * places(rows) };
            (block + row) as u32
        };
        let stencil_slots = |stencil: &Vec<u32>| {
            let pairs = stencil.iter().enumerate();
            pairs.flat_map(|(j, &c)| stencil[j..].iter().map(move |&r| place(c, r))).collect()
        };
        Slots(term.stencils().iter().map(stencil_slots).collect())
    }

    /// The energy of `term` at `positions`, mJ.
    ///
    /// # Errors
    /// [`Inadmissible`] where a stencil's energy is not defined.
    pub fn energy(&mut self, term: &dyn Term, positions: &[Vec3]) -> Result<f64, Inadmissible> {
        self.for_each_chunk(term, positions, Order::Energy, |_, _, _| ())
    }

    /// Adds the gradient of `term` to `residual`, and its Hessian to `tangent` where given; returns its energy.
    ///
    /// A gradient alone needs no slots.
    ///
    /// # Errors
    /// [`Inadmissible`] where a stencil's energy is not defined.
    pub fn add(
        &mut self,
        term: &dyn Term,
        slots: &Slots,
        positions: &[Vec3],
        residual: &mut [f64],
        mut tangent: Option<&mut [f64]>,
    ) -> Result<f64, Inadmissible> {
        let order = if tangent.is_some() { Order::Hessian } else { Order::Gradient };
        self.for_each_chunk(term, positions, order, |assembler, first, evaluations| {
            let chunk = Chunk {
                nodes: assembler.nodes,
                starts: &assembler.pattern.column_starts,
                stencils: &term.stencils()[first..],
                slots: slots.0.get(first..).unwrap_or_default(),
                evaluations,
            };
            let nodes = assembler.nodes.count();
            let tangent = tangent.as_deref_mut();
            let target = Target { nodes: 0..nodes, residual: &mut *residual, tangent };
            if evaluations.len() == 1 {
                chunk.add_to(target);
            } else {
                let least = nodes / (RANGES_OF_A_THREAD * rayon::current_num_threads());
                chunk.add_in_parallel(target, least.max(1));
            }
        })
    }

    /// Evaluates the stencils of `term` chunk by chunk, in order, and calls `finish` with each chunk's first stencil and
    /// its evaluations; returns the sum of the energies.
    fn for_each_chunk(
        &mut self,
        term: &dyn Term,
        positions: &[Vec3],
        order: Order,
        mut finish: impl FnMut(&Self, usize, &[Evaluation]),
    ) -> Result<f64, Inadmissible> {
        let stencils = term.stencils();
        let threads = rayon::current_num_threads();
        let alone = threads == 1 || stencils.len() < 2 * LEAST_FOR_A_THREAD;
        let size = if alone { 1 } else { (CHUNK_OF_A_THREAD * threads).min(stencils.len()) };
        let mut evaluations = std::mem::take(&mut self.evaluations);
        evaluations.resize_with(size.max(evaluations.len()), Evaluation::default);
        let mut sum = Ok(0.0);
        for first in (0..stencils.len()).step_by(size) {
            let chunk = &mut evaluations[..size.min(stencils.len() - first)];
            let evaluate = |(k, evaluation): (usize, &mut Evaluation)| {
                if order == Order::Energy || self.shares(&stencils[first + k]) {
                    evaluation.evaluate(term, first + k, positions, order);
                } else {
                    evaluation.energy = None;
                }
            };
            if alone {
                evaluate((0, &mut chunk[0]));
            } else {
                chunk
                    .par_iter_mut()
                    .enumerate()
                    .with_min_len(LEAST_FOR_A_THREAD)
                    .for_each(evaluate);
            }
            let energies = chunk.iter().filter_map(|evaluation| evaluation.energy);
            sum = energies.fold(sum, |sum, energy| Ok(sum? + energy?));
            if sum.is_err() {
                break;
            }
            finish(self, first, chunk);
        }
        self.evaluations = evaluations;
        sum
    }

    /// Whether a node of `stencil` is in the share.
    fn shares(&self, stencil: &[u32]) -> bool {
        self.share.is_empty() || stencil.iter().any(|&node| self.share[node as usize])
    }

    fn block_range(&self, column: u32) -> Range<usize> {
        let column = column as usize;
        self.block_starts[column] as usize..self.block_starts[column + 1] as usize
    }
}

impl Evaluation {
    fn evaluate(&mut self, term: &dyn Term, s: usize, positions: &[Vec3], order: Order) {
        self.energy = term.is_active(s, positions).then(|| {
            let stencil = &term.stencils()[s];
            self.x.clear();
            self.x.extend(stencil.iter().map(|&node| positions[node as usize]));
            if order == Order::Energy {
                return term.energy(s, &self.x);
            }
            self.local.reset(stencil.len(), order == Order::Hessian);
            term.derivatives(s, &self.x, &mut self.local)
        });
    }
}

/// Evaluated stencils.
#[derive(Clone, Copy)]
struct Chunk<'a> {
    nodes: Nodes,
    starts: &'a [u32],
    stencils: &'a [Vec<u32>],
    slots: &'a [Vec<u32>],
    evaluations: &'a [Evaluation],
}

/// The unknowns of successive nodes, and their columns.
struct Target<'a> {
    nodes: Range<usize>,
    residual: &'a mut [f64],
    tangent: Option<&'a mut [f64]>,
}

impl Chunk<'_> {
    /// Adds what concerns the target's nodes; halves of it side by side while it has more than `least` nodes.
    fn add_in_parallel(self, target: Target<'_>, least: usize) {
        if target.nodes.len() <= least {
            return self.add_to(target);
        }
        let (before, after) = self.split(target);
        rayon::join(|| self.add_in_parallel(before, least), || self.add_in_parallel(after, least));
    }

    /// The first half of the target's nodes, and the others.
    fn split<'a>(&self, target: Target<'a>) -> (Target<'a>, Target<'a>) {
        let Target { nodes: Range { start, end }, residual, tangent } = target;
        let middle = start + (end - start) / 2;
        let [first, middle_unknown] = [start, middle].map(|node| self.nodes.first_unknown(node));
        let (before, after) = residual.split_at_mut(middle_unknown - first);
        let stored = self.starts[middle_unknown] - self.starts[first];
        let (left, right) = tangent.map(|t| t.split_at_mut(stored as usize)).unzip();
        (
            Target { nodes: start..middle, residual: before, tangent: left },
            Target { nodes: middle..end, residual: after, tangent: right },
        )
    }

    fn add_to(self, mut target: Target<'_>) {
        for (k, (evaluation, stencil)) in self.evaluations.iter().zip(self.stencils).enumerate() {
            if evaluation.energy.is_some() {
                let slots = self.slots.get(k).map_or(&[][..], Vec::as_slice);
                self.add(&mut target, &evaluation.local, stencil, slots);
            }
        }
    }

    #[inline]
    fn add(
        &self,
        target: &mut Target<'_>,
        local: &LocalDerivatives,
        stencil: &[u32],
        slots: &[u32],
    ) {
        let first = self.nodes.first_unknown(target.nodes.start);
        // Stencils ascend.
        let own = stencil.partition_point(|&node| (node as usize) < target.nodes.start);
        let places = stencil.partition_point(|&node| (node as usize) < self.nodes.places);
        for (j, &node) in stencil.iter().enumerate().skip(own) {
            let node = node as usize;
            if node >= target.nodes.end {
                break;
            }
            let [begin, end] = [node, node + 1].map(|node| self.nodes.first_unknown(node));
            let own = &mut target.residual[begin - first..end - first];
            for (sum, value) in own.iter_mut().zip(&local.gradient()[j]) {
                *sum += value;
            }
            if let Some(tangent) = target.tangent.as_deref_mut() {
                let [begin, end] = [begin, end]
                    .map(|unknown| (self.starts[unknown] - self.starts[first]) as usize);
                let blocks = local.column(j);
                let before = local.column_start(j);
                let slots = &slots[before..before + blocks.len()];
                let column = &mut tangent[begin..end];
                let (placed, numbers) = blocks.split_at(places.saturating_sub(j));
                let (placed_slots, number_slots) = slots.split_at(placed.len());
                if j < places {
                    add_column(column, placed, placed_slots);
                    add_rows(column, numbers, number_slots);
                } else {
                    for (block, &slot) in numbers.iter().zip(number_slots) {
                        column[slot as usize] += block[(0, 0)];
                    }
                }
            }
        }
    }
}

/// Adds blocks at their places in a column of blocks.
#[inline]
fn add_column(column: &mut [f64], blocks: &[Block], slots: &[u32]) {
    let height = column.len() / 3;
    let (first, others) = column.split_at_mut(height);
    let (second, third) = others.split_at_mut(height);
    let [first, second, third] = [first, second, third].map(|c| c.as_chunks_mut::<3>().0);
    for (block, &slot) in blocks.iter().zip(slots) {
        let [one, two, three] = block.columns();
        add_to(&mut first[slot as usize], one);
        add_to(&mut second[slot as usize], two);
        add_to(&mut third[slot as usize], three);
    }
}

/// Adds the first row of blocks at their places in a column of blocks.
#[inline]
fn add_rows(column: &mut [f64], blocks: &[Block], slots: &[u32]) {
    let height = column.len() / 3;
    for (block, &slot) in blocks.iter().zip(slots) {
        for (k, of_column) in block.columns().iter().enumerate() {
            column[k * height + slot as usize] += of_column[0];
        }
    }
}

#[inline]
fn add_to(sum: &mut [f64; 3], values: &[f64; 4]) {
    *sum = [sum[0] + values[0], sum[1] + values[1], sum[2] + values[2]];
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::material::{Material, NeoHookean};
    use crate::model::test_shells::TestShell;

    /// Everything that the assembler makes of a wall, by `threads` threads.
    fn sums(shell: &TestShell, threads: usize) -> (f64, f64, Vec<f64>, Vec<f64>, Vec<f64>) {
        let wall = shell.wall(Material::NeoHookean(NeoHookean { mu: 1.3 }));
        let mut assembler = Assembler::new(shell.deformed.len(), &[&wall]);
        let slots = assembler.slots(&wall);
        let [mut residual, mut alone] = [0, 0].map(|_| vec![0.0; 3 * shell.deformed.len()]);
        let mut tangent = vec![0.0; assembler.pattern().stored()];
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let x = &shell.deformed;
        let (energy, same) = pool.install(|| {
            let energy = assembler.energy(&wall, x).unwrap();
            let same = assembler.add(&wall, &slots, x, &mut alone, None).unwrap();
            let tangent = Some(tangent.as_mut_slice());
            assert_eq!(assembler.add(&wall, &slots, x, &mut residual, tangent), Ok(same));
            assert!(threads == 1 || assembler.evaluations.len() > 1);
            (energy, same)
        });
        (energy, same, residual, alone, tangent)
    }

    #[test]
    fn bits_do_not_depend_on_the_number_of_threads() {
        for seed in 0..2 {
            let shell = TestShell::new(seed);
            let serial = sums(&shell, 1);
            assert!(serial.2 == serial.3 && serial.4.iter().any(|&entry| entry != 0.0));
            for threads in [2, 3] {
                assert!(sums(&shell, threads) == serial, "{threads} threads");
            }
        }
    }

    /// Where a wall is undefined at several stencils, the first one speaks, whoever evaluated it.
    #[test]
    fn inadmissible_states_do_not_depend_on_the_number_of_threads() {
        let mut shell = TestShell::new(0);
        let wall = shell.wall(Material::NeoHookean(NeoHookean { mu: 1.3 }));
        for &node in &wall.stencils()[70] {
            shell.deformed[node as usize] = Vec3::zeros();
        }
        let x = &shell.deformed;
        let energies = [1, 2, 3].map(|threads| {
            let mut assembler = Assembler::new(x.len(), &[&wall]);
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| assembler.energy(&wall, x))
        });
        assert!(energies[0].is_err() && energies == [energies[0]; 3], "{energies:?}");
    }
}
