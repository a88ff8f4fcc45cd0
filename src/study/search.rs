//! `evolve`: the search, one generation after the other, each saved before the next begins.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail, ensure};
use serde::{Deserialize, Serialize};

use super::certificate_row::{self, Row};
use super::certify::Certifying;
use super::evaluations::{Evaluator, Generation, Known, Unfinished, serve_candidates};
use super::history_row::HistoryRow;
use super::inherited::{Checkpoint, Individual, Nsga2};
use super::meaning::Meaning;
use super::mesh_error::MeshErrorRow;
use super::observer::{Limits, Observer};
use super::overload::overload;
use super::resume::Start;
use super::run_file::RunFile;
use super::run_folder::{Record, RunFolder, RunState, outcome_counts};
use super::solid_front::SolidFront;
use crate::batch::{Executor, Farm, Next, Stopped, Threads, hear_others, tell_first};
use crate::evolve::{Evaluation, hypervolume};
use crate::fitness::{CandidateSettings, FitnessSettings, Outcome, evaluate_network};
use crate::genome::Representation;
use crate::io::provenance::COMMIT;
use crate::io::{atomic, csv};
use crate::report::{FrontPoint, OutcomeCount};
use crate::scene::End;
use crate::scene::material::instability;
use crate::scene::part::solid_part::SolidSection;
use crate::scene::results::design_folder::write_surface;
use crate::scene::results::path_rows::write_scenarios;
use crate::solve::{Backend, Job, Stop};

/// How a search is run.
#[derive(Clone, Copy, Debug)]
pub struct Manner {
    /// Whether to go on with the search in the folder.
    pub resume: bool,
    /// Of each process; 0 is one for each core, or one where there are several processes.
    pub threads: usize,
    /// The processes that evaluate.
    pub job: Job,
}

impl Default for Manner {
    /// A new search, in this process alone, with a thread for each core.
    fn default() -> Self {
        Self { resume: false, threads: 0, job: Job { rank: 0, ranks: 1 } }
    }
}

/// What has become of a search.
#[derive(Debug)]
pub enum Searched {
    /// It was done to its end, and its results are in its folder.
    Finished(Box<Found>),
    /// Its limits ended it; what has ended is in its folder, and it can be resumed.
    Stopped,
    /// This process is not the first of the job, and has evaluated for that one.
    Served,
}

/// Runs the search of `run` in the folder `out`; the processes of the job but the first only
/// evaluate.
///
/// # Errors
/// When the folder is refused, cannot be written, or was made with other settings; when a solver or
/// a mesher fails as a program.
pub fn search(
    run: &RunFile,
    out: &Path,
    manner: &Manner,
    limits: &dyn Limits,
    observer: &dyn Observer,
) -> anyhow::Result<Searched> {
    let job = manner.job;
    ensure!(
        job.ranks == 1 || run.solver.backend == Backend::Native,
        "several processes evaluate with the solver native; PETSc would solve each candidate on all of them"
    );
    let settings = Meaning::of_search(run)?;
    agree(job, &settings)?;
    if !job.is_first() {
        let is_over = || limits.is_over();
        let (representation, settings) = (run.representation()?, run.candidate_settings()?);
        serve_candidates(job, &representation, &settings, Stop::when(&is_over))?;
        return Ok(Searched::Served);
    }
    run.solid.iter().try_for_each(SolidSection::check_programs)?;
    let material = run.material.material()?;
    let warnings = [instability(&material), overload(run, &material)];
    warnings.iter().flatten().for_each(|line| observer.warning(line));
    let threads = Threads::new(manner.threads(run, observer))?;
    let farm = (job.ranks > 1).then(|| Farm::new(job, &threads));
    let evaluator: &Evaluator<'_> = match &farm {
        Some(farm) => farm,
        None => &threads,
    };
    let mut search = Search::begin(run, out, settings, *manner, limits, observer)?;
    let first = search.nsga2.generation();
    while !search.is_finished() {
        match search.advance(evaluator) {
            Ok(()) => {}
            Err(Unfinished::Stopped { ended }) => {
                let is_idle = ended == 0 && search.nsga2.generation() == first;
                return Ok(search.stopped(is_idle));
            }
            Err(Unfinished::Failed(error)) => return Err(error),
        }
    }
    search.folder.write_results(&search.nsga2, &search.history, &search.records)?;
    if search.write_front_members(&threads)? == End::Stopped {
        return Ok(search.stopped(false));
    }
    observer.table(&search.folder.table(&search.nsga2, &search.records)?);
    if let Some(section) = &run.solid
        && search.certify_front(run, section, &threads)? == End::Stopped
    {
        return Ok(search.stopped(false));
    }
    Ok(Searched::Finished(Box::new(search.found()?)))
}

