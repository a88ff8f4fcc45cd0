//! The bodies of a part of several materials: what each extruder of a printer lays.
//!
//! ```text
//! cells of the part, each of one material -> a closed surface for each material; where two touch, they share triangles
//! ```
//! A body is the boundary of its cells. So bodies leave no gap and do not overlap, and the joint of two materials is rough by an edge
//! of a cell, which also locks them into each other.
//!
//! Specks smaller than a bead can fill take the material around them, and so do cells that meet others of their material in an edge
//! alone: a surface whose edges have more than two triangles is none that slicers take.

use std::collections::{BTreeMap, HashMap};

use crate::math::{DisjointSets, Vec3};
use crate::mesh::TetMesh;
use crate::surface::TriangleMesh;

/// Corners of the faces of a cell, counter-clockwise seen from outside.
const FACES: [[usize; 3]; 4] = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];
const EDGES: [[usize; 2]; 6] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];

/// The least volume of a piece of one material, mm^3: 10 mm of a bead of 0.4 x 0.25 mm.
pub const LEAST_PIECE: f64 = 1.0;

/// Sweeps over all edges, at most, in which cells change their material.
const SWEEPS: usize = 50;

/// Cells with their materials.
#[derive(Clone, Debug)]
pub struct Bodies<'a> {
    mesh: &'a TetMesh,
    /// Of each cell, by its place in a list.
    materials: Vec<u16>,
    /// The cell beyond each face of each cell.
    beyond: Vec<[Option<u32>; 4]>,
    /// Cells that changed their material.
    changed: usize,
}

impl<'a> Bodies<'a> {
    /// The cells of `mesh`, which are of these `materials`, but for specks and what meets in an edge alone.
    ///
    /// # Panics
    /// When there is not one material for each cell.
    #[must_use]
    pub fn new(mesh: &'a TetMesh, materials: Vec<u16>) -> Self {
        assert_eq!(materials.len(), mesh.tetrahedra.len(), "each cell has a material");
        let wanted = materials.clone();
        let mut bodies = Self { mesh, materials, beyond: beyond(mesh), changed: 0 };
        let around = around_edges(mesh);
        for _ in 0..SWEEPS {
            while bodies.fill_speck() {}
            if !bodies.part_edges(&around) {
                break;
            }
        }
        let pairs = wanted.iter().zip(&bodies.materials);
        bodies.changed = pairs.filter(|(wanted, is)| wanted != is).count();
        bodies
    }

    /// How many cells took the material around them.
    #[must_use]
    pub fn changed(&self) -> usize {
        self.changed
    }

    /// The surface of all cells of a material, closed, its normals leaving them; empty where there are none.
    ///
    /// Where the surface touches itself in a vertex alone, that is two vertices at one place.
    #[must_use]
    pub fn surface(&self, material: u16) -> TriangleMesh {
        let is_of = |cell: usize| self.materials[cell] == material;
        let mut faces: Vec<[u32; 3]> = Vec::new();
        for (cell, beyond) in self.beyond.iter().enumerate().filter(|(cell, _)| is_of(*cell)) {
            let bounds = |other: &Option<u32>| other.is_none_or(|other| !is_of(other as usize));
            let bounding = FACES.iter().zip(beyond).filter(|(_, other)| bounds(other));
            faces.extend(bounding.map(|(face, _)| face.map(|k| self.mesh.tetrahedra[cell][k])));
        }
        // Corners of triangles are one vertex where the triangles share an edge there.
        let mut corners = DisjointSets::new(3 * faces.len());
        let mut edges = HashMap::new();
        for (face, t) in faces.iter().zip(0u32..) {
            for (k, l) in [(0, 1), (1, 2), (2, 0)] {
                edges.insert([face[k], face[l]], [3 * t + k as u32, 3 * t + l as u32]);
            }
        }
        for (&[a, b], &[from, to]) in &edges {
            if let Some(&[from_b, to_a]) = edges.get(&[b, a]) {
                corners.join(from, to_a);
                corners.join(to, from_b);
            }
        }
        let numbers = corners.numbers(0..3 * faces.len() as u32);
        let count = numbers.iter().max().map_or(0, |&last| last as usize + 1);
        let mut positions = vec![Vec3::zeros(); count];
        for (&vertex, &v) in numbers.iter().zip(faces.as_flattened()) {
            positions[vertex as usize] = self.mesh.positions[v as usize];
        }
        TriangleMesh { positions, triangles: numbers.as_chunks::<3>().0.to_vec() }
    }

