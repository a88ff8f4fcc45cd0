//! CPU milliseconds of one Newton iteration, by stage, as the mesh grows: assembly, factorisation, and the rest.
//!
//! `cargo run --release --example newton_cost [native|petsc|both] [largest number of triangles]`
//!
//! Spheres pinned against rigid motion, and the published seed of `tests/data`, clamped, inflated in 20 steps.

#![allow(clippy::print_stdout, reason = "it is a program that prints a table")]

use std::path::Path;

use pneumorph::io::stl;
use pneumorph::math::cpu_seconds;
use pneumorph::mesh::{ShellMesh, ShellSettings};
use pneumorph::model::material::{Material, NeoHookean};
use pneumorph::model::system::System;
use pneumorph::model::{PartModel, PartSetup, Support};
use pneumorph::solve::{Backend, PathSettings, follow};
use pneumorph::surface::{RemeshSettings, TriangleMesh, remesh};

type Failure = Box<dyn std::error::Error + Send + Sync>;

/// A shell, what holds it, and the pressure to which it is inflated (MPa).
struct Part {
    name: &'static str,
    mesh: ShellMesh,
    support: Support,
    pressure: f64,
    steps: usize,
}

fn main() -> Result<(), Failure> {
    let mut arguments = std::env::args().skip(1);
    let backends = match arguments.next().as_deref() {
        Some("native") => vec![Backend::Native],
        Some("petsc") => vec![Backend::Petsc],
        _ => vec![Backend::Native, Backend::Petsc],
    };
    let largest: usize = arguments.next().map_or(Ok(usize::MAX), |text| text.parse())?;
    // One thread, so that its clock sees everything.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    println!(
        "ms of one Newton iteration     triangles unknowns  Newton  assembly  factorization    rest     whole path, s"
    );
    let parts =
        [basic_bend(Some(3.6))?, basic_bend(None)?, sphere(3, 20)?, sphere(4, 2)?, sphere(5, 1)?];
    for part in parts.iter().filter(|part| part.mesh.surface.triangles.len() <= largest) {
        for &backend in &backends {
            pool.install(|| measure(part, backend))?;
        }
    }
    Ok(())
}

fn measure(part: &Part, backend: Backend) -> Result<(), Failure> {
    let material = Material::NeoHookean(NeoHookean { mu: 1.0 });
    let mut model = PartModel::new(&part.mesh, &material, &part.support, &PartSetup::default())
        .map_err(|rejected| rejected.to_string())?;
    let start = cpu_seconds();
    let mut solver = backend.solver(model.pattern())?;
    let settings = PathSettings { steps: part.steps, ..PathSettings::default() };
    let path = follow(&mut model, solver.as_mut(), part.pressure, Vec::new(), &settings)?;
    let total = cpu_seconds() - start;
    let times = solver.times();
    let iterations: usize = path.points.iter().map(|point| point.newton_iterations).sum();
    let each = |seconds: f64| 1e3 * seconds / iterations as f64;
    println!(
        "{:16} {:12?} {:11} {:8} {iterations:7} {:9.2} {:14.2} {:7.2} {total:12.3} {}",
        part.name,
        backend,
        part.mesh.surface.triangles.len(),
        model.unknowns(),
        each(times.assembly),
        each(times.factorization),
        each(total - times.assembly - times.factorization),
        path.ending.name(),
    );
    Ok(())
}

/// The published seed, bent by 0.012 MPa; remeshed to triangles of `edge` (mm) where one is given.
fn basic_bend(edge: Option<f64>) -> Result<Part, Failure> {
    let mut surface = stl::read(Path::new("tests/data/basic_bend.stl"), stl::WELD_TOLERANCE)?;
    if let Some(edge) = edge {
        surface = remesh(&surface, None, &RemeshSettings { edge, iterations: 10 })
            .map_err(|rejected| rejected.to_string())?;
    }
    let mesh = ShellMesh::new(surface, &ShellSettings::default()).map_err(|r| r.to_string())?;
    Ok(Part { name: "basic_bend", mesh, support: Support::Clamp, pressure: 0.012, steps: 20 })
}

/// A sphere of radius 10 mm and wall 0.1 mm; 20 steps would stretch it by 1.2.
fn sphere(subdivisions: usize, steps: usize) -> Result<Part, Failure> {
    let surface = TriangleMesh::sphere(10.0, subdivisions);
    let support = Support::of_free_body(&surface);
    let settings = ShellSettings { thickness: 0.1, clamp_height: 10.0, ..Default::default() };
    let mesh = ShellMesh::new(surface, &settings).map_err(|rejected| rejected.to_string())?;
    let pressure = 0.011 * steps as f64 / 20.0;
    Ok(Part { name: "sphere", mesh, support, pressure, steps })
}
