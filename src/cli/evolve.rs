//! `evolve`: the search, one generation after the other, each saved before the next begins.

use std::path::Path;
use std::time::{Duration, Instant};

use anyhow::{Context, anyhow, ensure};
use indicatif::{ProgressBar, ProgressStyle};

use super::design_folder::{write_path, write_surface};
use super::evaluations::{Evaluator, Generation, Unfinished, serve_candidates};
use super::material::instability;
use super::run_file::RunFile;
use super::run_folder::{HistoryRow, Record, RunFolder, RunState, outcome_counts};
use super::solid_front::SolidFront;
use super::solid_part::SolidSection;
use super::{certify, say, warn};
use crate::batch::{Executor, Farm, Next, Threads};
use crate::evolve::{Evaluation, Individual, Nsga2, hypervolume};
use crate::fitness::{CandidateSettings, Outcome, evaluate_network};
use crate::genome::Genome;
use crate::io::{atomic, csv};
use crate::solve::{Backend, Job};

/// Both objectives are made large: the search minimises their negatives, which this reference bounds.
const REFERENCE: [f64; 2] = [0.0, 0.0];

/// How a search is run.
#[derive(Clone, Copy, Debug)]
pub(super) struct Manner {
    pub resume: bool,
    /// Of each process; 0 is one for each core, or one where there are several processes.
    pub threads: usize,
    pub solver: Option<Backend>,
    /// After which no candidate is begun.
    pub time_limit: Option<Duration>,
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
    let Manner { resume, solver, time_limit, job, .. } = *manner;
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
    let mut search = Search::begin(&run, out, resume)?;
    while !search.nsga2.is_finished() {
        match search.advance(evaluator, deadline) {
            Ok(()) => {}
            Err(Unfinished::OutOfTime) => return Ok(search.out_of_time()),
            Err(Unfinished::Failed(error)) => return Err(error),
        }
    }
    let table = search.folder.write_results(&search.nsga2, &search.history, &search.records)?;
    search.write_front_members(&threads)?;
    say(&table);
    if let Some(section) = &run.solid {
        if deadline.is_some_and(|deadline| Instant::now() >= deadline) {
            return Ok(search.out_of_time());
        }
        search.certify_front(section, &threads)?;
    }
    say(&search.rejection_summary());
    say(&format!("figures, front and designs are in {}", out.display()));
    Ok(Ending::Finished)
}

impl Manner {
    fn threads(&self, run: &RunFile) -> usize {
        if run.solver.backend == Backend::Petsc && self.threads != 1 {
            // PETSc solves one system at a time in a process: more threads would only wait.
            say("petsc evaluates one candidate at a time; native would use every core");
            return 1;
        }
        if self.threads == 0 && self.job.ranks > 1 { 1 } else { self.threads }
    }
}

/// A run between two generations.
struct Search {
    settings: CandidateSettings,
    nsga2: Nsga2,
    history: Vec<HistoryRow>,
    records: Vec<Record>,
    folder: RunFolder,
}

impl Search {
    fn begin(run: &RunFile, out: &Path, resume: bool) -> anyhow::Result<Self> {
        let settings = run.candidate_settings()?;
        if !resume {
            let nsga2 = Nsga2::new(run.evolution.clone(), run.gene_bounds()?, REFERENCE.len())?;
            let folder = RunFolder::create(out, run)?;
            return Ok(Self { settings, nsga2, history: Vec::new(), records: Vec::new(), folder });
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
            None => (
                Nsga2::new(run.evolution.clone(), run.gene_bounds()?, REFERENCE.len())?,
                Vec::new(),
            ),
        };
        let records = folder.records_to_resume(nsga2.generation())?;
        say(&format!(
            "resumed after generation {} of {}",
            nsga2.generation(),
            run.evolution.generations
        ));
        Ok(Self { settings, nsga2, history, records, folder })
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
        self.nsga2.tell(records.iter().map(evaluation).collect());
        self.folder.append(&records)?;
        self.history.push(self.history_row(&records));
        self.records.extend(records);
        let state = RunState { search: self.nsga2.checkpoint(), history: self.history.clone() };
        self.folder.save(&state)?;
        Ok(self.folder.clear_running()?)
    }

    fn out_of_time(&self) -> Ending {
        say(&format!(
            "the time is over after {} of {} generations; what has ended is saved, and --resume goes on",
            self.nsga2.generation(),
            self.nsga2.settings().generations
        ));
        Ending::OutOfTime
    }

    fn history_row(&self, records: &[Record]) -> HistoryRow {
        let front = self.nsga2.front();
        let objectives: Vec<[f64; 2]> = front
            .iter()
            .map(|individual| {
                [individual.evaluation.objectives[0], individual.evaluation.objectives[1]]
            })
            .collect();
        let best = |k: usize| objectives.iter().map(|o| -o[k]).fold(0.0, f64::max);
        let row = HistoryRow {
            generation: self.nsga2.generation() - 1,
            evaluated: records.len(),
            feasible: records.iter().filter(|r| matches!(r.outcome, Outcome::Evaluated(_))).count(),
            front: front.len(),
            hypervolume: hypervolume(&objectives, REFERENCE),
            best_bending: best(0),
            best_blocking: best(1),
            spread: self.nsga2.spread(),
        };
        say(&format!(
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
        say(&format!("walking the front of {} designs as solids", front.len()));
        let solid =
            SolidFront::new(&front, &self.records, &self.settings, section, &folder, executor)?;
        let SolidFront { rows, of_front, front } = &solid;
        std::fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
        csv::write(&folder.join("certificates.csv"), rows)?;
        self.folder.write_solid_front(front, &self.nsga2, &self.records)?;
        say(&certify::table(rows));
        say(&certify::summary(rows, &section.fidelity));
        say(&format!(
            "{of_front} designs of the front and {} promoted ones make a front of {} solids: front_solid.csv",
            rows.len() - of_front,
            front.len()
        ));
        Ok(())
    }

    fn rejection_summary(&self) -> String {
        let seconds: f64 = self.records.iter().map(|record| record.cpu_seconds.total()).sum();
        let causes: Vec<String> = outcome_counts(&self.records)
            .into_iter()
            .filter(|count| count.rejected)
            .map(|count| format!("{} {}", count.outcome, count.candidates))
            .collect();
        let causes = if causes.is_empty() { "none".to_owned() } else { causes.join(", ") };
        format!(
            "{} candidates in {seconds:.1} core-seconds; rejected: {causes}",
            self.records.len()
        )
    }
}

fn evaluation(record: &Record) -> Evaluation {
    match &record.outcome {
        Outcome::Evaluated(e) => Evaluation::feasible(vec![-e.bending, -e.blocking]),
        rejected @ Outcome::Rejected(_) => Evaluation::infeasible(rejected.constraint_violation()),
    }
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
