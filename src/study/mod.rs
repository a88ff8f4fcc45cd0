//! What is a search on disk, and how does it go?
//!
//! A program reads a [`RunFile`], and [`search()`] runs it in a folder until it is done or its
//! [`Limits`] end it; [`Found`] has the front, which [`front()`] reads of a folder. An [`Observer`]
//! is told of each generation; [`scene::Unobserved`](crate::scene::Unobserved) is one that ignores
//! them. The commands read the folder again: they certify, compare, pick, draw, film, export and
//! show what is in it.

pub(crate) mod certificate_row;
pub(crate) mod certify;
pub(crate) mod comparison;
pub(crate) mod deck;
pub(crate) mod design_pictures;
pub(crate) mod evaluations;
pub(crate) mod export;
pub(crate) mod film;
pub(crate) mod front;
pub(crate) mod front_rows;
pub(crate) mod history_row;
pub(crate) mod inherited;
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

pub use self::front::front;
pub use self::history_row::HistoryRow;
pub use self::observer::{Limits, Observer, Unlimited};
pub use self::run_file::RunFile;
pub use self::search::{Found, Manner, Searched, search};
