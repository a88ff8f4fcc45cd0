//! How robust is the whole chain? Random genomes of the paper's network, both scenarios each, and what became of every one.
//!
//! `cargo run --release --example campaign -- [--count N] [--seed S] [--steps-factor F]`
//!
//! The genomes are those of the first generation of `evolve` with the same seed: genome `i` of generation 0, by the keyed
//! stream. The native solver runs on two threads; where PETSc is built in, every tenth genome is run on it as well.
//!
//! What it prints:
//! - what became of the genomes: no valid chamber, and why; or how many valid ones there are;
//! - the endings of each scenario over the valid ones, with the mean share of the pressure that was reached; blocking is
//!   not walked where bending failed;
//! - the share of valid ones that reach the full pressure in both scenarios, and of those that reach it or end as a real
//!   part would: at a limit point, ballooning, or touching itself;
//! - every other valid one with its cause: these are the program's failures;
//! - snaps: how many designs snap, and how often in all, in either scenario;
//! - Newton iterations of a design that was evaluated, median and largest; CPU seconds of a valid design, median and
//!   largest, of one thread's clock; wall seconds of the whole run on two threads;
//! - PETSc against the native solver: designs whose ending differs, and the largest relative difference of `F_c` and `F_bf`.
//!
//! With `--steps-factor F` (2 halves and doubles) it studies instead how much the answer depends on the steps: the first 50
//! genomes that are evaluated are walked again with the smallest and the largest step `F` times smaller and larger between the
//! same samples (which no step passes), with `F` times as many samples, and with as many divided by `F`. The relative changes of `F_c` and `F_bf` are printed: median, largest,
//! and every design with one above 0.1 %. Both are the largest value over the path, so a sample that is left out or added near
//! a maximum changes them too; the bounds alone must not.

#![allow(clippy::print_stdout, clippy::print_stderr, reason = "it is a program that prints tables")]

use std::collections::BTreeMap;
use std::time::Instant;

use pneumorph::batch::{Executor, Next, Serial, Threads};
use pneumorph::fitness::{CandidateSettings, Outcome, evaluate_genome};
use pneumorph::genome::{Paper, PaperGenome, Representation};
use pneumorph::math::Room;
use pneumorph::math::random::{Purpose, Stream};
use pneumorph::model::material::{Material, Ogden};
use pneumorph::solve::{Backend, Path, PathSettings, Stop};

type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Valid designs of the study of steps.
const STUDIED: usize = 50;
/// Changes above this share are listed.
const NOTABLE: f64 = 1e-3;
/// Endings of a path at which a real part ends too.
const PHYSICAL: [&str; 3] = ["limit_point", "ballooning", "self_touch"];
/// Endings with the full pressure.
const FULL: [&str; 2] = ["reached", "snapped_and_continued"];

struct Arguments {
    count: u64,
    seed: u64,
    steps_factor: Option<f64>,
}

/// What became of a genome.
#[derive(Clone, Debug)]
enum Design {
    /// It makes no shell: why.
    Invalid(String),
    Walked(Walk),
    /// The program failed: a panic or a library's error.
    Broken(String),
}

/// What a valid design did.
#[derive(Clone, Debug)]
struct Walk {
    /// Of bending and, where it was walked, of blocking.
    ways: Vec<Way>,
    /// `F_c` and `F_bf`, where both scenarios count.
    objectives: Option<[f64; 2]>,
    newton_iterations: usize,
    cpu_seconds: f64,
}

/// One scenario.
#[derive(Clone, Debug, PartialEq)]
struct Way {
    ending: String,
    /// Share of the largest pressure.
    reached: f64,
    snaps: usize,
}

fn main() -> Result<(), Failure> {
    let arguments = arguments()?;
    let genomes = genomes(&arguments);
    match arguments.steps_factor {
        Some(factor) => study_of_steps(&genomes, factor),
        None => campaign(&genomes),
    }
}

fn arguments() -> Result<Arguments, Failure> {
    let mut found = Arguments { count: 1000, seed: 1, steps_factor: None };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let value = words.next().ok_or_else(|| format!("{word} wants a number"))?;
        match word.as_str() {
            "--count" => found.count = value.parse()?,
            "--seed" => found.seed = value.parse()?,
            "--steps-factor" => found.steps_factor = Some(value.parse()?),
            _ => return Err(format!("there is no option {word}").into()),
        }
    }
    let is_factor = |factor: f64| factor > 1.0 && factor <= 10.0;
    match found.steps_factor {
        Some(factor) if !is_factor(factor) => {
            Err("--steps-factor wants a number from 1 to 10".into())
        }
        _ => Ok(found),
    }
}

