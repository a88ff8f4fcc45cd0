//! Solid walls from VTK's unstructured grids (`.vtu`): linear or quadratic tetrahedra.
//!
//! Arrays may be text, base64 or appended (raw or base64), plain or compressed by zlib, LZ4 or LZMA, of either byte order. Points at
//! one place in several pieces are one node, and VTK's ghost cells are left out; other cells than solid ones are skipped. Physical
//! groups are the numbers in the cell array `gmsh:physical`, as conversions from Gmsh's files leave it, without names. Source: VTK file formats, "XML file formats".

mod arrays;
#[cfg(test)]
mod tests;

use std::borrow::Cow;
use std::collections::HashMap;
use std::path::Path;

use roxmltree::{Document, Node};

use self::arrays::{Arrays, Block, Numbers};
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
    let solid = parse(&bytes).and_then(|raw| raw.solid(choice));
    solid.map_err(|what| InputError::new(path, what))
}

/// The tetrahedra of the `bytes` of a file.
///
/// # Errors
/// One line when they are not a grid of tetrahedra.
pub(super) fn parse(bytes: &[u8]) -> Result<RawSolid, String> {
    let (xml, appended) = split(bytes)?;
    check_tags(&xml)?;
    let document = Document::parse(&xml).map_err(|error| format!("not a .vtu file: {error}"))?;
    let root = document.root_element();
    if root.tag_name().name() != "VTKFile" || root.attribute("type") != Some("UnstructuredGrid") {
        return Err("not a .vtu file: it is no VTKFile of the type UnstructuredGrid".to_owned());
    }
    let arrays = Arrays::new(root, appended, bytes.len())?;
    let grid = root.children().find(|node| node.has_tag_name("UnstructuredGrid"));
    let pieces = || grid.iter().flat_map(Node::children).filter(|node| node.has_tag_name("Piece"));
    let mut joined = Joined::new(pieces().count() > 1);
    for piece in pieces() {
        joined.add(&Piece::new(piece, &arrays)?)?;
    }
    let Joined { solid, .. } = joined;
    if solid.tetrahedra.is_empty() {
        return Err("the grid has no tetrahedra".to_owned());
    }
    if !solid.midpoints.is_empty() && solid.midpoints.len() != solid.tetrahedra.len() {
        return Err("the grid has tetrahedra of 4 nodes beside those of 10".to_owned());
    }
    Ok(solid)
}

/// The arrays of one piece of a grid.
struct Piece {
    points: Numbers,
    nodes: Numbers,
    /// Where the nodes of each cell end.
    ends: Numbers,
    kinds: Numbers,
    /// Of each cell, where the file has them.
    groups: Option<Numbers>,
    /// What VTK says of copies of cells that another piece has.
    ghosts: Option<Numbers>,
}

impl Piece {
    fn new(piece: Node<'_, '_>, arrays: &Arrays<'_>) -> Result<Self, String> {
        let count = |name: &str| -> Result<usize, String> {
            let count = piece.attribute(name).and_then(|count| count.trim().parse().ok());
            count.ok_or_else(|| format!("a piece has no {name}"))
        };
        let (points, cells) = (count("NumberOfPoints")?, count("NumberOfCells")?);
        let array = |section: &str, name: Option<&str>| {
            let section = piece.children().find(|node| node.has_tag_name(section))?;
            section.children().find(|node| {
                node.has_tag_name("DataArray")
                    && name.is_none_or(|name| node.attribute("Name") == Some(name))
            })
        };
        let required = |section: &str, name: Option<&str>, count: Option<usize>| {
            let lost = || format!("there is no array {}", name.unwrap_or(section));
            let array = array(section, name).ok_or_else(lost)?;
            let many = || "the grid has too many points or nodes".to_owned();
            arrays.numbers(array, count.ok_or_else(many)?)
        };
        let of_cells = |name: &str| {
            let array = array("CellData", Some(name));
            array.map(|array| arrays.numbers(array, cells)).transpose()
        };
        if points == 0 && cells == 0 {
            // Programs that run in parallel write pieces of nothing, and without arrays.
            let none = || Numbers::Text(Vec::new());
            let (groups, ghosts) = (None, None);
            return Ok(Self {
                points: none(),
                nodes: none(),
                ends: none(),
                kinds: none(),
                groups,
                ghosts,
            });
        }
        let ends = required("Cells", Some("offsets"), Some(cells))?;
        let nodes = if cells == 0 { 0.0 } else { ends.at(cells - 1) };
        Ok(Self {
            points: required("Points", None, points.checked_mul(3))?,
            nodes: required("Cells", Some("connectivity"), whole(nodes))?,
            ends,
            kinds: required("Cells", Some("types"), Some(cells))?,
            groups: of_cells("gmsh:physical")?,
            ghosts: of_cells("vtkGhostType")?,
        })
    }
}

/// Bits of VTK's ghost types: a cell that another piece has, one that was refined, one that is hidden.
const GHOST: u8 = 1 | 8 | 32;

/// The pieces of a grid as one.
struct Joined {
    solid: RawSolid,
    /// The first node at each place, for grids of several pieces: where these meet, each has its own.
    places: Option<HashMap<[u64; 3], u32>>,
}

impl Joined {
    fn new(has_several_pieces: bool) -> Self {
        Self { solid: RawSolid::default(), places: has_several_pieces.then(HashMap::new) }
    }

