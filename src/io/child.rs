//! A program of others, run so that its hanging, crashing or growing costs nothing but its time.
//!
//! ```text
//! setpriv --pdeathsig KILL  prlimit --as=.. --fsize=.. --core=0  program arguments
//! ```
//!
//! Both wrappers are of util-linux and become the program, so there is one process: the head of a process group of its own.
//! The group is killed when its head has ended or its time is over, so its descendants end with it; one that leaves the group
//! is not found. When this process dies, by whatever signal, the kernel kills the head (not its descendants).

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, WaitId, WaitIdOptions, kill_process_group, waitid};
use serde::{Deserialize, Serialize};

use super::error::one_line;

/// What a program may use.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Limits {
    /// Time by the clock, s.
    pub seconds: f64,
    /// Address space, and the size of each file it writes, MiB.
    pub mebibytes: u64,
}

impl Default for Limits {
    /// Hundredfold what a wall of 10^5 tetrahedra takes TetGen or gmsh, and what is left of 8 GiB beside a solver.
    fn default() -> Self {
        Self { seconds: 120.0, mebibytes: 4096 }
    }
}

/// How a program ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// By itself, with this exit code.
    Exited(i32),
    /// By this signal, not sent from here.
    Signalled(i32),
    /// It was killed at its time limit.
    TimedOut,
}

/// A program that has ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finished {
    /// How it ended.
    pub ending: Ending,
    /// The last lines it wrote to its output or error stream, as one line.
    pub words: String,
}

/// Runs `program` with `arguments` in `folder`, where the file `output.txt` takes what it says; it reads nothing.
///
/// # Errors
/// One line when it could not be started or watched, which is a fault of the machine.
pub fn run(
    program: &str,
    arguments: &[&str],
    folder: &Path,
    limits: &Limits,
) -> Result<Finished, String> {
    if !is_installed(program) {
        return Err(format!("there is no program `{program}`"));
    }
    let output = folder.join("output.txt");
    let failed =
        |error: io::Error| format!("cannot run `{program}`: {}", one_line(&error.to_string()));
    let start = || -> io::Result<Child> {
        let said = File::create(&output)?;
        let bytes = limits.mebibytes << 20;
        Command::new("setpriv")
            .args(["--pdeathsig", "KILL", "prlimit", "--core=0"])
            .args([format!("--as={bytes}"), format!("--fsize={bytes}")])
            .arg(program)
            .args(arguments)
            .current_dir(folder)
            .env("OMP_NUM_THREADS", "1")
            .stdin(Stdio::null())
            .stdout(said.try_clone()?)
            .stderr(said)
            .process_group(0)
            .spawn()
    };
    let child = start().map_err(|error| match error.kind() {
        io::ErrorKind::NotFound => "there is no program `setpriv` (Debian: util-linux)".to_owned(),
        _ => failed(error),
    })?;
    let status = ended(child, Duration::from_secs_f64(limits.seconds)).map_err(failed)?;
    let ending = match status {
        None => Ending::TimedOut,
        Some(status) => match (status.code(), status.signal()) {
            (Some(code), _) => Ending::Exited(code),
            (None, signal) => Ending::Signalled(signal.unwrap_or_default()),
        },
    };
    let words = last_words(&output).map_err(failed)?;
    let is_of_wrapper = WRAPPERS.iter().any(|name| words.starts_with(name));
    if !matches!(ending, Ending::Exited(0)) && is_of_wrapper {
        // The program itself never ran.
        return Err(format!("cannot run `{program}`: {}", one_line(&words)));
    }
    Ok(Finished { ending, words })
}

/// How those that set the limits begin what they complain of.
const WRAPPERS: [&str; 2] = ["setpriv: ", "prlimit: "];

/// Whether `program` is a file, or one of a folder in `PATH`.
#[must_use]
pub fn is_installed(program: &str) -> bool {
    if program.contains('/') {
        return Path::new(program).is_file();
    }
    std::env::var_os("PATH").is_some_and(|path| {
        std::env::split_paths(&path).any(|folder| folder.join(program).is_file())
    })
}

/// The exit status of `child`, or nothing when it had to be killed after `limit`; its group is gone in any case.
fn ended(mut child: Child, limit: Duration) -> io::Result<Option<ExitStatus>> {
    let group = Pid::from_child(&child);
    let deadline = Instant::now() + limit;
    let watched = has_ended(group, deadline);
    // Before the head is waited for: until then its number, which is the group's, cannot pass to another process.
    let killed = kill_process_group(group, Signal::KILL);
    let status = child.wait()?;
    killed?;
    Ok(watched?.then_some(status))
}

/// Whether the process ends before the `deadline`; it is left to be waited for.
fn has_ended(process: Pid, deadline: Instant) -> io::Result<bool> {
    let mut pause = Duration::from_millis(1);
    let ask = WaitIdOptions::EXITED | WaitIdOptions::NOHANG | WaitIdOptions::NOWAIT;
    while waitid(WaitId::Pid(process), ask)?.is_none() {
        let left = deadline.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Ok(false);
        }
        thread::sleep(pause.min(left));
        pause = (pause * 3 / 2).min(LONGEST_PAUSE);
    }
    Ok(true)
}

