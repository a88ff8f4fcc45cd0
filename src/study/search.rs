//! `evolve`: the search, one generation after the other, each saved before the next begins.

use std::collections::BTreeSet;
use std::path::Path;
use std::time::Duration;

use anyhow::{Context, bail, ensure};
use indicatif::{ProgressBar, ProgressStyle};
use serde::{Deserialize, Serialize};

use super::certify;
use super::certify::{Certifying, Row};
use super::evaluations::{Evaluator, Generation, Known, Unfinished, serve_candidates};
use super::meaning::Meaning;
use super::mesh_error::MeshErrorRow;
use super::overload::overload;
use super::resume::Start;
use super::run_file::RunFile;
use super::run_folder::{HistoryRow, Record, RunFolder, RunState, outcome_counts};
use super::solid_front::SolidFront;
use crate::batch::{Executor, Farm, Next, Stopped, Threads, hear_others, tell_first};
use crate::cli::patience::{End, Patience};
use crate::cli::terminal::narrate;
use crate::cli::terminal::say;
use crate::cli::terminal::warn;
use crate::evolve::{Checkpoint, Evaluation, Individual, Nsga2, hypervolume};
use crate::fitness::{CandidateSettings, FurtherObjective, Outcome, evaluate_network};
use crate::genome::Genome;
use crate::io::provenance::COMMIT;
use crate::io::{atomic, csv};
use crate::report::{FrontPoint, OutcomeCount};
use crate::scene::material::instability;
use crate::scene::part::solid_part::SolidSection;
use crate::scene::results::design_folder::write_surface;
use crate::scene::results::path_rows::write_scenarios;
use crate::solve::{Backend, Job, Stop};

/// How a search is run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Manner {
    pub resume: bool,
    /// Of each process; 0 is one for each core, or one where there are several processes.
    pub threads: usize,
    pub solver: Option<Backend>,
    /// After which it stops, candidates that have begun too.
    pub time_limit: Option<Duration>,
    /// Whether a program reads the answer.
    pub json: bool,
    pub job: Job,
}

/// Runs the search of the run file at `path` in the folder `out`; the processes of the job but the first only evaluate.
pub(crate) fn run(path: &Path, out: &Path, manner: &Manner) -> anyhow::Result<End> {
    let Manner { solver, time_limit, json, job, .. } = *manner;
    let patience = Patience::new(time_limit)?;
    let run = RunFile::read(path, solver)?;
    ensure!(
        job.ranks == 1 || run.solver.backend == Backend::Native,
        "several processes evaluate with the solver native; PETSc would solve each candidate on all of them"
    );
    let settings = Meaning::of_search(&run)?;
    agree(job, &settings)?;
    if !job.is_first() {
        let is_over = || patience.is_over();
        serve_candidates(job, &run.candidate_settings()?, Stop::when(&is_over))?;
        return Ok(End::Finished);
    }
    run.solid.iter().try_for_each(SolidSection::check_programs)?;
    let material = run.material.material()?;
    let warnings = [instability(&material), overload(&run, &material)];
    warnings.iter().flatten().for_each(|line| warn(line));
    let threads = Threads::new(manner.threads(&run))?;
    let farm = (job.ranks > 1).then(|| Farm::new(job, &threads));
    let evaluator: &Evaluator<'_> = match &farm {
        Some(farm) => farm,
        None => &threads,
    };
    let mut search = Search::begin(&run, out, settings, *manner, patience)?;
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
    manner.tell(&search.folder.table(&search.nsga2, &search.records)?);
    if let Some(section) = &run.solid
        && search.certify_front(&run, section, &threads)? == End::Stopped
    {
        return Ok(search.stopped(false));
    }
    if json {
        say(&serde_json::to_string_pretty(&search.summary()?)?);
    }
    manner.tell(&search.rejection_summary());
    manner.tell(&format!("figures, front and designs are in {}", out.display()));
    Ok(End::Finished)
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
    /// Tells the user how the search goes.
    fn tell(&self, text: &str) {
        if self.json { narrate(text) } else { say(text) }
    }

    fn threads(&self, run: &RunFile) -> usize {
        if run.solver.backend == Backend::Petsc && self.threads != 1 {
            // PETSc solves one system at a time in a process: more threads would only wait.
            self.tell("petsc evaluates one candidate at a time; native would use every core");
            return 1;
        }
        if self.threads == 0 && self.job.ranks > 1 { 1 } else { self.threads }
    }
}

/// What `--json` prints.
#[derive(Serialize)]
struct Summary<'a> {
    folder: &'a Path,
    candidates: usize,
    core_seconds: f64,
    outcomes: Vec<OutcomeCount>,
    hypervolume: f64,
    front: Vec<FrontPoint>,
    /// Where the front was walked again as solids.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    solid_front: Vec<Row>,
}

