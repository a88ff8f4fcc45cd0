//! The axis on which the literature is compared (Smith et al. 2022, figure 3).

use super::Observation;
use super::objective::loaded;

/// Tangent angle at the end of the path over length and pressure, deg/(kPa m): the literature's figure of merit.
#[must_use]
pub fn figure_of_merit(path: &[Observation], length: f64) -> f64 {
    loaded(path).last().map_or(0.0, |row| row.tangent_angle_deg / (row.pressure * length))
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    /// 100 degrees at 100 kPa over 65.8 mm is 15.2 deg/(kPa m) (Hainsworth et al. 2020).
    #[test]
    fn figure_of_merit_of_a_published_actuator() {
        let rest = Observation::at_rest();
        let path = [Observation { pressure: 0.1, work: 1.0, tangent_angle_deg: 100.0, ..rest }];
        assert_relative_eq!(figure_of_merit(&path, 65.8), 15.2, max_relative = 1e-3);
    }
}
