//! Good files of every format that the program reads, from which bad ones are made.

use std::fs;
use std::io;
use std::path::Path;

use pneumorph::cli::Input;
use pneumorph::io::{ChamberChoice, msh, part_file, stl};
use pneumorph::mesh::SolidMesh;
use pneumorph::surface::TriangleMesh;

/// Files of one format.
pub(crate) struct Corpus {
    /// What the format is called.
    pub name: &'static str,
    /// Which reader it is for.
    pub input: Input,
    /// Of the file that holds it, in a folder of its own.
    pub file: String,
    /// Contents.
    pub good: Vec<Vec<u8>>,
}

impl Corpus {
    /// Whether the file is one of a run's folder.
    pub(crate) fn is_in_a_run(&self) -> bool {
        self.input == Input::RunFolder
    }
}

type Failure = Box<dyn std::error::Error + Send + Sync>;

/// The files of every format; those of a finished run, where its `folder` is given.
pub(crate) fn all(folder: Option<&Path>) -> Result<Vec<Corpus>, Failure> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut all = Vec::new();
    let mut add = |name, input, file: &str, good: Vec<Vec<u8>>| {
        assert!(!good.is_empty(), "{name} has files");
        all.push(Corpus { name, input, file: file.to_owned(), good });
    };
    let sphere = TriangleMesh::sphere(10.0, 1);
    let place = tempfile::tempdir()?;
    let binary = place.path().join("part.stl");
    stl::write(&binary, &sphere)?;
    add("STL text", Input::Surface, "part.stl", vec![stl_text(&sphere)]);
    add("STL binary", Input::Surface, "part.stl", vec![fs::read(&binary)?]);

    let grids = root.join("tests/data/vtu");
    let solid = part_file::solid(&grids.join("ascii.vtu"), &ChamberChoice::default())?.mesh;
    let text = place.path().join("part.msh");
    msh::write(&text, &solid)?;
    add("msh 2.2 text", Input::Tetrahedra, "part.msh", vec![fs::read(&text)?]);
    for (name, is_version_4, is_binary) in [
        ("msh 2.2 binary", false, true),
        ("msh 4.1 text", true, false),
        ("msh 4.1 binary", true, true),
    ] {
        add(name, Input::Tetrahedra, "part.msh", vec![mesh_file(&solid, is_version_4, is_binary)]);
    }
    let of_grids = |words: &[&str]| -> io::Result<Vec<Vec<u8>>> {
        let files = files(&grids)?
            .into_iter()
            .filter(|(name, _)| words.iter().any(|word| name.contains(word)));
        Ok(files.map(|(_, bytes)| bytes).collect())
    };
    add("VTU text", Input::Tetrahedra, "part.vtu", of_grids(&["ascii", "pieces"])?);
    add("VTU plain", Input::Tetrahedra, "part.vtu", of_grids(&["plain"])?);
    add("VTU zlib", Input::Tetrahedra, "part.vtu", of_grids(&["zlib", "mixed", "ids32"])?);
    add("VTU LZ4", Input::Tetrahedra, "part.vtu", of_grids(&["lz4"])?);
    add("VTU LZMA", Input::Tetrahedra, "part.vtu", of_grids(&["lzma"])?);

    let settings = |folder: &str| -> io::Result<Vec<Vec<u8>>> {
        let files =
            files(&root.join(folder))?.into_iter().filter(|(name, _)| name.ends_with(".toml"));
        Ok(files.map(|(_, bytes)| bytes).collect())
    };
    let mut scenes = settings("examples/scenes")?;
    scenes.extend(
        MATERIALS
            .iter()
            .map(|material| format!("[part]\nstl = \"a\"\n[material]\n{material}").into()),
    );
    add("scene", Input::Scene, "scene.toml", scenes);
    add("run", Input::Run, "run.toml", settings("examples")?);
    add("network", Input::Network, "network.toml", settings("examples/networks")?);
    add("CalculiX .dat", Input::TipAnswer, "solid.dat", vec![TIPS.into()]);
    add("CalculiX .frd", Input::NodalAnswer, "solid.frd", vec![NODES.into()]);
    if let Some(folder) = folder {
        for (name, file) in
            [("run.toml of a run", "run.toml"), ("candidates.jsonl", "candidates.jsonl")]
        {
            add(name, Input::RunFolder, file, vec![fs::read(folder.join(file))?]);
        }
        let (file, bytes) = files(&folder.join("checkpoints"))?.pop().ok_or("no checkpoint")?;
        add("checkpoint", Input::RunFolder, &format!("checkpoints/{file}"), vec![bytes]);
    }
    Ok(all)
}

/// Names and contents of the files in `folder`, sorted.
fn files(folder: &Path) -> io::Result<Vec<(String, Vec<u8>)>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_file() {
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            files.push((name, fs::read(&path)?));
        }
    }
    files.sort();
    Ok(files)
}

fn stl_text(mesh: &TriangleMesh) -> Vec<u8> {
    let mut text = "solid sphere\n".to_owned();
    for t in 0..mesh.triangles.len() {
        text += "facet normal 0 0 0\nouter loop\n";
        for corner in mesh.corners(t) {
            text += &format!("vertex {} {} {}\n", corner.x, corner.y, corner.z);
        }
        text += "endloop\nendfacet\n";
    }
    (text + "endsolid sphere\n").into()
}

