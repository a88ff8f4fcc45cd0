//! Control points whose limit surface passes through given vertices, except at creases, which are rounded.
//!
//! ```text
//! L X = x        (L X)_v = (1 - n chi) X_v + chi sum ring
//! ```
//!
//! At a crease sharper than the wall is thick the surface through the vertices would fold tighter than the wall
//! allows. The vertices there give way: their target becomes their own smooth limit `(L x)_v`, which turns the
//! crease over two elements instead of one. A printed wall is rounded there too.

use std::rc::Rc;

use super::loop_patch::{LoopBasis, limit_weight};
use super::loop_shell::{TIGHTEST_FOLD, least_shifter};
use crate::math::{Rejected, Room, Vec3};
use crate::mesh::{Rings, ShellMesh};

/// Rounds of giving way; each takes the vertices of the elements that are still too tight.
const ROUNDS: usize = 8;

/// The control points of `mesh`, `[vertices]`, mm.
///
/// # Errors
/// [`Rejected`] when the iteration does not converge, which no closed manifold met so far has caused.
pub fn fitted_control_points(
    mesh: &ShellMesh,
    bases: &[Rc<LoopBasis>],
) -> Result<Vec<Vec3>, Rejected> {
    let vertices = &mesh.surface.positions;
    let smooth = limit(vertices, &mesh.rings);
    let mut targets = vertices.clone();
    let mut control = interpolating(&targets, &mesh.rings)?;
    for _ in 0..ROUNDS {
        let mut gave_way = false;
        for (stencil, basis) in mesh.stencils.iter().zip(bases) {
            let x: Vec<Vec3> = stencil.nodes.iter().map(|&v| control[v as usize]).collect();
            if least_shifter(&basis.barycentre, &x, mesh.thickness) < TIGHTEST_FOLD {
                for v in stencil.corners() {
                    gave_way |= targets[v as usize] != smooth[v as usize];
                    targets[v as usize] = smooth[v as usize];
                }
            }
        }
        if !gave_way {
            break;
        }
        control = interpolating(&targets, &mesh.rings)?;
    }
    Ok(control)
}

/// Solves `L X = targets` by damped iteration.
///
/// On closed meshes the spectrum of `L` lies in about [1/4, 1]: each iteration shrinks the error by 0.6.
fn interpolating(targets: &[Vec3], rings: &Rings) -> Result<Vec<Vec3>, Rejected> {
    const DAMPING: f64 = 1.6;
    const ITERATIONS: usize = 400;
    let scale = targets.iter().map(|x| x.amax()).fold(0.0, f64::max);
    let mut control = targets.to_vec();
    for _ in 0..ITERATIONS {
        let mut largest: f64 = 0.0;
        for ((control, limit), target) in limit(&control, rings)
            .iter()
            .zip(targets)
            .zip(&mut control)
            .map(|((l, t), c)| ((c, l), t))
        {
            let miss = target - limit;
            largest = largest.max(miss.amax());
            *control += DAMPING * miss;
        }
        if largest <= 1e-14 * scale {
            return Ok(control);
        }
    }
    Err(Rejected::new(
        Room::Model,
        "no_interpolating_surface",
        "the limit surface cannot be fitted through the vertices; valences are too irregular"
            .to_owned(),
        1.0,
    ))
}

/// `L X`: the limit positions of the vertices of a control mesh.
fn limit(control: &[Vec3], rings: &Rings) -> Vec<Vec3> {
    let limit_of = |(v, x): (usize, &Vec3)| {
        let ring = rings.ring(v as u32);
        let weight = limit_weight(ring.len());
        let sum: Vec3 = ring.iter().map(|&w| control[w as usize]).sum();
        x * (1.0 - ring.len() as f64 * weight) + weight * sum
    };
    control.iter().enumerate().map(limit_of).collect()
}
