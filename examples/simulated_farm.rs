//! How many processes a search can use: the farm of `mpirun pneumorph evolve`, simulated with the times of a run.
//!
//! ```text
//! cargo run --release --example simulated_farm -- RUN [message ms]
//! ```
//!
//! RUN is the folder of a finished search. Its candidates are handed out again as the farm does it: one at a time to who is free, a
//! generation after the other; each costs the first process a message (0.2 ms if not given) that it handles after the others.
//! Printed for each number of processes is the efficiency, the work over the processes' time: in the order of the generation, the
//! longest first (as it is done, but by times known beforehand), and for populations ten, a hundred and a thousand times as large, whose
//! times are drawn from those of the same generation.

#![allow(clippy::print_stdout, reason = "it is a program that prints a table")]

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::path::PathBuf;

use anyhow::{Context, ensure};
use pneumorph::evolve::IndividualId;
use pneumorph::fitness::StageSeconds;
use pneumorph::io::jsonl;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::Deserialize;

/// What is read of a line of `candidates.jsonl`.
#[derive(Deserialize)]
struct Candidate {
    id: IndividualId,
    cpu_seconds: StageSeconds,
}

fn main() -> anyhow::Result<()> {
    let mut words = std::env::args().skip(1);
    let run = PathBuf::from(words.next().context("name the folder of a search")?);
    let message = words.next().map_or(Ok(0.2), |word| word.parse::<f64>())? / 1000.0;
    let candidates: Vec<Candidate> = jsonl::read(&run.join("candidates.jsonl"))?;
    ensure!(!candidates.is_empty(), "the search has no candidates");
    let mut generations: Vec<Vec<f64>> = Vec::new();
    for Candidate { id, cpu_seconds } in &candidates {
        generations.resize(generations.len().max(id.generation + 1), Vec::new());
        generations[id.generation].push(cpu_seconds.total());
    }
    let work: f64 = generations.iter().flatten().sum();
    let longest = generations.iter().flatten().copied().fold(0.0, f64::max);
    println!(
        "{} candidates in {} generations: {work:.0} s, the mean {:.2} s, the longest {longest:.2} s",
        candidates.len(),
        generations.len(),
        work / candidates.len() as f64
    );
    let longest_first = |times: &[f64]| {
        let mut times = times.to_vec();
        times.sort_by(|a, b| b.total_cmp(a));
        times
    };
    let mut chance = ChaCha8Rng::seed_from_u64(0);
    let mut larger = |factor: usize| -> Vec<Vec<f64>> {
        let drawn = |times: &Vec<f64>| {
            let pick = |_| times[chance.random_range(0..times.len())];
            longest_first(&(0..factor * times.len()).map(pick).collect::<Vec<f64>>())
        };
        generations.iter().map(drawn).collect()
    };
    let [ten, hundred, thousand] = [10, 100, 1000].map(&mut larger);
    let sorted: Vec<Vec<f64>> = generations.iter().map(|times| longest_first(times)).collect();
    println!("processes   in order   longest first   population x 10   x 100   x 1000");
    for processes in (0..13).map(|power| 1 << power) {
        let [a, b, c, d, e] = [&generations, &sorted, &ten, &hundred, &thousand]
            .map(|generations| 100.0 * efficiency(generations, processes, message));
        println!("{processes:9} {a:9.1} % {b:13.1} % {c:15.1} % {d:5.1} % {e:6.1} %");
    }
    Ok(())
}

/// The work of all `generations [generation][candidate]` (s) over the time of so many processes.
fn efficiency(generations: &[Vec<f64>], processes: usize, message: f64) -> f64 {
    let work: f64 = generations.iter().flatten().sum();
    let time: f64 = generations.iter().map(|times| makespan(times, processes, message)).sum();
    work / (processes as f64 * time)
}

/// When the last candidate has ended, s.
fn makespan(times: &[f64], processes: usize, message: f64) -> f64 {
    // When each process is free, in nanoseconds: numbers that a heap can order.
    let ticks = |seconds: f64| (1e9 * seconds) as u64;
    let mut free: BinaryHeap<Reverse<(u64, usize)>> =
        (0..processes).map(|process| Reverse((0, process))).collect();
    let (mut handled, mut end) = (0, 0);
    for time in times {
        let Some(Reverse((since, process))) = free.pop() else { break };
        // The first process hands out to itself without a message.
        let begun = if process == 0 {
            since
        } else {
            handled = since.max(handled) + ticks(message);
            handled
        };
        let ended = begun + ticks(*time);
        end = end.max(ended);
        free.push(Reverse((ended, process)));
    }
    end as f64 / 1e9
}