const LONGEST_PAUSE: Duration = Duration::from_millis(20);

/// How much of the end of what a program said is kept.
const KEPT_BYTES: u64 = 4096;
const KEPT_LINES: usize = 4;

fn last_words(output: &Path) -> io::Result<String> {
    let mut file = File::open(output)?;
    let length = file.metadata()?.len();
    file.seek(SeekFrom::Start(length.saturating_sub(KEPT_BYTES)))?;
    let mut bytes = Vec::new();
    file.take(KEPT_BYTES).read_to_end(&mut bytes)?;
    let text = String::from_utf8_lossy(&bytes);
    let lines: Vec<&str> = text.lines().filter(|line| !line.trim().is_empty()).collect();
    let kept = lines[lines.len().saturating_sub(KEPT_LINES)..].join("\n");
    Ok(one_line(&kept.replace(|c: char| c.is_control() && c != '\n', " ")))
}

#[cfg(test)]
mod tests {
    use std::fs;

    use rustix::process::test_kill_process;

    use super::*;

    const SHORT: Limits = Limits { seconds: 0.3, mebibytes: 256 };
    const LONG: Limits = Limits { seconds: 20.0, ..SHORT };

    fn shell(script: &str, limits: &Limits) -> (Finished, tempfile::TempDir) {
        let folder = tempfile::tempdir().unwrap();
        let finished = run("sh", &["-c", script], folder.path(), limits).unwrap();
        (finished, folder)
    }

    /// Whether the process whose number is in the `file` is gone, now or within 2 s: the kernel clears up at its leisure.
    fn is_gone(file: &Path) -> bool {
        let pid = fs::read_to_string(file).unwrap().trim().parse().unwrap();
        let is_alive = || {
            // A killed process that nobody has waited for yet is a zombie.
            let state = fs::read_to_string(format!("/proc/{pid}/stat")).unwrap_or_default();
            test_kill_process(Pid::from_raw(pid).unwrap()).is_ok() && !state.contains(") Z ")
        };
        (0..100).any(|_| {
            thread::sleep(Duration::from_millis(20));
            !is_alive()
        })
    }

    #[test]
    fn what_a_program_says_last_is_kept() {
        let script = "pwd; seq 1000; echo good >&2; exit 3";
        let (finished, _) = shell(script, &LONG);
        let words = "998; 999; 1000; good".to_owned();
        assert_eq!(finished, Finished { ending: Ending::Exited(3), words });
        let (finished, folder) = shell("pwd", &LONG);
        let folder = folder.path().canonicalize().unwrap();
        assert_eq!(finished.words, folder.to_str().unwrap());
        // It reads nothing, and is not kept waiting for it.
        assert_eq!(
            shell("cat", &LONG).0,
            Finished { ending: Ending::Exited(0), words: String::new() }
        );
    }

    /// The program and a child of its own are killed at the limit, and not long after it.
    #[test]
    fn a_program_that_hangs_ends_with_its_descendants() {
        let start = Instant::now();
        let script = "echo $$ > head; (echo a; sleep 1000) & echo $! > child; wait";
        let (finished, folder) = shell(script, &SHORT);
        assert!(start.elapsed() < Duration::from_secs(10));
        assert_eq!(finished, Finished { ending: Ending::TimedOut, words: "a".to_owned() });
        assert!(is_gone(&folder.path().join("head")));
        assert!(is_gone(&folder.path().join("child")));
    }

    #[test]
    fn what_a_program_leaves_behind_is_ended() {
        let (finished, folder) = shell("sleep 1000 & echo $! > child", &LONG);
        assert_eq!(finished.ending, Ending::Exited(0));
        assert!(is_gone(&folder.path().join("child")));
    }

    #[test]
    fn a_crash_is_a_signal() {
        assert_eq!(shell("kill -SEGV $$", &LONG).0.ending, Ending::Signalled(11));
    }

    /// `tail` keeps a line until it ends, and this one has no end.
    #[test]
    fn memory_and_files_are_limited() {
        let (finished, _) = shell("exec tail /dev/zero", &LONG);
        assert_eq!(finished.ending, Ending::Exited(1));
        assert!(finished.words.contains("memory exhausted"), "{}", finished.words);
        let small = Limits { mebibytes: 16, ..LONG };
        let (finished, folder) = shell("exec head -c 100M /dev/zero > big", &small);
        assert_eq!(finished.ending, Ending::Signalled(Signal::XFSZ.as_raw()));
        assert_eq!(fs::metadata(folder.path().join("big")).unwrap().len(), 16 << 20);
    }

    #[test]
    fn a_program_that_is_not_there_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let error = run("no-such-program", &[], folder.path(), &LONG).unwrap_err();
        assert_eq!(error, "there is no program `no-such-program`");
    }
}
