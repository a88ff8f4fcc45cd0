//! The command line: what was typed, turned into work, and work turned into files and lines.

mod deck;
mod doctor;
mod evolve;
mod export;
mod film;
mod inspect;
mod keys;
mod listener;
mod material;
mod mesh;
#[cfg(feature = "monitor")]
mod monitor;
mod patience;
mod pick;
mod simulate;
mod terminal;
mod walk_progress;

#[cfg(feature = "monitor")]
use std::net::IpAddr;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use clap::error::ErrorKind;
use clap::{Args, CommandFactory, Parser, Subcommand, ValueEnum};
use clap_complete::Shell;

pub use self::inspect::{Input, inspect};
use self::listener::Listener;
use self::patience::Patience;
use self::terminal::{say, warn};
use crate::io::{OutputFolder, atomic};
use crate::mesh::ShellElement;
use crate::scene::deck::Choices;
use crate::scene::error::one_line;
use crate::scene::part::solid_part::SolidSection;
use crate::scene::{End, scene_defaults};
use crate::solve::{Backend, Job};
use crate::study::{Manner, certify, comparison, report, run_file};
use crate::verify::benchmarks::{self, Selection};
use crate::verify::{CURVES, SHELLS, SceneFolder, stability};

/// Designs pneumatic soft actuators by evolution.
#[derive(Debug, Parser)]
#[command(name = "pneumorph", version, about, arg_required_else_help = true)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Search for actuators that bend far and push hard (NSGA-II over network genomes).
    Evolve {
        /// The run file; every key has a default (see --print-defaults).
        #[arg(required_unless_present = "print_defaults")]
        run: Option<PathBuf>,
        /// Folder for the results; must not exist unless --resume is given.
        #[arg(long, required_unless_present = "print_defaults")]
        out: Option<PathBuf>,
        /// Go on with an interrupted run in --out.
        #[arg(long)]
        resume: bool,
        /// Candidates evaluated at once; 0 is one for each core. The results do not depend on it.
        #[arg(long, default_value_t = 0, allow_negative_numbers = true, value_parser = threads)]
        threads: usize,
        /// Stop cleanly after this time: 55m, 1h30m, or as Slurm has it (minutes, MM:SS, HH:MM:SS, D-HH, D-HH:MM:SS). Candidates that
        /// have not ended by then are evaluated later, the exit code is 3, and --resume goes on. Ctrl-C and SIGTERM do the same.
        #[arg(long, value_parser = patience::time_limit)]
        time_limit: Option<Duration>,
        /// The solver, instead of the run file's.
        #[arg(long)]
        solver: Option<SolverName>,
        /// Print what was found as JSON when the search is over; its progress goes to the other stream.
        #[arg(long)]
        json: bool,
        /// Print a run file with all defaults and stop.
        #[arg(long)]
        print_defaults: bool,
    },
    /// Inflate one part and record its path.
    Simulate {
        /// The scene file: a network or an STL mid-surface, its wall, load and planes.
        #[arg(required_unless_present = "print_defaults")]
        scene: Option<PathBuf>,
        /// Folder for the results; must not exist.
        #[arg(long, required_unless_present = "print_defaults")]
        out: Option<PathBuf>,
        /// The solver, instead of the scene's.
        #[arg(long)]
        solver: Option<SolverName>,
        /// Print the summary as JSON instead of words.
        #[arg(long)]
        json: bool,
        /// Threads that share the assembly, 0 for one on each core; the results are the same, the CPU times the first one's.
        #[arg(long, default_value_t = 1, allow_negative_numbers = true, value_parser = threads)]
        threads: usize,
        /// Print a scene file with all defaults and stop.
        #[arg(long)]
        print_defaults: bool,
    },
    /// Make the mid-surface of a network and report its quality.
    Mesh {
        /// The network file.
        network: PathBuf,
        /// Folder for surface.stl, surface.vtu and quality.json; must not exist.
        #[arg(long)]
        out: PathBuf,
        /// Edge length, mm.
        #[arg(long, allow_negative_numbers = true)]
        edge: Option<f64>,
        /// Print the quality as JSON instead of words.
        #[arg(long)]
        json: bool,
    },
    /// Walk designs as shells and as solids, and tell how far they agree.
    Certify {
        /// The run file, with a `solid` section or its defaults.
        #[arg(required_unless_present = "print_defaults")]
        run: Option<PathBuf>,
        /// Network files.
        networks: Vec<PathBuf>,
        /// Instead of files: this many valid designs of the run's first generation.
        #[arg(long, default_value_t = 0)]
        random: usize,
        /// Folder for the results; must not exist unless --resume is given.
        #[arg(long, required_unless_present = "print_defaults")]
        out: Option<PathBuf>,
        /// Go on in --out: designs that have ended there are not walked again.
        #[arg(long)]
        resume: bool,
        /// Stop cleanly after this time, as of `evolve`: the exit code is 3, and --resume goes on.
        #[arg(long, value_parser = patience::time_limit)]
        time_limit: Option<Duration>,
        /// Designs evaluated at once; 0 is one for each core.
        #[arg(long, default_value_t = 0, allow_negative_numbers = true, value_parser = threads)]
        threads: usize,
        /// The solver, instead of the run file's.
        #[arg(long)]
        solver: Option<SolverName>,
        /// Print a run file with all defaults, those of its solids too, and stop.
        #[arg(long)]
        print_defaults: bool,
    },
    /// Write a design for a printer, with an air inlet, and report whether it can be printed.
    Export(export::Export),
    /// Write a solid wall under pressure as input of CalculiX and FEBio, with our own answer to the same case.
    ///
    /// All solve one law, with a bulk modulus, and one mesh of quadratic tetrahedra. Shells are not written: CalculiX expands its
    /// shells to solids.
    Deck {
        /// A run folder, or a scene file of a network, an STL file or tetrahedra.
        source: PathBuf,
        /// Of a run folder: the individual, as g003-017.
        id: Option<String>,
        /// Folder for the decks; must not exist.
        #[arg(long)]
        out: PathBuf,
        /// Of an incompressible rubber, which CalculiX has no cells for [default: 0.49].
        #[arg(long, allow_negative_numbers = true)]
        poisson_ratio: Option<f64>,
        /// Edge length on the wall's faces, mm, instead of the file's.
        #[arg(long, allow_negative_numbers = true)]
        edge: Option<f64>,
        /// The largest pressure, MPa, instead of the file's.
        #[arg(long, allow_negative_numbers = true)]
        pressure: Option<f64>,
        /// In how many equal parts of the pressure answers are compared, instead of the file's steps.
        #[arg(long)]
        samples: Option<usize>,
        /// The solver, instead of the file's.
        #[arg(long)]
        solver: Option<SolverName>,
    },
    /// Compare what CalculiX answered to a deck with our own answer, or the fronts of two runs.
    ///
    /// Of a deck the exit code is 1 where CalculiX' answer is missing or ends early.
    Compare {
        /// The folder of a deck, in which `ccx solid` has run; or of a run.
        folder: PathBuf,
        /// The folder of another run: then both fronts are compared.
        other: Option<PathBuf>,
        /// Of two runs: folder for a figure of both fronts and comparison.json; must not exist.
        #[arg(long, requires = "other")]
        out: Option<PathBuf>,
        /// Print the comparison as JSON instead of words.
        #[arg(long)]
        json: bool,
    },
    /// Compare with published numbers; the exit code is 1 when one is too far.
    #[command(arg_required_else_help = true)]
    Verify {
        #[command(subcommand)]
        what: Verified,
    },
    /// Watch a run in a browser, while it goes on or later: its front, how it grew, and each design in three dimensions.
    ///
    /// From another machine: ssh -L 8737:127.0.0.1:8737 HOST, then http://127.0.0.1:8737/ there.
    #[cfg(feature = "monitor")]
    Monitor {
        /// The folder of a run.
        run: PathBuf,
        /// The port; 0 is any free one.
        #[arg(long, default_value_t = 8737)]
        port: u16,
        /// The address to listen on; others than this machine's own let others look.
        #[arg(long, default_value = "127.0.0.1")]
        listen: IpAddr,
    },
    /// A law of your own rubber from its tests, and the materials that are known by name.
    #[command(arg_required_else_help = true)]
    Material {
        #[command(subcommand)]
        what: material::MaterialCommand,
    },
    /// Film a design while it is inflated, free and against its plane (GIF).
    Film(film::Film),
    /// Pick the design of a run that does most of one thing among those that do enough of others.
    Pick(pick::Pick),
    /// Draw the figures of a run (SVG, PNG, PDF), write it as one page (report.html), and print its front.
    Report {
        /// The folder of a run.
        run: PathBuf,
    },
    /// Look at what this machine has of what the program can use; the exit code is 1 when something is missing.
    Doctor {
        /// Print the findings as JSON instead of words.
        #[arg(long)]
        json: bool,
    },
    /// Print the completions of a shell.
    Completions {
        /// Which shell.
        shell: Shell,
    },
    /// Write the manual pages, and the page of all keys of scene, run and network files.
    Manual {
        /// Folder for them; must not exist.
        #[arg(long)]
        out: PathBuf,
    },
}

