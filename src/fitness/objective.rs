//! The objectives of Smith et al. (2022), equations 1 and 2, and the axes of their figure 3.
//!
//! ```text
//! F_c  = max over the path of  angle / (L int p dV)^(1/p)       rad, m, J; chord angle
//! F_bf = max over the path of  force / pressure                 N/kPa
//! ```
//!
//! The maxima are taken over the samples of the loading programme, which stand where they stand however the path was walked.

use super::Observation;

/// `F_c`: how far it bends for the work done, rad / (m J)^(1/exponent), at the sample where that is most.
///
/// # Decisions
/// The exponent is not published. `F_c ~ pressure^(1 - 2 / exponent)` at small pressure: up to 2 it rewards
/// vanishing pressure, above 2 it rewards bending. Default 3.
#[must_use]
pub fn bending(path: &[Observation], length: f64, exponent: f64) -> f64 {
    largest(&bending_samples(path, length, exponent))
}

/// `F_bf`: how hard it pushes on the plane for its pressure, N/kPa, at the sample where that is most.
#[must_use]
pub fn blocking(path: &[Observation]) -> f64 {
    largest(&blocking_samples(path))
}

/// What [`bending`] takes the largest of.
pub(super) fn bending_samples(
    path: &[Observation],
    length: f64,
    exponent: f64,
) -> Vec<(&Observation, f64)> {
    let of_row = |row: &Observation| {
        let work_and_length = 1e-3 * length * 1e-3 * row.work;
        row.angle_deg.to_radians() / work_and_length.powf(1.0 / exponent)
    };
    loaded(path).map(|row| (row, of_row(row))).collect()
}

/// What [`blocking`] takes the largest of.
pub(super) fn blocking_samples(path: &[Observation]) -> Vec<(&Observation, f64)> {
    loaded(path).map(|row| (row, row.plane_force / (1e3 * row.pressure))).collect()
}

fn largest(samples: &[(&Observation, f64)]) -> f64 {
    samples.iter().map(|(_, value)| *value).fold(0.0, f64::max)
}

/// Tangent angle at the end of the path over length and pressure, deg/(kPa m): the literature's figure of merit.
#[must_use]
pub fn figure_of_merit(path: &[Observation], length: f64) -> f64 {
    loaded(path).last().map_or(0.0, |row| row.tangent_angle_deg / (row.pressure * length))
}

fn loaded(path: &[Observation]) -> impl Iterator<Item = &Observation> {
    path.iter().filter(|row| row.is_sample && row.pressure > 0.0 && row.work > 0.0)
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    fn row(pressure: f64, work: f64, angle_deg: f64, plane_force: f64) -> Observation {
        Observation {
            pressure,
            work,
            angle_deg,
            tangent_angle_deg: 2.0 * angle_deg,
            plane_force,
            ..Observation::at_rest()
        }
    }

    /// The published log of an 80 mm actuator at 0.2 MPa: 6.06 degrees and 329.8 mJ, by hand 0.356 for exponent 3,
    /// 0.652 for 2, 0.263 for 4.
    #[test]
    fn bending_of_the_public_log() {
        let path = [row(0.0, 0.0, 0.0, 0.0), row(0.2, 329.8, 6.065, 0.0)];
        for (exponent, exact) in [(2.0, 0.652), (3.0, 0.356), (4.0, 0.263)] {
            // Three digits were kept.
            assert_relative_eq!(bending(&path, 80.0, exponent), exact, max_relative = 2e-3);
        }
    }

    /// 100 degrees at 100 kPa over 65.8 mm is 15.2 deg/(kPa m) (Hainsworth et al. 2020).
    #[test]
    fn figure_of_merit_of_a_published_actuator() {
        let path = [row(0.1, 1.0, 50.0, 0.0)];
        assert_relative_eq!(figure_of_merit(&path, 65.8), 15.2, max_relative = 1e-3);
    }

    #[test]
    fn blocking_is_the_best_force_for_its_pressure() {
        let path = [row(0.0, 0.0, 0.0, 0.0), row(0.1, 1.0, 1.0, 3.0), row(0.2, 4.0, 1.0, 5.0)];
        assert_relative_eq!(blocking(&path), 0.03, max_relative = 1e-12);
    }
}
