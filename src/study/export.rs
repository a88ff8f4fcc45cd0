//! `export`: a design as files for a printer, and what a printer would say of it.
//!
//! ```text
//! part.stl  part.3mf      the wall with its inlet, one closed surface, mm
//! printability.json       thickness, overhangs, bridges, trapped air, leaks, mass
//! ```

use std::path::Path;

use anyhow::{Context, anyhow, ensure};
use serde::Serialize;

use super::run_file::RunFile;
use super::run_folder::RunFolder;
use crate::evolve::IndividualId;
use crate::field::{CappedField, CompiledNetwork};
use crate::genome::Network;
use crate::io::three_mf::Model;
use crate::io::{OutputFolder, stl};
use crate::math::Rejected;
use crate::mesh::{WallSettings, WallSurfaces, shell_of_field, wall_surfaces};
use crate::model::{PartModel, PartSetup, Support};
use crate::printing::{Inlet, PrintSettings, Printability, PrintedPart};
use crate::scene::material::within;
use crate::scene::part::on_disk::read_network;
use crate::scene::part::solid_part::middle;
use crate::scene::pattern::PatternSection;
use crate::scene::results::design_folder::write_json;
use crate::surface::TriangleMesh;

/// What is exported, and how.
pub(crate) struct Export<'a> {
    /// The folder of a run, or with `run` a network file.
    pub source: &'a Path,
    /// A design of the run's front.
    pub id: Option<&'a str>,
    /// The run file of a network file.
    pub run: Option<&'a Path>,
    /// The new folder.
    pub out: &'a Path,
    pub inlet: Inlet,
    /// The inlet in words.
    pub inlet_words: &'a str,
    /// Edge length of the triangles, mm.
    pub edge: f64,
    /// Edge of the cubes (mm), and density (g/cm^3).
    pub print: PrintSettings,
}

/// `printability.json`.
#[derive(Debug, Serialize)]
pub(crate) struct Report {
    design: String,
    material: String,
    inlet: String,
    triangles: usize,
    /// Edge length of the faces, mm.
    edge_mm: f64,
    #[serde(flatten)]
    printability: Printability,
}

impl Export<'_> {
    /// Writes the files, and tells what is in them.
    ///
    /// # Errors
    /// When design, edge, cubes or density are refused, the wall cannot be meshed or printed, or a
    /// file cannot be written.
    pub(crate) fn write(&self) -> anyhow::Result<Report> {
        OutputFolder::check_new(self.out)?;
        within("--density", self.print.density, 0.01, 30.0)?;
        let (name, network, run) = self.design()?;
        ensure!(
            run.pattern.is_none(),
            "export writes one body of one thickness and material, and the run has a [pattern]"
        );
        PatternSection::check(None, &network).with_context(|| name.clone())?;
        let thickness = run.wall.thickness;
        let base_height = run.wall.clamp_height * thickness;
        within("--edge", self.edge, 0.1, 20.0)?;
        let most = 0.5 * thickness;
        within("--voxel, which is to find leaks of the wall,", self.print.voxel, 0.05, most)?;
        let refused = |rejected: Rejected| anyhow!("{name}: {rejected}");
        let (wall, edge) = self.wall(&middle_of(&network, &run)?, thickness).map_err(refused)?;
        let part = PrintedPart::new(&wall, thickness, base_height, &self.inlet).map_err(refused)?;
        self.check_voxels(&part.surface)?;
        let printability = Printability::of(&part, &self.print).map_err(refused)?;

        let folder = OutputFolder::create_new(self.out)?;
        stl::write(&folder.file("part.stl"), &part.surface)?;
        let inlet = self.inlet_words;
        let material = run.material.name();
        let description = format!("pneumatic actuator, wall of {thickness} mm, {inlet}");
        let model = Model { name: &name, description: &description, material, mesh: &part.surface };
        model.write(&folder.file("part.3mf"))?;
        let report = Report {
            design: name.clone(),
            material: material.to_owned(),
            inlet: inlet.to_owned(),
            triangles: part.surface.triangles.len(),
            edge_mm: edge,
            printability,
        };
        write_json(&folder.file("printability.json"), &report)?;
        Ok(report)
    }

    /// The name, the network and the run file of the design.
    fn design(&self) -> anyhow::Result<(String, Network, RunFile)> {
        let Some(id) = self.id else {
            let run = self.run.context("a network file wants a run file")?;
            let name = self.source.file_stem().unwrap_or_default().to_string_lossy();
            return Ok((name.into_owned(), read_network(self.source)?, RunFile::read(run, None)?));
        };
        let id: IndividualId = id.parse()?;
        let folder = RunFolder::open(self.source)?;
        let run = folder.run_file()?;
        let network = folder.path().join("front").join(id.to_string()).join("genome.toml");
        ensure!(
            network.is_file(),
            "{} has no design {id} on its front; front.csv lists those it has",
            self.source.display()
        );
        Ok((id.to_string(), read_network(&network)?, run))
    }

    /// The faces of the wall around `mid`, and the edge length that could be meshed.
    fn wall(&self, mid: &TriangleMesh, thickness: f64) -> Result<(WallSurfaces, f64), Rejected> {
        let with = |edge: f64| {
            let settings = WallSettings { edge, ..WallSettings::default() };
            wall_surfaces(mid, thickness, &settings).map(|wall| (wall, edge))
        };
        OTHER_EDGES.iter().fold(with(self.edge), |found, share| {
            found.or_else(|rejected| with(share * self.edge).map_err(|_| rejected))
        })
    }

    fn check_voxels(&self, surface: &TriangleMesh) -> anyhow::Result<()> {
        let (lower, upper) = surface.bounding_box().unwrap_or_default();
        let cubes = (upper - lower).product() / self.print.voxel.powi(3);
        ensure!(
            cubes <= MOST_CUBES,
            "--voxel is {:?}, too fine for a part of this size; {:.2} mm would do",
            self.print.voxel,
            self.print.voxel * (cubes / MOST_CUBES).cbrt() + 0.005
        );
        Ok(())
    }
}

