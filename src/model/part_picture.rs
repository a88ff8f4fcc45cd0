//! What a picture of a part shows: its surface as smooth as its element has it, its cells, and what wall and faces bear.

use super::contact::PlaneContact;
use super::contact::self_contact::WallContact;
use super::discretization::Wall;
use super::element::{ShellState, SolidState};
use super::part_model::PartModel;
use crate::math::Vec3;

/// The cells of a picture over its points.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PictureCells {
    /// Corners.
    Triangles(Vec<[u32; 3]>),
    /// Corners, then the midpoints of the edges from the first to the second, the second to the third, the third to the first.
    QuadraticTriangles(Vec<[u32; 6]>),
    /// As [`crate::mesh::SolidMesh`] orders them.
    QuadraticTetrahedra(Vec<[u32; 10]>),
}

/// What wall or cells bear, one for each cell of the picture.
#[derive(Clone, Debug, PartialEq)]
pub enum BorneStates {
    /// Of the wall about a surface.
    Shell(Vec<ShellState>),
    /// Of a solid.
    Solid(Vec<SolidState>),
}

/// How the faces touch, one for each point of the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactStates {
    /// Smallest gap to a plane or to another fold, mm; not a number where nothing is near.
    pub gaps: Vec<f64>,
    /// Force over area at rest, MPa.
    pub pressures: Vec<f64>,
}

impl PartModel {
    /// Whether its wall is made of solid cells.
    #[must_use]
    pub fn is_solid(&self) -> bool {
        matches!(self.wall(), Wall::Solid(_))
    }

    /// The points of a picture at rest (mm), the vertices first, and its cells.
    ///
    /// Of a Loop shell they lie on the limit surface.
    #[must_use]
    pub fn picture_cells(&self) -> (Vec<Vec3>, PictureCells) {
        let triangles = || self.body.surface.facets.as_chunks::<4>().0.iter();
        let at_rest = || self.body.surface.at(&self.body.reference);
        match self.wall() {
            Wall::Solid(body) => {
                (self.body.reference.clone(), PictureCells::QuadraticTetrahedra(body.cells()))
            }
            Wall::Loop(_) => {
                let cell = |[[p0, p5, p4], [p1, p3, _], [p2, ..], _]: &[[u32; 3]; 4]| {
                    [*p0, *p1, *p2, *p5, *p3, *p4]
                };
                (at_rest(), PictureCells::QuadraticTriangles(triangles().map(cell).collect()))
            }
            Wall::MidEdge(_) => {
                let cell = |[[p0, ..], [p1, ..], [p2, ..], _]: &[[u32; 3]; 4]| [*p0, *p1, *p2];
                let mut points = at_rest();
                points.truncate(self.body.surface.vertices);
                (points, PictureCells::Triangles(triangles().map(cell).collect()))
            }
        }
    }

    /// Displacements at the unknowns `u` of the points of [`Self::picture_cells`], mm.
    #[must_use]
    pub fn picture_displacements(&self, u: &[f64]) -> Vec<Vec3> {
        let displacements = self.body.displacements(u);
        match self.wall() {
            Wall::Solid(_) => displacements,
            Wall::Loop(_) => self.body.surface.at(&displacements),
            Wall::MidEdge(_) => {
                let mut points = self.body.surface.at(&displacements);
                points.truncate(self.body.surface.vertices);
                points
            }
        }
    }

    /// What the cells of [`Self::picture_cells`] bear at the unknowns `u`; none where an element has collapsed.
    #[must_use]
    pub fn borne_states(&self, u: &[f64]) -> Option<BorneStates> {
        let shell = |states: Result<Vec<ShellState>, _>| states.ok().map(BorneStates::Shell);
        match self.wall() {
            Wall::Solid(body) => Some(BorneStates::Solid(body.states(&self.body.untied(u)))),
            Wall::Loop(wall) => shell(wall.states(&self.body.reference, &self.body.displaced(u))),
            Wall::MidEdge(wall) => {
                shell(wall.states(&self.body.reference, &self.body.displaced(u)))
            }
        }
    }

    /// The pressures in a solid at the unknowns `u`, one for each node, positive where they press together, MPa; none of shells.
    #[must_use]
    pub fn solid_pressures(&self, u: &[f64]) -> Option<Vec<f64>> {
        match self.wall() {
            Wall::Solid(body) => {
                Some(body.pressures(self.body.reference.len(), &self.body.untied(u)))
            }
            Wall::Loop(_) | Wall::MidEdge(_) => None,
        }
    }

    /// How the points of [`Self::picture_cells`] touch planes and other folds at the unknowns `u`; none of a part that touches nothing.
    ///
    /// Nodes inside a solid touch nothing.
    #[must_use]
    pub fn contact_states(&self, u: &[f64]) -> Option<ContactStates> {
        if self.each::<PlaneContact>().next().is_none() && !self.keeps_folds_apart() {
            return None;
        }
        let positions = self.body.displaced(u);
        let samples = self.body.surface.samples.len();
        let mut gaps = vec![f64::NAN; samples];
        let mut pressures = vec![0.0; samples];
        for contact in self.each::<PlaneContact>() {
            contact.add_contact(&positions, &mut gaps, &mut pressures);
        }
        for contact in self.each::<WallContact>() {
            contact.add_contact(&positions, &mut gaps, &mut pressures);
        }
        Some(match self.wall() {
            Wall::Solid(_) => {
                let nodes = self.body.reference.len();
                let mut all =
                    ContactStates { gaps: vec![f64::NAN; nodes], pressures: vec![0.0; nodes] };
                for ((sample, gap), pressure) in
                    self.body.surface.samples.iter().zip(gaps).zip(pressures)
                {
                    let node = sample.heaviest() as usize;
                    (all.gaps[node], all.pressures[node]) = (gap, pressure);
                }
                all
            }
            Wall::Loop(_) => ContactStates { gaps, pressures },
            Wall::MidEdge(_) => {
                gaps.truncate(self.body.surface.vertices);
                pressures.truncate(self.body.surface.vertices);
                ContactStates { gaps, pressures }
            }
        })
    }
}
