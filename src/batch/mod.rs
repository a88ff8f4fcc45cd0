//! Where does an evaluation run? Executors: a list of items and a function in, outcomes in the items' order out.
//!
//! The items of a batch are independent and differ much in cost. An executor hands them out one at a
//! time, reports each as it ends, and turns a panic inside one into that item's outcome.
//! It is not a cache, knows no time limits, and never repeats an item.
//!
//! # Decisions
//! - A generation ends when its last candidate has: what the others wait is lost. Recorded times of the paper's search (2400 candidates,
//!   mean 1.8 s, longest 14.7 s; `examples/simulated_farm`) keep 8 processes busy to 77 % in the order of the generation and to 97 %
//!   with the longest first, 16 to 69 %, 64 to 18 %. So a search begins with what took long nearby, and more processes want a larger
//!   population: ten times as many candidates keep 64 processes busy to 99 %, a hundred times 1024 to 89 %, where the
//!   messages of the first process (0.2 ms each) begin to count. Going on without waiting for the last was left out: the result would
//!   depend on who is how fast.
//! - A candidate's budget is counted, not timed: Newton iterations of its paths and triangles of its surface, so that what is
//!   rejected does not depend on the machine.

mod farm;
mod serial;
mod threads;

use std::any::Any;

use serde::{Deserialize, Serialize};

use crate::solve::{SolverFailure, confined};
pub use farm::{Farm, Mailbox, hear_others, serve, tell_first};
pub use serial::Serial;
pub use threads::{Threads, ThreadsUnavailable};

/// An evaluation that panicked: a defect of the program, confined to one item.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error, Serialize, Deserialize)]
#[error("the evaluation panicked: {message}")]
pub struct Panicked {
    /// The panic's message.
    pub message: String,
}

/// What became of one item.
pub type Outcome<Output> = Result<Output, Panicked>;

/// A batch has no outcomes.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Stopped {
    /// The observer asked for it to be given up.
    #[error("the batch was stopped by its observer")]
    ByObserver,
    /// Processes can no longer talk.
    #[error(transparent)]
    Lost(#[from] SolverFailure),
}

/// What an observer wants after an item has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Next {
    /// Go on with the batch.
    Continue,
    /// Start no further item, and report none.
    Stop,
}

/// Evaluates batches of items.
///
/// The type parameters belong to the trait so that an implementation that sends items elsewhere can
/// ask more of them, such as serialisation.
pub trait Executor<Item, Output> {
    /// The outcomes of `evaluate` on each of `items [n]`, in their order `[n]`.
    ///
    /// `finished(index, outcome)` is called once for each item, on the calling thread, in the order in which
    /// they end. The outcomes depend on neither that order nor the number of workers, if `evaluate` is a
    /// function of its item alone.
    ///
    /// # Errors
    /// [`Stopped`] when `finished` answered [`Next::Stop`].
    fn evaluate(
        &self,
        items: &[Item],
        evaluate: &(dyn Fn(&Item) -> Output + Sync),
        finished: &mut dyn FnMut(usize, &Outcome<Output>) -> Next,
    ) -> Result<Vec<Outcome<Output>>, Stopped>;
}

/// The outcome of one item, with a panic caught.
///
/// Unwinding is safe here: the function is shared and immutable, and its partial result is dropped.
fn guarded<Item, Output>(
    item: &Item,
    evaluate: &(dyn Fn(&Item) -> Output + Sync),
) -> Outcome<Output> {
    confined(|| evaluate(item))
        .map_err(|payload| Panicked { message: panic_message(payload.as_ref()) })
}

/// The text of a panic; `panic!` carries a `&str` or a `String`, and other payloads are rare.
fn panic_message(payload: &(dyn Any + Send)) -> String {
    if let Some(text) = payload.downcast_ref::<&str>() {
        (*text).to_owned()
    } else if let Some(text) = payload.downcast_ref::<String>() {
        text.clone()
    } else {
        "no message".to_owned()
    }
}

/// The contract of [`Executor`], run for every implementation.
#[cfg(test)]
mod suite {
    use super::*;

    /// Checks order, values, one report for each item, panics and stopping.
    pub(super) fn check(executor: &dyn Executor<u64, u64>) {
        outcomes_are_in_the_order_of_items(executor);
        each_item_is_reported_once_with_its_outcome(executor);
        a_panic_is_the_outcome_of_its_item_alone(executor);
        a_stop_ends_the_batch(executor);
        assert_eq!(executor.evaluate(&[], &|i| *i, &mut |_, _| Next::Continue), Ok(vec![]));
    }

    /// Items differ in cost by a factor of some thousands, the dearest first.
    fn collatz_steps(start: &u64) -> u64 {
        (0..(40 - start) * 50).map(|k| steps_to_one(start + k)).sum()
    }

    fn steps_to_one(mut n: u64) -> u64 {
        let mut steps = 0;
        while n > 1 {
            n = if n.is_multiple_of(2) { n / 2 } else { 3 * n + 1 };
            steps += 1;
        }
        steps
    }

    fn outcomes_are_in_the_order_of_items(executor: &dyn Executor<u64, u64>) {
        let items: Vec<u64> = (0..40).collect();
        let outcomes = executor.evaluate(&items, &collatz_steps, &mut |_, _| Next::Continue);
        let expected = items.iter().map(|item| Ok(collatz_steps(item))).collect();
        assert_eq!(outcomes, Ok(expected));
    }

    fn each_item_is_reported_once_with_its_outcome(executor: &dyn Executor<u64, u64>) {
        let items: Vec<u64> = (0..40).collect();
        let mut reports = vec![];
        let outcomes = executor
            .evaluate(&items, &collatz_steps, &mut |index, outcome| {
                reports.push((index, outcome.clone()));
                Next::Continue
            })
            .expect("never stopped");
        reports.sort_by_key(|(index, _)| *index);
        assert_eq!(reports, outcomes.into_iter().enumerate().collect::<Vec<_>>());
    }

    fn a_panic_is_the_outcome_of_its_item_alone(executor: &dyn Executor<u64, u64>) {
        let evaluate = |item: &u64| {
            assert!(!item.is_multiple_of(3), "item {item}");
            *item
        };
        let outcomes = executor.evaluate(&[0, 1, 2, 3, 4], &evaluate, &mut |_, _| Next::Continue);
        let panicked = |message: &str| Err(Panicked { message: message.to_owned() });
        assert_eq!(outcomes, Ok(vec![panicked("item 0"), Ok(1), Ok(2), panicked("item 3"), Ok(4)]));
    }

    fn a_stop_ends_the_batch(executor: &dyn Executor<u64, u64>) {
        let mut reports = 0;
        let outcomes = executor.evaluate(&[1; 100], &|item| *item, &mut |_, _| {
            reports += 1;
            if reports == 3 { Next::Stop } else { Next::Continue }
        });
        assert_eq!((outcomes, reports), (Err(Stopped::ByObserver), 3));
    }
}
