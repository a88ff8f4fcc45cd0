//! The published seed `y^2 + x^4 + sin(3.2 z) + cos(theta) - 0.6` bent by 0.012 MPa.
//!
//! Reference: CalculiX 2.20, 17,340 quadratic tetrahedra (two layers of the 1.6 mm wall around the same
//! mid-surface), neo-Hookean mu = 1 MPa, nu = 0.49, clamped below 2.4 mm: the 84 mid-surface vertices above
//! 95 % of the length move by (-9.8628, +0.0319, +1.2438) mm on average, the enclosed volume grows by
//! 970.0 mm^3. That solid is itself about 1 % stiff.

use std::path::Path;

use pneumorph::fitness::observations;
use pneumorph::io::stl;
use pneumorph::math::Vec3;
use pneumorph::mesh::{ShellMesh, ShellSettings};
use pneumorph::model::contact::PlaneSettings;
use pneumorph::model::material::{Material, NeoHookean};
use pneumorph::model::system::System;
use pneumorph::model::{ShellModel, Support};
use pneumorph::solve::{Backend, Ending, PathPoint, PathSettings, follow};

const PRESSURE: f64 = 0.012;

fn shell() -> ShellMesh {
    let surface = stl::read(Path::new("tests/data/basic_bend.stl"), stl::WELD_TOLERANCE).unwrap();
    ShellMesh::new(surface, &ShellSettings::default()).unwrap()
}

/// The path to full pressure, with a plane so many millimetres away where one is given.
fn walked(mesh: &ShellMesh, backend: Backend, plane: Option<f64>) -> (ShellModel, Vec<PathPoint>) {
    let before = |distance| PlaneSettings::before(mesh, Vec3::x(), distance, PRESSURE);
    let planes: Vec<PlaneSettings> = plane.map(before).into_iter().collect();
    let material = Material::NeoHookean(NeoHookean { mu: 1.0 });
    let mut model = ShellModel::new(mesh, &material, &Support::Clamp, &planes).unwrap();
    let mut solver = backend.solver(model.pattern()).unwrap();
    let settings = PathSettings::default();
    let path = follow(&mut model, solver.as_mut(), PRESSURE, Vec::new(), &settings).unwrap();
    assert_eq!(path.ending, Ending::Reached);
    (model, path.points)
}

/// Within 15 % of the solid's tip. Shells of this network with edges of 1.5 to 4 mm agree to 3 %, so most of what is
/// left (13 %) is the difference between a thin-shell theory and a wall as thick as its folds are sharp.
/// The volume, which the folds decide less, agrees to 1 %.
#[test]
fn tip_moves_like_the_solid() {
    let mesh = shell();
    let (model, points) = walked(&mesh, Backend::Native, None);
    let rows = observations(&mesh, &model, &points);
    let last = rows.last().unwrap();
    let solid = Vec3::new(-9.8628, 0.0319, 1.2438);
    let tip = Vec3::new(last.tip_x, last.tip_y, last.tip_z);
    let error = (tip - solid).norm() / solid.norm();
    assert!(error < 0.15, "tip {tip:?}, solid {solid:?}, error {error}");
    let growth = last.volume - rows[0].volume;
    assert!((growth / 970.0 - 1.0).abs() < 0.02, "volume grows by {growth} mm^3");
}

/// The pressure's work is stored in wall and barrier, to 1e-4 at every step: Hermite's rule has fourth order.
#[test]
fn work_of_the_pressure_is_stored() {
    let mesh = shell();
    for plane in [None, Some(5.0)] {
        let (_, points) = walked(&mesh, Backend::Native, plane);
        for point in &points[1..] {
            let stored = point.stored_energy - points[0].stored_energy;
            let error = (point.work / stored - 1.0).abs();
            assert!(error < 1e-4, "plane {plane:?}, pressure {}: {error}", point.load);
        }
    }
}

/// The plane holds the part back, is pressed on ever harder, and is never passed.
///
/// Its force is the derivative of the equilibrium's total energy with respect to its distance: a central
/// difference over 0.2 mm, whose own error is of second order.
#[test]
fn plane_blocks_the_part() {
    let mesh = shell();
    let (model, blocked) = walked(&mesh, Backend::Native, Some(5.0));
    let rows = observations(&mesh, &model, &blocked);
    let forces: Vec<f64> = rows.iter().map(|row| row.plane_force).collect();
    assert!(forces.is_sorted() && forces[0] == 0.0, "{forces:?}");
    for point in &blocked {
        assert!(model.smallest_gap(&point.x) > 0.0);
    }
    let [near, far] = [4.9, 5.1].map(|distance| {
        let (_, points) = walked(&mesh, Backend::Native, Some(distance));
        let last = points.last().unwrap();
        last.stored_energy - last.load * last.conjugate
    });
    let force = (near - far) / 0.2;
    assert!((forces[10] / force - 1.0).abs() < 1e-3, "{} {force}", forces[10]);
}

/// Two independent factorisations and Newton loops walk through the same states.
#[cfg(feature = "petsc")]
#[test]
fn petsc_and_native_agree_at_every_step() {
    let mesh = shell();
    for plane in [None, Some(5.0)] {
        let rows = [Backend::Native, Backend::Petsc].map(|backend| {
            let (model, points) = walked(&mesh, backend, plane);
            observations(&mesh, &model, &points)
        });
        assert_eq!(rows[0].len(), rows[1].len());
        for (native, petsc) in rows[0].iter().zip(&rows[1]).skip(1) {
            let pairs = [
                (native.tip_x, petsc.tip_x),
                (native.tip_y, petsc.tip_y),
                (native.tip_z, petsc.tip_z),
            ];
            for (native, petsc) in pairs {
                assert!((native / petsc - 1.0).abs() < 1e-8, "{native} {petsc}");
            }
        }
    }
}
