//! `deck`: one solid wall under pressure, written for CalculiX and FEBio, with our own answer to
//! the same case.
//!
//! ```text
//! solid.inp              for CalculiX: `ccx solid`
//! solid.feb              for FEBio: `febio4 -i solid.feb`
//! path_solid.csv         our tip at each sample of the pressure
//! displacement_solid.csv our displacements of all nodes at the last one
//! case.json  wall.msh    what was asked, and the mesh
//! ```
//!
//! Shells are not written: CalculiX expands its shells to solid cells before it solves, and so has
//! no counterpart of a wall in plane stress; the solid of the same wall is the independent opinion.

pub(crate) mod comparison;

use std::path::Path;

use anyhow::{Context, anyhow, bail, ensure};
use serde::{Deserialize, Serialize};

use super::material::within;
use super::observer::Observer;
use super::part::closed_part::shell;
use super::part::on_disk::OnDisk;
use super::part::solid_part::{SolidPart, SolidReport, SolidSection};
use super::part::{PartSource, own_surface};
use super::results::design_folder::write_json;
use super::results::walk_summary::WalkSummary;
use super::scene_file::SceneFile;
use super::shape::NO_CHAMBER;
use crate::fitness::LoadSettings;
use crate::io::provenance::Provenance;
use crate::io::{
    ChamberFound, LawWithCard, OutputFolder, OwnSolid, SolidCase, atomic, calculix, csv, febio, msh,
};
use crate::math::Vec3;
use crate::mesh::{EndSets, Ends, ShellMesh, ShellSettings, SolidMesh};
use crate::model::material::{Compressible, Material};
use crate::model::system::System;
use crate::model::{PartModel, PartSetup, Support};
use crate::solve::{Backend, LinearMethod, PathPoint, follow};

/// What may be chosen instead of what the run or scene file says.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Choices {
    /// Of an incompressible rubber, which other programs do not know.
    pub poisson_ratio: Option<f64>,
    /// Edge length on the wall's faces, mm.
    pub edge: Option<f64>,
    /// The largest pressure, MPa.
    pub pressure: Option<f64>,
    /// In how many equal parts of it an answer is wanted.
    pub samples: Option<usize>,
    pub solver: Option<Backend>,
}

/// The file that makes a folder one of a deck.
pub(crate) const CASE: &str = "case.json";
/// Our tip.
pub(crate) const PATH: &str = "path_solid.csv";
/// Our last displacements.
pub(crate) const DISPLACEMENT: &str = "displacement_solid.csv";

/// `case.json`.
#[derive(Debug, Serialize)]
struct Case {
    design: String,
    law: String,
    /// MPa.
    shear_modulus: f64,
    bulk_modulus: f64,
    poisson_ratio: f64,
    /// The largest, MPa.
    pressure: f64,
    samples: usize,
    nodes: usize,
    tetrahedra: usize,
    pressure_faces: usize,
    clamp_nodes: usize,
    tip_nodes: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    chamber: Option<ChamberFound>,
    /// Enclosed by the chamber at rest, mm^3.
    chamber_volume: f64,
    #[serde(flatten)]
    walk: WalkSummary,
    #[serde(skip_serializing_if = "Option::is_none")]
    mesh: Option<SolidReport>,
    provenance: Provenance,
}

/// A row of `path_solid.csv`; decks of earlier versions name no units.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct TipRow {
    pub step: usize,
    /// MPa.
    #[serde(rename = "pressure_MPa", alias = "pressure")]
    pub pressure: f64,
    /// Mean displacement of the tip's nodes, mm.
    #[serde(rename = "tip_x_mm", alias = "tip_x")]
    pub tip_x: f64,
    #[serde(rename = "tip_y_mm", alias = "tip_y")]
    pub tip_y: f64,
    #[serde(rename = "tip_z_mm", alias = "tip_z")]
    pub tip_z: f64,
    /// Of a node, mm.
    #[serde(rename = "max_displacement_mm", alias = "max_displacement")]
    pub max_displacement: f64,
    /// In the chamber, mm^3.
    #[serde(rename = "volume_mm3", alias = "volume")]
    pub volume: f64,
}

