//! What a lid without stiffness adds to the volume of a chamber: a fan from the middle of its rim.
//!
//! ```text
//! V = c . S       c = sum_i w_i x_i       S = sum_chords f / 6 (a x b)
//! dV/dx_j = w_j S + D_j^T c       d2V/dx_i dx_j = w_i D_j + w_j D_i^T - f / 6 [c]x (chord i, j)       D_j = dS/dx_j
//! ```
//!
//! `c` is the centroid of the rim at rest, and its weights `w` stay with the corners: the fan's middle moves as the rim does on the whole, and
//! what presses on the lid is passed on to the rim evenly along its length. Force and moment are those of the pressure on the lid,
//! whatever the rim does. Chords join corners by their midpoint, with four thirds, and without, with less one third, as the
//! chamber's facets do.

use crate::math::Vec3;

/// A lid within its rim.
#[derive(Clone, Debug)]
pub(in crate::model) struct LidFan {
    /// Nodes of the rim, ascending.
    pub(super) nodes: Vec<u32>,
    /// Of each node in [`Self::nodes`], its weight in the middle.
    weights: Vec<f64>,
    /// Places in [`Self::nodes`] of the ends of chords, and their factor.
    chords: Vec<([usize; 2], f64)>,
}

impl LidFan {
    /// The lid whose `rim` has corners and midpoints in turn, at `positions` (mm) at rest.
    ///
    /// # Panics
    /// When the rim has not as many midpoints as corners.
    #[must_use]
    pub(in crate::model) fn new(rim: &[u32], positions: &[Vec3]) -> Self {
        assert!(rim.len().is_multiple_of(2), "corners and midpoints");
        let mut nodes = rim.to_vec();
        nodes.sort_unstable();
        nodes.dedup();
        let place = |k: usize| nodes.partition_point(|&node| node < rim[k % rim.len()]);
        let at = |k: usize| positions[rim[k % rim.len()] as usize];
        let (mut weights, mut chords) = (vec![0.0; nodes.len()], Vec::new());
        for a in (0..rim.len()).step_by(2) {
            let length = (at(a + 2) - at(a)).norm();
            weights[place(a)] += length;
            weights[place(a + 2)] += length;
            chords.push(([place(a), place(a + 1)], 4.0 / 3.0));
            chords.push(([place(a + 1), place(a + 2)], 4.0 / 3.0));
            chords.push(([place(a), place(a + 2)], -1.0 / 3.0));
        }
        let total: f64 = weights.iter().sum();
        weights.iter_mut().for_each(|weight| *weight /= total);
        Self { nodes, weights, chords }
    }

    /// Its middle, and six times its share of the area vector.
    fn middle_and_area(&self, x: &[Vec3]) -> (Vec3, Vec3) {
        let middle = self.weights.iter().zip(x).map(|(w, x)| *w * x).sum();
        let area = self.chords.iter().map(|&([a, b], f)| f / 6.0 * x[a].cross(&x[b])).sum();
        (middle, area)
    }

    /// The volume between the lid and the origin for nodes at `x`, mm^3.
    pub(super) fn volume(&self, x: &[Vec3]) -> f64 {
        let (middle, area) = self.middle_and_area(x);
        middle.dot(&area)
    }

    /// Its gradient, one vector for each node, mm^2.
    pub(super) fn gradient(&self, x: &[Vec3]) -> Vec<Vec3> {
        let (middle, area) = self.middle_and_area(x);
        let mut gradient: Vec<Vec3> = self.weights.iter().map(|w| *w * area).collect();
        for &([a, b], f) in &self.chords {
            gradient[a] += f / 6.0 * x[b].cross(&middle);
            gradient[b] += f / 6.0 * middle.cross(&x[a]);
        }
        gradient
    }

    /// Gives the axes `a` of the skew blocks `d2V/dx_i dx_j = [a]x` of nodes `i >= j`, mm.
    pub(super) fn hessian_axes(&self, x: &[Vec3], mut add: impl FnMut(usize, usize, Vec3)) {
        let (middle, _) = self.middle_and_area(x);
        let mut turns = vec![Vec3::zeros(); x.len()];
        for &([a, b], f) in &self.chords {
            turns[a] -= f / 6.0 * x[b];
            turns[b] += f / 6.0 * x[a];
            let axis = -f / 6.0 * middle;
            if a >= b {
                add(a, b, axis);
            } else {
                add(b, a, -axis);
            }
        }
        for j in 0..x.len() {
            for i in j..x.len() {
                let axis = self.weights[i] * turns[j] - self.weights[j] * turns[i];
                if axis != Vec3::zeros() {
                    add(i, j, axis);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Isometry3;

    use super::*;
    use crate::model::load::ChamberPressure;
    use crate::model::term_suite::{Case, term_suite};
    use crate::model::test_shells::TestShell;

    /// Two lids over rims of nodes here and there of a deformed egg.
    fn lidded(shell: &TestShell) -> Case<ChamberPressure> {
        let rims: [&[u32]; 2] = [&[3, 9, 1, 17, 12, 5], &[2, 30, 28, 7, 11, 0, 21, 25]];
        let lids = rims.map(|rim| LidFan::new(rim, &shell.deformed)).to_vec();
        let mut term = ChamberPressure::new(&[]).with_lids(lids);
        term.pressure = 0.03;
        Case { term, positions: shell.deformed.clone(), motion: Isometry3::identity() }
    }

    term_suite!(lids, lidded);

    /// A square of 2 x 2 mm about the z axis at a height of 3 mm: a pyramid's volume and its rate with the height, shared evenly among
    /// corners and among midpoints.
    #[test]
    fn a_square_lid_shares_its_area_evenly() {
        let ring =
            [[-1., -1.], [0., -1.], [1., -1.], [1., 0.], [1., 1.], [0., 1.], [-1., 1.], [-1., 0.]];
        let x: Vec<Vec3> = ring.iter().map(|&[x, y]| Vec3::new(x, y, 3.0)).collect();
        let lid = LidFan::new(&[0, 1, 2, 3, 4, 5, 6, 7], &x);
        // Sums of a dozen exact numbers.
        assert!((lid.volume(&x) - 4.0).abs() < 1e-14);
        let gradient = lid.gradient(&x);
        for (k, share) in gradient.iter().enumerate() {
            assert!((share.z - gradient[(k + 2) % 8].z).abs() < 1e-14, "{gradient:?}");
        }
        let total: Vec3 = gradient.iter().sum();
        assert!((total - Vec3::new(0.0, 0.0, 4.0 / 3.0)).norm() < 1e-14, "{total}");
    }
}