/// Numbers as a mesh file has them.
struct Writer {
    bytes: Vec<u8>,
    is_binary: bool,
}

impl Writer {
    fn int(&mut self, number: usize) {
        self.number(number, &(number as u32).to_le_bytes());
    }

    fn size(&mut self, number: usize) {
        self.number(number, &(number as u64).to_le_bytes());
    }

    fn double(&mut self, number: f64) {
        self.number(number, &number.to_le_bytes());
    }

    fn number(&mut self, number: impl std::fmt::Display, raw: &[u8]) {
        if self.is_binary {
            self.bytes.extend(raw);
        } else {
            self.bytes.extend(format!("{number} ").bytes());
        }
    }

    fn text(&mut self, text: &str) {
        self.bytes.extend(text.bytes());
    }
}

/// The corners and tetrahedra of `solid`, and its chamber as a group of that name, as Gmsh writes them.
fn mesh_file(solid: &SolidMesh, is_version_4: bool, is_binary: bool) -> Vec<u8> {
    let mut file = Writer { bytes: Vec::new(), is_binary };
    let version = if is_version_4 { "4.1" } else { "2.2" };
    file.text(&format!("$MeshFormat\n{version} {} 8\n", u8::from(is_binary)));
    if is_binary {
        file.int(1);
        file.text("\n");
    }
    file.text(
        "$EndMeshFormat\n$PhysicalNames\n2\n2 5 \"chamber\"\n3 1 \"wall\"\n$EndPhysicalNames\n",
    );
    if is_version_4 {
        file.text("$Entities\n");
        [0, 0, 1, 1].into_iter().for_each(|count| file.size(count));
        for group in [5, 1] {
            file.int(1);
            [0.0, 0.0, 0.0, 15.0, 15.0, 15.0].into_iter().for_each(|x| file.double(x));
            file.size(1);
            file.int(group);
            file.size(0);
        }
        file.text("\n$EndEntities\n");
    }
    let nodes = &solid.positions[..solid.corners];
    file.text("$Nodes\n");
    if is_version_4 {
        [1, nodes.len(), 1, nodes.len()].into_iter().for_each(|count| file.size(count));
        [3, 1, 0].into_iter().for_each(|number| file.int(number));
        file.size(nodes.len());
        (1..=nodes.len()).for_each(|number| file.size(number));
        nodes.iter().flat_map(|x| [x.x, x.y, x.z]).for_each(|x| file.double(x));
    } else {
        file.text(&format!("{}\n", nodes.len()));
        for (x, number) in nodes.iter().zip(1..) {
            file.int(number);
            [x.x, x.y, x.z].into_iter().for_each(|x| file.double(x));
        }
    }
    file.text("\n$EndNodes\n$Elements\n");
    let triangles = solid.chamber.iter().map(|nodes| nodes[..3].to_vec()).collect();
    let tetrahedra = solid.tetrahedra.iter().map(|nodes| nodes[..4].to_vec()).collect();
    let blocks: [(usize, usize, usize, Vec<Vec<u32>>); 2] =
        [(2, 2, 5, triangles), (3, 4, 1, tetrahedra)];
    let count = solid.chamber.len() + solid.tetrahedra.len();
    if is_version_4 {
        [2, count, 1, count].into_iter().for_each(|count| file.size(count));
    } else {
        file.text(&format!("{count}\n"));
    }
    let mut number = 0;
    for (dimension, kind, group, cells) in blocks {
        if is_version_4 {
            [dimension, 1, kind].into_iter().for_each(|number| file.int(number));
            file.size(cells.len());
        } else if is_binary {
            [kind, cells.len(), 2].into_iter().for_each(|number| file.int(number));
        }
        for cell in cells {
            number += 1;
            if is_version_4 {
                file.size(number);
                cell.iter().for_each(|&node| file.size(node as usize + 1));
                continue;
            }
            file.int(number);
            if !is_binary {
                [kind, 2].into_iter().for_each(|number| file.int(number));
            }
            [group, group].into_iter().for_each(|group| file.int(group));
            cell.iter().for_each(|&node| file.int(node as usize + 1));
        }
    }
    file.text("\n$EndElements\n");
    file.bytes
}

const MATERIALS: [&str; 5] = [
    "law = \"neo-hookean\"\nyoung_modulus = 12.0\npoisson_ratio = 0.49\n",
    "law = \"ogden\"\nterms = [{ mu = 1.0, alpha = 2.0 }, { mu = -0.1, alpha = -2.0 }]\nbulk_modulus = 100.0\n",
    "law = \"yeoh\"\nc = [0.1, 0.02, 0.001]\n",
    "law = \"mooney-rivlin\"\nc1 = 0.2\nc2 = 0.05\nbulk_modulus = 50\n",
    "preset = \"ninjaflex-yap2016\"\n",
];

const TIPS: &str = "\n displacements (vx,vy,vz) for set TIP and time  0.5000000E+00\n\n       \
    820 -1.143620E+01 -8.000000E-03  2.000000E+00\n        21 -1.243620E+01  0.000000E+00  4.000000E+00\n";

const NODES: &str = "    1C\n  100CL  101 5.00000E-01           2                     0    1           1\n \
    -4  DISP        4    1\n -5  D1          1    2    1    0\n -1         1 0.00000E+00-2.00000E-01 0.00000E+00\n \
    -1        12 0.00000E+00 0.00000E+00-1.00000E+01\n -3\n 9999\n";
