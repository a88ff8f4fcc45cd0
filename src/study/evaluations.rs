//! The candidates of a generation become records: looked up, taken from a killed run, or evaluated.
//!
//! A record is on the disk as soon as its candidate has ended, so that a run killed in the middle of a generation loses only what was
//! being computed. A genome met before is not evaluated again: its outcome is a function of it.

use std::collections::{BTreeMap, BTreeSet};
use std::time::{SystemTime, UNIX_EPOCH};

use anyhow::anyhow;
use serde::{Deserialize, Serialize};

use super::inherited::{Candidate, Genome, Inherited};
use super::observer::{Limits, Observer};
use super::run_folder::{Place, Record, RunFolder};
use crate::batch::{Executor, Next, Outcome as Ended, Stopped, serve};
use crate::fitness::{
    Candidate as Evaluation, CandidateSettings, Outcome, StageSeconds, Unevaluated, evaluate_genome,
};
use crate::genome::Representation;
use crate::math::{Reason, Rejected, Room};
use crate::solve::{Job, SolveCounts, Stop};

/// What an evaluation gives.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) enum Evaluated {
    /// How the design did.
    Finished(Box<Finished>),
    /// Nothing: it was stopped before its end.
    Stopped,
    /// Why the machine failed.
    Failed(String),
}

/// What became of a genome, and what that cost.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Finished {
    outcome: Outcome,
    cpu_seconds: StageSeconds,
    counts: SolveCounts,
    place: Option<Place>,
}

/// Evaluates candidates, wherever that is.
pub(crate) type Evaluator<'a> = dyn Executor<Candidate, Evaluated> + 'a;

/// Why there are no records.
pub(crate) enum Unfinished {
    /// The limits ended it; the candidates that have ended, so many, are on the disk.
    Stopped {
        ended: usize,
    },
    Failed(anyhow::Error),
}

impl<E: Into<anyhow::Error>> From<E> for Unfinished {
    fn from(error: E) -> Self {
        Self::Failed(error.into())
    }
}

/// Evaluates what the first process of the `job` sends.
pub(crate) fn serve_candidates(
    job: Job,
    representation: &Inherited,
    settings: &CandidateSettings,
    stop: Stop<'_>,
) -> anyhow::Result<()> {
    let evaluate = |one: &Candidate| evaluate(one, representation, settings, job.rank, stop);
    Ok(serve(&job, &evaluate)?)
}

fn evaluate(
    candidate: &Candidate,
    representation: &Inherited,
    settings: &CandidateSettings,
    rank: usize,
    stop: Stop<'_>,
) -> Evaluated {
    let evaluated = match evaluate_genome(representation, &candidate.genome, settings, stop) {
        Ok(evaluated) => evaluated,
        Err(Unevaluated::Stopped) => return Evaluated::Stopped,
        Err(Unevaluated::Failed(failure)) => return Evaluated::Failed(failure.to_string()),
    };
    let since_1970 = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    let place = Some(Place { rank, ended: since_1970.as_secs_f64() });
    let Evaluation { outcome, seconds: cpu_seconds, counts, .. } = evaluated;
    Evaluated::Finished(Box::new(Finished { outcome, cpu_seconds, counts, place }))
}

/// What is known of genomes, by their text.
#[derive(Default)]
pub(crate) struct Known(BTreeMap<String, Outcome>);

impl Known {
    /// What records have of `genome`, which keeps every bit.
    pub(crate) fn text(genome: &Genome) -> String {
        serde_json::to_string(genome).expect("a record can hold a genome")
    }

    fn of<'a>(records: impl Iterator<Item = &'a Record>) -> Self {
        Self(records.map(|r| (Self::text(&r.genome), r.outcome.clone())).collect())
    }
}

/// The generation that a search is about to evaluate.
pub(crate) struct Generation<'a> {
    pub candidates: &'a [Candidate],
    /// Its number, and how many there will be.
    pub number: usize,
    pub generations: usize,
    /// Of the generations before.
    pub records: &'a [Record],
    /// What an earlier run has recorded beyond them.
    pub found: &'a [Record],
    pub representation: &'a Inherited,
    pub settings: &'a CandidateSettings,
    /// The digest of the run's settings.
    pub digest: &'a str,
    pub folder: &'a RunFolder,
    /// No candidate is begun once they are over, and those that have begun are stopped.
    pub limits: &'a dyn Limits,
    pub observer: &'a dyn Observer,
}

