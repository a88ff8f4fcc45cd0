//! Files: what is read from a person, and what is written so that a killed run leaves nothing half done.
//!
//! Every error of this module displays as one line that names the file.
//! Files are written whole or not at all ([`atomic::write`]); only JSON-lines logs grow in place.

pub mod atomic;
pub mod checkpoint;
pub mod csv;
mod error;
pub mod jsonl;
pub mod stl;
pub mod toml_file;
pub mod vtu;

pub use atomic::OutputFolder;
pub use error::{InputError, OutputError};
