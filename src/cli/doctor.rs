//! `doctor`: what the program can use on this machine, and what to do about what it cannot.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::thread::available_parallelism;

use anyhow::ensure;
use serde::Serialize;

use super::terminal::say;
use crate::io::child::is_installed;

/// One thing looked at.
#[derive(Serialize)]
struct Finding {
    what: &'static str,
    state: State,
    found: String,
    /// Empty where nothing is to be done.
    advice: &'static str,
}

#[derive(Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
enum State {
    Good,
    /// Works, but slower or not everywhere.
    Poor,
    /// Some command will refuse.
    Missing,
}

impl Finding {
    fn new(what: &'static str, is_good: bool, found: String, advice: &'static str) -> Self {
        let (state, advice) = if is_good { (State::Good, "") } else { (State::Poor, advice) };
        Self { what, state, found, advice }
    }

    fn program(name: &'static str, arguments: &[&str], advice: &'static str) -> Self {
        if is_installed(name) {
            let found = first_line(name, arguments).unwrap_or_else(|| "installed".to_owned());
            Self { what: name, state: State::Good, found, advice: "" }
        } else {
            Self { what: name, state: State::Missing, found: "not installed".to_owned(), advice }
        }
    }
}

/// Looks, and tells in a table or as JSON.
///
/// # Errors
/// When something is missing without which a command refuses.
pub(super) fn run(json: bool) -> anyhow::Result<()> {
    let findings = findings();
    if json {
        say(&serde_json::to_string_pretty(&findings)?);
    } else {
        say(&table(&findings));
    }
    let missing: Vec<_> =
        findings.iter().filter(|f| f.state == State::Missing).map(|f| f.what).collect();
    ensure!(missing.is_empty(), "not everything is there: {}", missing.join(", "));
    Ok(())
}

fn findings() -> Vec<Finding> {
    let libraries = libraries();
    let mut findings = vec![
        Finding::new(
            "program",
            env!("PNEUMORPH_PROFILE") == "release",
            format!(
                "{} {} ({}, {})",
                env!("CARGO_PKG_VERSION"),
                env!("PNEUMORPH_COMMIT"),
                env!("PNEUMORPH_PROFILE"),
                env!("PNEUMORPH_RUSTC")
            ),
            "build it with --release: searches are several times faster",
        ),
        Finding::new(
            "page",
            has_page(),
            if has_page() { "built in" } else { "not built in" }.to_owned(),
            "for `monitor`: scripts/web, then build again",
        ),
    ];
    findings.extend(petsc(&libraries));
    findings.extend([
        Finding::program(
            "mpirun",
            &["--version"],
            "for several processes: apt-get install openmpi-bin",
        ),
        Finding::program("tetgen", &[], "for solids: apt-get install tetgen"),
        Finding::program("gmsh", &["--version"], "for solids: apt-get install gmsh"),
        calculix(),
        Finding::program("setpriv", &["--version"], "for solids: apt-get install util-linux"),
        Finding::program("prlimit", &["--version"], "for solids: apt-get install util-linux"),
        cores(),
        memory(),
        disk(),
    ]);
    findings
}

/// No command starts it: `deck` writes for it, and `compare` reads what it wrote.
fn calculix() -> Finding {
    let is_there = is_installed("ccx");
    let found = is_there.then(|| first_line("ccx", &["-v"])).flatten();
    let found =
        found.unwrap_or_else(|| if is_there { "installed" } else { "not installed" }.to_owned());
    let advice = "CalculiX, for a second opinion: apt-get install calculix-ccx on Debian 12; Debian 13 has no such package: conda-forge's `calculix`, or its source from www.dhondt.de";
    Finding::new("ccx", is_there, found, advice)
}

fn has_page() -> bool {
    #[cfg(feature = "monitor")]
    let built_in = crate::monitor::is_built_in();
    #[cfg(not(feature = "monitor"))]
    let built_in = false;
    built_in
}

