//! The folder of a run: what `evolve` writes, and `--resume` and `report` read.
//!
//! ```text
//! run.toml  provenance.json  checkpoints/  candidates.jsonl  history.csv
//! running.jsonl                of a run that goes on, or was killed: what is not in candidates.jsonl yet
//! candidates.jsonl.damaged     what a run that went on found damaged, as it was
//! .lock                        locked by the process that writes
//! front.csv  front_error.csv  outcomes.csv  front, history, merit, outcomes, each .svg and .png
//! solid/  front_solid.csv      of a run with a [solid] section
//! front/<id>/  genome.toml  surface.stl  path.csv  path_blocked.csv  *.vtu  *.pvd
//! ```

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context, anyhow, bail, ensure};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::certificate_row::Row;
use super::front_rows::{axes, evaluated_objectives, front_points, header};
use super::history_row::HistoryRow;
use super::inherited::{Checkpoint, Genome, Inherited, Nsga2};
use super::meaning::Meaning;
use super::mesh_error::MeshErrorRow;
use super::observer::Observer;
use super::run_file::RunFile;
use crate::evolve::IndividualId;
use crate::fitness::{Outcome, SCENARIOS, StageSeconds};
use crate::genome::{Network, Representation};
use crate::io::provenance::Provenance;
use crate::io::{
    FolderLock, InputError, OutputError, OutputFolder, atomic, checkpoint, csv, input, jsonl,
    toml_file,
};
use crate::report::{
    FrontPoint, HistoryPoint, OutcomeCount, front_svg, front_table, history_svg, merit_svg,
    outcomes_svg, png, standing,
};
use crate::scene::results::design_folder::write_json;
use crate::solve::SolveCounts;

/// One line of `candidates.jsonl`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Record {
    pub id: IndividualId,
    pub genome: Genome,
    #[serde(flatten)]
    pub outcome: Outcome,
    pub cpu_seconds: StageSeconds,
    /// What it asked of the solvers; none of a genome that was known, or in records of earlier programs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub counts: Option<SolveCounts>,
    /// Where and when it was evaluated; none of a genome that was known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub place: Option<Place>,
    /// The digest of the settings of its run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub settings: Option<String>,
}

impl Record {
    /// The network of the design.
    pub(crate) fn network(&self, representation: &Inherited) -> Network {
        representation.express(&self.genome)
    }
}

/// Where and when a candidate was evaluated.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Place {
    /// Number of the process in its job.
    pub rank: usize,
    /// When it ended, seconds since 1970.
    pub ended: f64,
}

/// What a checkpoint holds.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct RunState {
    pub search: Checkpoint,
    pub history: Vec<HistoryRow>,
    /// What its run file means; earlier versions kept none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub settings: Option<Meaning>,
    /// The commits of the programs that took part, in their order.
    #[serde(default)]
    pub builds: Vec<String>,
}

/// Scale of the PNG figures over the SVG's pixels.
const PNG_SCALE: f32 = 2.0;

const RUN_FILE: &str = "run.toml";
const CHECKPOINTS: &str = "checkpoints";

/// The records of all generations that are over.
const CANDIDATES: &str = "candidates.jsonl";

/// The records of the generation that is being evaluated, as they end.
const RUNNING: &str = "running.jsonl";

/// The front of the solids.
const SOLID_FRONT: &str = "front_solid.csv";

/// What a second mesh makes of the front.
const FRONT_ERROR: &str = "front_error.csv";

/// A run folder.
pub(crate) struct RunFolder {
    folder: OutputFolder,
    /// Of the one process that writes into it.
    _lock: Option<FolderLock>,
}

/// What the logs of a run hold.
pub(crate) struct Logged {
    /// Of `candidates.jsonl`.
    candidates: Vec<Record>,
    /// Of `running.jsonl`.
    running: Vec<Record>,
    /// Lines of either that cannot be used.
    pub damaged: Vec<InputError>,
}

impl Logged {
    /// The records in the order in which they were written.
    pub(crate) fn all(&self) -> impl Iterator<Item = &Record> {
        self.candidates.iter().chain(&self.running)
    }
}

