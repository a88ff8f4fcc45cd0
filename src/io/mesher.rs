//! What the programs that make tetrahedra have in common: a folder of their own, limits, and ways to fail.

use std::io::Write;
use std::path::Path;

use super::child::{self, Ending, Finished, Limits};
use super::error::reason;
use crate::mesh::tetrahedra::MesherFailure;

/// Runs `program` (of the Debian package `package`) in `folder` to its end.
///
/// # Errors
/// [`MesherFailure`] unless it ends by itself with exit code 0.
pub(super) fn run(
    program: &str,
    package: &str,
    arguments: &[&str],
    folder: &Path,
    limits: &Limits,
) -> Result<(), MesherFailure> {
    if !child::is_installed(program) {
        let what = format!("there is no program `{program}`; install the package {package}");
        return Err(MesherFailure::Machine(what));
    }
    let Finished { ending, words } =
        child::run(program, arguments, folder, limits).map_err(MesherFailure::Machine)?;
    match ending {
        Ending::Exited(0) => Ok(()),
        Ending::TimedOut => Err(MesherFailure::TimedOut { seconds: limits.seconds }),
        _ if tells_of_memory(&words) => {
            Err(MesherFailure::OutOfMemory { mebibytes: limits.mebibytes })
        }
        Ending::Exited(code) => Err(MesherFailure::Refused { code, words }),
        Ending::Signalled(signal) => Err(MesherFailure::Crashed { signal, words }),
    }
}

/// The `answer` of a mesher in `folder`; a failure in a folder into which nothing more can be written is the machine's.
///
/// A program may not notice that its file was cut short, or call it anything: so the folder is tried.
///
/// # Errors
/// [`MesherFailure::Machine`] instead of a failure of its own.
pub(super) fn unless_full<Answer>(
    folder: &Path,
    answer: Result<Answer, MesherFailure>,
) -> Result<Answer, MesherFailure> {
    let failure = match answer {
        Ok(_) | Err(MesherFailure::Machine(_) | MesherFailure::TimedOut { .. }) => return answer,
        Err(failure) => failure,
    };
    let says_so = match &failure {
        MesherFailure::Refused { words, .. } | MesherFailure::Crashed { words, .. } => {
            ["no space left", "disk quota exceeded"]
                .iter()
                .any(|no| words.to_lowercase().contains(no))
        }
        _ => false,
    };
    let full = |why: &str| {
        let what = format!("no room for a mesher's files in {}: {why}", folder.display());
        Err(MesherFailure::Machine(what))
    };
    match takes_bytes(folder) {
        Err(error) => full(&reason(&error)),
        Ok(()) if says_so => full("its disk or quota was full"),
        Ok(()) => Err(failure),
    }
}

/// Tries to write as much as the rest of a mesher's file may have been.
fn takes_bytes(folder: &Path) -> std::io::Result<()> {
    let path = folder.join("room");
    let mut file = std::fs::File::create(&path)?;
    file.write_all(&[0; ROOM])?;
    file.sync_all()?;
    std::fs::remove_file(path)
}

/// Bytes: of the files of some thousand tetrahedra.
const ROOM: usize = 1 << 18;

/// How the C++ library, TetGen and the shell's tools say that there is no more memory.
fn tells_of_memory(words: &str) -> bool {
    let words = words.to_lowercase();
    ["bad_alloc", "out of memory", "memory exhausted", "cannot allocate memory"]
        .iter()
        .any(|phrase| words.contains(phrase))
}

/// A new folder for files of one run; it goes with its last use.
///
/// # Errors
/// [`MesherFailure::Machine`] when the file system refuses.
pub(super) fn folder() -> Result<tempfile::TempDir, MesherFailure> {
    tempfile::Builder::new()
        .prefix("pneumorph-")
        .tempdir()
        .map_err(|error| MesherFailure::Machine(format!("no temporary folder: {}", reason(&error))))
}

/// Writes a file of a mesher's folder.
///
/// # Errors
/// [`MesherFailure::Machine`] when the file system refuses.
pub(super) fn write(path: &Path, text: &str) -> Result<(), MesherFailure> {
    std::fs::write(path, text).map_err(|error| {
        MesherFailure::Machine(format!("cannot write {}: {}", path.display(), reason(&error)))
    })
}

