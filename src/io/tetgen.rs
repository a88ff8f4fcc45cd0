//! TetGen, the program: exact on any closed surface, and quick.
//!
//! ```text
//! tetgen -p q1.4 o/120 Y ..  wall.smesh  ->  wall.1.node  wall.1.ele  wall.1.face
//! ```
//!
//! `p`: fill the surfaces; `q`: radius over edge; `o/`: improve larger dihedral angles; `Y`: keep the surfaces' triangles.
//! Points without a triangle become vertices of tetrahedra. Source: Si (2015), TetGen, a Delaunay-based quality tetrahedral
//! mesh generator, ACM TOMS 41, 11; its manual 1.5. It is run, not linked (AGPL).

use std::collections::HashSet;
use std::fmt::Write;
use std::path::Path;
use std::str::SplitAsciiWhitespace;

use super::child::Limits;
use super::mesher;
use crate::math::Vec3;
use crate::mesh::tetrahedra::{MesherFailure, TetMesher, TetSettings};
use crate::mesh::{TetMesh, WallSurfaces};
use crate::surface::TriangleMesh;

/// TetGen 1.5 as a program of this machine.
#[derive(Clone, Debug, PartialEq)]
pub struct TetGen {
    /// The program's name or path.
    pub program: String,
    /// What each run may use.
    pub limits: Limits,
}

impl Default for TetGen {
    fn default() -> Self {
        Self { program: "tetgen".to_owned(), limits: Limits::default() }
    }
}

impl TetMesher for TetGen {
    fn name(&self) -> &str {
        "tetgen"
    }

    fn tetrahedra(
        &self,
        wall: &WallSurfaces,
        interior: &[Vec3],
        settings: &TetSettings,
    ) -> Result<TetMesh, MesherFailure> {
        let folder = mesher::folder()?;
        let file = |name: &str| folder.path().join(name);
        mesher::write(&file("wall.smesh"), &smesh(wall, interior))?;
        let TetSettings { radius_edge, dihedral_max, .. } = settings;
        let switches = format!("-pq{radius_edge}o/{dihedral_max}YQ");
        let arguments = [switches.as_str(), "wall.smesh"];
        let run = mesher::run(&self.program, "tetgen", &arguments, folder.path(), &self.limits);
        mesher::unless_full(folder.path(), run.and_then(|()| answer(folder.path())))
    }
}

const OUTER: u32 = 1;
const CHAMBER: u32 = 2;

/// The surfaces as TetGen reads them: points, triangles with a mark, points in holes.
fn smesh(wall: &WallSurfaces, interior: &[Vec3]) -> String {
    let WallSurfaces { outer, chamber } = wall;
    let points = outer.positions.iter().chain(&chamber.positions).chain(interior);
    let shift = outer.positions.len() as u32;
    let count = outer.positions.len() + chamber.positions.len() + interior.len();
    let mut text = format!("{count} 3 0 0\n");
    for (v, point) in points.enumerate() {
        writeln!(text, "{v} {} {} {}", point.x, point.y, point.z).expect(MEMORY);
    }
    writeln!(text, "{} 1", outer.triangles.len() + chamber.triangles.len()).expect(MEMORY);
    for [a, b, c] in &outer.triangles {
        writeln!(text, "3 {a} {b} {c} {OUTER}").expect(MEMORY);
    }
    for triangle in &chamber.triangles {
        let [a, b, c] = triangle.map(|v| v + shift);
        writeln!(text, "3 {a} {b} {c} {CHAMBER}").expect(MEMORY);
    }
    let holes = holes(wall);
    writeln!(text, "{}", holes.len()).expect(MEMORY);
    for (h, hole) in holes.iter().enumerate() {
        writeln!(text, "{h} {} {} {}", hole.x, hole.y, hole.z).expect(MEMORY);
    }
    text
}

const MEMORY: &str = "a text grows";

/// A point in each space that the wall encloses: each part of the chamber, and each pocket of the outside.
fn holes(wall: &WallSurfaces) -> Vec<Vec3> {
    let WallSurfaces { outer, chamber } = wall;
    let all: Vec<[Vec3; 3]> = [outer, chamber]
        .into_iter()
        .flat_map(|surface| (0..surface.triangles.len()).map(|t| surface.corners(t)))
        .collect();
    let in_parts = |surface: &TriangleMesh, side: f64| -> Vec<Vec3> {
        let volumes = surface.component_volumes();
        let components = surface.components();
        (0..volumes.len())
            .filter(|&part| side * volumes[part] < 0.0)
            .filter_map(|part| {
                let triangles = (0..components.len()).filter(|&t| components[t] as usize == part);
                // Away from the wall: out of a pocket's surface, into a chamber's.
                roomiest_point(surface, triangles.collect(), side, &all)
            })
            .collect()
    };
    [in_parts(chamber, -1.0), in_parts(outer, 1.0)].concat()
}

