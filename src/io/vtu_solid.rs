//! Solid walls from VTK's unstructured grids (`.vtu`): linear or quadratic tetrahedra.
//!
//! Arrays may be text, base64 or appended (raw or base64), plain or compressed by zlib, in one piece. Physical groups are the
//! numbers in the cell array `gmsh:physical`, as conversions from Gmsh's files leave it, without names. Source: VTK file formats, "XML file formats".

use std::io::Read;
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use roxmltree::{Document, Node};

use super::raw_solid::RawSolid;
use super::{ChamberChoice, InputError, OwnSolid, input};
use crate::math::Vec3;

/// The solid wall of the file `path`, mm, with the chamber of the `choice`; straight edges get their midpoints.
///
/// Its nodes are numbered anew: corners in the order of the file, then midpoints. Without a closed inner surface its chamber is empty.
///
/// # Errors
/// [`InputError`] when the file cannot be read, is not such a grid, or its tetrahedra do not fit together.
pub fn read(path: &Path, choice: &ChamberChoice) -> Result<OwnSolid, InputError> {
    let bytes = input::bytes(path, input::DATA)?;
    let solid = raw_solid(&bytes).and_then(|raw| raw.solid(choice));
    solid.map_err(|what| InputError::new(path, what))
}

fn raw_solid(bytes: &[u8]) -> Result<RawSolid, String> {
    let (xml, appended) = split(bytes)?;
    let document = Document::parse(&xml).map_err(|error| format!("not a .vtu file: {error}"))?;
    let root = document.root_element();
    if root.tag_name().name() != "VTKFile" || root.attribute("type") != Some("UnstructuredGrid") {
        return Err("not a .vtu file: it is no VTKFile of the type UnstructuredGrid".to_owned());
    }
    let grid = Grid::new(root, appended)?;
    let mut pieces = root.descendants().filter(|node| node.has_tag_name("Piece"));
    let (Some(piece), None) = (pieces.next(), pieces.next()) else {
        return Err("only a grid of one piece is read".to_owned());
    };
    let in_section = |section: &str, name: Option<&str>| {
        let section = piece.children().find(|node| node.has_tag_name(section))?;
        section.children().find(|node| {
            node.has_tag_name("DataArray")
                && name.is_none_or(|name| node.attribute("Name") == Some(name))
        })
    };
    let required = |section: &str, name: Option<&str>| {
        let array = in_section(section, name);
        let array =
            array.ok_or_else(|| format!("there is no array {}", name.unwrap_or(section)))?;
        grid.numbers(array)
    };
    let points = required("Points", None)?;
    let nodes = required("Cells", Some("connectivity"))?;
    let ends = required("Cells", Some("offsets"))?;
    let kinds = required("Cells", Some("types"))?;
    let groups = in_section("CellData", Some("gmsh:physical"));
    let groups = groups.map(|array| grid.numbers(array)).transpose()?;
    solid_of(&points, &nodes, &ends, &kinds, groups.as_deref())
}

fn solid_of(
    points: &[f64],
    nodes: &[f64],
    ends: &[f64],
    kinds: &[f64],
    groups: Option<&[f64]>,
) -> Result<RawSolid, String> {
    if ends.len() != kinds.len() || groups.is_some_and(|groups| groups.len() != kinds.len()) {
        return Err("the arrays of the cells have different lengths".to_owned());
    }
    let mut solid = RawSolid {
        positions: points.chunks_exact(3).map(Vec3::from_column_slice).collect(),
        ..RawSolid::default()
    };
    let group = |cell: usize| groups.map_or(0, |groups| groups[cell] as i64);
    let mut start = 0;
    for (cell, (&end, &kind)) in ends.iter().zip(kinds).enumerate() {
        let end = end as usize;
        let short = || format!("cell {cell} has fewer nodes than its type");
        let nodes = nodes.get(start..end).ok_or_else(short)?;
        start = end;
        let number =
            |v: f64| (v >= 0.0 && v.fract() == 0.0 && v < f64::from(u32::MAX)).then_some(v as u32);
        let not_one = || format!("cell {cell} names a node that is no number");
        let node =
            |k: usize| nodes.get(k).ok_or_else(short).and_then(|&v| number(v).ok_or_else(not_one));
        match kind as u8 {
            // Points, lines, polygons.
            1..=4 | 6..=9 | 21 | 23 => {}
            5 | 22 => {
                let set = solid.surfaces.set_of(group(cell));
                if set != 0 {
                    let mut face = [node(0)?, node(1)?, node(2)?];
                    face.sort_unstable();
                    solid.surfaces.count(set);
                    solid.triangles.push((face, set));
                }
            }
            10 | 24 => {
                let set = solid.volumes.set_of(group(cell));
                solid.volumes.count(set);
                solid.tetrahedra.push([node(0)?, node(1)?, node(2)?, node(3)?]);
                if kind as u8 == 10 {
                    continue;
                }
                let between = [node(4)?, node(5)?, node(6)?, node(7)?, node(8)?, node(9)?];
                solid.midpoints.push(between);
            }
            other => {
                return Err(format!(
                    "cells of VTK's type {other} are not read, only tetrahedra of 4 or 10 nodes are"
                ));
            }
        }
    }
    if solid.tetrahedra.is_empty() {
        return Err("the grid has no tetrahedra".to_owned());
    }
    if !solid.midpoints.is_empty() && solid.midpoints.len() != solid.tetrahedra.len() {
        return Err("the grid has tetrahedra of 4 nodes beside those of 10".to_owned());
    }
    Ok(solid)
}