impl Generation<'_> {
    /// The records of the candidates, in their order.
    pub(crate) fn evaluate(&self, evaluator: &Evaluator<'_>) -> Result<Vec<Record>, Unfinished> {
        let is_candidate = |record: &&Record| {
            self.candidates.iter().any(|c| c.id == record.id && c.genome == record.genome)
        };
        let mut own: BTreeMap<_, _> = self
            .found
            .iter()
            .filter(is_candidate)
            .map(|record| (record.id, record.clone()))
            .collect();
        let mut known = Known::of(self.records.iter().chain(self.found));
        let mut fresh = self.fresh(&known);
        self.put_longest_first(&mut fresh);
        for record in self.begun(&fresh, evaluator)? {
            known.0.insert(Known::text(&record.genome), record.outcome.clone());
            own.insert(record.id, record);
        }
        let record = |candidate: &Candidate| {
            own.remove(&candidate.id).unwrap_or_else(|| Record {
                id: candidate.id,
                genome: candidate.genome.clone(),
                outcome: known.0[&Known::text(&candidate.genome)].clone(),
                cpu_seconds: StageSeconds::default(),
                counts: None,
                place: None,
                settings: Some(self.digest.to_owned()),
            })
        };
        Ok(self.candidates.iter().map(record).collect())
    }

    /// The candidates whose genome nobody has met, each once.
    fn fresh(&self, known: &Known) -> Vec<Candidate> {
        let mut met = BTreeSet::new();
        let is_fresh = |candidate: &&Candidate| {
            let text = Known::text(&candidate.genome);
            !known.0.contains_key(&text) && met.insert(text)
        };
        self.candidates.iter().filter(is_fresh).cloned().collect()
    }

    /// Begins with those that may take longest, as what is nearest to them did: at the end of a generation nobody should wait for one
    /// that was begun last.
    fn put_longest_first(&self, fresh: &mut [Candidate]) {
        fresh.sort_by_cached_key(|candidate| {
            let nearest = self.records.iter().min_by(|a, b| {
                let [a, b] = [a, b]
                    .map(|record| self.representation.distance(&record.genome, &candidate.genome));
                a.total_cmp(&b)
            });
            let seconds = nearest.map_or(0.0, |record| record.cpu_seconds.total());
            // Times are positive, and the bits of such numbers rise with them.
            std::cmp::Reverse(seconds.max(0.0).to_bits())
        });
    }

    /// The records of the `fresh` candidates, each on the disk when it has ended; those that were stopped are as if never begun.
    fn begun(
        &self,
        fresh: &[Candidate],
        evaluator: &Evaluator<'_>,
    ) -> Result<Vec<Record>, Unfinished> {
        if fresh.is_empty() {
            return Ok(Vec::new());
        }
        if self.limits.is_over() {
            return Err(Unfinished::Stopped { ended: 0 });
        }
        let mut log = self.folder.running_log()?;
        let work = format!("generation {} of {}", self.number + 1, self.generations);
        let known = self.candidates.len() - fresh.len();
        self.observer.work_begins(&work, known, self.candidates.len());
        let (mut failure, mut records) = (None, Vec::new());
        let mut watch = |index: usize, ended: &Ended<Evaluated>| {
            self.observer.item_done();
            match record(&fresh[index], ended, self.digest) {
                Ok(None) => return Next::Stop,
                Ok(Some(record)) => match log.append(&record) {
                    Ok(()) => records.push(record),
                    Err(error) => failure = Some(error.into()),
                },
                Err(why) => failure = Some(why),
            }
            let ends = failure.is_some() || self.limits.is_over();
            if ends { Next::Stop } else { Next::Continue }
        };
        let (representation, settings) = (self.representation, self.settings);
        let is_over = || self.limits.is_over();
        let stop = Stop::when(&is_over);
        let evaluate = |one: &Candidate| evaluate(one, representation, settings, 0, stop);
        let outcomes = evaluator.evaluate(fresh, &evaluate, &mut watch);
        self.observer.work_ends();
        if let Some(failure) = failure {
            return Err(Unfinished::Failed(failure));
        }
        match outcomes {
            Ok(_) => Ok(records),
            // The last of a generation may end as the time does.
            Err(Stopped::ByObserver) if records.len() == fresh.len() => Ok(records),
            Err(Stopped::ByObserver) => Err(Unfinished::Stopped { ended: records.len() }),
            Err(lost @ Stopped::Lost(_)) => Err(lost.into()),
        }
    }
}

/// What is recorded of a candidate that has ended; nothing where it was stopped.
fn record(
    candidate: &Candidate,
    ended: &Ended<Evaluated>,
    digest: &str,
) -> anyhow::Result<Option<Record>> {
    let finished = match ended {
        Ok(Evaluated::Finished(finished)) => finished.as_ref().clone(),
        Ok(Evaluated::Stopped) => return Ok(None),
        Ok(Evaluated::Failed(failure)) => {
            return Err(anyhow!("{failure}; what has ended is saved"));
        }
        Err(panicked) => Finished {
            outcome: Outcome::Rejected(Rejected::new(
                Room::Genome,
                Reason::ProgramDefect,
                panicked.to_string(),
                f64::MAX,
            )),
            cpu_seconds: StageSeconds::default(),
            counts: SolveCounts::default(),
            place: None,
        },
    };
    let Finished { outcome, cpu_seconds, counts, place } = finished;
    let counts = Some(counts);
    let genome = candidate.genome.clone();
    let settings = Some(digest.to_owned());
    Ok(Some(Record { id: candidate.id, genome, outcome, cpu_seconds, counts, place, settings }))
}
