//! `export`: a design as files for a printer, and what a printer would say of it.

use std::path::PathBuf;

use anyhow::ensure;
use clap::{Args, ValueEnum};

use super::terminal::say;
use crate::printing::{Inlet, LEAST_WALL, PrintSettings};
use crate::scene::material::within;
use crate::study::export;

/// What is exported, and how.
#[derive(Debug, Args)]
pub(super) struct Export {
    /// The folder of a run, or with --run a network file.
    source: PathBuf,
    /// A design of the run's front, such as g003-017.
    #[arg(required_unless_present = "run", conflicts_with = "run")]
    id: Option<String>,
    /// The run file that says how thick the wall of a network file is, and of what.
    #[arg(long)]
    run: Option<PathBuf>,
    /// Folder for part.stl, part.3mf and printability.json; must not exist.
    #[arg(long)]
    out: PathBuf,
    /// How air gets in: through the middle of the base.
    #[arg(long, value_enum, default_value_t = InletName::Hole)]
    inlet: InletName,
    /// Diameter of the inlet's bore, mm.
    #[arg(long, default_value_t = 3.0, allow_negative_numbers = true)]
    inlet_diameter: f64,
    /// Inner diameter of the tube that a barb is for, mm.
    #[arg(long, default_value_t = 5.0, allow_negative_numbers = true)]
    tube: f64,
    /// Edge length of the triangles, mm; shorter where the wall bends, longer where that cannot be meshed.
    #[arg(long, default_value_t = 1.0, allow_negative_numbers = true)]
    edge: f64,
    /// Edge of the cubes with which trapped air, leaks and bridges are looked for, mm.
    #[arg(long, default_value_t = PrintSettings::default().voxel, allow_negative_numbers = true)]
    voxel: f64,
    /// Density of the material, g/cm^3.
    #[arg(long, default_value_t = PrintSettings::default().density, allow_negative_numbers = true)]
    density: f64,
    /// Print the report as JSON instead of words.
    #[arg(long)]
    json: bool,
}

/// The names of the inlets on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum InletName {
    /// The chamber stays a closed void.
    None,
    /// A bore through the base, to glue a tube into.
    Hole,
    /// A barb below the base, to slip a tube over.
    Barb,
}

impl Export {
    /// Writes the files, and says what is in them.
    pub(super) fn run(&self) -> anyhow::Result<()> {
        let inlet_words = self.inlet_words();
        let export = export::Export {
            source: &self.source,
            id: self.id.as_deref(),
            run: self.run.as_deref(),
            out: &self.out,
            inlet: self.inlet()?,
            inlet_words: &inlet_words,
            edge: self.edge,
            print: PrintSettings { voxel: self.voxel, density: self.density },
        };
        let report = export.write()?;
        let words = || format!("{}\nresults in {}", report.in_words(), self.out.display());
        say(&if self.json { serde_json::to_string_pretty(&report)? } else { words() });
        Ok(())
    }

    fn inlet(&self) -> anyhow::Result<Inlet> {
        let (bore, tube) = (self.inlet_diameter, self.tube);
        if self.inlet == InletName::None {
            return Ok(Inlet::None);
        }
        // Finer ones close in printing; wider ones are no inlets.
        within("--inlet-diameter", bore, 0.5, 50.0)?;
        if self.inlet == InletName::Hole {
            return Ok(Inlet::Hole { bore });
        }
        within("--tube", tube, 0.5, 50.0)?;
        let barb = Inlet::Barb { bore, tube };
        ensure!(
            barb.barb_wall().is_some_and(|wall| wall >= LEAST_WALL),
            "--tube is {tube:?}, but a barb with a bore of {bore:?} mm wants at least {:.1} mm, for a wall of {LEAST_WALL} mm",
            bore + 2.0 * LEAST_WALL
        );
        Ok(barb)
    }

    fn inlet_words(&self) -> String {
        let (bore, tube) = (self.inlet_diameter, self.tube);
        match self.inlet {
            InletName::None => "no inlet".to_owned(),
            InletName::Hole => format!("hole of {bore} mm"),
            InletName::Barb => format!("barb for a tube of {tube} mm, bore {bore} mm"),
        }
    }
}
