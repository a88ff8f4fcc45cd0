//! STL surfaces: triangles without shared vertices on the file, an indexed mesh in memory.
//!
//! The numbers of a binary file are 32-bit: a corner that triangles share may differ in its last digits, so
//! corners closer than a tolerance become one vertex. No unit is written in the file: mm is meant.
//! Which of the two forms a file has is seen from its bytes. Several solids become one mesh, as separate surfaces where they do not touch.
//! What is read is not checked for being closed or for facing outward.

mod text;

use std::collections::HashMap;
use std::io::Cursor;
use std::path::Path;

use super::{InputError, OutputError, atomic, input, part_file};
use crate::math::Vec3;
use crate::surface::{TriangleMesh, over_used_vertices};

/// The tolerance that joins what 32-bit rounding separated (1e-7 of a coordinate) and nothing a mesher made
/// (edges of 1e-3 of the part and longer).
pub const WELD_TOLERANCE: f64 = 1e-5;

/// The triangles of the STL file `path`, ASCII or binary, mm.
///
/// Corners within `weld` times the bounding box's diagonal become one vertex, at the first corner's position;
/// 0 joins equal corners only. Triangles that lose a corner by it are left out.
///
/// # Errors
/// [`InputError`] when the file cannot be read, is not an STL, or has no triangle or a coordinate beyond 32-bit numbers.
pub fn read(path: &Path, weld: f64) -> Result<TriangleMesh, InputError> {
    let bytes = input::bytes(path, input::DATA)?;
    parse(bytes, path, weld)
}

/// As [`read`], of the `bytes` of the file `path`.
///
/// # Errors
/// [`InputError`] as for [`read`].
pub fn parse(bytes: Vec<u8>, path: &Path, weld: f64) -> Result<TriangleMesh, InputError> {
    part_file::check_surface(&bytes, path)?;
    let corners = triangles(bytes, path)?;
    if corners.is_empty() {
        return Err(InputError::new(path, "the STL holds no triangle"));
    }
    if let Some(t) = corners.iter().position(|triangle| !triangle.iter().all(is_single)) {
        let what = format!("triangle {} has a coordinate that is not finite", t + 1);
        return Err(InputError::new(path, what));
    }
    let mesh = welded(&corners, weld);
    if mesh.triangles.is_empty() {
        return Err(InputError::new(path, "every triangle of the STL is degenerate"));
    }
    Ok(mesh)
}

