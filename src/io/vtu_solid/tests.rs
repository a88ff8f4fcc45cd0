//! Grids in every form that VTK and meshio write.

use std::io::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::*;
use crate::io::vtu::{Picture, Values};
use crate::mesh::SolidMesh;
use crate::mesh::tetrahedra::test_walls::{of_prisms, spheres};

fn read_text(text: &str) -> Result<SolidMesh, String> {
    let raw = parse(text.as_bytes());
    raw.and_then(|raw| raw.solid(&ChamberChoice::default())).map(|read| read.mesh)
}

fn read_mesh(path: &Path) -> Result<SolidMesh, InputError> {
    read(path, &ChamberChoice::default()).map(|read| read.mesh)
}

/// Appended raw data, as we write them: the same places, and the chamber found by itself.
#[test]
fn a_picture_of_a_solid_comes_back() {
    let mut solid = SolidMesh::straight(&of_prisms(&spheres(10.0, 8.0, 1)));
    solid.positions[solid.corners..].iter_mut().for_each(|x| *x *= 1.01);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("solid.vtu");
    let picture = Picture::of_solid(&solid);
    picture.with_point_data("position", Values::Vectors(&solid.positions)).write(&path).unwrap();
    let read = read_mesh(&path).unwrap();
    assert_eq!((read.corners, read.positions.len()), (solid.corners, solid.positions.len()));
    assert_eq!((read.chamber.len(), read.outer.len()), (80, 80));
    for (read_nodes, nodes) in read.tetrahedra.iter().zip(&solid.tetrahedra) {
        let [these, those] = [(&read, read_nodes), (&solid, nodes)]
            .map(|(mesh, nodes)| nodes.map(|v| mesh.positions[v as usize]));
        assert_eq!(these, those);
    }
}

/// Bytes as a block of base64 of its own.
fn plain(bytes: &[u8]) -> String {
    let head = (bytes.len() as u32).to_le_bytes();
    STANDARD.encode([&head, bytes].concat())
}

/// The same in two compressed blocks.
fn compressed(bytes: &[u8]) -> String {
    let (first, second) = bytes.split_at(bytes.len() / 2);
    let blocks = [first, second].map(|block| {
        let mut encoder =
            flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
        encoder.write_all(block).unwrap();
        encoder.finish().unwrap()
    });
    let numbers = [2, first.len(), second.len(), blocks[0].len(), blocks[1].len()];
    let head: Vec<u8> = numbers.iter().flat_map(|&n| (n as u32).to_le_bytes()).collect();
    STANDARD.encode(head) + &STANDARD.encode(blocks.concat())
}

/// A linear tetrahedron and a triangle, with 32-bit numbers.
fn arrays() -> [(&'static str, &'static str, Vec<u8>, String); 4] {
    let points = [0f32, 0., 0., 1., 0., 0., 0., 1., 0., 0., 0., 1.];
    let array = |name, kind, bytes: Vec<u8>, text: &str| (name, kind, bytes, text.to_owned());
    [
        array(
            "Points",
            "Float32",
            points.iter().flat_map(|x| x.to_le_bytes()).collect(),
            "0 0 0 1 0 0 0 1 0 0 0 1",
        ),
        array(
            "connectivity",
            "Int32",
            [0i32, 1, 2, 3, 0, 2, 1].iter().flat_map(|v| v.to_le_bytes()).collect(),
            "0 1 2 3 0 2 1",
        ),
        array("offsets", "UInt16", vec![4, 0, 7, 0], "4 7"),
        array("types", "UInt8", vec![10, 5], "10 5"),
    ]
}

fn file(
    attributes: &str,
    form: &str,
    data: impl Fn(&[u8], &str) -> (String, String),
    tail: &str,
) -> String {
    let elements = arrays().map(|(name, kind, bytes, text)| {
        let (more, inside) = data(&bytes, &text);
        format!("<DataArray type=\"{kind}\" Name=\"{name}\" format=\"{form}\"{more}>{inside}</DataArray>")
    });
    let [points, cells @ ..] = elements;
    format!(
        "<?xml version=\"1.0\"?><VTKFile type=\"UnstructuredGrid\" byte_order=\"LittleEndian\"{attributes}>\
         <UnstructuredGrid><Piece NumberOfPoints=\"4\" NumberOfCells=\"2\"><Points>{points}</Points>\
         <Cells>{}</Cells></Piece></UnstructuredGrid>{tail}</VTKFile>",
        cells.concat()
    )
}

