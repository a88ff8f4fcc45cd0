//! Can the wall of every design be built as a solid? Random genomes of the paper's network, and what became of their walls.
//!
//! `cargo run --release --example walls -- [--count N] [--seed S] [--edge E]`
//!
//! The genomes are those of the first generation of `evolve` with the same seed; the first N (300) that make a valid shell are
//! taken. Their mid-surface is meshed again with edges of 2 mm, and its wall of the shell's thickness with edges of E
//! mm (2). One thread.
//!
//! What it prints:
//! - every wall that is rejected, with its cause, and every genome whose finer mid-surface is;
//! - how many walls succeed; how many of them have fillets: vertices of a face farther from the middle than half the wall;
//! - CPU seconds of a wall, median and largest; triangles of both faces, median and largest;
//! - angles of the triangles: the smallest of all, and the share below 15 and 30 degrees;
//! - how far the faces are from half the thickness, at the middles of their triangles: root mean square, and the largest
//!   distance missing (where the wall is thinned);
//! - the wall's volume against Steiner's for the same middle without merged folds: median, smallest and largest.

#![allow(clippy::print_stdout, clippy::print_stderr, reason = "it is a program that prints tables")]

use pneumorph::field::{CappedField, CompiledNetwork, DesignBox, ScalarField};
use pneumorph::genome::{Paper, Representation};
use pneumorph::math::random::{Purpose, Stream};
use pneumorph::math::{Rejected, Vec3, cpu_seconds};
use pneumorph::mesh::{
    MeshSettings, ShellSettings, WallSettings, WallSurfaces, shell_of_field, surface_of_field,
    wall_surfaces,
};
use pneumorph::surface::{MidSurface, TriangleMesh};

type Failure = Box<dyn std::error::Error + Send + Sync>;

struct Arguments {
    count: usize,
    seed: u64,
    edge: f64,
}

/// What a wall is like.
struct Figures {
    seconds: f64,
    triangles: usize,
    /// Of every triangle, the smallest, degrees.
    angles: Vec<f64>,
    /// `|d| - t / 2` at the middle of every triangle, mm.
    excesses: Vec<f64>,
    has_fillets: bool,
    /// Over Steiner's.
    volume: f64,
}

fn main() -> Result<(), Failure> {
    let arguments = arguments()?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build()?;
    pool.install(|| campaign(&arguments))
}

fn arguments() -> Result<Arguments, Failure> {
    let mut found = Arguments { count: 300, seed: 1, edge: WallSettings::default().edge };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let value = words.next().ok_or_else(|| format!("{word} wants a number"))?;
        match word.as_str() {
            "--count" => found.count = value.parse()?,
            "--seed" => found.seed = value.parse()?,
            "--edge" => found.edge = value.parse()?,
            _ => return Err(format!("there is no option {word}").into()),
        }
    }
    Ok(found)
}

fn campaign(arguments: &Arguments) -> Result<(), Failure> {
    let stream = Stream::new(arguments.seed);
    let paper = Paper::default();
    let shell = MeshSettings::default();
    let finer = MeshSettings { edge: FINER, ..shell };
    let (mut valid, mut coarse, mut found) = (0, 0, Vec::new());
    let mut genome = 0;
    while valid < arguments.count {
        let random = paper.random(&mut stream.keyed(Purpose::Creation, 0, genome));
        let compiled = CompiledNetwork::new(&paper.express(&random));
        let field = CappedField::new(compiled, DesignBox::default(), shell.rim_radius)?;
        if shell_of_field(&field, &shell, &ShellSettings::default()).is_ok() {
            valid += 1;
            let mid = surface_of_field(&field, &finer)
                .or_else(|rejection| {
                    println!("genome {genome}: the finer mid-surface: {rejection}");
                    coarse += 1;
                    surface_of_field(&field, &shell)
                })
                .map_err(|r| r.to_string())?;
            match figures(&mid, arguments.edge) {
                Ok(figures) => found.push(figures),
                Err(rejection) => println!("genome {genome}: {rejection}"),
            }
            if valid % 10 == 0 {
                eprint!("\r{valid} of {}   ", arguments.count);
            }
        }
        genome += 1;
    }
    eprintln!();
    println!("{genome} genomes, {valid} valid shells, {coarse} of which have no finer mid-surface");
    print_figures(valid, &found);
    Ok(())
}

