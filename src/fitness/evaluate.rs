//! The objectives of a part, a shell or a solid, by its scenarios.

use super::evaluation::{AtReference, Evaluation, Rated, Readings, ScenarioEnding};
use super::exploit::{Exploit, exploits, flags};
use super::load_settings::LoadSettings;
use super::merit::figure_of_merit;
use super::objective::{Asked, OBJECTIVES, Objective, Reading};
use super::observation::Stability;
use super::outcome::NotEvaluated;
use super::part::Part;
use super::scenario::{blocked, free};
use super::settings::FitnessSettings;
use super::walk::{RatedPressure, Scenarios, Walked, walk_scenarios};
use crate::math::{Reason, Rejected, Room};
use crate::solve::{Backend, SolveCounts, Stop};

/// Walks `part` through the scenarios that `fitness` asks for, and reads the objectives off; until `stop` wants that to end. Adds to
/// `counts` what that asked of the solvers, however it ended.
///
/// # Errors
/// [`NotEvaluated`] when the design fails, a library fails, or it was stopped.
pub fn evaluate(
    part: &dyn Part,
    load: &LoadSettings,
    fitness: &FitnessSettings,
    backend: Backend,
    stop: Stop<'_>,
    counts: &mut SolveCounts,
) -> Result<(Evaluation, Scenarios), NotEvaluated> {
    let scenarios = walk_scenarios(part, load, fitness, backend, stop, counts)?;
    let at = scenarios.rated.map(|rated| rated.pressure);
    let reading = Reading { part, settings: fitness, walked: &scenarios.walked, at };
    let exploits = exploits(fitness.objectives(), &reading, scenarios.model().creased_share());
    if fitness.exclude_exploits && !exploits.is_empty() {
        return Err(excluded(&exploits).into());
    }
    let Readings { objectives, figure_of_merit, max_force, angle_deg } = readings(&reading);
    let ending = |walked: &Walked| {
        let ending =
            ScenarioEnding { ending: walked.path.ending, pressure: walked.last_pressure() };
        (walked.scenario.action.to_owned(), ending)
    };
    let own_rows = || scenarios.walked.iter().flat_map(Walked::own_rows);
    let evaluation = Evaluation {
        objectives,
        figure_of_merit,
        max_force,
        angle_deg,
        creased_share: scenarios.model().creased_share(),
        unknowns: scenarios.model().unknowns(),
        newton_iterations: counts.newton_iterations,
        snaps: own_rows().filter(|row| row.stability == Stability::Snapped).count(),
        endings: scenarios.walked.iter().map(ending).collect(),
        exploits,
        rated: scenarios.rated.map(|RatedPressure { pressure, reference }| Rated {
            pressure,
            at_reference: reference.map(|pressure| {
                let at = Some(pressure);
                AtReference { pressure, readings: readings(&Reading { at, ..reading }) }
            }),
        }),
    };
    match not_finite(&evaluation) {
        Some(rejected) => Err(rejected.into()),
        None => Ok((evaluation, scenarios)),
    }
}

/// What is read off the paths of a part.
fn readings(reading: &Reading<'_>) -> Readings {
    let (free, blocked) = (reading.rows(&free::SCENARIO), reading.rows(&blocked::SCENARIO));
    let value = |objective: &Objective| (objective.name.to_owned(), objective.value(reading));
    Readings {
        objectives: reading.settings.objectives().map(value).collect(),
        figure_of_merit: figure_of_merit(free, reading.part.shell().ends.heights.length),
        max_force: blocked.iter().map(|row| row.plane_force).fold(0.0, f64::max),
        angle_deg: free.last().map_or(0.0, |row| row.angle_deg),
    }
}

/// A number that is none says nothing about its design, and no file of a run can hold it.
fn not_finite(evaluation: &Evaluation) -> Option<Rejected> {
    let Evaluation { figure_of_merit, max_force, angle_deg, .. } = *evaluation;
    let asked = |asked: Asked| {
        let objectives = OBJECTIVES.iter().filter(move |objective| objective.asked == asked);
        objectives.filter_map(|objective| evaluation.value(objective))
    };
    let figures = [figure_of_merit, max_force, angle_deg];
    let numbers: Vec<f64> =
        asked(Asked::Always).chain(figures).chain(asked(Asked::ByName)).collect();
    (!numbers.iter().all(|number| number.is_finite())).then(|| {
        let detail = format!("among what was read off the paths is no number: {numbers:?}");
        Rejected::new(Room::Fitness, Reason::NotFinite, detail, 1.0)
    })
}

/// Why a design is rejected whose objectives are doubted: it came to the end, and is as far from acceptable as flags are many.
fn excluded(exploits: &[Exploit]) -> Rejected {
    Rejected::new(Room::Fitness, Reason::Exploit, flags(exploits), 0.1 * exploits.len() as f64)
}
