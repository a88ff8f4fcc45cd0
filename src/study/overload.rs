//! Whether a pressure is one that a wall of this law and size can carry at all, asked before hours are spent.
//!
//! ```text
//! p = 2 mu h / R (1 / l - 1 / l^7)        a thin balloon of neo-Hookean rubber, radius R and wall h at rest, stretch l
//! largest at l^6 = 7:   p = 12 / 7^(7/6) mu h / R = 1.24 mu h / R
//! ```
//!
//! Source: Mueller and Strehlow (2004), Rubber and Rubber Balloons, Springer, chapter 2. A chamber that is as wide as the design box gives
//! way at about that pressure; narrow ones and laws that stiffen carry several times as much, which is what [`FAR`] leaves room for.

use super::run_file::RunFile;
use crate::model::material::Material;

/// How many times the pressure of a balloon is beyond doubt.
const FAR: f64 = 10.0;

/// A line for a run whose pressure is far beyond what its wall can carry, as kPa typed for MPa is.
pub(crate) fn overload(run: &RunFile, material: &Material) -> Option<String> {
    let radius = 0.5 * run.design_box.sides().min();
    let carried = balloon_pressure(material.shear_modulus(), run.wall.thickness, radius);
    let pressure = run.load.pressure;
    // A design that is walked to the limit of its material is not loaded further.
    (run.load.rated.is_none() && pressure > FAR * carried).then(|| {
        format!(
            "[load] pressure is {pressure} MPa, {:.0} times the {carried:.3} MPa at which a balloon of this wall and half the box's width gives way; is it meant in kPa ({} MPa)?",
            pressure / carried,
            pressure / 1000.0
        )
    })
}

/// The largest pressure that a thin balloon carries, MPa: of shear modulus `mu` (MPa), wall `thickness` and `radius` at rest (mm).
fn balloon_pressure(mu: f64, thickness: f64, radius: f64) -> f64 {
    12.0 / 7.0_f64.powf(7.0 / 6.0) * mu * thickness / radius
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The largest value on a fine grid of stretches, which is second order near the top.
    #[test]
    fn a_balloon_gives_way_at_the_top_of_its_curve() {
        let (mu, thickness, radius) = (0.4, 0.3, 25.0);
        let pressure = |l: f64| 2.0 * mu * thickness / radius * (1.0 / l - l.powi(-7));
        let top = (0..4000).map(|k| pressure(1.0 + 1e-3 * f64::from(k))).fold(0.0, f64::max);
        let closed = balloon_pressure(mu, thickness, radius);
        assert!((closed / top - 1.0).abs() < 1e-6, "{closed} {top}");
    }

    #[test]
    fn kilopascals_typed_as_megapascals_are_told() {
        let mut run = RunFile::default();
        let material = run.material.material().unwrap();
        assert_eq!(overload(&run, &material), None);
        run.load.pressure *= 1000.0;
        let told = overload(&run, &material).unwrap();
        assert!(told.contains("pressure is 200 MPa") && told.contains("(0.2 MPa)"), "{told}");
    }
}
