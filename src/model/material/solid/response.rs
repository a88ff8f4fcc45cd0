//! How a law resists a change of shape.

use nalgebra::Matrix3;

/// How a law resists a change of shape at one deformation gradient.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolidResponse {
    /// `psi_iso`, MPa.
    pub energy: f64,
    /// The first Piola-Kirchhoff stress `P = d psi_iso / dF`, MPa.
    pub stress: Matrix3<f64>,
    /// `moduli[J][L](i, k) = d P_iJ / d F_kL`, MPa; `moduli[L][J]` is the transpose of `moduli[J][L]`.
    ///
    /// Zero unless they were asked for.
    pub moduli: [[Matrix3<f64>; 3]; 3],
}

/// The blocks of moduli on and below the diagonal.
pub(super) const LOWER: [[usize; 2]; 6] = [[0, 0], [1, 0], [1, 1], [2, 0], [2, 1], [2, 2]];

/// Fills the blocks above the diagonal.
#[inline]
pub(super) fn mirror(moduli: &mut [[Matrix3<f64>; 3]; 3]) {
    for [j, l] in [[1, 0], [2, 0], [2, 1]] {
        moduli[l][j] = moduli[j][l].transpose();
    }
}
