//! How hard a part pushes on a plane on its other side for its pressure.
//!
//! ```text
//! max over the samples of  force / pressure                N/kPa
//! ```
//!
//! A part that bends leaves this plane alone. What it rewards is a part that swells to both sides, or bends there and back.

use super::{Asked, Objective, Sense, Value, forces_per_pressure};
use crate::fitness::scenario::blocked_back;

/// Much force is good.
pub(super) const OBJECTIVE: Objective = Objective {
    name: "blocking_back",
    symbol: None,
    unit: "N/kPa",
    is_unit_told: true,
    decimals: 5,
    sense: Sense::Largest,
    worst: 0.0,
    asked: Asked::ByName,
    scenario: Some(blocked_back::SCENARIO),
    judged_by: |_| "the force on a plane on the other side over the pressure".to_owned(),
    is_per_work: false,
    value: Value::LargestOf(|reading| forces_per_pressure(reading.rows(&blocked_back::SCENARIO))),
};

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use crate::fitness::{FitnessSettings, LoadSettings, ShellPart, evaluate, objective};
    use crate::mesh::{ShellMesh, ShellSettings};
    use crate::model::material::{Material, Ogden};
    use crate::solve::{Backend, SolveCounts, Stop};
    use crate::surface::TriangleMesh;

    /// A balloon that is flatter on one side; `side` is 1, or -1 for its mirror image about x = 0.
    fn balloon(side: f64) -> TriangleMesh {
        let mut surface = TriangleMesh::sphere(10.0, 2);
        for x in &mut surface.positions {
            x.x *= if x.x < 0.0 { 0.7 * side } else { side };
        }
        if side < 0.0 {
            surface.triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
        }
        surface
    }

    /// What one side of a part does is what the other side of its mirror image does.
    #[test]
    fn the_back_is_the_front_of_the_mirror_image() {
        let material = Material::Ogden(Ogden::ninjaflex_c2s());
        let mut load = LoadSettings { pressure: 0.2, ..LoadSettings::default() };
        load.path.steps = 3;
        let asked = FitnessSettings {
            plane_distance: 0.1,
            further_objectives: vec![*objective("blocking_back").unwrap()],
            ..FitnessSettings::default()
        };
        let both = |side: f64| {
            let settings = ShellSettings { thickness: 1.0, ..ShellSettings::default() };
            let shell = ShellMesh::new(balloon(side), &settings).unwrap();
            let part = ShellPart { shell: &shell, materials: material.as_ref(), limits: &[] };
            let mut counts = SolveCounts::default();
            let evaluated =
                evaluate(&part, &load, &asked, Backend::Native, Stop::NEVER, &mut counts);
            let (evaluation, scenarios) = evaluated.unwrap();
            assert_eq!(scenarios.walked.len(), 3);
            ["blocking", "blocking_back"].map(|name| evaluation.objectives[name])
        };
        let [front, back] = both(1.0);
        let [mirrored_front, mirrored_back] = both(-1.0);
        assert!(front > 0.0 && back > 0.0 && (front / back - 1.0).abs() > 0.01, "{front} {back}");
        // Newton's method stops at 1e-8 of the scale of forces.
        assert_relative_eq!(back, mirrored_front, max_relative = 1e-5);
        assert_relative_eq!(front, mirrored_back, max_relative = 1e-5);
    }
}
