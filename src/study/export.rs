//! `export`: a design as files for a printer, and what a printer would say of it.
//!
//! ```text
//! part.stl  part.3mf          the wall with its inlet, one closed surface, mm; of several materials the 3MF has a body for each
//! part_1.stl  part_2.stl ..   of several materials: the body of each, which share their joints
//! printability.json           thickness, overhangs, bridges, trapped air, leaks, mass
//! ```

use std::path::Path;

use anyhow::{Context, anyhow, bail, ensure};
use serde::Serialize;

use super::run_file::RunFile;
use super::run_folder::RunFolder;
use crate::evolve::IndividualId;
use crate::fitness::shell_of_network;
use crate::genome::Network;
use crate::io::three_mf::{Model, PrintBody};
use crate::io::{OutputFolder, stl};
use crate::math::{Rejected, Vec3};
use crate::mesh::tetrahedra::{MesherFailure, TetSettings, check};
use crate::mesh::{TetMesh, WallSettings, WallSurfaces, wall_surfaces};
use crate::model::{PartModel, PartSetup, Support};
use crate::printing::{Bodies, Inlet, LEAST_PIECE, PrintSettings, Printability, PrintedPart};
use crate::scene::material::{MaterialSection, within};
use crate::scene::part::on_disk::read_network;
use crate::scene::part::solid_part::{material_at, meshers, middle};
use crate::scene::pattern::PatternSection;
use crate::scene::results::design_folder::write_json;
use crate::surface::{MidSurface, TriangleMesh};

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
    /// Of several materials, what each extruder prints.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    bodies: Vec<BodyReport>,
    #[serde(flatten)]
    printability: Printability,
}

/// What one extruder prints.
struct Body {
    /// Its place in the list of materials.
    material: usize,
    surface: TriangleMesh,
}

/// The body of one material.
#[derive(Debug, Serialize)]
struct BodyReport {
    file: String,
    material: String,
    volume_mm3: f64,
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
        PatternSection::check(run.pattern.as_ref(), &network).with_context(|| name.clone())?;
        let refused = |rejected: Rejected| anyhow!("{name}: {rejected}");
        let settings = run.candidate_settings()?;
        let shell = shell_of_network(&network, &settings).map_err(refused)?;
        let setup = PartSetup::default();
        let model = PartModel::new(&shell, &settings.materials(), &Support::Clamp, &setup);
        let middle = middle(&model.map_err(refused)?, &shell.section)?;
        let [thinnest, thickest] = shell.section.thickness_range();
        let base_height = run.wall.clamp_height * run.wall.thickness;
        within("--edge", self.edge, 0.1, 20.0)?;
        let most = 0.5 * thinnest;
        within("--voxel, which is to find leaks of the wall,", self.print.voxel, 0.05, most)?;
        let (wall, edge) = self.wall(&middle).map_err(refused)?;
        let part = PrintedPart::new(&wall, thickest, base_height, &self.inlet).map_err(refused)?;
        self.check_voxels(&part.surface)?;
        let mut printability = Printability::of(&part, &self.print).map_err(refused)?;
        let materials = materials_of(&run);
        let bodies = if shell.section.last_material() > 0 {
            let material = |x: Vec3| material_at(&shell, &middle, x);
            let (bodies, warning) =
                self.bodies(&part.surface, edge, &material).context(name.clone())?;
            printability.warnings.extend(warning);
            bodies
        } else {
            Vec::new()
        };

