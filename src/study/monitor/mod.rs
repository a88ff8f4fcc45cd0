//! `monitor`: a run folder as a web page, while the run goes on or later.
//!
//! It reads the folder alone: a run does not know that it is watched. What is not in the folder, the deformed shapes, is
//! computed when somebody asks for it.

mod overview;
mod reader;
mod shape;

use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use anyhow::bail;
use serde::Serialize;

use self::reader::Reader;
use crate::evolve::IndividualId;
use crate::fitness::{Objective, Outcome, SCENARIOS};
use crate::monitor::{Answer, Refusal, Source};
use crate::scene::error::one_line;
use crate::study::inherited::named_genes;
use crate::study::run_folder::{Record, RunFolder};

/// Shapes that are kept: some 20 MB.
const KEPT: usize = 24;

/// A run folder that somebody looks at.
pub(crate) struct Watched {
    path: PathBuf,
    reader: Reader,
    /// The last shapes asked for, the newest first; whoever computes one holds the lock, so that a page does not take all cores.
    shapes: Mutex<VecDeque<(IndividualId, Arc<[u8]>)>>,
}

impl Watched {
    /// The run in `path`.
    ///
    /// # Errors
    /// When that is not the folder of a run.
    pub(crate) fn open(path: &Path) -> anyhow::Result<Self> {
        RunFolder::open(path)?;
        Ok(Self { path: path.to_owned(), reader: Reader::of(path), shapes: Mutex::default() })
    }

    /// What was recorded of `id`.
    fn record(&self, id: &str) -> Result<Record, Refusal> {
        let id: IndividualId = id.parse().map_err(|_| {
            Refusal::Unknown("designs are called by generation and index, such as g003-017".into())
        })?;
        let (_, records) = self.reader.read().map_err(|error| failed(&error))?;
        let record = records.iter().find(|record| record.id == id).cloned();
        record.ok_or_else(|| Refusal::Unknown(format!("there is no {id} in this run yet")))
    }

    fn details(&self, record: Record) -> anyhow::Result<Arc<[u8]>> {
        let solids = RunFolder::open(&self.path)?.certificates()?;
        let name = record.id.to_string();
        let certificate = solids.into_iter().find(|row| row.design == name);
        let inherited = RunFolder::open(&self.path)?.run_file()?.representation()?;
        let genes =
            named_genes(&inherited, &record.genome).map(|(name, value)| Gene { name, value });
        let evaluation = match &record.outcome {
            Outcome::Evaluated(evaluation) => Some(evaluation),
            Outcome::Rejected(_) => None,
        };
        let objectives = evaluation.iter().flat_map(|e| e.known()).map(|(objective, _)| objective);
        let scenarios =
            SCENARIOS.iter().filter(|one| evaluation.is_some_and(|e| e.ending(one).is_some()));
        let actions: Vec<&str> = scenarios.map(|scenario| scenario.action).collect();
        let details = serde_json::json!({
            "id": name,
            "genome": genes.collect::<Vec<_>>(),
            "status": if matches!(record.outcome, Outcome::Evaluated(_)) { "evaluated" } else { "rejected" },
            "objectives": objectives.map(Named::of).collect::<Vec<_>>(),
            "actions": actions,
            "evaluation": evaluation,
            "rejection": if let Outcome::Rejected(r) = &record.outcome { Some(r) } else { None },
            "cpu_seconds": record.cpu_seconds,
            "certificate": certificate,
        });
        Ok(serde_json::to_vec(&details)?.into())
    }

    fn computed(&self, record: &Record) -> anyhow::Result<Arc<[u8]>> {
        let run = RunFolder::open(&self.path)?.run_file()?;
        let settings = run.checked()?.candidate_settings()?;
        let network = record.network(&run.representation()?);
        let Some(shape) = shape::computed(&network, settings)? else {
            bail!("{} was evaluated by the run, and is rejected by this program", record.id);
        };
        Ok(serde_json::to_vec(&shape)?.into())
    }
}

impl Source for Watched {
    fn run(&self) -> Answer {
        self.reader.read().map(|(overview, _)| overview).map_err(|error| failed(&error))
    }

    fn design(&self, id: &str) -> Answer {
        self.details(self.record(id)?).map_err(|error| failed(&error))
    }

    fn shape(&self, id: &str) -> Answer {
        let record = self.record(id)?;
        if let Outcome::Rejected(rejected) = &record.outcome {
            return Err(Refusal::Unfit(format!("{} has no shape: {rejected}", record.id)));
        }
        let mut shapes = lock(&self.shapes);
        if let Some((_, bytes)) = shapes.iter().find(|(id, _)| *id == record.id) {
            return Ok(bytes.clone());
        }
        let bytes = self.computed(&record).map_err(|error| failed(&error))?;
        shapes.push_front((record.id, bytes.clone()));
        shapes.truncate(KEPT);
        Ok(bytes)
    }
}

/// What an objective is called.
#[derive(Serialize)]
struct Named {
    name: &'static str,
    symbol: Option<&'static str>,
    unit: &'static str,
}

impl Named {
    fn of(objective: &'static Objective) -> Self {
        let &Objective { name, symbol, unit, .. } = objective;
        Self { name, symbol, unit }
    }
}

/// A gene and its name.
#[derive(Serialize)]
struct Gene<'a> {
    name: &'a str,
    value: f64,
}

fn failed(error: &anyhow::Error) -> Refusal {
    Refusal::Failed(one_line(error))
}

/// What is kept is replaced as a whole, so that a panic leaves nothing half done.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
