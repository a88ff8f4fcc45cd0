//! The surfaces of pictures that this program wrote: what [`super::vtu`] writes, read again.
//!
//! Triangles are read as they are, quadratic ones as the four between their six points. Other programs' grids are
//! [`super::vtu_solid`]'s.

use std::ops::Range;
use std::path::Path;

use roxmltree::{Document, Node};

use super::{InputError, input};
use crate::math::Vec3;
use crate::surface::TriangleMesh;

/// The surface of the picture `path`, mm.
///
/// # Errors
/// [`InputError`] when the file cannot be read, or is not a picture of triangles as this program writes it.
pub fn read(path: &Path) -> Result<TriangleMesh, InputError> {
    let bytes = input::bytes(path, input::DATA)?;
    surface(&bytes).ok_or_else(|| {
        InputError::new(path, "is not a picture of a surface as this program writes it")
    })
}

const MARKER: &[u8] = b"<AppendedData encoding=\"raw\">\n_";
/// What ends the part of the file that is XML.
const END: &str = "</AppendedData></VTKFile>";

/// None where the bytes are something else.
fn surface(bytes: &[u8]) -> Option<TriangleMesh> {
    let marker = bytes.windows(MARKER.len()).position(|window| window == MARKER)?;
    let (xml, blocks) = bytes.split_at(marker + MARKER.len());
    let xml = format!("{}{END}", std::str::from_utf8(xml).ok()?);
    let document = Document::parse(&xml).ok()?;
    let array = |name: &str| {
        let named = |node: &Node<'_, '_>| {
            node.has_tag_name("DataArray") && node.attribute("Name") == Some(name)
        };
        let node = document.descendants().find(named)?;
        let block = block(blocks, node.attribute("offset")?.parse().ok()?)?;
        Some((node.attribute("type")?.to_owned(), &blocks[block]))
    };
    let (_, positions) = array("position").filter(|(kind, _)| kind == "Float64")?;
    let number = |bytes: &[u8; 8]| f64::from_le_bytes(*bytes);
    let numbers: Vec<f64> = positions.as_chunks().0.iter().map(number).collect();
    let positions: Vec<Vec3> =
        numbers.as_chunks().0.iter().map(|x: &[f64; 3]| (*x).into()).collect();
    let nodes: Vec<u32> = match array("connectivity")? {
        (kind, block) if kind == "Int32" => {
            let node = |bytes: &[u8; 4]| u32::try_from(i32::from_le_bytes(*bytes)).ok();
            block.as_chunks().0.iter().map(node).collect::<Option<_>>()?
        }
        (kind, block) if kind == "Int64" => {
            let node = |bytes: &[u8; 8]| u32::try_from(i64::from_le_bytes(*bytes)).ok();
            block.as_chunks().0.iter().map(node).collect::<Option<_>>()?
        }
        _ => return None,
    };
    if nodes.iter().any(|&node| node as usize >= positions.len()) {
        return None;
    }
    let (_, kinds) = array("types")?;
    let triangles = match kinds.first()? {
        kind if kinds.iter().any(|other| other != kind) => return None,
        5 => nodes.as_chunks().0.to_vec(),
        22 => {
            let parts = |&[a, b, c, ab, bc, ca]: &[u32; 6]| {
                [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
            };
            nodes.as_chunks().0.iter().flat_map(parts).collect()
        }
        _ => return None,
    };
    Some(TriangleMesh { positions, triangles })
}

/// Where the contents of the block at `offset` stand.
fn block(blocks: &[u8], offset: usize) -> Option<Range<usize>> {
    let begin = offset.checked_add(8)?;
    let length = blocks.get(offset..begin)?.first_chunk()?;
    let end = begin.checked_add(usize::try_from(u64::from_le_bytes(*length)).ok()?)?;
    (end <= blocks.len()).then_some(begin..end)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::vtu::Picture;
    use crate::model::PictureCells;

    fn points(count: u32) -> Vec<Vec3> {
        (0..count).map(|k| Vec3::new(f64::from(k), 1.0 / 3.0, -2.5)).collect()
    }

    #[test]
    fn pictures_are_read_as_they_were_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.vtu");
        let flat = TriangleMesh { positions: points(4), triangles: vec![[0, 1, 2], [2, 1, 3]] };
        Picture::new(&flat).write(&path).unwrap();
        assert_eq!(read(&path).unwrap(), flat);
        let cells = PictureCells::QuadraticTriangles(vec![[0, 1, 2, 3, 4, 5]]);
        Picture::of_cells(&points(6), &cells).write(&path).unwrap();
        let quadratic = read(&path).unwrap();
        assert_eq!(quadratic.triangles, [[0, 3, 5], [1, 4, 3], [2, 5, 4], [3, 4, 5]]);
        assert_eq!(quadratic.positions, points(6));
    }

    #[test]
    fn what_is_no_picture_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.vtu");
        let flat = TriangleMesh { positions: points(4), triangles: vec![[0, 1, 2], [2, 1, 3]] };
        Picture::new(&flat).write(&path).unwrap();
        let whole = std::fs::read(&path).unwrap();
        // Cut short anywhere, it is none, and never a panic.
        for length in (0..whole.len() - 40).step_by(37) {
            std::fs::write(&path, &whole[..length]).unwrap();
            assert!(read(&path).is_err(), "{length}");
        }
        let tetrahedra = PictureCells::QuadraticTetrahedra(vec![[0, 1, 2, 3, 4, 5, 6, 7, 8, 9]]);
        Picture::of_cells(&points(10), &tetrahedra).write(&path).unwrap();
        let error = read(&path).unwrap_err().to_string();
        assert!(error.contains("is not a picture of a surface"), "{error}");
    }
}
