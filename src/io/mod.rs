//! Files: what is read from a person, and what is written so that a killed run leaves nothing half done.
//!
//! Every error of this module displays as one line that names the file.
//! What a user gives is read through [`input`] alone. Files are written whole or not at all ([`atomic::write`]); only JSON-lines logs grow in place.

pub mod atomic;
pub mod calculix;
pub mod checkpoint;
pub mod checksum;
pub mod child;
pub mod csv;
mod error;
pub mod febio;
pub mod gmsh;
pub mod input;
pub mod jsonl;
mod lock;
mod marks;
mod mesher;
pub mod msh;
mod own_solid;
pub mod part_file;
pub(crate) mod provenance;
mod raw_solid;
mod solid_case;
pub mod stl;
pub mod tetgen;
pub mod three_mf;
pub mod toml_file;
pub mod vtu;
pub mod vtu_solid;
pub mod vtu_surface;
mod xml;

pub use atomic::OutputFolder;
pub use error::{InputError, OutputError};
pub use lock::FolderLock;
pub use marks::GroupKey;
pub use own_solid::{ChamberChoice, ChamberFound, OwnSolid};
pub use solid_case::{LawWithCard, NoCard, SolidCase};
