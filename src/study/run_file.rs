//! The run file of `evolve`, and the sections that it shares with scenes.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context, ensure};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::inherited::{Inherited, named_bounds};
use crate::evolve::Nsga2Settings;
use crate::field::DesignBox;
use crate::fitness::{CandidateSettings, FitnessSettings, LoadSettings, WallPattern};
use crate::io::toml_file;
use crate::mesh::{MeshSettings, ShellSettings};
use crate::model::MaterialLimits;
use crate::scene::checks::{check_distance, check_mesh, check_normal, check_shell, check_solver};
use crate::scene::keys::{annotated, sections};
use crate::scene::limits::{LimitsSection, OfMaterial, material_limits};
use crate::scene::material::{MaterialSection, positive, within};
use crate::scene::part::solid_part::SolidSection;
use crate::scene::pattern::PatternSection;
use crate::solve::Backend;

/// A run file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct RunFile {
    pub(crate) evolution: Nsga2Settings,
    pub(crate) fitness: FitnessSettings,
    #[serde(rename = "box")]
    pub(crate) design_box: DesignBox,
    pub(crate) mesh: MeshSettings,
    pub(crate) wall: ShellSettings,
    pub(crate) material: MaterialSection,
    /// What the material may bear: the path of a design that reaches it ends there.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) limits: Option<LimitsSection>,
    /// A wall that is not the same everywhere, by further genes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) pattern: Option<PatternSection>,
    pub(crate) load: LoadSettings,
    pub(crate) solver: SolverSection,
    /// The front again as solids, when the search is over.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) solid: Option<SolidSection>,
    /// Bounds of single genes, `name = [lower, upper]`.
    pub(crate) genes: BTreeMap<String, [f64; 2]>,
}

/// Which solver finds the equilibria.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct SolverSection {
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
            limits: None,
            pattern: None,
            load: LoadSettings::default(),
            // A search runs on threads, and PETSc would make them take turns.
            solver: SolverSection { backend: Backend::Native },
            solid: None,
            genes: BTreeMap::new(),
        }
    }
}

impl RunFile {
    /// Reads and checks the run file at `path`; `solver` is taken instead of its own.
    ///
    /// # Errors
    /// One line that names the file when it cannot be read, or says what no search can.
    pub fn read(path: &Path, solver: Option<Backend>) -> anyhow::Result<Self> {
        toml_file::read::<Self>(path)?.accepted(path, solver)
    }

    /// Reads the `text` of a run file as if it stood at `path`.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn parse(text: &str, path: &Path, solver: Option<Backend>) -> anyhow::Result<Self> {
        toml_file::parse::<Self>(text, path)?.accepted(path, solver)
    }

    fn accepted(mut self, path: &Path, solver: Option<Backend>) -> anyhow::Result<Self> {
        self.solver.backend = solver.unwrap_or(self.solver.backend);
        self.checked().with_context(|| path.display().to_string())?;
        Ok(self)
    }

    /// Itself, when every value is one that the program can work with.
    pub(crate) fn checked(&self) -> anyhow::Result<&Self> {
        check_solver(self.solver.backend)?;
        self.check_pressure()?;
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
            self.pattern()?.material.map_or(Ok(()), |second| section.check_material(&second))?;
        }
        self.evolution.validate().context("[evolution]")?;
        self.representation()?;
        self.material.material()?;
        self.limits()?;
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

    fn check_pressure(&self) -> anyhow::Result<()> {
        let Some(rated) = self.load.rated else {
            positive("[load] pressure", self.load.pressure)?;
            return Ok(());
        };
        positive("[load] largest_pressure", self.load.pressure)?;
        positive("[load] reference_pressure", rated.reference)?;
        ensure!(
            self.limits.is_some(),
            "[load] pressure = \"rated\" is the pressure at which the material is at its limit; say what that is in [limits], as stretch = 1.5"
        );
        Ok(())
    }

    fn check_further_objectives(&self) -> anyhow::Result<()> {
        let further = &self.fitness.further_objectives;
        let repeated = (1..further.len()).find(|&k| further[..k].contains(&further[k]));
        ensure!(
            repeated.is_none(),
            "[fitness] further_objectives names one twice; name each once: {:?}",
            further.iter().map(|objective| objective.name).collect::<Vec<_>>()
        );
        Ok(())
    }

    /// What each material of its designs may bear; none where nothing is said of any.
    fn limits(&self) -> anyhow::Result<Vec<MaterialLimits>> {
        let first = OfMaterial::first(&self.material, self.limits.as_ref());
        let second = self.pattern.iter().map(PatternSection::limited);
        material_limits(first, second, self.load.stretch_bound)
    }

    /// What the networks of its designs may say of their walls.
    pub(crate) fn pattern(&self) -> anyhow::Result<WallPattern> {
        self.pattern.as_ref().map_or_else(|| Ok(WallPattern::default()), PatternSection::pattern)
    }

    /// What the designs inherit.
    pub(crate) fn representation(&self) -> anyhow::Result<Inherited> {
        let Some(pattern) = &self.pattern else {
            return Inherited::new(&self.genes).context("[genes]");
        };
        let mut genes = self.genes.clone();
        if let Some(bounds) = pattern.thickness {
            // Where a network's thickness begins; what x, pleats and lobes make of it is bounded too.
            genes.entry("tO".to_owned()).or_insert(bounds);
        }
        Inherited::with_wall(pattern.genes(), &genes).context("[genes]")
    }

    /// What decides a candidate's outcome.
    ///
    /// # Errors
    /// When `[material]` names no law, which [`Self::read`] has refused already.
    pub fn candidate_settings(&self) -> anyhow::Result<CandidateSettings> {
        Ok(CandidateSettings {
            design_box: self.design_box,
            mesh: self.mesh,
            wall: self.wall,
            material: self.material.material()?,
            limits: self.limits()?,
            pattern: self.pattern()?,
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
pub(crate) fn defaults(solid: Option<SolidSection>) -> String {
    let genes = named_bounds(&Inherited::default()).collect();
    let run = RunFile { genes, solid, ..RunFile::default() };
    let defaults = toml::to_string(&run).expect("the defaults are plain numbers and words");
    let example = if solid.is_some() { "" } else { SOLID_EXAMPLE };
    annotated(&defaults, &sections::<RunFile>()) + example
}

/// A population of this size takes some hundred megabytes, and a year.
const MOST_INDIVIDUALS: usize = 100_000;