/// What the processes of a job have in common before they begin.
#[derive(Serialize, Deserialize)]
struct Word {
    commit: String,
    settings: Meaning,
}

/// Refuses processes that would search for different things.
fn agree(job: Job, settings: &Meaning) -> anyhow::Result<()> {
    if !job.is_first() {
        let word = Word { commit: COMMIT.to_owned(), settings: settings.clone() };
        return Ok(tell_first(&job, &word)?);
    }
    for (Word { commit, settings: theirs }, rank) in hear_others::<Word>(&job)?.iter().zip(1..) {
        if let Some(difference) = theirs.first_difference(settings) {
            bail!("process {rank} of the job has another run file than process 0: {difference}");
        }
        ensure!(
            commit == COMMIT,
            "process {rank} of the job is another build than process 0 (commit {commit} instead of {COMMIT})"
        );
    }
    Ok(())
}

impl Manner {
    fn threads(&self, run: &RunFile, observer: &dyn Observer) -> usize {
        if run.solver.backend == Backend::Petsc && self.threads != 1 {
            // PETSc solves one system at a time in a process: more threads would only wait.
            observer.note("petsc evaluates one candidate at a time; native would use every core");
            return 1;
        }
        if self.threads == 0 && self.job.ranks > 1 { 1 } else { self.threads }
    }
}

/// What a search has found.
#[derive(Debug, Serialize)]
pub struct Found {
    /// Where its results are.
    pub folder: PathBuf,
    /// How many candidates it has evaluated, those met before included.
    pub candidates: usize,
    /// Of CPU time, s.
    pub core_seconds: f64,
    /// How many candidates ended in which way: those with objectives first, then the most.
    pub outcomes: Vec<OutcomeCount>,
    /// Of objectives, that the front dominates.
    pub hypervolume: f64,
    /// The designs that no other is better than in all objectives.
    pub front: Vec<FrontPoint>,
    /// Where the front was walked again as solids.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(crate) solid_front: Vec<Row>,
}

impl Found {
    /// A line of how many candidates were rejected why, and what all took.
    #[must_use]
    pub fn rejections(&self) -> String {
        let causes: Vec<String> = self
            .outcomes
            .iter()
            .filter(|count| count.rejected)
            .map(|count| format!("{} {}", count.outcome, count.candidates))
            .collect();
        let causes = if causes.is_empty() { "none".to_owned() } else { causes.join(", ") };
        format!(
            "{} candidates in {:.1} core-seconds; rejected: {causes}",
            self.candidates, self.core_seconds
        )
    }
}

/// A run between two generations.
struct Search<'a> {
    limits: &'a dyn Limits,
    observer: &'a dyn Observer,
    settings: CandidateSettings,
    nsga2: Nsga2,
    history: Vec<HistoryRow>,
    records: Vec<Record>,
    /// Records of generations that are still to come.
    found: Vec<Record>,
    /// To what the records of a damaged folder are to lead.
    expected: Option<Checkpoint>,
    meaning: Meaning,
    digest: String,
    builds: Vec<String>,
    folder: RunFolder,
}

impl<'a> Search<'a> {
    fn begin(
        run: &RunFile,
        out: &Path,
        meaning: Meaning,
        manner: Manner,
        limits: &'a dyn Limits,
        observer: &'a dyn Observer,
    ) -> anyhow::Result<Self> {
        let settings = run.candidate_settings()?;
        let (folder, start) = if manner.resume {
            let folder = RunFolder::open_to_resume(out, observer)?;
            let start = Start::resumed(&folder, run, meaning, observer)?;
            folder.write_settings(run)?;
            observer.note(&format!(
                "resumed after generation {} of {}",
                start.nsga2.generation(),
                run.evolution.generations
            ));
            (folder, start)
        } else {
            let start = Start::new(run, meaning)?;
            (RunFolder::create(out, run, observer)?, start)
        };
        let Start { nsga2, history, records, found, expected, settings: meaning, builds } = start;
        let digest = meaning.digest();
        let search = Self {
            limits,
            observer,
            settings,
            nsga2,
            history,
            records,
            found,
            expected,
            meaning,
            digest,
            builds,
            folder,
        };
        if search.nsga2.generation() == 0 {
            // So that what is evaluated first is bound to its settings too.
            search.folder.save(&search.state())?;
        }
        Ok(search)
    }

