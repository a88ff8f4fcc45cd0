//! Which format the file of a part has, by its first bytes, whatever its name ends in.
//!
//! What is read is an STL surface, a mesh of Gmsh's and a VTK grid of tetrahedra. Other formats of the field are known by name, with the
//! command that converts them; `meshio`, `trimesh` and `pyvista` are packages of PyPI, `gmsh` one of Debian.

use std::path::Path;

use super::{ChamberChoice, InputError, OwnSolid, input, msh, stl, vtu_solid};

/// A file's format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    /// An STL surface, as text or binary.
    Stl,
    /// A mesh of Gmsh's.
    Gmsh,
    /// An unstructured grid of VTK's, as XML.
    Vtu,
    /// A known one that is not read.
    Foreign(Foreign),
    /// None of them.
    Unknown,
}

/// A format that is known by name alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Foreign {
    /// With its article.
    name: &'static str,
    /// What the names of such files end in, by which converters know them.
    endings: &'static [&'static str],
    /// What turns FILE into STEM.stl.
    surface: Option<&'static str>,
    /// What turns FILE into STEM.vtu or STEM.msh.
    solid: Option<&'static str>,
}

/// The solid wall of the file `path`, a mesh of Gmsh's or a VTK grid, mm, with the chamber of the `choice`; straight edges get their midpoints.
///
/// # Errors
/// [`InputError`] when the file cannot be read or is of another format, or its tetrahedra do not fit together.
pub fn solid(path: &Path, choice: &ChamberChoice) -> Result<OwnSolid, InputError> {
    let bytes = input::bytes(path, input::DATA)?;
    let raw = if is_vtu(&bytes, path)? { vtu_solid::parse(&bytes) } else { msh::parse(&bytes) };
    raw.and_then(|raw| raw.solid(choice)).map_err(|what| InputError::new(path, what))
}

/// Refuses what is no surface in STL, by the `bytes` of the file `path`; an unknown format is left to STL's reader to explain.
///
/// # Errors
/// [`InputError`] with what the file is, and what would make it one that is read.
pub(super) fn check_surface(bytes: &[u8], path: &Path) -> Result<(), InputError> {
    match format(bytes) {
        Format::Stl | Format::Unknown => Ok(()),
        Format::Gmsh => Err(InputError::new(
            path,
            format!(
                "is a mesh of Gmsh's, not an STL; tetrahedra are given as `[part] tetrahedra`, triangles are converted by `{}`",
                command("meshio convert FILE STEM.stl", &["msh"], path)
            ),
        )),
        Format::Vtu => Err(InputError::new(
            path,
            format!(
                "is a VTK grid, not an STL; tetrahedra are given as `[part] tetrahedra`, triangles are converted by `{}`",
                command("meshio convert FILE STEM.stl", &["vtu"], path)
            ),
        )),
        Format::Foreign(foreign) => Err(foreign.refusal(foreign.surface, path)),
    }
}

/// Whether the `bytes` of the file `path` are a VTK grid; otherwise they are for the reader of Gmsh's meshes, which explains unknown ones.
///
/// # Errors
/// [`InputError`] with what the file is, and what would make it one that is read.
fn is_vtu(bytes: &[u8], path: &Path) -> Result<bool, InputError> {
    match format(bytes) {
        Format::Vtu => Ok(true),
        Format::Gmsh | Format::Unknown => Ok(false),
        Format::Stl => {
            Err(InputError::new(path, "is an STL surface, not tetrahedra; give it as `[part] stl`"))
        }
        Format::Foreign(foreign) => Err(foreign.refusal(foreign.solid, path)),
    }
}

impl Foreign {
    fn refusal(self, converter: Option<&str>, path: &Path) -> InputError {
        let Self { name, endings, .. } = self;
        let what = match converter {
            Some(converter) => {
                format!(
                    "is {name}, which is not read; `{}` converts it",
                    command(converter, endings, path)
                )
            }
            None => format!("is {name}, which is not read"),
        };
        InputError::new(path, what)
    }
}

