//! Who is told how a comparison goes: nothing here prints.

use crate::scene;

/// Is told the table of a comparison as it grows.
pub trait Observer: scene::Observer {
    /// The head of the table, a row, or what is to be said below.
    fn line(&self, line: &str) {
        let _ = line;
    }
}

impl Observer for scene::Unobserved {}
