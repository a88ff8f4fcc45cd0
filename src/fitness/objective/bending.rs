//! `F_c` of Smith et al. (2022), equation 1: how far a part bends for the work done.
//!
//! ```text
//! F_c = max over the samples of  angle / (L int p dV)^(1/p)       rad, m, J; chord angle
//! ```
//!
//! The samples stand where they stand however the path was walked.
//!
//! # Decisions
//! The exponent is not published. `F_c ~ pressure^(1 - 2 / exponent)` at small pressure: up to 2 it rewards
//! vanishing pressure, above 2 it rewards bending. Default 3.

use super::{Asked, Objective, Reading, Samples, Sense, Value, loaded};
use crate::fitness::Observation;
use crate::fitness::scenario::free;

/// Much bending is good.
pub(super) const OBJECTIVE: Objective = Objective {
    name: "bending",
    symbol: Some("F_c"),
    unit: "rad/(m J)^(1/p)",
    is_unit_told: false,
    decimals: 4,
    sense: Sense::Largest,
    worst: 0.0,
    asked: Asked::Always,
    scenario: Some(free::SCENARIO),
    judged_by: |asked| format!("the chord angle over the work to the power 1/{}", asked.exponent),
    is_per_work: true,
    value: Value::LargestOf(samples),
};

fn samples<'a>(reading: &Reading<'a>) -> Samples<'a> {
    let length = reading.part.shell().ends.heights.length;
    samples_of(reading.rows(&free::SCENARIO), length, reading.settings.exponent)
}

/// The quotient at each loaded sample of a part of this `length`, mm.
fn samples_of(rows: &[Observation], length: f64, exponent: f64) -> Samples<'_> {
    let of_row = |row: &Observation| {
        let work_and_length = 1e-3 * length * 1e-3 * row.work;
        row.angle_deg.to_radians() / work_and_length.powf(1.0 / exponent)
    };
    loaded(rows).map(|row| (row, of_row(row))).collect()
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    /// The published log of an 80 mm actuator at 0.2 MPa: 6.06 degrees and 329.8 mJ, by hand 0.356 for exponent 3,
    /// 0.652 for 2, 0.263 for 4.
    #[test]
    fn bending_of_the_public_log() {
        let rest = Observation::at_rest();
        let path = [rest, Observation { pressure: 0.2, work: 329.8, angle_deg: 6.065, ..rest }];
        for (exponent, exact) in [(2.0, 0.652), (3.0, 0.356), (4.0, 0.263)] {
            let [(_, value)] = samples_of(&path, 80.0, exponent)[..] else {
                panic!("one is loaded")
            };
            // Three digits were kept.
            assert_relative_eq!(value, exact, max_relative = 2e-3);
        }
    }
}
