//! Evolution of genomes that are no numbers: bit strings, with the objectives LOTZ (leading ones and
//! trailing zeros).
//!
//! A string `1..1 0..0` of n bits has n of them together, and no string has more: the front is the
//! n + 1 strings of this form.
//! Source: Laumanns, Thiele, Zitzler, Welzl and Deb (2002), PPSN VII: 44-53.

use rand::{Rng, RngExt};
use serde::{Deserialize, Serialize};

use super::checkpoint::Checkpoint;
use super::individual::Evaluation;
use super::nsga2::Nsga2;
use super::settings::{Breeding, Nsga2Settings};
use crate::genome::{Bounds, Operators, Representation};

/// Strings of so many bits, which stand for the numbers of their leading ones and trailing zeros.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct BitString {
    bits: usize,
}

impl Representation for BitString {
    type Genome = Vec<bool>;
    type Phenotype = [usize; 2];

    fn key(&self) -> &'static str {
        "bit-string"
    }

    fn random(&self, rng: &mut impl Rng) -> Vec<bool> {
        (0..self.bits).map(|_| rng.random()).collect()
    }

    /// Uniform crossover.
    fn mix(&self, [a, b]: [&Vec<bool>; 2], _: &Operators, rng: &mut impl Rng) -> Vec<bool> {
        a.iter().zip(b).map(|(a, b)| if rng.random() { *a } else { *b }).collect()
    }

    /// Bitwise mutation.
    fn mutate(&self, parent: &Vec<bool>, how: &Operators, rng: &mut impl Rng) -> Vec<bool> {
        let probability = how.mutation_probability.unwrap_or(1.0 / self.bits as f64);
        parent.iter().map(|bit| bit ^ rng.random_bool(probability)).collect()
    }

    /// The number of bits that differ.
    fn distance(&self, a: &Vec<bool>, b: &Vec<bool>) -> f64 {
        a.iter().zip(b).filter(|(a, b)| a != b).count() as f64
    }

    fn contains(&self, genome: &Vec<bool>) -> bool {
        genome.len() == self.bits
    }

    fn express(&self, genome: &Vec<bool>) -> [usize; 2] {
        let ones = genome.iter().take_while(|bit| **bit).count();
        let zeros = genome.iter().rev().take_while(|bit| !**bit).count();
        [ones, zeros]
    }
}

const BITS: usize = 10;

/// A run with four times as many individuals as the front has points: so many find all of it in a
/// number of generations in the order of n^2 (Zheng, Liu and Doerr 2022, AAAI-36).
fn start(seed: u64) -> Nsga2<BitString> {
    let settings = Nsga2Settings {
        population: 4 * (BITS + 1),
        generations: 3 * BITS * BITS,
        seed,
        breeding: Breeding::CrossoverThenMutation,
        ..Nsga2Settings::default()
    };
    Nsga2::new(settings, BitString { bits: BITS }, 2).unwrap()
}

fn step(run: &mut Nsga2<BitString>) {
    let evaluation = |genome: &Vec<bool>| {
        let counts = run.representation().express(genome);
        Evaluation::feasible(counts.map(|count| -(count as f64)).to_vec())
    };
    let evaluations = run.ask().iter().map(|one| evaluation(&one.genome)).collect();
    run.tell(evaluations);
}

#[test]
fn the_whole_front_of_bit_strings_is_found() {
    for seed in 1..=3 {
        let mut run = start(seed);
        while !run.is_finished() {
            step(&mut run);
        }
        let mut found: Vec<_> = run.front().iter().map(|one| one.genome.clone()).collect();
        found.sort();
        found.dedup();
        let front: Vec<Vec<bool>> =
            (0..=BITS).map(|ones| (0..BITS).map(|bit| bit < ones).collect()).collect();
        assert_eq!(found, front, "seed {seed}");
    }
}

#[test]
fn a_run_of_bit_strings_resumed_from_json_goes_on_with_the_same_bits() {
    let (mut uninterrupted, mut resumed) = (start(1), start(1));
    for _ in 0..20 {
        step(&mut uninterrupted);
        step(&mut resumed);
        let json = serde_json::to_string(&resumed.checkpoint()).unwrap();
        resumed = Nsga2::resume(serde_json::from_str(&json).unwrap()).unwrap();
        assert_eq!(resumed, uninterrupted);
    }
}

#[test]
fn a_checkpoint_names_its_representation_and_is_read_as_no_other() {
    let json = serde_json::to_string(&start(1).checkpoint()).unwrap();
    assert!(json.contains(r#""representation":"bit-string","bounds":{"bits":10}"#), "{json}");
    assert!(serde_json::from_str::<Checkpoint<Bounds>>(&json).is_err());
    let mut run = start(1);
    step(&mut run);
    let mut checkpoint = run.checkpoint();
    checkpoint.population[0].genome.pop();
    let error = Nsga2::resume(checkpoint).unwrap_err().to_string();
    assert!(error.contains("is not in the bounds"), "{error}");
}
