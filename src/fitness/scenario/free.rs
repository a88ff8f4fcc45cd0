//! Clamped at the base, pressure rising, nothing in the way.

use super::{Arrangement, Scenario};

pub(in crate::fitness) const SCENARIO: Scenario = Scenario {
    name: "free",
    action: "bending",
    branches_off: None,
    arrangement: |_, load| Arrangement { planes: Vec::new(), programme: load.pressure.into() },
};