fn genomes(arguments: &Arguments) -> Vec<PaperGenome> {
    let stream = Stream::new(arguments.seed);
    let paper = Paper::default();
    (0..arguments.count).map(|i| paper.random(&mut stream.keyed(Purpose::Creation, 0, i))).collect()
}

fn settings(backend: Backend) -> CandidateSettings {
    CandidateSettings::new(Material::Ogden(Ogden::ninjaflex_c2s()), backend)
}

fn design(genome: &PaperGenome, settings: &CandidateSettings) -> Design {
    let candidate = match evaluate_genome(&Paper::default(), genome, settings, Stop::NEVER) {
        Ok(candidate) => candidate,
        Err(failure) => return Design::Broken(failure.to_string()),
    };
    let walk = |ways, objectives, newton_iterations| Walk {
        ways,
        objectives,
        newton_iterations,
        cpu_seconds: candidate.seconds.total(),
    };
    match (&candidate.outcome, &candidate.scenarios) {
        (Outcome::Evaluated(evaluation), Some(scenarios)) => {
            let largest = settings.load.pressure;
            let ways = scenarios.walked.iter().map(|walked| way(&walked.path, largest));
            let objectives = ["bending", "blocking"].map(|name| evaluation.objectives[name]);
            if !objectives.iter().all(|value| value.is_finite()) {
                return Design::Broken(format!("objectives {objectives:?}"));
            }
            Design::Walked(walk(ways.collect(), Some(objectives), evaluation.newton_iterations))
        }
        (Outcome::Evaluated(_), None) => Design::Broken("evaluated without a path".to_owned()),
        (Outcome::Rejected(rejected), _) if rejected.room == Room::Solve => {
            let failed = Way {
                ending: rejected.reason.to_string(),
                reached: 1.0 - rejected.violation,
                snaps: 0,
            };
            let full = Way { ending: "reached".to_owned(), reached: 1.0, snaps: 0 };
            let is_bending = rejected.detail.starts_with("bending");
            let ways = if is_bending { vec![failed] } else { vec![full, failed] };
            Design::Walked(walk(ways, None, 0))
        }
        (Outcome::Rejected(rejected), _) => {
            Design::Invalid(format!("{:?}: {}", rejected.room, rejected.reason).to_lowercase())
        }
    }
}

fn way(path: &Path, largest: f64) -> Way {
    let reached = path.points.last().map_or(0.0, |point| point.load / largest);
    Way { ending: path.ending.name().to_owned(), reached, snaps: path.snaps().count() }
}

/// Every design of `genomes`, in their order, by `executor`.
fn designs(
    executor: &dyn Executor<PaperGenome, Design>,
    genomes: &[PaperGenome],
    settings: &CandidateSettings,
    what: &str,
) -> Result<Vec<Design>, Failure> {
    let mut done = 0;
    let every = (genomes.len() / 50).max(1);
    let outcomes =
        executor.evaluate(genomes, &|genome| design(genome, settings), &mut |_, _| {
            done += 1;
            if done % every == 0 || done == genomes.len() {
                eprint!("\r{what}: {done} of {}   ", genomes.len());
            }
            Next::Continue
        })?;
    eprintln!();
    Ok(outcomes
        .into_iter()
        .map(|outcome| outcome.unwrap_or_else(|panic| Design::Broken(panic.to_string())))
        .collect())
}

fn campaign(genomes: &[PaperGenome]) -> Result<(), Failure> {
    let start = Instant::now();
    let found = designs(&Threads::new(2)?, genomes, &settings(Backend::Native), "native")?;
    let wall = start.elapsed().as_secs_f64();
    let valid: Vec<(usize, &Walk)> = walks(&found);
    print_validity(&found, valid.len());
    print_endings(&valid);
    print_others(&found, &valid);
    print_costs(&valid, wall);
    if Backend::Petsc.is_built_in() {
        compare_with_petsc(genomes, &found)?;
    }
    Ok(())
}

fn walk_of(design: &Design) -> Option<&Walk> {
    match design {
        Design::Walked(walk) => Some(walk),
        Design::Invalid(_) | Design::Broken(_) => None,
    }
}

