//! `deck`: a solid wall under pressure for other programs; `compare`: what one of them answered.

use std::path::Path;

use anyhow::{Context, ensure};

use super::listener::Listener;
use super::terminal::say;
use crate::io::OutputFolder;
use crate::scene::deck::comparison::Comparison;
use crate::scene::deck::{Choices, of_scene};
use crate::study::deck::of_run;

/// Writes the decks of the scene file `source`, or of the individual `id` of the run folder `source`, into the new folder `out`.
pub(super) fn run(
    source: &Path,
    id: Option<&str>,
    out: &Path,
    choices: &Choices,
) -> anyhow::Result<()> {
    OutputFolder::check_new(out)?;
    choices.check()?;
    let named = || source.display().to_string();
    let subject = match id {
        Some(id) => of_run(source, id, choices)?,
        None => of_scene(source, choices, &Listener::default()).with_context(named)?,
    };
    say(&subject.write(choices, out).with_context(named)?);
    Ok(())
}

/// Compares the answers in the folder `path` of a deck.
pub(super) fn compare(path: &Path, json: bool) -> anyhow::Result<()> {
    ensure!(
        !path.join("run.toml").exists(),
        "{} is a run; name another run to compare it with",
        path.display()
    );
    let comparison = Comparison::read(path)?;
    if json {
        say(&serde_json::to_string_pretty(&comparison)?);
    } else if comparison.reached().is_some() {
        say(&comparison.in_words());
    }
    comparison.check(path)
}
