//! A search as a run file says it, and what its folder holds: how it goes on, ends, is certified, compared and shown.

pub(crate) mod certificate_row;
pub(crate) mod certify;
pub(crate) mod comparison;
pub(crate) mod deck;
pub(crate) mod design_pictures;
pub(crate) mod evaluations;
pub(crate) mod export;
pub(crate) mod film;
pub(crate) mod front_rows;
pub(crate) mod history_row;
pub(crate) mod meaning;
pub(crate) mod mesh_error;
#[cfg(feature = "monitor")]
pub(crate) mod monitor;
mod observer;
pub(crate) mod overload;
pub(crate) mod pick;
pub(crate) mod report;
pub(crate) mod resume;
pub(crate) mod run_file;
pub(crate) mod run_folder;
mod search;
pub(crate) mod solid_front;

pub use self::history_row::HistoryRow;
pub use self::observer::{Limits, Observer, Unlimited};
pub use self::run_file::RunFile;
pub use self::search::{Found, Manner, Searched, search};