/// The XML of a file without its appended data, and these with their encoding.
fn split(bytes: &[u8]) -> Result<(String, Option<Block<'_>>), String> {
    const APPENDED: &[u8] = b"<AppendedData";
    let at = bytes.windows(APPENDED.len()).position(|window| window == APPENDED);
    let text = |bytes: &[u8]| {
        String::from_utf8(bytes.to_vec()).map_err(|_| "not a .vtu file: not text".to_owned())
    };
    let Some(at) = at else { return Ok((text(bytes)?, None)) };
    let lost = || "the appended data have no beginning".to_owned();
    let opening = bytes[at..].iter().position(|&b| b == b'>').ok_or_else(lost)?;
    let tag = text(&bytes[at..at + opening])?;
    let underscore = bytes[at + opening..].iter().position(|&b| b == b'_').ok_or_else(lost)?;
    let data = &bytes[at + opening + underscore + 1..];
    let block = if tag.contains("\"raw\"") { Block::Raw(data) } else { Block::Base64(data) };
    Ok((text(&bytes[..at])? + "</VTKFile>", Some(block)))
}

/// Binary data of a file, from the beginning of an array on.
#[derive(Clone, Copy)]
enum Block<'a> {
    Raw(&'a [u8]),
    Base64(&'a [u8]),
}

impl<'a> Block<'a> {
    fn at(self, offset: usize) -> Option<Self> {
        Some(match self {
            Self::Raw(data) => Self::Raw(data.get(offset..)?),
            Self::Base64(data) => Self::Base64(data.get(offset..)?),
        })
    }

    /// The first `count` bytes, which were encoded together, and what comes behind them.
    fn taken(self, count: usize) -> Option<(Vec<u8>, Self)> {
        match self {
            Self::Raw(data) => {
                let (these, rest) = data.split_at_checked(count)?;
                Some((these.to_vec(), Self::Raw(rest)))
            }
            Self::Base64(data) => {
                let (these, rest) = data.split_at_checked(count.div_ceil(3).checked_mul(4)?)?;
                let mut bytes = STANDARD.decode(these).ok()?;
                bytes.truncate(count);
                Some((bytes, Self::Base64(rest)))
            }
        }
    }
}

/// How the arrays of a file are written.
struct Grid<'a> {
    /// Bytes of a number in the head of a block.
    head: usize,
    is_compressed: bool,
    appended: Option<Block<'a>>,
}

impl<'a> Grid<'a> {
    fn new(root: Node<'_, '_>, appended: Option<Block<'a>>) -> Result<Self, String> {
        if root.attribute("byte_order").is_some_and(|order| order != "LittleEndian") {
            return Err("the grid is not little-endian".to_owned());
        }
        let head = match root.attribute("header_type") {
            None | Some("UInt32") => 4,
            Some("UInt64") => 8,
            Some(other) => return Err(format!("heads of the type {other} are not read")),
        };
        let is_compressed = match root.attribute("compressor") {
            None => false,
            Some("vtkZLibDataCompressor") => true,
            Some(other) => return Err(format!("data compressed by {other} are not read")),
        };
        Ok(Self { head, is_compressed, appended })
    }

    /// The numbers of a data array.
    fn numbers(&self, array: Node<'_, '_>) -> Result<Vec<f64>, String> {
        let name = array.attribute("Name").unwrap_or("of the points");
        let unreadable = || format!("the array {name} cannot be read");
        let text = array.text().unwrap_or_default();
        let block = match array.attribute("format") {
            None | Some("ascii") => {
                let numbers: Result<Vec<f64>, _> =
                    text.split_ascii_whitespace().map(str::parse).collect();
                return numbers.map_err(|_| unreadable());
            }
            Some("binary") => Some(Block::Base64(text.trim().as_bytes())),
            Some("appended") => array
                .attribute("offset")
                .and_then(|offset| self.appended?.at(offset.parse().ok()?)),
            Some(_) => None,
        };
        let bytes = block.and_then(|block| self.bytes(block));
        let kind = array.attribute("type").unwrap_or_default();
        bytes.and_then(|bytes| decoded(kind, &bytes)).ok_or_else(unreadable)
    }

