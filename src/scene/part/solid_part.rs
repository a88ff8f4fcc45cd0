//! `[solid]`: the wall of a closed part in tetrahedra, made without a human.

use anyhow::{anyhow, ensure};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::fitness::FidelitySettings;
use crate::io::child::is_installed;
use crate::io::gmsh::{Algorithm, Gmsh};
use crate::io::tetgen::TetGen;
use crate::math::{Rejected, Vec3};
use crate::mesh::tetrahedra::{
    Attempt, Filled, TetMesher, TetQuality, TetSettings, Unfilled, filled_wall,
};
use crate::mesh::{Section, ShellMesh, SolidMesh, WallSettings, wall_surfaces};
use crate::model::material::Material;
use crate::model::{PartModel, PartSetup, SolidLoads};
use crate::scene::checks::check_distance;
use crate::scene::material::within;
use crate::surface::{MeshDefect, MidSurface};

/// How a wall becomes tetrahedra, and what its answers say of the shell's.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct SolidSection {
    /// Edge length on the wall's faces, mm.
    pub edge: f64,
    /// Elements through the wall; by default as many as make them as high as wide.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub layers: Option<usize>,
    /// Which program makes the tetrahedra; by default the one and then the other.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mesher: Option<MesherName>,
    /// For certificates: how many times longer the edges of a second solid are, by which the first is judged.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coarser: Option<f64>,
    /// When a shell is trusted.
    pub fidelity: FidelitySettings,
}

impl Default for SolidSection {
    fn default() -> Self {
        Self {
            edge: 2.0,
            layers: None,
            mesher: None,
            coarser: None,
            fidelity: FidelitySettings::default(),
        }
    }
}

/// A program that makes tetrahedra.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum MesherName {
    Tetgen,
    Gmsh,
}

/// Facets of the middle, in thicknesses of the wall where it is thinnest: their corners show in neither face.
const FACET: f64 = 0.3;
/// Facets of the middle, at the least, as a share of the part: some hundred thousand of them.
const LEAST_FACET: f64 = 2e-3;
/// The finest edge of the ladder, as a share of the one asked for.
const LEAST_SHARE: f64 = 0.6;
/// Cubes of that edge about the part: some points of the grid from which faces are made each.
const MOST_CUBES: f64 = 4e6;
/// More is a thick body, not a wall.
const MOST_LAYERS: usize = 16;

impl SolidSection {
    pub(crate) fn check(&self) -> anyhow::Result<()> {
        check_distance("[solid] edge", self.edge)?;
        let layers = self.layers.unwrap_or(1);
        ensure!(
            (1..=MOST_LAYERS).contains(&layers),
            "[solid] layers is {layers}, but it must lie between 1 and {MOST_LAYERS}"
        );
        within("[solid] coarser", self.coarser.unwrap_or(1.5), 1.1, 4.0)?;
        let FidelitySettings { trust, check } = self.fidelity;
        ensure!(
            trust > 0.0 && trust <= check,
            "[solid.fidelity] wants 0 < trust <= check, not trust = {trust} and check = {check}"
        );
        Ok(())
    }

    /// Refuses a law of shells alone.
    pub(crate) fn check_material(&self, material: &Material) -> anyhow::Result<()> {
        ensure!(
            material.solid().is_some(),
            "[material] has a law of shells alone; take [solid] away"
        );
        Ok(())
    }

    /// Refuses to begin what a missing program would end.
    pub(crate) fn check_programs(&self) -> anyhow::Result<()> {
        let needed: &[&str] = match self.mesher {
            None => &["tetgen", "gmsh"],
            Some(MesherName::Tetgen) => &["tetgen"],
            Some(MesherName::Gmsh) => &["gmsh"],
        };
        for program in needed {
            ensure!(
                is_installed(program),
                "[solid] wants the program `{program}`; install the package of that name"
            );
        }
        Ok(())
    }

    /// The section for a mesh whose edges are `share` as long.
    pub(crate) fn scaled(&self, share: f64) -> Self {
        Self { edge: share * self.edge, ..*self }
    }

    fn settings(&self, thickness: f64) -> TetSettings {
        let settings = TetSettings::for_wall(thickness, self.edge);
        TetSettings { layers: self.layers.unwrap_or(settings.layers), ..settings }
    }
}

/// The middle of the wall of a `shell` of this `section`, as its solid has it.
///
/// # Errors
/// [`MeshDefect`] unless the shell is closed.
pub(crate) fn middle(shell: &PartModel, section: &Section) -> Result<MidSurface, MeshDefect> {
    let [thinnest, _] = section.thickness_range();
    shell.mid_surface((FACET * thinnest).max(LEAST_FACET * shell.rest_size().amax()))
}

/// The place in the list of materials of that of a solid around the `middle` of a `shell` at `point`: that of the nearest triangle.
pub(crate) fn material_at(shell: &ShellMesh, middle: &MidSurface, point: Vec3) -> u16 {
    // Each triangle of the shell is so many of the middle, one after the other.
    let facets = middle.mesh().triangles.len() / shell.surface.triangles.len();
    shell.section.material(middle.distance().nearest_triangle(point) / facets)
}

