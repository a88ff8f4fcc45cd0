//! `material`: a law of one's own rubber, and the materials that are known by name.

use std::path::PathBuf;

use super::terminal::say;
use crate::calibration::test_table::named_test;
use crate::calibration::{Calibration, Request};
use crate::io::OutputFolder;
use crate::model::material::Loading;
use crate::scene::presets;

/// What was asked on the command line.
#[derive(Debug, clap::Subcommand)]
pub(super) enum MaterialCommand {
    /// Fit every law to tests of a rubber, stable in Drucker's sense, and write the one that predicts best as a `[material]`.
    ///
    /// A table (CSV) has a line of names and then one line for each state: `stretch`, `strain` (engineering) or `strain_percent`;
    /// `nominal_mpa`, `nominal_kpa`, `cauchy_mpa` or `cauchy_kpa`; and `test`, which is uniaxial, planar (pure shear) or equibiaxial.
    Fit(Fit),
    /// List the materials that `[material] preset` knows: what each is, how far it was stretched, and where its numbers come from.
    Presets {
        /// Print them as JSON instead of words.
        #[arg(long)]
        json: bool,
    },
}

#[derive(Debug, clap::Args)]
pub(super) struct Fit {
    /// Tables of tests of one rubber (CSV).
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// Folder for material.toml, laws.json and the figure; must not exist.
    #[arg(long)]
    out: PathBuf,
    /// The kind of test of files without a column `test`: uniaxial, planar or equibiaxial.
    #[arg(long, value_parser = named_test)]
    test: Option<Loading>,
    /// Leave out what was stretched further, or pressed below its inverse.
    #[arg(long, value_parser = stretch, allow_negative_numbers = true)]
    up_to: Option<f64>,
    /// Print the fits as JSON instead of words.
    #[arg(long)]
    json: bool,
}

impl MaterialCommand {
    /// Does it and tells it.
    pub(super) fn run(&self) -> anyhow::Result<()> {
        match self {
            Self::Fit(fit) => fit.run(),
            Self::Presets { json: true } => {
                say(&serde_json::to_string_pretty(&presets::records())?);
                Ok(())
            }
            Self::Presets { json: false } => {
                say(presets::in_words().trim_end());
                Ok(())
            }
        }
    }
}

impl Fit {
    fn run(&self) -> anyhow::Result<()> {
        OutputFolder::check_new(&self.out)?;
        let request = Request { files: &self.files, test: self.test, up_to: self.up_to };
        let calibration = Calibration::new(&request)?;
        let written = calibration.write(&self.out)?;
        if self.json {
            say(&serde_json::to_string_pretty(&calibration.in_json())?);
            return Ok(());
        }
        say(&calibration.in_words());
        written.iter().for_each(|path| say(&path.display().to_string()));
        Ok(())
    }
}

fn stretch(text: &str) -> Result<f64, String> {
    let stretch = text.parse().ok().filter(|stretch: &f64| *stretch > 1.0 && stretch.is_finite());
    stretch.ok_or_else(|| "it must be a stretch above 1".to_owned())
}
