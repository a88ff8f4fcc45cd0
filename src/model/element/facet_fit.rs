//! Vertices moved off a closed surface so that its facets enclose what the smooth surface does.
//!
//! Facets between points of a curved surface cut its volume short, by the square of their size; with it the load. One
//! offset along the normals, the same for all vertices, makes up for that:
//!
//! ```text
//! V(x + s n) = V_smooth          a cubic in s          dV/ds = sum_T A_T N_T . (n_0 + n_1 + n_2) / 3
//! ```

use crate::math::{Reason, Rejected, Room, Vec3};
use crate::surface::TriangleMesh;

/// Newton steps; from the right side of a cubic three or four do.
const STEPS: usize = 20;
/// Of the volume, relative: above the rounding of some ten thousand facets' volumes.
const TOLERANCE: f64 = 1e-12;

/// The vertices of the closed `surface` (mm), all moved by one distance along their normals so that the facets enclose
/// `volume` (mm^3).
///
/// # Errors
/// [`Rejected`] when no such distance is near: the surface is not closed, or the volume quite another one.
pub fn volume_matched(surface: &TriangleMesh, volume: f64) -> Result<Vec<Vec3>, Rejected> {
    let normals = surface.vertex_normals();
    let mut moved = surface.clone();
    for _ in 0..STEPS {
        let miss = volume - moved.volume();
        if miss.abs() <= TOLERANCE * volume {
            return Ok(moved.positions);
        }
        let slope: f64 = moved
            .triangles
            .iter()
            .enumerate()
            .map(|(t, corners)| {
                let normals: Vec3 = corners.iter().map(|&v| normals[v as usize]).sum();
                moved.area_vector(t).dot(&normals) / 3.0
            })
            .sum();
        for (x, normal) in moved.positions.iter_mut().zip(&normals) {
            *x += miss / slope * normal;
        }
    }
    Err(Rejected::new(
        Room::Model,
        Reason::NoVolumeMatch,
        format!(
            "no offset makes facets of {:.3e} mm^3 enclose {volume:.3e} mm^3",
            surface.volume()
        ),
        1.0,
    ))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    /// Of a ball every vertex moves along its radius, up to the unevenness of the mesh.
    #[test]
    fn facets_enclose_the_ball() {
        let (exact, centre) = (4000.0 * PI / 3.0, Vec3::new(30.0, -20.0, 50.0));
        for subdivisions in 0..3 {
            let mut surface = TriangleMesh::sphere(10.0, subdivisions);
            let radius = 10.0 * (exact / surface.volume()).cbrt();
            surface.positions.iter_mut().for_each(|x| *x += centre);
            surface.positions = volume_matched(&surface, exact).unwrap();
            assert!((surface.volume() / exact - 1.0).abs() < 2.0 * TOLERANCE);
            for x in &surface.positions {
                // The normals of the finest lean by up to 3e-3.
                assert!(((x - centre).norm() - radius).abs() < 1e-4, "{x} {radius}");
            }
        }
    }

    #[test]
    fn impossible_volumes_are_rejected() {
        let surface = TriangleMesh::sphere(10.0, 1);
        for volume in [-1.0, f64::NAN] {
            assert_eq!(volume_matched(&surface, volume).unwrap_err().reason, Reason::NoVolumeMatch);
        }
    }
}
