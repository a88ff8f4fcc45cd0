//! CPU seconds of a bending part whose folds are not looked at, watched, and kept apart while they are far from each other.
//!
//! `cargo run --release --example self_contact_cost [surface.stl]`

#![allow(clippy::print_stdout, reason = "it is a program that prints a table")]

use pneumorph::io::stl;
use pneumorph::math::cpu_seconds;
use pneumorph::mesh::{ShellMesh, ShellSettings};
use pneumorph::model::contact::SelfContactSettings;
use pneumorph::model::material::{Material, NeoHookean};
use pneumorph::model::system::{LoadedSystem, System};
use pneumorph::model::{FoldContact, PartModel, PartSetup, Support};
use pneumorph::solve::{NativeSolver, PathSettings, follow};

const PRESSURE: f64 = 0.012;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = std::env::args().nth(1).unwrap_or_else(|| "tests/data/basic_bend.stl".to_owned());
    let surface = stl::read(file.as_ref(), stl::WELD_TOLERANCE)?;
    let mesh =
        ShellMesh::new(surface, &ShellSettings::default()).map_err(|error| error.to_string())?;
    let material = Material::NeoHookean(NeoHookean { mu: 1.0 });
    println!("{} triangles", mesh.surface.triangles.len());
    println!("folds        iterations   path  first look  a look");
    // One thread, so that its clock sees everything.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    pool.install(|| measure(&mesh, &material)).map_err(Into::into)
}

fn measure(mesh: &ShellMesh, material: &Material) -> Result<(), String> {
    let barrier = SelfContactSettings::of_wall(mesh.section.thickness(0), PRESSURE);
    for (name, folds) in [
        ("not seen", FoldContact::Unseen),
        ("watched", FoldContact::Ends),
        ("kept apart", FoldContact::Barrier(barrier)),
    ] {
        let setup = PartSetup { folds: Some(folds), ..PartSetup::default() };
        let mut model = PartModel::new(mesh, material, &Support::Clamp, &setup)
            .map_err(|error| error.to_string())?;
        let mut solver =
            NativeSolver::new(model.pattern()).map_err(|failure| failure.to_string())?;
        let settings = PathSettings::default();
        let start = cpu_seconds();
        let path = follow(&mut model, &mut solver, PRESSURE, Vec::new(), &settings)
            .map_err(|failure| failure.to_string())?;
        let walked = cpu_seconds();
        let iterations: usize = path.points.iter().map(|point| point.newton_iterations).sum();
        let first = model.passed_limit(&path.points[0].x);
        let looked = cpu_seconds();
        let limits = path.points[1..].iter().filter_map(|point| model.passed_limit(&point.x));
        let touches = limits.chain(first).count();
        println!(
            "{name:12} {iterations:10} {:6.3} {:11.4} {:7.5}  {touches} touches",
            walked - start,
            looked - walked,
            (cpu_seconds() - looked) / (path.points.len() - 1) as f64
        );
    }
    Ok(())
}