/// Triangles from which the space in front of them is sounded.
const SOUNDINGS: usize = 64;

/// Of some of the `triangles` of `surface`: the point halfway from the centre to the next wall on the given side, farthest from both.
fn roomiest_point(
    surface: &TriangleMesh,
    triangles: Vec<usize>,
    side: f64,
    all: &[[Vec3; 3]],
) -> Option<Vec3> {
    let stride = triangles.len().div_ceil(SOUNDINGS);
    let sounding = |&t: &usize| {
        let [a, b, c] = surface.corners(t);
        let direction = side * surface.area_vector(t).try_normalize(0.0)?;
        let centre = (a + b + c) / 3.0;
        let itself = |corners: &&[Vec3; 3]| **corners != [a, b, c];
        let depth = all
            .iter()
            .filter(itself)
            .filter_map(|&corners| hit(centre, direction, corners))
            .fold(f64::INFINITY, f64::min);
        depth.is_finite().then_some((depth, centre + 0.5 * depth * direction))
    };
    let soundings = triangles.iter().step_by(stride).filter_map(sounding);
    soundings.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, point)| point)
}

/// The distance along `direction` at which a ray from `origin` passes through a triangle.
///
/// Source: Moeller and Trumbore (1997), Fast, minimum storage ray/triangle intersection.
fn hit(origin: Vec3, direction: Vec3, [a, b, c]: [Vec3; 3]) -> Option<f64> {
    let (e1, e2) = (b - a, c - a);
    let p = direction.cross(&e2);
    let determinant = e1.dot(&p);
    let s = (origin - a) / determinant;
    let u = s.dot(&p);
    let q = s.cross(&e1);
    let v = direction.dot(&q);
    let distance = e2.dot(&q);
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 0.0).then_some(distance)
}

/// What TetGen wrote into `folder`.
fn answer(folder: &Path) -> Result<TetMesh, MesherFailure> {
    let text = |name: &str| -> Result<String, MesherFailure> {
        Ok(String::from_utf8_lossy(&mesher::read(&folder.join(name))?).into_owned())
    };
    let positions = rows(&text("wall.1.node")?, "wall.1.node", |numbers| {
        Some(Vec3::new(float(numbers)?, float(numbers)?, float(numbers)?))
    })?;
    let tetrahedra = rows(&text("wall.1.ele")?, "wall.1.ele", |numbers| {
        Some([index(numbers)?, index(numbers)?, index(numbers)?, index(numbers)?])
    })?;
    let faces = rows(&text("wall.1.face")?, "wall.1.face", |numbers| {
        Some(([index(numbers)?, index(numbers)?, index(numbers)?], index(numbers)?))
    })?;
    let chamber: HashSet<[u32; 3]> = faces
        .into_iter()
        .filter(|&(_, mark)| mark == CHAMBER)
        .map(|(mut face, _)| {
            face.sort_unstable();
            face
        })
        .collect();
    let mesh = TetMesh::of_tetrahedra(&positions, &tetrahedra, |face| chamber.contains(&face))?;
    Ok(mesh.mesh)
}

