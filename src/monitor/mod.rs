//! How does a browser look at a run? A small local web server: one page, and what it asks for as JSON.
//!
//! It knows nothing of runs: a [`Source`] answers. The page itself is built by `scripts/web` and is part of the program.
//!
//! # Decisions
//! - Only the machine itself is served unless another address is asked for. A page of another site that a browser on this machine
//!   shows could still send requests here: those that name another host (DNS rebinding), or that a browser marks as
//!   coming from another site, are refused.
//! - The page polls. A stream of events would save the answers that say that nothing is new, and cost a second protocol.
//! - One thread serves, others work out what was asked: nobody waits for a design that is being computed.

mod page;
mod server;

use std::sync::Arc;

pub use page::is_built_in;
pub use server::{Server, router};

/// What the page asks for.
pub trait Source: Send + Sync {
    /// The run as a whole, as JSON.
    ///
    /// # Errors
    /// [`Refusal`], as of all.
    fn run(&self) -> Answer;

    /// What is known of the design `id`, as JSON.
    ///
    /// # Errors
    /// [`Refusal::Unknown`] when there is none.
    fn design(&self, id: &str) -> Answer;

    /// The design `id` in three dimensions, at rest and deformed, as JSON.
    ///
    /// # Errors
    /// [`Refusal::Unknown`] when there is none, [`Refusal::Unfit`] when it has no shape.
    fn shape(&self, id: &str) -> Answer;
}

/// JSON, or why there is none.
pub type Answer = Result<Arc<[u8]>, Refusal>;

/// Why a question has no answer, in one line.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Refusal {
    /// There is no such thing.
    #[error("{0}")]
    Unknown(String),
    /// It is there, but what was asked cannot be done with it.
    #[error("{0}")]
    Unfit(String),
    /// The machine failed.
    #[error("{0}")]
    Failed(String),
}
