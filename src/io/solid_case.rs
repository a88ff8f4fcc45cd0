//! A clamped wall of quadratic tetrahedra under a rising pressure in its chamber: what another program is asked to solve.
//!
//! ```text
//! psi = psi_law(J^(-1/3) F) + kappa/2 (J - 1)^2        p(t) = t pressure,   t from 0 to 1
//! ```

use std::collections::HashMap;

use crate::mesh::SolidMesh;
use crate::model::material::{MooneyRivlin, NeoHookean, Ogden, Rubber, Yeoh};

/// A law that CalculiX and FEBio have too, so that a deck has a card for it.
#[derive(Clone, Debug, PartialEq)]
pub enum LawWithCard {
    /// [`NeoHookean`].
    NeoHookean(NeoHookean),
    /// [`MooneyRivlin`].
    MooneyRivlin(MooneyRivlin),
    /// [`Yeoh`].
    Yeoh(Yeoh),
    /// [`Ogden`].
    Ogden(Ogden),
}

/// A law of ours that CalculiX and FEBio do not have, by its name in files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "[material] law = \"{0}\" cannot be written into a deck: CalculiX and FEBio have no such law; they have neo-hookean, mooney-rivlin, yeoh and ogden"
)]
pub struct NoCard(pub &'static str);

impl TryFrom<&Rubber> for LawWithCard {
    type Error = NoCard;

    fn try_from(law: &Rubber) -> Result<Self, NoCard> {
        match law.clone() {
            Rubber::NeoHookean(law) => Ok(Self::NeoHookean(law)),
            Rubber::MooneyRivlin(law) => Ok(Self::MooneyRivlin(law)),
            Rubber::Yeoh(law) => Ok(Self::Yeoh(law)),
            Rubber::Ogden(law) => Ok(Self::Ogden(law)),
            // A law that is added to the list of rubbers needs no card.
            #[allow(unreachable_patterns, reason = "laws may be added")]
            _ => Err(NoCard(law.name())),
        }
    }
}

impl LawWithCard {
    /// Its name in the literature.
    #[must_use]
    pub fn in_words(&self) -> &'static str {
        match self {
            Self::NeoHookean(_) => "neo-Hooke",
            Self::MooneyRivlin(_) => "Mooney-Rivlin",
            Self::Yeoh(_) => "Yeoh",
            Self::Ogden(_) => "Ogden",
        }
    }
}

/// One load case. Nodes and cells are numbered from 1 in files, in the order of the mesh.
#[derive(Clone, Copy, Debug)]
pub struct SolidCase<'a> {
    /// One line about what it is.
    pub title: &'a str,
    /// The wall, mm.
    pub mesh: &'a SolidMesh,
    /// Its resistance to changes of shape.
    pub law: &'a LawWithCard,
    /// Its resistance to changes of volume, MPa.
    pub bulk_modulus: f64,
    /// Of the law with it, at rest.
    pub poisson_ratio: f64,
    /// Nodes that do not move, ascending.
    pub clamp: &'a [u32],
    /// Nodes whose mean displacement is the tip's, ascending.
    pub tip: &'a [u32],
    /// The largest pressure in the chamber, MPa; it follows the wall.
    pub pressure: f64,
    /// In how many equal parts of the pressure an answer is wanted.
    pub samples: usize,
}

