//! How good is that? Scenarios, what is read off their paths, and the objectives.
//!
//! Scenarios ([`SCENARIOS`]) and objectives ([`OBJECTIVES`]) are lists. A scenario is the path of the one that it branches off from until the
//! part comes near its planes: bending freely and pressing on a plane are one path until then.

mod candidate;
mod evaluate;
mod evaluation;
mod exploit;
mod fidelity;
mod load_settings;
mod merit;
mod objective;
mod observation;
mod outcome;
mod part;
mod pattern;
mod scenario;
mod settings;
mod turning;
mod walk;

pub use candidate::{
    Candidate, CandidateSettings, evaluate_genome, evaluate_network, evaluate_network_until,
    shell_of_network,
};
pub use evaluate::evaluate;
pub use evaluation::{AtReference, Evaluation, Rated, Readings, ScenarioEnding};
pub use exploit::{Exploit, flags};
pub use fidelity::{Certificate, FidelitySettings, Verdict};
pub use load_settings::{LoadSettings, RatedSettings};
pub use merit::figure_of_merit;
pub use objective::{
    Asked, OBJECTIVES, Objective, Reading, Samples, Sense, UnknownObjective, Value, objective,
};
pub use observation::{Observation, Stability, Watched, observations};
pub use outcome::{NotEvaluated, Outcome, StageSeconds, Unevaluated};
pub use part::{Part, ShellPart};
pub use pattern::WallPattern;
pub use scenario::{Arrangement, SCENARIOS, Scenario};
pub use settings::FitnessSettings;
pub use turning::Turning;
pub use walk::{RatedPressure, Scenarios, Walked};
