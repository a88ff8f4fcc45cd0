//! A thin incompressible neo-Hookean sphere under internal pressure.
//!
//! ```text
//! p = 2 mu (t / R) (1 / l - 1 / l^7)        l = current over initial radius
//! ```
//!
//! Source: Green & Adkins (1970), large elastic deformations, membrane limit t / R -> 0.

use pneumorph::mesh::{ShellMesh, ShellSettings};
use pneumorph::model::material::{Material, NeoHookean};
use pneumorph::model::system::System;
use pneumorph::model::{ShellModel, Support};
use pneumorph::solve::{Ending, NativeSolver, PathSettings, follow};
use pneumorph::surface::TriangleMesh;

const RADIUS: f64 = 10.0;

/// A sphere whose rigid motions alone are held: 3 unknowns at the top, 2 at the bottom, 1 beside.
fn sphere(thickness: f64) -> ShellModel {
    let surface = TriangleMesh::sphere(RADIUS, 3);
    let farthest = |axis: usize, sign: f64| {
        let height = |v: &u32| sign * surface.positions[*v as usize][axis];
        (0..surface.positions.len() as u32).max_by(|a, b| height(a).total_cmp(&height(b))).unwrap()
    };
    let (top, bottom, side) = (farthest(2, 1.0), farthest(2, -1.0), farthest(0, 1.0));
    let pins = vec![3 * top, 3 * top + 1, 3 * top + 2, 3 * bottom, 3 * bottom + 1, 3 * side + 1];
    let settings = ShellSettings { thickness, clamp_height: 1.0 / thickness, ..Default::default() };
    let mesh = ShellMesh::new(surface, &settings).unwrap();
    let material = Material::NeoHookean(NeoHookean { mu: 1.0 });
    ShellModel::new(&mesh, &material, &Support::Unknowns(pins), &[]).unwrap()
}

fn membrane_pressure(stretch: f64, thickness: f64) -> f64 {
    2.0 * thickness / RADIUS * (1.0 / stretch - stretch.powi(-7))
}

/// Within 0.5 % to a stretch of 1.3; at t / R = 0.01 the thickness changes the pressure by less than 0.1 %.
#[test]
fn pressure_follows_the_membrane_formula_to_stretch_1_3() {
    let thickness = 0.01 * RADIUS;
    let mut model = sphere(thickness);
    let mut solver = NativeSolver::new(model.pattern()).unwrap();
    let largest = membrane_pressure(1.3, thickness);
    let path =
        follow(&mut model, &mut solver, largest, Vec::new(), &PathSettings::default()).unwrap();
    assert_eq!(path.ending, Ending::Reached);
    let rest = path.points[0].conjugate;
    for point in &path.points[1..] {
        let stretch = (point.conjugate / rest).cbrt();
        let exact = membrane_pressure(stretch, thickness);
        assert!(
            (point.load / exact - 1.0).abs() < 5e-3,
            "stretch {stretch}: {} {exact}",
            point.load
        );
    }
    let last = path.points.last().unwrap();
    let stretch = (last.conjugate / rest).cbrt();
    assert!((stretch - 1.3).abs() < 0.02, "{stretch}");
}
