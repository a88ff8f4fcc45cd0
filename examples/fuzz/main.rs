//! Does any file of a user's make the program panic, crash, hang or take the machine's memory?
//!
//! `scripts/fuzz [--runs N] [--seed S] [--folder RUN] [--format NAME] [--keep FOLDER]`
//!
//! Good files of every format are changed a little (`mutation.rs`) and read as the commands read them (`pneumorph::cli::inspect`).
//! Each run is of a seed and a number, so that it can be had again. A child process reads many in a row, within 10 s for each and
//! 1 GiB of memory more than it begins with; where it dies, the run that killed it is read once more, alone, and those behind it go on.
//!
//! What it prints, by format: runs; refused; accepted; panics; signals (a crash, or memory beyond the limit); slow (over 10 s);
//! the largest memory (MiB) and the longest time (s) of a run. The exit code is 1 where a run panicked, crashed or was slow.

#![allow(clippy::print_stdout, clippy::print_stderr, reason = "it is a program that prints tables")]
#![cfg_attr(test, allow(clippy::unwrap_used, reason = "a test may panic"))]

mod corpus;
mod mutation;

use std::fs;
use std::io::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::Instant;

use pneumorph::cli::inspect;
use pneumorph::io::child::{self, Ending, Limits};

use self::corpus::Corpus;
use self::mutation::{Random, mutated};

type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Runs of one child process.
const BATCH: usize = 200;
/// What a run may take, s and MiB.
const LONGEST: f64 = 10.0;
const MOST: u64 = 1024;

struct Arguments {
    runs: usize,
    seed: u64,
    folder: Option<PathBuf>,
    format: Option<String>,
    keep: Option<PathBuf>,
    /// Of a child process: from which run to which.
    child: Option<(usize, usize)>,
}

fn arguments() -> Result<Arguments, Failure> {
    let mut read =
        Arguments { runs: 2000, seed: 1, folder: None, format: None, keep: None, child: None };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or_else(|| format!("{word} wants a value"));
        match word.as_str() {
            "--runs" => read.runs = value()?.parse()?,
            "--seed" => read.seed = value()?.parse()?,
            "--folder" => read.folder = Some(fs::canonicalize(value()?)?),
            "--format" => read.format = Some(value()?),
            "--keep" => read.keep = Some(value()?.into()),
            "--child" => read.child = Some((value()?.parse()?, value()?.parse()?)),
            other => return Err(format!("no option {other}").into()),
        }
    }
    Ok(read)
}

/// How a run ended.
#[derive(Clone, Debug, PartialEq)]
enum Outcome {
    Accepted,
    Refused,
    Panicked(String),
    Signalled(String),
    Slow,
}

/// What a run took.
struct Run {
    outcome: Outcome,
    seconds: f64,
    mebibytes: u64,
}

fn main() -> Result<(), Failure> {
    let arguments = arguments()?;
    let all = corpus::all(arguments.folder.as_deref())?;
    if let (Some((from, to)), Some(format)) = (arguments.child, &arguments.format) {
        let corpus = all.iter().find(|corpus| corpus.name == format).ok_or("no such format")?;
        return read_in_a_row(corpus, &arguments, from, to);
    }
    let wanted =
        |corpus: &&Corpus| arguments.format.as_ref().is_none_or(|name| name == corpus.name);
    let chosen: Vec<&Corpus> = all.iter().filter(wanted).collect();
    let runs = arguments.runs.div_ceil(chosen.len().max(1));
    println!(
        "{:20} {:>6} {:>8} {:>9} {:>7} {:>8} {:>5} {:>8} {:>6}",
        "format", "runs", "refused", "accepted", "panics", "signals", "slow", "MiB", "s"
    );
    let mut faults = Vec::new();
    for corpus in chosen {
        let mut counts = [0; 5];
        let (mut memory, mut longest) = (0, 0.0f64);
        let mut next = 0;
        while next < runs {
            let done = read_by_a_child(corpus, &arguments, next, (next + BATCH).min(runs))?;
            for (run, number) in done.iter().zip(next..) {
                memory = memory.max(run.mebibytes);
                longest = longest.max(run.seconds);
                let (place, told) = match &run.outcome {
                    Outcome::Refused => (0, None),
                    Outcome::Accepted => (1, None),
                    Outcome::Panicked(words) => (2, Some(words.as_str())),
                    Outcome::Signalled(words) => (3, Some(words.as_str())),
                    Outcome::Slow => (4, Some("is slow")),
                };
                counts[place] += 1;
                if let Some(told) = told {
                    faults.push(format!("{} {number}: {told}", corpus.name));
                    keep(corpus, &arguments, number)?;
                }
            }
            next += done.len();
        }
        let [refused, accepted, panics, signals, slow] = counts;
        println!(
            "{:20} {runs:>6} {refused:>8} {accepted:>9} {panics:>7} {signals:>8} {slow:>5} {memory:>8} {longest:>6.2}",
            corpus.name
        );
    }
    faults.iter().for_each(|fault| println!("{fault}"));
    if faults.is_empty() { Ok(()) } else { Err(format!("{} runs failed", faults.len()).into()) }
}