/// A row of `displacement_solid.csv`, as [`TipRow`].
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct NodeRow {
    /// Counted from 1, as in the decks.
    pub node: u32,
    /// mm.
    #[serde(rename = "x_mm", alias = "x")]
    pub x: f64,
    #[serde(rename = "y_mm", alias = "y")]
    pub y: f64,
    #[serde(rename = "z_mm", alias = "z")]
    pub z: f64,
}

/// Each is a step of CalculiX's of some thirty iterations.
const MOST_SAMPLES: usize = 1000;

/// What is written and walked.
pub(crate) struct Subject {
    pub design: String,
    pub mesh: SolidMesh,
    /// Of tetrahedra of one's own.
    pub chamber: Option<ChamberFound>,
    pub report: Option<SolidReport>,
    pub wall: ShellSettings,
    pub ends: Ends,
    pub material: Compressible,
    pub was_incompressible: bool,
    pub load: LoadSettings,
    pub backend: Backend,
    pub linear: LinearMethod,
}

impl Choices {
    /// Refuses values that no deck can have.
    ///
    /// # Errors
    /// One sentence that names the value.
    pub(crate) fn check(&self) -> anyhow::Result<()> {
        if let Some(edge) = self.edge {
            within("--edge", edge, 1e-3, 1e3)?;
        }
        if let Some(pressure) = self.pressure {
            within("--pressure", pressure.abs(), 1e-9, 1e6)?;
        }
        let samples = self.samples.unwrap_or(1);
        ensure!(
            (1..=MOST_SAMPLES).contains(&samples),
            "--samples is {samples}, but it must lie between 1 and {MOST_SAMPLES}"
        );
        Ok(())
    }

    /// What the choices make of a solid of a run or scene file, whose mesher must be there.
    ///
    /// # Errors
    /// When no mesher is installed.
    pub(crate) fn section(&self, section: SolidSection) -> anyhow::Result<SolidSection> {
        let section = SolidSection { edge: self.edge.unwrap_or(section.edge), ..section };
        section.check_programs()?;
        Ok(section)
    }
}

/// What the decks of the scene file at `path` are of.
///
/// # Errors
/// When the file is refused, asks for what decks do not have, or its part cannot be made.
pub(crate) fn of_scene(
    path: &Path,
    choices: &Choices,
    observer: &dyn Observer,
) -> anyhow::Result<Subject> {
    ensure!(!path.is_dir(), "a run folder wants the name of an individual behind it, as g003-017");
    let scene = SceneFile::read(path, choices.solver)?;
    let refused = [
        ("[[plane]]", !scene.planes.is_empty()),
        ("[self_contact]", scene.self_contact.is_some()),
        ("[[region]]", !scene.regions.is_empty()),
        ("[pattern]", scene.pattern.is_some()),
        ("[gravity]", scene.gravity.is_some()),
        ("[limits]", scene.limits.is_some()),
        ("[load] volume_ratio", scene.load.volume_ratio.is_some()),
        ("[load] volume_mm3", scene.load.volume_mm3.is_some()),
        ("[load] gas", scene.load.gas.is_some()),
        ("[load] pressure = 0", scene.load.pressure == Some(0.0) && choices.pressure.is_none()),
        ("[load] curve", scene.load.curve),
        ("[load] linear", scene.load.linear),
    ];
    if let Some((what, _)) = refused.iter().find(|(_, is_there)| *is_there) {
        bail!(
            "{what} is not written into decks, which raise the pressure of a free part; take it away"
        );
    }
    let given = scene.material.material()?;
    let material = compressible(&given, choices.poisson_ratio)?;
    let mut chamber = None;
    let source = scene.part.source(path, &OnDisk)?;
    source
        .check_size(&scene.part, scene.wall.thickness)?
        .iter()
        .for_each(|line| observer.warning(line));
    let (mesh, report, ends) = match source {
        PartSource::Tetrahedra { file, solid, .. } => {
            let OwnSolid { mesh, chamber: found, warnings } = solid;
            ensure!(!mesh.chamber.is_empty(), "{}: {NO_CHAMBER}", file.display());
            warnings.iter().for_each(|warning| {
                observer.warning(&format!("{}: {warning}", file.display()));
            });
            chamber = Some(found);
            let ends = Ends::of_solid(&mesh, &scene.wall);
            (mesh, None, ends)
        }
        source if source.is_actuator() => {
            let shell = shell(&scene, &source, observer)?;
            let section = choices.section(scene.solid.unwrap_or_default())?;
            let law = Material::Compressible(material.clone());
            let model = PartModel::new(&shell, &law, &Support::Clamp, &PartSetup::default())
                .map_err(|rejected| anyhow!("{rejected}"))?;
            let judgement = own_surface::judged(&scene, &source, &shell, &model)?;
            judgement.iter().for_each(|line| observer.warning(line));
            let (mesh, report) = solid(&shell, &law, &section)?;
            (mesh, Some(report), shell.ends.heights)
        }
        _ => bail!(
            "[part] has no base to be clamped at; decks want a network, an STL file or tetrahedra"
        ),
    };
    let name =
        path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    Ok(Subject {
        design: name,
        mesh,
        chamber,
        report,
        wall: scene.wall,
        ends,
        material,
        was_incompressible: given.poisson_ratio() == 0.5,
        load: scene.load_settings(),
        backend: scene.solver.backend,
        linear: scene.solver.linear,
    })
}

