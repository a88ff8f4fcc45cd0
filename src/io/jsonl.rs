//! Logs that grow: one JSON value a line, each line on the disk's way as soon as it is appended.
//!
//! A killed run leaves at most one unfinished line, the last: reading leaves it out, opening cuts it off.

use std::fs::{self, File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::{InputError, OutputError, atomic, input};

/// A JSON-lines file open for appending.
#[derive(Debug)]
pub struct JsonLog {
    path: PathBuf,
    file: File,
}

impl JsonLog {
    /// Opens or makes the log `path`; an unfinished last line is cut off.
    ///
    /// # Errors
    /// [`OutputError::Write`] when the file system refuses.
    pub fn open(path: &Path) -> Result<Self, OutputError> {
        let write = |source| OutputError::write(path, source);
        let file = OpenOptions::new().create(true).append(true).open(path).map_err(write)?;
        let bytes = fs::read(path).map_err(write)?;
        let finished = finished_length(&bytes);
        if finished < bytes.len() {
            file.set_len(finished as u64).map_err(write)?;
        }
        Ok(Self { path: path.to_owned(), file })
    }

    /// Appends `row` as one line and hands it to the operating system.
    ///
    /// # Errors
    /// [`OutputError`] when the row has no JSON form or the file system refuses.
    pub fn append<T: Serialize>(&mut self, row: &T) -> Result<(), OutputError> {
        let line = line(row, &self.path)?;
        self.file.write_all(&line).map_err(|source| OutputError::write(&self.path, source))
    }

    /// Puts what was appended on the disk, where a power cut leaves it.
    ///
    /// # Errors
    /// [`OutputError::Write`] when the file system refuses.
    pub fn sync(&self) -> Result<(), OutputError> {
        self.file.sync_data().map_err(|source| OutputError::write(&self.path, source))
    }
}

/// Replaces the log `path` by one that holds `rows`, whole or not at all.
///
/// # Errors
/// [`OutputError`] when a row has no JSON form or the file system refuses.
pub fn write<T: Serialize>(path: &Path, rows: &[T]) -> Result<(), OutputError> {
    let mut bytes = Vec::new();
    for row in rows {
        bytes.extend(line(row, path)?);
    }
    atomic::write(path, &bytes)
}

/// The finished lines of the log `path`.
///
/// # Errors
/// [`InputError`] when the file cannot be read, or a finished line does not fit `T`; with the line.
pub fn read<T: DeserializeOwned>(path: &Path) -> Result<Vec<T>, InputError> {
    let bytes = input::bytes(path, input::DATA)?;
    let finished = &bytes[..finished_length(&bytes)];
    let mut rows = Vec::new();
    for (i, line) in finished.split_inclusive(|&byte| byte == b'\n').enumerate() {
        let row = serde_json::from_slice(line)
            .map_err(|error| InputError::at_line(path, i + 1, error.to_string()))?;
        rows.push(row);
    }
    Ok(rows)
}

/// The finished lines of the log `path` that fit `T`, and how many do not.
///
/// For a look at a log that may be damaged, or not ours at all: [`read`] is for what must be whole.
///
/// # Errors
/// [`InputError`] when the file cannot be read.
pub fn read_what_fits<T: DeserializeOwned>(path: &Path) -> Result<(Vec<T>, usize), InputError> {
    let bytes = input::bytes(path, input::DATA)?;
    let finished = &bytes[..finished_length(&bytes)];
    let (mut rows, mut damaged) = (Vec::new(), 0);
    for line in finished.split_inclusive(|&byte| byte == b'\n') {
        match serde_json::from_slice(line) {
            Ok(row) => rows.push(row),
            Err(_) => damaged += 1,
        }
    }
    Ok((rows, damaged))
}

fn line<T: Serialize>(row: &T, path: &Path) -> Result<Vec<u8>, OutputError> {
    let mut line = serde_json::to_vec(row).map_err(|e| OutputError::unwritable(path, &e))?;
    line.push(b'\n');
    Ok(line)
}

fn finished_length(bytes: &[u8]) -> usize {
    bytes.iter().rposition(|&byte| byte == b'\n').map_or(0, |end| end + 1)
}

#[cfg(test)]
mod tests {
    use serde::Deserialize;

    use super::*;

    #[derive(Debug, PartialEq, Serialize, Deserialize)]
    struct Row {
        generation: usize,
        hypervolume: f64,
    }

    fn row(generation: usize) -> Row {
        Row { generation, hypervolume: 1.0 / (generation as f64 + 3.0) }
    }

    #[test]
    fn a_killed_run_loses_only_its_unfinished_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("history.jsonl");
        let mut log = JsonLog::open(&path).unwrap();
        log.append(&row(0)).unwrap();
        log.append(&row(1)).unwrap();
        drop(log);
        let whole = fs::read(&path).unwrap();
        let first = finished_length(&whole[..whole.len() - 1]);
        for cut in first..whole.len() {
            fs::write(&path, &whole[..cut]).unwrap();
            assert_eq!(read::<Row>(&path).unwrap(), [row(0)], "cut at {cut}");
        }
        JsonLog::open(&path).unwrap().append(&row(1)).unwrap();
        assert_eq!(fs::read(&path).unwrap(), whole);
    }

    #[test]
    fn a_finished_line_that_does_not_fit_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("history.jsonl");
        write(&path, &[row(0)]).unwrap();
        JsonLog::open(&path).unwrap().append(&"not a row").unwrap();
        assert_eq!(read::<Row>(&path).unwrap_err().line, Some(2));
        assert_eq!(read_what_fits::<Row>(&path).unwrap(), (vec![row(0)], 1));
        write(&path, &[row(7), row(8)]).unwrap();
        assert_eq!(read::<Row>(&path).unwrap(), [row(7), row(8)]);
    }
}
