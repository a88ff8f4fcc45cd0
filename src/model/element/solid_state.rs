//! What the cells of a solid bear, for pictures.
//!
//! ```text
//! l_i^2 = eigenvalues of F^T F        sigma = P F^T / J        von Mises: sqrt(3/2 dev sigma : dev sigma)
//! ```
//!
//! Each value is the mean over a cell, by volume at rest.

use nalgebra::Matrix3;

use super::taylor_hood::TaylorHood;
use super::wall_state::PeakState;
use crate::math::Vec3;
use crate::mesh::TET_EDGES;
use crate::model::local::Term;

/// The state of a solid's cell.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SolidState {
    /// Principal stretches, the largest first.
    pub stretches: [f64; 3],
    /// Principal Cauchy stresses, the largest first, MPa.
    pub stresses: [f64; 3],
    /// Von Mises' stress, MPa.
    pub von_mises: f64,
    /// Volume over volume at rest.
    pub j: f64,
}

impl TaylorHood {
    /// What each cell bears where all nodes are at `x`, the pressures' unknowns after the places.
    #[must_use]
    pub fn states(&self, x: &[Vec3]) -> Vec<SolidState> {
        let of_cell = |(s, stencil): (usize, &Vec<u32>)| {
            let nodes: Vec<Vec3> = stencil.iter().map(|&v| x[v as usize]).collect();
            let (places, q) = nodes.split_at(10);
            let (mut volume, mut sum) = (0.0, SolidState::default());
            for (dv, f, stress) in self.states_at_points(s, places, q) {
                let squares = descending(&(f.transpose() * f));
                let principal = descending(&stress);
                let deviator = stress - Matrix3::identity() * (stress.trace() / 3.0);
                for k in 0..3 {
                    sum.stretches[k] += dv * squares[k].max(0.0).sqrt();
                    sum.stresses[k] += dv * principal[k];
                }
                sum.von_mises += dv * (1.5 * deviator.norm_squared()).sqrt();
                sum.j += dv * f.determinant();
                volume += dv;
            }
            SolidState {
                stretches: sum.stretches.map(|sum| sum / volume),
                stresses: sum.stresses.map(|sum| sum / volume),
                von_mises: sum.von_mises / volume,
                j: sum.j / volume,
            }
        };
        self.stencils().iter().enumerate().map(of_cell).collect()
    }

    /// The largest stretch and stress at each point of quadrature, where all nodes are at `x`, the pressures' unknowns after the places.
    ///
    /// Principal directions of stretch are those of stress: `P_i = J n_i . sigma n_i / l_i` with `F F^T n_i = l_i^2 n_i`.
    #[must_use]
    pub fn peaks(&self, x: &[Vec3]) -> Vec<PeakState> {
        let of_cell = |(s, stencil): (usize, &Vec<u32>)| {
            let nodes: Vec<Vec3> = stencil.iter().map(|&v| x[v as usize]).collect();
            let (places, q) = nodes.split_at(10);
            let peak = |(_, f, stress): (f64, Matrix3<f64>, Matrix3<f64>)| {
                let j = f.determinant();
                let stretched = (f * f.transpose()).symmetric_eigen();
                let mut state = PeakState {
                    place: s,
                    material: self.material(s),
                    face: None,
                    stretch: 0.0,
                    nominal_stress: 0.0,
                };
                for k in 0..3 {
                    let n = stretched.eigenvectors.column(k);
                    let l = stretched.eigenvalues[k].max(0.0).sqrt();
                    state.stretch = state.stretch.max(l);
                    state.nominal_stress = state.nominal_stress.max(j * n.dot(&(stress * n)) / l);
                }
                state
            };
            self.states_at_points(s, places, q).map(peak).collect::<Vec<_>>()
        };
        self.stencils().iter().enumerate().flat_map(of_cell).collect()
    }

    /// The ten nodes of each cell, in the order of [`crate::mesh::SolidMesh`].
    #[must_use]
    pub fn cells(&self) -> Vec<[u32; 10]> {
        self.tetrahedra().collect()
    }

    /// The pressure at each of `places` nodes where all nodes are at `x`, positive where it presses together, MPa: linear in each cell.
    #[must_use]
    pub fn pressures(&self, places: usize, x: &[Vec3]) -> Vec<f64> {
        let unit = self.pressure_unit();
        let mut pressures = vec![0.0; places];
        for nodes in self.tetrahedra() {
            let corner = |k: usize| -unit * x[places + nodes[k] as usize].x;
            for k in 0..4 {
                pressures[nodes[k] as usize] = corner(k);
            }
            for (k, [a, b]) in TET_EDGES.into_iter().enumerate() {
                pressures[nodes[4 + k] as usize] = 0.5 * (corner(a) + corner(b));
            }
        }
        pressures
    }
}

fn descending(symmetric: &Matrix3<f64>) -> [f64; 3] {
    let mut values: [f64; 3] = symmetric.symmetric_eigenvalues().into();
    values.sort_by(|a, b| b.total_cmp(a));
    values
}
