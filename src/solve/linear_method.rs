//! The choice between a factorisation and an iteration.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How linear systems are solved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum LinearMethod {
    /// By size: a factorisation while that is the faster.
    #[default]
    #[serde(rename = "auto")]
    Automatic,
    /// A sparse factorisation, which counts negative pivots.
    Direct,
    /// A preconditioned iteration, for solids (systems with multipliers that know their places) by PETSc; all else is factorised.
    Iterative,
}
