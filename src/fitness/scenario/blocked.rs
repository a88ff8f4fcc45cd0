//! As [`free`], with a rigid plane at a distance from the outer wall.

use super::{Arrangement, Scenario, free};

pub(in crate::fitness) const SCENARIO: Scenario = Scenario {
    name: "blocked",
    action: "blocking",
    branches_off: Some(free::SCENARIO.name),
    arrangement: |fitness, load| Arrangement {
        planes: vec![fitness.plane(1.0, load.pressure)],
        programme: load.pressure.into(),
    },
};
