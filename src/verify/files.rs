//! Files of benchmarks that are built into the program: the scenes of one folder, and what they name.

use std::path::Path;

use anyhow::{Context, bail};

use crate::genome::{Network, NetworkDraft};
use crate::io::{ChamberChoice, OwnSolid, stl, toml_file};
use crate::scene::part::PartFiles;
use crate::surface::TriangleMesh;

/// The scenes of one folder under `verify/`.
#[derive(Clone, Copy, Debug)]
pub struct SceneFolder {
    /// Its path in the repository.
    pub path: &'static str,
    /// Name without ending and text of every file, in the order in which they are run.
    pub files: &'static [(&'static str, &'static str)],
}

impl SceneFolder {
    pub(crate) fn names(&self) -> impl Iterator<Item = &'static str> + use<> {
        self.files.iter().map(|(name, _)| *name)
    }

    /// The `chosen` names; all where none is chosen.
    pub(crate) fn chosen<'a>(&self, chosen: &'a [String]) -> Vec<&'a str> {
        if chosen.is_empty() {
            self.names().collect()
        } else {
            chosen.iter().map(String::as_str).collect()
        }
    }

    /// Name, path and text of the file of a name of [`Self::names`].
    ///
    /// # Errors
    /// When there is none; the nearest is named.
    pub(crate) fn file(&self, name: &str) -> anyhow::Result<(&'static str, String, &'static str)> {
        let likeness = |known: &str| strsim::sorensen_dice(known, name);
        let nearest = || {
            let nearest = self.names().max_by(|a, b| likeness(a).total_cmp(&likeness(b)));
            nearest.expect("there are cases")
        };
        let file = self.files.iter().find(|(known, _)| *known == name);
        let (name, text) = file.with_context(|| {
            format!("there is no case `{name}`; the nearest is `{}`; --list shows all", nearest())
        })?;
        Ok((name, format!("{}/{name}.toml", self.path), text))
    }
}

/// What the first line of a scene's `text` says it is, up to its first stop.
pub(crate) fn title(text: &str) -> String {
    let title = text.lines().next().unwrap_or_default().trim_start_matches("# ");
    let title = title.split([';', ':']).next().and_then(|title| title.split(". ").next());
    title.unwrap_or_default().trim_end_matches('.').to_owned()
}

/// The files that scenes name, as they stand in the repository.
pub(crate) struct BuiltIn;

impl PartFiles for BuiltIn {
    fn network(&self, path: &Path) -> anyhow::Result<Network> {
        let draft: NetworkDraft = toml_file::parse(built_in(&NETWORKS, path)?, path)?;
        Network::try_from(draft).with_context(|| path.display().to_string())
    }

    fn surface(&self, path: &Path) -> anyhow::Result<TriangleMesh> {
        Ok(stl::parse(built_in(&SURFACES, path)?.to_vec(), path, stl::WELD_TOLERANCE)?)
    }

    fn tetrahedra(&self, path: &Path, _: &ChamberChoice) -> anyhow::Result<OwnSolid> {
        bail!("{} is not built in", path.display())
    }
}

fn built_in<T: Copy>(files: &[(&str, T)], path: &Path) -> anyhow::Result<T> {
    let file = files.iter().find(|(name, _)| path.ends_with(name));
    file.map(|(_, content)| *content).with_context(|| format!("{} is not built in", path.display()))
}

/// Networks by their path in the repository.
pub(crate) const NETWORKS: [(&str, &str); 4] = [
    ("examples/networks/basic_bend.toml", include_str!("../../examples/networks/basic_bend.toml")),
    ("examples/networks/pneunet.toml", include_str!("../../examples/networks/pneunet.toml")),
    ("examples/networks/paper.toml", include_str!("../../examples/networks/paper.toml")),
    (
        "verify/stability/parts/bellows.toml",
        include_str!("../../verify/stability/parts/bellows.toml"),
    ),
];

/// STL files by their path in the repository.
pub(crate) const SURFACES: [(&str, &[u8]); 2] = [
    (
        "verify/stability/parts/slivers.stl",
        include_bytes!("../../verify/stability/parts/slivers.stl"),
    ),
    (
        "verify/stability/parts/valence_10.stl",
        include_bytes!("../../verify/stability/parts/valence_10.stl"),
    ),
];