#[derive(Debug, Subcommand)]
enum Verified {
    /// Textbook shells on finer and finer meshes: error, order of convergence, CPU time.
    Shells(Benchmarks),
    /// Limit points, snap-back, buckling and follower loads against whole curves: error, order of convergence, CPU time.
    Curves(Benchmarks),
    /// Hard scenes on every solver: ending, snaps, iterations, CPU time.
    Stability {
        /// Only this case; again for each (see --list).
        #[arg(long)]
        case: Vec<String>,
        /// Folder for stability.csv; must not exist.
        #[arg(long)]
        out: Option<PathBuf>,
        /// Print the names of the cases and stop.
        #[arg(long)]
        list: bool,
        /// Only the cases that take a few seconds.
        #[arg(long)]
        quick: bool,
        /// Only this solver.
        #[arg(long)]
        solver: Option<SolverName>,
    },
}

/// Which benchmarks to run, and how.
#[derive(Debug, Args)]
struct Benchmarks {
    /// Only this case; again for each (see --list).
    #[arg(long)]
    case: Vec<String>,
    /// Only this element.
    #[arg(long)]
    element: Option<ElementName>,
    /// Folder for errors.csv, a figure of each case and a summary of all; must not exist.
    #[arg(long)]
    out: Option<PathBuf>,
    /// Print the names of the cases and stop.
    #[arg(long)]
    list: bool,
    /// Only the meshes on which an error is accepted.
    #[arg(long)]
    quick: bool,
    /// The solver.
    #[arg(long, default_value = "native")]
    solver: SolverName,
}

