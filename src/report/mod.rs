//! What a person sees of a run: figures and tables, made from plain numbers.
//!
//! Figures are SVG text, the same bytes for the same numbers; [`png`] and [`pdf`] render one with a built-in font.
//! Nothing here reads or writes a file.

mod canvas;
mod error_figure;
mod error_overview;
mod front;
mod history;
mod literature;
mod merit;
mod outcomes;
mod page;
mod table;

pub use canvas::{pdf, png};
pub use error_figure::{ErrorCurve, ErrorPoint, error_svg};
pub use error_overview::{JudgedError, OverviewRow, overview_svg};
pub use front::{Column, FrontPoint, front_svg};
pub use history::{HistoryPoint, history_svg};
pub use literature::{Published, Set, Technique, best_stiffness, dominated, published};
pub use merit::{merit_svg, standing};
pub use outcomes::{OutcomeCount, outcomes_svg};
pub use page::ReportPage;
pub use table::front_table;
