//! Is it one chamber from the clamp to the tip?

use crate::math::{Reason, Rejected, Room};

use super::TriangleMesh;

/// What the surface of an actuator must be: one closed chamber that reaches from the clamp face to the
/// tip face of the design box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chamber {
    /// Height of the clamped face, mm.
    pub clamp_z: f64,
    /// Height of the face of the tip, mm.
    pub tip_z: f64,
    /// Distance within which a face counts as reached, mm.
    pub tolerance: f64,
    /// The most triangles that are worth remeshing.
    pub most_triangles: usize,
}

impl Chamber {
    /// Whether `mesh`, a closed manifold, is such a chamber.
    ///
    /// # Errors
    /// [`Rejected`] with the first reason that holds of `no_surface`, `too_many_triangles`, `islands`,
    /// `enclosed_void`, `no_chamber_at_clamp` and `not_reaching_tip`; the violation is a share of the
    /// triangles allowed, of the volume, or of the length between the faces.
    pub fn check(&self, mesh: &TriangleMesh) -> Result<(), Rejected> {
        let Some((lower, upper)) = mesh.bounding_box() else {
            let detail = "the field is negative nowhere in the box".to_owned();
            return Err(rejected(Reason::NoSurface, detail, 1.0));
        };
        let triangles = mesh.triangles.len();
        if triangles > self.most_triangles {
            let detail =
                format!("the surface has {triangles} triangles, at most {}", self.most_triangles);
            let excess = triangles as f64 / self.most_triangles as f64 - 1.0;
            return Err(rejected(Reason::TooManyTriangles, detail, excess));
        }
        check_one_solid(&mesh.component_volumes())?;

        let length = self.tip_z - self.clamp_z;
        let at_clamp = lower.z - self.clamp_z;
        if at_clamp > self.tolerance {
            let detail = format!("the chamber starts {at_clamp:.2} mm from the clamped face");
            return Err(rejected(Reason::NoChamberAtClamp, detail, at_clamp / length));
        }
        let at_tip = self.tip_z - upper.z;
        if at_tip > self.tolerance {
            let detail = format!("the chamber ends {at_tip:.2} mm before the face of the tip");
            return Err(rejected(Reason::NotReachingTip, detail, at_tip / length));
        }
        Ok(())
    }
}

fn check_one_solid(volumes: &[f64]) -> Result<(), Rejected> {
    let (solids, voids): (Vec<f64>, Vec<f64>) = volumes.iter().partition(|&&v| v > 0.0);
    let solid: f64 = solids.iter().sum();
    if solids.len() > 1 {
        let largest = solids.iter().copied().fold(0.0, f64::max);
        let elsewhere = 1.0 - largest / solid;
        let share = 100.0 * elsewhere;
        let detail = format!("{} separate parts, {share:.2} % in the lesser ones", solids.len());
        return Err(rejected(Reason::Islands, detail, elsewhere));
    }
    if !voids.is_empty() {
        let share = -voids.iter().sum::<f64>() / solid;
        let detail = format!("{} voids of {:.2} % of the volume", voids.len(), 100.0 * share);
        return Err(rejected(Reason::EnclosedVoid, detail, share));
    }
    Ok(())
}

fn rejected(reason: Reason, detail: String, violation: f64) -> Rejected {
    Rejected::new(Room::Surface, reason, detail, violation)
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::math::Vec3;
    use crate::surface::isosurface;
    use crate::surface::test_fields::{Analytic, capped};

    const CHAMBER: Chamber =
        Chamber { clamp_z: 0.0, tip_z: 20.0, tolerance: 0.1, most_triangles: 50_000 };

    fn verdict(field: impl Fn(Vec3) -> f64 + Sync) -> Result<(), Rejected> {
        let (lower, upper) = (Vec3::new(-6.0, -6.0, 0.0), Vec3::new(6.0, 6.0, 20.0));
        let mesh = isosurface(&capped(Analytic(field), lower, upper), lower, upper, 0.9);
        CHAMBER.check(&mesh)
    }

    fn tube(p: Vec3) -> f64 {
        p.x.hypot(p.y) - 4.0
    }

    fn ball(p: Vec3, z: f64, radius: f64) -> f64 {
        (p - Vec3::new(0.0, 0.0, z)).norm() - radius
    }

    #[test]
    fn a_tube_between_the_faces_is_a_chamber() {
        assert_eq!(verdict(tube), Ok(()));
    }

    #[test]
    fn each_failure_has_its_reason_and_size() {
        let rejected = |field: fn(Vec3) -> f64, reason: Reason, violation: f64| {
            let rejection = verdict(field).unwrap_err();
            assert_eq!(rejection.reason, reason);
            // The lattice of 0.9 mm loses up to 5 % of a small ball's volume.
            assert_relative_eq!(rejection.violation, violation, max_relative = 0.05);
        };
        rejected(|_| 1.0, Reason::NoSurface, 1.0);
        rejected(|p| tube(p).max(15.0 - p.z), Reason::NoChamberAtClamp, 15.0 / 20.0);
        rejected(|p| tube(p).max(p.z - 15.0), Reason::NotReachingTip, 5.0 / 20.0);
        rejected(|p| ball(p, 5.0, 4.0).min(ball(p, 14.0, 2.0)), Reason::Islands, 8.0 / 72.0);
        let tube_volume = 16.0 * 20.0 * std::f64::consts::PI;
        let ball_volume = 36.0 * std::f64::consts::PI;
        let share = ball_volume / tube_volume;
        rejected(|p| tube(p).max(-ball(p, 10.0, 3.0)), Reason::EnclosedVoid, share);
    }

    #[test]
    fn too_many_triangles_come_before_the_shape() {
        let strict = Chamber { most_triangles: 100, ..CHAMBER };
        let mesh = isosurface(
            &Analytic(|p| ball(p, 0.0, 3.0)),
            Vec3::repeat(-4.0),
            Vec3::repeat(4.0),
            0.9,
        );
        let rejection = strict.check(&mesh).unwrap_err();
        assert_eq!(rejection.reason, Reason::TooManyTriangles);
        assert!(rejection.violation > 0.0);
    }
}