/// A run between two generations.
struct Search {
    manner: Manner,
    patience: Patience,
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

impl Search {
    fn begin(
        run: &RunFile,
        out: &Path,
        meaning: Meaning,
        manner: Manner,
        patience: Patience,
    ) -> anyhow::Result<Self> {
        let settings = run.candidate_settings()?;
        let (folder, start) = if manner.resume {
            let folder = RunFolder::open_to_resume(out)?;
            let start = Start::resumed(&folder, run, meaning)?;
            folder.write_settings(run)?;
            manner.tell(&format!(
                "resumed after generation {} of {}",
                start.nsga2.generation(),
                run.evolution.generations
            ));
            (folder, start)
        } else {
            let start = Start::new(run, meaning)?;
            (RunFolder::create(out, run)?, start)
        };
        let Start { nsga2, history, records, found, expected, settings: meaning, builds } = start;
        let digest = meaning.digest();
        let search = Self {
            manner,
            patience,
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
            settings: &self.settings,
            digest: &self.digest,
            folder: &self.folder,
            patience: &self.patience,
        };
        let records = generation.evaluate(evaluator)?;
        let further = &self.settings.fitness.further_objectives;
        let evaluations = records.iter().map(|record| evaluation(record, further));
        self.nsga2.tell(evaluations.collect::<anyhow::Result<_>>()?);
        self.check_expected()?;
        self.folder.append(&records)?;
        self.history.push(self.history_row(&records));
        self.records.extend(records);
        self.folder.save(&self.state())?;
        let generation = self.nsga2.generation();
        let bits = |record: &Record| Known::bits(&record.genome);
        let met: BTreeSet<_> = self.records.iter().map(bits).collect();
        self.found.retain(|r| r.id.generation >= generation || !met.contains(&bits(r)));
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

    /// Says how far the search is; `is_idle` where no candidate has ended since it was begun or resumed.
    fn stopped(&self, is_idle: bool) -> End {
        self.manner.tell(&format!(
            "{} after {} of {} generations; what has ended is saved, and --resume goes on{}",
            self.patience.why(),
            self.nsga2.generation(),
            self.nsga2.settings().generations,
            if is_idle { " (no candidate has ended since: give it more time)" } else { "" }
        ));
        End::Stopped
    }

    fn history_row(&self, records: &[Record]) -> HistoryRow {
        let front = self.nsga2.front();
        let objectives: Vec<&[f64]> =
            front.iter().map(|individual| &individual.evaluation.objectives[..]).collect();
        let best = |k: usize| objectives.iter().map(|o| -o[k]).fold(0.0, f64::max);
        let reference = reference(&self.settings.fitness.further_objectives);
        let row = HistoryRow {
            generation: self.nsga2.generation() - 1,
            evaluated: records.len(),
            feasible: records.iter().filter(|r| matches!(r.outcome, Outcome::Evaluated(_))).count(),
            front: front.len(),
            hypervolume: hypervolume(&objectives, &reference),
            best_bending: best(0),
            best_blocking: best(1),
            spread: self.nsga2.spread(),
        };
        self.manner.tell(&format!(
            "generation {:3} of {}: {:3} of {} feasible, {:2} on the front, best F_c {:.4}, best F_bf {:.5} N/kPa, hypervolume {:.4e}",
            row.generation + 1,
            self.nsga2.settings().generations,
            row.feasible,
            row.evaluated,
            row.front,
            row.best_bending,
            row.best_blocking,
            row.hypervolume
        ));
        row
    }

    /// Computes the members of the front again, with a second mesh too, and writes genome, surface, paths and pictures of each, and
    /// how far they depend on the mesh.
    fn write_front_members(&self, executor: &Threads) -> anyhow::Result<End> {
        let front: Vec<&Individual> = self.nsga2.front();
        let folder = self.folder.file("front");
        if folder.exists() {
            // Members of an earlier front that a resumed run has left behind.
            std::fs::remove_dir_all(&folder).with_context(|| folder.display().to_string())?;
        }
        let bar = progress_bar(self.nsga2.generation(), self.nsga2.generation(), front.len());
        bar.set_message("writing the front");
        let written = executor.evaluate(
            &front,
            &|individual: &&Individual| self.write_member(individual),
            &mut |_, _| {
                bar.inc(1);
                // It begins anew when resumed, so that a time limit would never let it end.
                if self.patience.is_interrupted() { Next::Stop } else { Next::Continue }
            },
        );
        bar.finish_and_clear();
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
        let network = Genome::try_from(individual.genome.clone())?.decode();
        atomic::write(&folder.join("genome.toml"), network.to_toml().as_bytes())?;
        let candidate = evaluate_network(&network, &self.settings)?;
        let (Some(mesh), Some(mut scenarios), Outcome::Evaluated(evaluation)) =
            (candidate.mesh, candidate.scenarios, candidate.outcome)
        else {
            bail!("{} was evaluated before and fails now", individual.id);
        };
        write_surface(&folder, &mesh)?;
        write_scenarios(&folder, ["path", "path_blocked"], &mut scenarios, Some(&mesh))?;
        MeshErrorRow::new(individual.id.to_string(), &network, &self.settings, &evaluation)
    }

    /// Walks the front as solids, and what they promote; writes `solid/` and `front_solid.csv`. What a killed run has walked is taken
    /// from there.
    fn certify_front(
        &self,
        run: &RunFile,
        section: &SolidSection,
        executor: &Threads,
    ) -> anyhow::Result<End> {
        let front: Vec<_> = self.nsga2.front().iter().map(|individual| individual.id).collect();
        let folder = self.folder.file("solid");
        self.manner.tell(&format!("walking the front of {} designs as solids", front.len()));
        let job = Certifying {
            settings: &self.settings,
            section,
            meaning: &Meaning::of_certificates(run, section)?,
            folder: &folder,
            patience: &self.patience,
            tell: &|line| self.manner.tell(line),
        };
        let Some(solid) = SolidFront::new(&front, &self.records, &job, executor)? else {
            return Ok(End::Stopped);
        };
        let SolidFront { rows, of_front, front } = &solid;
        std::fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
        csv::write(&folder.join("certificates.csv"), rows)?;
        self.folder.write_solid_front(front, &self.nsga2, &self.records)?;
        self.manner.tell(&certify::table(rows));
        self.manner.tell(&certify::summary(rows, &section.fidelity));
        self.manner.tell(&format!(
            "{of_front} designs of the front and {} promoted ones make a front of {} solids: front_solid.csv",
            rows.len() - of_front,
            front.len()
        ));
        Ok(End::Finished)
    }

    /// What a program reads of a search that is over.
    fn summary(&self) -> anyhow::Result<Summary<'_>> {
        Ok(Summary {
            folder: self.folder.path(),
            candidates: self.records.len(),
            core_seconds: self.core_seconds(),
            outcomes: outcome_counts(&self.records),
            hypervolume: self.history.last().map_or(0.0, |row| row.hypervolume),
            front: self.folder.front(&self.nsga2, &self.records)?,
            solid_front: self.folder.solid_front()?,
        })
    }