/// The tetrahedra of the wall around the middle of a `shell`.
///
/// # Errors
/// When the wall cannot be filled, or no mesher runs.
pub(crate) fn solid(
    shell: &ShellMesh,
    material: &Material,
    section: &SolidSection,
) -> anyhow::Result<(SolidMesh, SolidReport)> {
    let failed = |rejected| anyhow!("{rejected}");
    let model =
        PartModel::new(shell, material, &Support::Clamp, &PartSetup::default()).map_err(failed)?;
    let SolidPart { mesh, report } = SolidPart::new(shell, &model, section)?.map_err(failed)?;
    Ok((mesh, report))
}

/// The Poisson's ratio of a rubber that has none of its own.
const POISSON_RATIO: f64 = 0.49;
/// Beyond, cells with displacements alone lock.
const LARGEST_POISSON_RATIO: f64 = 0.4999;

/// `material` with a bulk modulus `2 mu (1 + nu) / (3 (1 - 2 nu))`, where it is incompressible.
///
/// # Errors
/// When the `material` is one of shells alone or one that other programs lack, or has a Poisson's
/// ratio of its own and another is given.
pub(crate) fn compressible(
    material: &Material,
    poisson_ratio: Option<f64>,
) -> anyhow::Result<Compressible> {
    let (law, bulk_modulus) = material.rubber().context("[material] has a law of shells alone")?;
    // Before anything is meshed: not every law has a card.
    LawWithCard::try_from(&law)?;
    if let Some(bulk_modulus) = bulk_modulus {
        ensure!(
            poisson_ratio.is_none(),
            "--poisson-ratio is for incompressible rubbers; [material] has {:.4}",
            material.poisson_ratio()
        );
        return Ok(Compressible { law, bulk_modulus });
    }
    let nu = poisson_ratio.unwrap_or(POISSON_RATIO);
    within("--poisson-ratio", nu, 0.0, LARGEST_POISSON_RATIO)?;
    let mu = material.shear_modulus();
    Ok(Compressible { law, bulk_modulus: 2.0 * mu * (1.0 + nu) / (3.0 * (1.0 - 2.0 * nu)) })
}

