//! What a wall bears at a point of its middle and at its faces, for pictures.
//!
//! ```text
//! G(Z) = A - 2 Z B + Z^2 C      g(Z) = a - 2 z b + z^2 c,   z = l3 Z      Z = -h/2, 0, h/2
//! s_i  = 2 (l_i^2 psi_T + J psi_J) / (l1 l2 l3)          von Mises: sqrt(s1^2 - s1 s2 + s2^2)
//! ```
//!
//! Stresses are Cauchy's, of layers in plane stress. The metrics are those that the element's energy has: where a fold is softened at
//! rest, the faces are the outermost layers that still bend.

use super::kinematics::{Form, det, third_form};
use super::wall_point::{bending_depth, least_shifter};
use crate::mesh::SectionPoint;
use crate::model::material::Material;
use crate::model::membrane::PlaneState;
use crate::model::system::Inadmissible;

/// The state of a shell's wall in a triangle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ShellState {
    /// Principal stretches of the middle, the larger first, and the stretch across the wall.
    pub stretches: [f64; 3],
    /// Thickness of the wall now, mm.
    pub thickness: f64,
    /// Principal Cauchy stresses in the middle, the larger first, MPa.
    pub stresses: [f64; 2],
    /// Von Mises' stress at the inner face, in the middle, and at the outer face, MPa.
    pub von_mises: [f64; 3],
}

impl ShellState {
    /// Of a wall of `thickness` (mm) and `material` with the fundamental forms `rest` and `now`.
    pub(super) fn new(
        rest: [Form; 2],
        now: [Form; 2],
        thickness: f64,
        material: &Material,
    ) -> Self {
        let (middle, [inner, outer]) = middle_and_faces(rest, now, thickness, material);
        let [_, _, l3] = middle.stretches;
        Self {
            stretches: middle.stretches,
            thickness: thickness * l3,
            stresses: middle.stresses,
            von_mises: [inner.von_mises(), middle.von_mises(), outer.von_mises()],
        }
    }

    /// The mean of the `states` of a triangle's points.
    fn mean(states: &[Self]) -> Self {
        let share = 1.0 / states.len() as f64;
        let mut mean = Self::default();
        for state in states {
            let add = |sum: &mut [f64], of: &[f64]| {
                sum.iter_mut().zip(of).for_each(|(sum, of)| *sum += share * of);
            };
            add(&mut mean.stretches, &state.stretches);
            add(&mut mean.stresses, &state.stresses);
            add(&mut mean.von_mises, &state.von_mises);
            mean.thickness += share * state.thickness;
        }
        mean
    }
}

/// A face of a shell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Face {
    /// Behind the normal: of a closed part the one towards the chamber.
    Inner,
    /// The other.
    Outer,
}

/// The largest stretch and stress at a point of a shell's face, or within a solid's cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PeakState {
    /// The triangle, or the cell.
    pub place: usize,
    /// By its place in the list of materials.
    pub material: u16,
    /// Of a shell.
    pub face: Option<Face>,
    /// The largest principal stretch.
    pub stretch: f64,
    /// The largest principal nominal stress (first Piola and Kirchhoff), at least 0, MPa.
    pub nominal_stress: f64,
}

impl PeakState {
    /// Of both faces of the wall of a triangle, `place`, of `thickness` (mm) and `material`, with the fundamental forms `rest` and `now`.
    pub(super) fn of_faces(
        place: usize,
        section: SectionPoint,
        [rest, now]: [[Form; 2]; 2],
        material: &Material,
    ) -> [Self; 2] {
        let (_, [inner, outer]) = middle_and_faces(rest, now, section.thickness, material);
        [(Face::Inner, inner), (Face::Outer, outer)].map(|(face, state)| Self {
            place,
            material: section.material,
            face: Some(face),
            stretch: state.stretches[0],
            nominal_stress: state.largest_nominal_stress(),
        })
    }
}

