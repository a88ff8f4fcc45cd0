//! The run file of `evolve`, and the sections that it shares with scenes.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context, ensure};
use serde::{Deserialize, Serialize};

use super::material::{MaterialSection, positive};
use crate::evolve::{self, Nsga2Settings};
use crate::field::{CappedField, CompiledNetwork, DesignBox};
use crate::fitness::{CandidateSettings, FitnessSettings, LoadSettings};
use crate::genome::{Bounds, GENES, Genome};
use crate::io::toml_file;
use crate::mesh::{MeshSettings, ShellSettings};
use crate::solve::Backend;

/// A run file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct RunFile {
    pub evolution: Nsga2Settings,
    pub fitness: FitnessSettings,
    #[serde(rename = "box")]
    pub design_box: DesignBox,
    pub mesh: MeshSettings,
    pub wall: ShellSettings,
    pub material: MaterialSection,
    pub load: LoadSettings,
    pub solver: SolverSection,
    /// Bounds of single genes, `name = [lower, upper]`.
    pub genes: BTreeMap<String, [f64; 2]>,
}

/// Which solver finds the equilibria.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SolverSection {
    /// `native` or `petsc`.
    pub backend: Backend,
}

impl Default for RunFile {
    fn default() -> Self {
        Self {
            evolution: Nsga2Settings::default(),
            fitness: FitnessSettings::default(),
            design_box: DesignBox::default(),
            mesh: MeshSettings::default(),
            wall: ShellSettings::default(),
            material: MaterialSection::default(),
            load: LoadSettings::default(),
            // A search runs on threads, and PETSc would make them take turns.
            solver: SolverSection { backend: Backend::Native },
            genes: BTreeMap::new(),
        }
    }
}

impl RunFile {
    /// Reads and checks a run file.
    pub(super) fn read(path: &Path, solver: Option<Backend>) -> anyhow::Result<Self> {
        let mut run: Self = toml_file::read(path)?;
        run.solver.backend = solver.unwrap_or(run.solver.backend);
        run.check().with_context(|| path.display().to_string())?;
        Ok(run)
    }

    fn check(&self) -> anyhow::Result<()> {
        check_solver(self.solver.backend)?;
        check_shell(&self.mesh, &self.wall, &self.load)?;
        check_rim(self.design_box, &self.mesh)?;
        self.evolution.validate().context("[evolution]")?;
        self.gene_bounds()?;
        self.material.material()?;
        positive("[fitness] exponent", self.fitness.exponent)?;
        positive("[fitness] plane_distance", self.fitness.plane_distance)?;
        check_normal("[fitness] plane_normal", self.fitness.plane_normal)?;
        let height = self.design_box.sides().z;
        ensure!(
            self.wall.clamp_height * self.wall.thickness < height,
            "the clamp of {} thicknesses of {} mm holds the whole box of {height} mm",
            self.wall.clamp_height,
            self.wall.thickness
        );
        Ok(())
    }

    /// The bounds of all genes as evolution sees them.
    pub(super) fn gene_bounds(&self) -> anyhow::Result<evolve::Bounds> {
        let bounds = Bounds::with_overrides(&self.genes).context("[genes]")?;
        let pairs = bounds.intervals().iter().map(|&[lower, upper]| (lower, upper)).collect();
        evolve::Bounds::new(pairs).context("[genes]")
    }

    /// What decides a candidate's outcome.
    pub(super) fn candidate_settings(&self) -> anyhow::Result<CandidateSettings> {
        Ok(CandidateSettings {
            design_box: self.design_box,
            mesh: self.mesh,
            wall: self.wall,
            material: self.material.material()?,
            load: self.load,
            fitness: self.fitness,
            backend: self.solver.backend,
        })
    }
}

/// A run file with every default, as TOML.
pub(super) fn defaults() -> String {
    let genes = GENES.iter().map(|gene| (gene.name.to_owned(), [gene.lower, gene.upper])).collect();
    let run = RunFile { genes, ..RunFile::default() };
    toml::to_string(&run).expect("the defaults are plain numbers and words")
}

pub(super) fn check_solver(backend: Backend) -> anyhow::Result<()> {
    ensure!(
        backend.is_built_in(),
        "this program was built without PETSc; use --solver native, or build it with the feature `petsc`"
    );
    Ok(())
}

pub(super) fn check_shell(
    mesh: &MeshSettings,
    wall: &ShellSettings,
    load: &LoadSettings,
) -> anyhow::Result<()> {
    positive("[mesh] edge", mesh.edge)?;
    positive("[wall] thickness", wall.thickness)?;
    positive("[wall] clamp_height", wall.clamp_height)?;
    ensure!(
        wall.tip_fraction > 0.0 && wall.tip_fraction < 1.0,
        "[wall] tip_fraction is {}, but it must lie between 0 and 1",
        wall.tip_fraction
    );
    positive("[load] pressure", load.pressure)?;
    ensure!(load.path.steps > 0, "[load.path] steps is 0, but at least 1 step is needed");
    ensure!(
        load.path.halvings <= 30,
        "[load.path] halvings is {}, more than 30",
        load.path.halvings
    );
    positive("[load.path.newton] tolerance", load.path.newton.tolerance)?;
    ensure!(load.path.newton.max_iterations > 0, "[load.path.newton] max_iterations is 0");
    Ok(())
}

pub(super) fn check_rim(design_box: DesignBox, mesh: &MeshSettings) -> anyhow::Result<()> {
    let middle = GENES.map(|gene| 0.5 * (gene.lower + gene.upper)).to_vec();
    let genome = Genome::try_from(middle).expect("one number for each gene");
    CappedField::new(CompiledNetwork::new(&genome.decode()), design_box, mesh.rim_radius)
        .context("[mesh]")?;
    Ok(())
}

pub(super) fn check_normal(what: &str, normal: [f64; 3]) -> anyhow::Result<()> {
    let length = normal.iter().map(|n| n * n).sum::<f64>().sqrt();
    ensure!(length > 1e-12 && length.is_finite(), "{what} must be a direction, not {normal:?}");
    Ok(())
}