    fn is_finished(&self) -> bool {
        let expects =
            self.expected.as_ref().is_some_and(|e| self.nsga2.generation() < e.generation);
        self.nsga2.is_finished() && !expects
    }

    fn state(&self) -> RunState {
        RunState {
            search: self.nsga2.checkpoint(),
            history: self.history.clone(),
            settings: Some(self.meaning.clone()),
            builds: self.builds.clone(),
        }
    }

    fn advance(&mut self, evaluator: &Evaluator<'_>) -> Result<(), Unfinished> {
        let candidates = self.nsga2.ask();
        let generation = Generation {
            candidates: &candidates,
            number: self.nsga2.generation(),
            generations: self.nsga2.settings().generations,
            records: &self.records,
            found: &self.found,
            representation: self.nsga2.representation(),
            settings: &self.settings,
            digest: &self.digest,
            folder: &self.folder,
            limits: self.limits,
            observer: self.observer,
        };
        let records = generation.evaluate(evaluator)?;
        let asked = &self.settings.fitness;
        let evaluations = records.iter().map(|record| evaluation(record, asked));
        self.nsga2.tell(evaluations.collect::<anyhow::Result<_>>()?);
        self.check_expected()?;
        self.folder.append(&records)?;
        self.history.push(self.history_row(&records));
        self.records.extend(records);
        self.folder.save(&self.state())?;
        let generation = self.nsga2.generation();
        let text = |record: &Record| Known::text(&record.genome);
        let met: BTreeSet<_> = self.records.iter().map(text).collect();
        self.found.retain(|r| r.id.generation >= generation || !met.contains(&text(r)));
        Ok(self.folder.keep_found(&self.found)?)
    }

    /// Refuses records that do not lead to the checkpoint that they were found with.
    fn check_expected(&self) -> anyhow::Result<()> {
        let here = self.nsga2.checkpoint();
        let expected = self.expected.as_ref().filter(|e| e.generation == here.generation);
        ensure!(
            expected.is_none_or(|expected| *expected == here),
            "{}: what is recorded does not lead to the checkpoint after generation {}; nothing was removed (was it made by another build?)",
            self.folder.path().display(),
            here.generation
        );
        Ok(())
    }

    /// Says how far the search is; `is_idle` where no candidate has ended since it was begun or
    /// resumed.
    fn stopped(&self, is_idle: bool) -> Searched {
        self.observer.note(&format!(
            "{} after {} of {} generations; what has ended is saved, and --resume goes on{}",
            self.limits.why(),
            self.nsga2.generation(),
            self.nsga2.settings().generations,
            if is_idle { " (no candidate has ended since: give it more time)" } else { "" }
        ));
        Searched::Stopped
    }

    fn history_row(&self, records: &[Record]) -> HistoryRow {
        let front = self.nsga2.front();
        let objectives: Vec<&[f64]> =
            front.iter().map(|individual| &individual.evaluation.objectives[..]).collect();
        let asked = &self.settings.fitness;
        let best = asked.objectives().enumerate().map(|(k, objective)| {
            (objective.name.to_owned(), objective.best_of(objectives.iter().map(|o| o[k])))
        });
        let row = HistoryRow {
            generation: self.nsga2.generation() - 1,
            evaluated: records.len(),
            feasible: records.iter().filter(|r| matches!(r.outcome, Outcome::Evaluated(_))).count(),
            front: front.len(),
            hypervolume: hypervolume(&objectives, &reference(asked)),
            best: best.collect(),
            spread: self.nsga2.spread(),
        };
        self.observer.generation(&row, self.nsga2.settings().generations);
        row
    }

    /// Computes the members of the front again, with a second mesh too, and writes genome, surface,
    /// paths and pictures of each, and how far they depend on the mesh.
    fn write_front_members(&self, executor: &Threads) -> anyhow::Result<End> {
        let front: Vec<&Individual> = self.nsga2.front();
        let folder = self.folder.file("front");
        if folder.exists() {
            // Members of an earlier front that a resumed run has left behind.
            std::fs::remove_dir_all(&folder).with_context(|| folder.display().to_string())?;
        }
        self.observer.work_begins("writing the front", 0, front.len());
        let written = executor.evaluate(
            &front,
            &|individual: &&Individual| self.write_member(individual),
            &mut |_, _| {
                self.observer.item_done();
                if self.limits.is_interrupted() { Next::Stop } else { Next::Continue }
            },
        );
        self.observer.work_ends();
        let written = match written {
            Err(Stopped::ByObserver) => return Ok(End::Stopped),
            written => written?,
        };
        let rows: Vec<MeshErrorRow> =
            written.into_iter().flatten().collect::<anyhow::Result<_>>()?;
        self.folder.write_mesh_errors(&rows)?;
        Ok(End::Finished)
    }

