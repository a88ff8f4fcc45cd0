//! The two ways a file can fail: what was read is wrong, or what was made cannot be written.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// A file that cannot be read or does not hold what was asked for; displays as one line.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub struct InputError {
    /// The file.
    pub path: PathBuf,
    /// The line at fault, from 1, where one can be named.
    pub line: Option<usize>,
    /// What is wrong, without a line break.
    pub what: String,
}

impl InputError {
    /// An error about the whole file.
    #[must_use]
    pub fn new(path: &Path, what: impl Into<String>) -> Self {
        Self { path: path.to_owned(), line: None, what: one_line(&what.into()) }
    }

    /// An error at `line`, counted from 1.
    #[must_use]
    pub fn at_line(path: &Path, line: usize, what: impl Into<String>) -> Self {
        Self { line: Some(line), ..Self::new(path, what) }
    }

    /// An error of the file system while reading.
    #[must_use]
    pub fn unreadable(path: &Path, source: &io::Error) -> Self {
        Self::new(path, reason(source))
    }
}

impl fmt::Display for InputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            Some(line) => write!(f, "{}:{line}: {}", self.path.display(), self.what),
            None => write!(f, "{}: {}", self.path.display(), self.what),
        }
    }
}

/// A file or folder that cannot be written; displays as one line.
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    /// The folder of a new run is already there.
    #[error("output folder {} exists; choose another", .0.display())]
    FolderExists(PathBuf),
    /// The folder of an earlier run is not there.
    #[error("there is no folder {}", .0.display())]
    FolderMissing(PathBuf),
    /// Another process writes into the folder.
    #[error("{} is in use by another process; wait for its end, or choose another folder", .0.display())]
    InUse(PathBuf),
    /// The file system refused.
    #[error("cannot write {}: {}", path.display(), reason(cause))]
    Write {
        /// The file or folder.
        path: PathBuf,
        /// What the file system said; part of the line above, hence no `source`.
        cause: io::Error,
    },
    /// A value has no form in the file's format.
    #[error("cannot write {}: {what}", path.display())]
    Unwritable {
        /// The file.
        path: PathBuf,
        /// Which value and why, without a line break.
        what: String,
    },
}

impl OutputError {
    pub(super) fn write(path: &Path, cause: io::Error) -> Self {
        Self::Write { path: path.to_owned(), cause }
    }

    pub(super) fn unwritable(path: &Path, what: &dyn fmt::Display) -> Self {
        Self::Unwritable { path: path.to_owned(), what: one_line(&what.to_string()) }
    }
}

pub(super) fn one_line(text: &str) -> String {
    text.lines().map(str::trim).filter(|line| !line.is_empty()).collect::<Vec<_>>().join("; ")
}

pub(super) fn reason(source: &io::Error) -> String {
    match source.kind() {
        io::ErrorKind::NotFound => "no such file or folder".to_owned(),
        io::ErrorKind::PermissionDenied => "permission denied".to_owned(),
        io::ErrorKind::IsADirectory => "is a folder, not a file".to_owned(),
        io::ErrorKind::NotADirectory => "a folder of the path is a file".to_owned(),
        io::ErrorKind::AlreadyExists => "is a file, not a folder".to_owned(),
        io::ErrorKind::InvalidData => "is not a text file (UTF-8)".to_owned(),
        _ => one_line(&source.to_string()),
    }
}
