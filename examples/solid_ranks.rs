//! A hollow box of rubber under pressure, solved by all ranks of `mpirun` together.
//!
//! ```text
//! [mpirun -n 2] solid_ranks [cells through the wall] [wall-thicknesses along the box] [direct | iterative | auto]
//! ```
//!
//! The floor of the box is twice as thick as the other walls, so it bends. Printed by the first rank: unknowns, and of each load the
//! Newton steps, iterations of linear solutions and seconds; then the tip, and the largest memory of any rank.

#![allow(clippy::print_stdout, reason = "it is a program that prints a table")]

use std::collections::BTreeMap;
use std::time::Instant;

use pneumorph::math::Vec3;
use pneumorph::mesh::{SolidMesh, TetMesh};
use pneumorph::model::material::{Material, NeoHookean};
use pneumorph::model::system::{LoadedSystem, System};
use pneumorph::model::{PartModel, PartSetup};
use pneumorph::solve::{EquilibriumSolver, Job, LinearMethod, NewtonSettings, Snes};

fn main() -> anyhow::Result<()> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let number = |at: usize, default| words.get(at).map_or(Ok(default), |word| word.parse());
    let (cells, length) = (number(0, 1)?, number(1, 20)?);
    let method = match words.get(2).map(String::as_str) {
        Some("direct") => LinearMethod::Direct,
        Some("iterative") => LinearMethod::Iterative,
        _ => LinearMethod::Automatic,
    };
    let job = Job::join()?;
    let say = |text: String| {
        if job.is_first() {
            println!("{text}");
        }
    };
    // As many threads as fit beside the other ranks.
    let cores = std::thread::available_parallelism()?.get();
    let threads = if job.ranks == 1 { 1 } else { (cores / job.ranks).max(1) };
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()?;

    let start = Instant::now();
    let mesh = SolidMesh::straight(&hollow_box(cells, length));
    let clamp: Vec<u32> =
        (0..).zip(&mesh.positions).filter(|(_, x)| x.z == 0.0).map(|(v, _)| v).collect();
    let material = Material::NeoHookean(NeoHookean { mu: 1.0 });
    let held = SolidMesh::unknowns_of(&clamp);
    let mut model =
        PartModel::of_solid(&mesh, THICKNESS, &material, &held.into(), &PartSetup::default())
            .map_err(|rejected| anyhow::anyhow!("{rejected:?}"))?;
    let mut solver = Snes::with_method(model.pattern(), method)?;
    say(format!(
        "{} ranks, {method:?}: {} cells, {} unknowns, {} stored entries; prepared in {:.1} s",
        job.ranks,
        mesh.tetrahedra.len(),
        model.unknowns(),
        model.pattern().stored(),
        start.elapsed().as_secs_f64()
    ));
    let mut x = vec![0.0; model.unknowns()];
    let mut iterations = 0;
    let whole = Instant::now();
    for load in [0.5, 1.0] {
        model.set_load(load * PRESSURE);
        let start = Instant::now();
        let before = solver.times();
        let report = solver.solve(&mut model, &mut x, &NewtonSettings::default())?;
        let times = solver.times();
        say(format!(
            "pressure {:.4} MPa: {:?} in {} steps, {} linear iterations, {:.2} s (CPU of a rank: assembly {:.2}, linear {:.2})",
            load * PRESSURE,
            report.ending,
            report.iterations,
            solver.linear_iterations() - iterations,
            start.elapsed().as_secs_f64(),
            times.assembly - before.assembly,
            times.factorization - before.factorization,
        ));
        iterations = solver.linear_iterations();
    }
    let start = Instant::now();
    let surplus = solver.linearize(&mut model, &x)? as i64 - model.stable_negative_pivots() as i64;
    say(format!(
        "negative pivots beyond the stable: {surplus}, in {:.2} s",
        start.elapsed().as_secs_f64()
    ));
    let tip = (0..mesh.positions.len()).max_by(|&a, &b| {
        let height = |v: usize| mesh.positions[v].z + 1e-3 * mesh.positions[v].x;
        height(a).total_cmp(&height(b))
    });
    let tip = tip.map(|v| Vec3::from_column_slice(&x[3 * v..3 * v + 3])).unwrap_or_default();
    say(format!("tip moved by ({:.12}, {:.12}, {:.12}) mm", tip.x, tip.y, tip.z));
    say(format!(
        "solved in {:.2} s; this rank's memory {:.2} GB",
        whole.elapsed().as_secs_f64(),
        memory()
    ));
    Ok(())
}

const THICKNESS: f64 = 2.0;
/// Outer width in thicknesses.
const WIDTH: usize = 8;
/// MPa.
const PRESSURE: f64 = 0.1;

/// Straight cells: six in each cube of a lattice, with a chamber inside.
fn hollow_box(cells: usize, length: usize) -> TetMesh {
    let size = [WIDTH, WIDTH + 1, length].map(|thicknesses| thicknesses * cells);
    let wall = [[1, 1], [2, 1], [1, 1]].map(|sides| sides.map(|side| side * cells));
    let step = THICKNESS / cells as f64;
    let mut mesh = TetMesh::default();
    let mut numbers = BTreeMap::new();
    let mut faces: BTreeMap<[u32; 3], [u32; 3]> = BTreeMap::new();
    for k in 0..size[2] {
        for j in 0..size[1] {
            for i in 0..size[0] {
                let at = [i, j, k];
                let inside =
                    |axis: usize| (wall[axis][0]..size[axis] - wall[axis][1]).contains(&at[axis]);
                if (0..3).all(inside) {
                    continue;
                }
                for order in ORDERS {
                    let mut corner = at;
                    let mut tetrahedron = [0; 4];
                    for (n, node) in tetrahedron.iter_mut().enumerate() {
                        if n > 0 {
                            corner[order[n - 1]] += 1;
                        }
                        *node = *numbers.entry(corner).or_insert_with(|| {
                            mesh.positions.push(Vec3::from(corner.map(|c| step * c as f64)));
                            mesh.positions.len() as u32 - 1
                        });
                    }
                    let odd = [[0, 2, 1], [1, 0, 2], [2, 1, 0]].contains(&order);
                    if odd {
                        tetrahedron.swap(2, 3);
                    }
                    let [a, b, c, d] = tetrahedron;
                    for face in [[b, c, d], [a, d, c], [a, b, d], [a, c, b]] {
                        let mut key = face;
                        key.sort_unstable();
                        if faces.remove(&key).is_none() {
                            faces.insert(key, face);
                        }
                    }
                    mesh.tetrahedra.push(tetrahedron);
                }
            }
        }
    }
    let highest = size.map(|cells| step * cells as f64);
    for [a, b, c] in faces.into_values() {
        let middle = [a, b, c].map(|v| mesh.positions[v as usize]).iter().sum::<Vec3>() / 3.0;
        let on_outside = (0..3)
            .any(|axis| middle[axis] < 1e-3 * step || middle[axis] > highest[axis] - 1e-3 * step);
        // Outward of the wall; the chamber's faces look into it.
        if on_outside {
            mesh.outer.push([a, b, c]);
        } else {
            mesh.chamber.push([a, c, b]);
        }
    }
    mesh
}

/// The axes in every order: the way from a cube's first corner to its last (Kuhn's cells).
const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];

/// The largest memory of this process so far, GB; 0 where the system does not say.
fn memory() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kilobytes = line.and_then(|line| line.split_whitespace().next()?.parse::<f64>().ok());
    kilobytes.unwrap_or_default() / 1e6
}
