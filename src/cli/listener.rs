//! What is told a person at a terminal while the work goes on: lines, tables, progress bars.

use std::sync::{Mutex, MutexGuard, PoisonError};

use indicatif::{ProgressBar, ProgressStyle};

use super::terminal::{narrate, say, warn};
use super::walk_progress::WalkProgress;
use crate::solve::{PathPoint, Programme};
use crate::study::HistoryRow;
use crate::{scene, study, verify};

/// Tells what the rooms report.
#[derive(Default)]
pub(super) struct Listener {
    /// Whether the answer is for a program: then all else goes to the other stream.
    is_json: bool,
    bar: Mutex<Option<ProgressBar>>,
    walk: Mutex<Option<WalkProgress>>,
}

impl Listener {
    /// Where `is_json`, a program reads the answer.
    pub(super) fn new(is_json: bool) -> Self {
        Self { is_json, ..Self::default() }
    }

    /// Tells `text` above the progress bar, if there is one.
    pub(super) fn tell(&self, text: &str) {
        let tell = || if self.is_json { narrate(text) } else { say(text) };
        match &*held(&self.bar) {
            Some(bar) => bar.suspend(tell),
            None => tell(),
        }
    }
}

impl scene::Observer for Listener {
    fn warning(&self, line: &str) {
        warn(line);
    }

    fn walk_begins(&self, programme: Programme) {
        *held(&self.walk) = Some(WalkProgress::new(programme));
    }

    fn state(&self, point: &PathPoint) {
        if let Some(walk) = &mut *held(&self.walk) {
            walk.note(point);
        }
    }
}

impl study::Observer for Listener {
    fn note(&self, line: &str) {
        self.tell(line);
    }

    fn table(&self, table: &str) {
        self.tell(table);
    }

    fn generation(&self, row: &HistoryRow, generations: usize) {
        self.tell(&row.in_words(generations));
    }

    fn work_begins(&self, name: &str, done: usize, total: usize) {
        let style =
            ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len} [{elapsed}, {eta} left]");
        let bar = ProgressBar::new(total as u64);
        bar.set_style(style.expect("the template is valid"));
        bar.set_message(name.to_owned());
        bar.inc(done as u64);
        *held(&self.bar) = Some(bar);
    }

    fn item_done(&self) {
        held(&self.bar).iter().for_each(|bar| bar.inc(1));
    }

    fn work_ends(&self) {
        held(&self.bar).take().iter().for_each(ProgressBar::finish_and_clear);
    }
}

impl verify::Observer for Listener {
    fn line(&self, line: &str) {
        self.tell(line);
    }
}

/// What is behind the lock is whole at any time, also where a thread has panicked.
fn held<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
