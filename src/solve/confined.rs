//! Panics that end nothing but the work they happen in.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::thread;

thread_local! {
    /// A panic of this thread is caught, and no other process waits for it.
    static CONFINED: Cell<bool> = const { Cell::new(false) };
}

/// Runs `body` so that a panic in it ends neither this process nor the others of its job.
///
/// # Errors
/// The panic's payload.
pub fn confined<Output>(body: impl FnOnce() -> Output) -> thread::Result<Output> {
    let before = CONFINED.replace(true);
    // The caller drops what the body has left half done.
    let outcome = catch_unwind(AssertUnwindSafe(body));
    CONFINED.set(before);
    outcome
}

/// Whether a panic of this thread is caught by [`confined`].
#[cfg(feature = "petsc")]
pub(super) fn is_confined() -> bool {
    CONFINED.get()
}