    /// Gives the smallest piece below [`LEAST_PIECE`] the material that it shares most faces with; whether there was one.
    fn fill_speck(&mut self) -> bool {
        let mut sets = DisjointSets::new(self.materials.len());
        for (cell, beyond) in (0u32..).zip(&self.beyond) {
            for &other in beyond.iter().flatten() {
                if self.materials[cell as usize] == self.materials[other as usize] {
                    sets.join(cell, other);
                }
            }
        }
        let pieces = sets.numbers(0..self.materials.len() as u32);
        let count = pieces.iter().max().map_or(0, |&last| last as usize + 1);
        let mut volumes = vec![0.0; count];
        for (&piece, corners) in pieces.iter().zip(&self.mesh.tetrahedra) {
            volumes[piece as usize] += volume(self.mesh, corners);
        }
        let specks = (0..count).filter(|&piece| volumes[piece] < LEAST_PIECE && count > 1);
        let Some(speck) = specks.min_by(|&a, &b| volumes[a].total_cmp(&volumes[b])) else {
            return false;
        };
        let cells: Vec<usize> =
            (0..pieces.len()).filter(|&cell| pieces[cell] as usize == speck).collect();
        let mut faces = BTreeMap::new();
        for &other in cells.iter().flat_map(|&cell| &self.beyond[cell]).flatten() {
            if pieces[other as usize] as usize != speck {
                *faces.entry(self.materials[other as usize]).or_insert(0) += 1;
            }
        }
        // A piece apart from all others has no material around it.
        let Some((&material, _)) = faces.iter().max_by_key(|(_, count)| **count) else {
            return false;
        };
        cells.iter().for_each(|&cell| self.materials[cell] = material);
        true
    }

    /// Where cells of one material around an edge are not all joined by faces there, gives the fewest joined ones of a later material of
    /// the list an earlier one of that edge; whether there were any. `around` are the cells around each edge.
    ///
    /// Cells go to earlier materials alone, so that sweeps come to an end.
    fn part_edges(&mut self, around: &[([u32; 2], Vec<u32>)]) -> bool {
        let mut done = false;
        for (edge, cells) in around {
            let groups = self.groups(*edge, cells);
            let of = |group: &Vec<u32>| self.materials[group[0] as usize];
            let are_apart =
                |group: &Vec<u32>| groups.iter().filter(|other| of(other) == of(group)).count() > 1;
            let Some(apart) = groups.iter().find(|group| are_apart(group)).map(of) else {
                continue;
            };
            let first = groups.iter().map(of).min().expect("there are cells");
            // Apart cells of the first material are joined by what is between them.
            let leaves = |group: &&Vec<u32>| {
                if apart == first { of(group) != first } else { of(group) == apart }
            };
            let fewest = groups.iter().filter(leaves).min_by_key(|group| group.len());
            let fewest = fewest.expect("something is between cells that are apart");
            fewest.iter().for_each(|&cell| self.materials[cell as usize] = first);
            done = true;
        }
        done
    }

    /// The `cells` around an edge, those of one material together that are joined by faces there.
    fn groups(&self, [a, b]: [u32; 2], cells: &[u32]) -> Vec<Vec<u32>> {
        let mut groups: Vec<Vec<u32>> = Vec::new();
        for &cell in cells {
            let corners = self.mesh.tetrahedra[cell as usize];
            let has_edge = |face: &[usize; 3]| {
                let has = |v: u32| face.iter().any(|&k| corners[k] == v);
                has(a) && has(b)
            };
            let faces = FACES.iter().zip(&self.beyond[cell as usize]);
            let beside: Vec<u32> =
                faces.filter(|(face, _)| has_edge(face)).filter_map(|(_, other)| *other).collect();
            let is_same =
                |other: &u32| self.materials[*other as usize] == self.materials[cell as usize];
            let is_joined =
                |group: &Vec<u32>| group.iter().any(|o| is_same(o) && beside.contains(o));
            let (joined, apart): (Vec<_>, Vec<_>) = groups.into_iter().partition(is_joined);
            groups = apart;
            groups.push(joined.into_iter().flatten().chain([cell]).collect());
        }
        groups
    }
}

/// The cell beyond each face of each cell of `mesh`.
fn beyond(mesh: &TetMesh) -> Vec<[Option<u32>; 4]> {
    let mut faces = Vec::with_capacity(4 * mesh.tetrahedra.len());
    for (cell, corners) in (0u32..).zip(&mesh.tetrahedra) {
        faces.extend(FACES.iter().enumerate().map(|(place, face)| {
            let mut face = face.map(|k| corners[k]);
            face.sort_unstable();
            (face, cell, place)
        }));
    }
    faces.sort_unstable();
    let mut beyond = vec![[None; 4]; mesh.tetrahedra.len()];
    for pair in faces.windows(2) {
        let [(face, a, at_a), (other, b, at_b)] = [pair[0], pair[1]];
        if face == other {
            beyond[a as usize][at_a] = Some(b);
            beyond[b as usize][at_b] = Some(a);
        }
    }
    beyond
}