    fn bytes(&self, block: Block<'_>) -> Option<Vec<u8>> {
        let number = |bytes: &[u8]| -> Option<usize> {
            let mut padded = [0; 8];
            padded[..bytes.len()].copy_from_slice(bytes);
            u64::from_le_bytes(padded).try_into().ok()
        };
        let first = number(&block.taken(self.head)?.0)?;
        if !self.is_compressed {
            let (bytes, _) = block.taken(self.head.checked_add(first)?)?;
            return Some(bytes[self.head..].to_vec());
        }
        // How many blocks, how long they and the last one are, and what each takes compressed.
        let (head, data) = block.taken(self.head.checked_mul(first.checked_add(3)?)?)?;
        let sizes: Option<Vec<usize>> =
            head[3 * self.head..].chunks(self.head).map(number).collect();
        let sizes = sizes?;
        let total = sizes.iter().try_fold(0usize, |sum, &size| sum.checked_add(size))?;
        let (compressed, _) = data.taken(total)?;
        let (mut bytes, mut rest) = (Vec::new(), &compressed[..]);
        for size in sizes {
            let (these, others) = rest.split_at_checked(size)?;
            flate2::read::ZlibDecoder::new(these).read_to_end(&mut bytes).ok()?;
            rest = others;
        }
        Some(bytes)
    }
}

/// The numbers of one type of VTK's.
fn decoded(kind: &str, bytes: &[u8]) -> Option<Vec<f64>> {
    macro_rules! numbers {
        ($type:ty) => {
            bytes
                .chunks_exact(size_of::<$type>())
                .map(|raw| {
                    <$type>::from_le_bytes(raw.try_into().expect("chunks of that size")) as f64
                })
                .collect()
        };
    }
    Some(match kind {
        "Float64" => numbers!(f64),
        "Float32" => numbers!(f32),
        "Int64" => numbers!(i64),
        "UInt64" => numbers!(u64),
        "Int32" => numbers!(i32),
        "UInt32" => numbers!(u32),
        "Int16" => numbers!(i16),
        "UInt16" => numbers!(u16),
        "Int8" => numbers!(i8),
        "UInt8" => numbers!(u8),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;
    use crate::io::vtu::{Picture, Values};
    use crate::mesh::SolidMesh;
    use crate::mesh::tetrahedra::test_walls::{of_prisms, spheres};

    fn read_text(text: &str) -> Result<SolidMesh, String> {
        let raw = raw_solid(text.as_bytes());
        raw.and_then(|raw| raw.solid(&ChamberChoice::default())).map(|read| read.mesh)
    }

    /// Appended raw data, as we write them: the same places, and the chamber found by itself.
    #[test]
    fn a_picture_of_a_solid_comes_back() {
        let mut solid = SolidMesh::straight(&of_prisms(&spheres(10.0, 8.0, 1)));
        solid.positions[solid.corners..].iter_mut().for_each(|x| *x *= 1.01);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("solid.vtu");
        let picture = Picture::of_solid(&solid);
        picture
            .with_point_data("position", Values::Vectors(&solid.positions))
            .write(&path)
            .unwrap();
        let read = read(&path, &ChamberChoice::default()).unwrap().mesh;
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
        assert_eq!(changed("LittleEndian", "BigEndian"), "the grid is not little-endian");
        assert_eq!(
            changed("<VTKFile", "<VTKFile compressor=\"vtkLZMADataCompressor\""),
            "data compressed by vtkLZMADataCompressor are not read"
        );
        assert_eq!(changed("\"offsets\"", "\"ends\""), "there is no array offsets");
        assert_eq!(changed("ascii", "appended"), "the array Points cannot be read");
        assert_eq!(changed("ascii", "binary"), "the array Points cannot be read");
        assert_eq!(changed(">4 7<", ">4<"), "the arrays of the cells have different lengths");
        assert_eq!(changed(">4 7<", ">3 7<"), "cell 0 has fewer nodes than its type");
        assert_eq!(
            changed(">10 5<", ">12 5<"),
            "cells of VTK's type 12 are not read, only tetrahedra of 4 or 10 nodes are"
        );
        assert_eq!(changed(">10 5<", ">9 5<"), "the grid has no tetrahedra");
        assert_eq!(
            changed(">0 1 2 3 ", ">0 1 2 9 "),
            "1 tetrahedra name a vertex beyond the last one"
        );
    }
}
