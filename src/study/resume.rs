//! Where a search begins, or goes on: a checkpoint where the records before it are whole, else the first generation.
//!
//! ```text
//! checkpoint after generation G, candidates.jsonl holds all of 0 .. G        -> goes on with generation G
//! anything lost of either                                                    -> all generations again, from what is recorded
//! ```
//!
//! What was evaluated is known: an outcome is a function of its genome, and chance of a generation's number. So the second way takes
//! seconds, evaluates what was lost, and comes to the same bits; where it does not come to the checkpoint that is there, it is
//! refused. Nothing is removed: what is recorded beyond the start waits in `running.jsonl` until its generation comes.

use std::collections::{BTreeMap, BTreeSet};

use anyhow::{bail, ensure};

use super::evaluations::Known;
use super::history_row::HistoryRow;
use super::inherited::{Checkpoint, Nsga2};
use super::meaning::Meaning;
use super::observer::Observer;
use super::run_file::RunFile;
use super::run_folder::{Logged, Record, RunFolder, RunState};
use super::search::{evaluation, reference};
use crate::evolve::IndividualId;
use crate::fitness::FitnessSettings;
use crate::io::provenance::COMMIT;

/// A search between two generations, and what is known beside it.
pub(crate) struct Start {
    pub nsga2: Nsga2,
    pub history: Vec<HistoryRow>,
    /// Of all generations before.
    pub records: Vec<Record>,
    /// Of later ones.
    pub found: Vec<Record>,
    /// To what the records are to lead.
    pub expected: Option<Checkpoint>,
    pub settings: Meaning,
    /// The commits of the programs that took part, in their order.
    pub builds: Vec<String>,
}

impl Start {
    /// The start of a new search.
    pub(crate) fn new(run: &RunFile, settings: Meaning) -> anyhow::Result<Self> {
        let objectives = reference(&run.fitness).len();
        Ok(Self {
            nsga2: Nsga2::new(run.evolution.clone(), run.representation()?, objectives)?,
            history: Vec::new(),
            records: Vec::new(),
            found: Vec::new(),
            expected: None,
            settings,
            builds: vec![COMMIT.to_owned()],
        })
    }

    /// The start of what is left of the search in `folder`, where its logs are put in order.
    ///
    /// # Errors
    /// When it was made with other settings, or its files contradict each other; the folder is then untouched.
    pub(crate) fn resumed(
        folder: &RunFolder,
        run: &RunFile,
        settings: Meaning,
        observer: &dyn Observer,
    ) -> anyhow::Result<Self> {
        let (state, damaged) = folder.load_to_resume()?;
        folder.check_same(run, &settings, state.as_ref(), observer)?;
        let logged = folder.logged()?;
        let kept = state.as_ref().and_then(|state| state.settings.clone());
        check_digests(folder, &logged, &[Some(&settings), kept.as_ref()])?;
        let by_id = by_id(&logged)?;
        let is_fallen_back = state.is_some();
        for line in damaged {
            let instead = if is_fallen_back {
                "the checkpoint before it is used"
            } else {
                "all generations are made again from what is recorded"
            };
            observer.warning(&format!("{line}; {instead}"));
        }
        let mut start = Self::new(run, kept.unwrap_or(settings))?;
        if let Some(RunState { mut search, history, builds, .. }) = state {
            search.settings.generations = run.evolution.generations;
            start.tell_of_builds(folder, builds, observer);
            let nsga2 = Nsga2::resume(search)?;
            agrees(folder, &nsga2, &by_id, &run.fitness)?;
            let lost = ids_before(&nsga2).filter(|id| !by_id.contains_key(id)).count();
            if lost == 0 {
                (start.nsga2, start.history) = (nsga2, history);
            } else {
                observer.warning(&format!(
                    "candidates.jsonl lacks {lost} of the {} candidates up to the checkpoint; they are evaluated again",
                    ids_before(&nsga2).count()
                ));
                start.expected = Some(nsga2.checkpoint());
            }
        }
        for line in &logged.damaged {
            observer
                .warning(&format!("{line}; the damaged file is kept as {}", RunFolder::DAMAGED));
        }
        let before = start.nsga2.generation();
        let is_before = |record: &&Record| record.id.generation < before;
        start.records = by_id.values().copied().filter(is_before).cloned().collect();
        let is_recorded =
            |record: &Record| is_before(&record) && by_id[&record.id].genome == record.genome;
        let mut met = BTreeSet::new();
        let is_new = |record: &&Record| met.insert((record.id, Known::text(&record.genome)));
        let others = logged.all().filter(|record| !is_recorded(record)).filter(is_new);
        start.found = others.cloned().collect();
        folder.put_in_order(&logged, &start.records, &start.found)?;
        Ok(start)
    }

