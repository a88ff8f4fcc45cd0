//! A small search for actuators that bend far and push hard, told as it goes.
//!
//! `cargo run --release --example front -- FOLDER`
//!
//! FOLDER, which must not exist, receives what `pneumorph evolve` writes.

#![allow(clippy::print_stdout, reason = "it is a program that prints lines")]

use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use pneumorph::report::FrontPoint;
use pneumorph::scene;
use pneumorph::solve::Backend;
use pneumorph::study::{HistoryRow, Manner, Observer, RunFile, Searched, Unlimited, search};

const RUN: &str = r#"
[evolution]
population = 6
generations = 2

[mesh]
edge = 6.0
"#;

/// Prints a line after each generation.
struct Told;

impl scene::Observer for Told {}

impl Observer for Told {
    fn generation(&self, row: &HistoryRow, generations: usize) {
        println!("{}", row.in_words(generations));
    }
}

/// The front of the search in the new folder `out`.
pub(crate) fn front(out: &Path) -> anyhow::Result<Vec<FrontPoint>> {
    let run = RunFile::parse(RUN, Path::new("run.toml"), Some(Backend::Native))?;
    match search(&run, out, &Manner::default(), &Unlimited, &Told)? {
        Searched::Finished(found) => Ok(found.front),
        Searched::Stopped | Searched::Served => bail!("one process without limits ends its search"),
    }
}

fn main() -> anyhow::Result<()> {
    let folder = std::env::args().nth(1).map(PathBuf::from).context("name a new folder")?;
    for point in front(&folder)? {
        let [bending, blocking] = point.place();
        println!("{}: bends by {bending:.3}, pushes by {blocking:.4} N/kPa", point.id);
    }
    Ok(())
}