impl Benchmarks {
    fn run(self, folder: &'static SceneFolder) -> anyhow::Result<()> {
        let Self { case, element, out, list, quick, solver } = self;
        if list {
            say_all(&benchmarks::list(folder)?);
            return Ok(());
        }
        let element = element.map(ShellElement::from);
        let selection = Selection { folder, cases: case, element, quick, solver: solver.into() };
        // Its CPU times are those of one thread.
        on_threads(1, || benchmarks::run(&selection, out.as_deref(), &Listener::default()))
    }
}

/// The names of the shell elements on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ElementName {
    /// Loop's subdivision surface.
    Loop,
    /// Flat triangles with normals averaged across edges.
    MidEdge,
}

impl From<ElementName> for ShellElement {
    fn from(name: ElementName) -> Self {
        match name {
            ElementName::Loop => Self::Loop,
            ElementName::MidEdge => Self::MidEdge,
        }
    }
}

/// The names of the solvers on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum SolverName {
    /// Newton in Rust with faer.
    Native,
    /// PETSc's SNES with MUMPS.
    Petsc,
}

impl From<SolverName> for Backend {
    fn from(name: SolverName) -> Self {
        match name {
            SolverName::Native => Self::Native,
            SolverName::Petsc => Self::Petsc,
        }
    }
}