impl RunFolder {
    /// What is kept of a log with damaged lines.
    pub(crate) const DAMAGED: &str = "candidates.jsonl.damaged";

    /// A new folder for `run`, or one that a killed run had only begun to make.
    pub(crate) fn create(
        path: &Path,
        run: &RunFile,
        observer: &dyn Observer,
    ) -> anyhow::Result<Self> {
        let (folder, lock) = OutputFolder::claim(path).map_err(|error| match error {
            OutputError::FolderExists(_) => anyhow!("{error}, or go on with its run: --resume"),
            other => other.into(),
        })?;
        let folder = Self { folder, _lock: Some(guarding(lock, observer)) };
        folder.write_settings(run)?;
        Ok(folder)
    }

    /// Writes the run file, and which program runs it.
    pub(crate) fn write_settings(&self, run: &RunFile) -> anyhow::Result<()> {
        atomic::write(&self.file(RUN_FILE), toml::to_string(run)?.as_bytes())?;
        write_json(&self.file("provenance.json"), &Provenance::of_this_process())
    }

    /// The folder of an earlier run, to look at.
    pub(crate) fn open(path: &Path) -> anyhow::Result<Self> {
        let folder = OutputFolder::open(path)?;
        ensure!(
            folder.file(RUN_FILE).is_file(),
            "{} is not the folder of a run: it has no run.toml",
            path.display()
        );
        Ok(Self { folder, _lock: None })
    }

    /// The folder of an earlier run, to go on with: nobody else can at the same time.
    pub(crate) fn open_to_resume(path: &Path, observer: &dyn Observer) -> anyhow::Result<Self> {
        let Self { folder, .. } = Self::open(path)?;
        let lock = FolderLock::take(path)?;
        Ok(Self { folder, _lock: Some(guarding(lock, observer)) })
    }

    /// The run file that the folder was made with.
    pub(crate) fn run_file(&self) -> anyhow::Result<RunFile> {
        Ok(toml_file::read(&self.folder.file(RUN_FILE))?)
    }

    /// The commit of the program that made the folder, where it says so.
    #[cfg(feature = "monitor")]
    pub(crate) fn commit(&self) -> Option<String> {
        let text = input::text(&self.file("provenance.json"), input::SETTINGS).ok()?;
        let provenance: serde_json::Value = serde_json::from_str(&text).ok()?;
        provenance["commit"].as_str().map(str::to_owned)
    }

    /// Refuses to go on with other `settings` than those of the checkpoint's `state`, or where that has none with a run file other than
    /// the folder's copy; only more generations may be asked for, and another second stage, which the search does not know.
    pub(crate) fn check_same(
        &self,
        run: &RunFile,
        settings: &Meaning,
        state: Option<&RunState>,
        observer: &dyn Observer,
    ) -> anyhow::Result<()> {
        let kept = state.and_then(|state| state.settings.as_ref());
        let difference = match (kept, state) {
            (Some(kept), _) => settings.first_difference_from_earlier(kept),
            (None, Some(state)) => {
                settings.first_difference_of_known(&Meaning::of_checkpoint(&state.search)?)
            }
            (None, None) => None,
        };
        let difference = match (difference, kept) {
            (None, None) => settings.first_difference(&Meaning::of_search(&self.run_file()?)?),
            (difference, _) => difference,
        };
        if let Some(difference) = difference {
            bail!(
                "{} was made with other settings: {difference}; resume it with its own run.toml, or choose another folder",
                self.path().display()
            );
        }
        let copy = self.run_file().and_then(|copy| Meaning::of_search(&copy));
        if copy.ok().is_none_or(|copy| settings.first_difference(&copy).is_some()) {
            observer.warning(&format!(
                "{} was changed since the run was made; it is written anew",
                self.file(RUN_FILE).display()
            ));
        }
        let old = self.run_file().ok().and_then(|old| old.solid);
        ensure!(
            old == run.solid || !self.file("solid").exists(),
            "{} was made with another [solid] section; remove it to walk the front again",
            self.file("solid").display()
        );
        Ok(())
    }