        let folder = OutputFolder::create_new(self.out)?;
        stl::write(&folder.file("part.stl"), &part.surface)?;
        let inlet = self.inlet_words;
        let wall = if thinnest < thickest {
            format!("{thinnest:.2} to {thickest:.2}")
        } else {
            thickest.to_string()
        };
        let description = format!("pneumatic actuator, wall of {wall} mm, {inlet}");
        let print = |(material, mesh)| PrintBody { material, mesh };
        let mut report = Vec::new();
        for Body { material, surface } in bodies.iter().filter(|_| bodies.len() > 1) {
            let (file, material) = (format!("part_{}.stl", material + 1), materials[*material]);
            stl::write(&folder.file(&file), surface)?;
            let (material, volume_mm3) = (material.to_owned(), surface.volume());
            report.push(BodyReport { file, material, volume_mm3 });
        }
        let of_each: Vec<PrintBody<'_>> = match &bodies[..] {
            [] => vec![print((materials[0], &part.surface))],
            [body] => vec![print((materials[body.material], &part.surface))],
            bodies => {
                bodies.iter().map(|body| print((materials[body.material], &body.surface))).collect()
            }
        };
        let model = Model { name: &name, description: &description, bodies: &of_each };
        model.write(&folder.file("part.3mf"))?;
        let names: Vec<&str> = of_each.iter().map(|body| body.material).collect();
        let report = Report {
            design: name.clone(),
            material: names.join(" and "),
            inlet: inlet.to_owned(),
            triangles: part.surface.triangles.len(),
            edge_mm: edge,
            bodies: report,
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

    /// The faces of the wall around its `middle`, and the edge length that could be meshed.
    fn wall(&self, middle: &MidSurface) -> Result<(WallSurfaces, f64), Rejected> {
        let with = |edge: f64| {
            let settings = WallSettings { edge, ..WallSettings::default() };
            wall_surfaces(middle, &settings).map(|wall| (wall, edge))
        };
        OTHER_EDGES.iter().fold(with(self.edge), |found, share| {
            found.or_else(|rejected| with(share * self.edge).map_err(|_| rejected))
        })
    }

    /// The bodies of the part in a `surface` with edges of `edge` (mm), by the `material` at each point; and what is to be said of them.
    fn bodies(
        &self,
        surface: &TriangleMesh,
        edge: f64,
        material: &dyn Fn(Vec3) -> u16,
    ) -> anyhow::Result<(Vec<Body>, Option<String>)> {
        let mesh = filled(surface, edge)?;
        let centre =
            |cell: &[u32; 4]| cell.iter().map(|&v| mesh.positions[v as usize]).sum::<Vec3>() / 4.0;
        let materials: Vec<u16> =
            mesh.tetrahedra.iter().map(|cell| material(centre(cell))).collect();
        let last = materials.iter().max().copied().unwrap_or_default();
        let bodies = Bodies::new(&mesh, materials);
        let warning = (bodies.changed() > 0).then(|| {
            let share = 100.0 * bodies.changed() as f64 / mesh.tetrahedra.len() as f64;
            format!("{share:.2} % of the material is not of the one asked for: pieces below {LEAST_PIECE} mm^3 and what meets in an edge alone take the material around them")
        });
        let body = |material: u16| Body {
            material: usize::from(material),
            surface: bodies.surface(material),
        };
        let bodies: Vec<Body> =
            (0..=last).map(body).filter(|body| !body.surface.triangles.is_empty()).collect();
        for Body { surface, .. } in &bodies {
            surface.check_closed_manifold().map_err(|defect| {
                anyhow!(
                    "the body of one material is no closed surface: {defect}; another --edge may do"
                )
            })?;
        }
        Ok((bodies, warning))
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

/// Tetrahedra in a closed `surface` with edges of `edge`, mm.
fn filled(surface: &TriangleMesh, edge: f64) -> anyhow::Result<TetMesh> {
    let (positions, triangles) = (Vec::new(), Vec::new());
    let chamber = TriangleMesh { positions, triangles };
    let wall = WallSurfaces { outer: surface.clone(), chamber };
    let settings = TetSettings { edge, layers: 1, ..TetSettings::default() };
    let mut failures = Vec::new();
    for mesher in meshers(None) {
        let mesh = mesher.tetrahedra(&wall, &[], &settings);
        match mesh.and_then(|mesh| check(&mesh, &wall).map(|()| mesh).map_err(Into::into)) {
            Ok(mesh) => return Ok(mesh),
            Err(MesherFailure::Machine(what)) => bail!(what),
            Err(failure) => failures.push(format!("{}: {failure}", mesher.name())),
        }
    }
    bail!("the part cannot be cut into bodies of one material: {}", failures.join("; "))
}

/// The names of the materials of a run, in the order in which sections name them.
fn materials_of(run: &RunFile) -> Vec<&str> {
    let second = run.pattern.as_ref().and_then(|pattern| pattern.material.as_ref());
    [&run.material].into_iter().chain(second).map(MaterialSection::name).collect()
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
        for (body, extruder) in self.bodies.iter().zip(1..) {
            lines.insert(
                4 + extruder - 1,
                format!(
                    "extruder {extruder}    {:.2} cm^3 of {}: {}",
                    1e-3 * body.volume_mm3,
                    body.material,
                    body.file
                ),
            );
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
