//! `evolve`: a search, told as it goes.

use std::path::Path;
use std::time::Duration;

use super::listener::Listener;
use super::patience::Patience;
use super::terminal::say;
use crate::scene::End;
use crate::solve::Backend;
use crate::study::{Manner, RunFile, Searched, search};

/// How the search was asked for, besides its manner.
#[derive(Clone, Copy, Debug)]
pub(super) struct Asked {
    /// Instead of the run file's.
    pub solver: Option<Backend>,
    /// After which it stops, candidates that have begun too.
    pub time_limit: Option<Duration>,
    /// Whether a program reads the answer.
    pub json: bool,
}

/// Runs the search of the run file at `path` in the folder `out`.
pub(super) fn run(path: &Path, out: &Path, manner: &Manner, asked: &Asked) -> anyhow::Result<End> {
    let patience = Patience::new(asked.time_limit)?;
    let listener = Listener::new(asked.json);
    let run = RunFile::read(path, asked.solver)?;
    let found = match search(&run, out, manner, &patience, &listener)? {
        Searched::Finished(found) => found,
        Searched::Stopped => return Ok(End::Stopped),
        Searched::Served => return Ok(End::Finished),
    };
    if asked.json {
        say(&serde_json::to_string_pretty(&found)?);
    }
    listener.tell(&found.rejections());
    listener.tell(&format!("figures, front and designs are in {}", out.display()));
    Ok(End::Finished)
}