fn figures(mid: &TriangleMesh, edge: f64) -> Result<Figures, Rejected> {
    let thickness = ShellSettings::default().thickness;
    let settings = WallSettings { edge, ..WallSettings::default() };
    let start = cpu_seconds();
    let middle = MidSurface::uniform(mid.clone(), thickness)?;
    let WallSurfaces { outer, chamber } = wall_surfaces(&middle, &settings)?;
    let seconds = cpu_seconds() - start;
    let faces = outer.joined(&chamber);
    let excess = |point: Vec3| middle.distance().value(point).abs() - 0.5 * thickness;
    let corners = || (0..faces.triangles.len()).map(|t| faces.corners(t));
    let handles = mid.genus() as f64;
    let curved = std::f64::consts::PI * thickness.powi(3) / 3.0 * (1.0 - handles);
    Ok(Figures {
        seconds,
        triangles: faces.triangles.len(),
        angles: corners().map(smallest_angle).collect(),
        excesses: corners().map(|[a, b, c]| excess((a + b + c) / 3.0)).collect(),
        has_fillets: faces.positions.iter().any(|&p| excess(p) > FILLET),
        volume: (outer.volume() - chamber.volume()) / (mid.area() * thickness + curved),
    })
}

/// Edge of the mid-surface that is offset, mm: what the designs of a front deserve.
const FINER: f64 = 2.0;
/// Vertices farther off than this, mm, stand on a fillet: others are within 5 % of an edge.
const FILLET: f64 = 0.15;

fn smallest_angle(corners: [Vec3; 3]) -> f64 {
    let at = |k: usize| {
        let [a, b] = [1, 2].map(|n| corners[(k + n) % 3] - corners[k]);
        a.angle(&b).to_degrees()
    };
    at(0).min(at(1)).min(at(2))
}

fn print_figures(valid: usize, found: &[Figures]) {
    let share = |count: usize, all: usize| 100.0 * count as f64 / all.max(1) as f64;
    let fillets = found.iter().filter(|f| f.has_fillets).count();
    println!(
        "{} walls ({:.2} %), {fillets} of them with fillets",
        found.len(),
        share(found.len(), valid)
    );
    let print = |name: &str, values: Vec<f64>| {
        let [least, median, most] = spread(values);
        println!("{name}: median {median:.3}, smallest {least:.3}, largest {most:.3}");
    };
    print("CPU seconds", found.iter().map(|f| f.seconds).collect());
    print("triangles", found.iter().map(|f| f.triangles as f64).collect());
    print("volume over Steiner's", found.iter().map(|f| f.volume).collect());
    print("largest |d| - t/2 missing, mm", found.iter().map(|f| -least(&f.excesses)).collect());
    let mean_square = |f: &Figures| {
        (f.excesses.iter().map(|e| e * e).sum::<f64>() / f.excesses.len() as f64).sqrt()
    };
    print("root mean square of |d| - t/2, mm", found.iter().map(mean_square).collect());
    print("smallest angle of a wall, degrees", found.iter().map(|f| least(&f.angles)).collect());
    let angles = || found.iter().flat_map(|f| &f.angles);
    for limit in [15.0, 30.0] {
        let below = angles().filter(|&&angle| angle < limit).count();
        println!("{:.4} % of all triangles below {limit} degrees", share(below, angles().count()));
    }
}

fn least(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::INFINITY, f64::min)
}

/// Smallest, median and largest.
fn spread(mut values: Vec<f64>) -> [f64; 3] {
    values.sort_by(f64::total_cmp);
    let at = |place: usize| values.get(place).copied().unwrap_or(f64::NAN);
    [at(0), at(values.len() / 2), at(values.len().saturating_sub(1))]
}