    pub(crate) fn path(&self) -> &Path {
        self.folder.path()
    }

    /// The folder of a member of the front.
    pub(crate) fn design(&self, id: &str) -> std::path::PathBuf {
        self.folder.path().join("front").join(id)
    }

    pub(crate) fn file(&self, name: &str) -> std::path::PathBuf {
        self.folder.file(name)
    }

    /// The last complete checkpoint, and a line for each damaged one that was passed over.
    pub(crate) fn load(&self) -> anyhow::Result<(Option<RunState>, Vec<String>)> {
        let folder = self.file(CHECKPOINTS);
        let found =
            if folder.is_dir() { checkpoint::load_latest::<RunState>(&folder)? } else { None };
        let Some(found) = found else {
            return Ok((None, Vec::new()));
        };
        let damaged = found.damaged.iter().map(ToString::to_string).collect();
        Ok((Some(found.state), damaged))
    }

    /// As [`Self::load`]; where no checkpoint can be used there is none, with a line for each.
    pub(crate) fn load_to_resume(&self) -> anyhow::Result<(Option<RunState>, Vec<String>)> {
        let folder = self.file(CHECKPOINTS);
        if !folder.is_dir() {
            return Ok((None, Vec::new()));
        }
        let lines = |damaged: Vec<InputError>| damaged.iter().map(ToString::to_string).collect();
        Ok(match checkpoint::load_usable::<RunState>(&folder)? {
            Ok(found) => (Some(found.state), lines(found.damaged)),
            Err(damaged) => (None, lines(damaged)),
        })
    }

    pub(crate) fn save(&self, state: &RunState) -> anyhow::Result<()> {
        let generation = state.search.generation as u64;
        Ok(checkpoint::save(&self.folder.subfolder(CHECKPOINTS)?, generation, state)?)
    }

    /// The records of the generations before `generation`.
    pub(crate) fn records(&self, generation: usize) -> anyhow::Result<Vec<Record>> {
        let path = self.file(CANDIDATES);
        let mut records: Vec<Record> = if path.exists() { jsonl::read(&path)? } else { Vec::new() };
        records.retain(|record| record.id.generation < generation);
        Ok(records)
    }

    /// What was recorded of `id`, in whatever generation.
    pub(crate) fn record(&self, id: IndividualId) -> anyhow::Result<Option<Record>> {
        Ok(self.records(usize::MAX)?.into_iter().find(|record| record.id == id))
    }

    /// Everything that was recorded.
    pub(crate) fn logged(&self) -> anyhow::Result<Logged> {
        let read = |name: &str| {
            let path = self.file(name);
            if path.exists() { jsonl::read_what_fits(&path) } else { Ok(Default::default()) }
        };
        let (candidates, mut damaged) = read(CANDIDATES)?;
        let (running, also_damaged) = read(RUNNING)?;
        damaged.extend(also_damaged);
        Ok(Logged { candidates, running, damaged })
    }

    /// Makes `records` the contents of `candidates.jsonl` and `found` those of `running.jsonl`, and takes away what killed processes
    /// have left half written. What is `logged` is at no time in neither.
    pub(crate) fn put_in_order(
        &self,
        logged: &Logged,
        records: &[Record],
        found: &[Record],
    ) -> anyhow::Result<()> {
        atomic::clear_unfinished(self.path())?;
        let candidates = self.file(CANDIDATES);
        if !logged.damaged.is_empty() {
            let logs = [candidates.clone(), self.file(RUNNING)]
                .map(|log| input::bytes(&log, input::DATA).ok());
            atomic::write(
                &self.file(Self::DAMAGED),
                &logs.into_iter().flatten().flatten().collect::<Vec<_>>(),
            )?;
        }
        self.keep_found(found)?;
        let ids = |records: &[Record]| records.iter().map(|record| record.id).collect::<Vec<_>>();
        let is_in_order = logged.damaged.is_empty() && ids(&logged.candidates) == ids(records);
        if !is_in_order {
            jsonl::write(&candidates, records)?;
        }
        Ok(())
    }