impl Subject {
    /// Walks the solid and writes decks and answer into the new folder `out`; returns what a person
    /// is told, some lines.
    ///
    /// # Errors
    /// When its clamp holds too little or the tip, the path ends early, or a file cannot be
    /// written.
    pub(crate) fn write(mut self, choices: &Choices, out: &Path) -> anyhow::Result<String> {
        let LoadSettings { pressure, path, .. } = &mut self.load;
        *pressure = choices.pressure.unwrap_or(*pressure);
        path.steps = choices.samples.unwrap_or(path.steps);
        let Self { design, mesh, wall, material, load, .. } = &self;
        let (surface, corners) = mesh.boundary();
        let EndSets { clamp, tip, .. } = EndSets::of_solid(mesh, self.ends, &surface);
        // On the part's faces, where `simulate` reads the tip of tetrahedra.
        let tip: Vec<u32> = tip.iter().map(|&vertex| corners[vertex as usize]).collect();
        ensure!(
            clamp.len() > 3 && tip.iter().all(|node| clamp.binary_search(node).is_err()),
            "the clamp below z = {:.3} mm holds {} nodes; it must hold 4 at least, and none of the tip's: see [wall]",
            self.ends.clamp_top,
            clamp.len()
        );
        ensure!(
            mesh.lids.iter().flat_map(|lid| &lid.rim).all(|node| clamp.binary_search(node).is_ok()),
            "decks have no lids, so their rims must be held: raise [wall] clamp_height, or close the inlet in the mesh"
        );
        let law = Material::Compressible(material.clone());
        let shape = LawWithCard::try_from(&material.law)?;
        let title = format!(
            "{design}, 0 to {} MPa in {} samples, {} with a bulk modulus of {:.4} MPa",
            load.pressure,
            load.path.steps,
            shape.in_words(),
            material.bulk_modulus
        );
        let case = SolidCase {
            title: &title,
            mesh,
            law: &shape,
            bulk_modulus: material.bulk_modulus,
            poisson_ratio: law.poisson_ratio(),
            clamp: &clamp,
            tip: &tip,
            pressure: load.pressure,
            samples: load.path.steps,
        };
        let inp = calculix::deck(&case)?;
        let held = SolidMesh::unknowns_of(&clamp);
        let mut model =
            PartModel::of_solid(mesh, wall.thickness, &law, &held.into(), &load.setup(Vec::new()))
                .map_err(|rejected| anyhow!("{rejected}"))?;
        let mut solver = self.backend.solver_by(self.linear, model.pattern())?;
        let walked = follow(&mut model, solver.as_mut(), load.pressure, Vec::new(), &load.path)?;
        let samples: Vec<&PathPoint> =
            walked.points.iter().filter(|point| point.is_sample).collect();
        let walk = WalkSummary::new(&walked, &model);
        let last = *samples.last().with_context(|| format!("{} at rest", walk.in_words()))?;
        ensure!(
            walked.ending.is_complete(),
            "our own path ends early: {} beyond {:.4} MPa; ask for less by --pressure",
            walk.in_words(),
            last.load
        );
        let folder = OutputFolder::create_new(out)?;
        atomic::write(&folder.file("solid.inp"), inp.as_bytes())?;
        atomic::write(&folder.file("solid.feb"), febio::deck(&case).as_bytes())?;
        msh::write(&folder.file("wall.msh"), mesh)?;
        let rows: Vec<TipRow> = (0..).zip(&samples).map(|(k, at)| row(k, at, mesh, &tip)).collect();
        csv::write(&folder.file(PATH), &rows)?;
        let nodes: Vec<NodeRow> = (1..)
            .zip(displacements(last, mesh))
            .map(|(node, u)| NodeRow { node, x: u.x, y: u.y, z: u.z })
            .collect();
        csv::write(&folder.file(DISPLACEMENT), &nodes)?;
        let chamber = self.chamber.as_ref().map(|chamber| chamber.in_words(rows[0].volume) + "\n");
        let words =
            chamber.unwrap_or_default() + &self.in_words(&rows[rows.len() - 1], &walk, &case, out);
        let case = Case {
            design: design.clone(),
            law: shape.in_words().to_owned(),
            shear_modulus: law.shear_modulus(),
            bulk_modulus: material.bulk_modulus,
            poisson_ratio: law.poisson_ratio(),
            pressure: load.pressure,
            samples: load.path.steps,
            nodes: mesh.positions.len(),
            tetrahedra: mesh.tetrahedra.len(),
            pressure_faces: mesh.chamber.len(),
            clamp_nodes: clamp.len(),
            tip_nodes: tip.len(),
            chamber: self.chamber.clone(),
            chamber_volume: rows[0].volume,
            walk,
            mesh: self.report,
            provenance: Provenance::of_this_process(),
        };
        write_json(&folder.file(CASE), &case)?;
        Ok(words)
    }