/// The rows of one of TetGen's files, numbered from 0: a count, then as many lines that begin with their number.
fn rows<T>(
    text: &str,
    file: &str,
    row: impl Fn(&mut SplitAsciiWhitespace<'_>) -> Option<T>,
) -> Result<Vec<T>, MesherFailure> {
    let mut lines = text
        .lines()
        .map(|line| line.split('#').next().unwrap_or_default().split_ascii_whitespace())
        .filter(|line| line.clone().next().is_some());
    let unreadable = |what: String| MesherFailure::Unreadable(format!("{file}: {what}"));
    let count: Option<usize> = lines.next().and_then(|mut line| line.next()?.parse().ok());
    let count = count.ok_or_else(|| unreadable("it does not begin with a count".to_owned()))?;
    let mut parsed = Vec::new();
    for number in 0..count {
        let values = lines.next().and_then(|mut line| {
            let is_next = line.next()?.parse() == Ok(number);
            is_next.then(|| row(&mut line)).flatten()
        });
        let what = || unreadable(format!("row {number} of {count} cannot be read"));
        parsed.push(values.ok_or_else(what)?);
    }
    Ok(parsed)
}

fn float(numbers: &mut SplitAsciiWhitespace<'_>) -> Option<f64> {
    numbers.next()?.parse().ok()
}

fn index(numbers: &mut SplitAsciiWhitespace<'_>) -> Option<u32> {
    numbers.next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::mesh::tetrahedra::test_walls::{crossing, spheres};
    use crate::mesh::tetrahedra::{TetQuality, check};

    /// A wall that is finer than thick, one that is as thick as fine, and one with points inside.
    #[test]
    fn walls_are_filled_and_their_surfaces_kept() {
        for (wall, layers) in [(spheres(10.0, 9.0, 3), 1), (spheres(10.0, 8.0, 3), 2)] {
            let settings = TetSettings { layers, ..TetSettings::default() };
            let mesh = TetGen::default().tetrahedra(&wall, &[], &settings).unwrap();
            check(&mesh, &wall).unwrap();
            assert_eq!(mesh.outer.len(), wall.outer.triangles.len());
            assert_eq!(mesh.chamber.len(), wall.chamber.triangles.len());
            let quality = TetQuality::of(&mesh, &wall);
            // What `o/120` is for; without it 1 % are below 11 degrees.
            assert!(quality.dihedral_1_percent > 20.0, "{quality:?}");
        }
    }

    /// Points given are among the vertices, to the last bit.
    #[test]
    fn interior_points_become_vertices() {
        let wall = spheres(10.0, 8.0, 2);
        let middle = TriangleMesh::sphere(9.0, 2).positions;
        let mesh = TetGen::default().tetrahedra(&wall, &middle, &TetSettings::default()).unwrap();
        check(&mesh, &wall).unwrap();
        assert!(middle.iter().all(|point| mesh.positions.contains(point)));
    }

    /// A pocket closed off in the outside stays empty and is no chamber.
    #[test]
    fn a_pocket_stays_empty() {
        let mut wall = spheres(10.0, 4.0, 2);
        let mut pocket = TriangleMesh::sphere(1.0, 1);
        let shift = wall.outer.positions.len() as u32;
        pocket.positions.iter_mut().for_each(|p| p.x += 7.0);
        wall.outer.positions.extend(pocket.positions);
        let turned = pocket.triangles.iter().map(|&[a, b, c]| [a, c, b].map(|v| v + shift));
        wall.outer.triangles.extend(turned);
        let mesh = TetGen::default().tetrahedra(&wall, &[], &TetSettings::default()).unwrap();
        check(&mesh, &wall).unwrap();
        assert_relative_eq!(
            mesh.volume(),
            wall.outer.volume() - wall.chamber.volume(),
            max_relative = 1e-12
        );
    }

    #[test]
    fn surfaces_that_cross_are_its_failure() {
        let failure = TetGen::default().tetrahedra(&crossing(), &[], &TetSettings::default());
        let failure = failure.unwrap_err();
        let is_its_own =
            matches!(failure, MesherFailure::Crashed { .. } | MesherFailure::Refused { .. });
        assert!(is_its_own, "{failure}");
    }

    #[test]
    fn a_missing_program_names_its_package() {
        let absent = TetGen { program: "no-such-tetgen".to_owned(), ..TetGen::default() };
        let failure = absent.tetrahedra(&spheres(2.0, 1.0, 1), &[], &TetSettings::default());
        let what = "there is no program `no-such-tetgen`; install the package tetgen".to_owned();
        assert_eq!(failure, Err(MesherFailure::Machine(what)));
    }

    #[test]
    fn rows_that_are_none_are_told() {
        let row = |numbers: &mut SplitAsciiWhitespace<'_>| Some([index(numbers)?, index(numbers)?]);
        assert_eq!(rows("# a\n2 7\n\n0 3 4 # b\n1  5 6 7\n", "f", row), Ok(vec![[3, 4], [5, 6]]));
        let what = |text: &str| rows(text, "f", row).unwrap_err().to_string();
        let unreadable = "its answer cannot be read: f: ";
        assert_eq!(what("two"), format!("{unreadable}it does not begin with a count"));
        assert_eq!(what("2\n0 1 2\n"), format!("{unreadable}row 1 of 2 cannot be read"));
        assert_eq!(what("1\n1 1 2\n"), format!("{unreadable}row 0 of 1 cannot be read"));
    }
}
