//! The front as tables and figures show it, from what was recorded of its designs.

use std::collections::BTreeMap;

use anyhow::bail;

use super::inherited::Individual;
use super::run_folder::Record;
use crate::evolve::IndividualId;
use crate::fitness::{
    Evaluation, FitnessSettings, OBJECTIVES, Objective, Outcome, Rated, Readings, SCENARIOS,
    Scenario, flags,
};
use crate::io::csv::Cells;
use crate::report::{Column, FrontPoint, RatedColumns, Reached, axis_label};

/// The `front` with what was recorded of its members.
///
/// # Errors
/// When the `records` lack a member, or its objectives.
pub(super) fn front_points(
    front: &[&Individual],
    records: &[Record],
) -> anyhow::Result<Vec<FrontPoint>> {
    let by_id: BTreeMap<IndividualId, &Record> =
        records.iter().map(|record| (record.id, record)).collect();
    let point = |individual: &&Individual| {
        let record = by_id.get(&individual.id);
        let Some(Outcome::Evaluated(evaluation)) = record.map(|record| &record.outcome) else {
            bail!("candidates.jsonl lacks {}, a member of the front", individual.id);
        };
        Ok(FrontPoint {
            id: individual.id.to_string(),
            objectives: evaluation.known().map(column).collect(),
            figure_of_merit: evaluation.figure_of_merit,
            max_force: evaluation.max_force,
            flags: flags(&evaluation.exploits),
            reached: Some(reached(evaluation)),
            rated: evaluation.rated.as_ref().map(|rated| {
                let asked: Vec<&Objective> = evaluation.known().map(|(one, _)| one).collect();
                rated_columns(rated, &asked)
            }),
            mesh_errors: Vec::new(),
        })
    };
    front.iter().map(point).collect()
}

/// What a design reached.
pub(super) fn reached(evaluation: &Evaluation) -> Reached {
    let pressures = SCENARIOS.iter().filter_map(|scenario| {
        let ended = evaluation.ending(scenario)?;
        Some((pressure_column(scenario), ended.pressure))
    });
    Reached { angle_deg: evaluation.angle_deg, pressures: pressures.collect() }
}

/// The rated pressure of a design, and what it is at the reference pressure; the columns are the same whether it comes to that or not.
fn rated_columns(rated: &Rated, asked: &[&Objective]) -> RatedColumns {
    let told = rated.at_reference.as_ref();
    let reading = |name: &str, of: fn(&Readings) -> f64| {
        (name.to_owned(), told.map(|told| of(&told.readings)))
    };
    let objective = |one: &&Objective| {
        let value = told.and_then(|told| told.readings.objectives.get(one.name).copied());
        (one.name.to_owned(), value)
    };
    let mut columns = vec![("pressure".to_owned(), told.map(|told| told.pressure))];
    columns.extend(asked.iter().map(objective));
    columns.push(reading("figure_of_merit", |readings| readings.figure_of_merit));
    columns.push(reading("max_force", |readings| readings.max_force));
    columns.push(reading("angle_deg", |readings| readings.angle_deg));
    let named = |(name, value): (String, _)| (format!("reference_{name}"), value);
    let at_reference = columns.into_iter().map(named).collect();
    RatedColumns { pressure: rated.pressure, at_reference }
}

/// The column of the pressure that was reached in a `scenario`.
pub(super) fn pressure_column(scenario: &Scenario) -> String {
    format!("{}_pressure", scenario.action)
}

/// An objective with its value, as tables and figures show it.
pub(crate) fn column((objective, value): (&'static Objective, f64)) -> Column {
    let &Objective { name, symbol, unit, .. } = objective;
    Column { name, symbol, unit, value }
}

/// `front.csv` of a run, whose designs may each have a rated pressure, that found nothing feasible: a table without rows, not an empty file.
pub(super) fn header(asked: &FitnessSettings, is_rated: bool) -> String {
    let objectives = OBJECTIVES.iter().filter(|one| asked.objectives().any(|asked| asked == *one));
    let pressures =
        asked.scenarios().iter().map(|scenario| (pressure_column(scenario), 0.0)).collect();
    let point = FrontPoint {
        id: String::new(),
        objectives: objectives.map(|objective| column((objective, 0.0))).collect(),
        figure_of_merit: 0.0,
        max_force: 0.0,
        flags: String::new(),
        reached: Some(Reached { angle_deg: 0.0, pressures }),
        rated: is_rated.then(|| {
            let asked: Vec<&Objective> = asked.objectives().collect();
            rated_columns(&Rated { pressure: 0.0, at_reference: None }, &asked)
        }),
        mesh_errors: Vec::new(),
    };
    let names: Vec<String> = point.cells().into_iter().map(|(name, _)| name).collect();
    names.join(",") + "\n"
}

/// What stands at the axes of fronts: the first two objectives.
pub(crate) fn axes() -> [String; 2] {
    [0, 1].map(|k| axis_label(OBJECTIVES[k].name, OBJECTIVES[k].symbol, OBJECTIVES[k].unit))
}

/// The objectives at the [`axes`] of every design that was evaluated.
pub(super) fn evaluated_objectives(records: &[Record]) -> Vec<[f64; 2]> {
    let objectives = |record: &Record| match &record.outcome {
        Outcome::Evaluated(evaluation) => {
            Some([evaluation.value(&OBJECTIVES[0])?, evaluation.value(&OBJECTIVES[1])?])
        }
        Outcome::Rejected(_) => None,
    };
    records.iter().filter_map(objectives).collect()
}
