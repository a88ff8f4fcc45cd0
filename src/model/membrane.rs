//! What the middle of a deformed wall bears: its largest stretch and stress, for pictures.
//!
//! ```text
//! l1^2, l2^2 = eigenvalues of G^-1 g         G, g: metrics of a facet at rest and now, from its sides
//! sigma_i = l_i dpsi/dl_i / (l1 l2 l3)       psi in plane stress, so that the normal stress vanishes
//!         = (2 l_i^2 psi_T + 2 J psi_J) / (l1 l2 l3)
//! ```
//!
//! Facets are flat here and their stretch is constant, whatever element solved: bending is not seen.
//!
//! Source: Holzapfel (2000), Nonlinear Solid Mechanics, equation 6.47, for the principal stresses.

use super::material::Material;
use crate::math::Vec3;
use crate::surface::TriangleMesh;

/// The state of a wall's middle at one place.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MembraneState {
    /// The largest principal stretch.
    pub stretch: f64,
    /// The largest principal Cauchy stress, MPa.
    pub stress: f64,
}

/// The states `[vertex]` of a wall of `material` with the middle `reference` when its vertices are at `positions`: means of the
/// facets about each vertex, weighted by their areas at rest.
///
/// # Panics
/// When there are not as many positions as vertices.
#[must_use]
pub fn membrane_states<'a>(
    material: impl Fn(usize) -> &'a Material,
    reference: &TriangleMesh,
    positions: &[Vec3],
) -> Vec<MembraneState> {
    assert_eq!(positions.len(), reference.positions.len());
    let mut sums = vec![(0.0, MembraneState::default()); positions.len()];
    for (t, triangle) in reference.triangles.iter().enumerate() {
        let at_rest = triangle.map(|v| reference.positions[v as usize]);
        let now = triangle.map(|v| positions[v as usize]);
        let area = (at_rest[1] - at_rest[0]).cross(&(at_rest[2] - at_rest[0])).norm() / 2.0;
        if area == 0.0 {
            continue;
        }
        let state = state_of_facet(material(t), metric(at_rest), metric(now));
        for v in triangle {
            let (weight, sum) = &mut sums[*v as usize];
            *weight += area;
            sum.stretch += area * state.stretch;
            sum.stress += area * state.stress;
        }
    }
    let mean = |(weight, sum): (f64, MembraneState)| MembraneState {
        stretch: sum.stretch / weight,
        stress: sum.stress / weight,
    };
    sums.into_iter().map(mean).collect()
}

/// `(11, 22, 12)` of the metric that two sides of a facet span.
fn metric([a, b, c]: [Vec3; 3]) -> [f64; 3] {
    let [s, t] = [b - a, c - a];
    [s.dot(&s), t.dot(&t), s.dot(&t)]
}

fn state_of_facet(material: &Material, rest: [f64; 3], now: [f64; 3]) -> MembraneState {
    let PlaneState { stretches, stresses } = PlaneState::new(material, rest, now);
    MembraneState { stretch: stretches[0], stress: stresses[0] }
}

/// What a layer in plane stress bears.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PlaneState {
    /// Principal stretches in the layer, the larger first, and the one across it.
    pub(super) stretches: [f64; 3],
    /// Principal Cauchy stresses in the layer, the larger first, MPa.
    pub(super) stresses: [f64; 2],
}

impl PlaneState {
    /// Of a layer of `material` with the metrics `(11, 22, 12)` at `rest` and `now`.
    pub(super) fn new(material: &Material, rest: [f64; 3], now: [f64; 3]) -> Self {
        let det = |[a, b, c]: [f64; 3]| a * b - c * c;
        let row = |a: f64, b: f64| {
            [a * now[0] + b * now[2], a * now[2] + b * now[1]].map(|entry| entry / det(rest))
        };
        // G^-1 g; the difference of its eigenvalues from its entries, as that of their invariants cancels where they are equal.
        let [[a, b], [c, d]] = [row(rest[1], -rest[2]), row(-rest[2], rest[0])];
        let (trace, j) = (a + d, det(now) / det(rest));
        let square = 0.5 * trace + (0.25 * (a - d) * (a - d) + b * c).max(0.0).sqrt();
        let psi = material.density(trace, j);
        let l3 = material.thickness_stretch(trace, j).value;
        let volume = j.sqrt() * l3;
        let squares = [square, j / square];
        let stress = |square: f64| 2.0 * (square * psi.first[0] + j * psi.first[1]) / volume;
        let [l1, l2] = squares.map(f64::sqrt);
        Self { stretches: [l1, l2, l3], stresses: squares.map(stress) }
    }

    /// The largest principal nominal stress (first Piola and Kirchhoff), `J s_i / l_i`, at least 0, as nothing pulls across it; MPa.
    pub(super) fn largest_nominal_stress(&self) -> f64 {
        let [l1, l2, l3] = self.stretches;
        let [s1, s2] = self.stresses;
        (s1 * l2 * l3).max(s2 * l1 * l3).max(0.0)
    }

    /// Von Mises' stress, MPa.
    pub(super) fn von_mises(&self) -> f64 {
        let [s1, s2] = self.stresses;
        (s1 * s1 - s1 * s2 + s2 * s2).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::material::NeoHookean;

    /// A sheet in the plane of x and y, of two facets.
    fn sheet() -> TriangleMesh {
        let at = |x: f64, y: f64| Vec3::new(x, y, 0.0);
        TriangleMesh {
            positions: vec![at(0.0, 0.0), at(2.0, 0.0), at(2.5, 1.0), at(0.5, 1.0)],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
        }
    }

    /// `sigma_1 = mu (l1^2 - l3^2)` of an incompressible neo-Hookean sheet (Treloar 1975, chapter 4); rounding alone differs.
    #[test]
    fn stresses_are_those_of_the_books() {
        let material = Material::NeoHookean(NeoHookean { mu: 0.7 });
        for [l1, l2] in [[1.0, 1.0], [1.5, 1.5], [2.0, 1.0 / 2.0_f64.sqrt()], [0.9, 1.2]] {
            // Stretched along x and y, then turned about z, which changes nothing.
            let (sin, cos) = 0.6_f64.sin_cos();
            let moved = |x: &Vec3| {
                let [x, y] = [l1 * x.x, l2 * x.y];
                Vec3::new(cos * x - sin * y, sin * x + cos * y, 3.0)
            };
            let positions: Vec<Vec3> = sheet().positions.iter().map(moved).collect();
            let l3: f64 = 1.0 / (l1 * l2);
            let largest = l1.max(l2);
            for state in membrane_states(|_| &material, &sheet(), &positions) {
                assert!((state.stretch - largest).abs() < 1e-14, "{state:?}");
                let stress = 0.7 * (largest * largest - l3 * l3);
                assert!((state.stress - stress).abs() < 1e-13, "{state:?} {stress}");
            }
        }
    }
}