/// The cells around each edge of `mesh`, in the order of the edges.
fn around_edges(mesh: &TetMesh) -> Vec<([u32; 2], Vec<u32>)> {
    let mut around: BTreeMap<[u32; 2], Vec<u32>> = BTreeMap::new();
    for (cell, corners) in (0u32..).zip(&mesh.tetrahedra) {
        for [a, b] in EDGES.map(|edge| edge.map(|k| corners[k])) {
            around.entry([a.min(b), a.max(b)]).or_default().push(cell);
        }
    }
    around.into_iter().collect()
}

fn volume(mesh: &TetMesh, corners: &[u32; 4]) -> f64 {
    let [a, b, c, d] = corners.map(|v| mesh.positions[v as usize]);
    (b - a).dot(&(c - a).cross(&(d - a))) / 6.0
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::mesh::{SolidMesh, unit_lattice};

    /// A box of cells of a millimetre, of which a formula of the cell's middle says the material.
    fn block([nx, ny, nz]: [usize; 3], material: impl Fn(Vec3) -> u16) -> (TetMesh, Vec<u16>) {
        let sides = Vec3::new(nx as f64, ny as f64, nz as f64);
        let solid = SolidMesh::layers(&unit_lattice([nx, ny]), nz, &|x, h| {
            (x + h * Vec3::z()).component_mul(&sides)
        });
        let materials = solid.centres().map(material).collect();
        let corners = |face: &[u32; 6]| [face[0], face[1], face[2]];
        let mesh = TetMesh {
            positions: solid.positions[..solid.corners].to_vec(),
            tetrahedra: solid.tetrahedra.iter().map(|c| [c[0], c[1], c[2], c[3]]).collect(),
            chamber: Vec::new(),
            outer: solid.faces().map(|face| corners(&face)).collect(),
        };
        (mesh, materials)
    }

    /// Bodies are closed, share no space and leave none: their volumes are those of their cells, in boxes that are known.
    #[test]
    fn bodies_fill_the_part() {
        let (mesh, materials) = block([6, 4, 3], |x| u16::from(x.x > 2.0));
        let bodies = Bodies::new(&mesh, materials);
        assert_eq!(bodies.changed(), 0);
        for (material, volume, area) in [(0, 24.0, 52.0), (1, 48.0, 80.0)] {
            let surface = bodies.surface(material);
            assert_eq!(surface.check_closed_manifold(), Ok(()));
            // Sums of some hundred terms.
            assert_relative_eq!(surface.volume(), volume, max_relative = 1e-12);
            assert_relative_eq!(surface.area(), area, max_relative = 1e-12);
        }
        assert!(bodies.surface(2).triangles.is_empty());
    }

    /// Some cells of one cubic millimetre within a box are not printed in a material of their own; a column of 3 mm^3 is.
    #[test]
    fn specks_take_what_is_around_them() {
        let within =
            |x: Vec3, low: Vec3, high: Vec3| (low.inf(&x) == low) && (high.sup(&x) == high);
        let thin = |x: Vec3| within(x, Vec3::new(2.0, 2.0, 1.0), Vec3::new(3.0, 3.0, 2.0));
        let thick = |x: Vec3| within(x, Vec3::new(4.0, 1.0, 0.0), Vec3::new(5.0, 2.0, 3.0));
        let half = |x: Vec3| thin(x) && x.z - 1.0 < 0.5;
        let (mesh, materials) = block([7, 5, 3], |x| if thick(x) { 2 } else { u16::from(half(x)) });
        assert!(materials.contains(&1));
        let bodies = Bodies::new(&mesh, materials.clone());
        assert_eq!(bodies.changed(), materials.iter().filter(|m| **m == 1).count());
        assert!(bodies.surface(1).triangles.is_empty());
        assert_relative_eq!(bodies.surface(2).volume(), 3.0, max_relative = 1e-12);
    }

    /// Of a chess board, of which all fields of one colour meet in edges, two colours remain whose bodies are closed surfaces.
    #[test]
    fn what_meets_in_an_edge_is_parted() {
        let field = |x: f64| (x / 2.0) as usize;
        let colour = |x: Vec3| ((field(x.x) + field(x.y)) % 2) as u16;
        let (mesh, materials) = block([8, 8, 3], colour);
        let bodies = Bodies::new(&mesh, materials);
        let surfaces = [0, 1].map(|material| bodies.surface(material));
        assert!(bodies.changed() > 0);
        for surface in &surfaces {
            assert_eq!(surface.check_closed_manifold(), Ok(()));
        }
        let volume = surfaces[0].volume() + surfaces[1].volume();
        assert_relative_eq!(volume, 192.0, max_relative = 1e-12);
        // A field has 12 mm^3; each corner where four of them meet costs some cells of it.
        assert!(surfaces.iter().all(|surface| surface.volume() > 60.0));
    }
}
