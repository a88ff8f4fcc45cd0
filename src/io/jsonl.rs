//! Logs that grow: one JSON value a line, each line on the disk's way as soon as it is appended.
//!
//! A killed run leaves at most one unfinished line, the last: reading leaves it out, opening cuts it off.
//!
//! ```text
//! {"id":"g000-001", ... ,"checksum":"af63dc4c8601ec8c"}      of the line without its last key, as it was first written
//! ```
//!
//! A line that holds another value than was written does not pass. Logs of earlier versions have no checksums, and are read as they
//! are; behind the first line that has one, every line must.

use std::fs::{self, File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::{InputError, OutputError, atomic, checksum, input};

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
        // A pipe would be waited for.
        if path.exists() && !path.is_file() {
            return Err(write(std::io::Error::other("it is not a file")));
        }
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
/// [`InputError`] when the file cannot be read, or a finished line is damaged or does not fit `T`; with the line.
pub fn read<T: DeserializeOwned>(path: &Path) -> Result<Vec<T>, InputError> {
    let (rows, damaged) = read_what_fits(path)?;
    damaged.into_iter().next().map_or(Ok(rows), Err)
}

/// The finished lines of the log `path` that are whole and fit `T`, and what is wrong with each of the others.
///
/// For a log that may be damaged, or not ours at all: [`read`] is for what must be whole.
///
/// # Errors
/// [`InputError`] when the file cannot be read.
pub fn read_what_fits<T: DeserializeOwned>(
    path: &Path,
) -> Result<(Vec<T>, Vec<InputError>), InputError> {
    let bytes = input::bytes(path, input::DATA)?;
    let finished = &bytes[..finished_length(&bytes)];
    let (mut rows, mut damaged) = (Vec::new(), Vec::new());
    let mut wants_checksum = false;
    for (line, number) in finished.split_inclusive(|&byte| byte == b'\n').zip(1..) {
        let parsed = checked(&line[..line.len() - 1], &mut wants_checksum)
            .and_then(|line| serde_json::from_slice(&line).map_err(|error| error.to_string()));
        match parsed {
            Ok(row) => rows.push(row),
            Err(what) => damaged.push(InputError::at_line(path, number, what)),
        }
    }
    Ok((rows, damaged))
}

const KEY: &[u8] = b",\"checksum\":\"";
const DIGITS: usize = 16;
/// Of the key, its value, a quote and a brace.
const TAIL: usize = KEY.len() + DIGITS + 2;

/// A line as it was before its checksum was added.
fn checked(line: &[u8], wants_checksum: &mut bool) -> Result<Vec<u8>, String> {
    let tail = line.len().checked_sub(TAIL).map(|at| line.split_at(at));
    let Some((body, tail)) = tail.filter(|(_, tail)| tail.starts_with(KEY)) else {
        if *wants_checksum {
            return Err("has no checksum, unlike the lines before it".to_owned());
        }
        return Ok(line.to_vec());
    };
    *wants_checksum = true;
    let body = [body, b"}"].concat();
    let expected = checksum::written(&body);
    if &tail[KEY.len()..] == format!("{expected}\"}}").as_bytes() {
        Ok(body)
    } else {
        Err("the checksum does not fit the line".to_owned())
    }
}

fn line<T: Serialize>(row: &T, path: &Path) -> Result<Vec<u8>, OutputError> {
    let mut line = serde_json::to_vec(row).map_err(|e| OutputError::unwritable(path, &e))?;
    if line.ends_with(b"}") && line != b"{}" {
        let checksum = checksum::written(&line);
        line.pop();
        line.extend(KEY);
        line.extend(checksum.bytes());
        line.extend(b"\"}");
    }
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

    /// Opening a pipe to append to it would wait for a reader.
    #[test]
    fn a_log_that_is_no_file_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("history.jsonl");
        let (kind, mode) = (rustix::fs::FileType::Fifo, rustix::fs::Mode::RUSR);
        rustix::fs::mknodat(rustix::fs::CWD, &path, kind, mode, 0).unwrap();
        let error = JsonLog::open(&path).unwrap_err().to_string();
        assert!(error.ends_with("it is not a file"), "{error}");
    }

    #[test]
    fn a_finished_line_that_does_not_fit_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("history.jsonl");
        write(&path, &[row(0)]).unwrap();
        JsonLog::open(&path).unwrap().append(&"not a row").unwrap();
        assert_eq!(read::<Row>(&path).unwrap_err().line, Some(2));
        let (rows, damaged) = read_what_fits::<Row>(&path).unwrap();
        assert_eq!((rows, damaged[0].line), (vec![row(0)], Some(2)));
        write(&path, &[row(7), row(8)]).unwrap();
        assert_eq!(read::<Row>(&path).unwrap(), [row(7), row(8)]);
    }

    /// No byte of a line can be another without being noticed, but for what JSON does not count (blanks are not written).
    #[test]
    fn a_changed_byte_is_named_by_its_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("history.jsonl");
        write(&path, &[row(0), row(1), row(2)]).unwrap();
        let whole = fs::read(&path).unwrap();
        let first = whole.iter().position(|&byte| byte == b'\n').unwrap() + 1;
        let second = whole[first..].iter().position(|&byte| byte == b'\n').unwrap();
        for at in first..first + second {
            let mut bytes = whole.clone();
            bytes[at] ^= 1;
            fs::write(&path, bytes).unwrap();
            let (rows, damaged) = read_what_fits::<Row>(&path).unwrap();
            assert_eq!((rows, damaged[0].line), (vec![row(0), row(2)], Some(2)), "byte {at}");
        }
    }

    #[test]
    fn lines_of_earlier_versions_have_no_checksum() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("history.jsonl");
        let old = "{\"generation\":0,\"hypervolume\":0.3333333333333333}\n";
        fs::write(&path, old).unwrap();
        JsonLog::open(&path).unwrap().append(&row(1)).unwrap();
        assert_eq!(read::<Row>(&path).unwrap(), [row(0), row(1)]);
        let both = fs::read_to_string(&path).unwrap();
        assert!(both.starts_with(old) && both.ends_with("\"}\n"), "{both}");
        fs::write(&path, both + old).unwrap();
        assert_eq!(read::<Row>(&path).unwrap_err().line, Some(3));
    }
}
