//! What an error costs, of shells and of solids: two parts on finer and finer meshes, against a solid finer than all.
//!
//! ```text
//! cargo run --release --example fidelity_cost -- FOLDER [basic_bend | pneunet]
//! ```
//!
//! Every run is the walk of a scene on one thread; FOLDER receives the scene files, and a table and
//! a figure for each part. The error is the distance between the displacements of the tip, over the
//! length of the finest solid's. That solid, and the others, stand around one mid-surface with
//! edges of 1.5 mm; shells stand on their own. What remains of a shell's error on fine meshes is
//! the price of its theory. Half an hour.

#![allow(clippy::print_stdout, reason = "it is a program that prints a table")]

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail, ensure};
use pneumorph::math::{Vec3, cpu_seconds};
use pneumorph::report::{ErrorCurve, ErrorPoint, error_svg, png};
use pneumorph::scene::{Scene, Unobserved};
use pneumorph::solve::{Backend, Stop};

/// A network beside the examples, and what its scenes hold.
struct Part {
    name: &'static str,
    title: &'static str,
    load: &'static str,
}

const PARTS: [Part; 2] = [
    Part {
        name: "basic_bend",
        title: "basic_bend at 0.012 MPa, wall 1.6 mm, incompressible: tip against the finest solid",
        load: "[load]\npressure = 0.012\n\n[load.path]\nsteps = 4\n",
    },
    Part {
        name: "pneunet",
        title: "pneunet at 0.01 MPa, wall 1.6 mm, incompressible: tip against the finest solid",
        load: "[load]\npressure = 0.01\n\n[load.path]\nsteps = 4\n",
    },
];
const SHELLS: [(&str, &str); 2] =
    [("loop", "shell, Loop subdivision"), ("mid-edge", "shell, mid-edge")];
const SHELL_EDGES: [f64; 5] = [5.0, 4.0, 3.0, 2.0, 1.5];
const SOLID_EDGES: [f64; 4] = [5.0, 4.0, 3.0, 2.0];
const FINEST_EDGE: f64 = 1.4;
/// Of the surface that solids stand around, mm.
const MIDDLE_EDGE: f64 = 1.5;

/// What a run gave.
struct Run {
    tip: Vec3,
    point: ErrorPoint,
}

fn main() -> anyhow::Result<()> {
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global()?;
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [folder, names @ ..] = words.as_slice() else {
        bail!("name a folder for the results");
    };
    let folder = PathBuf::from(folder);
    fs::create_dir(&folder).with_context(|| format!("{} cannot be made", folder.display()))?;
    for name in names {
        let known = PARTS.map(|part| part.name);
        ensure!(known.contains(&name.as_str()), "there is no part {name}, but {known:?}");
    }
    for part in PARTS.iter().filter(|part| names.is_empty() || names.iter().any(|n| n == part.name))
    {
        study(part, &folder)?;
    }
    Ok(())
}

fn study(part: &Part, folder: &Path) -> anyhow::Result<()> {
    let solid = |edge| {
        let mesh = format!("[mesh]\nedge = {MIDDLE_EDGE}\n\n[solid]\nedge = {edge}\n");
        run(part, &format!("solid_{edge}"), &mesh, folder)
    };
    let reference = solid(FINEST_EDGE)?;
    println!(
        "{}: reference {:.4} mm, {:.1} s",
        part.name,
        reference.tip.transpose(),
        reference.point.cpu_seconds
    );
    let mut table = csv::Writer::from_path(folder.join(format!("{}.csv", part.name)))?;
    table.write_record([
        "element",
        "edge",
        "unknowns",
        "cpu_seconds",
        "tip_x",
        "tip_y",
        "tip_z",
        "error_percent",
    ])?;
    let mut judged = |element: &str, edge: f64, mut run: Run| -> anyhow::Result<ErrorPoint> {
        run.point.error = 100.0 * (run.tip - reference.tip).norm() / reference.tip.norm();
        let ErrorPoint { cpu_seconds, unknowns, error } = run.point;
        println!("{element}, {edge} mm: {unknowns} unknowns, {cpu_seconds:.2} s, {error:.2} %");
        let numbers = [edge, unknowns as f64, cpu_seconds, run.tip.x, run.tip.y, run.tip.z, error];
        let numbers = numbers.map(|number| number.to_string());
        table.write_record(std::iter::once(element).chain(numbers.iter().map(String::as_str)))?;
        table.flush()?;
        Ok(run.point)
    };
    let mut curves = Vec::new();
    for (element, title) in SHELLS {
        let mut runs = Vec::new();
        for edge in SHELL_EDGES {
            let mesh = format!("[mesh]\nedge = {edge}\n\n[wall]\nelement = \"{element}\"\n");
            match run(part, &format!("{element}_{edge}"), &mesh, folder) {
                Ok(run) => runs.push(judged(element, edge, run)?),
                Err(error) => println!("{element}, {edge} mm: {error:#}"),
            }
        }
        curves.push(ErrorCurve { element: title.to_owned(), runs, accepted: None });
    }
    let mut runs = Vec::new();
    for edge in SOLID_EDGES {
        runs.push(judged("solid", edge, solid(edge)?)?);
    }
    curves.push(ErrorCurve {
        element: "solid, quadratic tetrahedra".to_owned(),
        runs,
        accepted: None,
    });
    let svg = error_svg(part.title, &curves);
    fs::write(folder.join(format!("{}.svg", part.name)), &svg)?;
    fs::write(folder.join(format!("{}.png", part.name)), png(&svg, 2.0))?;
    Ok(())
}

/// Walks the scene `name` of a part with the mesh sections `mesh`.
fn run(part: &Part, name: &str, mesh: &str, folder: &Path) -> anyhow::Result<Run> {
    let network = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/networks");
    let text = format!(
        "[part]\nnetwork = {:?}\n\n{mesh}\n[material]\nlaw = \"neo-hookean\"\nmu = 1.0\n\n{}",
        network.join(format!("{}.toml", part.name)),
        part.load
    );
    let path = folder.join(format!("{}_{name}.toml", part.name));
    fs::write(&path, &text)?;
    let start = cpu_seconds();
    let scene = Scene::parse(&text, &path, Some(Backend::Native))?;
    let walk = scene.walk(Stop::NEVER, &Unobserved)?;
    // Of programs that make tetrahedra only the time on the clock is known.
    let cpu_seconds = cpu_seconds() - start + walk.mesher_seconds;
    let last = walk.observations.last().context("the part is not stable at rest")?;
    let tip = Vec3::new(last.tip_x, last.tip_y, last.tip_z);
    let unknowns = walk.model.unknowns();
    Ok(Run { tip, point: ErrorPoint { cpu_seconds, unknowns, error: 0.0 } })
}