    /// Makes `found` the contents of `running.jsonl`: the records whose generations are still to come.
    pub(crate) fn keep_found(&self, found: &[Record]) -> anyhow::Result<()> {
        let path = self.file(RUNNING);
        if !found.is_empty() {
            return Ok(jsonl::write(&path, found)?);
        }
        match std::fs::remove_file(&path) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                Err(error).with_context(|| path.display().to_string())
            }
            _ => Ok(()),
        }
    }

    /// The log of the generation that is being evaluated.
    pub(crate) fn running_log(&self) -> anyhow::Result<jsonl::JsonLog> {
        Ok(jsonl::JsonLog::open(&self.file(RUNNING))?)
    }

    pub(crate) fn append(&self, records: &[Record]) -> anyhow::Result<()> {
        let mut log = jsonl::JsonLog::open(&self.file(CANDIDATES))?;
        records.iter().try_for_each(|record| log.append(record))?;
        Ok(log.sync()?)
    }

    /// The front of the `search` with what was recorded of its members.
    pub(crate) fn front(
        &self,
        search: &Nsga2,
        records: &[Record],
    ) -> anyhow::Result<Vec<FrontPoint>> {
        let mut front = front_points(&search.front(), records)
            .with_context(|| self.path().display().to_string())?;
        let errors: Vec<MeshErrorRow> = rows_of(&self.file(FRONT_ERROR))?;
        for point in &mut front {
            let of_point = errors.iter().find(|row| row.id == point.id);
            let error = |row: &MeshErrorRow| {
                point.objectives.iter().map(|column| row.error_percent(column.name)).collect()
            };
            point.mesh_errors = of_point.map(error).unwrap_or_default();
        }
        Ok(front)
    }

    /// Writes `front_error.csv`.
    pub(crate) fn write_mesh_errors(&self, rows: &[MeshErrorRow]) -> anyhow::Result<()> {
        Ok(csv::write_cells(&self.file(FRONT_ERROR), rows)?)
    }

    /// The front for the terminal.
    pub(crate) fn table(&self, search: &Nsga2, records: &[Record]) -> anyhow::Result<String> {
        let front = self.front(search, records)?;
        if front.is_empty() {
            return Ok(why_none(records));
        }
        Ok(front_table(&front) + &standing(&front).map_or_else(String::new, |line| line + "\n"))
    }

    /// Writes tables and figures of what the run has found.
    pub(crate) fn write_results(
        &self,
        search: &Nsga2,
        history: &[HistoryRow],
        records: &[Record],
    ) -> anyhow::Result<()> {
        let front = self.front(search, records)?;
        csv::write_cells(&self.file("history.csv"), history)?;
        if front.is_empty() {
            let run = self.run_file()?;
            let header = header(&run.fitness, run.load.rated.is_some());
            atomic::write(&self.file("front.csv"), header.as_bytes())?;
        } else {
            csv::write_cells(&self.file("front.csv"), &front)?;
        }
        let solids = self.solid_front()?;
        let solids: Vec<FrontPoint> = solids.iter().filter_map(Row::front_point).collect();
        self.write_fronts(&front, records, &solids)?;
        let points: Vec<HistoryPoint> = history
            .iter()
            .map(|row| HistoryPoint {
                generation: row.generation as u64,
                hypervolume: row.hypervolume,
                feasible_share: row.feasible as f64 / row.evaluated as f64,
            })
            .collect();
        self.write_figure("history", &history_svg(&points))?;
        let outcomes = outcome_counts(records);
        csv::write(&self.file("outcomes.csv"), &outcomes)?;
        self.write_figure("outcomes", &outcomes_svg(&outcomes))
    }

    /// Writes the figures of both fronts.
    fn write_fronts(
        &self,
        front: &[FrontPoint],
        records: &[Record],
        solids: &[FrontPoint],
    ) -> anyhow::Result<()> {
        let evaluated = evaluated_objectives(records);
        self.write_figure("front", &front_svg(&axes(), front, &evaluated, solids))?;
        self.write_figure("merit", &merit_svg(front, solids))
    }

    /// The rows of `front_solid.csv`; none where there is no such file.
    pub(crate) fn solid_front(&self) -> anyhow::Result<Vec<Row>> {
        rows_of(&self.file(SOLID_FRONT))
    }

    /// The rows of `solid/certificates.csv`; none where there is no such file.
    #[cfg(feature = "monitor")]
    pub(crate) fn certificates(&self) -> anyhow::Result<Vec<Row>> {
        rows_of(&self.file("solid/certificates.csv"))
    }

    /// Writes `front_solid.csv`, and the figure of both fronts.
    pub(crate) fn write_solid_front(
        &self,
        solids: &[Row],
        search: &Nsga2,
        records: &[Record],
    ) -> anyhow::Result<()> {
        csv::write_cells(&self.file(SOLID_FRONT), solids)?;
        let front = self.front(search, records)?;
        let solids: Vec<FrontPoint> = solids.iter().filter_map(Row::front_point).collect();
        self.write_fronts(&front, records, &solids)
    }

    fn write_figure(&self, name: &str, svg: &str) -> anyhow::Result<()> {
        atomic::write(&self.file(&format!("{name}.svg")), svg.as_bytes())?;
        Ok(atomic::write(&self.file(&format!("{name}.png")), &png(svg, PNG_SCALE))?)
    }
}

