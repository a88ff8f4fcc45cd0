//! Several items at once, on all processes of a job: the first one hands them out, and computes too.
//!
//! ```text
//! first process:  (index, item) ->  the next idle process  -> (index, outcome), in any order
//! the others:     serve until they are told that it is over
//! ```
//! Items go one at a time to whoever is free, so that dear ones do not queue behind each other. Messages are JSON, which keeps every
//! bit of a finite number. Nobody spins while waiting: a process that does nothing leaves its core to others.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use rayon::ThreadPoolBuilder;
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::{Executor, Next, Outcome, Stopped, Threads, guarded, threads};
use crate::solve::{Job, Message, SolverFailure};

/// How the processes of a job talk.
pub trait Mailbox {
    /// How many processes there are; they are numbered from 0.
    fn processes(&self) -> usize;

    /// Sends a message to `message.rank`.
    ///
    /// # Errors
    /// When it cannot be sent.
    fn send(&self, message: Message) -> Result<(), SolverFailure>;

    /// The next message, if one waits.
    ///
    /// # Errors
    /// When it cannot be received.
    fn receive(&self) -> Result<Option<Message>, SolverFailure>;
}

impl Mailbox for Job {
    fn processes(&self) -> usize {
        self.ranks
    }

    fn send(&self, message: Message) -> Result<(), SolverFailure> {
        Job::send(*self, &message)
    }

    fn receive(&self) -> Result<Option<Message>, SolverFailure> {
        Job::receive(*self)
    }
}

/// An item for a process.
const ITEM: i32 = 1;
/// The outcome of an item.
const OUTCOME: i32 = 2;
/// There will be no more items.
const END: i32 = 3;
/// What is told before the first item.
const WORD: i32 = 4;
/// Between looks into the mailbox of a process that has nothing else to do: a thousandth of what an item takes.
const PAUSE: Duration = Duration::from_micros(500);
/// Between those of the first process, whose own threads compute: at 500 microseconds they took 3 % longer.
const LEADERS_PAUSE: Duration = Duration::from_millis(2);

/// Evaluates on the other processes of a job and on threads of this one.
#[derive(Debug)]
pub struct Farm<'a, M: Mailbox> {
    mailbox: M,
    own: &'a Threads,
}

impl<'a, M: Mailbox> Farm<'a, M> {
    /// The first process's part of a farm, which computes on threads of its `own` beside handing out.
    pub fn new(mailbox: M, own: &'a Threads) -> Self {
        Self { mailbox, own }
    }

    /// Hands out items until all have ended.
    fn lead<Item: Serialize, Output: DeserializeOwned>(
        &self,
        items: &[Item],
        next: &AtomicUsize,
        own: &mpsc::Receiver<(usize, Outcome<Output>)>,
        finished: &mut dyn FnMut(usize, &Outcome<Output>) -> Next,
    ) -> Result<Vec<Outcome<Output>>, Stopped> {
        let mut outcomes: Vec<Option<Outcome<Output>>> = items.iter().map(|_| None).collect();
        let mut idle: Vec<usize> = (1..self.mailbox.processes()).rev().collect();
        let mut busy = 0;
        let mut stopped = false;
        let mut left = items.len();
        while left > 0 && !stopped || busy > 0 {
            while !stopped && !idle.is_empty() {
                let Some((index, item)) = threads::take(items, next) else { break };
                let rank = idle.pop().expect("it is not empty");
                let bytes = serde_json::to_vec(&(index, item)).expect("items are plain data");
                self.mailbox.send(Message { rank, kind: ITEM, bytes })?;
                busy += 1;
            }
            let mut ended: Vec<(usize, Outcome<Output>)> =
                own.recv_timeout(LEADERS_PAUSE).into_iter().collect();
            while let Some(Message { rank, bytes, .. }) = self.mailbox.receive()? {
                ended.push(serde_json::from_slice(&bytes).expect("this program has written it"));
                idle.push(rank);
                busy -= 1;
            }
            for (index, outcome) in ended {
                left -= 1;
                if !stopped && finished(index, &outcome) == Next::Stop {
                    next.store(items.len(), Ordering::Relaxed);
                    stopped = true;
                }
                outcomes[index] = Some(outcome);
            }
        }
        if stopped {
            return Err(Stopped::ByObserver);
        }
        Ok(outcomes.into_iter().map(|outcome| outcome.expect("all have ended")).collect())
    }
}

impl<M, Item, Output> Executor<Item, Output> for Farm<'_, M>
where
    M: Mailbox,
    Item: Sync + Serialize,
    Output: Send + DeserializeOwned,
{
    fn evaluate(
        &self,
        items: &[Item],
        evaluate: &(dyn Fn(&Item) -> Output + Sync),
        finished: &mut dyn FnMut(usize, &Outcome<Output>) -> Next,
    ) -> Result<Vec<Outcome<Output>>, Stopped> {
        let next = AtomicUsize::new(0);
        thread::scope(|scope| {
            let (sender, receiver) = mpsc::channel();
            self.own.start(scope, items, evaluate, &next, &sender);
            let outcomes = self.lead(items, &next, &receiver, finished);
            // The own threads take nothing more, whatever happened.
            next.store(items.len(), Ordering::Relaxed);
            outcomes
        })
    }
}

