//! From stencils to the global gradient and Hessian.
//!
//! Three unknowns for each node; the tangent's lower triangle by columns in 3x3 blocks. A column of blocks is
//! stored as three columns of equal length, so that the place of a block follows from two numbers.

use super::local::{LocalDerivatives, Term};
use super::system::{Inadmissible, SparsityPattern};
use crate::math::Vec3;

/// The sparsity of a set of terms, and where each stencil's blocks go.
#[derive(Clone, Debug)]
pub struct Assembler {
    pattern: SparsityPattern,
    /// Start of each node's block column in `block_rows`, [nodes + 1].
    block_starts: Vec<u32>,
    block_rows: Vec<u32>,
    local: LocalDerivatives,
    gathered: Vec<Vec3>,
}

/// For each stencil of a term, the position of its lower blocks within their block columns.
#[derive(Clone, Debug, Default)]
pub struct Slots(Vec<Vec<u32>>);

impl Assembler {
    /// The union of the stencils of all terms over `nodes` nodes.
    #[must_use]
    pub fn new(nodes: usize, terms: &[&dyn Term]) -> Self {
        let mut columns: Vec<Vec<u32>> = (0..nodes as u32).map(|v| vec![v]).collect();
        let mut largest = 0;
        for stencil in terms.iter().flat_map(|term| term.stencils()) {
            largest = largest.max(stencil.len());
            for (j, &column) in stencil.iter().enumerate() {
                columns[column as usize].extend_from_slice(&stencil[j..]);
            }
        }
        let mut block_starts = vec![0];
        let mut block_rows = Vec::new();
        let mut column_starts = vec![0];
        let mut row_indices = Vec::new();
        for column in &mut columns {
            column.sort_unstable();
            column.dedup();
            block_rows.extend_from_slice(column);
            block_starts.push(block_rows.len() as u32);
            for _ in 0..3 {
                row_indices.extend(column.iter().flat_map(|&v| [3 * v, 3 * v + 1, 3 * v + 2]));
                column_starts.push(row_indices.len() as u32);
            }
        }
        Self {
            pattern: SparsityPattern { column_starts, row_indices },
            block_starts,
            block_rows,
            local: LocalDerivatives::with_capacity(largest),
            gathered: vec![Vec3::zeros(); largest],
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
            let range = self.block_range(column);
            let found = self.block_rows[range].binary_search(&row);
            found.expect("the pattern holds every stencil's pairs") as u32
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
        let mut energy = 0.0;
        for (s, stencil) in term.stencils().iter().enumerate() {
            if term.is_active(s, positions) {
                energy += term.energy(s, gather(&mut self.gathered, stencil, positions))?;
            }
        }
        Ok(energy)
    }

    /// Adds the gradient of `term` to `residual`, and its Hessian to `tangent` where given; returns its energy.
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
        let mut energy = 0.0;
        for (s, stencil) in term.stencils().iter().enumerate() {
            if !term.is_active(s, positions) {
                continue;
            }
            self.local.reset(stencil.len(), tangent.is_some());
            let x = gather(&mut self.gathered, stencil, positions);
            energy += term.derivatives(s, x, &mut self.local)?;
            for (&node, gradient) in stencil.iter().zip(self.local.gradient()) {
                let start = 3 * node as usize;
                for (sum, value) in residual[start..start + 3].iter_mut().zip(gradient) {
                    *sum += value;
                }
            }
            if let Some(tangent) = tangent.as_deref_mut() {
                self.scatter(stencil, &slots.0[s], tangent);
            }
        }
        Ok(energy)
    }

    fn scatter(&self, stencil: &[u32], slots: &[u32], tangent: &mut [f64]) {
        let mut slots = slots.iter();
        for (j, &node) in stencil.iter().enumerate() {
            let column = 3 * node as usize;
            let starts: [usize; 3] =
                std::array::from_fn(|c| self.pattern.column_starts[column + c] as usize);
            for (i, &slot) in (j..stencil.len()).zip(&mut slots) {
                let block = self.local.block(i, j);
                for (c, start) in starts.iter().enumerate() {
                    let entry = start + 3 * slot as usize;
                    for (sum, value) in
                        tangent[entry..entry + 3].iter_mut().zip(block.column(c).iter())
                    {
                        *sum += value;
                    }
                }
            }
        }
    }

    fn block_range(&self, column: u32) -> std::ops::Range<usize> {
        let column = column as usize;
        self.block_starts[column] as usize..self.block_starts[column + 1] as usize
    }
}

fn gather<'a>(gathered: &'a mut [Vec3], stencil: &[u32], positions: &[Vec3]) -> &'a [Vec3] {
    for (x, &node) in gathered.iter_mut().zip(stencil) {
        *x = positions[node as usize];
    }
    &gathered[..stencil.len()]
}
