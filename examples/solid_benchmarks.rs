//! Errors of quadratic tetrahedra against closed forms and the results of other programs, as the mesh grows.
//!
//! `cargo run --release --example solid_benchmarks [native|petsc] [1 (coarse) .. 3]`

#![allow(clippy::print_stdout, reason = "it is a program that prints tables")]
#![allow(clippy::unwrap_used, reason = "it shares its problems with tests")]

#[path = "../tests/benchmarks/solid_problems.rs"]
mod solid_problems;

use pneumorph::math::cpu_seconds;
use pneumorph::solve::Backend;
use solid_problems::{
    BLOCK_SINKING, COOK_RISE, Problem, Volume, beam_tips, block_sinking, cook_rise, elastica_error,
    exact_twisted_energy, inflation_error, sphere, tube, twisted_energy,
};

fn main() {
    let mut arguments = std::env::args().skip(1);
    let backend = match arguments.next().as_deref() {
        Some("petsc") => Backend::Petsc,
        _ => Backend::Native,
    };
    let level: usize = arguments.next().and_then(|text| text.parse().ok()).unwrap_or(2);

    for volume in Volume::ALL {
        let material = volume.rubber(1.0);
        for outer in [1.2, 2.0] {
            let layers = |n: usize| if outer == 1.2 { n.div_ceil(4) } else { n.div_ceil(2) };
            let error = |mut body: Problem, directions| {
                inflation_error(&mut body, directions, outer, 2.0_f64.powi(directions + 1), backend)
            };
            let title = format!("sphere, B/A = {outer}, {volume:?}: error of the pressure");
            table(&title, &[2, 4, 8, 16][..level + 1], |n| {
                error(sphere(n, layers(n), outer, &material), 2)
            });
            let title = format!("tube, B/A = {outer}, {volume:?}: error of the pressure");
            table(&title, &[4, 8, 16, 32][..level + 1], |n| {
                error(tube(n, layers(n), outer, &material), 1)
            });
        }
        println!(
            "Cook's membrane, {volume:?}: rise at fifths of 100 N/mm, mm\n  known  {COOK_RISE:.4?}"
        );
        for n in &[8, 12, 16, 24, 32, 48][..level + 3] {
            println!("{n:7}  {:.4?}", cook_rise(*n, volume, backend));
        }
        println!();
    }
    println!("compressed block: sinking at quarters of 320 MPa, mm\n  known  {BLOCK_SINKING:.4?}");
    for n in &[4, 6, 8, 10, 12][..level + 2] {
        println!("{n:7}  {:.4?}", block_sinking(*n, backend));
    }
    println!();
    let tips = |n, length| beam_tips(n, length, backend);
    let finest = tips(128, 40.0);
    let title =
        "bent beam, one cell across, 40 times as long: distance of the tip from that on 128 cells";
    table(title, &[4, 8, 16, 32][..level + 1], |n| (tips(n, 40.0)[9] - finest[9]).norm());
    let title = "bent beam, cells of 1 x 1 mm, n times as long: distance from the elastica";
    table(title, &[20, 40, 80, 160][..level + 1], |n| elastica_error(&tips(n, n as f64)));
    let title = "twisted rod: error of the energy";
    table(title, &[2, 4, 8, 12][..level + 1], |n| {
        twisted_energy(n, 0.5, 1.0, backend) / exact_twisted_energy(0.5, 1.0) - 1.0
    });
}

/// Prints the errors at sizes `n`, with their order `ln(e / e') / ln(n' / n)` and what they cost.
fn table(title: &str, sizes: &[usize], error: impl Fn(usize) -> f64) {
    println!("{title}\n      n        error    order    CPU, s");
    let mut before: Option<(f64, f64)> = None;
    for &n in sizes {
        let start = cpu_seconds();
        let (size, found) = (n as f64, error(n));
        let order = before.map(|(coarse, error)| (error / found).abs().ln() / (size / coarse).ln());
        let order = order.map_or_else(|| "-".to_owned(), |order| format!("{order:.2}"));
        println!("{n:7} {:11.4} % {order:>8} {:9.1}", 100.0 * found, cpu_seconds() - start);
        before = Some((size, found));
    }
    println!();
}
