//! Mesh files of each version and form, as Gmsh itself writes them.

use std::path::Path;

use super::*;
use crate::io::child::{Ending, Limits, run};
use crate::math::Vec3;
use crate::mesh::tetrahedra::check;
use crate::mesh::tetrahedra::test_walls::{of_prisms, spheres};
use crate::mesh::{TET_EDGES, TetMesh};

/// A wall whose midpoints are pushed out of their edges.
fn curved() -> SolidMesh {
    let mut solid = SolidMesh::straight(&of_prisms(&spheres(10.0, 8.0, 1)));
    for x in &mut solid.positions[solid.corners..] {
        *x *= 1.0 + 0.01 * x.x.sin();
    }
    solid
}

/// The mesh with straight edges between the corners.
fn straight(solid: &SolidMesh) -> TetMesh {
    let corners = |nodes: &[u32; 6]| [nodes[0], nodes[1], nodes[2]];
    TetMesh {
        positions: solid.positions[..solid.corners].to_vec(),
        tetrahedra: solid.tetrahedra.iter().map(|n| [n[0], n[1], n[2], n[3]]).collect(),
        chamber: solid.chamber.iter().map(corners).collect(),
        outer: solid.outer.iter().map(corners).collect(),
    }
}

/// The edges of each tetrahedron (ends and midpoint, mixed into one number) as places, whatever their numbers and order.
fn places(solid: &SolidMesh) -> Vec<Vec<[i64; 3]>> {
    // Gmsh writes 16 digits as text.
    let place = |v: u32| -> [i64; 3] {
        solid.positions[v as usize].map(|x| (1e9 * x).round() as i64).into()
    };
    let mut all: Vec<Vec<[i64; 3]>> = solid
        .tetrahedra
        .iter()
        .map(|nodes| {
            let mut edges: Vec<[i64; 3]> = TET_EDGES
                .into_iter()
                .enumerate()
                .map(|(k, [i, j])| {
                    let [a, b] = [place(nodes[i]), place(nodes[j])];
                    let between = place(nodes[4 + k]);
                    std::array::from_fn(|c| {
                        a[c].min(b[c]) ^ a[c].max(b[c]).rotate_left(7) ^ between[c].rotate_left(13)
                    })
                })
                .collect();
            edges.sort_unstable();
            edges
        })
        .collect();
    all.sort_unstable();
    all
}

/// What Gmsh makes of the file `from`, written as `to` in a format.
fn converted(from: &Path, to: &str, format: &[&str]) -> std::path::PathBuf {
    let folder = from.parent().unwrap();
    let arguments = [&["-0", from.to_str().unwrap(), "-o", to][..], format].concat();
    let finished = run("gmsh", &arguments, folder, &Limits::default()).unwrap();
    assert_eq!(finished.ending, Ending::Exited(0), "{}", finished.words);
    folder.join(to)
}

/// What we write, Gmsh reads; what it makes of that in each format, we read: the same nodes in the same tetrahedra.
#[test]
fn all_formats_hold_the_same_wall() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("wall.msh");
    let solid = curved();
    write(&path, &solid).unwrap();
    assert_eq!(places(&read(&path, &ChamberChoice::default()).unwrap().mesh), places(&solid));
    let formats: [&[&str]; 4] = [
        &["-format", "msh22"],
        &["-format", "msh22", "-bin"],
        &["-format", "msh41"],
        &["-format", "msh41", "-bin"],
    ];
    for (n, format) in formats.into_iter().enumerate() {
        let path = converted(&path, &format!("{n}.msh"), format);
        let read = read(&path, &ChamberChoice::default()).unwrap().mesh;
        assert_eq!(places(&read), places(&solid), "{format:?}");
        assert_eq!((read.chamber.len(), read.outer.len()), (80, 80), "{format:?}");
        check(&straight(&read), &spheres(10.0, 8.0, 1)).unwrap();
    }
}

fn read_text(text: &str) -> Result<SolidMesh, String> {
    let read = parse(text.as_bytes()).and_then(|raw| raw.solid(&ChamberChoice::default()));
    read.map(|read| read.mesh)
}

const HEAD: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
const NODES: &str = "$Nodes\n5\n10 0 0 0\n20 1 0 0\n30 0 1 0\n40 0 0 1\n50 9 9 9\n$EndNodes\n";

/// A tetrahedron turned inside out among an unused node and other elements; it has no chamber.
#[test]
fn a_linear_tetrahedron_gets_midpoints() {
    let elements = "$Comments\n$ none\n$EndComments\n$Elements\n3\n\
                    1 15 2 0 1 50\n2 2 2 7 1 10 20 30\n3 4 2 1 1 20 10 30 40\n$EndElements\n";
    let solid = read_text(&format!("{HEAD}{NODES}{elements}")).unwrap();
    assert_eq!((solid.corners, solid.positions.len()), (4, 10));
    assert_eq!((solid.chamber.len(), solid.outer.len()), (0, 4));
    assert_eq!(straight(&solid).volume(), 1.0 / 6.0);
    assert!(solid.positions.contains(&Vec3::new(0.5, 0.5, 0.0)));
}

