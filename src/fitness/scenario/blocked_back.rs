//! As `blocked`, with the plane on the other side of the part, at the same distance.

use super::{Arrangement, Scenario, free};

pub(in crate::fitness) const SCENARIO: Scenario = Scenario {
    name: "blocked_back",
    action: "blocking_back",
    branches_off: Some(free::SCENARIO.name),
    arrangement: |fitness, load| Arrangement {
        planes: vec![fitness.plane(-1.0, load.pressure)],
        programme: load.pressure.into(),
    },
};
