//! The scene file of `simulate`: one part, its wall, its load, and the planes it may touch.

use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use serde::{Deserialize, Serialize};

use super::material::MaterialSection;
use super::run_file::{
    SolverSection, check_distance, check_mesh, check_normal, check_shell, check_solver,
};
use crate::field::DesignBox;
use crate::fitness::LoadSettings;
use crate::io::toml_file;
use crate::mesh::{MeshSettings, ShellSettings};
use crate::solve::Backend;

/// A scene file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SceneFile {
    pub part: Part,
    /// For a network: where the chamber may be, mm.
    #[serde(rename = "box", default)]
    pub design_box: DesignBox,
    /// For a network: how finely it is meshed.
    #[serde(default)]
    pub mesh: MeshSettings,
    #[serde(default)]
    pub wall: ShellSettings,
    #[serde(default)]
    pub material: MaterialSection,
    #[serde(default)]
    pub load: LoadSettings,
    #[serde(default = "default_solver")]
    pub solver: SolverSection,
    /// Rigid planes; none is listed, none is computed.
    #[serde(default, rename = "plane", skip_serializing_if = "Vec::is_empty")]
    pub planes: Vec<Plane>,
}

/// Where the mid-surface comes from; exactly one of the two, relative to the scene file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Part {
    /// A network file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub network: Option<PathBuf>,
    /// An STL file of a closed mid-surface, mm, z along the part.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stl: Option<PathBuf>,
}

/// A rigid plane.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Plane {
    /// Direction towards the part.
    pub normal: [f64; 3],
    /// Distance from the outermost point of the outer wall at rest, mm.
    pub distance: f64,
}

/// PETSc where it is built in: a single scene has the process to itself.
fn default_solver() -> SolverSection {
    let backend = if Backend::Petsc.is_built_in() { Backend::Petsc } else { Backend::Native };
    SolverSection { backend }
}

/// What a scene's part is made from.
pub(super) enum PartSource {
    Network(PathBuf),
    Stl(PathBuf),
}

impl SceneFile {
    /// Reads and checks a scene file.
    pub(super) fn read(path: &Path, solver: Option<Backend>) -> anyhow::Result<Self> {
        let mut scene: Self = toml_file::read(path)?;
        scene.solver.backend = solver.unwrap_or(scene.solver.backend);
        scene.check().with_context(|| path.display().to_string())?;
        Ok(scene)
    }

    fn check(&self) -> anyhow::Result<()> {
        check_solver(self.solver.backend)?;
        check_shell(&self.wall, &self.load)?;
        check_mesh(self.design_box, &self.mesh)?;
        self.material.material()?;
        for plane in &self.planes {
            check_normal("[[plane]] normal", plane.normal)?;
            check_distance("[[plane]] distance", plane.distance, &self.wall)?;
        }
        Ok(())
    }

    /// The part's file, found beside the scene file at `path`.
    pub(super) fn source(&self, path: &Path) -> anyhow::Result<PartSource> {
        let beside = |file: &PathBuf| path.parent().unwrap_or(Path::new("")).join(file);
        match (&self.part.network, &self.part.stl) {
            (Some(network), None) => Ok(PartSource::Network(beside(network))),
            (None, Some(stl)) => Ok(PartSource::Stl(beside(stl))),
            (Some(_), Some(_)) => {
                bail!("{}: [part] has both `network` and `stl`; give one", path.display())
            }
            (None, None) => {
                bail!("{}: [part] has neither `network` nor `stl`; give one", path.display())
            }
        }
    }
}

/// A list has no default to print.
const PLANE_EXAMPLE: &str = "
# A rigid plane on the -x side; as many as needed.
# [[plane]]
# normal = [1.0, 0.0, 0.0]
# distance = 5.0
";

/// A scene file with every default, as TOML.
pub(super) fn defaults() -> String {
    let scene = SceneFile {
        part: Part { network: Some("network.toml".into()), stl: None },
        design_box: DesignBox::default(),
        mesh: MeshSettings::default(),
        wall: ShellSettings::default(),
        material: MaterialSection::default(),
        load: LoadSettings::default(),
        solver: default_solver(),
        planes: Vec::new(),
    };
    let defaults = toml::to_string(&scene).expect("the defaults are plain numbers and words");
    defaults + PLANE_EXAMPLE
}
