//! Where a result came from: program, commit, libraries, command.

use serde::Serialize;

use crate::model::block::instruction_set;

/// The commit of this program.
pub(crate) const COMMIT: &str = env!("PNEUMORPH_COMMIT");

/// What a run folder tells about the program that made it.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Provenance {
    program: &'static str,
    version: &'static str,
    commit: &'static str,
    rustc: &'static str,
    target: &'static str,
    profile: &'static str,
    petsc: &'static str,
    /// With which instructions this processor runs the elements' kernels: the last bits of results depend on them.
    instructions: &'static str,
    /// The words of the command line.
    command: Vec<String>,
}

impl Provenance {
    /// Of this process.
    pub(crate) fn of_this_process() -> Self {
        Self {
            program: env!("CARGO_PKG_NAME"),
            version: env!("CARGO_PKG_VERSION"),
            commit: COMMIT,
            rustc: env!("PNEUMORPH_RUSTC"),
            target: env!("PNEUMORPH_TARGET"),
            profile: env!("PNEUMORPH_PROFILE"),
            petsc: env!("PNEUMORPH_PETSC"),
            instructions: instruction_set(),
            command: std::env::args().collect(),
        }
    }
}
