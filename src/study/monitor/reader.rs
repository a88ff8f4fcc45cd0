//! What is read of a run's folder: once for all who look, on one thread.
//!
//! A large run is some hundred megabytes while it is read. On one thread these are used again for the next look; on as many threads as
//! there are readers each would keep its own.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Sender, channel};
use std::thread;
use std::time::{Duration, SystemTime};

use anyhow::{Context, anyhow, ensure};

use super::overview::{Overview, read_records};
use crate::study::run_folder::Record;

/// Larger files are not read: a candidate takes 1 kB.
const LARGEST_FILE: u64 = 1 << 30;

/// A run that writes nothing for so long has stopped: a candidate takes seconds.
const SILENCE: Duration = Duration::from_secs(300);

/// A thread that reads the folder of a run for whoever asks.
pub(crate) struct Reader {
    questions: Sender<Sender<anyhow::Result<Shared>>>,
}

/// The overview as JSON, and all records.
type Shared = (Arc<[u8]>, Arc<[Record]>);

impl Reader {
    /// Of the run in `path`.
    pub(crate) fn of(path: &Path) -> Self {
        let (questions, asked) = channel::<Sender<_>>();
        let mut folder = Folder { path: path.to_owned(), kept: None };
        thread::spawn(move || {
            for reply in asked {
                // A damaged file may be more than a reader was made for; the next look begins anew.
                let read = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| folder.read()));
                let read = read.unwrap_or_else(|_| Err(anyhow!("the run could not be read")));
                // Who asked may be gone.
                let _ = reply.send(read);
            }
        });
        Self { questions }
    }

    /// The overview as JSON, and all records; read anew only where a file has changed.
    pub(crate) fn read(&self) -> anyhow::Result<Shared> {
        let (reply, answer) = channel();
        self.questions.send(reply).ok().context("the run is not read any more")?;
        answer.recv().context("the run is not read any more")?
    }
}

/// The folder with what was read of it last.
struct Folder {
    path: PathBuf,
    kept: Option<Read>,
}

/// A run as its files had it.
struct Read {
    signature: Signature,
    records: Arc<[Record]>,
    overview: Arc<[u8]>,
}

/// By which files are known to be the same: lengths, times, and whether the newest is old.
type Signature = (Vec<(u64, Option<SystemTime>)>, bool);

impl Folder {
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

    /// The overview as JSON, and all records; read anew only where a file has changed.
    fn read(&mut self) -> anyhow::Result<Shared> {
        let signature = self.signature()?;
        if let Some(Read { overview, records, .. }) =
            self.kept.as_ref().filter(|read| read.signature == signature)
        {
            return Ok((overview.clone(), records.clone()));
        }
        // Not two runs at a time.
        self.kept = None;
        let (records, left_out) = read_records(&self.path)?;
        let overview = Overview::read(&self.path, &records, left_out, signature.1)?;
        let overview: Arc<[u8]> = serde_json::to_vec(&overview)?.into();
        let records: Arc<[Record]> = records.into();
        self.kept = Some(Read { signature, records: records.clone(), overview: overview.clone() });
        Ok((overview, records))
    }
}