/// The command for the file `path`; for one called part, where its name is quoted or has none of the `endings`.
fn command(pattern: &str, endings: &[&str], path: &Path) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "._-/+,".contains(c);
    let ending = path.extension().unwrap_or_default().to_string_lossy();
    let is_known = endings.is_empty() || endings.contains(&&*ending);
    let name = if is_known && path.to_string_lossy().chars().all(is_plain) {
        path.to_owned()
    } else {
        Path::new("part").with_extension(endings.first().unwrap_or(&""))
    };
    let stem = name.with_extension("");
    pattern.replace("FILE", &name.to_string_lossy()).replace("STEM", &stem.to_string_lossy())
}

/// How far into a file its kind is looked for, bytes.
const HEAD: usize = 4096;

/// The format of a file of these `bytes`.
pub(super) fn format(bytes: &[u8]) -> Format {
    if stl::is_binary(bytes) {
        return Format::Stl;
    }
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    if let Some(foreign) = MAGIC.iter().find(|(magic, _)| bytes.starts_with(magic)) {
        return Format::Foreign(foreign.1);
    }
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(HEAD)]);
    let head = head.trim_start();
    let first = head.lines().next().unwrap_or_default().trim_end();
    if stl::is_text(bytes) && (head.to_ascii_lowercase().contains("facet") || head.len() < HEAD / 2)
    {
        Format::Stl
    } else if head.starts_with('<') {
        xml(head)
    } else if first.starts_with('$')
        && GMSH_SECTIONS.iter().any(|section| first[1..].starts_with(section))
    {
        Format::Gmsh
    } else {
        text(head, first).map_or(Format::Unknown, Format::Foreign)
    }
}

/// Sections with which a mesh of Gmsh's may begin.
const GMSH_SECTIONS: [&str; 8] = [
    "MeshFormat",
    "Comment",
    "PhysicalNames",
    "Entities",
    "Nodes",
    "Elements",
    "NOD",
    "MeshVersion",
];

const MESHIO: Foreign = Foreign {
    name: "",
    endings: &[],
    surface: Some("meshio convert FILE STEM.stl"),
    solid: Some("meshio convert FILE STEM.vtu"),
};
const TRIMESH: Foreign = Foreign {
    name: "",
    endings: &[],
    surface: Some(
        "python3 -c \"import trimesh; trimesh.load('FILE', force='mesh').export('STEM.stl')\"",
    ),
    solid: None,
};
const GMSH: Foreign = Foreign {
    name: "",
    endings: &[],
    surface: Some("gmsh -2 FILE -o STEM.stl"),
    solid: Some("gmsh -3 FILE -o STEM.msh"),
};
const NONE: Foreign = Foreign { name: "", endings: &[], surface: None, solid: None };

/// Beginnings of files that are no text, or have one word of their own.
const MAGIC: [(&[u8], Foreign); 13] = [
    (b"# vtk DataFile", Foreign { name: "a legacy VTK file", endings: &["vtk"], ..MESHIO }),
    (
        b"PK\x03\x04",
        Foreign { name: "a 3MF part or another ZIP archive", endings: &["3mf"], ..TRIMESH },
    ),
    (
        b"\x1f\x8b",
        Foreign {
            name: "a file packed by gzip",
            endings: &[],
            surface: Some("gunzip FILE"),
            solid: Some("gunzip FILE"),
        },
    ),
    (
        b"\x89HDF",
        Foreign { name: "an HDF5 file (MED, CGNS, XDMF's data)", endings: &["med"], ..MESHIO },
    ),
    (b"glTF", Foreign { name: "a glTF model", endings: &["glb"], ..TRIMESH }),
    (b"ply\n", Foreign { name: "a PLY surface", endings: &["ply"], solid: None, ..MESHIO }),
    (b"ply\r", Foreign { name: "a PLY surface", endings: &["ply"], solid: None, ..MESHIO }),
    (b"ISO-10303-21", Foreign { name: "a STEP file", endings: &["step", "stp"], ..GMSH }),
    (
        b"DBRep_DrawableShape",
        Foreign { name: "a BREP file of OpenCASCADE", endings: &["brep"], ..GMSH },
    ),
    (
        b"CASCADE Topology",
        Foreign { name: "a BREP file of OpenCASCADE", endings: &["brep"], ..GMSH },
    ),
    (
        b"\xd0\xcf\x11\xe0",
        Foreign { name: "a document of a CAD program; export an STL there", ..NONE },
    ),
    (b"%PDF", Foreign { name: "a PDF", ..NONE }),
    (b"\x89PNG", Foreign { name: "a PNG picture", ..NONE }),
];

