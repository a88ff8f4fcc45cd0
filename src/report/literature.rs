//! Published actuators on the axes of Smith et al. (2022), Fig. 3, digitised; the file names its sources.

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::evolve::pareto_dominates;
use crate::io;

/// One mark of a published figure.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct Published {
    /// Which marks it belongs to.
    pub set: Set,
    /// First author and year.
    pub work: String,
    /// How the actuator was made.
    #[serde(rename(deserialize = "class"))]
    pub technique: Technique,
    /// Bending angle per pressure and length, deg/(kPa m).
    #[serde(rename(deserialize = "figure_of_merit_deg_per_kPa_m"))]
    pub figure_of_merit: f64,
    /// Largest force, N.
    #[serde(rename(deserialize = "max_force_N"))]
    pub max_force: f64,
}

/// The marks of the two published figures that belong together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Set {
    /// Works of others, as plotted by Hainsworth et al. (2020).
    #[serde(rename = "literature_2020")]
    Literature2020,
    /// Works of others, as plotted by Smith et al. (2022).
    #[serde(rename = "literature_2022")]
    Literature2022,
    /// The front found by Smith et al. (2022) with shell elements.
    #[serde(rename = "smith_2022_shell_front")]
    SmithShellFront,
    /// The same designs simulated again with tetrahedra.
    #[serde(rename = "smith_2022_solid_front")]
    SmithSolidFront,
    /// The design that Smith et al. (2022) printed and measured.
    #[serde(rename = "smith_2022_printed")]
    SmithPrinted,
}

/// How a published actuator was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Technique {
    /// Moulded.
    Cast,
    /// Printed from thermoplastic filament.
    FilamentPrinted,
    /// Printed from a resin or silicone.
    ResinOrSiliconePrinted,
    /// Made together with its sensor.
    ActuatorWithSensor,
    /// Simulated only.
    Simulated,
}

/// Every published mark, in the order of the file `data/literature.csv`.
///
/// # Panics
/// Never: the file is part of the program, and a test reads it.
#[must_use]
pub fn published() -> Vec<Published> {
    let path = Path::new("data/literature.csv");
    io::csv::parse(include_str!("../../data/literature.csv"), path).expect("a test reads this file")
}

/// How many of the works of others in Smith et al. (2022), Fig. 3, a design is better than on both axes, were its material `stiffness`
/// times as stiff; and how many there are.
///
/// At the same geometry the figure of merit, deg/(kPa m), falls as stiffness rises, and the force, N, rises with it.
///
/// # Panics
/// Never: as [`published`].
#[must_use]
pub fn dominated(figure_of_merit: f64, max_force: f64, stiffness: f64) -> (usize, usize) {
    let others = others();
    (count(&others, [figure_of_merit / stiffness, max_force * stiffness]), others.len())
}

/// How many of `others` the design `at` (figure of merit, force) is better than.
fn count(others: &[Published], at: [f64; 2]) -> usize {
    // Both are made large.
    let ours = at.map(|value| -value);
    let is_dominated =
        |other: &&Published| pareto_dominates(&ours, &[-other.figure_of_merit, -other.max_force]);
    others.iter().filter(is_dominated).count()
}

/// The stiffness, in that of its material, with which a design would be better than the most works ([`dominated`]).
///
/// # Panics
/// Never: as [`published`].
#[must_use]
pub fn best_stiffness(figure_of_merit: f64, max_force: f64) -> f64 {
    // The count changes only where the design is level with a work on an axis.
    let mut tried = vec![1.0];
    let others = others();
    for other in &others {
        tried.extend([figure_of_merit / other.figure_of_merit, other.max_force / max_force]);
    }
    tried.retain(|stiffness| stiffness.is_finite() && *stiffness > 0.0);
    let better = |s: &f64| count(&others, [figure_of_merit / s, max_force * s]);
    // Of equals the last is taken: the material as it is.
    tried.into_iter().rev().max_by_key(better).unwrap_or(1.0)
}

fn others() -> Vec<Published> {
    published().into_iter().filter(|point| point.set == Set::Literature2022).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stiffness_is_chosen_that_dominates_most() {
        // Better than all by the plot's own largest numbers.
        assert_eq!(dominated(2000.0, 78.0, 1.0), (24, 24));
        assert_eq!(best_stiffness(2000.0, 78.0), 1.0);
        assert_eq!(dominated(0.1, 1000.0, 1.0), (0, 24));
        // A tenth of the force at ten times the merit is the same geometry of another material.
        let stiffness = best_stiffness(0.1, 1000.0);
        let softer = best_stiffness(1.0, 100.0);
        let counts = [dominated(0.1, 1000.0, stiffness), dominated(1.0, 100.0, softer)];
        assert!(stiffness < 1.0 && counts[0].0 > 0 && counts[0] == counts[1], "{counts:?}");
        assert_eq!(best_stiffness(0.0, 0.0), 1.0);
    }

    #[test]
    fn the_file_holds_the_published_figures() {
        let all = published();
        let count = |set| all.iter().filter(|point| point.set == set).count();
        // Counts of the marks visible in the two figures.
        assert_eq!(count(Set::SmithShellFront), 10);
        assert_eq!(count(Set::SmithSolidFront), 5);
        assert_eq!(count(Set::SmithPrinted), 1);
        assert_eq!(count(Set::Literature2022), 24);
        assert_eq!(count(Set::Literature2020), 13);
        assert!(all.iter().all(|point| point.figure_of_merit > 0.0 && point.max_force > 0.0));
        let strongest = all.iter().map(|point| point.max_force).fold(0.0, f64::max);
        assert_eq!(strongest, 77.9);
    }
}
