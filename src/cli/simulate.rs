//! `simulate`: one part under its load.

use std::path::Path;

use super::listener::Listener;
use super::patience::Patience;
use super::terminal::say;
use crate::scene::End;
use crate::scene::simulate::{Request, simulate};
use crate::solve::{Backend, Job, Stop};
use crate::study::Limits;

/// What is said of a path that was interrupted in its first state.
const NOTHING_WRITTEN: &str = "interrupted before the path began; nothing is written";

/// Runs the scene at `path`; the first process of the `job` writes its results into the new folder `out`.
pub(super) fn run(
    path: &Path,
    out: &Path,
    solver: Option<Backend>,
    json: bool,
    job: Job,
) -> anyhow::Result<End> {
    let patience = Patience::new(None)?;
    // All processes walk one path, and end it together; a job that can no longer talk is over.
    let is_over = || job.any(patience.is_over()).unwrap_or(true);
    let request = Request { scene: path, out, solver, job };
    let simulated = simulate(&request, Stop::when(&is_over), &Listener::new(json))?;
    match &simulated.summary {
        Some(summary) if json => say(&serde_json::to_string_pretty(summary)?),
        Some(summary) => say(&summary.in_words(out)),
        None if job.is_first() => say(NOTHING_WRITTEN),
        None => {}
    }
    Ok(simulated.end)
}
