//! How good is that? Scenarios, what is read off their paths, and the objectives.
//!
//! Two scenarios share one path until the part touches the plane: bending freely, and pressing on a plane.

mod candidate;
mod evaluate;
mod exploit;
mod fidelity;
mod further;
mod objective;
mod observation;
mod outcome;
mod turning;

pub use candidate::{
    Candidate, CandidateSettings, evaluate_network, evaluate_network_until, shell_of_network,
};
pub use evaluate::{
    Evaluation, FitnessSettings, LoadSettings, Scenarios, evaluate, evaluate_model,
};
pub use exploit::{Exploit, flags};
pub use fidelity::{Certificate, FidelitySettings, Verdict};
pub use further::{FurtherObjective, Reading, Sense, UnknownObjective};
pub use objective::{bending, blocking, figure_of_merit};
pub use observation::{Observation, Watched, observations, stability};
pub use outcome::{Outcome, StageSeconds, Unevaluated};
pub use turning::Turning;
