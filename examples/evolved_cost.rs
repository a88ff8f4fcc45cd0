//! What evolved designs cost, and how far their factorisation is from the machine's peak.
//!
//! `cargo run --release --example evolved_cost [RUN]`
//!
//! The ten designs of `examples/data/evolved.jsonl` come from a late generation; they are walked through both scenarios with the settings
//! of `examples/modern.toml`, or of the run file RUN. The peak is that of a dense L D L^T with as many operations, by the same library.

#![allow(clippy::print_stdout, reason = "it is a program that prints a table")]

use std::path::PathBuf;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::ldlt::factor::{
    LdltRegularization, cholesky_in_place, cholesky_in_place_scratch,
};
use faer::{Mat, Par, Spec};
use pneumorph::fitness::{CandidateSettings, Outcome, evaluate_genome};
use pneumorph::genome::{Paper, PaperGenome};
use pneumorph::io::jsonl;
use pneumorph::math::cpu_seconds;
use pneumorph::model::PartModel;
use pneumorph::model::system::{LoadedSystem, System};
use pneumorph::solve::{EquilibriumSolver, NativeSolver, PathPoint, Stop};
use pneumorph::study::RunFile;

type Failure = Box<dyn std::error::Error + Send + Sync>;

fn main() -> Result<(), Failure> {
    let run = std::env::args().nth(1).map_or("examples/modern.toml".into(), PathBuf::from);
    let settings = RunFile::read(&run, None)?.candidate_settings()?;
    let genomes: Vec<PaperGenome> = jsonl::read("examples/data/evolved.jsonl".as_ref())?;
    // One thread, so that its clock sees everything.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    println!(
        "unknowns states Newton factors  meshing assembly factorization   rest  total | \
         ms: energy residual tangent  factor  solve | Mflop  Gflop/s dense"
    );
    let rows = genomes.iter().map(|genome| pool.install(|| row(genome, &settings)));
    let sums = rows.sum::<Result<Sums, Failure>>()?;
    let Sums { states, newton, factors, seconds } = sums;
    let [meshing, assembly, factorization, rest] = seconds;
    let total: f64 = seconds.iter().sum();
    println!(
        "     all {states:6} {newton:6} {factors:7} {meshing:8.2} {assembly:8.2} {factorization:13.2} {rest:6.2} {total:6.2}"
    );
    Ok(())
}

#[derive(Default)]
struct Sums {
    states: usize,
    newton: usize,
    factors: usize,
    seconds: [f64; 4],
}

impl std::iter::Sum for Sums {
    fn sum<I: Iterator<Item = Self>>(rows: I) -> Self {
        rows.fold(Self::default(), |sum, row| Self {
            states: sum.states + row.states,
            newton: sum.newton + row.newton,
            factors: sum.factors + row.factors,
            seconds: std::array::from_fn(|k| sum.seconds[k] + row.seconds[k]),
        })
    }
}

fn row(genome: &PaperGenome, settings: &CandidateSettings) -> Result<Sums, Failure> {
    let candidate = evaluate_genome(&Paper::default(), genome, settings, Stop::NEVER)
        .map_err(|_| "a library failed")?;
    let (Outcome::Evaluated(evaluation), Some(mut scenarios)) =
        (candidate.outcome, candidate.scenarios)
    else {
        return Err("a design of the file was rejected".into());
    };
    let s = candidate.seconds;
    let seconds = [s.meshing, s.assembly, s.factorization, s.rest];
    let states =
        scenarios.walked.iter().map(|walked| walked.path.points.len() - walked.common).sum();
    let (newton, factors) = (candidate.counts.newton_iterations, candidate.counts.factorizations);
    let mut last = None;
    scenarios.try_for_each(|walked, model| {
        let point = walked.path.points.last().ok_or("a path without points")?;
        last = Some(Kernels::measured(model, point)?);
        Ok::<(), Failure>(())
    })?;
    let k = last.ok_or("no scenario was walked")?;
    let [meshing, assembly, factorization, rest] = seconds;
    println!(
        "{:8} {states:6} {newton:6} {factors:7} {meshing:8.2} {assembly:8.2} {factorization:13.2} {rest:6.2} {:6.2} | \
         {:10.2} {:8.2} {:7.2} {:7.2} {:6.2} | {:5.0} {:8.1} {:5.1}",
        evaluation.unknowns,
        seconds.iter().sum::<f64>(),
        k.energy,
        k.residual,
        k.tangent,
        k.factor,
        k.solve,
        1e-6 * k.operations,
        1e-6 * k.operations / k.factor,
        dense_rate(k.operations)?,
    );
    Ok(Sums { states, newton, factors, seconds })
}

/// Milliseconds of what a path is made of, at one of its states.
struct Kernels {
    energy: f64,
    residual: f64,
    tangent: f64,
    factor: f64,
    solve: f64,
    operations: f64,
}

impl Kernels {
    fn measured(model: &mut PartModel, point: &PathPoint) -> Result<Self, Failure> {
        const ADMISSIBLE: &str = "a state of a path is admissible";
        let x = &point.x;
        model.set_load(point.load);
        let mut solver = NativeSolver::new(model.pattern())?;
        let mut residual = vec![0.0; x.len()];
        let mut entries = vec![0.0; model.pattern().stored()];
        let energy = milliseconds(|| {
            model.energy(x).expect(ADMISSIBLE);
        });
        let of_residual = milliseconds(|| {
            model.residual(x, &mut residual).expect(ADMISSIBLE);
        });
        let tangent = milliseconds(|| {
            model.tangent(x, &mut residual, &mut entries).expect(ADMISSIBLE);
        });
        let both = milliseconds(|| {
            solver.linearize(model, x).expect("its like was factorised on the way");
        });
        let solve = milliseconds(|| solver.solve_linearized(&mut residual).expect("linearized"));
        let factor = both - tangent;
        let operations = solver.factor_operations();
        Ok(Self { energy, residual: of_residual, tangent, factor, solve, operations })
    }
}

/// CPU milliseconds of one call, the least of three times ten.
fn milliseconds(mut work: impl FnMut()) -> f64 {
    let ten = || {
        let start = cpu_seconds();
        (0..10).for_each(|_| work());
        100.0 * (cpu_seconds() - start)
    };
    std::iter::repeat_with(ten).take(3).fold(f64::INFINITY, f64::min)
}

/// Gflop/s of a dense factorisation with about so many `operations`, n^3 / 3.
fn dense_rate(operations: f64) -> Result<f64, Failure> {
    let n = (3.0 * operations).cbrt().round() as usize;
    let matrix =
        Mat::from_fn(
            n,
            n,
            |i, j| if i == j { n as f64 } else { 1.0 / (1.0 + i.abs_diff(j) as f64) },
        );
    let mut memory = MemBuffer::new(cholesky_in_place_scratch::<f64>(n, Par::Seq, Spec::default()));
    let mut least = f64::INFINITY;
    for _ in 0..3 {
        let mut factor = matrix.clone();
        let start = cpu_seconds();
        let regularization = LdltRegularization::default();
        cholesky_in_place(
            factor.as_mut(),
            regularization,
            Par::Seq,
            MemStack::new(&mut memory),
            Spec::default(),
        )
        .map_err(|_| "the dense matrix has a zero pivot")?;
        least = least.min(cpu_seconds() - start);
    }
    Ok(1e-9 * (n as f64).powi(3) / 3.0 / least)
}