fn walks(designs: &[Design]) -> Vec<(usize, &Walk)> {
    let walked = |(i, design)| Some((i, walk_of(design)?));
    designs.iter().enumerate().filter_map(walked).collect()
}

fn print_validity(designs: &[Design], valid: usize) {
    let mut reasons = BTreeMap::new();
    for design in designs {
        if let Design::Invalid(reason) = design {
            *reasons.entry(reason.as_str()).or_insert(0) += 1;
        }
    }
    println!("{} genomes: {valid} make a valid chamber", designs.len());
    reasons.iter().for_each(|(reason, count)| println!("{count:7}  {reason}"));
}

fn print_endings(valid: &[(usize, &Walk)]) {
    for (place, scenario) in ["bending", "blocking"].into_iter().enumerate() {
        let mut endings: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
        for way in valid.iter().filter_map(|(_, walk)| walk.ways.get(place)) {
            endings.entry(&way.ending).or_default().push(way.reached);
        }
        println!("{scenario}:");
        for (ending, reached) in endings {
            let mean = 100.0 * reached.iter().sum::<f64>() / reached.len() as f64;
            println!(
                "{:7}  {ending}, on the average at {mean:.1} % of the pressure",
                reached.len()
            );
        }
    }
}

fn is_full(walk: &Walk) -> bool {
    walk.ways.len() == 2 && walk.ways.iter().all(|way| FULL.contains(&way.ending.as_str()))
}

fn is_physical(walk: &Walk) -> bool {
    let is_end = |way: &Way| [FULL.as_slice(), &PHYSICAL].concat().contains(&way.ending.as_str());
    walk.ways.iter().all(is_end)
}

fn print_others(designs: &[Design], valid: &[(usize, &Walk)]) {
    let share = |count: usize| 100.0 * count as f64 / valid.len().max(1) as f64;
    let full = valid.iter().filter(|(_, walk)| is_full(walk)).count();
    let physical = valid.iter().filter(|(_, walk)| is_physical(walk)).count();
    println!("{:.2} % of the valid reach the full pressure in both scenarios", share(full));
    println!("{:.2} % reach it or end as a real part would; all others:", share(physical));
    for (i, design) in designs.iter().enumerate() {
        match design {
            Design::Walked(walk) if !is_physical(walk) => {
                let told =
                    ["bending", "blocking"].into_iter().zip(&walk.ways).map(|(name, way)| {
                        format!("{name} {} at {:.1} %", way.ending, 100.0 * way.reached)
                    });
                println!("  genome {i}: {}", told.collect::<Vec<_>>().join(", "));
            }
            Design::Broken(why) => println!("  genome {i}: {why}"),
            _ => {}
        }
    }
}

fn print_costs(valid: &[(usize, &Walk)], wall: f64) {
    let snaps = |walk: &Walk| walk.ways.iter().map(|way| way.snaps).sum::<usize>();
    let snapping = valid.iter().filter(|(_, walk)| snaps(walk) > 0).count();
    let all: usize = valid.iter().map(|(_, walk)| snaps(walk)).sum();
    println!("{snapping} designs snap, {all} times in all");
    let evaluated = valid.iter().filter(|(_, walk)| walk.objectives.is_some());
    let newton: Vec<f64> = evaluated.map(|(_, walk)| walk.newton_iterations as f64).collect();
    let cpu: Vec<f64> = valid.iter().map(|(_, walk)| walk.cpu_seconds).collect();
    let [newton_median, newton_largest] = median_and_largest(newton);
    let [cpu_median, cpu_largest] = median_and_largest(cpu);
    println!("Newton iterations of a design: median {newton_median}, largest {newton_largest}");
    println!("CPU seconds of a valid design: median {cpu_median:.2}, largest {cpu_largest:.2}");
    println!("wall seconds of all on two threads: {wall:.0}");
}

fn median_and_largest(mut values: Vec<f64>) -> [f64; 2] {
    values.sort_by(f64::total_cmp);
    let at = |place: usize| values.get(place).copied().unwrap_or(f64::NAN);
    [at(values.len() / 2), at(values.len().saturating_sub(1))]
}

