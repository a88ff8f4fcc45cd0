//! Files that are there whole or not at all, and the folder of a run.
//!
//! ```text
//! write a hidden neighbour -> fsync it -> rename it over the name -> fsync the folder
//! ```
//!
//! The rename replaces an older file of the same name in one step, as POSIX `rename(2)` promises.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::OutputError;
use super::lock::{self, FolderLock};

/// Writes `bytes` as the file `path`, replacing an older one in one step.
///
/// # Errors
/// [`OutputError::Write`] when the file system refuses; an older file is then untouched.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), OutputError> {
    let temporary = neighbour(path).map_err(|source| OutputError::write(path, source))?;
    let written = write_and_rename(path, &temporary, bytes);
    if written.is_err() {
        // The temporary file may not even exist; the error worth telling is the first one.
        let _ = fs::remove_file(&temporary);
    }
    written.map_err(|source| OutputError::write(path, source))
}

fn write_and_rename(path: &Path, temporary: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = File::create(temporary)?;
    file.write_all(bytes)?;
    file.sync_all()?;
    fs::rename(temporary, path)?;
    sync_folder(path)
}

/// A hidden name beside `path`, of this process alone.
fn neighbour(path: &Path) -> io::Result<PathBuf> {
    let name = path.file_name().ok_or_else(|| io::Error::other("not a file name"))?;
    let hidden = format!(".{}.{}.tmp", name.to_string_lossy(), std::process::id());
    Ok(path.with_file_name(hidden))
}

/// Whether a file of this name is one that [`write()`] had not finished when it was killed.
pub(super) fn is_unfinished(name: &str) -> bool {
    let parts = name.strip_prefix('.').and_then(|name| name.strip_suffix(".tmp")?.rsplit_once('.'));
    parts.is_some_and(|(name, process)| !name.is_empty() && process.parse::<u32>().is_ok())
}

/// Removes from `folder` what killed processes had not finished writing; only its one owner may.
///
/// # Errors
/// [`OutputError::Write`] when the file system refuses.
pub fn clear_unfinished(folder: &Path) -> Result<(), OutputError> {
    let cleared = || -> io::Result<()> {
        for entry in fs::read_dir(folder)? {
            let entry = entry?;
            if is_unfinished(&entry.file_name().to_string_lossy()) {
                fs::remove_file(entry.path())?;
            }
        }
        Ok(())
    };
    cleared().map_err(|source| OutputError::write(folder, source))
}

/// Makes the rename itself survive a power cut.
fn sync_folder(path: &Path) -> io::Result<()> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    if cfg!(unix) { File::open(folder)?.sync_all() } else { Ok(()) }
}

/// Whether `path` is a folder in which a killed run had not begun to write.
fn is_left_empty(path: &Path) -> bool {
    path.is_dir() && lock::is_blank(path).unwrap_or(false)
}

/// The folder that one run writes into.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutputFolder {
    path: PathBuf,
}

