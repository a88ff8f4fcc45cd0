//! Closed parts: the shell of a network, an STL file, a sphere or an ellipsoid, and what holds it.

use anyhow::{Context, anyhow, bail, ensure};

use super::PartSource;
use super::own_surface;
use crate::field::{CappedField, CompiledNetwork, ScalarField};
use crate::math::{Rejected, Vec3};
use crate::mesh::{ShellMesh, ShellSettings, shell_of_field};
use crate::model::Support;
use crate::scene::observer::Observer;
use crate::scene::pattern::PatternSection;
use crate::scene::scene_file::SceneFile;
use crate::surface::{RemeshSettings, TriangleMesh, intersecting_pairs, isosurface, remesh};

/// The shell of a closed part; the observer is warned of edges that its triangles cannot keep.
///
/// # Errors
/// When its surface cannot be made, or is not one of a shell; the part is a patch; or a region is wrong somewhere.
pub(crate) fn shell(
    scene: &SceneFile,
    source: &PartSource<'_>,
    observer: &dyn Observer,
) -> anyhow::Result<ShellMesh> {
    let mesh = plain_shell(scene, source, observer)?;
    let section = scene.regions()?.of_shell(&mesh, source.placed().moved)?;
    Ok(ShellMesh { section, ..mesh })
}

/// The shell as it is without regions.
fn plain_shell(
    scene: &SceneFile,
    source: &PartSource<'_>,
    observer: &dyn Observer,
) -> anyhow::Result<ShellMesh> {
    match source {
        PartSource::Network { file, network } => {
            let field = CappedField::new(
                CompiledNetwork::new(network),
                scene.design_box,
                scene.mesh.rim_radius,
            )?;
            PatternSection::check(scene.pattern.as_ref(), network)
                .with_context(|| file.display().to_string())?;
            let shell = shell_of_field(&field, &scene.mesh.settings(), &scene.wall)
                .map_err(|rejected| anyhow!("{}: {rejected}", file.display()))?;
            let section = scene.pattern()?.section(network, &shell);
            Ok(ShellMesh { section, ..shell })
        }
        PartSource::Stl { file, surface, .. } => {
            let name = file.display();
            surface.check_closed_manifold().with_context(|| name.to_string())?;
            let parts = surface.components().iter().max().map_or(0, |&last| last + 1);
            ensure!(
                parts == 1,
                "{name}: {parts} separate surfaces, but one closed chamber is wanted{}",
                if own_surface::is_body(surface) {
                    ", the middle of its wall; this is a body around a cavity, which a mesher such as gmsh fills for [part] tetrahedra"
                } else {
                    ""
                }
            );
            let crossings = intersecting_pairs(surface).len();
            ensure!(
                crossings == 0,
                "{name}: {crossings} pairs of triangles pass through each other"
            );
            own_surface::shell(&name.to_string(), surface, scene, observer)
                .map_err(|rejected| anyhow!("{name}: {rejected}"))
        }
        PartSource::Sphere(sphere) => {
            let surface = TriangleMesh::sphere(sphere.radius, sphere.subdivisions);
            free_shell(surface, scene).map_err(|rejected| anyhow!("[part.sphere]: {rejected}"))
        }
        PartSource::Ellipsoid(semi_axes) => {
            ellipsoid(Vec3::from(*semi_axes), scene.mesh.settings().edge)
                .and_then(|surface| free_shell(surface, scene))
                .map_err(|rejected| anyhow!("[part.ellipsoid]: {rejected}"))
        }
        PartSource::Patch(_) => bail!("a patch is not closed"),
        PartSource::Tetrahedra { .. } => bail!("tetrahedra are no shell"),
    }
}

/// What holds the shell of `source`: its clamp, or its six rigid motions alone.
pub(crate) fn support(source: &PartSource<'_>, mesh: &ShellMesh) -> Support {
    let (PartSource::Sphere(_) | PartSource::Ellipsoid(_)) = source else {
        return Support::Clamp;
    };
    Support::of_free_body(&mesh.surface)
}

/// A mesh wants a clamp, though free bodies do not use it.
fn free_shell(surface: TriangleMesh, scene: &SceneFile) -> Result<ShellMesh, Rejected> {
    let highest = surface.positions.iter().map(|x| x.z).fold(0.0, f64::max);
    let settings = ShellSettings { clamp_height: highest / scene.wall.thickness, ..scene.wall };
    ShellMesh::new(surface, &settings)
}

/// An ellipsoid about the origin in triangles of one size.
fn ellipsoid(semi_axes: Vec3, edge: f64) -> Result<TriangleMesh, Rejected> {
    let field = Ellipsoid(semi_axes);
    let step = GRID_SHARE * edge;
    let corner = semi_axes.add_scalar(2.0 * step);
    let coarse = isosurface(&field, -corner, corner, step);
    remesh(&coarse, Some(&field), &RemeshSettings { edge, iterations: REMESH_ITERATIONS })
}

/// Grid step of the isosurface as a share of the edge.
const GRID_SHARE: f64 = 0.4;
/// Passes of the remesher, as for networks.
const REMESH_ITERATIONS: usize = 10;

/// `(|x/axes| - 1)` times the shortest axis: about a distance beside the short axes.
struct Ellipsoid(Vec3);

impl ScalarField for Ellipsoid {
    fn value(&self, point: Vec3) -> f64 {
        self.0.min() * (point.component_div(&self.0).norm() - 1.0)
    }

    fn value_and_gradient(&self, point: Vec3) -> (f64, Vec3) {
        let scaled = point.component_div(&self.0);
        let gradient = scaled.component_div(&self.0) / scaled.norm().max(1e-12);
        (self.value(point), self.0.min() * gradient)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    /// Flat triangles cut off less and less, with the square of their edge.
    #[test]
    fn ellipsoids_have_their_volume() {
        let exact = 4.0 / 3.0 * PI * 3.0 * 2.0 * 5.0;
        let missing = [1.0, 0.5].map(|edge| {
            let surface = ellipsoid(Vec3::new(3.0, 2.0, 5.0), edge).unwrap();
            surface.check_closed_manifold().unwrap();
            1.0 - surface.volume() / exact
        });
        // Between 2 and 8 for second order, with unstructured triangles.
        assert!(missing[1] > 0.0 && missing[1] < 0.02, "{missing:?}");
        assert!((2.0..8.0).contains(&(missing[0] / missing[1])), "{missing:?}");
    }
}
