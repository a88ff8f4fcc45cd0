//! A folder to run the program in, and what the program said.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// A temporary folder with a network and the program beside it.
pub(crate) struct Workshop {
    folder: tempfile::TempDir,
}

/// How a run of the program ended.
#[derive(Debug)]
pub(crate) struct Said {
    /// The exit code; -1 after a signal.
    pub code: i32,
    pub out: String,
    pub err: String,
}

impl Workshop {
    /// A folder that holds the published seed as `network.toml`.
    pub(crate) fn new() -> Self {
        let workshop = Self { folder: tempfile::tempdir().unwrap() };
        workshop.write("network.toml", include_str!("../../examples/networks/basic_bend.toml"));
        workshop
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, contents: impl AsRef<[u8]>) {
        fs::write(self.path(name), contents).unwrap();
    }

    pub(crate) fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    pub(crate) fn json(&self, name: &str) -> serde_json::Value {
        serde_json::from_str(&self.read(name)).unwrap()
    }

    /// The values of a table's column of numbers.
    pub(crate) fn column(&self, table: &str, name: &str) -> Vec<f64> {
        let text = self.read(table);
        let mut rows = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
        let header = rows.next().unwrap();
        let place = header.iter().position(|column| *column == name).unwrap();
        rows.map(|row| row[place].parse().unwrap()).collect()
    }

    /// The program in this folder on several processes, not yet started.
    #[cfg(feature = "petsc")]
    pub(crate) fn launched(&self, processes: usize, arguments: &[&str]) -> Command {
        let mut command = Command::new("mpirun");
        command
            .args([
                "--oversubscribe",
                "-n",
                &processes.to_string(),
                env!("CARGO_BIN_EXE_pneumorph"),
            ])
            .args(arguments)
            .current_dir(self.folder.path())
            .envs(
                ["OMPI_ALLOW_RUN_AS_ROOT", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM"]
                    .map(|name| (name, "1")),
            );
        command
    }

    /// The program in this folder, not yet started.
    pub(crate) fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_pneumorph"));
        command
            .args(arguments)
            .current_dir(self.folder.path())
            .env_remove("RUST_BACKTRACE")
            .envs([("OPENBLAS_NUM_THREADS", "1"), ("OMP_NUM_THREADS", "1")])
            .envs([("OMPI_ALLOW_RUN_AS_ROOT", "1"), ("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1")])
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        command
    }

    pub(crate) fn run(&self, arguments: &[&str]) -> Said {
        let output = self.command(arguments).output().unwrap();
        Said {
            code: output.status.code().unwrap_or(-1),
            out: String::from_utf8(output.stdout).unwrap(),
            err: String::from_utf8(output.stderr).unwrap(),
        }
    }

    /// Runs the program, which must succeed without a word on stderr but how far it is; what it printed.
    pub(crate) fn succeed(&self, arguments: &[&str]) -> String {
        let said = self.run(arguments);
        let else_said = said.err.lines().find(|line| !line.starts_with("walking: "));
        assert_eq!((said.code, else_said), (0, None), "{arguments:?}: {said:?}");
        said.out
    }

    /// Runs the program, which must exit with `code` and one line that holds each of `words`, and touch no file.
    pub(crate) fn refuse(&self, arguments: &[&str], code: i32, words: &[&str]) {
        let before = self.files();
        let said = self.run(arguments);
        assert_eq!(said.code, code, "{arguments:?}: {said:?}");
        assert_eq!(said.out, "", "{arguments:?}");
        assert_eq!(said.err.lines().count(), 1, "{arguments:?}: {}", said.err);
        assert!(said.err.starts_with("pneumorph: "), "{}", said.err);
        // Longer lines are not read; the longest of ours names a file with the longest possible name.
        assert!(said.err.len() < 350, "{}", said.err);
        for word in words {
            assert!(said.err.contains(word), "{:?} should contain {word:?}", said.err);
        }
        assert!(self.files() == before, "{arguments:?} touched a file");
    }

    /// Writes `scene` as `scene.toml`, which `simulate` must refuse.
    pub(crate) fn refuse_scene(&self, scene: &str, words: &[&str]) {
        self.write("scene.toml", scene);
        self.refuse(&["simulate", "scene.toml", "--out", "out"], 1, words);
    }

    /// Writes `run` as `run.toml`, which `evolve` must refuse.
    pub(crate) fn refuse_run(&self, run: &str, words: &[&str]) {
        self.write("run.toml", run);
        self.refuse(&["evolve", "run.toml", "--out", "out"], 1, words);
    }

    /// Every file below the folder with its contents; folders have none.
    pub(crate) fn files(&self) -> BTreeMap<PathBuf, Option<Vec<u8>>> {
        let mut files = BTreeMap::new();
        collect(self.folder.path(), &mut files);
        files
    }

    /// A copy of the folder `name`, also named `name`, in a workshop of its own.
    pub(crate) fn copy_of(&self, names: &[&str]) -> Self {
        let copy = Self::new();
        let wanted = |path: &Path| names.iter().any(|name| path.starts_with(self.path(name)));
        for (path, contents) in self.files().into_iter().filter(|(path, _)| wanted(path)) {
            let place = copy.path(path.strip_prefix(self.folder.path()).unwrap().to_str().unwrap());
            match contents {
                Some(contents) => fs::write(place, contents).unwrap(),
                None => fs::create_dir(place).unwrap(),
            }
        }
        copy
    }
}

fn collect(folder: &Path, files: &mut BTreeMap<PathBuf, Option<Vec<u8>>>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files.insert(path.clone(), None);
            collect(&path, files);
        } else {
            let contents = fs::read(&path).unwrap();
            files.insert(path, Some(contents));
        }
    }
}