/// Runs the program on the process's arguments; the exit code is 0 when done, 1 when the machine or the input
/// failed, 2 for wrong usage, 3 when it stopped at its time limit or on a signal, with what it had in its folder.
#[must_use]
pub fn run() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(usage) => return answer(&usage),
    };
    let job = match Job::join() {
        Ok(job) => job,
        Err(error) => {
            warn(&one_line(&error.into()));
            return ExitCode::FAILURE;
        }
    };
    match dispatch(arguments.command, job) {
        Ok(code) => code,
        Err(error) => {
            warn(&one_line(&error));
            job.abort();
            ExitCode::FAILURE
        }
    }
}

/// Prints the help that was asked for, or what is wrong with the usage in one line.
fn answer(usage: &clap::Error) -> ExitCode {
    let is_help = matches!(
        usage.kind(),
        ErrorKind::DisplayHelp
            | ErrorKind::DisplayVersion
            | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand
    );
    if is_help {
        // A closed pipe ends the listening.
        let _ = usage.print();
    } else {
        let text = usage.render().to_string();
        let said = text.lines().map(str::trim).take_while(|line| !line.starts_with("Usage:"));
        // A tip how to pass an unknown flag as a value helps nobody: no value of ours begins with a dash.
        let noise = |line: &str| {
            line.is_empty() || line.starts_with("For more") || line.contains("as a value")
        };
        let words: Vec<&str> = said.filter(|line| !noise(line)).collect();
        let line = words.join(" ").replace(" tip: ", "; ");
        warn(&format!("{}; see --help", line.trim_start_matches("error: ")));
    }
    if usage.use_stderr() { ExitCode::from(2) } else { ExitCode::SUCCESS }
}