impl OutputFolder {
    /// Makes the folder `path` (and its parents) for a new run.
    ///
    /// # Errors
    /// [`OutputError::FolderExists`] when there is already something of that name, so that no run
    /// overwrites another; [`OutputError::Write`] when it cannot be made.
    pub fn create_new(path: &Path) -> Result<Self, OutputError> {
        if let Some(parent) = path.parent() {
            fs::create_dir_all(parent).map_err(|source| OutputError::write(parent, source))?;
        }
        match fs::create_dir(path) {
            Ok(()) => Ok(Self { path: path.to_owned() }),
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
                Err(OutputError::FolderExists(path.to_owned()))
            }
            Err(error) => Err(OutputError::write(path, error)),
        }
    }

    /// As [`Self::create_new`], for long work: what a killed run left empty is taken too, and nobody else may write into the folder
    /// while the lock lasts.
    ///
    /// # Errors
    /// As [`Self::create_new`]; [`OutputError::InUse`] when another process has just made it.
    pub fn claim(path: &Path) -> Result<(Self, FolderLock), OutputError> {
        let folder = match Self::create_new(path) {
            Err(OutputError::FolderExists(_)) if is_left_empty(path) => {
                Self { path: path.to_owned() }
            }
            created => created?,
        };
        let lock = FolderLock::take(path)?;
        // Another may have finished in between.
        if !is_left_empty(path) {
            return Err(OutputError::FolderExists(path.to_owned()));
        }
        clear_unfinished(path)?;
        Ok((folder, lock))
    }

    /// Refuses a `path` that [`Self::claim`] would refuse because it is taken: asked before long work.
    ///
    /// # Errors
    /// [`OutputError::FolderExists`] when there is already something of that name, and it is more than what a killed run left empty.
    pub fn check_unclaimed(path: &Path) -> Result<(), OutputError> {
        if is_left_empty(path) { Ok(()) } else { Self::check_new(path) }
    }

    /// Refuses a `path` that [`Self::create_new`] would refuse because it is taken: asked before long work.
    ///
    /// # Errors
    /// [`OutputError::FolderExists`] when there is already something of that name.
    pub fn check_new(path: &Path) -> Result<(), OutputError> {
        if path.symlink_metadata().is_ok() {
            Err(OutputError::FolderExists(path.to_owned()))
        } else {
            Ok(())
        }
    }

    /// Removes the folder when nothing was written into it.
    pub fn remove_if_empty(&self) {
        // A folder with files in it refuses, and is kept.
        let _ = fs::remove_dir(&self.path);
    }

    /// Gives back what was claimed: the lock, and the folder when nothing was written into it.
    pub fn give_back(&self, lock: FolderLock) {
        lock.remove();
        self.remove_if_empty();
    }

    /// Opens the folder of an earlier run.
    ///
    /// # Errors
    /// [`OutputError::FolderMissing`] when there is no such folder.
    pub fn open(path: &Path) -> Result<Self, OutputError> {
        if path.is_dir() {
            Ok(Self { path: path.to_owned() })
        } else {
            Err(OutputError::FolderMissing(path.to_owned()))
        }
    }

    /// The folder.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The path of `name` inside the folder.
    #[must_use]
    pub fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// The path of a folder inside this one, made when it is not there.
    ///
    /// # Errors
    /// [`OutputError::Write`] when it cannot be made.
    pub fn subfolder(&self, name: &str) -> Result<PathBuf, OutputError> {
        let path = self.path.join(name);
        fs::create_dir_all(&path).map_err(|source| OutputError::write(&path, source))?;
        Ok(path)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn replaces_a_file_and_leaves_no_other() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        write(&path, b"one, the longer").unwrap();
        write(&path, b"two").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"two");
        assert_eq!(names(folder.path()), ["a.txt"]);
    }

    #[test]
    fn a_failed_write_says_where_and_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let missing = folder.path().join("no/a.txt");
        let error = write(&missing, b"x").unwrap_err().to_string();
        assert_eq!(error, format!("cannot write {}: no such file or folder", missing.display()));

        // Renaming a file over a folder fails after the temporary file was written.
        let taken = folder.path().join("taken");
        fs::create_dir(&taken).unwrap();
        assert!(write(&taken, b"x").is_err());
        assert_eq!(names(folder.path()), ["taken"]);
    }

    #[test]
    fn what_a_killed_run_left_empty_is_claimed_by_one() {
        let base = tempfile::tempdir().unwrap();
        let path = base.path().join("run");
        fs::create_dir(&path).unwrap();
        fs::write(path.join(".lock"), "").unwrap();
        fs::write(path.join(".run.toml.4711.tmp"), "half").unwrap();
        OutputFolder::check_unclaimed(&path).unwrap();
        let (folder, lock) = OutputFolder::claim(&path).unwrap();
        assert_eq!(names(&path), [".lock"]);
        assert!(matches!(OutputFolder::claim(&path), Err(OutputError::InUse(_))));
        fs::write(folder.file("run.toml"), "").unwrap();
        drop(lock);
        assert!(matches!(OutputFolder::claim(&path), Err(OutputError::FolderExists(_))));
        assert!(OutputFolder::check_unclaimed(&path).is_err());
        // A file of somebody's that is hidden too is no leftover of ours.
        for name in [".lock.tmp", ".tmp", ".a.b.tmp", ".profile", "a.1.tmp"] {
            assert!(!is_unfinished(name), "{name}");
        }
    }

    #[test]
    fn a_run_never_takes_an_existing_folder() {
        let base = tempfile::tempdir().unwrap();
        let path = base.path().join("runs/first");
        assert_eq!(
            OutputFolder::open(&path).unwrap_err().to_string(),
            format!("there is no folder {}", path.display())
        );
        let folder = OutputFolder::create_new(&path).unwrap();
        assert_eq!(folder.file("a.csv"), path.join("a.csv"));
        assert!(folder.subfolder("designs").unwrap().is_dir());
        assert_eq!(
            OutputFolder::create_new(&path).unwrap_err().to_string(),
            format!("output folder {} exists; choose another", path.display())
        );
        assert!(matches!(OutputFolder::check_new(&path), Err(OutputError::FolderExists(_))));
        assert_eq!(OutputFolder::open(&path).unwrap(), folder);
        let below_a_file = base.path().join("file/run");
        fs::write(base.path().join("file"), "").unwrap();
        assert_eq!(
            OutputFolder::create_new(&below_a_file).unwrap_err().to_string(),
            format!("cannot write {}/file: is a file, not a folder", base.path().display())
        );

        folder.remove_if_empty();
        assert!(path.is_dir(), "the folder `designs` is in it");
        fs::remove_dir(path.join("designs")).unwrap();
        folder.remove_if_empty();
        assert!(OutputFolder::check_new(&path).is_ok());
    }
}
