//! Gmsh's mesh files: solid walls of linear or quadratic tetrahedra.
//!
//! Read are the formats 2.2 and 4.1, as text or binary; written is 2.2 as text, with the chamber as the group of that name.
//! Source: Gmsh reference manual, "MSH file format" and "Node ordering".

#[cfg(test)]
mod group_tests;
mod parse;
#[cfg(test)]
mod tests;
mod words;

use std::fmt::Write;
use std::path::Path;

use super::raw_solid::RawSolid;
use super::{ChamberChoice, InputError, OutputError, OwnSolid, atomic, input};
use crate::mesh::SolidMesh;

/// The solid wall of the file `path`, mm, with the chamber of the `choice`; straight edges get their midpoints.
///
/// Its nodes are numbered anew: corners in the order of the file, then midpoints. Without a closed inner surface its chamber is empty.
///
/// # Errors
/// [`InputError`] when the file cannot be read, is not such a mesh, or its tetrahedra do not fit together.
pub fn read(path: &Path, choice: &ChamberChoice) -> Result<OwnSolid, InputError> {
    let bytes = input::bytes(path, input::DATA)?;
    let solid = parse(&bytes).and_then(|raw| raw.solid(choice));
    solid.map_err(|what| InputError::new(path, what))
}

/// The tetrahedra of the `bytes` of a file.
///
/// # Errors
/// One line when they are not a mesh of tetrahedra.
pub(super) fn parse(bytes: &[u8]) -> Result<RawSolid, String> {
    parse::raw_solid(bytes)
}

/// Where Gmsh puts the midpoints of our tetrahedra, and of our triangles.
const TET_ORDER: [usize; 10] = [0, 1, 2, 3, 4, 5, 6, 7, 9, 8];
const TRIANGLE_ORDER: [usize; 6] = [0, 1, 2, 5, 3, 4];

/// Writes `mesh` as the file `path`, whole or not at all, with the physical groups `wall`, `chamber` and `outer`.
///
/// # Errors
/// [`OutputError::Write`] when the file system refuses.
pub fn write(path: &Path, mesh: &SolidMesh) -> Result<(), OutputError> {
    atomic::write(path, text(mesh).as_bytes())
}

fn text(mesh: &SolidMesh) -> String {
    const MEMORY: &str = "a text grows";
    let mut text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n\
                    2 2 \"chamber\"\n2 3 \"outer\"\n3 1 \"wall\"\n$EndPhysicalNames\n$Nodes\n"
        .to_owned();
    writeln!(text, "{}", mesh.positions.len()).expect(MEMORY);
    for (x, number) in mesh.positions.iter().zip(1..) {
        writeln!(text, "{number} {} {} {}", x.x, x.y, x.z).expect(MEMORY);
    }
    let count = mesh.chamber.len() + mesh.outer.len() + mesh.tetrahedra.len();
    writeln!(text, "$EndNodes\n$Elements\n{count}").expect(MEMORY);
    let triangles = [(2, &mesh.chamber), (3, &mesh.outer)];
    let triangles = triangles.into_iter().flat_map(|(group, faces)| {
        faces.iter().map(move |face| (9, group, TRIANGLE_ORDER.map(|k| face[k] + 1).to_vec()))
    });
    let tetrahedra =
        mesh.tetrahedra.iter().map(|nodes| (11, 1, TET_ORDER.map(|k| nodes[k] + 1).to_vec()));
    for ((kind, group, nodes), number) in triangles.chain(tetrahedra).zip(1..) {
        write!(text, "{number} {kind} 2 {group} {group}").expect(MEMORY);
        for node in nodes {
            write!(text, " {node}").expect(MEMORY);
        }
        text.push('\n');
    }
    text + "$EndElements\n"
}
