//! What a person sees of a run: figures and tables, made from plain numbers.
//!
//! Figures are SVG text, the same bytes for the same numbers; [`png`] and [`pdf`] render one with a built-in font.
//! Nothing here reads or writes a file.

mod canvas;
mod curves;
mod error_figure;
mod error_overview;
mod film;
mod fitted;
mod front;
mod history;
mod literature;
mod merit;
mod outcomes;
mod page;
mod shaded;
mod table;

pub use canvas::{pdf, png};
pub use curves::{DesignCurves, curves_svg};
pub use error_figure::{ErrorCurve, ErrorPoint, error_svg};
pub use error_overview::{JudgedError, OverviewRow, overview_svg};
pub use film::gif_film;
pub use fitted::{FittedCurve, FittedTest, fitted_svg};
pub use front::{Column, FrontPoint, RatedColumns, Reached, axis_label, front_svg, two_fronts_svg};
pub use history::{HistoryPoint, history_svg};
pub use literature::{Published, Set, Technique, best_stiffness, dominated, published};
pub use merit::{merit_svg, standing};
pub use outcomes::{OutcomeCount, outcomes_svg};
pub use page::ReportPage;
pub use shaded::{Camera, Image, Pixels, Rgb};
pub use table::front_table;
