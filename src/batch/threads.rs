//! Several items at once, one on each thread.
//!
//! A thread takes the next item when it is free, so the dear ones do not queue behind each other. A
//! parallel loop inside an evaluation stays on the evaluation's own thread: the machine is never
//! oversubscribed, and no thread that waits for such a loop steals another item meanwhile.
//! For this every thread is a pool of its own: in one shared pool, `rayon` lets a waiting thread steal.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{self, Sender};
use std::thread::{self, Scope};

use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};

use super::{Executor, Next, Outcome, Stopped, guarded};

/// Evaluates on threads of its own.
#[derive(Debug)]
pub struct Threads {
    /// One pool of one thread for each item at a time.
    pools: Vec<ThreadPool>,
}

/// The system refused to start the threads.
#[derive(Debug, thiserror::Error)]
#[error("cannot start {count} threads: {source}")]
pub struct ThreadsUnavailable {
    count: usize,
    source: ThreadPoolBuildError,
}

impl Threads {
    /// An executor of `count` threads; 0 stands for one for each core of the machine.
    ///
    /// # Errors
    /// [`ThreadsUnavailable`] when the system refuses them.
    pub fn new(count: usize) -> Result<Self, ThreadsUnavailable> {
        let count = if count == 0 { cores() } else { count };
        let pools = (0..count)
            .map(|_| ThreadPoolBuilder::new().num_threads(1).build())
            .collect::<Result<_, _>>()
            .map_err(|source| ThreadsUnavailable { count, source })?;
        Ok(Self { pools })
    }

    /// Lets each thread evaluate, and send, the `next` of the `items` until none is left or nobody listens.
    pub(super) fn start<'scope, Item: Sync, Output: Send + 'scope>(
        &'scope self,
        scope: &'scope Scope<'scope, '_>,
        items: &'scope [Item],
        evaluate: &'scope (dyn Fn(&Item) -> Output + Sync),
        next: &'scope AtomicUsize,
        sender: &Sender<(usize, Outcome<Output>)>,
    ) {
        for pool in self.pools.iter().take(items.len()) {
            let sender = sender.clone();
            let work = move || {
                while let Some((index, item)) = take(items, next) {
                    // Nobody listens after a stop.
                    if sender.send((index, guarded(item, evaluate))).is_err() {
                        break;
                    }
                }
            };
            scope.spawn(|| pool.install(work));
        }
    }

    /// The number of threads.
    #[must_use]
    pub fn count(&self) -> usize {
        self.pools.len()
    }
}

/// The number of cores that this process may use; 1 when the system does not tell.
fn cores() -> usize {
    thread::available_parallelism().map_or(1, Into::into)
}

impl<Item: Sync, Output: Send> Executor<Item, Output> for Threads {
    fn evaluate(
        &self,
        items: &[Item],
        evaluate: &(dyn Fn(&Item) -> Output + Sync),
        finished: &mut dyn FnMut(usize, &Outcome<Output>) -> Next,
    ) -> Result<Vec<Outcome<Output>>, Stopped> {
        let next = AtomicUsize::new(0);
        let mut outcomes: Vec<Option<Outcome<Output>>> = items.iter().map(|_| None).collect();
        thread::scope(|scope| {
            let (sender, receiver) = mpsc::channel();
            self.start(scope, items, evaluate, &next, &sender);
            drop(sender);
            for (index, outcome) in receiver {
                if finished(index, &outcome) == Next::Stop {
                    return Err(Stopped::ByObserver);
                }
                outcomes[index] = Some(outcome);
            }
            Ok(())
        })?;
        Ok(outcomes
            .into_iter()
            .map(|outcome| outcome.expect("the channel closes when every item has been sent"))
            .collect())
    }
}

/// The next item that nobody has taken, with its index.
pub(super) fn take<'a, Item>(items: &'a [Item], next: &AtomicUsize) -> Option<(usize, &'a Item)> {
    let index = next.fetch_add(1, Ordering::Relaxed);
    items.get(index).map(|item| (index, item))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::sync::{Barrier, Mutex};

    use super::super::suite;
    use super::*;

    #[test]
    fn keeps_the_contract_for_any_number_of_threads() {
        for count in [1, 2, 3, 8] {
            suite::check(&Threads::new(count).unwrap());
        }
    }

    #[test]
    fn every_thread_takes_an_item() {
        // Each of the first three items waits for the other two: it ends only if three threads work at once.
        let barrier = Barrier::new(3);
        let workers = Mutex::new(BTreeSet::new());
        let evaluate = |item: &usize| {
            if *item < 3 {
                barrier.wait();
            }
            workers.lock().unwrap().insert(format!("{:?}", thread::current().id()));
        };
        let items: Vec<usize> = (0..12).collect();
        let outcomes = Threads::new(3)
            .unwrap()
            .evaluate(&items, &evaluate, &mut |_, _| Next::Continue)
            .unwrap();
        assert!(outcomes.iter().all(Result::is_ok));
        assert_eq!(workers.into_inner().unwrap().len(), 3);
    }

    #[test]
    fn parallel_loops_of_an_evaluation_stay_on_its_thread() {
        let home = |_: &u32| {
            let (a, b) = rayon::join(|| thread::current().id(), || thread::current().id());
            (rayon::current_num_threads(), a == thread::current().id() && a == b)
        };
        let outcomes =
            Threads::new(3).unwrap().evaluate(&[0; 9], &home, &mut |_, _| Next::Continue).unwrap();
        assert_eq!(outcomes, vec![Ok((1, true)); 9]);
    }
}
