//! `F_bf` of Smith et al. (2022), equation 2: how hard a part pushes on the plane for its pressure.
//!
//! ```text
//! F_bf = max over the samples of  force / pressure                N/kPa
//! ```

use super::{Asked, Objective, Sense, Value, forces_per_pressure};
use crate::fitness::scenario::blocked;

/// Much force is good.
pub(super) const OBJECTIVE: Objective = Objective {
    name: "blocking",
    symbol: Some("F_bf"),
    unit: "N/kPa",
    is_unit_told: true,
    decimals: 5,
    sense: Sense::Largest,
    worst: 0.0,
    asked: Asked::Always,
    scenario: Some(blocked::SCENARIO),
    judged_by: |asked| {
        let [x, y, z] = asked.plane_normal;
        format!(
            "the force on a plane with the normal ({x}, {y}, {z}), {} mm from the wall at rest, over the pressure",
            asked.plane_distance
        )
    },
    is_per_work: false,
    value: Value::LargestOf(|reading| forces_per_pressure(reading.rows(&blocked::SCENARIO))),
};

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::fitness::Observation;

    #[test]
    fn blocking_is_the_best_force_for_its_pressure() {
        let rest = Observation::at_rest();
        let row = |pressure, work, plane_force| Observation { pressure, work, plane_force, ..rest };
        let path = [rest, row(0.1, 1.0, 3.0), row(0.2, 4.0, 5.0)];
        let largest = forces_per_pressure(&path).iter().map(|(_, f)| *f).fold(0.0, f64::max);
        assert_relative_eq!(largest, 0.03, max_relative = 1e-12);
    }
}
