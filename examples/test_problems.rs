//! The fronts that NSGA-II finds of test problems, for a comparison with other programs.
//!
//! ```text
//! test_problems POPULATION GENERATIONS SEEDS
//! ```
//!
//! With the operators of Deb et al. (2002), as `examples/modern.toml` has them. One line of JSON for each problem and seed:
//! `{"problem", "seed", "front": [[objective ..] ..]}`. `scripts/nsga2_against_pymoo` reads them.
//!
//! Source: Zitzler, Deb and Thiele (2000), problems 1 to 3 with 30 genes; Deb, Thiele, Laumanns and Zitzler (2002), problem 2 with 12
//! genes and 3 objectives.

#![allow(clippy::print_stdout, reason = "it is a program that prints lines")]

use std::f64::consts::{FRAC_PI_2, PI};

use anyhow::{Context, ensure};
use pneumorph::evolve::{Breeding, Evaluation, Nsga2, Nsga2Settings};
use pneumorph::genome::Bounds;
use serde_json::json;

struct Problem {
    name: &'static str,
    genes: usize,
    objectives: usize,
    evaluate: fn(&[f64]) -> Vec<f64>,
}

const PROBLEMS: [Problem; 4] = [
    Problem {
        name: "zdt1",
        genes: 30,
        objectives: 2,
        evaluate: |x| zdt(x, |f, g| 1.0 - (f / g).sqrt()),
    },
    Problem {
        name: "zdt2",
        genes: 30,
        objectives: 2,
        evaluate: |x| zdt(x, |f, g| 1.0 - (f / g).powi(2)),
    },
    Problem {
        name: "zdt3",
        genes: 30,
        objectives: 2,
        evaluate: |x| zdt(x, |f, g| 1.0 - (f / g).sqrt() - f / g * (10.0 * PI * f).sin()),
    },
    Problem { name: "dtlz2", genes: 12, objectives: 3, evaluate: dtlz2 },
];

fn zdt(x: &[f64], shape: fn(f64, f64) -> f64) -> Vec<f64> {
    let g = 1.0 + 9.0 * x[1..].iter().sum::<f64>() / (x.len() - 1) as f64;
    vec![x[0], g * shape(x[0], g)]
}

fn dtlz2(x: &[f64]) -> Vec<f64> {
    let radius = 1.0 + x[2..].iter().map(|x| (x - 0.5).powi(2)).sum::<f64>();
    let [(sin_a, cos_a), (sin_b, cos_b)] = [x[0], x[1]].map(|x| (FRAC_PI_2 * x).sin_cos());
    vec![radius * cos_a * cos_b, radius * cos_a * sin_b, radius * sin_a]
}

fn main() -> anyhow::Result<()> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    ensure!(words.len() == 3, "name a population, generations and seeds");
    let number = |at: usize| words[at].parse::<usize>().with_context(|| words[at].clone());
    let (population, generations, seeds) = (number(0)?, number(1)?, number(2)?);
    for Problem { name, genes, objectives, evaluate } in PROBLEMS {
        for seed in 1..=seeds as u64 {
            let settings = Nsga2Settings {
                population,
                generations,
                seed,
                breeding: Breeding::CrossoverThenMutation,
                ..Nsga2Settings::default()
            };
            let bounds = Bounds::new(vec![(0.0, 1.0); genes])?;
            let mut run = Nsga2::new(settings, bounds, objectives)?;
            while !run.is_finished() {
                let of = |genome: &[f64]| Evaluation::feasible(evaluate(genome));
                run.tell(run.ask().iter().map(|candidate| of(&candidate.genome)).collect());
            }
            let front: Vec<_> = run.front().iter().map(|one| &one.evaluation.objectives).collect();
            println!("{}", json!({ "problem": name, "seed": seed, "front": front }));
        }
    }
    Ok(())
}