fn xml(head: &str) -> Format {
    let vtk_type = || {
        let tag = &head[head.find("<VTKFile")?..];
        let tag = &tag[..tag.find('>').unwrap_or(tag.len())];
        // Not of `header_type`.
        let (place, _) = tag
            .match_indices("type")
            .find(|&(place, _)| tag[..place].ends_with(|c: char| c.is_ascii_whitespace()))?;
        let value = tag[place + 4..].trim_start().strip_prefix('=')?.trim_start();
        let quote = value.chars().next().filter(|quote| "\"'".contains(*quote))?;
        value[1..].split(quote).next()
    };
    let tags = [
        ("<febio_spec", Foreign { name: "an input file of FEBio", ..NONE }),
        ("<Xdmf", Foreign { name: "an XDMF file", endings: &["xdmf", "xmf"], ..MESHIO }),
        ("<dolfin", Foreign { name: "a mesh of DOLFIN", endings: &["xml"], ..MESHIO }),
        ("<amf", Foreign { name: "an AMF part; export an STL instead", ..NONE }),
        ("<svg", Foreign { name: "an SVG picture", ..NONE }),
        ("<html", Foreign { name: "a web page", ..NONE }),
    ];
    match vtk_type() {
        Some("UnstructuredGrid") => Format::Vtu,
        Some("PolyData") => Format::Foreign(Foreign {
            name: "VTK's surface (.vtp)",
            endings: &["vtp"],
            surface: Some(
                "python3 -c \"import pyvista; pyvista.read('FILE').triangulate().save('STEM.stl')\"",
            ),
            solid: None,
        }),
        Some("PUnstructuredGrid") => Format::Foreign(Foreign {
            name: "a list of VTK grids (.pvtu)",
            endings: &["pvtu"],
            surface: None,
            solid: Some("python3 -c \"import pyvista; pyvista.read('FILE').save('STEM.vtu')\""),
        }),
        Some("Collection") => Format::Foreign(Foreign {
            name: "a list of pictures (.pvd); give one of its .vtu files",
            ..NONE
        }),
        Some(_) => Format::Foreign(Foreign {
            name: "a VTK file of another type than UnstructuredGrid",
            ..NONE
        }),
        None => match tags.iter().find(|(tag, _)| head.contains(tag)) {
            Some((_, foreign)) => Format::Foreign(*foreign),
            None => Format::Unknown,
        },
    }
}

fn text(head: &str, first: &str) -> Option<Foreign> {
    let begins = |word: &str| {
        let start = first.get(..word.len()).unwrap_or_default();
        start.eq_ignore_ascii_case(word)
    };
    let lines = || head.lines().map(str::trim_start);
    let has_line = |beginning: &str| lines().any(|line| line.starts_with(beginning));
    if head.is_empty() {
        Some(Foreign { name: "an empty file", ..NONE })
    } else if begins("MeshVersionFormatted") {
        Some(Foreign { name: "a mesh of Medit", endings: &["mesh"], ..MESHIO })
    } else if ["OFF", "COFF", "NOFF", "CNOFF"]
        .contains(&first.split(' ').next().unwrap_or_default())
    {
        Some(Foreign { name: "an OFF surface", endings: &["off"], solid: None, ..MESHIO })
    } else if first.starts_with('(') && first[1..].starts_with(|c: char| c.is_ascii_digit()) {
        Some(Foreign { name: "a mesh of ANSYS Fluent", endings: &["msh"], ..MESHIO })
    } else if begins("*KEYWORD") {
        Some(Foreign { name: "an input file of LS-DYNA", ..NONE })
    } else if first.starts_with('*') && has_line("*") {
        Some(Foreign { name: "an input file of Abaqus or CalculiX", endings: &["inp"], ..MESHIO })
    } else if has_line("BEGIN BULK") || has_line("GRID,") || has_line("GRID ") || has_line("GRID*")
    {
        Some(Foreign {
            name: "an input file of Nastran",
            endings: &["bdf", "nas", "fem"],
            ..MESHIO
        })
    } else if first == "-1" {
        Some(Foreign {
            name: "a universal file (UNV)",
            endings: &["unv"],
            surface: None,
            solid: Some("gmsh -save FILE -o STEM.msh"),
        })
    } else if begins("/PREP7") || begins("/COM,") {
        Some(Foreign { name: "a database of ANSYS Mechanical", ..NONE })
    } else if first.as_bytes().get(72) == Some(&b'S') && first.len() == 80 {
        Some(Foreign { name: "an IGES file", endings: &["igs", "iges"], ..GMSH })
    } else if has_line("v ") && (has_line("f ") || has_line("v  ") || head.len() + 4 > HEAD) {
        Some(Foreign { name: "an OBJ surface", endings: &["obj"], solid: None, ..MESHIO })
    } else if GEO.iter().any(|word| has_line(word)) {
        Some(Foreign { name: "a geometry of Gmsh's", endings: &["geo"], ..GMSH })
    } else if ["[part]", "[part.", "[[node]]", "[[nodes]]", "[[link]]", "[material]"]
        .iter()
        .any(|word| has_line(word))
    {
        Some(Foreign { name: "a TOML file, as scenes, runs and networks are", ..NONE })
    } else if is_tetgen(first, lines()) {
        Some(Foreign {
            name: "a file of TetGen's nodes",
            endings: &["node"],
            surface: None,
            ..MESHIO
        })
    } else {
        None
    }
}

