//! One process at a time in a folder.
//!
//! ```text
//! folder/.lock    flock(2), exclusive: the kernel lets go of it when the process ends, however that was
//! ```
//!
//! The file itself says nothing: one that is left behind hinders nobody. Those who only read take no lock.
//! Network file systems that know no such lock are told of, and the folder is then used without.

use std::fs::{self, File, OpenOptions};
use std::io;
use std::path::{Path, PathBuf};

use rustix::fs::{FlockOperation, flock};
use rustix::io::Errno;

use super::OutputError;
use super::error::reason;

/// The name of the file that is locked.
pub(super) const NAME: &str = ".lock";

/// The right to write into a folder, until it is dropped.
#[derive(Debug)]
pub struct FolderLock {
    path: PathBuf,
    /// Locked as long as it is open.
    _file: File,
    /// Why it keeps nobody out, where the file system knows no locks.
    unguarded: Option<String>,
}

impl FolderLock {
    /// Takes the lock of `folder`.
    ///
    /// # Errors
    /// [`OutputError::InUse`] when another process has it; [`OutputError::Write`] when the file system refuses the file.
    pub fn take(folder: &Path) -> Result<Self, OutputError> {
        let path = folder.join(NAME);
        let write = |source| OutputError::write(&path, source);
        let file = OpenOptions::new()
            .create(true)
            .truncate(false)
            .write(true)
            .open(&path)
            .map_err(write)?;
        let unguarded = match flock(&file, FlockOperation::NonBlockingLockExclusive) {
            Ok(()) => None,
            Err(Errno::WOULDBLOCK) => return Err(OutputError::InUse(folder.to_owned())),
            Err(error) if KNOWS_NO_LOCKS.contains(&error) => Some(reason(&error.into())),
            Err(error) => return Err(write(error.into())),
        };
        Ok(Self { path, _file: file, unguarded })
    }

    /// Why it keeps nobody out, where the file system knows no locks.
    #[must_use]
    pub fn unguarded(&self) -> Option<&str> {
        self.unguarded.as_deref()
    }

    /// Lets go of the lock and takes its file away.
    pub fn remove(self) {
        // It may be gone with its folder.
        let _ = fs::remove_file(&self.path);
    }
}

/// What file systems without locks answer: NFS without a lock daemon, some of FUSE, old Lustre.
const KNOWS_NO_LOCKS: [Errno; 4] = [Errno::NOLCK, Errno::NOTSUP, Errno::NOSYS, Errno::INVAL];

/// Whether nothing but what a killed run leaves behind is in `folder`: its lock, and files that were being written.
pub(super) fn is_blank(folder: &Path) -> io::Result<bool> {
    for entry in fs::read_dir(folder)? {
        let name = entry?.file_name();
        let name = name.to_string_lossy();
        if name != NAME && !super::atomic::is_unfinished(&name) {
            return Ok(false);
        }
    }
    Ok(true)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lock_keeps_others_out_until_it_is_dropped() {
        let folder = tempfile::tempdir().unwrap();
        let lock = FolderLock::take(folder.path()).unwrap();
        assert_eq!(lock.unguarded(), None);
        let refused = FolderLock::take(folder.path()).unwrap_err().to_string();
        let place = folder.path().display();
        assert_eq!(
            refused,
            format!(
                "{place} is in use by another process; wait for its end, or choose another folder"
            )
        );
        drop(lock);
        // The file is still there, as after a kill.
        assert!(folder.path().join(NAME).exists());
        FolderLock::take(folder.path()).unwrap().remove();
        assert!(!folder.path().join(NAME).exists());
        assert!(FolderLock::take(&folder.path().join("none")).is_err());
    }
}
