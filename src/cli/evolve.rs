//! `evolve`: the search, one generation after the other, each saved before the next begins.

use std::path::Path;
use std::time::{Duration, Instant};

use anyhow::{Context, anyhow, ensure};
use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;

use super::certify::Row;
use super::design_folder::{write_path, write_surface};
use super::evaluations::{Evaluator, Generation, Unfinished, serve_candidates};
use super::material::instability;
use super::run_file::RunFile;
use super::run_folder::{HistoryRow, Record, RunFolder, RunState, outcome_counts};
use super::solid_front::SolidFront;
use super::solid_part::SolidSection;
use super::{certify, narrate, say, warn};
use crate::batch::{Executor, Farm, Next, Threads};
use crate::evolve::{Evaluation, Individual, Nsga2, hypervolume};
use crate::fitness::{CandidateSettings, FurtherObjective, Outcome, evaluate_network};
use crate::genome::Genome;
use crate::io::{atomic, csv};
use crate::report::{FrontPoint, OutcomeCount};
use crate::solve::{Backend, Job};

/// How a search is run.
#[derive(Clone, Copy, Debug)]
pub(super) struct Manner {
    pub resume: bool,
    /// Of each process; 0 is one for each core, or one where there are several processes.
    pub threads: usize,
    pub solver: Option<Backend>,
    /// After which no candidate is begun.
    pub time_limit: Option<Duration>,
    /// Whether a program reads the answer.
    pub json: bool,
    pub job: Job,
}

/// How a search ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ending {
    Finished,
    /// What has ended is saved, and `--resume` goes on.
    OutOfTime,
}

/// Runs the search of the run file at `path` in the folder `out`; the processes of the job but the first only evaluate.
pub(super) fn run(path: &Path, out: &Path, manner: &Manner) -> anyhow::Result<Ending> {
    let Manner { solver, time_limit, json, job, .. } = *manner;
    let deadline = time_limit.map(|limit| Instant::now() + limit);
    let run = RunFile::read(path, solver)?;
    ensure!(
        job.ranks == 1 || run.solver.backend == Backend::Native,
        "several processes evaluate with the solver native; PETSc would solve each candidate on all of them"
    );
    if !job.is_first() {
        serve_candidates(job, &run.candidate_settings()?)?;
        return Ok(Ending::Finished);
    }
    run.solid.iter().try_for_each(SolidSection::check_programs)?;
    instability(&run.material.material()?).iter().for_each(|line| warn(line));
    let threads = Threads::new(manner.threads(&run))?;
    let farm = (job.ranks > 1).then(|| Farm::new(job, &threads));
    let evaluator: &Evaluator<'_> = match &farm {
        Some(farm) => farm,
        None => &threads,
    };
    let mut search = Search::begin(&run, out, *manner)?;
    while !search.nsga2.is_finished() {
        match search.advance(evaluator, deadline) {
            Ok(()) => {}
            Err(Unfinished::OutOfTime) => return Ok(search.out_of_time()),
            Err(Unfinished::Failed(error)) => return Err(error),
        }
    }
    let table = search.folder.write_results(&search.nsga2, &search.history, &search.records)?;
    search.write_front_members(&threads)?;
    manner.tell(&table);
    if let Some(section) = &run.solid {
        if deadline.is_some_and(|deadline| Instant::now() >= deadline) {
            return Ok(search.out_of_time());
        }
        search.certify_front(section, &threads)?;
    }
    if json {
        say(&serde_json::to_string_pretty(&search.summary()?)?);
    }
    manner.tell(&search.rejection_summary());
    manner.tell(&format!("figures, front and designs are in {}", out.display()));
    Ok(Ending::Finished)
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
    settings: CandidateSettings,
    nsga2: Nsga2,
    history: Vec<HistoryRow>,
    records: Vec<Record>,
    folder: RunFolder,
}