/// The states of the middle, and of the inner and the outer face.
fn middle_and_faces(
    rest: [Form; 2],
    now: [Form; 2],
    thickness: f64,
    material: &Material,
) -> (PlaneState, [PlaneState; 2]) {
    let middle = PlaneState::new(material, rest[0], now[0]);
    let [_, _, l3] = middle.stretches;
    let depth = bending_depth(rest, thickness);
    // A face that a sharp fold has turned inside out has no metric; then the outermost layer of quadrature stands for it.
    let at_face = least_face(now, depth * thickness * l3) > 0.0;
    let half = 0.5 * depth * thickness * if at_face { 1.0 } else { OUTERMOST_LAYER };
    let face = |z: f64| PlaneState::new(material, layer(rest, z), layer(now, z * l3));
    (middle, [face(-half), face(half)])
}

/// The states of triangles, each the mean of its points' `state`; they have as many points as `counts` says, one after the other.
///
/// # Errors
/// [`Inadmissible`] where an element has collapsed.
pub(super) fn states_of_triangles(
    counts: &[u8],
    state: impl Fn(usize) -> Result<ShellState, Inadmissible>,
) -> Result<Vec<ShellState>, Inadmissible> {
    let mut next = 0;
    let of_triangle = |count: &u8| {
        let points = next..next + usize::from(*count);
        next = points.end;
        Ok(ShellState::mean(&points.map(&state).collect::<Result<Vec<_>, _>>()?))
    };
    counts.iter().map(of_triangle).collect()
}

/// Gauss' outermost layer of three, over half the thickness.
const OUTERMOST_LAYER: f64 = 0.774_596_669_241_483_4;

/// As [`least_shifter`], at the faces.
fn least_face(forms: [Form; 2], thickness: f64) -> f64 {
    least_shifter(forms, thickness / OUTERMOST_LAYER)
}

fn layer([a, b]: [Form; 2], z: f64) -> Form {
    let c = third_form(a, b, det(a));
    std::array::from_fn(|k| a[k] - 2.0 * z * b[k] + z * z * c[k])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::material::NeoHookean;

    /// A cylinder of radius `R` opened out to the radius `r` at constant length: the layer at `Z` goes from `R + Z` to `r + l3 Z`.
    /// Closed form; rounding alone differs.
    #[test]
    fn faces_of_a_widened_cylinder() {
        let (radius, now, thickness, mu) = (5.0, 7.0, 0.8, 0.3);
        let material = Material::NeoHookean(NeoHookean { mu });
        // Around by the angle and along by the length; b = x,11 . n = -r.
        let forms = |r: f64| [[r * r, 1.0, 0.0], [-r, 0.0, 0.0]];
        let state = ShellState::new(forms(radius), forms(now), thickness, &material);
        let l3 = radius / now;
        for (value, exact) in state.stretches.iter().zip([now / radius, 1.0, l3]) {
            assert!((value - exact).abs() < 1e-14, "{state:?}");
        }
        assert!((state.thickness - thickness * l3).abs() < 1e-14);
        for (value, z) in state.von_mises.iter().zip([-0.4, 0.0, 0.4]) {
            let l1: f64 = (now + l3 * z) / (radius + z);
            let across = 1.0 / (l1 * l1);
            let [s1, s2] = [mu * (l1 * l1 - across), mu * (1.0 - across)];
            let exact = (s1 * s1 - s1 * s2 + s2 * s2).sqrt();
            assert!((value / exact - 1.0).abs() < 1e-13, "{value} {exact}");
        }
        // P_1 = J s_1 / l_1, and nothing changes its volume: the larger of both ways is that around.
        let section = SectionPoint { thickness, material: 3 };
        let states = PeakState::of_faces(7, section, [forms(radius), forms(now)], &material);
        for (state, z) in states.iter().zip([-0.4, 0.4]) {
            let l1: f64 = (now + l3 * z) / (radius + z);
            assert!((state.stretch - l1).abs() < 1e-14, "{state:?} {l1}");
            let exact = mu * (l1 - l1.powi(-3));
            assert!((state.nominal_stress / exact - 1.0).abs() < 1e-13, "{state:?} {exact}");
            assert_eq!((state.place, state.material), (7, 3));
        }
        assert_eq!(states.map(|state| state.face), [Some(Face::Inner), Some(Face::Outer)]);
    }
}
