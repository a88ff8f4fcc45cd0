//! Parts and walks that several benchmarks share.

use pneumorph::math::Vec3;
use pneumorph::mesh::{Patch, ShellElement, ShellMesh, ShellSettings};
use pneumorph::model::material::Material;
use pneumorph::model::system::System;
use pneumorph::model::{EdgeSupport, PartModel, PartSetup, PatchLoads, Support};
use pneumorph::solve::{NativeSolver, Path, PathSettings, Programme, follow, linear_path};
use pneumorph::surface::TriangleMesh;

/// The middle of the walls of all spheres and tubes, mm.
pub(crate) const RADIUS: f64 = 10.0;

/// Of the tubes, mm.
const LENGTH: f64 = 4.0;

/// A free sphere: an icosahedron quartered so many times.
pub(crate) fn sphere(
    subdivisions: usize,
    thickness: f64,
    element: ShellElement,
    material: &Material,
) -> PartModel {
    sphere_among(subdivisions, thickness, element, material, &PartSetup::default())
}

/// The same, among what `setup` lists.
pub(crate) fn sphere_among(
    subdivisions: usize,
    thickness: f64,
    element: ShellElement,
    material: &Material,
    setup: &PartSetup,
) -> PartModel {
    let surface = TriangleMesh::sphere(RADIUS, subdivisions);
    let support = Support::of_free_body(&surface);
    // A mesh wants a clamp, which these supports do not use.
    let clamp_height = RADIUS / thickness;
    let settings =
        ShellSettings { thickness, clamp_height, element: Some(element), ..Default::default() };
    let mesh = ShellMesh::new(surface, &settings).unwrap();
    PartModel::new(&mesh, material, &support, setup).unwrap()
}

/// A quarter of a tube between two planes that keep its length, in so many cells around and 4 along.
pub(crate) fn quarter_tube(
    cells: usize,
    thickness: f64,
    element: ShellElement,
    material: &Material,
) -> PartModel {
    let around = |s: f64, t: f64| Vec3::new(RADIUS * s.sin(), t, RADIUS * s.cos());
    let quarter = [0.0, std::f64::consts::FRAC_PI_2];
    let patch = Patch::new([cells, 4], quarter, [0.0, LENGTH], thickness, &around).unwrap();
    let supports = [0, 2, 1, 1].map(EdgeSupport::Symmetry);
    let loads = PatchLoads { supports, pressure: 1.0, ..Default::default() };
    PartModel::of_patch(&patch, element, material, &loads, &PartSetup::default()).unwrap()
}

/// The path to a load, in so many steps of equal size at most.
pub(crate) fn walked(model: &mut PartModel, load: f64, settings: &PathSettings) -> Path {
    driven(model, load, settings)
}

/// The path through a programme.
pub(crate) fn driven(
    model: &mut PartModel,
    programme: impl Into<Programme>,
    settings: &PathSettings,
) -> Path {
    let mut solver = NativeSolver::new(model.pattern()).unwrap();
    follow(model, &mut solver, programme, Vec::new(), settings).unwrap()
}

/// The displacements at a load of 1 by the linear theory.
pub(crate) fn linear_response(model: &mut PartModel) -> Vec<f64> {
    let mut solver = NativeSolver::new(model.pattern()).unwrap();
    let path = linear_path(model, &mut solver, 1.0).unwrap();
    path.points.last().expect("it is stable at rest").x.clone()
}