/// The contents of run `number` of a format.
fn contents(corpus: &Corpus, seed: u64, number: usize) -> Vec<u8> {
    let name = corpus.name.bytes().fold(seed, |sum, byte| sum.wrapping_mul(31) + u64::from(byte));
    let mut random = Random::new(name.wrapping_mul(0x1_0000_0001).wrapping_add(number as u64));
    // Numbers that follow each other begin streams that have nothing in common only after a draw.
    random.below(2);
    mutated(&corpus.good, &mut random)
}

fn keep(corpus: &Corpus, arguments: &Arguments, number: usize) -> Result<(), Failure> {
    let Some(folder) = &arguments.keep else { return Ok(()) };
    fs::create_dir_all(folder)?;
    let name =
        format!("{} {number} {}", corpus.name, corpus.file.replace('/', " ")).replace(' ', "_");
    Ok(fs::write(folder.join(name), contents(corpus, arguments.seed, number))?)
}

/// Reads the runs and tells of each as soon as it has ended, one a line.
fn read_in_a_row(
    corpus: &Corpus,
    arguments: &Arguments,
    from: usize,
    to: usize,
) -> Result<(), Failure> {
    let place = tempfile::tempdir()?;
    if let Some(folder) = &arguments.folder {
        copy(folder, place.path())?;
    }
    let path = place.path().join(&corpus.file);
    std::panic::set_hook(Box::new(|_| {}));
    for number in from..to {
        fs::write(&path, contents(corpus, arguments.seed, number))?;
        let what =
            if arguments.folder.is_some() && corpus.is_in_a_run() { place.path() } else { &path };
        // Later peaks are measured from here.
        let _ = fs::write("/proc/self/clear_refs", "5");
        let start = Instant::now();
        let outcome = outcome(corpus, what);
        let seconds = start.elapsed().as_secs_f64();
        let word = match outcome {
            Outcome::Accepted => "accepted",
            Outcome::Panicked(_) => "panicked",
            _ => "refused",
        };
        let told = if let Outcome::Panicked(words) = outcome { words } else { String::new() };
        println!("{number} {word} {seconds} {} {}", peak(), told.replace('\n', " "));
        std::io::stdout().flush()?;
    }
    Ok(())
}

fn outcome(corpus: &Corpus, path: &Path) -> Outcome {
    match catch_unwind(AssertUnwindSafe(|| inspect(corpus.input, path))) {
        Ok(Ok(())) => Outcome::Accepted,
        Ok(Err(_)) => Outcome::Refused,
        Err(panic) => {
            let words = panic.downcast_ref::<String>().cloned();
            let words =
                words.or_else(|| panic.downcast_ref::<&str>().map(|&words| words.to_owned()));
            Outcome::Panicked(words.unwrap_or_default())
        }
    }
}

/// The largest memory since the last look, MiB; 0 where the system does not say.
fn peak() -> u64 {
    status("VmHWM:").unwrap_or(0)
}

fn status(key: &str) -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with(key))?;
    line.split_ascii_whitespace().nth(1)?.parse::<u64>().ok().map(|kibibytes| kibibytes >> 10)
}

fn copy(from: &Path, to: &Path) -> Result<(), Failure> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let path = entry?.path();
        let target = to.join(path.file_name().ok_or("a file has a name")?);
        if path.is_dir() {
            copy(&path, &target)?;
        } else {
            fs::copy(&path, target)?;
        }
    }
    Ok(())
}