impl<M: Mailbox> Drop for Farm<'_, M> {
    fn drop(&mut self) {
        for rank in 1..self.mailbox.processes() {
            // A job that can no longer be told is ending anyway.
            let _ = self.mailbox.send(Message { rank, kind: END, bytes: Vec::new() });
        }
    }
}

/// Tells the first process of a job a `word`, before it leads a farm.
///
/// # Errors
/// [`SolverFailure`] when it cannot be sent.
///
/// # Panics
/// When the word is no plain data.
pub fn tell_first<Word: Serialize>(
    mailbox: &impl Mailbox,
    word: &Word,
) -> Result<(), SolverFailure> {
    let bytes = serde_json::to_vec(word).expect("words are plain data");
    mailbox.send(Message { rank: 0, kind: WORD, bytes })
}

/// What each of the other processes tells the first one by [`tell_first`], in the order of their numbers.
///
/// # Errors
/// [`SolverFailure`] when it cannot be received.
///
/// # Panics
/// When a process tells something else.
pub fn hear_others<Word: DeserializeOwned>(
    mailbox: &impl Mailbox,
) -> Result<Vec<Word>, SolverFailure> {
    let mut words: BTreeMap<usize, Word> = BTreeMap::new();
    while words.len() + 1 < mailbox.processes() {
        match mailbox.receive()? {
            None => thread::sleep(PAUSE),
            Some(Message { rank, bytes, .. }) => {
                let word = serde_json::from_slice(&bytes).expect("this program has written it");
                words.insert(rank, word);
            }
        }
    }
    Ok(words.into_values().collect())
}

/// Evaluates what the first process sends, until it says that it is over.
///
/// # Errors
/// [`SolverFailure`] when messages cannot be received or sent.
///
/// # Panics
/// When the system refuses a thread.
pub fn serve<Item: DeserializeOwned + Sync, Output: Serialize + Send>(
    mailbox: &impl Mailbox,
    evaluate: &(dyn Fn(&Item) -> Output + Sync),
) -> Result<(), SolverFailure> {
    let pool = ThreadPoolBuilder::new().num_threads(1).build().expect("one thread can be started");
    loop {
        match mailbox.receive()? {
            None => thread::sleep(PAUSE),
            Some(Message { kind: END, .. }) => return Ok(()),
            Some(Message { rank, bytes, .. }) => {
                let (index, item): (usize, Item) =
                    serde_json::from_slice(&bytes).expect("this program has written it");
                let outcome = pool.install(|| guarded(&item, evaluate));
                let bytes = serde_json::to_vec(&(index, outcome)).expect("outcomes are plain data");
                mailbox.send(Message { rank, kind: OUTCOME, bytes })?;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;
    use std::sync::mpsc::{Receiver, Sender};

    use super::super::suite;
    use super::*;

    /// A process of a job whose processes are threads.
    struct Post {
        rank: usize,
        boxes: Vec<Sender<Message>>,
        own: Mutex<Receiver<Message>>,
    }

    impl Mailbox for &Post {
        fn processes(&self) -> usize {
            self.boxes.len()
        }

        fn send(&self, message: Message) -> Result<(), SolverFailure> {
            let sent = Message { rank: self.rank, ..message.clone() };
            self.boxes[message.rank].send(sent).expect("the job goes on");
            Ok(())
        }

        fn receive(&self) -> Result<Option<Message>, SolverFailure> {
            Ok(self.own.lock().unwrap().try_recv().ok())
        }
    }

    /// A farm of this many processes for every batch, whose first one has threads.
    struct Village {
        processes: usize,
        threads: usize,
    }

    impl Executor<u64, u64> for Village {
        fn evaluate(
            &self,
            items: &[u64],
            evaluate: &(dyn Fn(&u64) -> u64 + Sync),
            finished: &mut dyn FnMut(usize, &Outcome<u64>) -> Next,
        ) -> Result<Vec<Outcome<u64>>, Stopped> {
            let (boxes, owners): (Vec<_>, Vec<_>) =
                (0..self.processes).map(|_| mpsc::channel()).unzip();
            let posts: Vec<Post> = owners
                .into_iter()
                .enumerate()
                .map(|(rank, own)| Post { rank, boxes: boxes.clone(), own: Mutex::new(own) })
                .collect();
            thread::scope(|scope| {
                for post in &posts[1..] {
                    scope.spawn(move || serve(&post, evaluate).unwrap());
                }
                let own = Threads::new(self.threads).unwrap();
                Farm::new(&posts[0], &own).evaluate(items, evaluate, finished)
            })
        }
    }

    #[test]
    fn keeps_the_contract() {
        for processes in 1..=4 {
            for threads in 1..=2 {
                suite::check(&Village { processes, threads });
            }
        }
    }

    #[test]
    fn every_process_computes() {
        // Two items meet at a barrier: neither ends before another process has begun the other.
        let barrier = std::sync::Barrier::new(3);
        let evaluate = |item: &u64| {
            barrier.wait();
            *item
        };
        let farm = Village { processes: 3, threads: 1 };
        let outcomes = farm.evaluate(&[7, 8, 9], &evaluate, &mut |_, _| Next::Continue);
        assert_eq!(outcomes, Ok(vec![Ok(7), Ok(8), Ok(9)]));
    }
}