#[test]
fn all_forms_hold_the_same_tetrahedron() {
    let none = String::new;
    let text = file("", "ascii", |_, text| (none(), format!("\n{text}\n")), "");
    let expected = read_text(&text).unwrap();
    assert_eq!((expected.corners, expected.positions.len(), expected.outer.len()), (4, 10, 4));
    assert_eq!(expected.positions[1], Vec3::x());
    let base64 = file("", "binary", |bytes, _| (none(), format!("\n{}\n", plain(bytes))), "");
    let zlib = " compressor=\"vtkZLibDataCompressor\"";
    let packed = file(zlib, "binary", |bytes, _| (none(), compressed(bytes)), "");
    let encoded = std::cell::RefCell::new(String::new());
    let append = |bytes: &[u8], _: &str| {
        let offset = format!(" offset=\"{}\"", encoded.borrow().len());
        *encoded.borrow_mut() += &compressed(bytes);
        (offset, none())
    };
    let without_tail = file(zlib, "appended", append, "@");
    let tail =
        format!("<AppendedData encoding=\"base64\">\n_{}\n</AppendedData>", encoded.borrow());
    let appended = without_tail.replace('@', &tail);
    for form in [base64, packed, appended] {
        assert_eq!(read_text(&form).as_ref(), Ok(&expected), "{form}");
    }
}

#[test]
fn what_is_no_wall_is_told_in_one_line() {
    let text = file("", "ascii", |_, text| (String::new(), text.to_owned()), "");
    let what = |text: &str| read_text(text).unwrap_err();
    assert!(what("solid part").starts_with("not a .vtu file: "));
    let no_grid = "not a .vtu file: it is no VTKFile of the type UnstructuredGrid";
    assert_eq!(what("<VTKFile type=\"PolyData\"/>"), no_grid);
    let changed = |from: &str, to: &str| what(&text.replace(from, to));
    assert_eq!(changed("LittleEndian", "MiddleEndian"), "the byte order MiddleEndian is not known");
    assert_eq!(
        changed("<VTKFile", "<VTKFile compressor=\"vtkNewDataCompressor\""),
        "data compressed by vtkNewDataCompressor are not read"
    );
    assert_eq!(changed("\"offsets\"", "\"ends\""), "there is no array offsets");
    assert_eq!(changed("ascii", "appended"), "the array offsets cannot be read");
    assert_eq!(changed("ascii", "binary"), "the array offsets cannot be read");
    let counted = "the array offsets has 1 numbers, but the grid wants 2";
    assert_eq!(changed(">4 7<", ">4<"), counted);
    assert_eq!(changed(">4 7<", ">3 7<"), "cell 0 has fewer nodes than its type");
    assert_eq!(changed(">4 7<", ">8 7<"), "cell 0 has fewer nodes than its type");
    assert_eq!(changed(">4 7<", ">4 -1<"), "the grid has too many points or nodes");
    assert_eq!(
        changed(">10 5<", ">12 5<"),
        "cells of VTK's type 12 (hexahedra) are not read, only tetrahedra of 4 or 10 nodes are"
    );
    assert_eq!(changed(">10 5<", ">9 5<"), "the grid has no tetrahedra");
    assert_eq!(changed(">0 1 2 3 ", ">0 1 2 9 "), "cell 0 names a node that is not there");
    let attributes: String = (0..100_000).map(|k| format!(" a{k}=\"\"")).collect();
    let long = changed("<Piece", &format!("<Piece{attributes}"));
    assert_eq!(long, "not a .vtu file: it has a tag of 988932 characters");
    assert_eq!(changed("NumberOfPoints", "Points"), "a piece has no NumberOfPoints");
    let many = changed("NumberOfPoints=\"4\"", "NumberOfPoints=\"18446744073709551615\"");
    assert_eq!(many, "the grid has too many points or nodes");
}

