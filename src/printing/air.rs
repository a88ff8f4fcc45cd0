//! Which air reaches which? A flood through the cubes that are not solid.
//!
//! Both questions are asked to the printer's disadvantage: air is cut off when it does not pass from face to face of a cube, and
//! a wall leaks when it passes over edges and corners too.

use crate::math::Vec3;

use super::{Bore, Voxels};

/// Connections of the air in and around a part.
#[derive(Clone, Debug, PartialEq)]
pub struct AirPaths {
    /// Whether air from outside reaches the chamber.
    pub chamber_reached: bool,
    /// Whether the chamber, its inlet plugged, is apart from the outside.
    pub airtight: bool,
    /// Volumes of the pockets that air from outside does not reach, the chamber left out, largest first, mm^3.
    pub pockets: Vec<f64>,
}

/// Across what air passes between cubes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Passage {
    Faces,
    Corners,
}

impl AirPaths {
    /// The connections in `voxels`, with the chamber at `chamber` (mm), whose inlet is `bore`.
    #[must_use]
    pub fn of(voxels: &Voxels, chamber: Vec3, bore: Option<&Bore>) -> Self {
        let chamber = voxels.at(chamber);
        let mut reached = vec![false; voxels.solid.len()];
        flood(voxels, OUTSIDE, Passage::Faces, &mut reached);
        let chamber_reached = reached[chamber];
        let mut pockets = Vec::new();
        for k in 0..voxels.solid.len() {
            let pocket = flood(voxels, k, Passage::Faces, &mut reached);
            if !pocket.is_empty() && !pocket.contains(&chamber) {
                pockets.push(pocket.len() as f64 * voxels.size.powi(3));
            }
        }
        pockets.sort_by(|a, b| b.total_cmp(a));
        let plugged = bore.map(|bore| voxels.filled(|point| bore.contains(point)));
        reached.fill(false);
        flood(plugged.as_ref().unwrap_or(voxels), OUTSIDE, Passage::Corners, &mut reached);
        Self { chamber_reached, airtight: !reached[chamber], pockets }
    }
}

/// A cube of the layer of air around the part.
const OUTSIDE: usize = 0;

/// The cubes of air that are reached from cube `start`, itself the first, without those that were `reached` before; marks them.
fn flood(voxels: &Voxels, start: usize, passage: Passage, reached: &mut [bool]) -> Vec<usize> {
    if voxels.solid[start] || reached[start] {
        return Vec::new();
    }
    let strides = voxels.strides();
    let steps: Vec<[isize; 3]> = (0..27)
        .map(|k| [k / 9 - 1, k / 3 % 3 - 1, k % 3 - 1])
        .filter(|step| match step.iter().filter(|along| **along != 0).count() {
            0 => false,
            1 => true,
            _ => passage == Passage::Corners,
        })
        .collect();
    reached[start] = true;
    let mut cubes = vec![start];
    let mut next = 0;
    while let Some(&k) = cubes.get(next) {
        next += 1;
        let at = voxels.indices(k);
        for step in &steps {
            let to: [usize; 3] =
                std::array::from_fn(|axis| at[axis].wrapping_add_signed(step[axis]));
            if (0..3).any(|axis| to[axis] >= voxels.counts[axis]) {
                continue;
            }
            let other = (0..3).map(|axis| to[axis] * strides[axis]).sum::<usize>();
            if !reached[other] && !voxels.solid[other] {
                reached[other] = true;
                cubes.push(other);
            }
        }
    }
    cubes
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use approx::assert_relative_eq;

    use super::*;
    use crate::printing::test_shapes::{ball, hollow};
    use crate::surface::test_fields::Analytic;
    use crate::surface::{TriangleMesh, isosurface};

    /// A sphere of outer radius 10 mm and wall 1.6 mm, with a bore of radius `bore` along the x axis.
    fn shell(bore: f64) -> TriangleMesh {
        let field = Analytic(move |p: Vec3| {
            let wall = (p.norm() - 9.2).abs() - 0.8;
            if p.x > 0.0 { wall.max(bore - p.y.hypot(p.z)) } else { wall }
        });
        isosurface(&field, Vec3::repeat(-11.0), Vec3::repeat(11.0), 0.35)
    }

    #[test]
    fn two_voids_are_a_chamber_and_a_pocket() {
        let voids = [ball([-4.0, 0.0, 0.0], 2.0), ball([4.0, 0.0, 0.0], 3.0)];
        let voxels = Voxels::of(&hollow(&ball([0.0; 3], 10.0), &voids), 0.25);
        let air = AirPaths::of(&voxels, Vec3::new(4.0, 0.0, 0.0), None);
        assert_eq!((air.chamber_reached, air.airtight, air.pockets.len()), (false, true, 1));
        // Cubes of an eighth of the radius count a ball to a percent or two.
        assert_relative_eq!(air.pockets[0], 4.0 / 3.0 * PI * 8.0, max_relative = 0.03);
    }

    #[test]
    fn a_puncture_leaks_and_a_plugged_one_does_not() {
        let at = |bore: f64| Voxels::of(&shell(bore), 0.4);
        let whole = AirPaths::of(&at(-1.0), Vec3::zeros(), None);
        let closed = AirPaths { chamber_reached: false, airtight: true, pockets: vec![] };
        assert_eq!(whole, closed);
        // A bore of 1 mm is wider than a cube.
        let punctured = AirPaths::of(&at(0.5), Vec3::zeros(), None);
        let open = AirPaths { chamber_reached: true, airtight: false, pockets: vec![] };
        assert_eq!(punctured, open);
    }

    /// The bore of a part is vertical: the shell is turned, z becoming x, and its bore known as the inlet.
    #[test]
    fn a_plugged_inlet_keeps_the_air() {
        let mut mesh = shell(1.5);
        mesh.positions.iter_mut().for_each(|p| *p = Vec3::new(p.z, p.y, -p.x));
        let bore = Bore { centre: [0.0, 0.0], radius: 1.5, bottom: -10.5, top: -8.0 };
        let air = AirPaths::of(&Voxels::of(&mesh, 0.4), Vec3::zeros(), Some(&bore));
        assert_eq!(air, AirPaths { chamber_reached: true, airtight: true, pockets: vec![] });
    }
}
