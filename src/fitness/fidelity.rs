//! The fidelity certificate: how far a shell's answers may be believed, judged by the solid of the same wall.
//!
//! ```text
//! deviation of q = max_k |q_shell(p_k) - q_solid(p_k)| / max_k max(|q_shell(p_k)|, |q_solid(p_k)|)
//!                 over the samples p_k that both paths have
//! ```
//!
//! Angles, work and growth are those of the scenarios that branch off from no other, forces those of the planes in the others: the largest
//! deviation of each. Angles are the chord's; work and growth are those of the chamber's volume, which is the same for the mid-surface and
//! for the chamber itself as far as the wall keeps its volume.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::observation::Observation;
use super::walk::Scenarios;
use crate::solve::Ending;

/// What a deviation means.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct FidelitySettings {
    /// Up to this largest deviation the shell is trusted.
    pub trust: f64,
    /// Up to this it wants a second look; beyond, it misleads.
    pub check: f64,
}

impl Default for FidelitySettings {
    fn default() -> Self {
        Self { trust: 0.1, check: 0.25 }
    }
}

/// Whether a shell's answers may be believed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// They are those of the solid.
    Trust,
    /// They differ visibly.
    Check,
    /// They are of another part, or one of the paths ends where the other goes on.
    Misleads,
}

/// How a design's shell and solid compare.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Certificate {
    /// Deviation of the chord angle; an angle below a degree counts as one.
    pub angle: f64,
    /// Deviation of the force on the plane.
    pub force: f64,
    /// Deviation of the pressure's work.
    pub work: f64,
    /// Deviation of the volume's growth.
    pub growth: f64,
    /// Share of the pressures reached that both reached, the least of all scenarios.
    pub common_pressure: f64,
    /// What follows.
    pub verdict: Verdict,
}

impl Certificate {
    /// Compares the scenarios of a design's `shell` with those of its `solid`.
    #[must_use]
    pub fn new(shell: &Scenarios, solid: &Scenarios, settings: &FidelitySettings) -> Self {
        let rows = shell.walked.iter().filter_map(|shell| {
            let other = solid.walked.iter().find(|solid| solid.scenario == shell.scenario)?;
            let are_limited =
                [shell, other].iter().all(|one| one.path.ending == Ending::LimitReached);
            Some((shell.scenario, [&shell.rows[..], &other.rows], are_limited))
        });
        let (mut angle, mut force, mut work, mut growth) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
        let mut common = 1.0_f64;
        let mut unlike = 0.0_f64;
        for (scenario, rows, are_limited) in rows {
            if scenario.branches_off.is_none() {
                angle = angle.max(deviation(rows, LEAST_ANGLE, |row, _| row.angle_deg));
                work = work.max(deviation(rows, 0.0, |row, _| row.work));
                growth = growth.max(deviation(rows, 0.0, |row, rest| row.volume - rest.volume));
            } else {
                force = force.max(deviation(rows, 0.0, |row, _| row.plane_force));
            }
            let of_rows = common_pressure(rows);
            common = common.min(of_rows);
            // Where both were walked to the limit of the material, its pressure is a number as others are.
            unlike = unlike.max(if are_limited || of_rows == 1.0 { 1.0 - of_rows } else { 1.0 });
        }
        let common_pressure = common;
        let largest = [angle, force, work, growth, unlike].into_iter().fold(0.0, f64::max);
        let verdict = if largest <= settings.trust {
            Verdict::Trust
        } else if largest <= settings.check {
            Verdict::Check
        } else {
            Verdict::Misleads
        };
        Self { angle, force, work, growth, common_pressure, verdict }
    }

    /// The largest deviation.
    #[must_use]
    pub fn largest(&self) -> f64 {
        [self.angle, self.force, self.work, self.growth].into_iter().fold(0.0, f64::max)
    }
}

/// Degrees.
const LEAST_ANGLE: f64 = 1.0;
/// Pressures that differ by less, relatively, are the same sample.
const SAME: f64 = 1e-9;

/// The deviation of what `quantity` reads off a row and that at rest, over the pairs of equal pressure of `[shell, solid]`.
fn deviation(
    [shell, solid]: [&[Observation]; 2],
    least: f64,
    quantity: impl Fn(&Observation, &Observation) -> f64,
) -> f64 {
    let (mut largest, mut scale) = (0.0_f64, least);
    for row in solid.iter().filter(|row| row.is_sample) {
        let is_same = |other: &&Observation| {
            other.is_sample && (other.pressure - row.pressure).abs() <= SAME * row.pressure.abs()
        };
        if let Some(other) = shell.iter().find(is_same) {
            let [value, other] = [quantity(row, &solid[0]), quantity(other, &shell[0])];
            largest = largest.max((value - other).abs());
            scale = scale.max(value.abs()).max(other.abs());
        }
    }
    if largest == 0.0 { 0.0 } else { largest / scale }
}

/// The share of the longer path that the shorter one has.
fn common_pressure(rows: [&[Observation]; 2]) -> f64 {
    let last = |rows: &[Observation]| {
        rows.iter().rfind(|row| row.is_sample).map_or(0.0, |row| row.pressure)
    };
    let [a, b] = rows.map(last);
    if (a - b).abs() <= SAME * a.max(b) { 1.0 } else { a.min(b) / a.max(b) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(pressure: f64, volume: f64) -> Observation {
        Observation { pressure, volume, angle_deg: 0.1 * volume, ..Observation::at_rest() }
    }

    /// Growth is measured from each one's own rest, and what only one path has is not compared.
    #[test]
    fn deviations_are_of_common_samples() {
        let shell = [row(0.0, 100.0), row(0.1, 110.0), row(0.2, 125.0), row(0.3, 300.0)];
        let solid = [row(0.0, 80.0), row(0.1, 91.0), row(0.2, 100.0)];
        let growth = deviation([&shell, &solid], 0.0, |row, rest| row.volume - rest.volume);
        assert!((growth - 5.0 / 25.0).abs() < 1e-15);
        assert!((common_pressure([&shell, &solid]) - 2.0 / 3.0).abs() < 1e-15);
        assert_eq!(common_pressure([&shell[..3], &solid]), 1.0);
    }

    /// Nothing is no deviation from nothing, and something is a whole one.
    #[test]
    fn nothing_deviates_from_nothing() {
        let rest = [row(0.0, 5.0), row(0.1, 5.0)];
        assert_eq!(deviation([&rest, &rest], 0.0, |row, _| row.plane_force), 0.0);
        let moved = [row(0.0, 5.0), row(0.1, 6.0)];
        let growth = |row: &Observation, rest: &Observation| row.volume - rest.volume;
        assert_eq!(deviation([&moved, &rest], 0.0, growth), 1.0);
    }
}
