//! `film`: a design while it is inflated, free and against a plane, as a GIF.

use std::path::{Path, PathBuf};

use anyhow::ensure;

use super::terminal::say;
use crate::io::atomic;
use crate::study::film::film;

/// What is filmed.
#[derive(Debug, clap::Args)]
pub(super) struct Film {
    /// The folder of a run, or of `simulate`.
    folder: PathBuf,
    /// Of a run: the design, such as g003-017. The front's designs have their shapes in the folder; others are computed again.
    id: Option<String>,
    /// The file; must not exist [default: the design's name and .gif, here].
    #[arg(long)]
    out: Option<PathBuf>,
}

impl Film {
    /// Draws the film and writes it.
    pub(super) fn run(&self) -> anyhow::Result<()> {
        if let Some(out) = &self.out {
            check_new(out)?;
        }
        let (name, gif) = film(&self.folder, self.id.as_deref())?;
        let out = self.out.clone().unwrap_or_else(|| PathBuf::from(format!("{name}.gif")));
        check_new(&out)?;
        atomic::write(&out, &gif)?;
        say(&out.display().to_string());
        Ok(())
    }
}

/// Refuses a file that is there.
fn check_new(path: &Path) -> anyhow::Result<()> {
    ensure!(!path.exists(), "{} exists; choose another name with --out", path.display());
    Ok(())
}
