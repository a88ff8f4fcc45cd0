//! NSGA-II on a problem whose front is known: how much of it is found.
//!
//! `cargo run --example nondominated`
//!
//! ZDT1 (Zitzler, Deb and Thiele 2000), whose front is `f_2 = 1 - sqrt(f_1)`: it dominates 2/3 of
//! what the point (1, 1) is the corner of.

#![allow(clippy::print_stdout, reason = "it is a program that prints a line")]

use pneumorph::evolve::{Breeding, Evaluation, Nsga2, Nsga2Settings, hypervolume};
use pneumorph::genome::Bounds;

/// Both objectives, to be made small.
fn zdt1(x: &[f64]) -> Vec<f64> {
    let g = 1.0 + 9.0 * x[1..].iter().sum::<f64>() / (x.len() - 1) as f64;
    vec![x[0], g * (1.0 - (x[0] / g).sqrt())]
}

/// The area that the front found dominates, and that of the whole front.
pub(crate) fn areas() -> anyhow::Result<[f64; 2]> {
    let settings = Nsga2Settings {
        population: 60,
        generations: 100,
        breeding: Breeding::CrossoverThenMutation,
        ..Nsga2Settings::default()
    };
    let mut search = Nsga2::new(settings, Bounds::new(vec![(0.0, 1.0); 10])?, 2)?;
    while !search.is_finished() {
        let evaluated = search.ask().into_iter().map(|one| Evaluation::feasible(zdt1(&one.genome)));
        let evaluated = evaluated.collect();
        search.tell(evaluated);
    }
    let front = search.front();
    let objectives: Vec<&[f64]> =
        front.iter().map(|one| one.evaluation.objectives.as_slice()).collect();
    Ok([hypervolume(&objectives, &[1.0, 1.0]), 2.0 / 3.0])
}

fn main() -> anyhow::Result<()> {
    let [found, whole] = areas()?;
    println!("the front found dominates {found:.4}, the whole front {whole:.4}");
    Ok(())
}