/// The programs that are tried, in their order.
pub(crate) fn meshers(name: Option<MesherName>) -> Vec<Box<dyn TetMesher>> {
    let tetgen = || -> Box<dyn TetMesher> { Box::new(TetGen::default()) };
    let gmsh = |algorithm| -> Box<dyn TetMesher> { Box::new(Gmsh::new(algorithm)) };
    match name {
        None => vec![tetgen(), gmsh(Algorithm::Hxt), gmsh(Algorithm::Delaunay)],
        Some(MesherName::Tetgen) => vec![tetgen()],
        Some(MesherName::Gmsh) => vec![gmsh(Algorithm::Hxt), gmsh(Algorithm::Delaunay)],
    }
}

/// A wall in tetrahedra.
pub(crate) struct SolidPart {
    pub mesh: SolidMesh,
    pub report: SolidReport,
}

/// How a wall was meshed.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct SolidReport {
    /// The program that succeeded.
    pub mesher: String,
    /// Edge length on the faces, mm.
    pub edge: f64,
    /// Edges that follow the curved faces.
    pub curved: usize,
    pub quality: TetQuality,
    pub attempts: Vec<AttemptReport>,
}

/// One attempt.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct AttemptReport {
    pub mesher: String,
    pub edge: f64,
    /// Of the clock.
    pub seconds: f64,
    /// Why it was not taken.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failure: Option<String>,
}

impl From<Attempt> for AttemptReport {
    fn from(attempt: Attempt) -> Self {
        let Attempt { mesher, edge, seconds, failure } = attempt;
        Self { mesher, edge, seconds, failure: failure.map(|failure| failure.to_string()) }
    }
}

impl SolidPart {
    /// The wall around the middle of a `shell`, whose `model` is given; each cell is of the material of the nearest triangle.
    ///
    /// # Errors
    /// When a mesher cannot be run, or the edge is too fine. A wall that cannot be meshed is the inner [`Rejected`].
    pub(crate) fn new(
        shell: &ShellMesh,
        model: &PartModel,
        section: &SolidSection,
    ) -> anyhow::Result<Result<Self, Rejected>> {
        let [thinnest, thickest] = shell.section.thickness_range();
        let meshers = meshers(section.mesher);
        let meshers: Vec<&dyn TetMesher> = meshers.iter().map(|mesher| &**mesher).collect();
        let size = model.rest_size();
        let middle = middle(model, &shell.section)?;
        let finest = LEAST_SHARE * section.edge;
        let cubes = size.add_scalar(2.0 * thickest).product() / finest.powi(3);
        ensure!(
            cubes <= MOST_CUBES,
            "[solid] edge is {}, too fine for a part of {:.0} x {:.0} x {:.0} mm; {:.2} mm would do",
            section.edge,
            size.x,
            size.y,
            size.z,
            section.edge * (cubes / MOST_CUBES).cbrt() + 0.005
        );
        let surfaces =
            |edge: f64| wall_surfaces(&middle, &WallSettings { edge, ..WallSettings::default() });
        let settings = section.settings(0.5 * (thinnest + thickest));
        match filled_wall(&surfaces, &meshers, &settings) {
            Ok(Filled { mesh, quality, mesher, edge, attempts }) => {
                let attempts = attempts.into_iter().map(AttemptReport::from).collect();
                let mut mesh = SolidMesh::straight(&mesh);
                let curved = mesh.curve(&middle);
                if shell.section.last_material() > 0 {
                    let material = |x: Vec3| material_at(shell, &middle, x);
                    mesh.materials = mesh.centres().map(material).collect();
                }
                let report = SolidReport { mesher, edge, curved, quality, attempts };
                Ok(Ok(Self { mesh, report }))
            }
            Err(Unfilled::Rejected { rejected, .. }) => Ok(Err(rejected)),
            Err(Unfilled::Machine(what)) => Err(anyhow!(what)),
        }
    }

    /// The model of the wall among what `setup` lists, which shows the vertices of its `shell`.
    ///
    /// # Errors
    /// As [`PartModel::of_solid`].
    pub(crate) fn model(
        &self,
        shell: &ShellMesh,
        materials: &[Material],
        setup: &PartSetup,
    ) -> Result<PartModel, Rejected> {
        let held = SolidMesh::unknowns_of(&shell.ends.heights.held_nodes(&self.mesh));
        let shown = Some(shell.surface.positions.as_slice());
        let loads = SolidLoads { held, shown, ..SolidLoads::default() };
        // Folds are those of middles of walls.
        let setup = PartSetup { folds: None, ..setup.clone() };
        let [_, thickest] = shell.section.thickness_range();
        PartModel::of_solid(&self.mesh, thickest, materials, &loads, &setup)
    }
}

impl SolidReport {
    pub(crate) fn in_words(&self) -> String {
        let TetQuality { tetrahedra, dihedral_min, dihedral_1_percent, layers_mean, .. } =
            self.quality;
        format!(
            "{tetrahedra} tetrahedra by {} at edges of {:.2} mm, {layers_mean:.1} through the wall, dihedral angles from {dihedral_min:.1} deg (1 % below {dihedral_1_percent:.1})",
            self.mesher, self.edge
        )
    }
}
