//! `monitor`: a run folder as a web page, while the run goes on or later.
//!
//! It reads the folder alone: a run does not know that it is watched. What is not in the folder, the deformed shapes, is
//! computed when somebody asks for it.

mod overview;
mod shape;

use std::collections::VecDeque;
use std::fs;
use std::net::{IpAddr, SocketAddr};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, SystemTime};

use anyhow::{Context, bail, ensure};
use serde::Serialize;

use self::overview::{Overview, read_records};
use super::run_folder::{Record, RunFolder};
use super::{one_line, say, warn};
use crate::evolve::IndividualId;
use crate::fitness::Outcome;
use crate::genome::{GENES, Genome};
use crate::monitor::{Answer, Refusal, Server, Source, is_built_in};

/// Serves the run in `path` at `address` until the process ends.
pub(super) fn run(path: &Path, address: IpAddr, port: u16) -> anyhow::Result<()> {
    RunFolder::open(path)?;
    let address = SocketAddr::new(address, port);
    let server = Server::bind(address).with_context(|| {
        format!("{address} is not free; choose another with --port, or --port 0 for any")
    })?;
    let address = server.address()?;
    say(&format!("http://{address}/"));
    if !is_built_in() {
        warn("this program was built without its page: run scripts/web, build again");
    }
    if !address.ip().is_loopback() {
        warn(&format!("everybody who reaches {address} may look at {}", path.display()));
    }
    Ok(server.serve(Arc::new(Watched::new(path)))?)
}

/// Shapes that are kept: some 20 MB.
const KEPT: usize = 24;

/// Larger files are not read: a candidate takes 1 kB.
const LARGEST_FILE: u64 = 1 << 30;

/// A run that writes nothing for so long has stopped: a candidate takes seconds.
const SILENCE: Duration = Duration::from_secs(300);

/// A run folder that somebody looks at.
struct Watched {
    path: PathBuf,
    overview: Mutex<Option<(Signature, Arc<[u8]>)>>,
    /// The last shapes asked for, the newest first; whoever computes one holds the lock, so that a page does not take all cores.
    shapes: Mutex<VecDeque<(IndividualId, Arc<[u8]>)>>,
}

/// By which files are known to be the same: lengths, times, and whether the newest is old.
type Signature = (Vec<(u64, Option<SystemTime>)>, bool);

impl Watched {
    fn new(path: &Path) -> Self {
        Self { path: path.to_owned(), overview: Mutex::default(), shapes: Mutex::default() }
    }

    /// Files that change while a run goes on.
    fn signature(&self) -> anyhow::Result<Signature> {
        let names =
            ["run.toml", "candidates.jsonl", "running.jsonl", "front.csv", "front_solid.csv"];
        let mut files = Vec::new();
        for path in names.map(|name| self.path.join(name)).into_iter().chain(self.checkpoints()) {
            let Ok(metadata) = fs::metadata(&path) else {
                files.push((0, None));
                continue;
            };
            ensure!(metadata.len() <= LARGEST_FILE, "{} is too large to be shown", path.display());
            ensure!(metadata.is_file(), "{} is not a file", path.display());
            files.push((metadata.len(), metadata.modified().ok()));
        }
        let newest = files.iter().filter_map(|file| file.1).max();
        let age = newest.and_then(|newest| newest.elapsed().ok()).unwrap_or_default();
        Ok((files, age > SILENCE))
    }

    fn checkpoints(&self) -> Vec<PathBuf> {
        let entries = fs::read_dir(self.path.join("checkpoints")).into_iter().flatten().flatten();
        let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
        paths.sort();
        paths
    }

    fn overview(&self) -> anyhow::Result<Arc<[u8]>> {
        let signature = self.signature()?;
        let mut kept = lock(&self.overview);
        match &*kept {
            Some((of, bytes)) if *of == signature => Ok(bytes.clone()),
            _ => {
                let overview = Overview::read(&self.path, signature.1)?;
                let bytes: Arc<[u8]> = serde_json::to_vec(&overview)?.into();
                *kept = Some((signature, bytes.clone()));
                Ok(bytes)
            }
        }
    }

    /// What was recorded of `id`.
    fn record(&self, id: &str) -> Result<Record, Refusal> {
        let id: IndividualId = id.parse().map_err(|_| {
            Refusal::Unknown("designs are called by generation and index, such as g003-017".into())
        })?;
        self.signature().map_err(|error| failed(&error))?;
        let (records, _) = read_records(&self.path).map_err(|error| failed(&error))?;
        let record = records.into_iter().find(|record| record.id == id);
        record.ok_or_else(|| Refusal::Unknown(format!("there is no {id} in this run yet")))
    }

    fn details(&self, record: Record) -> anyhow::Result<Arc<[u8]>> {
        let solids = RunFolder::open(&self.path)?.certificates()?;
        let name = record.id.to_string();
        let certificate = solids.into_iter().find(|row| row.design == name);
        let genes = GENES.iter().zip(&record.genome);
        let details = serde_json::json!({
            "id": name,
            "genome": genes.map(|(gene, value)| Gene { name: gene.name, value: *value }).collect::<Vec<_>>(),
            "status": if matches!(record.outcome, Outcome::Evaluated(_)) { "evaluated" } else { "rejected" },
            "evaluation": if let Outcome::Evaluated(e) = &record.outcome { Some(e) } else { None },
            "rejection": if let Outcome::Rejected(r) = &record.outcome { Some(r) } else { None },
            "cpu_seconds": record.cpu_seconds,
            "certificate": certificate,
        });
        Ok(serde_json::to_vec(&details)?.into())
    }

    fn computed(&self, record: &Record) -> anyhow::Result<Arc<[u8]>> {
        let run = RunFolder::open(&self.path)?.run_file()?;
        let settings = run.checked()?.candidate_settings()?;
        let network = Genome::try_from(record.genome.clone())?.decode();
        let Some(shape) = shape::computed(&network, settings)? else {
            bail!("{} was evaluated by the run, and is rejected by this program", record.id);
        };
        Ok(serde_json::to_vec(&shape)?.into())
    }
}

impl Source for Watched {
    fn run(&self) -> Answer {
        self.overview().map_err(|error| failed(&error))
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