fn dispatch(command: Command, job: Job) -> anyhow::Result<ExitCode> {
    let is_shared = matches!(
        command,
        Command::Simulate { print_defaults: false, .. }
            | Command::Evolve { print_defaults: false, .. }
    );
    anyhow::ensure!(
        job.ranks == 1 || is_shared,
        "only `simulate` and `evolve` run on several ranks"
    );
    let done = match command {
        Command::Evolve { print_defaults: true, .. } => {
            say(&run_file::defaults(None));
            Ok(())
        }
        Command::Certify { print_defaults: true, .. } => {
            say(&run_file::defaults(Some(SolidSection::default())));
            Ok(())
        }
        Command::Simulate { print_defaults: true, .. } => {
            say(&scene_defaults::defaults());
            Ok(())
        }
        Command::Evolve { run, out, resume, threads, time_limit, solver, json, .. } => {
            let (run, out) = (given(run), given(out));
            let manner = Manner { resume, threads, job };
            let asked = evolve::Asked { solver: solver.map(Backend::from), time_limit, json };
            return Ok(evolve::run(&run, &out, &manner, &asked)?.into());
        }
        Command::Simulate { scene, out, solver, json, threads, .. } => {
            let (scene, out, solver) = (given(scene), given(out), solver.map(Backend::from));
            let simulate = || simulate::run(&scene, &out, solver, json, job);
            return Ok(on_threads(threads, simulate)?.into());
        }
        Command::Certify {
            run,
            networks,
            random,
            out,
            resume,
            time_limit,
            threads,
            solver,
            ..
        } => {
            let (run, out) = (given(run), given(out));
            let request = certify::Request {
                run: &run,
                files: &networks,
                random,
                out: &out,
                resume,
                threads,
                solver: solver.map(Backend::from),
            };
            let patience = Patience::new(time_limit)?;
            return Ok(certify::certify_designs(&request, &patience, &Listener::default())?.into());
        }
        Command::Export(export) => export.run(),
        Command::Mesh { network, out, edge, json } => mesh::run(&network, &out, edge, json),
        Command::Deck { source, id, out, poisson_ratio, edge, pressure, samples, solver } => {
            let solver = solver.map(Backend::from);
            let choices = Choices { poisson_ratio, edge, pressure, samples, solver };
            deck::run(&source, id.as_deref(), &out, &choices)
        }
        Command::Compare { folder, other: Some(other), out, json } => {
            let comparison = comparison::compare([&folder, &other], out.as_deref())?;
            let words = || comparison.in_words(out.as_deref());
            say(&if json { serde_json::to_string_pretty(&comparison)? } else { words() });
            Ok(())
        }
        Command::Compare { folder, other: None, json, .. } => deck::compare(&folder, json),
        Command::Verify { what: Verified::Shells(benchmarks) } => benchmarks.run(&SHELLS),
        Command::Verify { what: Verified::Curves(benchmarks) } => benchmarks.run(&CURVES),
        Command::Verify { what: Verified::Stability { list: true, .. } } => {
            say_all(&stability::list()?);
            Ok(())
        }
        Command::Verify { what: Verified::Stability { case, out, quick, solver, .. } } => {
            let solver = solver.map(Backend::from);
            let selection = stability::Selection { cases: case, solver, quick };
            on_threads(1, || stability::run(&selection, out.as_deref(), &Listener::default()))
        }
        #[cfg(feature = "monitor")]
        Command::Monitor { run, port, listen } => monitor::run(&run, listen, port),
        Command::Material { what } => what.run(),
        Command::Film(film) => film.run(),
        Command::Pick(pick) => pick.run(),
        Command::Report { run } => {
            let reported = report::report(&run, &Listener::default())?;
            say(&reported.table);
            say_all(&reported.written);
            Ok(())
        }
        Command::Doctor { json } => doctor::run(json),
        Command::Completions { shell } => {
            let mut text = Vec::new();
            clap_complete::generate(shell, &mut Arguments::command(), "pneumorph", &mut text);
            say(&String::from_utf8_lossy(&text));
            Ok(())
        }
        Command::Manual { out } => {
            let folder = OutputFolder::create_new(&out)?;
            clap_mangen::generate_to(Arguments::command(), folder.path())?;
            Ok(atomic::write(&folder.file("keys.md"), keys::page().as_bytes())?)
        }
    };
    done.map(|()| ExitCode::SUCCESS)
}

/// The exit code of [`End::Stopped`].
const STOPPED: u8 = 3;

impl From<End> for ExitCode {
    fn from(end: End) -> Self {
        match end {
            End::Finished => Self::SUCCESS,
            End::Stopped => Self::from(STOPPED),
        }
    }
}

fn say_all(lines: &[String]) {
    lines.iter().for_each(|line| say(line));
}

/// Does `work` on this thread, whose parallel loops run on so many threads, itself included.
fn on_threads<Answer: Send>(
    threads: usize,
    work: impl FnOnce() -> anyhow::Result<Answer> + Send,
) -> anyhow::Result<Answer> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).use_current_thread();
    pool.build()?.install(work)
}

fn given(path: Option<PathBuf>) -> PathBuf {
    path.expect("clap demands the path unless defaults are printed")
}

/// More threads than any machine has cores would only take its memory.
const MOST_THREADS: usize = 4096;

fn threads(text: &str) -> Result<usize, String> {
    text.parse()
        .ok()
        .filter(|&threads| threads <= MOST_THREADS)
        .ok_or_else(|| format!("it must be a whole number from 0 to {MOST_THREADS}"))
}
