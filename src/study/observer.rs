//! Who is told how a search goes, and what may end it: nothing here prints or listens.

use super::history_row::HistoryRow;
use crate::scene;

/// Is told what happens while a search goes on; a method that is not written ignores it.
pub trait Observer: scene::Observer {
    /// A line that says how the work goes.
    fn note(&self, line: &str) {
        let _ = line;
    }

    /// A table of results: its head, then a line for each row.
    fn table(&self, table: &str) {
        let _ = table;
    }

    /// A generation, of so many, was evaluated.
    fn generation(&self, row: &HistoryRow, generations: usize) {
        let _ = (row, generations);
    }

    /// The work `name` on `total` items begins, of which `done` are done already.
    fn work_begins(&self, name: &str, done: usize, total: usize) {
        let _ = (name, done, total);
    }

    /// One more item of the work is done.
    fn item_done(&self) {}

    /// The work that began last is over, done or not.
    fn work_ends(&self) {}
}

impl Observer for scene::Unobserved {}

/// What may end a search before it is done; asked again and again, by every thread.
pub trait Limits: Sync {
    /// Whether it is to stop now: its time is over, or somebody asked.
    fn is_over(&self) -> bool {
        self.is_interrupted()
    }

    /// Whether somebody asked it to stop. The writing of results ends for that alone, not for the
    /// time: it begins anew where a search goes on, and a time limit would never let it end.
    fn is_interrupted(&self) -> bool {
        false
    }

    /// Why it is over, as a sentence begins.
    fn why(&self) -> &'static str {
        if self.is_interrupted() { "interrupted" } else { "the time is over" }
    }
}

/// Nothing ends it.
#[derive(Clone, Copy, Debug)]
pub struct Unlimited;

impl Limits for Unlimited {}
