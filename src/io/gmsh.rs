//! Gmsh, the program: a second opinion, with two meshers of its own.
//!
//! ```text
//! gmsh -3 wall.geo -o filled.msh        wall.geo: merges surface.msh, fills what is between its surfaces 1 and 2
//! ```
//!
//! It keeps the surfaces' triangles. Source: Geuzaine and Remacle (2009), Gmsh, IJNME 79, 1309; Marot, Pellerin, Remacle (2019),
//! One machine, one minute, three billion tetrahedra, IJNME 117, 967 (HXT). It is run, not linked (GPL).

use std::fmt::Write;

use super::child::Limits;
use super::{mesher, msh};
use crate::math::Vec3;
use crate::mesh::tetrahedra::{MesherFailure, TetMesher, TetSettings};
use crate::mesh::{TetMesh, WallSurfaces};

/// Gmsh 4 as a program of this machine.
#[derive(Clone, Debug, PartialEq)]
pub struct Gmsh {
    /// The program's name or path.
    pub program: String,
    /// Which of its meshers is used.
    pub algorithm: Algorithm,
    /// What each run may use.
    pub limits: Limits,
}

/// A mesher of Gmsh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Algorithm {
    /// The newer one, which makes better tetrahedra.
    Hxt,
    /// The older one, which begins without the other's assumptions.
    Delaunay,
}

impl Gmsh {
    /// Gmsh with one of its meshers, as the program `gmsh`.
    #[must_use]
    pub fn new(algorithm: Algorithm) -> Self {
        Self { program: "gmsh".to_owned(), algorithm, limits: Limits::default() }
    }
}

impl TetMesher for Gmsh {
    fn name(&self) -> &str {
        match self.algorithm {
            Algorithm::Hxt => "gmsh hxt",
            Algorithm::Delaunay => "gmsh delaunay",
        }
    }

    fn tetrahedra(
        &self,
        wall: &WallSurfaces,
        interior: &[Vec3],
        _: &TetSettings,
    ) -> Result<TetMesh, MesherFailure> {
        let folder = mesher::folder()?;
        let file = |name: &str| folder.path().join(name);
        mesher::write(&file("surface.msh"), &surfaces(wall))?;
        mesher::write(&file("wall.geo"), &self.geometry(interior))?;
        let arguments =
            ["-3", "wall.geo", "-o", "filled.msh", "-format", "msh41", "-bin", "-nt", "1"];
        let run = mesher::run(&self.program, "gmsh", &arguments, folder.path(), &self.limits);
        let answer = || {
            let raw = msh::parse(&mesher::read(&file("filled.msh"))?);
            Ok(raw.map_err(MesherFailure::Unreadable)?.numbered()?.mesh)
        };
        mesher::unless_full(folder.path(), run.and_then(|()| answer()))
    }
}

impl Gmsh {
    /// The commands: fill the volume between the surfaces 1 (outside) and 2 (chamber).
    fn geometry(&self, interior: &[Vec3]) -> String {
        let algorithm = match self.algorithm {
            Algorithm::Hxt => 10,
            Algorithm::Delaunay => 1,
        };
        let mut text = format!(
            "Merge \"surface.msh\";\n\
             Surface Loop(1) = {{1}};\nSurface Loop(2) = {{2}};\nVolume(1) = {{1, 2}};\n\
             Physical Surface(\"chamber\", 2) = {{2}};\nPhysical Volume(\"wall\", 1) = {{1}};\n\
             Mesh.Algorithm3D = {algorithm};\n"
        );
        for (point, number) in interior.iter().zip(1..) {
            let [x, y, z]: [f64; 3] = (*point).into();
            writeln!(text, "Point({number}) = {{{x}, {y}, {z}}};").expect(MEMORY);
        }
        if !interior.is_empty() {
            writeln!(text, "Point{{1:{}}} In Volume{{1}};", interior.len()).expect(MEMORY);
        }
        text
    }
}

