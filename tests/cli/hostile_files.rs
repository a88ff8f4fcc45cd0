//! Files that are not what their names say, that have no end, or that speak to the terminal.

use std::path::Path;
use std::process::Command;

use super::workshop::Workshop;

/// What the scene gives a cube of 15 mm with a cavity of 5 mm.
const SOLID: &str = "[wall]\nthickness = 4\nclamp_height = 0.6\n[material]\nlaw = \"neo-hookean\"\nmu = 0.3\nbulk_modulus = 3.0\n\
                     [load]\npressure = 0.01\n[load.path]\nsteps = 1\n[solver]\nbackend = \"native\"\n";

fn grid(name: &str) -> Vec<u8> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/vtu");
    std::fs::read(folder.join(name)).unwrap()
}

/// One grid in two forms under wrong names: the same path, byte for byte.
#[test]
fn formats_are_seen_from_contents() {
    let workshop = Workshop::new();
    let mut paths = Vec::new();
    for (name, form) in [("part.VTU", "big_lz4_base64_64.vtu"), ("part.msh", "big_lzma_raw_32.vtu")]
    {
        workshop.write(name, grid(form));
        workshop.write("scene.toml", format!("[part]\ntetrahedra = \"{name}\"\n{SOLID}"));
        let out = format!("out of {form}");
        let said = workshop.run(&["simulate", "scene.toml", "--out", &out]);
        assert_eq!(said.code, 0, "{said:?}");
        paths.push(workshop.read(&format!("{out}/path.csv")));
    }
    assert!(paths[0].lines().count() > 1, "{}", paths[0]);
    assert_eq!(paths[0], paths[1]);
    let stl = "[part]\nstl = \"part.VTU\"\n";
    workshop.refuse_scene(
        &format!("{stl}{SOLID}"),
        &["part.VTU: is a VTK grid, not an STL; tetrahedra are given as `[part] tetrahedra`"],
    );
    workshop.write("part.stl", "ply\nformat ascii 1.0\n");
    workshop.refuse_scene("[part]\nstl = \"part.stl\"\n", &["part.stl: is a PLY surface, which is not read; `meshio convert part.ply part.stl` converts it"]);
    workshop.write("part.vtk", "# vtk DataFile Version 4.2\n");
    workshop.refuse_scene(
        "[part]\ntetrahedra = \"part.vtk\"\n",
        &["is a legacy VTK file, which is not read; `meshio convert", "part.vtk"],
    );
}

/// Opening a pipe that nobody writes would wait for ever, and a device has no end.
#[test]
fn only_files_are_read() {
    let workshop = Workshop::new();
    let made = Command::new("mkfifo").arg(workshop.path("pipe")).status().unwrap();
    assert!(made.success());
    let simulate = |scene: &str, words: &[&str]| {
        workshop.write("scene.toml", scene);
        let said = workshop.run(&["simulate", "scene.toml", "--out", "out"]);
        assert_eq!((said.code, said.err.lines().count()), (1, 1), "{said:?}");
        words.iter().for_each(|word| assert!(said.err.contains(word), "{said:?}"));
    };
    simulate("[part]\nstl = \"pipe\"\n", &["pipe: is a pipe, not a file"]);
    simulate("[part]\ntetrahedra = \"pipe\"\n", &["pipe: is a pipe, not a file"]);
    simulate("[part]\nnetwork = \"pipe\"\n", &["pipe: is a pipe, not a file"]);
    simulate("[part]\nstl = \"/dev/zero\"\n", &["/dev/zero: is a device, not a file"]);
    for command in [
        ["simulate", "pipe", "--out", "out"],
        ["evolve", "pipe", "--out", "out"],
        ["mesh", "pipe", "--out", "out"],
        ["simulate", "/dev/zero", "--out", "out"],
    ] {
        let said = workshop.run(&command);
        assert_eq!((said.code, said.err.lines().count()), (1, 1), "{said:?}");
        assert!(said.err.contains(", not a file"), "{said:?}");
    }
    assert!(!workshop.path("out").exists());
}

/// Names of files, keys and values of TOML, and words of a mesh, as a stranger may choose them.
#[test]
fn what_a_file_says_is_shown_and_not_obeyed() {
    let workshop = Workshop::new();
    let title = "\\u001b]0;owned\\u0007\\u009b31m";
    let long = "k".repeat(1_000_000);
    for scene in [
        format!("\"{title}\" = 1\n"),
        format!("[part]\nstl = \"{title}\"\n"),
        format!("[part]\nstl = \"a\"\n[material]\npreset = \"{title}\\r\\n\\u202e\"\n"),
        format!("{long} = 1\n"),
        format!("[part]\nstl = \"a\"\n[material]\npreset = \"{long}\"\n"),
        format!("[part]\nstl = \"a\"\n[wall]\nelement = \"{long}\"\n"),
    ] {
        workshop.write("scene.toml", &scene);
        let said = workshop.run(&["simulate", "scene.toml", "--out", "out"]);
        assert_eq!((said.code, said.err.lines().count()), (1, 1), "{said:?}");
        let obeyed = said.err.trim_end().chars().find(|c| c.is_control() || *c == '\u{202e}');
        assert_eq!(obeyed, None, "{said:?}");
        assert!(said.err.len() < 1500, "{} bytes", said.err.len());
    }
    workshop.write("part.stl", "solid a\nfacet normal 0 0 0\nouter loop\nvertex \u{1b}[31m 0 0\n");
    workshop.write("scene.toml", "[part]\nstl = \"part.stl\"\n");
    let said = workshop.run(&["simulate", "scene.toml", "--out", "out"]);
    assert!(said.err.contains("part.stl:4: `\\u{1b}[31m` is not a number"), "{said:?}");
}