impl Search {
    fn begin(run: &RunFile, out: &Path, manner: Manner) -> anyhow::Result<Self> {
        let settings = run.candidate_settings()?;
        let objectives = reference(&settings.fitness.further_objectives).len();
        if !manner.resume {
            let nsga2 = Nsga2::new(run.evolution.clone(), run.gene_bounds()?, objectives)?;
            let folder = RunFolder::create(out, run)?;
            let (history, records) = (Vec::new(), Vec::new());
            return Ok(Self { manner, settings, nsga2, history, records, folder });
        }
        let folder = RunFolder::open(out)?;
        folder.check_same(run)?;
        folder.write_settings(run)?;
        let (state, damaged) = folder.load()?;
        for line in damaged {
            warn(&format!("{line}; the checkpoint before it is used"));
        }
        let (nsga2, history) = match state {
            Some(mut state) => {
                state.search.settings.generations = run.evolution.generations;
                (Nsga2::resume(state.search)?, state.history)
            }
            None => {
                (Nsga2::new(run.evolution.clone(), run.gene_bounds()?, objectives)?, Vec::new())
            }
        };
        let records = folder.records_to_resume(nsga2.generation())?;
        manner.tell(&format!(
            "resumed after generation {} of {}",
            nsga2.generation(),
            run.evolution.generations
        ));
        Ok(Self { manner, settings, nsga2, history, records, folder })
    }

    fn advance(
        &mut self,
        evaluator: &Evaluator<'_>,
        deadline: Option<Instant>,
    ) -> Result<(), Unfinished> {
        let candidates = self.nsga2.ask();
        let generation = Generation {
            candidates: &candidates,
            number: self.nsga2.generation(),
            generations: self.nsga2.settings().generations,
            records: &self.records,
            settings: &self.settings,
            folder: &self.folder,
            deadline,
        };
        let records = generation.evaluate(evaluator)?;
        let further = &self.settings.fitness.further_objectives;
        let evaluations = records.iter().map(|record| evaluation(record, further));
        self.nsga2.tell(evaluations.collect::<anyhow::Result<_>>()?);
        self.folder.append(&records)?;
        self.history.push(self.history_row(&records));
        self.records.extend(records);
        let state = RunState { search: self.nsga2.checkpoint(), history: self.history.clone() };
        self.folder.save(&state)?;
        Ok(self.folder.clear_running()?)
    }

    fn out_of_time(&self) -> Ending {
        self.manner.tell(&format!(
            "the time is over after {} of {} generations; what has ended is saved, and --resume goes on",
            self.nsga2.generation(),
            self.nsga2.settings().generations
        ));
        Ending::OutOfTime
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

    /// Computes the members of the front again and writes genome, surface, paths and pictures of each.
    fn write_front_members(&self, executor: &Threads) -> anyhow::Result<()> {
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
                Next::Continue
            },
        );
        bar.finish_and_clear();
        for outcome in written.map_err(|_| anyhow!("the front was not written"))? {
            outcome??;
        }
        Ok(())
    }

    fn write_member(&self, individual: &Individual) -> anyhow::Result<()> {
        let folder = self.folder.path().join("front").join(individual.id.to_string());
        std::fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
        let network = Genome::try_from(individual.genome.clone())?.decode();
        atomic::write(&folder.join("genome.toml"), network.to_toml().as_bytes())?;
        let candidate = evaluate_network(&network, &self.settings)?;
        let (Some(mesh), Some(scenarios)) = (candidate.mesh, candidate.scenarios) else {
            anyhow::bail!("{} was evaluated before and fails now", individual.id);
        };
        write_surface(&folder, &mesh)?;
        let model = &scenarios.model;
        write_path(&folder, "path", &mesh, model, &scenarios.free.points, &scenarios.free_rows)?;
        let (points, rows) = (&scenarios.blocked.points, &scenarios.blocked_rows);
        write_path(&folder, "path_blocked", &mesh, model, points, rows)?;
        Ok(())
    }

    /// Walks the front as solids, and what they promote; writes `solid/` and `front_solid.csv`. What a killed run has walked is taken
    /// from there.
    fn certify_front(&self, section: &SolidSection, executor: &Threads) -> anyhow::Result<()> {
        let front: Vec<_> = self.nsga2.front().iter().map(|individual| individual.id).collect();
        let folder = self.folder.file("solid");
        self.manner.tell(&format!("walking the front of {} designs as solids", front.len()));
        let solid =
            SolidFront::new(&front, &self.records, &self.settings, section, &folder, executor)?;
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
        Ok(())
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
fn evaluation(record: &Record, further: &[FurtherObjective]) -> anyhow::Result<Evaluation> {
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
fn reference(further: &[FurtherObjective]) -> Vec<f64> {
    let further = further.iter().map(|objective| objective.minimized(objective.worst));
    [0.0, 0.0].into_iter().chain(further).collect()
}

pub(super) fn progress_bar(
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
