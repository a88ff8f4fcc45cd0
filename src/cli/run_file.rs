//! The run file of `evolve`, and the sections that it shares with scenes.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context, ensure};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::keys::{annotated, sections};
use super::material::{MaterialSection, positive, within};
use super::solid_part::SolidSection;
use crate::evolve::{self, Nsga2Settings};
use crate::field::{CappedField, CompiledNetwork, DesignBox};
use crate::fitness::{CandidateSettings, FitnessSettings, LoadSettings};
use crate::genome::{Bounds, GENES, Genome};
use crate::io::toml_file;
use crate::mesh::{MeshSettings, ShellSettings};
use crate::solve::Backend;

/// A run file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
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
    /// The front again as solids, when the search is over.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub solid: Option<SolidSection>,
    /// Bounds of single genes, `name = [lower, upper]`.
    pub genes: BTreeMap<String, [f64; 2]>,
}

/// Which solver finds the equilibria.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct SolverSection {
    /// Which library finds the equilibria.
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
            solid: None,
            genes: BTreeMap::new(),
        }
    }
}

impl RunFile {
    /// Reads and checks a run file.
    pub(super) fn read(path: &Path, solver: Option<Backend>) -> anyhow::Result<Self> {
        let mut run: Self = toml_file::read(path)?;
        run.solver.backend = solver.unwrap_or(run.solver.backend);
        run.checked().with_context(|| path.display().to_string())?;
        Ok(run)
    }

    /// Itself, when every value is one that the program can work with.
    pub(super) fn checked(&self) -> anyhow::Result<&Self> {
        check_solver(self.solver.backend)?;
        positive("[load] pressure", self.load.pressure)?;
        check_shell(&self.wall, &self.load)?;
        check_mesh(self.design_box, &self.mesh)?;
        ensure!(
            self.evolution.population <= MOST_INDIVIDUALS,
            "[evolution] population is {}, but at most {MOST_INDIVIDUALS} fit in memory",
            self.evolution.population
        );
        if let Some(section) = &self.solid {
            section.check()?;
            section.check_material(&self.material.material()?)?;
        }
        self.evolution.validate().context("[evolution]")?;
        self.gene_bounds()?;
        self.material.material()?;
        within("[fitness] exponent", self.fitness.exponent, 0.1, 100.0)?;
        check_distance("[fitness] plane_distance", self.fitness.plane_distance)?;
        check_normal("[fitness] plane_normal", self.fitness.plane_normal)?;
        self.check_further_objectives()?;
        let height = self.design_box.sides().z;
        let clamped = self.wall.clamp_height * self.wall.thickness;
        ensure!(
            clamped < (1.0 - self.wall.tip_fraction) * height,
            "[wall] clamp_height holds {clamped:.2} mm of a box of {height} mm, tip included; it must be smaller"
        );
        Ok(self)
    }

    fn check_further_objectives(&self) -> anyhow::Result<()> {
        let further = &self.fitness.further_objectives;
        let repeated = (1..further.len()).find(|&k| further[..k].contains(&further[k]));
        ensure!(
            repeated.is_none(),
            "[fitness] further_objectives names one twice; name each once: {:?}",
            further.iter().map(|objective| objective.name).collect::<Vec<_>>()
        );
        ensure!(
            further.is_empty() || self.solid.is_none(),
            "[solid] sorts its front by bending and blocking alone; leave out [fitness] further_objectives, or walk single designs with certify"
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
            fitness: self.fitness.clone(),
            backend: self.solver.backend,
        })
    }
}

/// A section has no default to print where it is left out.
const SOLID_EXAMPLE: &str = "
# The front again as solids, when the search is over, and what that may promote.
# [solid]
# edge = 2.0  # mm, on the wall's faces
# layers = 1  # through the wall; as many as make tetrahedra as high as wide where it is left out
# mesher = \"tetgen\"  # or gmsh; the one and then the other where it is left out
# coarser = 1.5  # and with edges so many times longer, by which the first is judged
# [solid.fidelity]
# trust = 0.1  # the largest deviation at which the shell is trusted
# check = 0.25
";

/// A run file with every default, as TOML, and with the section of a `solid` where there is one.
pub(super) fn defaults(solid: Option<SolidSection>) -> String {
    let bounds = GENES.iter().map(|gene| (gene.name.to_owned(), [gene.lower, gene.upper]));
    let run = RunFile { genes: bounds.collect(), solid, ..RunFile::default() };
    let defaults = toml::to_string(&run).expect("the defaults are plain numbers and words");
    let example = if solid.is_some() { "" } else { SOLID_EXAMPLE };
    annotated(&defaults, &sections::<RunFile>()) + example
}