fn compare_with_petsc(genomes: &[PaperGenome], native: &[Design]) -> Result<(), Failure> {
    let tenth: Vec<PaperGenome> = genomes.iter().step_by(10).cloned().collect();
    // PETSc is one to a process; and one thread, so that its clock sees everything.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build()?;
    let run = || designs(&Serial, &tenth, &settings(Backend::Petsc), "PETSc");
    let petsc = pool.install(run)?;
    let mut largest = [0.0_f64; 2];
    println!("PETSc on every tenth genome:");
    for (k, (a, b)) in native.iter().step_by(10).zip(&petsc).enumerate() {
        let i = 10 * k;
        match (a, b) {
            (Design::Invalid(_), Design::Invalid(_)) => {}
            (Design::Walked(a), Design::Walked(b)) => {
                let ends = |walk: &Walk| walk.ways.iter().map(|w| w.ending.clone()).collect();
                let (a_ends, b_ends): (Vec<String>, Vec<String>) = (ends(a), ends(b));
                if a_ends != b_ends {
                    println!("  genome {i}: native {a_ends:?}, PETSc {b_ends:?}");
                }
                for (change, largest) in changes(a, b).into_iter().flatten().zip(&mut largest) {
                    *largest = largest.max(change);
                }
            }
            _ => println!("  genome {i}: native {a:?}, PETSc {b:?}"),
        }
    }
    println!("  largest difference of F_c {:.1e}, of F_bf {:.1e}", largest[0], largest[1]);
    Ok(())
}

/// Relative changes of both objectives; none where one of the two was not evaluated.
fn changes(a: &Walk, b: &Walk) -> Option<[f64; 2]> {
    let (a, b) = (a.objectives?, b.objectives?);
    let change = |k: usize| if a[k] == b[k] { 0.0 } else { (b[k] - a[k]).abs() / a[k].abs() };
    Some([change(0), change(1)])
}

fn study_of_steps(genomes: &[PaperGenome], factor: f64) -> Result<(), Failure> {
    let threads = Threads::new(2)?;
    let usual = settings(Backend::Native);
    let mut studied: Vec<(usize, PaperGenome, Walk)> = Vec::new();
    for (k, chunk) in genomes.chunks(20).enumerate() {
        let found = designs(&threads, chunk, &usual, "usual steps")?;
        for (i, walk) in walks(&found).into_iter().filter(|(_, walk)| walk.objectives.is_some()) {
            studied.push((20 * k + i, chunk[i].clone(), walk.clone()));
        }
        if studied.len() >= STUDIED {
            break;
        }
    }
    studied.truncate(STUDIED);
    let again: Vec<PaperGenome> = studied.iter().map(|(_, genome, _)| genome.clone()).collect();
    let path = usual.load.path;
    let times = |scale: f64| ((path.steps as f64 * scale).round() as usize).max(1);
    // The smallest step is a power of two.
    let bounds = |scale: f64| PathSettings {
        largest_step: path.largest_step * scale,
        halvings: path.halvings.saturating_add_signed(-scale.log2().round() as i32),
        ..path
    };
    for (name, path) in [
        ("smaller bounds of the step", bounds(1.0 / factor)),
        ("larger bounds of the step", bounds(factor)),
        ("more samples", PathSettings { steps: times(factor), ..path }),
        ("fewer samples", PathSettings { steps: times(1.0 / factor), ..path }),
    ] {
        let mut other = usual.clone();
        other.load.path = path;
        let found = designs(&threads, &again, &other, name)?;
        println!("{name} by a factor of {factor}, {} designs:", studied.len());
        let mut all: [Vec<f64>; 2] = Default::default();
        for ((i, _, walk), design) in studied.iter().zip(&found) {
            let Some(changes) = (match design {
                Design::Walked(other) => changes(walk, other),
                _ => None,
            }) else {
                println!("  genome {i} is evaluated no more: {design:?}");
                continue;
            };
            all.iter_mut().zip(changes).for_each(|(all, change)| all.push(change));
            if changes.iter().any(|change| *change > NOTABLE) {
                let [f_c, f_bf] = changes.map(|change| 100.0 * change);
                println!("  genome {i}: F_c changes by {f_c:.3} %, F_bf by {f_bf:.3} %");
            }
        }
        for (name, values) in ["F_c", "F_bf"].into_iter().zip(all) {
            let [median, largest] = median_and_largest(values).map(|change| 100.0 * change);
            println!("  {name} changes by {median:.4} % (median), {largest:.4} % (largest)");
        }
    }
    Ok(())
}