/// A cube of 15 mm around a cavity of 5 mm: what VTK 9.6 and meshio 5.3 wrote of it in each form is one mesh, with its volumes in closed form.
#[test]
fn grids_written_by_vtk_and_meshio_are_one_mesh() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/vtu");
    let reference = read_mesh(&folder.join("ascii.vtu")).unwrap();
    let volume = |mesh: &SolidMesh| -> f64 {
        let corners = |nodes: &[u32; 10]| [0, 1, 2, 3].map(|k| mesh.positions[nodes[k] as usize]);
        let volume = |[a, b, c, d]: [Vec3; 4]| (b - a).cross(&(c - a)).dot(&(d - a)).abs();
        mesh.tetrahedra.iter().map(|nodes| volume(corners(nodes))).sum::<f64>() / 6.0
    };
    let mut files = 0;
    for entry in std::fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        if name == "hexa.vtu" || !name.ends_with(".vtu") {
            continue;
        }
        files += 1;
        let mesh = read_mesh(&path).unwrap_or_else(|error| panic!("{error}"));
        // Coordinates are multiples of 5, and their sums exact.
        assert_eq!(volume(&mesh), 15f64.powi(3) - 5f64.powi(3), "{name}");
        let counts = [mesh.tetrahedra.len(), mesh.corners, mesh.chamber.len(), mesh.outer.len()];
        assert_eq!(counts, [156, 64, 12, 108], "{name}");
        if name != "pieces.vtu" {
            assert_eq!(mesh, reference, "{name}");
        }
    }
    assert_eq!(files, 15);
    let hexahedra = read_mesh(&folder.join("hexa.vtu")).unwrap_err();
    assert!(hexahedra.what.contains("type 12 (hexahedra) are not read"), "{hexahedra}");
}

/// Text does not care for the order of bytes.
#[test]
fn bytes_of_either_order_hold_the_same_numbers() {
    let expected = file("", "ascii", |_, text| (String::new(), text.to_owned()), "");
    let expected = read_text(&expected).unwrap();
    let swapped = |bytes: &[u8], _: &str| {
        // 4-byte points and nodes, 2-byte ends, types of one.
        let size = match bytes.len() {
            48 | 28 => 4,
            4 => 2,
            _ => 1,
        };
        let bytes: Vec<u8> =
            bytes.chunks(size).flat_map(|number| number.iter().rev().copied()).collect();
        let head = (bytes.len() as u32).to_be_bytes();
        // The length as a run of its own, as some writers have it.
        (String::new(), STANDARD.encode(head) + &STANDARD.encode(bytes))
    };
    let text = file("", "binary", swapped, "").replace("LittleEndian", "BigEndian");
    assert_eq!(read_text(&text), Ok(expected));
}

/// Each cut and each short run of base64 is told, and none is read beyond its end.
#[test]
fn damaged_bytes_are_no_panic() {
    for compressor in ["", " compressor=\"vtkZLibDataCompressor\""] {
        let whole = |bytes: &[u8]| {
            if compressor.is_empty() { plain(bytes) } else { compressed(bytes) }
        };
        for length in 0..24 {
            let cut = |bytes: &[u8], _: &str| {
                let run = whole(bytes);
                let kept = &run[..length.min(run.len() - 1)];
                (String::new(), kept.to_owned() + &"=".repeat(length % 3))
            };
            let told = read_text(&file(compressor, "binary", cut, "")).unwrap_err();
            assert!(told.starts_with("the array "), "{told}");
        }
    }
}

/// A kilobyte that says to be a gigabyte, of each compressor, is refused before it is one.
#[test]
fn small_files_take_little_memory() {
    let text = file("", "ascii", |_, text| (String::new(), text.to_owned()), "");
    let zeros = {
        let mut encoder =
            flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
        encoder.write_all(&vec![0; 1 << 20]).unwrap();
        encoder.finish().unwrap()
    };
    let array = |announced: usize| {
        let numbers = [1, announced, 0, zeros.len()];
        let head: Vec<u8> = numbers.iter().flat_map(|&n| (n as u32).to_le_bytes()).collect();
        let data = STANDARD.encode(head) + &STANDARD.encode(&zeros);
        let old = "<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">10 5<";
        let new = format!("<DataArray type=\"UInt8\" Name=\"types\" format=\"binary\">{data}<");
        assert!(text.contains(old));
        text.replace("<VTKFile", "<VTKFile compressor=\"vtkZLibDataCompressor\"").replace(old, &new)
    };
    let what = |text: &str| read_text(text).unwrap_err();
    assert_eq!(what(&array(2)), "the array types cannot be read");
    assert_eq!(
        what(&array(1 << 30)),
        "the array types has 1073741824 numbers, but the grid wants 2"
    );
    let many = array(1 << 30).replace("NumberOfPoints=\"4\"", "NumberOfPoints=\"400000000\"");
    let many =
        many.replace("Name=\"Points\" format=\"ascii\"", "Name=\"Points\" format=\"binary\"");
    assert_eq!(
        what(&many),
        "the array Points of 1200000000 numbers is not believed of a file of this size"
    );
}