/// Without groups the inner surface is the chamber; a group is found by its name, whatever its number.
#[test]
fn the_chamber_is_found() {
    let wall = spheres(10.0, 8.0, 1);
    let full = text(&SolidMesh::straight(&of_prisms(&wall)));
    let without_groups = full.replace(" 2 2 2 ", " 2 0 2 ").replace(" 2 3 3 ", " 2 0 3 ");
    // A name without triangles is a mistake.
    let named = read_text(&without_groups).unwrap_err();
    assert_eq!(
        named,
        "the group \"chamber\" (2) has no triangles; the file has no group with triangles"
    );
    let without_names = without_groups.replace("2 2 \"chamber\"", "2 2 \"cavity\"");
    check(&straight(&read_text(&without_names).unwrap()), &wall).unwrap();
    let renamed = full
        .replace("2 2 \"chamber\"", "2 3 \"Chamber\"")
        .replace("2 3 \"outer\"", "2 2 \"outer\"");
    let renumbered = renamed.replace(" 9 2 2 2 ", " 9 2 x ").replace(" 9 2 3 3 ", " 9 2 2 2 ");
    let renumbered = renumbered.replace(" 9 2 x ", " 9 2 3 3 ");
    check(&straight(&read_text(&renumbered).unwrap()), &wall).unwrap();
}

/// A wall with a vertex of the chamber moved through the outside overlaps itself, and is read with that said.
#[test]
fn a_wall_that_overlaps_itself_is_read() {
    let mut mesh = of_prisms(&spheres(10.0, 8.0, 1));
    assert_eq!(SolidMesh::straight(&mesh).overlapping_faces(), 0);
    mesh.positions[0] *= 1.3;
    let solid = read_text(&text(&SolidMesh::straight(&mesh))).unwrap();
    assert_eq!((solid.chamber.len(), solid.tetrahedra.len()), (80, 240));
    assert!(solid.overlapping_faces() > 0);
    assert!((0..240).all(|t| {
        let [a, b, c, d] =
            std::array::from_fn(|k| solid.positions[solid.tetrahedra[t][k] as usize]);
        (b - a).dot(&(c - a).cross(&(d - a))) > 0.0
    }));
}

#[test]
fn what_is_no_wall_is_told_in_one_line() {
    let what = |text: &str| read_text(text).unwrap_err();
    let tail = |elements: &str| format!("{HEAD}{NODES}$Elements\n{elements}\n$EndElements\n");
    assert_eq!(what("solid part\n"), "not a Gmsh mesh: it does not begin with $MeshFormat");
    assert_eq!(what("$Nodes\n0\n"), "not a Gmsh mesh: it does not begin with $MeshFormat");
    let old = "$MeshFormat\n4 0 8\n$EndMeshFormat\n";
    assert_eq!(what(old), "version 4 of Gmsh's format is not read, only 2.2 and 4.1 are");
    assert_eq!(what(HEAD), "the mesh has no tetrahedra");
    assert_eq!(
        what(&format!("{HEAD}$Nodes\n2\n1 0 0 0\n$EndNodes\n")),
        "the section $Nodes cannot be read to its end"
    );
    assert_eq!(
        what(&tail("1\n1 5 2 1 1 10 20 30 40 50 10 20 30")),
        "elements of Gmsh's type 5 are not read, only tetrahedra of 4 or 10 nodes are"
    );
    assert_eq!(
        what(&tail("1\n1 4 2 1 1 10 20 30 60")),
        "an element names a node that is not there"
    );
    let marked = |elements: &str| {
        format!(
            "{HEAD}$PhysicalNames\n1\n2 2 \"chamber\"\n$EndPhysicalNames\n{}",
            &tail(elements)[HEAD.len()..]
        )
    };
    assert_eq!(
        what(&marked("2\n1 2 2 2 1 10 20 50\n2 4 2 1 1 10 20 30 40")),
        "1 of the 1 triangles marked as the chamber are not on the boundary of the tetrahedra; the air before them must have none"
    );
    assert_eq!(
        what(&marked("2\n1 2 2 2 1 10 20 30\n2 4 2 1 1 10 20 30 40")),
        "the chamber is open along 3 edges; if that is a flat air inlet, [part] close_inlet = true closes it"
    );
    assert_eq!(what(&tail("1\n1 4 2 1 1 10 20 30 30")), "1 tetrahedra have no volume");
    let cut: String = text(&curved()).chars().take(9000).collect();
    assert_eq!(what(&cut), "the section $Nodes cannot be read to its end");
    // A count that no file can hold is no reason to ask for memory.
    let endless = format!("{HEAD}$Nodes\n99999999999\n1 0 0 0\n$EndNodes\n");
    assert_eq!(what(&endless), "the section $Nodes cannot be read to its end");
    let missing = Path::new("no/wall.msh");
    assert_eq!(
        read(missing, &ChamberChoice::default()).unwrap_err().to_string(),
        "no/wall.msh: no such file or folder"
    );
}
