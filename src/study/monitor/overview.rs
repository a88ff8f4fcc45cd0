//! The run as a whole, as the page shows it.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use serde::Serialize;

use crate::evolve::IndividualId;
use crate::fitness::{Outcome, SCENARIOS, flags};
use crate::io::jsonl;
use crate::report::{OutcomeCount, Published, published};
use crate::scene::material::MaterialSection;
use crate::study::certificate_row::Row;
use crate::study::history_row::HistoryRow;
use crate::study::inherited::{Checkpoint, Nsga2};
use crate::study::run_folder::{Record, RunFolder, RunState, outcome_counts};

/// What the page shows of a run.
#[derive(Serialize)]
pub(crate) struct Overview {
    name: String,
    state: State,
    /// Generations that are finished, of how many.
    generation: usize,
    generations: usize,
    population: usize,
    /// MPa.
    pressure: f64,
    material: Option<String>,
    seed: u64,
    commit: Option<String>,
    seconds_left: Option<f64>,
    evaluated: usize,
    /// Candidates that have ended of the generation under way.
    in_generation: usize,
    ranks: Vec<Rank>,
    history: Vec<HistoryRow>,
    outcomes: Vec<OutcomeCount>,
    candidates: Vec<Point>,
    front: Vec<IndividualId>,
    solids: Vec<SolidPoint>,
    literature: Vec<Published>,
    warnings: Vec<String>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
enum State {
    Running,
    /// Nothing new for minutes, and generations are left.
    Stopped,
    Finished,
}

/// What a process has done.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct Rank {
    rank: usize,
    candidates: usize,
    /// Candidates per hour, of late.
    per_hour: f64,
}

/// A candidate with objectives.
#[derive(Serialize)]
struct Point {
    id: IndividualId,
    /// Its objectives.
    #[serde(flatten)]
    objectives: BTreeMap<&'static str, f64>,
    figure_of_merit: f64,
    max_force: f64,
    /// Degrees, at the pressure (MPa) behind it, of the first scenario.
    angle_deg: f64,
    bending_pressure: f64,
    flags: String,
}

/// A member of the solids' front.
#[derive(Serialize)]
struct SolidPoint {
    id: String,
    verdict: String,
    /// Its objectives.
    #[serde(flatten)]
    objectives: BTreeMap<&'static str, f64>,
    figure_of_merit: f64,
    max_force: f64,
}

impl Overview {
    /// Reads the run in `path` with its `records`, of which so many lines were left out, which is `silent` when it has written nothing for
    /// minutes.
    pub(crate) fn read(
        path: &Path,
        records: &[Record],
        left_out: usize,
        silent: bool,
    ) -> anyhow::Result<Self> {
        let folder = RunFolder::open(path)?;
        let run = folder.run_file()?;
        let (state, damaged) = folder.load()?;
        let mut warnings: Vec<String> = damaged
            .into_iter()
            .map(|line| format!("{line}; the checkpoint before it is shown"))
            .collect();
        if left_out > 0 {
            warnings.push(format!("{left_out} damaged lines of candidates are left out"));
        }
        let (front, history) = match state {
            Some(RunState { search, history, .. }) => (front(search)?, history),
            None => (Vec::new(), Vec::new()),
        };
        let (generation, generations) = (history.len(), run.evolution.generations);
        let population = run.evolution.population;
        let ranks = throughput(records);
        let left = (population * generations).saturating_sub(records.len());
        let rate: f64 = ranks.iter().map(|rank| rank.per_hour).sum();
        let state = match () {
            () if generation >= generations => State::Finished,
            () if silent => State::Stopped,
            () => State::Running,
        };
        let is_timed = state == State::Running && rate > 0.0;
        let name = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        let solids = folder.solid_front()?;
        Ok(Self {
            name: name.file_name().unwrap_or_default().to_string_lossy().into_owned(),
            state,
            generation,
            generations,
            population,
            pressure: run.load.pressure,
            material: name_of(&run.material)?,
            seed: run.evolution.seed,
            commit: folder.commit(),
            seconds_left: is_timed.then(|| 3600.0 * left as f64 / rate),
            evaluated: records.len(),
            in_generation: records.iter().filter(|r| r.id.generation == generation).count(),
            ranks,
            history,
            outcomes: outcome_counts(records),
            candidates: records.iter().filter_map(point).collect(),
            front,
            solids: solids.iter().filter_map(solid_point).collect(),
            literature: published(),
            warnings,
        })
    }
}

/// The preset or law that the section names.
fn name_of(material: &MaterialSection) -> anyhow::Result<Option<String>> {
    let section = toml::Table::try_from(material)?;
    let name = section.get("preset").or_else(|| section.get("law"));
    Ok(name.and_then(|name| Some(name.as_str()?.to_owned())))
}

