//! What an error costs, of shells and of solids: two parts on finer and finer meshes, against a solid finer than all.
//!
//! ```text
//! cargo build --release && cargo run --release --example fidelity_cost -- FOLDER [basic_bend | pneunet]
//! ```
//!
//! Every run is `pneumorph simulate` of a scene file, the program beside this one, on one thread; the files stay in FOLDER, with a
//! table and a figure for each part. The error is the distance between the displacements of the tip, over the length of the finest
//! solid's. That solid, and the others, stand around one mid-surface with edges of 1.5 mm; shells stand on their own. What remains
//! of a shell's error on fine meshes is the price of its theory. Half an hour.

#![allow(clippy::print_stdout, reason = "it is a program that prints a table")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, bail, ensure};
use pneumorph::math::Vec3;
use pneumorph::report::{ErrorCurve, ErrorPoint, error_svg, png};
use serde_json::Value;

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

/// Simulates the scene `name` of a part with the mesh sections `mesh`.
fn run(part: &Part, name: &str, mesh: &str, folder: &Path) -> anyhow::Result<Run> {
    let network = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/networks");
    let scene = format!(
        "[part]\nnetwork = {:?}\n\n{mesh}\n[material]\nlaw = \"neo-hookean\"\nmu = 1.0\n\n{}",
        network.join(format!("{}.toml", part.name)),
        part.load
    );
    let path = |end: &str| folder.join(format!("{}_{name}{end}", part.name));
    fs::write(path(".toml"), scene)?;
    let program = std::env::current_exe()?
        .parent()
        .and_then(Path::parent)
        .map(|profile| profile.join("pneumorph"))
        .filter(|program| program.exists())
        .context("`cargo build --release` first makes the program that this one runs")?;
    let ran = Command::new(program)
        .arg("simulate")
        .arg(path(".toml"))
        .arg("--out")
        .arg(path(""))
        .args(["--solver", "native", "--threads", "1"])
        .output()?;
    let said = String::from_utf8_lossy(&ran.stderr);
    ensure!(ran.status.success(), "{}: {}", path(".toml").display(), said.trim());
    let summary: Value = serde_json::from_slice(&fs::read(path("").join("summary.json"))?)?;
    let number = |value: &Value| value.as_f64().context("a number is missing in summary.json");
    let tip = [0, 1, 2].map(|axis| number(&summary["tip"][axis]));
    let [x, y, z] = tip;
    let stages = summary["cpu_seconds"].as_object().context("no times in summary.json")?;
    let mut cpu_seconds = stages.values().map(number).sum::<anyhow::Result<f64>>()?;
    // Of programs that make tetrahedra only the time on the clock is known.
    for attempt in summary["solid"]["attempts"].as_array().into_iter().flatten() {
        cpu_seconds += number(&attempt["seconds"])?;
    }
    let unknowns = number(&summary["unknowns"])? as usize;
    Ok(Run { tip: Vec3::new(x?, y?, z?), point: ErrorPoint { cpu_seconds, unknowns, error: 0.0 } })
}
