//! CPU seconds of one candidate, both scenarios, over random genomes: what a search will cost on one core.
//!
//! `cargo run --release --example candidate_cost [valid genomes] [native|petsc] [edge mm]`

#![allow(clippy::print_stdout, reason = "it is a program that prints a table")]

use pneumorph::fitness::{CandidateSettings, Outcome, evaluate_genome};
use pneumorph::genome::{Paper, Representation};
use pneumorph::math::random::{Purpose, Stream};
use pneumorph::model::material::{Material, Ogden};
use pneumorph::solve::{Backend, Stop};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let wanted: usize = arguments.next().map_or(Ok(30), |text| text.parse())?;
    let backend = match arguments.next().as_deref() {
        Some("petsc") => Backend::Petsc,
        _ => Backend::Native,
    };
    let edge: Option<f64> = arguments.next().map(|text| text.parse()).transpose()?;
    let ninjaflex = Material::Ogden(Ogden::ninjaflex_c2s());
    let mut settings = CandidateSettings::new(ninjaflex, backend);
    settings.mesh.edge = edge.unwrap_or(settings.mesh.edge);

    // One thread, so that its clock sees everything.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let stream = Stream::new(1);
    let paper = Paper::default();
    let mut columns: [Vec<f64>; 6] = Default::default();
    let mut tried = 0;
    println!("  genome unknowns Newton  meshing assembly factorization   rest  total  outcome");
    while columns[0].len() < wanted {
        let genome = paper.random(&mut stream.keyed(Purpose::Creation, 0, tried));
        let evaluated = || evaluate_genome(&paper, &genome, &settings, Stop::NEVER);
        let candidate = pool.install(evaluated)?;
        let s = candidate.seconds;
        let total = s.meshing + s.assembly + s.factorization + s.rest;
        let (unknowns, newton, what) = match &candidate.outcome {
            Outcome::Evaluated(e) => {
                let row = [
                    s.meshing,
                    s.assembly,
                    s.factorization,
                    s.rest,
                    total,
                    e.newton_iterations as f64,
                ];
                columns.iter_mut().zip(row).for_each(|(column, value)| column.push(value));
                let [bending, blocking] = ["bending", "blocking"].map(|name| e.objectives[name]);
                let what = format!("F_c {bending:.3}  F_bf {blocking:.4}  {:.1} N", e.max_force);
                (e.unknowns, e.newton_iterations, what)
            }
            Outcome::Rejected(rejected) => (0, 0, rejected.to_string()),
        };
        println!(
            "{tried:8} {unknowns:8} {newton:6} {:8.3} {:8.3} {:13.3} {:6.3} {total:6.3}  {what}",
            s.meshing, s.assembly, s.factorization, s.rest
        );
        tried += 1;
    }
    let [meshing, assembly, factorization, rest, total, newton] = columns.map(median);
    println!(
        "{wanted} valid of {tried}; median CPU seconds of one valid candidate, both scenarios: {total:.3}"
    );
    println!(
        "  meshing {meshing:.3}  assembly {assembly:.3}  factorization {factorization:.3}  rest {rest:.3}  Newton iterations {newton}"
    );
    Ok(())
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
