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
    BLOCK_SINKING, COOK_RISE, Problem, Volume, beam_error, block_sinking, cook_rise,
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
        let title = format!("Cook's membrane, {volume:?}: error of the rise under 100 N/mm");
        table(&title, &[4, 8, 16, 32, 64][..level + 2], |n| {
            cook_rise(n, volume, backend)[4] / COOK_RISE[4] - 1.0
        });
    }
    println!("compressed block: sinking at quarters of 320 MPa, mm\n  known  {BLOCK_SINKING:.4?}");
    for n in &[4, 6, 8, 10, 12][..level + 2] {
        println!("{n:7}  {:.4?}", block_sinking(*n, backend));
    }
    println!();
    let title = "bent beam, one cell across: distance from the elastica";
    table(title, &[8, 16, 32, 64, 128][..level + 2], |n| beam_error(n, backend));
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
