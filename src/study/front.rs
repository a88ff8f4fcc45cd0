//! A run as its last finished generation has left it.

use std::path::Path;

use anyhow::Context;

use super::inherited::Nsga2;
use super::run_folder::{Record, RunFolder};
use crate::report::FrontPoint;

/// The last finished generation of a run.
pub(crate) struct LastGeneration {
    pub folder: RunFolder,
    pub search: Nsga2,
    /// Of all generations that are finished.
    pub records: Vec<Record>,
}

impl LastGeneration {
    /// Reads the run in the folder `path`.
    ///
    /// # Errors
    /// When that is not the folder of a run, is damaged, or has no finished generation yet.
    pub(crate) fn read(path: &Path) -> anyhow::Result<Self> {
        let folder = RunFolder::open(path)?;
        let (state, _) = folder.load()?;
        let state = state
            .with_context(|| format!("{}: no generation has been finished yet", path.display()))?;
        let search = Nsga2::resume(state.search)?;
        let records = folder.records(search.generation())?;
        Ok(Self { folder, search, records })
    }
}

/// The front of the run in the folder `path`, as far as its generations are finished, with what was
/// recorded of each design; no order.
///
/// # Errors
/// One line when that is not the folder of a run, is damaged, or has no finished generation yet.
pub fn front(path: &Path) -> anyhow::Result<Vec<FrontPoint>> {
    let LastGeneration { folder, search, records } = LastGeneration::read(path)?;
    folder.front(&search, &records)
}