    fn add(&mut self, piece: &Piece) -> Result<(), String> {
        let Piece { points, nodes, ends, kinds, groups, ghosts } = piece;
        let numbers: Vec<u32> = (0..points.len() / 3)
            .map(|k| self.node(Vec3::from_fn(|axis, _| points.at(3 * k + axis))))
            .collect();
        let mut start = 0;
        for cell in 0..kinds.len() {
            let short = || format!("cell {cell} has fewer nodes than its type");
            let end = whole(ends.at(cell)).filter(|&end| start <= end && end <= nodes.len());
            let end = end.ok_or_else(short)?;
            let (first, count) = (start, end - start);
            start = end;
            if ghosts.as_ref().is_some_and(|ghosts| ghosts.at(cell) as u8 & GHOST != 0) {
                continue;
            }
            let node = |k: usize| {
                if k >= count {
                    return Err(short());
                }
                let number = whole(nodes.at(first + k)).and_then(|v| numbers.get(v)).copied();
                number.ok_or_else(|| format!("cell {cell} names a node that is not there"))
            };
            let group = groups.as_ref().map_or(0, |groups| groups.at(cell) as i64);
            match kinds.at(cell) as u8 {
                // Nothing, points, lines, polygons.
                0..=4 | 6..=9 | 21 | 23 | 28 | 30 | 35 | 36 | 68 | 70 | 75 | 77 => {}
                5 | 22 | 34 | 69 | 76 => {
                    let set = self.solid.surfaces.set_of(group);
                    if set != 0 {
                        let mut face = [node(0)?, node(1)?, node(2)?];
                        face.sort_unstable();
                        self.solid.surfaces.count(set);
                        self.solid.triangles.push((face, set));
                    }
                }
                kind @ (10 | 24) => {
                    let set = self.solid.volumes.set_of(group);
                    self.solid.volumes.count(set);
                    self.solid.tetrahedra.push([node(0)?, node(1)?, node(2)?, node(3)?]);
                    if kind == 10 {
                        continue;
                    }
                    let between = [node(4)?, node(5)?, node(6)?, node(7)?, node(8)?, node(9)?];
                    self.solid.midpoints.push(between);
                }
                kind => {
                    return Err(format!(
                        "cells of VTK's type {kind}{} are not read, only tetrahedra of 4 or 10 nodes are",
                        name_of(kind)
                    ));
                }
            }
        }
        Ok(())
    }

    /// The number of a node at `position`.
    fn node(&mut self, position: Vec3) -> u32 {
        let positions = &mut self.solid.positions;
        let new = positions.len() as u32;
        if let Some(places) = &mut self.places {
            // Adding zero makes the two zeros one.
            let place = position.map(|x| (x + 0.0).to_bits()).into();
            let number = *places.entry(place).or_insert(new);
            if number < new {
                return number;
            }
        }
        positions.push(position);
        new
    }
}

/// A number of a file that counts something.
fn whole(number: f64) -> Option<usize> {
    (number >= 0.0 && number.fract() == 0.0 && number < f64::from(u32::MAX))
        .then_some(number as usize)
}

/// What VTK calls cells that are not read.
fn name_of(kind: u8) -> &'static str {
    match kind {
        11 => " (voxels)",
        12 | 25 | 29 | 33 => " (hexahedra)",
        13 | 26 | 31 | 32 => " (wedges)",
        14 | 27 | 37 => " (pyramids)",
        42 => " (polyhedra)",
        71 | 78 => " (tetrahedra of higher order)",
        _ => "",
    }
}

/// Refuses tags longer than any of VTK's: the time that their attributes take grows with the square of their number.
fn check_tags(xml: &str) -> Result<(), String> {
    let tags = xml.split('<').skip(1).filter(|tag| !tag.starts_with('!'));
    let mut lengths = tags.map(|tag| tag.find('>').unwrap_or(tag.len()));
    match lengths.find(|&length| length > LONGEST_TAG) {
        Some(length) => Err(format!("not a .vtu file: it has a tag of {length} characters")),
        None => Ok(()),
    }
}

/// Those of VTK have some hundred characters.
const LONGEST_TAG: usize = 4096;

/// The XML of a file without its appended data, and these with their encoding.
fn split(bytes: &[u8]) -> Result<(Cow<'_, str>, Option<Block<'_>>), String> {
    const APPENDED: &[u8] = b"<AppendedData";
    let at = bytes.windows(APPENDED.len()).position(|window| window == APPENDED);
    // Names may have any encoding.
    let text = String::from_utf8_lossy;
    let Some(at) = at else { return Ok((text(bytes), None)) };
    let lost = || "the appended data have no beginning".to_owned();
    let opening = bytes[at..].iter().position(|&b| b == b'>').ok_or_else(lost)?;
    let tag = text(&bytes[at..at + opening]);
    let underscore = bytes[at + opening..].iter().position(|&b| b == b'_').ok_or_else(lost)?;
    let data = &bytes[at + opening + underscore + 1..];
    let is_raw = tag.contains("\"raw\"") || tag.contains("'raw'");
    let block = if is_raw { Block::Raw(data) } else { Block::Base64(data) };
    let xml = text(&bytes[..at]).into_owned() + "</VTKFile>";
    Ok((xml.into(), Some(block)))
}