/// Words of Gmsh's language for geometries.
const GEO: [&str; 8] =
    ["SetFactory(", "Point(", "Point (", "Merge \"", "Box(", "Cylinder(", "Sphere(", "Mesh."];

/// `points 3 attributes markers`, then `number x y z ...`.
fn is_tetgen<'a>(first: &'a str, lines: impl Iterator<Item = &'a str>) -> bool {
    let mut told = lines.filter(|line| !line.is_empty() && !line.starts_with('#'));
    let words = |line: &str| {
        line.split_ascii_whitespace().map(str::parse::<f64>).collect::<Result<Vec<_>, _>>()
    };
    let head = if first.starts_with('#') {
        told.next()
    } else {
        told.next().filter(|line| line.trim_end() == first)
    };
    let (Some(Ok(head)), Some(Ok(node))) = (head.map(words), told.next().map(words)) else {
        return false;
    };
    head.len() == 4 && head[1] == 3.0 && node.len() >= 4
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(bytes: &[u8], as_surface: bool, name: &str) -> Result<(), String> {
        let path = Path::new(name);
        let checked =
            if as_surface { check_surface(bytes, path) } else { is_vtu(bytes, path).map(|_| ()) };
        checked.map_err(|error| error.what)
    }

    /// Beginnings as meshio 5.3, trimesh 4, pyvista 0.46, gmsh 4.8 and OpenCASCADE write them; each command was run.
    #[test]
    fn other_formats_are_named_with_what_converts_them() {
        let meshio = |file: &str, new: &str| format!("`meshio convert {file} {new}` converts it");
        #[expect(clippy::type_complexity, reason = "a table of five columns")]
        let cases: [(&str, &[u8], &str, Option<String>, Option<String>); 17] = [
            ("a.vtk", b"# vtk DataFile Version 5.1\n", "a legacy VTK file", Some(meshio("a.vtk", "a.stl")), Some(meshio("a.vtk", "a.vtu"))),
            ("a.inp", b"*HEADING\nAbaqus DataFile Version 6.14\n*NODE\n", "an input file of Abaqus or CalculiX", Some(meshio("a.inp", "a.stl")), Some(meshio("a.inp", "a.vtu"))),
            ("a.bdf", b"$ Nastran file written by\nBEGIN BULK\nGRID*   1\n", "an input file of Nastran", None, Some(meshio("a.bdf", "a.vtu"))),
            ("a.msh", b"(1 \"meshio 5.3.5\")\n(2 3)\n", "a mesh of ANSYS Fluent", None, Some(meshio("a.msh", "a.vtu"))),
            ("a.mesh", b"MeshVersionFormatted 2\nDimension 3\n", "a mesh of Medit", None, Some(meshio("a.mesh", "a.vtu"))),
            ("a.node", b"# made by\n175 3 0 0\n0 0.0 0.0 0.0\n", "a file of TetGen's nodes", None, Some(meshio("a.node", "a.vtu"))),
            ("a.node", b"175 3 0 0\n0 0.0 0.0 0.0\n", "a file of TetGen's nodes", None, Some(meshio("a.node", "a.vtu"))),
            ("a.obj", b"# comment\nv -0.5 -0.5 -0.5\nv 1 1 1\nf 1 2 3\n", "an OBJ surface", Some(meshio("a.obj", "a.stl")), None),
            ("a.ply", b"ply\nformat binary_little_endian 1.0\n", "a PLY surface", Some(meshio("a.ply", "a.stl")), None),
            ("a.off", b"OFF\n8 12 0\n", "an OFF surface", Some(meshio("a.off", "a.stl")), None),
            ("a.step", b"ISO-10303-21;\nHEADER;\n", "a STEP file", Some("`gmsh -2 a.step -o a.stl` converts it".into()), Some("`gmsh -3 a.step -o a.msh` converts it".into())),
            ("a.geo", b"// box\nSetFactory(\"OpenCASCADE\");\n", "a geometry of Gmsh's", Some("`gmsh -2 a.geo -o a.stl` converts it".into()), Some("`gmsh -3 a.geo -o a.msh` converts it".into())),
            ("a.unv", b"    -1\n  2411\n", "a universal file (UNV)", None, Some("`gmsh -save a.unv -o a.msh` converts it".into())),
            ("a.3mf", b"PK\x03\x04\x14", "a 3MF part or another ZIP archive", Some("`python3 -c \"import trimesh; trimesh.load('a.3mf', force='mesh').export('a.stl')\"` converts it".into()), None),
            ("a.vtp", b"<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\">", "VTK's surface (.vtp)", Some("`python3 -c \"import pyvista; pyvista.read('a.vtp').triangulate().save('a.stl')\"` converts it".into()), None),
            ("a.toml", b"length_unit_mm = 10.0\n\n[[node]]\n", "a TOML file, as scenes, runs and networks are", None, None),
            ("a.stl", b" \n", "an empty file", None, None),
        ];
        for (name, bytes, is, surface, solid) in cases {
            for (as_surface, converts) in [(true, surface), (false, solid)] {
                let wrongly_called = told(bytes, as_surface, "some part.txt").unwrap_err();
                let told = told(bytes, as_surface, name).unwrap_err();
                let start = format!("is {is}, which is not read");
                assert!(told.starts_with(&start), "{name}: {told}");
                if let Some(converts) = converts {
                    assert_eq!(told, format!("{start}; {converts}"));
                    let called = converts.replace(" a.", " part.").replace("'a.", "'part.");
                    assert_eq!(wrongly_called, format!("{start}; {called}"));
                }
            }
        }
    }

    /// The ending says nothing.
    #[test]
    fn formats_are_seen_from_their_bytes() {
        let grid = b"\xef\xbb\xbf<VTKFile header_type='UInt64' type='UnstructuredGrid'>";
        assert_eq!(format(grid), Format::Vtu);
        assert_eq!(is_vtu(grid, Path::new("a.stl")), Ok(true));
        assert_eq!(is_vtu(b"$MeshFormat\n", Path::new("a.vtu")), Ok(false));
        assert_eq!(format(b"$Comments\n"), Format::Gmsh);
        for text in ["solid\nfacet normal 0 0 1\n", "\u{feff} SOLID a\nendsolid"] {
            assert_eq!(format(text.as_bytes()), Format::Stl);
            assert_eq!(
                told(text.as_bytes(), false, "a.msh").unwrap_err(),
                "is an STL surface, not tetrahedra; give it as `[part] stl`"
            );
        }
        // A binary STL may have any header.
        let mut binary = b"ply\n".to_vec();
        binary.resize(84 + 50, 0);
        binary[80] = 1;
        assert_eq!(format(&binary), Format::Stl);
        assert_eq!(
            told(b"$MeshFormat\n", true, "b c.stl").unwrap_err(),
            "is a mesh of Gmsh's, not an STL; tetrahedra are given as `[part] tetrahedra`, triangles are converted by `meshio convert part.msh part.stl`"
        );
        assert!(
            told(grid, true, "a.vtu").unwrap_err().starts_with("is a VTK grid, not an STL; tetra")
        );
        assert_eq!(format(b"a letter"), Format::Unknown);
    }
}
