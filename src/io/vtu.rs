//! Triangle surfaces and solid walls with values on them for ParaView: `.vtu` pictures and the `.pvd` list of a series.
//!
//! Data are appended raw, little-endian, each block behind its length as 64 bits:
//! Source: VTK file formats, "XML file formats", unstructured grid, appended data.

use std::path::Path;

use super::xml::escaped;
use super::{OutputError, atomic};
use crate::math::Vec3;
use crate::mesh::SolidMesh;
use crate::model::PictureCells;
use crate::surface::TriangleMesh;

/// A surface or a solid, and named values on its nodes and cells.
#[derive(Clone, Debug)]
pub struct Picture<'a> {
    positions: &'a [Vec3],
    cells: Cells<'a>,
    point_data: Vec<(String, Values<'a>)>,
    cell_data: Vec<(String, Values<'a>)>,
}

/// The cells of a picture.
#[derive(Clone, Copy, Debug)]
enum Cells<'a> {
    Triangles(&'a [[u32; 3]]),
    QuadraticTriangles(&'a [[u32; 6]]),
    QuadraticTetrahedra(&'a [[u32; 10]]),
}

/// One value for each node or cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Values<'a> {
    /// A number each.
    Scalars(&'a [f64]),
    /// A vector each.
    Vectors(&'a [Vec3]),
    /// A number each, of single precision.
    Singles(&'a [f32]),
}

impl<'a> Picture<'a> {
    /// The surface without values.
    #[must_use]
    pub fn new(mesh: &'a TriangleMesh) -> Self {
        Self::of(&mesh.positions, Cells::Triangles(&mesh.triangles))
    }

    /// The tetrahedra of a solid without values.
    #[must_use]
    pub fn of_solid(mesh: &'a SolidMesh) -> Self {
        Self::of(&mesh.positions, Cells::QuadraticTetrahedra(&mesh.tetrahedra))
    }

    /// The `cells` over `positions` (mm), without values.
    #[must_use]
    pub fn of_cells(positions: &'a [Vec3], cells: &'a PictureCells) -> Self {
        let cells = match cells {
            PictureCells::Triangles(cells) => Cells::Triangles(cells),
            PictureCells::QuadraticTriangles(cells) => Cells::QuadraticTriangles(cells),
            PictureCells::QuadraticTetrahedra(cells) => Cells::QuadraticTetrahedra(cells),
        };
        Self::of(positions, cells)
    }

    fn of(positions: &'a [Vec3], cells: Cells<'a>) -> Self {
        Self { positions, cells, point_data: Vec::new(), cell_data: Vec::new() }
    }

    /// The picture with `values`, one for each node, named `name` (with its unit).
    ///
    /// # Panics
    /// When there are not as many values as nodes.
    #[must_use]
    pub fn with_point_data(mut self, name: &str, values: Values<'a>) -> Self {
        assert_eq!(values.len(), self.positions.len(), "{name}: a value for each node");
        self.point_data.push((name.to_owned(), values));
        self
    }

    /// The picture with `values`, one for each cell, named `name` (with its unit).
    ///
    /// # Panics
    /// When there are not as many values as cells.
    #[must_use]
    pub fn with_cell_data(mut self, name: &str, values: Values<'a>) -> Self {
        assert_eq!(values.len(), self.cells.len(), "{name}: a value for each cell");
        self.cell_data.push((name.to_owned(), values));
        self
    }

    /// Writes the picture as the file `path` (`.vtu`), whole or not at all.
    ///
    /// # Errors
    /// [`OutputError::Write`] when the file system refuses.
    pub fn write(&self, path: &Path) -> Result<(), OutputError> {
        atomic::write(path, &self.bytes())
    }

    fn bytes(&self) -> Vec<u8> {
        let Self { positions, cells, .. } = self;
        let (nodes, size, kind) = match cells {
            Cells::Triangles(cells) => (cells.as_flattened(), 3, VTK_TRIANGLE),
            Cells::QuadraticTriangles(cells) => (cells.as_flattened(), 6, VTK_QUADRATIC_TRIANGLE),
            Cells::QuadraticTetrahedra(cells) => (cells.as_flattened(), 10, VTK_QUADRATIC_TETRA),
        };
        let ends = (1..=cells.len()).map(|t| size * t as i64);
        let types = vec![kind; cells.len()];

        let mut blocks = AppendedBlocks::default();
        let mut xml = format!(
            "<?xml version=\"1.0\"?>\n\
             <VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n\
             <UnstructuredGrid>\n\
             <Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n",
            positions.len(),
            cells.len()
        );
        xml += "<Points>\n";
        xml += &blocks.values("position", Values::Vectors(positions));
        xml += "</Points>\n<Cells>\n";
        // No mesh of ours has 2^31 nodes, and half as many bytes do.
        let nodes = nodes.iter().flat_map(|&v| v.cast_signed().to_le_bytes());
        xml += &blocks.array("Int32", "connectivity", 1, nodes);
        xml += &blocks.array("Int64", "offsets", 1, ends.flat_map(i64::to_le_bytes));
        xml += &blocks.array("UInt8", "types", 1, types.into_iter());
        xml += "</Cells>\n";
        for (tag, data) in [("PointData", &self.point_data), ("CellData", &self.cell_data)] {
            xml += &format!("<{tag}>\n");
            for (name, values) in data {
                xml += &blocks.values(name, *values);
            }
            xml += &format!("</{tag}>\n");
        }
        xml += "</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_";

        let mut bytes = xml.into_bytes();
        bytes.extend(blocks.bytes);
        bytes.extend(b"\n</AppendedData>\n</VTKFile>\n");
        bytes
    }
}

impl Cells<'_> {
    fn len(&self) -> usize {
        match self {
            Self::Triangles(cells) => cells.len(),
            Self::QuadraticTriangles(cells) => cells.len(),
            Self::QuadraticTetrahedra(cells) => cells.len(),
        }
    }
}

impl Values<'_> {
    fn len(&self) -> usize {
        match self {
            Self::Scalars(values) => values.len(),
            Self::Vectors(values) => values.len(),
            Self::Singles(values) => values.len(),
        }
    }
}

/// Writes the series `path` (`.pvd`): the time of each picture and its file, relative to the series' folder.
///
/// # Errors
/// [`OutputError::Write`] when the file system refuses.
pub fn write_series(path: &Path, pictures: &[(f64, String)]) -> Result<(), OutputError> {
    let mut xml = "<?xml version=\"1.0\"?>\n\
                   <VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n\
                   <Collection>\n"
        .to_owned();
    for (time, file) in pictures {
        let file = escaped(file);
        xml += &format!("<DataSet timestep=\"{time}\" part=\"0\" file=\"{file}\"/>\n");
    }
    xml += "</Collection>\n</VTKFile>\n";
    atomic::write(path, xml.as_bytes())
}

const VTK_TRIANGLE: u8 = 5;
const VTK_QUADRATIC_TRIANGLE: u8 = 22;
/// Its nodes have the order of ours.
const VTK_QUADRATIC_TETRA: u8 = 24;

/// The binary tail of the file; each block is announced by an XML element with its offset.
#[derive(Default)]
struct AppendedBlocks {
    bytes: Vec<u8>,
}

impl AppendedBlocks {
    fn values(&mut self, name: &str, values: Values<'_>) -> String {
        match values {
            Values::Scalars(values) => {
                self.array("Float64", name, 1, values.iter().flat_map(|x| x.to_le_bytes()))
            }
            Values::Singles(values) => {
                self.array("Float32", name, 1, values.iter().flat_map(|x| x.to_le_bytes()))
            }
            Values::Vectors(values) => {
                let numbers = values.iter().flat_map(|v| [v.x, v.y, v.z]);
                self.array("Float64", name, 3, numbers.flat_map(f64::to_le_bytes))
            }
        }
    }

    fn array(
        &mut self,
        kind: &str,
        name: &str,
        components: usize,
        data: impl Iterator<Item = u8>,
    ) -> String {
        let offset = self.bytes.len();
        self.bytes.extend([0; 8]);
        self.bytes.extend(data);
        let length = (self.bytes.len() - offset - 8) as u64;
        self.bytes[offset..offset + 8].copy_from_slice(&length.to_le_bytes());
        // Readers give a scalar that is announced with its one component a second axis.
        let components = match components {
            1 => String::new(),
            n => format!(" NumberOfComponents=\"{n}\""),
        };
        format!(
            "<DataArray type=\"{kind}\" Name=\"{}\"{components} format=\"appended\" offset=\"{offset}\"/>\n",
            escaped(name)
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The value of attribute `key` in an XML element.
    fn attribute<'a>(element: &'a str, key: &str) -> Option<&'a str> {
        let element = element.split("/>").next()?;
        let start = element.find(&format!("{key}=\""))? + key.len() + 2;
        element[start..].split('"').next()
    }

    /// Name, components and numbers of every array, read as the format says.
    fn arrays(file: &[u8]) -> Vec<(String, usize, Vec<f64>)> {
        let marker = b"<AppendedData encoding=\"raw\">\n_";
        let start = file.windows(marker.len()).position(|w| w == marker).unwrap() + marker.len();
        let xml = std::str::from_utf8(&file[..start]).unwrap();
        let mut end = 0;
        let arrays = xml
            .split("<DataArray")
            .skip(1)
            .map(|element| {
                let offset: usize = attribute(element, "offset").unwrap().parse().unwrap();
                assert_eq!(offset, end, "blocks follow each other");
                let at = start + offset;
                let length = u64::from_le_bytes(file[at..at + 8].try_into().unwrap()) as usize;
                end = offset + 8 + length;
                let block = &file[at + 8..at + 8 + length];
                let words = block.chunks(8).map(|word| word.try_into().unwrap_or_default());
                let halves = block.chunks(4).map(|word| word.try_into().unwrap_or_default());
                let numbers = match attribute(element, "type").unwrap() {
                    "Float64" => words.map(f64::from_le_bytes).collect(),
                    "Int64" => words.map(|word| i64::from_le_bytes(word) as f64).collect(),
                    "Int32" => halves.map(|word| f64::from(i32::from_le_bytes(word))).collect(),
                    "Float32" => halves.map(|word| f64::from(f32::from_le_bytes(word))).collect(),
                    _ => block.iter().map(|&byte| f64::from(byte)).collect(),
                };
                let components =
                    attribute(element, "NumberOfComponents").map_or(1, |n| n.parse().unwrap());
                (attribute(element, "Name").unwrap().to_owned(), components, numbers)
            })
            .collect();
        assert_eq!(&file[start + end..], b"\n</AppendedData>\n</VTKFile>\n");
        arrays
    }

    #[test]
    fn every_array_reads_back() {
        let mesh = TriangleMesh {
            positions: (0..4).map(|i| Vec3::new(f64::from(i), 0.1, -1.0 / 3.0)).collect(),
            triangles: vec![[0, 1, 2], [2, 1, 3]],
        };
        let pressure = [0.5, -0.5];
        let angle = [1.0, 2.0, 3.0, 4.0];
        let picture = Picture::new(&mesh)
            .with_point_data("displacement <mm>", Values::Vectors(&mesh.positions))
            .with_point_data("angle", Values::Scalars(&angle))
            .with_cell_data("pressure", Values::Scalars(&pressure))
            .with_cell_data("stress", Values::Singles(&[0.25, -3.0]));
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.vtu");
        picture.write(&path).unwrap();
        let file = std::fs::read(&path).unwrap();
        let xyz: Vec<f64> = mesh.positions.iter().flat_map(|v| [v.x, v.y, v.z]).collect();
        let named = |name: &str, components, numbers: &[f64]| {
            (name.to_owned(), components, numbers.to_vec())
        };
        assert_eq!(
            arrays(&file),
            [
                named("position", 3, &xyz),
                named("connectivity", 1, &[0.0, 1.0, 2.0, 2.0, 1.0, 3.0]),
                named("offsets", 1, &[3.0, 6.0]),
                named("types", 1, &[5.0, 5.0]),
                named("displacement &lt;mm&gt;", 3, &xyz),
                named("angle", 1, &angle),
                named("pressure", 1, &pressure),
                named("stress", 1, &[0.25, -3.0]),
            ]
        );
    }

    #[test]
    fn a_series_lists_its_pictures() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("bend.pvd");
        let pictures = [(0.0, "bend-000.vtu".to_owned()), (0.05, "bend-001.vtu".to_owned())];
        write_series(&path, &pictures).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        let listed: Vec<_> = text
            .split("<DataSet")
            .skip(1)
            .map(|element| {
                let time = attribute(element, "timestep").unwrap().parse().unwrap();
                (time, attribute(element, "file").unwrap().to_owned())
            })
            .collect();
        assert_eq!(listed, pictures);
    }
}