    fn in_words(
        &self,
        last: &TipRow,
        walk: &WalkSummary,
        case: &SolidCase<'_>,
        out: &Path,
    ) -> String {
        let Self { design, mesh, material, was_incompressible, .. } = self;
        let poisson_ratio = case.poisson_ratio;
        let why = if *was_incompressible {
            "; the rubber itself is incompressible, which CalculiX has no cells for, so all three solve this law"
        } else {
            ""
        };
        let TipRow { pressure, tip_x, tip_y, tip_z, .. } = *last;
        let locking = calculix::locking_in_words(poisson_ratio).map_or_else(String::new, |words| {
            let advice = if *was_incompressible {
                "--poisson-ratio 0.3 gives both a law at which they hardly do"
            } else {
                "a smaller bulk_modulus gives both a law at which they hardly do"
            };
            format!("{words}; {advice}\n")
        });
        format!(
            "{design}: {} nodes, {} tetrahedra, {} faces under pressure\n\
             {} with a bulk modulus of {:.3} MPa (Poisson's ratio {poisson_ratio:.4}){why}\n\
             ours {} at {pressure:.4} MPa: tip moved by ({tip_x:+.3}, {tip_y:+.3}, {tip_z:+.3}) mm\n\
             {locking}next: (cd {} && ccx solid) && pneumorph compare {}",
            mesh.positions.len(),
            mesh.tetrahedra.len(),
            mesh.chamber.len(),
            case.law.in_words(),
            material.bulk_modulus,
            walk.in_words(),
            out.display(),
            out.display()
        )
    }
}

fn displacements<'a>(
    point: &'a PathPoint,
    mesh: &SolidMesh,
) -> impl ExactSizeIterator<Item = Vec3> + use<'a> {
    let places = &point.x[..3 * mesh.positions.len()];
    places.as_chunks().0.iter().map(|&u: &[f64; 3]| u.into())
}

fn row(step: usize, point: &PathPoint, mesh: &SolidMesh, tip: &[u32]) -> TipRow {
    let u: Vec<Vec3> = displacements(point, mesh).collect();
    let sum: Vec3 = tip.iter().map(|&node| u[node as usize]).sum();
    let mean = sum / tip.len() as f64;
    TipRow {
        step,
        pressure: point.load,
        tip_x: mean.x,
        tip_y: mean.y,
        tip_z: mean.z,
        max_displacement: u.iter().map(|u| u.norm()).fold(0.0, f64::max),
        volume: point.conjugate,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::material::{NeoHookean, StVenantKirchhoff};

    /// `kappa / mu = 2 (1 + nu) / (3 (1 - 2 nu))` is 149 / 3 at 0.49: 49.67.
    #[test]
    fn incompressible_rubbers_are_given_a_volume() {
        let rubber = Material::NeoHookean(NeoHookean { mu: 3.0 });
        let law = compressible(&rubber, None).unwrap();
        assert!((law.bulk_modulus - 149.0).abs() < 1e-9, "{law:?}");
        let law = Material::Compressible(compressible(&rubber, Some(0.45)).unwrap());
        assert!((law.poisson_ratio() - 0.45).abs() < 1e-12);
        assert_eq!(Material::Compressible(compressible(&law, None).unwrap()), law);
        assert!(compressible(&law, Some(0.49)).is_err());
        assert!(compressible(&rubber, Some(0.5)).is_err());
        let plate = StVenantKirchhoff { young_modulus: 1.0, poisson_ratio: 0.3 };
        assert!(compressible(&Material::StVenantKirchhoff(plate), None).is_err());
    }
}