/// The file of a mesher's folder that it was to write.
///
/// # Errors
/// [`MesherFailure::Unreadable`] when there is none.
pub(super) fn read(path: &Path) -> Result<Vec<u8>, MesherFailure> {
    std::fs::read(path).map_err(|error| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        MesherFailure::Unreadable(format!("{name}: {}", reason(&error)))
    })
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::os::unix::fs::PermissionsExt;

    use super::*;
    use crate::io::tetgen::TetGen;
    use crate::mesh::tetrahedra::test_walls::spheres;
    use crate::mesh::tetrahedra::{AttemptFailure, TetSettings, filled_wall};

    /// A full disk is not the wall's fault: not where the program says so, and not where a file ends too early.
    #[test]
    fn a_full_disk_is_a_fault_of_the_machine() {
        let home = tempfile::tempdir().unwrap();
        let refused = || MesherFailure::Refused {
            code: 1,
            words: "wall.1.ele: No space left on device".to_owned(),
        };
        let told = unless_full::<()>(home.path(), Err(refused())).unwrap_err();
        let room = home.path().display();
        assert_eq!(
            told,
            MesherFailure::Machine(format!(
                "no room for a mesher's files in {room}: its disk or quota was full"
            ))
        );
        // A folder that takes nothing, for a file that stops in the middle.
        let gone = home.path().join("gone");
        let cut = || MesherFailure::Unreadable("wall.1.ele: row 7 of 9 cannot be read".to_owned());
        let told = unless_full::<()>(&gone, Err(cut())).unwrap_err();
        assert!(matches!(told, MesherFailure::Machine(_)), "{told}");
        // Where there is room, it is the mesher's failure, and nothing is left behind.
        assert_eq!(unless_full::<()>(home.path(), Err(cut())), Err(cut()));
        assert_eq!(fs::read_dir(home.path()).unwrap().count(), 0);
    }

    /// Each stand-in for a mesher costs its one failure; the true one behind it does the work, and no folder is left.
    #[test]
    fn a_program_that_fails_costs_one_attempt() {
        let crashed = |signal| MesherFailure::Crashed { signal, words: String::new() };
        let unreadable = |what: &str| MesherFailure::Unreadable(what.to_owned());
        let refused = |words: &str| MesherFailure::Refused { code: 4, words: words.to_owned() };
        let no_file = "wall.1.node: no such file or folder";
        let cases = [
            ("sleep 1000 & wait", MesherFailure::TimedOut { seconds: 0.5 }),
            ("kill -SEGV $$", crashed(11)),
            ("kill -KILL $$", crashed(9)),
            ("exec tail /dev/zero", MesherFailure::OutOfMemory { mebibytes: 256 }),
            ("echo a facet is odd; exit 4", refused("a facet is odd")),
            ("", unreadable(no_file)),
            (
                "for f in node ele face; do head -c 5000 /dev/urandom > wall.1.$f; done",
                unreadable("wall.1.node: it does not begin with a count"),
            ),
        ];
        let home = tempfile::tempdir().unwrap();
        for (n, (script, expected)) in cases.into_iter().enumerate() {
            let program = home.path().join(format!("mesher-{n}"));
            fs::write(
                &program,
                format!("#!/bin/sh\npwd > {0}/at-{n}\n{script}\n", home.path().display()),
            )
            .unwrap();
            fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
            // The others have time to start on a busy machine.
            let seconds = if script.starts_with("sleep") { 0.5 } else { 20.0 };
            let limits = Limits { seconds, mebibytes: 256 };
            let stand_in = TetGen { program: program.to_str().unwrap().to_owned(), limits };
            let wall = |_| Ok(spheres(10.0, 8.0, 2));
            let filled =
                filled_wall(&wall, &[&stand_in, &TetGen::default()], &TetSettings::default())
                    .unwrap();
            let failures: Vec<_> = filled.attempts.into_iter().map(|a| a.failure).collect();
            assert_eq!(failures, [Some(AttemptFailure::Mesher(expected)), None], "{script}");
            let folder = fs::read_to_string(home.path().join(format!("at-{n}"))).unwrap();
            assert!(!Path::new(folder.trim()).exists(), "{folder} is left");
        }
    }
}
