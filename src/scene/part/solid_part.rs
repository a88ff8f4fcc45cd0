//! `[solid]`: the wall of a closed part in tetrahedra, made without a human.

use anyhow::{Context, anyhow, ensure};
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
use crate::mesh::{ShellMesh, SolidMesh, WallSettings, wall_surfaces};
use crate::model::material::Material;
use crate::model::{PartModel, PartSetup, SolidLoads};
use crate::scene::checks::check_distance;
use crate::scene::material::within;
use crate::surface::{SignedDistance, TriangleMesh};

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

/// Facets of the middle, in thicknesses: their corners show in neither face.
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

/// The middle of the wall of a `shell` of `thickness` (mm), as its solid has it.
pub(crate) fn middle(shell: &PartModel, thickness: f64) -> TriangleMesh {
    shell.rest_surface((FACET * thickness).max(LEAST_FACET * shell.rest_size().amax()))
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
    /// When a mesher cannot be run, or the wall is not of one thickness. A wall that cannot be meshed is the inner [`Rejected`].
    pub(crate) fn new(
        shell: &ShellMesh,
        model: &PartModel,
        section: &SolidSection,
    ) -> anyhow::Result<Result<Self, Rejected>> {
        let thickness = shell.section.uniform_thickness().context(ONE_THICKNESS)?;
        let (tetgen, hxt, delaunay) =
            (TetGen::default(), Gmsh::new(Algorithm::Hxt), Gmsh::new(Algorithm::Delaunay));
        let meshers: &[&dyn TetMesher] = match section.mesher {
            None => &[&tetgen, &hxt, &delaunay],
            Some(MesherName::Tetgen) => &[&tetgen],
            Some(MesherName::Gmsh) => &[&hxt, &delaunay],
        };
        let size = model.rest_size();
        let middle = middle(model, thickness);
        let finest = LEAST_SHARE * section.edge;
        let cubes = size.add_scalar(2.0 * thickness).product() / finest.powi(3);
        ensure!(
            cubes <= MOST_CUBES,
            "[solid] edge is {}, too fine for a part of {:.0} x {:.0} x {:.0} mm; {:.2} mm would do",
            section.edge,
            size.x,
            size.y,
            size.z,
            section.edge * (cubes / MOST_CUBES).cbrt() + 0.005
        );
        let surfaces = |edge: f64| {
            wall_surfaces(&middle, thickness, &WallSettings { edge, ..WallSettings::default() })
        };
        match filled_wall(&surfaces, meshers, &section.settings(thickness)) {
            Ok(Filled { mesh, quality, mesher, edge, attempts }) => {
                let attempts = attempts.into_iter().map(AttemptReport::from).collect();
                let mut mesh = SolidMesh::straight(&mesh);
                let distance = SignedDistance::new(&middle)?;
                let curved = mesh.curve(&distance, thickness);
                if shell.section.last_material() > 0 {
                    // Each triangle of the shell is so many of the middle, one after the other.
                    let facets = middle.triangles.len() / shell.surface.triangles.len();
                    let material =
                        |x: Vec3| shell.section.material(distance.nearest_triangle(x) / facets);
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

/// What is said of a solid around a wall that is not everywhere as thick.
pub(crate) const ONE_THICKNESS: &str = "a [solid] wants a wall of one thickness; leave out that of each [[region]] and of the [pattern]";

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
