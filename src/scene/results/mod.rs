//! What is written of a walked path: tables, pictures, and how it went.

pub(crate) mod contact_rows;
pub(crate) mod design_folder;
pub(crate) mod path_rows;
pub(crate) mod walk_summary;
