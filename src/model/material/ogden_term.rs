//! A term of Ogden's law.

use serde::{Deserialize, Serialize};

/// One term of the Ogden law.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OgdenTerm {
    /// Contribution to the shear modulus at rest, MPa.
    pub mu: f64,
    /// Exponent.
    pub alpha: f64,
}
