//! The files that a part names, read where they are.

use std::path::Path;

use anyhow::Context;

use super::PartFiles;
use crate::genome::{Network, NetworkDraft};
use crate::io::{ChamberChoice, OwnSolid, part_file, stl, toml_file};
use crate::surface::TriangleMesh;

/// Files where they are.
pub(crate) struct OnDisk;

impl PartFiles for OnDisk {
    fn network(&self, path: &Path) -> anyhow::Result<Network> {
        read_network(path)
    }

    fn surface(&self, path: &Path) -> anyhow::Result<TriangleMesh> {
        Ok(stl::read(path, stl::WELD_TOLERANCE)?)
    }

    fn tetrahedra(&self, path: &Path, choice: &ChamberChoice) -> anyhow::Result<OwnSolid> {
        Ok(part_file::solid(path, choice)?)
    }
}

/// Reads a network file.
pub(crate) fn read_network(path: &Path) -> anyhow::Result<Network> {
    let draft: NetworkDraft = toml_file::read(path)?;
    Network::try_from(draft).with_context(|| path.display().to_string())
}