pub(super) fn check_solver(backend: Backend) -> anyhow::Result<()> {
    ensure!(
        backend.is_built_in(),
        "this program was built without PETSc; use --solver native, or build it with the feature `petsc`"
    );
    Ok(())
}

/// A population of this size takes some hundred megabytes, and a year.
const MOST_INDIVIDUALS: usize = 100_000;

pub(super) fn check_shell(wall: &ShellSettings, load: &LoadSettings) -> anyhow::Result<()> {
    positive("[wall] thickness", wall.thickness)?;
    positive("[wall] clamp_height", wall.clamp_height)?;
    within("[wall] tip_fraction", wall.tip_fraction, 1e-3, 0.9)?;
    let steps = load.path.steps;
    ensure!(
        (1..=MOST_STEPS).contains(&steps),
        "[load.path] steps is {steps}, but it must lie between 1 and {MOST_STEPS}"
    );
    within("[load] stretch_bound", load.stretch_bound, 1.01, 1e3)?;
    within("[load.path] largest_step", load.path.largest_step, 1e-3, 1e3)?;
    ensure!(
        load.path.iteration_budget > 0,
        "[load.path] iteration_budget is 0, but a step takes iterations"
    );
    ensure!(
        load.path.halvings <= 30,
        "[load.path] halvings is {}, more than 30",
        load.path.halvings
    );
    within("[load.path] work_tolerance", load.path.work_tolerance, 1e-9, 1.0)?;
    let newton = &load.path.newton;
    within("[load.path.newton] tolerance", newton.tolerance, 1e-13, 1e-3)?;
    within("[load.path.newton] chord_contraction", newton.chord_contraction, 0.0, 0.9)?;
    ensure!(
        newton.max_iterations > 0,
        "[load.path.newton] max_iterations is 0, but at least 1 is needed"
    );
    Ok(())
}

/// Every step is kept in memory with all its unknowns.
const MOST_STEPS: usize = 1000;

/// Checks that the box can be meshed with these settings, in a memory of about a gigabyte.
pub(super) fn check_mesh(design_box: DesignBox, mesh: &MeshSettings) -> anyhow::Result<()> {
    positive("[mesh] edge", mesh.edge)?;
    let sides = design_box.sides();
    ensure!(
        mesh.edge < 0.5 * sides.min(),
        "[mesh] edge is {:?} mm, but a box {:?} mm wide needs one below half of that",
        mesh.edge,
        sides.min()
    );
    let cubes = sides.iter().map(|side| side / mesh.edge).product::<f64>();
    ensure!(
        cubes <= MOST_CUBES,
        "[mesh] edge is {:?} mm, too fine for a box of {:?} x {:?} x {:?} mm; {:.2} mm is the finest",
        mesh.edge,
        sides.x,
        sides.y,
        sides.z,
        mesh.edge * (cubes / MOST_CUBES).cbrt() + 0.005
    );
    check_rim(design_box, mesh)
}

/// Cubes of one edge in the box: 3.4 points of the isosurface's grid each, of some 72 bytes.
const MOST_CUBES: f64 = 4e6;

fn check_rim(design_box: DesignBox, mesh: &MeshSettings) -> anyhow::Result<()> {
    let middle = GENES.map(|gene| 0.5 * (gene.lower + gene.upper)).to_vec();
    let genome = Genome::try_from(middle).expect("one number for each gene");
    CappedField::new(CompiledNetwork::new(&genome.decode()), design_box, mesh.rim_radius)
        .context("[mesh]")?;
    Ok(())
}

/// Checks the distance of a plane, mm: the barrier begins half way to it, or a tenth of the wall's thickness before it.
pub(super) fn check_distance(what: &str, distance: f64) -> anyhow::Result<()> {
    positive(what, distance)?;
    within(what, distance, LEAST_DISTANCE, 1e12)?;
    Ok(())
}

/// Below, the rounding of positions is a share of the gap.
const LEAST_DISTANCE: f64 = 1e-6;

pub(super) fn check_normal(what: &str, normal: [f64; 3]) -> anyhow::Result<()> {
    let length = normal.iter().map(|n| n * n).sum::<f64>().sqrt();
    ensure!(length > 1e-12 && length.is_finite(), "{what} must be a direction, not {normal:?}");
    Ok(())
}