/// Writes `mesh` as the binary STL file `path`, whole or not at all; positions are rounded to 32 bits.
///
/// # Errors
/// [`OutputError::Write`] when the file system refuses.
pub fn write(path: &Path, mesh: &TriangleMesh) -> Result<(), OutputError> {
    let single = |v: Vec3| stl_io::Vector::new([v.x as f32, v.y as f32, v.z as f32]);
    let triangles: Vec<_> = (0..mesh.triangles.len())
        .map(|t| {
            let [a, b, c] = mesh.corners(t);
            let normal = (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_default();
            stl_io::Triangle { normal: single(normal), vertices: [a, b, c].map(single) }
        })
        .collect();
    let mut bytes = Vec::new();
    stl_io::write_stl(&mut bytes, triangles.iter())
        .map_err(|source| OutputError::write(path, source))?;
    atomic::write(path, &bytes)
}

/// Bytes before the first triangle of a binary STL, and bytes of each.
const HEADER: usize = 84;
const TRIANGLE: usize = 50;

/// The number of triangles that a binary STL announces.
fn announced(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(80..HEADER)?;
    Some(u32::from_le_bytes(count.try_into().expect("the range has four bytes")) as usize)
}

/// Whether `bytes` are just as long as the binary STL that they would be: no other format is that by chance.
pub(super) fn is_binary(bytes: &[u8]) -> bool {
    announced(bytes).is_some_and(|count| count > 0 && bytes.len() == HEADER + TRIANGLE * count)
}

/// Whether `bytes` begin as a text STL does.
pub(super) fn is_text(bytes: &[u8]) -> bool {
    text::is_text(bytes)
}

fn triangles(mut bytes: Vec<u8>, path: &Path) -> Result<Vec<[Vec3; 3]>, InputError> {
    let announced = announced(&bytes);
    let end = announced.map_or(usize::MAX, |count| HEADER + TRIANGLE * count);
    // In a text, these bytes would announce more triangles than a file can have.
    if end > bytes.len() {
        if is_text(&bytes) {
            let triangles = text::triangles(&bytes);
            return triangles.map_err(|(line, what)| InputError::at_line(path, line, what));
        }
        let what = match announced {
            Some(count) => format!(
                "not an STL: neither ASCII, nor binary ({count} triangles would be {end} bytes, there are {})",
                bytes.len()
            ),
            None => "not an STL: neither ASCII nor long enough for binary".to_owned(),
        };
        return Err(InputError::new(path, what));
    }
    // Some programs write more behind the triangles; what could be triangles is none of that.
    let behind = &bytes[end..];
    let more = behind.len() / TRIANGLE;
    if more > 0 && behind.len().is_multiple_of(TRIANGLE) && behind.iter().any(|&byte| byte != 0) {
        let what = format!(
            "the STL announces {} triangles and holds {more} more",
            announced.unwrap_or_default()
        );
        return Err(InputError::new(path, what));
    }
    bytes.truncate(end);
    // Some programs begin a binary header with "solid", which `stl_io` takes for ASCII.
    bytes[0] = b' ';
    let not_stl = |error: std::io::Error| InputError::new(path, format!("not an STL: {error}"));
    let mut cursor = Cursor::new(bytes);
    let reader = stl_io::create_stl_reader(&mut cursor).map_err(not_stl)?;
    reader
        .map(|triangle| triangle.map(|t| t.vertices.map(|v| Vec3::from(v.0.map(f64::from)))))
        .collect::<Result<_, _>>()
        .map_err(not_stl)
}

/// Whether its coordinates are finite, as 32-bit numbers too.
fn is_single(v: &Vec3) -> bool {
    v.iter().all(|x| x.abs() <= f64::from(f32::MAX))
}

fn welded(corners: &[[Vec3; 3]], weld: f64) -> TriangleMesh {
    let all = || corners.iter().flatten();
    let low = all().fold(Vec3::repeat(f64::INFINITY), |low, v| low.inf(v));
    let high = all().fold(Vec3::repeat(f64::NEG_INFINITY), |high, v| high.sup(v));
    let mut vertices = WeldedVertices::new(low, weld * (high - low).norm());
    let triangles = corners.iter().map(|triangle| triangle.map(|corner| vertices.index(corner)));
    let triangles: Vec<_> = triangles.filter(|[a, b, c]| a != b && b != c && c != a).collect();
    // Some vertices only degenerate triangles had.
    over_used_vertices(&vertices.positions, &triangles).0
}

/// Vertices no two of which are within `tolerance`, found through a grid of that spacing.
struct WeldedVertices {
    origin: Vec3,
    tolerance: f64,
    positions: Vec<Vec3>,
    cells: HashMap<[i64; 3], Vec<u32>>,
}

impl WeldedVertices {
    fn new(origin: Vec3, tolerance: f64) -> Self {
        Self { origin, tolerance, positions: Vec::new(), cells: HashMap::new() }
    }

    /// The first vertex within the tolerance of `corner`; a new one when there is none.
    fn index(&mut self, corner: Vec3) -> u32 {
        let [i, j, k] = self.cell(corner);
        let reach = if self.tolerance > 0.0 { -1..=1 } else { 0..=0 };
        let near = reach.clone().flat_map(|di| {
            let reach = reach.clone();
            reach.clone().flat_map(move |dj| reach.clone().map(move |dk| [i + di, j + dj, k + dk]))
        });
        let found = near
            .filter_map(|cell| self.cells.get(&cell))
            .flatten()
            .copied()
            .filter(|&v| (self.positions[v as usize] - corner).norm() <= self.tolerance)
            .min();
        found.unwrap_or_else(|| {
            let v = self.positions.len() as u32;
            self.positions.push(corner);
            self.cells.entry([i, j, k]).or_default().push(v);
            v
        })
    }

    fn cell(&self, corner: Vec3) -> [i64; 3] {
        if self.tolerance > 0.0 {
            ((corner - self.origin) / self.tolerance).map(|x| x.floor() as i64).into()
        } else {
            // Adding zero makes the two zeros one.
            corner.map(|x| (x + 0.0).to_bits() as i64).into()
        }
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    /// A cube of edge 10 mm, facing outward.
    fn cube() -> TriangleMesh {
        let corner = |i: usize| Vec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64);
        let quads =
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        TriangleMesh {
            positions: (0..8).map(|i| 10.0 * corner(i) - Vec3::repeat(5.0)).collect(),
            triangles: quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
        }
    }

    fn ascii(corners: &[[Vec3; 3]], name: &str) -> String {
        let mut text = format!("solid{name}\n");
        for triangle in corners {
            text += "facet normal 0 0 0\nouter loop\n";
            for v in triangle {
                text += &format!("vertex {} {} {}\n", v.x, v.y, v.z);
            }
            text += "endloop\nendfacet\n";
        }
        text + "endsolid\n"
    }

    fn all_corners(mesh: &TriangleMesh) -> Vec<[Vec3; 3]> {
        (0..mesh.triangles.len()).map(|t| mesh.corners(t)).collect()
    }

    fn read_bytes(bytes: &[u8], weld: f64) -> Result<TriangleMesh, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.stl");
        fs::write(&path, bytes).unwrap();
        read(&path, weld).map_err(|error| error.what)
    }

    #[test]
    fn a_cube_comes_back_with_eight_vertices() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("cube.stl");
        write(&path, &cube()).unwrap();
        for weld in [0.0, WELD_TOLERANCE] {
            let mesh = read(&path, weld).unwrap();
            assert_eq!((mesh.positions.len(), mesh.triangles.len()), (8, 12));
            assert_eq!(all_corners(&mesh), all_corners(&cube()));
        }
    }

    #[test]
    fn ascii_is_read_with_or_without_a_name_and_binary_may_begin_with_solid() {
        let corners = all_corners(&cube());
        for name in ["", " a part", " "] {
            let mesh = read_bytes(ascii(&corners, name).as_bytes(), 0.0).unwrap();
            assert_eq!(all_corners(&mesh), corners);
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("cube.stl");
        write(&path, &cube()).unwrap();
        let mut bytes = fs::read(&path).unwrap();
        bytes[..12].copy_from_slice(b"solid a part");
        assert_eq!(all_corners(&read_bytes(&bytes, 0.0).unwrap()), corners);
    }

    #[test]
    fn corners_within_the_tolerance_are_joined_whatever_cell_they_fall_in() {
        // Each triangle's corners are moved by 1e-6 of the diagonal (17 mm) in its own direction.
        let moved: Vec<[Vec3; 3]> = all_corners(&cube())
            .iter()
            .enumerate()
            .map(|(t, corners)| {
                let angle = t as f64;
                corners
                    .map(|v| v + 1.7e-5 * Vec3::new(angle.cos(), angle.sin(), (2.0 * angle).sin()))
            })
            .collect();
        let text = ascii(&moved, " moved");
        assert!(read_bytes(text.as_bytes(), 0.0).unwrap().positions.len() > 8);
        let mesh = read_bytes(text.as_bytes(), WELD_TOLERANCE).unwrap();
        assert_eq!((mesh.positions.len(), mesh.triangles.len()), (8, 12));
    }

    #[test]
    fn degenerate_triangles_and_their_vertices_are_left_out() {
        let mut corners = all_corners(&cube());
        let far = Vec3::new(8.0, 8.0, 8.0);
        corners.insert(0, [far, far, corners[0][0]]);
        let mesh = read_bytes(ascii(&corners, "").as_bytes(), WELD_TOLERANCE).unwrap();
        assert_eq!((mesh.positions.len(), mesh.triangles.len()), (8, 12));
        assert_eq!(all_corners(&mesh), all_corners(&cube()));

        let nothing = read_bytes(ascii(&corners[..1], "").as_bytes(), WELD_TOLERANCE);
        assert_eq!(nothing.unwrap_err(), "every triangle of the STL is degenerate");
    }

    /// The cube once more, 20 mm beside, as a solid of its own or as more triangles of the first.
    #[test]
    fn several_solids_are_one_mesh() {
        let first = all_corners(&cube());
        let second: Vec<_> =
            first.iter().map(|t| t.map(|v| v + Vec3::new(20.0, 0.0, 0.0))).collect();
        let text = ascii(&first, " a") + &ascii(&second, " b");
        let mesh = read_bytes(text.as_bytes(), WELD_TOLERANCE).unwrap();
        assert_eq!((mesh.positions.len(), mesh.triangles.len()), (16, 24));
        assert_eq!(all_corners(&mesh), [first.clone(), second].concat());
        let halves = ascii(&first[..5], " a") + &ascii(&first[5..], " b");
        assert_eq!(all_corners(&read_bytes(halves.as_bytes(), 0.0).unwrap()), first);
    }

    /// A colour in the header and in the two bytes of each triangle, and 7 bytes behind: the same cube.
    #[test]
    fn binary_files_may_hold_more_than_triangles() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("cube.stl");
        write(&path, &cube()).unwrap();
        let mut bytes = fs::read(&path).unwrap();
        bytes[..16].copy_from_slice(b"COLOR=\xff\x80\x40\xffsolid ");
        for t in 0..12 {
            bytes[HEADER + TRIANGLE * t + 48..][..2].copy_from_slice(&[0x1f, 0x80]);
        }
        let triangles = bytes[HEADER..].to_vec();
        bytes.extend(b"a trail");
        assert_eq!(all_corners(&read_bytes(&bytes, 0.0).unwrap()), all_corners(&cube()));
        bytes.truncate(HEADER + 12 * TRIANGLE);
        bytes.extend([0; 2 * TRIANGLE]);
        assert_eq!(all_corners(&read_bytes(&bytes, 0.0).unwrap()), all_corners(&cube()));
        bytes.truncate(HEADER + 12 * TRIANGLE);
        bytes.extend(&triangles[..2 * TRIANGLE]);
        let error = read_bytes(&bytes, 0.0).unwrap_err();
        assert_eq!(error, "the STL announces 12 triangles and holds 2 more");
    }

    #[test]
    fn what_is_not_an_stl_is_said() {
        let folder = tempfile::tempdir().unwrap();
        let missing = folder.path().join("a.stl");
        let error = read(&missing, 0.0).unwrap_err().to_string();
        assert_eq!(error, format!("{}: no such file or folder", missing.display()));

        let what = |bytes: &[u8]| read_bytes(bytes, 0.0).unwrap_err();
        assert_eq!(what(b""), "is an empty file, which is not read");
        assert_eq!(what(b"a letter"), "not an STL: neither ASCII nor long enough for binary");
        assert_eq!(what(ascii(&[], "").as_bytes()), "the STL holds no triangle");
        assert_eq!(what(&[0; HEADER]), "the STL holds no triangle");
        let long_text = "this is a letter, not a part. ".repeat(5);
        assert!(what(long_text.as_bytes()).starts_with("not an STL: neither ASCII, nor binary"));
        let cube = all_corners(&cube());
        let two = ascii(&cube, " a") + &ascii(&cube, " b");
        let cut = &two.as_bytes()[..198];
        assert_eq!(what(cut), "the text ends within a facet");

        let mut binary = vec![0; HEADER + TRIANGLE];
        binary[80] = 1;
        binary[96..100].copy_from_slice(&f32::NAN.to_le_bytes());
        assert_eq!(what(&binary), "triangle 1 has a coordinate that is not finite");
        assert!(
            what(&binary[..HEADER + 20]).contains("1 triangles would be 134 bytes, there are 104")
        );
    }
}