/// The middle of the wall of the design that `network` makes under the settings of `run`.
fn middle_of(network: &Network, run: &RunFile) -> anyhow::Result<TriangleMesh> {
    let compiled = CompiledNetwork::new(network);
    let field = CappedField::new(compiled, run.design_box, run.mesh.rim_radius)?;
    let material = run.material.material()?;
    let shell = shell_of_field(&field, &run.mesh, &run.wall)
        .and_then(|shell| PartModel::new(&shell, &material, &Support::Clamp, &PartSetup::default()))
        .map_err(|rejected| anyhow!("{rejected}"))?;
    Ok(middle(&shell, run.wall.thickness))
}

impl Report {
    /// What is in the files and what a printer would say, some lines for a person.
    pub(crate) fn in_words(&self) -> String {
        let Printability {
            size_mm: [x, y, z],
            volume_mm3,
            mass_g,
            density_g_cm3,
            least_wall_mm,
            least_wall_at_mm,
            voxel_mm,
            pockets_mm3,
            warnings,
            ..
        } = &self.printability;
        let yes = |answer: bool| if answer { "yes" } else { "no" };
        let [at_x, at_y, at_z] = least_wall_at_mm;
        let mut lines = vec![
            format!("{} in {}, {}", self.design, self.material, self.inlet),
            format!("{} triangles, edges of {} mm", self.triangles, self.edge_mm),
            format!("size          {x:.1} x {y:.1} x {z:.1} mm"),
            format!(
                "material      {:.2} cm^3, {mass_g:.1} g at {density_g_cm3} g/cm^3",
                1e-3 * volume_mm3
            ),
            format!("thinnest      {least_wall_mm:.2} mm at ({at_x:.1}, {at_y:.1}, {at_z:.1})"),
            format!(
                "air           chamber reached: {}, airtight when plugged: {}, trapped pockets: {} (cubes of {voxel_mm} mm)",
                yes(self.printability.chamber_reached),
                yes(self.printability.airtight),
                pockets_mm3.len()
            ),
            String::new(),
            "up   overhang %  in chamber %  support mm^2  bridge mm  height mm".to_owned(),
        ];
        for (place, up) in self.printability.orientations.iter().enumerate() {
            lines.push(format!(
                "{:<3}  {:>10.1}  {:>12.1}  {:>12.0}  {:>9.1}  {:>9.1}{}",
                up.up,
                100.0 * up.overhang_share,
                100.0 * up.chamber_overhang_share,
                up.support_area_mm2,
                up.longest_bridge_mm,
                up.height_mm,
                if place == 0 { "  best" } else { "" }
            ));
        }
        lines.extend(warnings.iter().map(|warning| format!("warning: {warning}")));
        lines.join("\n")
    }
}

/// Edge lengths that are tried where the one wanted fails, over it; twice the default is the
/// solids'.
const OTHER_EDGES: [f64; 3] = [0.7, 1.5, 2.0];
/// Some hundred megabytes.
const MOST_CUBES: f64 = 2e8;
