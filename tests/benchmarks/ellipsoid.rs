//! A flattened closed shell that pressure rounds up: bending and membrane stretch together.
//!
//! Ellipsoid of semi-axes 50, 12 and 6 mm, wall 1 mm, incompressible neo-Hookean with E = 10 MPa, 0.2 MPa inside:
//! the enclosed volume grows by 9945 +- 10 mm^3. Source: agreement of independent prototype elements (Loop with
//! one and four points, mid-edge, EBST) at 1,600 and more vertices.

use pneumorph::field::ScalarField;
use pneumorph::math::Vec3;
use pneumorph::mesh::{ShellMesh, ShellSettings};
use pneumorph::model::material::{Material, NeoHookean};
use pneumorph::model::system::System;
use pneumorph::model::{ShellModel, Support};
use pneumorph::solve::{Ending, NativeSolver, PathSettings, follow};
use pneumorph::surface::{RemeshSettings, isosurface, remesh};

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

/// Within 0.5 % at 800 vertices or fewer.
#[test]
fn flattened_ellipsoid_rounds_up() {
    let field = Ellipsoid(Vec3::new(12.0, 6.0, 50.0));
    let corner = field.0.add_scalar(2.0);
    let coarse = isosurface(&field, -corner, corner, 1.2);
    let surface =
        remesh(&coarse, Some(&field), &RemeshSettings { edge: 2.75, iterations: 10 }).unwrap();
    assert!(surface.positions.len() <= 800, "{}", surface.positions.len());

    let highest = |axis: usize, sign: f64| {
        let along = |v: &u32| sign * surface.positions[*v as usize][axis];
        (0..surface.positions.len() as u32).max_by(|a, b| along(a).total_cmp(&along(b))).unwrap()
    };
    let (top, bottom, side) = (highest(2, 1.0), highest(2, -1.0), highest(0, 1.0));
    let pins = vec![3 * top, 3 * top + 1, 3 * top + 2, 3 * bottom, 3 * bottom + 1, 3 * side + 1];
    let settings = ShellSettings { thickness: 1.0, clamp_height: 8.0, ..Default::default() };
    let mesh = ShellMesh::new(surface, &settings).unwrap();
    let material = Material::NeoHookean(NeoHookean { mu: 10.0 / 3.0 });
    let mut model = ShellModel::new(&mesh, &material, &Support::Unknowns(pins), &[]).unwrap();
    let mut solver = NativeSolver::new(model.pattern()).unwrap();
    let path = follow(&mut model, &mut solver, 0.2, Vec::new(), &PathSettings::default()).unwrap();
    assert_eq!(path.ending, Ending::Reached);
    let growth = path.points.last().unwrap().conjugate - path.points[0].conjugate;
    assert!((growth / 9945.0 - 1.0).abs() < 5e-3, "{growth} mm^3");
}
