//! `report`: the figures and tables of a run folder, drawn again from its records.

use std::path::Path;

use anyhow::Context;

use super::run_folder::RunFolder;
use super::{say, warn};
use crate::evolve::Nsga2;

/// Draws the figures of the run in `path` and prints its front.
pub(super) fn run(path: &Path) -> anyhow::Result<()> {
    let folder = RunFolder::open(path)?;
    let (state, damaged) = folder.load()?;
    for line in damaged {
        warn(&format!("{line}; the checkpoint before it is used"));
    }
    let state = state
        .with_context(|| format!("{}: no generation has been finished yet", path.display()))?;
    let search = Nsga2::resume(state.search)?;
    let records = folder.records(search.generation())?;
    say(&folder.write_results(&search, &state.history, &records)?);
    for figure in ["front", "merit", "history", "outcomes"] {
        for ending in ["svg", "png", "csv"] {
            let file = folder.file(&format!("{figure}.{ending}"));
            if file.is_file() {
                say(&file.display().to_string());
            }
        }
    }
    Ok(())
}
