//! The one door through which files of a user are read: regular files alone, up to a stated size.
//!
//! A pipe without a writer would hold the program for ever, and a device may have no end: both are refused before a byte is read.

use std::fs::{File, FileType, metadata};
use std::io::Read;
use std::os::unix::fs::FileTypeExt;
use std::path::Path;

use rustix::fs::{Mode, OFlags, open};

use super::InputError;

/// The largest file of settings (scene, run, network), bytes: a thousandfold what a person writes.
pub const SETTINGS: u64 = 16 << 20;

/// The largest file of data (surface, tetrahedra, records, answers), bytes: beyond any part that could be computed.
pub const DATA: u64 = 2 << 30;

/// The bytes of the regular file `path`, no more than `limit` of them.
///
/// # Errors
/// [`InputError`] when it cannot be read, is a folder, a pipe, a socket or a device, or is larger.
pub fn bytes(path: &Path, limit: u64) -> Result<Vec<u8>, InputError> {
    let unreadable = |error| InputError::unreadable(path, &error);
    let is_file = |kind: FileType| match other_kind(kind) {
        Some(kind) => Err(InputError::new(path, format!("is {kind}, not a file"))),
        None => Ok(()),
    };
    is_file(metadata(path).map_err(unreadable)?.file_type())?;
    // What became a pipe since then does not block either.
    let flags = OFlags::RDONLY | OFlags::CLOEXEC | OFlags::NONBLOCK | OFlags::NOCTTY;
    let file = open(path, flags, Mode::empty()).map_err(|error| unreadable(error.into()))?;
    let file = File::from(file);
    let found = file.metadata().map_err(unreadable)?;
    is_file(found.file_type())?;
    let too_large = || {
        let mebibytes = limit >> 20;
        InputError::new(path, format!("is larger than {mebibytes} MiB, the most that is read"))
    };
    if found.len() > limit {
        return Err(too_large());
    }
    // Its length may be unknown (0, of the kernel's own files), or grow.
    let mut bytes = Vec::with_capacity(found.len() as usize);
    file.take(limit + 1).read_to_end(&mut bytes).map_err(unreadable)?;
    if bytes.len() as u64 > limit { Err(too_large()) } else { Ok(bytes) }
}

/// The UTF-8 text of the regular file `path`, no more than `limit` bytes; a byte order mark before it is left out.
///
/// # Errors
/// [`InputError`] as for [`bytes`], and when it is not such a text.
pub fn text(path: &Path, limit: u64) -> Result<String, InputError> {
    let bytes = bytes(path, limit)?;
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return Err(InputError::new(path, "is a text in UTF-16; save it as UTF-8"));
    }
    let text = String::from_utf8(bytes).map_err(|error| {
        let before = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let line = 1 + before.iter().filter(|&&byte| byte == b'\n').count();
        InputError::at_line(path, line, "is not a text in UTF-8")
    })?;
    Ok(text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text))
}

/// What it is, if it is no regular file.
fn other_kind(kind: FileType) -> Option<&'static str> {
    if kind.is_file() {
        None
    } else if kind.is_dir() {
        Some("a folder")
    } else if kind.is_fifo() {
        Some("a pipe")
    } else if kind.is_socket() {
        Some("a socket")
    } else {
        Some("a device")
    }
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::os::unix::net::UnixListener;

    use rustix::fs::{CWD, FileType, mknodat};

    use super::*;

    /// Each is answered at once; opening the pipe would wait for a writer that never comes.
    #[test]
    fn only_regular_files_are_opened() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        mknodat(CWD, path("pipe"), FileType::Fifo, Mode::RUSR, 0).unwrap();
        let _socket = UnixListener::bind(path("socket")).unwrap();
        std::os::unix::fs::symlink(path("pipe"), path("link")).unwrap();
        let what = |path: &Path| bytes(path, SETTINGS).unwrap_err().what;
        assert_eq!(what(&path("pipe")), "is a pipe, not a file");
        assert_eq!(what(&path("link")), "is a pipe, not a file");
        assert_eq!(what(&path("socket")), "is a socket, not a file");
        assert_eq!(what(folder.path()), "is a folder, not a file");
        assert_eq!(what(Path::new("/dev/zero")), "is a device, not a file");
        assert_eq!(what(&path("nothing")), "no such file or folder");
        fs::write(path("file"), "12").unwrap();
        assert_eq!(what(&path("file").join("below")), "a folder of the path is a file");
        assert_eq!(bytes(&path("file"), 2), Ok(b"12".to_vec()));
    }

    /// A hole of 3 GiB takes no room on the disk, and is not read.
    #[test]
    fn files_beyond_the_limit_are_refused_unread() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("large");
        File::create(&path).unwrap().set_len(3 << 30).unwrap();
        let error = bytes(&path, DATA).unwrap_err();
        assert_eq!(error.what, "is larger than 2048 MiB, the most that is read");
    }

    #[test]
    fn texts_are_utf_8_with_or_without_a_mark() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.toml");
        let read = |bytes: &[u8]| {
            fs::write(&path, bytes).unwrap();
            text(&path, SETTINGS)
        };
        assert_eq!(read(b"a = 1").unwrap(), "a = 1");
        assert_eq!(read(b"\xef\xbb\xbfa = 1").unwrap(), "a = 1");
        let latin = read(b"a = 1\n# K\xf6rper").unwrap_err();
        assert_eq!((latin.line, latin.what.as_str()), (Some(2), "is not a text in UTF-8"));
        let wide = read(b"\xff\xfea\0").unwrap_err();
        assert_eq!(wide.what, "is a text in UTF-16; save it as UTF-8");
    }
}