/// At least one run, read by a process that may die.
fn read_by_a_child(
    corpus: &Corpus,
    arguments: &Arguments,
    from: usize,
    to: usize,
) -> Result<Vec<Run>, Failure> {
    // Runs take milliseconds; a batch that takes longer than one may is looked at singly.
    let (mut runs, ending) =
        told_by_a_child(corpus, arguments, from, to, LONGEST + 0.1 * BATCH as f64)?;
    if runs.len() < to - from && runs.is_empty() && to - from > 1 {
        runs = told_by_a_child(corpus, arguments, from, from + 1, LONGEST)?.0;
    }
    if runs.is_empty() && to - from > 1 {
        return read_by_a_child(corpus, arguments, from, from + 1);
    }
    if runs.is_empty() {
        let outcome = match ending {
            Ending::TimedOut => Outcome::Slow,
            Ending::Signalled(signal) => Outcome::Signalled(format!("signal {signal}")),
            Ending::Exited(code) => Outcome::Signalled(format!("exit code {code}")),
        };
        runs.push(Run { outcome, seconds: LONGEST, mebibytes: MOST });
    }
    Ok(runs)
}

/// What a child process told of the runs until it ended.
fn told_by_a_child(
    corpus: &Corpus,
    arguments: &Arguments,
    from: usize,
    to: usize,
    seconds: f64,
) -> Result<(Vec<Run>, Ending), Failure> {
    let place = tempfile::tempdir()?;
    let program = std::env::current_exe()?;
    let program = program.to_str().ok_or("the program's name is no text")?;
    let (seed, from, to) = (arguments.seed.to_string(), from.to_string(), to.to_string());
    let mut words = vec!["--format", corpus.name, "--seed", &seed, "--child", &from, &to];
    if let Some(folder) = &arguments.folder {
        words.extend(["--folder", folder.to_str().ok_or("the folder's name is no text")?]);
    }
    // Libraries alone take some hundred MiB of addresses.
    let mebibytes = MOST + status("VmSize:").unwrap_or(MOST);
    let finished = child::run(program, &words, place.path(), &Limits { seconds, mebibytes })?;
    let told = fs::read_to_string(place.path().join("output.txt"))?;
    Ok((told.lines().filter_map(run_of).collect(), finished.ending))
}

fn run_of(line: &str) -> Option<Run> {
    let mut words = line.splitn(5, ' ').skip(1);
    let word = words.next()?;
    let (seconds, mebibytes) = (words.next()?.parse().ok()?, words.next()?.parse().ok()?);
    let outcome = match word {
        "accepted" => Outcome::Accepted,
        "refused" => Outcome::Refused,
        _ => Outcome::Panicked(words.next().unwrap_or_default().to_owned()),
    };
    let outcome = if seconds > LONGEST { Outcome::Slow } else { outcome };
    Some(Run { outcome, seconds, mebibytes })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Some hundred runs of each format, in this process: a crash would be seen by whoever runs the tests.
    #[test]
    fn no_file_makes_a_reader_panic() {
        let place = tempfile::tempdir().unwrap();
        let mut outcomes = [0; 2];
        for corpus in corpus::all(None).unwrap() {
            let path = place.path().join(&corpus.file);
            for good in &corpus.good {
                fs::write(&path, good).unwrap();
                let refused = inspect(corpus.input, &path).err();
                let may_be = refused.as_ref().is_none_or(|told| told.contains("(hexahedra)"));
                assert!(may_be, "{}: {refused:?}", corpus.name);
            }
            for number in 0..RUNS {
                fs::write(&path, contents(&corpus, 1, number)).unwrap();
                let start = Instant::now();
                match outcome(&corpus, &path) {
                    Outcome::Panicked(words) => panic!("{} {number}: {words}", corpus.name),
                    Outcome::Accepted => outcomes[0] += 1,
                    _ => outcomes[1] += 1,
                }
                let seconds = start.elapsed().as_secs_f64();
                assert!(seconds < LONGEST, "{} {number}: {seconds} s", corpus.name);
            }
        }
        // Both happen, or the mutations are none, or nothing but them.
        assert!(outcomes.iter().all(|&count| count > RUNS), "{outcomes:?}");
    }

    /// Of each format: all of them in a few seconds.
    const RUNS: usize = 200;
}