    fn core_seconds(&self) -> f64 {
        self.records.iter().map(|record| record.cpu_seconds.total()).sum()
    }

    fn rejection_summary(&self) -> String {
        let causes: Vec<String> = outcome_counts(&self.records)
            .into_iter()
            .filter(|count| count.rejected)
            .map(|count| format!("{} {}", count.outcome, count.candidates))
            .collect();
        let causes = if causes.is_empty() { "none".to_owned() } else { causes.join(", ") };
        format!(
            "{} candidates in {:.1} core-seconds; rejected: {causes}",
            self.records.len(),
            self.core_seconds()
        )
    }
}

/// Bending and blocking are made large, so that the search minimises their negatives; then what the run asks besides.
pub(crate) fn evaluation(
    record: &Record,
    further: &[FurtherObjective],
) -> anyhow::Result<Evaluation> {
    let evaluated = match &record.outcome {
        Outcome::Evaluated(evaluated) => evaluated,
        rejected @ Outcome::Rejected(_) => {
            return Ok(Evaluation::infeasible(rejected.constraint_violation()));
        }
    };
    let further = further.iter().map(|objective| {
        let value = evaluated.further.get(objective.name);
        let value = value.with_context(|| format!("{} has no {}", record.id, objective.name))?;
        Ok(objective.minimized(*value))
    });
    let pair = [-evaluated.bending, -evaluated.blocking].map(Ok);
    Ok(Evaluation::feasible(pair.into_iter().chain(further).collect::<anyhow::Result<_>>()?))
}

/// Where the hypervolume of a front with these objectives ends.
pub(crate) fn reference(further: &[FurtherObjective]) -> Vec<f64> {
    let further = further.iter().map(|objective| objective.minimized(objective.worst));
    [0.0, 0.0].into_iter().chain(further).collect()
}

pub(crate) fn progress_bar(
    generation: usize,
    generations: usize,
    candidates: usize,
) -> ProgressBar {
    let style =
        ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len} [{elapsed}, {eta} left]");
    let bar = ProgressBar::new(candidates as u64);
    bar.set_style(style.expect("the template is valid"));
    bar.set_message(format!("generation {} of {generations}", generation + 1));
    bar
}