/// Corners of the faces of a tetrahedron, seen from outside counter-clockwise about its first, second, ... face as Abaqus numbers them.
const TET_FACES: [[usize; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

impl SolidCase<'_> {
    /// The cells on the chamber by the number of their face there: each cell from 0, ascending.
    ///
    /// # Panics
    /// When a face of the chamber belongs to no cell.
    #[must_use]
    pub fn chamber_cells(&self) -> [Vec<u32>; 4] {
        let sorted = |mut corners: [u32; 3]| {
            corners.sort_unstable();
            corners
        };
        let mut owners = HashMap::new();
        for (cell, nodes) in (0..).zip(&self.mesh.tetrahedra) {
            for (face, corners) in TET_FACES.iter().enumerate() {
                owners.entry(sorted(corners.map(|k| nodes[k]))).or_insert((cell, face));
            }
        }
        let mut cells = [const { Vec::new() }; 4];
        for nodes in &self.mesh.chamber {
            let (cell, face) = owners[&sorted([nodes[0], nodes[1], nodes[2]])];
            cells[face].push(cell);
        }
        cells.iter_mut().for_each(|cells: &mut Vec<u32>| cells.sort_unstable());
        cells
    }

    /// The shares of the pressure at which an answer is wanted, the last one 1.
    pub(super) fn times(&self) -> impl Iterator<Item = f64> + use<> {
        let samples = self.samples;
        (1..=samples).map(move |sample| sample as f64 / samples as f64)
    }
}

/// Numbers that count from 0, as numbers that count from 1.
pub(super) fn list(items: &[u32]) -> String {
    let items: Vec<String> = items.iter().map(|item| (item + 1).to_string()).collect();
    items.join(",")
}

/// A number in at most 19 characters, of which CalculiX reads 20.
pub(super) fn number(value: f64) -> String {
    format!("{value:.11e}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;
    use crate::mesh::TET_EDGES;
    use crate::mesh::tetrahedra::test_walls::{of_prisms, spheres};
    use crate::model::material::example_rubbers;

    /// Each law of ours has a card, and is among those that the refusal names, or is refused by its name.
    #[test]
    fn laws_have_a_card_or_are_refused() {
        for law in example_rubbers() {
            let name = law.name();
            let line = NoCard(name).to_string();
            let is_known = line.matches(name).count() > 1;
            assert_eq!(LawWithCard::try_from(&law).err(), (!is_known).then_some(NoCard(name)));
        }
    }

    /// Faces are named so that their normals leave the tetrahedron.
    #[test]
    fn faces_look_outwards() {
        let corners = [Vec3::zeros(), Vec3::x(), Vec3::y(), Vec3::z()];
        let centre = 0.25 * corners.iter().sum::<Vec3>();
        for face in TET_FACES {
            let [a, b, c] = face.map(|k| corners[k]);
            assert!((b - a).cross(&(c - a)).dot(&(a - centre)) > 0.0, "{face:?}");
        }
    }

    /// Seen from its cell, each face of the chamber is the one that it is in the list: no other has its corners.
    #[test]
    fn chamber_faces_are_found_in_their_cells() {
        let mesh = SolidMesh::straight(&of_prisms(&spheres(10.0, 8.0, 1)));
        let law = LawWithCard::NeoHookean(NeoHookean { mu: 1.0 });
        let case = SolidCase {
            title: "sphere",
            mesh: &mesh,
            law: &law,
            bulk_modulus: 9.0,
            poisson_ratio: 0.444,
            clamp: &[],
            tip: &[],
            pressure: 1.0,
            samples: 4,
        };
        let cells = case.chamber_cells();
        assert_eq!(cells.iter().map(Vec::len).sum::<usize>(), mesh.chamber.len());
        for (cells, corners) in cells.iter().zip(TET_FACES) {
            for &cell in cells {
                // A sphere's inner face lies nearest to its centre.
                let nodes = mesh.tetrahedra[cell as usize];
                let radii = corners.map(|k| mesh.positions[nodes[k] as usize].norm());
                assert!(radii.iter().all(|radius| (radius - 8.0).abs() < 1e-9), "{radii:?}");
            }
        }
        assert_eq!(case.times().collect::<Vec<_>>(), [0.25, 0.5, 0.75, 1.0]);
    }

    /// The order of midpoints that CalculiX (C3D10) and FEBio (tet10) have, from their manuals.
    #[test]
    fn midpoints_are_in_the_order_of_both_programs() {
        assert_eq!(TET_EDGES, [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]]);
    }
}