/// The records of a run, those of the generation under way included, and how many lines were damaged.
pub(crate) fn read_records(path: &Path) -> anyhow::Result<(Vec<Record>, usize)> {
    let (mut records, mut damaged) = (Vec::<Record>::new(), 0);
    for name in ["candidates.jsonl", "running.jsonl"] {
        let file = path.join(name);
        // A run removes the second between two looks.
        if let Ok((rows, left_out)) = jsonl::read_what_fits(&file) {
            records.extend::<Vec<Record>>(rows);
            damaged += left_out.len();
        }
    }
    let mut met = BTreeSet::new();
    records.retain(|record| met.insert(record.id));
    Ok((records, damaged))
}

/// The front of a `search`, the one that bends most first.
fn front(search: Checkpoint) -> anyhow::Result<Vec<IndividualId>> {
    let search = Nsga2::resume(search)?;
    let mut front = search.front();
    front.sort_by(|a, b| a.evaluation.objectives[0].total_cmp(&b.evaluation.objectives[0]));
    Ok(front.into_iter().map(|individual| individual.id).collect())
}

fn point(record: &Record) -> Option<Point> {
    let Outcome::Evaluated(evaluation) = &record.outcome else { return None };
    Some(Point {
        id: record.id,
        objectives: evaluation.known().map(|(objective, value)| (objective.name, value)).collect(),
        figure_of_merit: evaluation.figure_of_merit,
        max_force: evaluation.max_force,
        angle_deg: evaluation.angle_deg,
        bending_pressure: evaluation.ending(&SCENARIOS[0])?.pressure,
        flags: flags(&evaluation.exploits),
    })
}

fn solid_point(row: &Row) -> Option<SolidPoint> {
    let objectives = row.solid_objectives()?.into_iter();
    Some(SolidPoint {
        id: row.design.clone(),
        verdict: row.verdict.clone(),
        objectives: objectives.map(|(objective, value)| (objective.name, value)).collect(),
        figure_of_merit: row.figure_of_merit_solid?,
        max_force: row.max_force_solid?,
    })
}

/// Seconds before the last candidate's end that count as of late.
const OF_LATE: f64 = 600.0;

/// What each process did; rates are of the last ten minutes in which candidates ended.
fn throughput(records: &[Record]) -> Vec<Rank> {
    let placed = || records.iter().filter_map(|r| Some((r.place?, r.cpu_seconds.total())));
    let last = placed().map(|(place, _)| place.ended).fold(f64::NEG_INFINITY, f64::max);
    let first = placed().map(|(place, cost)| place.ended - cost).fold(f64::INFINITY, f64::min);
    let begin = first.max(last - OF_LATE);
    let mut ranks: BTreeMap<usize, (usize, usize)> = BTreeMap::new();
    for (place, _) in placed() {
        let (all, of_late) = ranks.entry(place.rank).or_default();
        *all += 1;
        *of_late += usize::from(place.ended > begin);
    }
    let rank = |(rank, (candidates, of_late))| Rank {
        rank,
        candidates,
        per_hour: 3600.0 * f64::from(of_late as u32) / (last - begin).max(1e-3),
    };
    ranks.into_iter().map(rank).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fitness::StageSeconds;
    use crate::genome::GENES;
    use crate::math::{Reason, Rejected, Room};
    use crate::study::run_folder::Place;

    fn record(index: usize, rank: usize, ended: f64) -> Record {
        let rejected = Rejected::new(Room::Surface, Reason::Islands, String::new(), 1.0);
        Record {
            id: IndividualId { generation: 0, index },
            genome: vec![0.0; GENES.len()].try_into().unwrap(),
            outcome: Outcome::Rejected(rejected),
            cpu_seconds: StageSeconds { rest: 10.0, ..StageSeconds::default() },
            counts: None,
            place: (rank < 2).then_some(Place { rank, ended }),
            settings: None,
        }
    }

    /// One process a candidate each ten seconds for twenty minutes, another each twenty; a third entry was never computed.
    #[test]
    fn rates_are_those_of_the_last_ten_minutes() {
        let fast = (1..=120).map(|k| record(k, 0, 10.0 * k as f64));
        let slow = (1..=60).map(|k| record(200 + k, 1, 20.0 * k as f64));
        let known = [record(300, 9, 0.0)];
        let records: Vec<Record> = fast.chain(slow).chain(known).collect();
        let expected = [(0, 120, 360.0), (1, 60, 180.0)].map(|(rank, candidates, per_hour)| Rank {
            rank,
            candidates,
            per_hour,
        });
        assert_eq!(throughput(&records), expected);
        assert_eq!(throughput(&[]), []);
        // Of a run that has just begun the time since its beginning counts.
        assert_eq!(throughput(&records[..2])[0].per_hour, 360.0);
    }
}