/// PETSc, and the BLAS under it, by the libraries that the system has loaded for this process.
fn petsc(libraries: &[String]) -> Vec<Finding> {
    if !cfg!(feature = "petsc") {
        let advice = "build it with the feature petsc for PETSc, mpirun and large solids";
        return vec![Finding::new("PETSc", false, "not built in".to_owned(), advice)];
    }
    let loaded = |name: &str| libraries.iter().find(|path| path.contains(name)).cloned();
    let blas =
        loaded("openblas").or_else(|| loaded("blas")).unwrap_or_else(|| "unknown".to_owned());
    let threads = ["OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"]
        .map(|name| std::env::var(name).unwrap_or_else(|_| "not set".to_owned()));
    let is_serial = blas.contains("serial") || threads.iter().any(|threads| threads == "1");
    vec![
        Finding::new(
            "PETSc",
            true,
            format!(
                "{}, {}",
                env!("PNEUMORPH_PETSC"),
                loaded("libdmumps").map_or("no MUMPS".to_owned(), |path| format!("with {path}"))
            ),
            "",
        ),
        Finding::new(
            "BLAS",
            blas.contains("openblas"),
            blas,
            "PETSc is 4 to 5 times faster with OpenBLAS: apt-get install libopenblas0-serial",
        ),
        Finding::new(
            "BLAS threads",
            is_serial,
            format!("OPENBLAS_NUM_THREADS {}, OMP_NUM_THREADS {}", threads[0], threads[1]),
            "set both to 1: searches use all cores themselves, and equal bits want one thread",
        ),
    ]
}

fn cores() -> Finding {
    let cores = available_parallelism().map_or(1, std::num::NonZero::get);
    Finding::new("cores", cores > 1, cores.to_string(), "a search uses as many as there are")
}

/// What a search of shells needs for a core, bytes.
const MEMORY_FOR_A_CORE: u64 = 500_000_000;

fn memory() -> Finding {
    let text = fs::read_to_string("/proc/meminfo").unwrap_or_default();
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"));
    let kilobytes = line.and_then(|line| line.split_whitespace().next()?.parse::<u64>().ok());
    let cores = available_parallelism().map_or(1, |cores| cores.get() as u64);
    let bytes = kilobytes.map_or(0, |kilobytes| 1024 * kilobytes);
    Finding::new(
        "free memory",
        bytes >= MEMORY_FOR_A_CORE * cores,
        format!("{:.1} GB", bytes as f64 / 1e9),
        "a shell takes 0.2 GB, a solid of a million unknowns 10 GB; give evolve fewer --threads",
    )
}

/// What a run of 2,400 candidates writes, several times over.
const ROOM_FOR_A_RUN: u64 = 1_000_000_000;

fn disk() -> Finding {
    let found = rustix::fs::statvfs(Path::new("."));
    let bytes = found.map_or(0, |found| found.f_bavail * found.f_frsize);
    Finding::new(
        "free disk here",
        bytes >= ROOM_FOR_A_RUN,
        format!("{:.1} GB", bytes as f64 / 1e9),
        "a run takes some 0.1 GB, its solids more; --out may lie elsewhere",
    )
}

/// The files of the shared libraries of this process, links resolved.
fn libraries() -> Vec<String> {
    let maps = fs::read_to_string("/proc/self/maps").unwrap_or_default();
    let mut paths: Vec<String> = maps
        .lines()
        .filter_map(|line| line.split_whitespace().nth(5))
        .filter(|path| path.contains(".so"))
        .map(str::to_owned)
        .collect();
    paths.sort();
    paths.dedup();
    paths
}

fn first_line(program: &str, arguments: &[&str]) -> Option<String> {
    if arguments.is_empty() {
        return None;
    }
    let said = Command::new(program).args(arguments).output().ok()?;
    // gmsh tells its version where others complain.
    let said = [said.stdout, said.stderr].concat();
    let text = String::from_utf8_lossy(&said).into_owned();
    text.lines().map(str::trim).find(|line| !line.is_empty()).map(str::to_owned)
}

fn table(findings: &[Finding]) -> String {
    let mut text = String::new();
    for Finding { what, state, found, advice } in findings {
        let mark = match state {
            State::Good => "ok",
            State::Poor => "poor",
            State::Missing => "missing",
        };
        text += &format!("{mark:7}  {what:14}  {found}\n");
        if !advice.is_empty() {
            text += &format!("{:25}{advice}\n", "");
        }
    }
    text
}