    /// Says when the search was begun by another program.
    fn tell_of_builds(
        &mut self,
        folder: &RunFolder,
        mut builds: Vec<String>,
        observer: &dyn Observer,
    ) {
        if builds.last().is_some_and(|last| last == COMMIT) {
            self.builds = builds;
            return;
        }
        if let Some(last) = builds.last() {
            observer.warning(&format!(
                "{} was made by another build (commit {last}, now {COMMIT}): the same run file may give other digits",
                folder.path().display()
            ));
        }
        builds.push(COMMIT.to_owned());
        self.builds = builds;
    }
}

/// The ids of all candidates before the next generation, in their order.
fn ids_before(nsga2: &Nsga2) -> impl Iterator<Item = IndividualId> {
    let population = nsga2.settings().population;
    (0..nsga2.generation()).flat_map(move |generation| {
        (0..population).map(move |index| IndividualId { generation, index })
    })
}

/// Refuses records that were made with none of these settings.
fn check_digests(
    folder: &RunFolder,
    logged: &Logged,
    settings: &[Option<&Meaning>],
) -> anyhow::Result<()> {
    let digests: Vec<String> = settings.iter().flatten().map(|m| m.digest()).collect();
    let is_foreign =
        |record: &&Record| record.settings.as_ref().is_some_and(|digest| !digests.contains(digest));
    if let Some(record) = logged.all().find(is_foreign) {
        bail!(
            "{} was made with other settings: its record of {} is of another run file; resume it with its own, or choose another folder",
            folder.path().display(),
            record.id
        );
    }
    Ok(())
}

/// The records by their ids; a genome has one outcome.
fn by_id(logged: &Logged) -> anyhow::Result<BTreeMap<IndividualId, &Record>> {
    let mut by_id: BTreeMap<IndividualId, &Record> = BTreeMap::new();
    let mut by_genome: BTreeMap<String, &Record> = BTreeMap::new();
    for record in logged.all() {
        let text = Known::text(&record.genome);
        let twins =
            [by_genome.entry(text).or_insert(record), by_id.entry(record.id).or_insert(record)];
        for twin in twins {
            let same = twin.genome != record.genome || twin.outcome == record.outcome;
            ensure!(
                same,
                "candidates.jsonl and running.jsonl hold two outcomes of one genome, as {} and {}: no search can go on from both",
                twin.id,
                record.id
            );
        }
    }
    Ok(by_id)
}

/// Refuses a checkpoint whose individuals are not those of the records.
fn agrees(
    folder: &RunFolder,
    nsga2: &Nsga2,
    by_id: &BTreeMap<IndividualId, &Record>,
    asked: &FitnessSettings,
) -> anyhow::Result<()> {
    for individual in nsga2.population() {
        let Some(record) = by_id.get(&individual.id) else { continue };
        let is_same = record.genome == individual.genome
            && (!individual.evaluation.is_feasible()
                || evaluation(record, asked)? == individual.evaluation);
        ensure!(
            is_same,
            "{}: candidates.jsonl and the checkpoint after generation {} tell different things of {}; one of them is not of this run",
            folder.path().display(),
            nsga2.generation(),
            individual.id
        );
    }
    Ok(())
}