const MEMORY: &str = "a text grows";

/// The surfaces 1 and 2 as a mesh file of version 2.2.
fn surfaces(wall: &WallSurfaces) -> String {
    let WallSurfaces { outer, chamber } = wall;
    let mut text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n".to_owned();
    writeln!(text, "{}", outer.positions.len() + chamber.positions.len()).expect(MEMORY);
    for (x, number) in outer.positions.iter().chain(&chamber.positions).zip(1..) {
        writeln!(text, "{number} {} {} {}", x.x, x.y, x.z).expect(MEMORY);
    }
    let count = outer.triangles.len() + chamber.triangles.len();
    writeln!(text, "$EndNodes\n$Elements\n{count}").expect(MEMORY);
    let shift = outer.positions.len() as u32;
    let outer = outer.triangles.iter().map(|triangle| (1, triangle.map(|v| v + 1)));
    let chamber = chamber.triangles.iter().map(|triangle| (2, triangle.map(|v| v + 1 + shift)));
    for ((surface, [a, b, c]), number) in outer.chain(chamber).zip(1..) {
        writeln!(text, "{number} 2 2 0 {surface} {a} {b} {c}").expect(MEMORY);
    }
    text + "$EndElements\n"
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::tetrahedra::test_walls::{crossing, spheres};
    use crate::mesh::tetrahedra::{TetQuality, check};
    use crate::surface::TriangleMesh;

    #[test]
    fn walls_are_filled_and_their_surfaces_kept() {
        for algorithm in [Algorithm::Hxt, Algorithm::Delaunay] {
            let mut wall = spheres(10.0, 8.0, 2);
            // Two triangles one above the other have corners on a common sphere, for which Delaunay has no unique answer.
            let turn = nalgebra::Rotation3::from_euler_angles(0.3, 0.2, 0.1);
            wall.chamber.positions.iter_mut().for_each(|x| *x = turn * *x);
            let mesher = Gmsh::new(algorithm);
            let mesh = mesher.tetrahedra(&wall, &[], &TetSettings::default()).unwrap();
            check(&mesh, &wall).unwrap();
            assert_eq!(mesh.outer.len(), wall.outer.triangles.len());
            assert_eq!(mesh.chamber.len(), wall.chamber.triangles.len());
            let quality = TetQuality::of(&mesh, &wall);
            assert!(quality.dihedral_1_percent > 10.0, "{quality:?}");
        }
    }

    /// Points given are among the vertices, to the last bit.
    #[test]
    fn interior_points_become_vertices() {
        let wall = spheres(10.0, 8.0, 2);
        let middle = TriangleMesh::sphere(9.0, 2).positions;
        let mesher = Gmsh::new(Algorithm::Hxt);
        let mesh = mesher.tetrahedra(&wall, &middle, &TetSettings::default()).unwrap();
        check(&mesh, &wall).unwrap();
        assert!(middle.iter().all(|point| mesh.positions.contains(point)));
    }

    #[test]
    fn surfaces_that_cross_are_its_failure() {
        let mesher = Gmsh::new(Algorithm::Hxt);
        let answer = mesher.tetrahedra(&crossing(), &[], &TetSettings::default());
        match answer {
            Ok(mesh) => assert!(check(&mesh, &crossing()).is_err()),
            Err(failure) => assert!(!matches!(failure, MesherFailure::Machine(_)), "{failure}"),
        }
    }

    #[test]
    fn a_missing_program_names_its_package() {
        let absent = Gmsh { program: "no-such-gmsh".to_owned(), ..Gmsh::new(Algorithm::Hxt) };
        let failure = absent.tetrahedra(&spheres(2.0, 1.0, 1), &[], &TetSettings::default());
        let what = "there is no program `no-such-gmsh`; install the package gmsh".to_owned();
        assert_eq!(failure, Err(MesherFailure::Machine(what)));
    }
}
