//! From a genome or a network to its outcome: all rooms in a row.

use super::evaluate::evaluate;
use super::load_settings::LoadSettings;
use super::outcome::{NotEvaluated, Outcome, StageSeconds, Unevaluated};
use super::part::ShellPart;
use super::pattern::WallPattern;
use super::settings::FitnessSettings;
use super::walk::Scenarios;
use crate::field::{CappedField, CompiledNetwork, DesignBox};
use crate::genome::{Network, Representation};
use crate::math::{Rejected, cpu_seconds};
use crate::mesh::{MeshSettings, ShellMesh, ShellSettings, shell_of_field};
use crate::model::MaterialLimits;
use crate::model::material::Material;
use crate::solve::{Backend, SolveCounts, SolverFailure, Stop};

/// Everything that decides a candidate's outcome besides its network.
#[derive(Clone, Debug, PartialEq)]
pub struct CandidateSettings {
    /// Where the chamber may be, mm.
    pub design_box: DesignBox,
    /// How finely it is meshed.
    pub mesh: MeshSettings,
    /// Its wall.
    pub wall: ShellSettings,
    /// What the wall is made of.
    pub material: Material,
    /// What the [`Self::materials`] may bear, in their order; none of those that are left out.
    pub limits: Vec<MaterialLimits>,
    /// What its network may say of the wall.
    pub pattern: WallPattern,
    /// How it is loaded.
    pub load: LoadSettings,
    /// What is asked of it.
    pub fitness: FitnessSettings,
    /// Which library solves.
    pub backend: Backend,
}

impl CandidateSettings {
    /// The materials that a section names by their places: that of the wall, and the second of its pattern.
    #[must_use]
    pub fn materials(&self) -> Vec<Material> {
        [self.material.clone()].into_iter().chain(self.pattern.material.clone()).collect()
    }

    /// The defaults of everything but the material and the library.
    #[must_use]
    pub fn new(material: Material, backend: Backend) -> Self {
        Self {
            design_box: DesignBox::default(),
            mesh: MeshSettings::default(),
            wall: ShellSettings::default(),
            material,
            limits: Vec::new(),
            pattern: WallPattern::default(),
            load: LoadSettings::default(),
            fitness: FitnessSettings::default(),
            backend,
        }
    }
}

/// A candidate's outcome, its scenarios where there are any, and its cost.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// What became of it.
    pub outcome: Outcome,
    /// The shell, once there is one.
    pub mesh: Option<ShellMesh>,
    /// The walked scenarios, when it was evaluated.
    pub scenarios: Option<Scenarios>,
    /// CPU seconds.
    pub seconds: StageSeconds,
    /// What was asked of the solvers.
    pub counts: SolveCounts,
}

/// The shell that a network encloses.
///
/// # Errors
/// [`Rejected`] when it is no chamber or cannot be meshed.
///
/// # Panics
/// When the rim radius does not fit the design box: check the settings first with
/// [`CappedField::check_rim`].
pub fn shell_of_network(
    network: &Network,
    settings: &CandidateSettings,
) -> Result<ShellMesh, Rejected> {
    let compiled = CompiledNetwork::new(network);
    let field = CappedField::new(compiled, settings.design_box, settings.mesh.rim_radius)
        .expect("the settings were checked");
    let shell = shell_of_field(&field, &settings.mesh, &settings.wall)?;
    let section = settings.pattern.section(network, &shell);
    Ok(ShellMesh { section, ..shell })
}

/// Builds and evaluates what a `genome` stands for, until `stop` wants it to end.
///
/// # Errors
/// [`Unevaluated`] when a library fails, or it was stopped.
pub fn evaluate_genome<R: Representation<Phenotype = Network>>(
    representation: &R,
    genome: &R::Genome,
    settings: &CandidateSettings,
    stop: Stop<'_>,
) -> Result<Candidate, Unevaluated> {
    evaluate_network_until(&representation.express(genome), settings, stop)
}

/// Builds and evaluates one network.
///
/// # Errors
/// [`SolverFailure`] when a library fails.
pub fn evaluate_network(
    network: &Network,
    settings: &CandidateSettings,
) -> Result<Candidate, SolverFailure> {
    match evaluate_network_until(network, settings, Stop::NEVER) {
        Ok(candidate) => Ok(candidate),
        Err(Unevaluated::Failed(failure)) => Err(failure),
        Err(Unevaluated::Stopped) => unreachable!("nobody wants it to end"),
    }
}

/// As [`evaluate_network`], until `stop` wants it to end.
///
/// # Errors
/// [`Unevaluated`] when a library fails, or it was stopped.
pub fn evaluate_network_until(
    network: &Network,
    settings: &CandidateSettings,
    stop: Stop<'_>,
) -> Result<Candidate, Unevaluated> {
    if stop.is_wanted() {
        return Err(Unevaluated::Stopped);
    }
    let start = cpu_seconds();
    let shell = shell_of_network(network, settings);
    let mut seconds = StageSeconds { meshing: cpu_seconds() - start, ..Default::default() };
    let mut counts = SolveCounts::default();
    let rejected = |rejected, mesh, seconds, counts| Candidate {
        outcome: Outcome::Rejected(rejected),
        mesh,
        scenarios: None,
        seconds,
        counts,
    };
    let mesh = match shell {
        Ok(mesh) => mesh,
        Err(reason) => return Ok(rejected(reason, None, seconds, counts)),
    };
    let CandidateSettings { load, fitness, backend, .. } = settings;
    let materials = settings.materials();
    let part = ShellPart { shell: &mesh, materials: &materials, limits: &settings.limits };
    let evaluated = evaluate(&part, load, fitness, *backend, stop, &mut counts);
    let total = cpu_seconds() - start;
    match evaluated {
        Err(NotEvaluated::Unevaluated(why)) => Err(why),
        Err(NotEvaluated::Rejected(reason)) => {
            seconds.rest = total - seconds.meshing;
            Ok(rejected(reason, Some(mesh), seconds, counts))
        }
        Ok((evaluation, scenarios)) => {
            seconds.assembly = scenarios.times.assembly;
            seconds.factorization = scenarios.times.factorization;
            seconds.rest = total - seconds.meshing - seconds.assembly - seconds.factorization;
            Ok(Candidate {
                outcome: Outcome::Evaluated(evaluation),
                mesh: Some(mesh),
                scenarios: Some(scenarios),
                seconds,
                counts,
            })
        }
    }
}