    fn write_member(&self, individual: &Individual) -> anyhow::Result<MeshErrorRow> {
        let folder = self.folder.path().join("front").join(individual.id.to_string());
        std::fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
        let network = self.nsga2.representation().express(&individual.genome);
        atomic::write(&folder.join("genome.toml"), network.to_toml().as_bytes())?;
        let candidate = evaluate_network(&network, &self.settings)?;
        let (Some(mesh), Some(mut scenarios), Outcome::Evaluated(evaluation)) =
            (candidate.mesh, candidate.scenarios, candidate.outcome)
        else {
            bail!("{} was evaluated before and fails now", individual.id);
        };
        write_surface(&folder, &mesh)?;
        write_scenarios(&folder, "", &mut scenarios, Some(&mesh))?;
        MeshErrorRow::new(individual.id.to_string(), &network, &self.settings, &evaluation)
    }

    /// Walks the front as solids, and what they promote; writes `solid/` and `front_solid.csv`.
    /// What a killed run has walked is taken from there.
    fn certify_front(
        &self,
        run: &RunFile,
        section: &SolidSection,
        executor: &Threads,
    ) -> anyhow::Result<End> {
        let front: Vec<_> = self.nsga2.front().iter().map(|individual| individual.id).collect();
        let folder = self.folder.file("solid");
        self.observer.note(&format!("walking the front of {} designs as solids", front.len()));
        let job = Certifying {
            settings: &self.settings,
            section,
            meaning: &Meaning::of_certificates(run, section)?,
            folder: &folder,
            limits: self.limits,
            observer: self.observer,
        };
        let Some(solid) =
            SolidFront::new(&front, &self.records, self.nsga2.representation(), &job, executor)?
        else {
            return Ok(End::Stopped);
        };
        let SolidFront { rows, of_front, front } = &solid;
        std::fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
        csv::write_cells(&folder.join("certificates.csv"), rows)?;
        self.folder.write_solid_front(front, &self.nsga2, &self.records)?;
        self.observer.table(&certificate_row::table(rows));
        self.observer.note(&certificate_row::summary(rows, &section.fidelity));
        self.observer.note(&format!(
            "{of_front} designs of the front and {} promoted ones make a front of {} solids: front_solid.csv",
            rows.len() - of_front,
            front.len()
        ));
        Ok(End::Finished)
    }

    fn found(&self) -> anyhow::Result<Found> {
        Ok(Found {
            folder: self.folder.path().to_owned(),
            candidates: self.records.len(),
            core_seconds: self.records.iter().map(|record| record.cpu_seconds.total()).sum(),
            outcomes: outcome_counts(&self.records),
            hypervolume: self.history.last().map_or(0.0, |row| row.hypervolume),
            front: self.folder.front(&self.nsga2, &self.records)?,
            solid_front: self.folder.solid_front()?,
        })
    }
}

/// What a `record` is to the search, which makes the objectives that `asked` has small.
pub(crate) fn evaluation(record: &Record, asked: &FitnessSettings) -> anyhow::Result<Evaluation> {
    let evaluated = match &record.outcome {
        Outcome::Evaluated(evaluated) => evaluated,
        rejected @ Outcome::Rejected(_) => {
            return Ok(Evaluation::infeasible(rejected.constraint_violation()));
        }
    };
    let values = asked.objectives().map(|objective| {
        let value = evaluated.value(objective);
        let value = value.with_context(|| format!("{} has no {}", record.id, objective.name))?;
        Ok(objective.minimized(value))
    });
    Ok(Evaluation::feasible(values.collect::<anyhow::Result<_>>()?))
}

/// Where the hypervolume of a front with the objectives that `asked` has ends.
pub(crate) fn reference(asked: &FitnessSettings) -> Vec<f64> {
    asked.objectives().map(|objective| objective.minimized(objective.worst)).collect()
}