/// Why there is no front: the leading reasons, each with its count and with what one design said.
fn why_none(records: &[Record]) -> String {
    let told = |count: &OutcomeCount| {
        let detail = records.iter().find_map(|record| match &record.outcome {
            Outcome::Rejected(rejected) if way_of(&record.outcome).1 == count.outcome => {
                Some(rejected.detail.as_str())
            }
            _ => None,
        });
        let detail = detail.filter(|detail| !detail.is_empty());
        let detail = detail.map_or_else(String::new, |detail| format!(" (such as: {detail})"));
        format!("{} {}{detail}", count.candidates, count.outcome)
    };
    let counts = outcome_counts(records);
    let reasons: Vec<String> = counts.iter().take(LEADING).map(told).collect();
    format!(
        "no design could be evaluated, because of {} candidates were rejected: {}{}\n",
        records.len(),
        reasons.join("; "),
        if counts.len() > LEADING { "; and others, see outcomes.csv" } else { "" }
    )
}

/// How many reasons are told where nothing could be evaluated.
const LEADING: usize = 3;

/// The `lock`; where it keeps nobody out the user has to.
fn guarding(lock: FolderLock, observer: &dyn Observer) -> FolderLock {
    if let Some(why) = lock.unguarded() {
        observer.warning(&format!(
            "the file system of the run folder has no locks ({why}): see to it that no other process writes there"
        ));
    }
    lock
}

fn rows_of<R: DeserializeOwned>(path: &Path) -> anyhow::Result<Vec<R>> {
    if !path.exists() {
        return Ok(Vec::new());
    }
    let text = input::text(path, input::DATA)?;
    Ok(csv::parse(&text, path)?)
}

/// How many of the `records` ended in which way: those with objectives first, then the most.
pub(crate) fn outcome_counts(records: &[Record]) -> Vec<OutcomeCount> {
    let mut counts: BTreeMap<(bool, String), usize> = BTreeMap::new();
    for record in records {
        *counts.entry(way_of(&record.outcome)).or_default() += 1;
    }
    let mut counts: Vec<OutcomeCount> = counts
        .into_iter()
        .map(|((rejected, outcome), candidates)| OutcomeCount { outcome, rejected, candidates })
        .collect();
    counts.sort_by_key(|count| (count.rejected, std::cmp::Reverse(count.candidates)));
    counts
}

/// Whether an outcome is a rejection, and its cause; else how the path of the first scenario ended.
fn way_of(outcome: &Outcome) -> (bool, String) {
    match outcome {
        Outcome::Evaluated(evaluation) => {
            let ending = evaluation.ending(&SCENARIOS[0]).map(|ended| ended.ending.name());
            (false, ending.unwrap_or_default().to_owned())
        }
        Outcome::Rejected(rejected) => (true, format!("{:?}/{}", rejected.room, rejected.reason)),
    }
}
