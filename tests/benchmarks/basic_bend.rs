//! The published seed `y^2 + x^4 + sin(3.2 z) + cos(theta) - 0.6` bent by 0.012 MPa.
//!
//! References: CalculiX 2.20, neo-Hookean mu = 1 MPa, nu = 0.49, a wall of 1.6 mm clamped below 2.4 mm, the pressure on the
//! chamber's faces; mean motion of the mid-surface's vertices above 95 % of the length, growth of the enclosed volume.
//!
//! ```text
//! the mesh of the seed        (-11.0641, -0.0096, +0.9932) mm     973.6 mm^3    17,340 quadratic tetrahedra, straight edges
//! our mesh of the network     (-10.6102, -0.0204, +0.6845) mm     984.3 mm^3    curved, on the shell's own surface
//! ```

use std::path::Path;

use pneumorph::field::{CappedField, CompiledNetwork, DesignBox};
use pneumorph::fitness::observations;
use pneumorph::io::stl;
use pneumorph::math::Vec3;
use pneumorph::mesh::{MeshSettings, ShellMesh, ShellSettings, shell_of_field};
use pneumorph::model::contact::PlaneSettings;
use pneumorph::model::material::{Material, NeoHookean};
use pneumorph::model::system::{LoadedSystem, System};
use pneumorph::model::{PartModel, Support};
use pneumorph::solve::{Backend, Ending, PathPoint, PathSettings, follow};

const PRESSURE: f64 = 0.012;

fn shell() -> ShellMesh {
    let surface = stl::read(Path::new("tests/data/basic_bend.stl"), stl::WELD_TOLERANCE).unwrap();
    ShellMesh::new(surface, &ShellSettings::default()).unwrap()
}

/// The path to full pressure, with a plane so many millimetres away where one is given.
fn walked(mesh: &ShellMesh, backend: Backend, plane: Option<f64>) -> (PartModel, Vec<PathPoint>) {
    let before = |distance| PlaneSettings::new(Vec3::x(), distance, PRESSURE);
    let planes: Vec<PlaneSettings> = plane.map(before).into_iter().collect();
    let material = Material::NeoHookean(NeoHookean { mu: 1.0 });
    let mut model = PartModel::new(mesh, &material, &Support::Clamp, &planes.into()).unwrap();
    let mut solver = backend.solver(model.pattern()).unwrap();
    let settings = PathSettings::default();
    let path = follow(&mut model, solver.as_mut(), PRESSURE, Vec::new(), &settings).unwrap();
    assert_eq!(path.ending, Ending::Reached);
    (model, path.points)
}

/// The tip's distance from the `solid`'s as a share of its motion, and the error of the volume's growth.
fn errors(mesh: &ShellMesh, solid: Vec3, solid_growth: f64) -> [f64; 2] {
    let (model, points) = walked(mesh, Backend::Native, None);
    let rows = observations(mesh, &model, &points);
    let last = rows.last().unwrap();
    let tip = Vec3::new(last.tip_x, last.tip_y, last.tip_z);
    let growth = last.volume - rows[0].volume;
    [(tip - solid).norm() / solid.norm(), (growth / solid_growth - 1.0).abs()]
}

/// Within 3 %. The solid is known to no better: finer triangles along the wall move its tip by 3.2 %, curved ones by 1.3 %,
/// a Poisson's ratio from 0.49 to 0.5, which the shell has, by -2.2 %. The thin-shell theory takes 1.9 %.
#[test]
fn tip_moves_like_the_solid() {
    let [tip, growth] = errors(&shell(), Vec3::new(-11.0641, -0.0096, 0.9932), 973.6);
    assert!(tip < 0.03, "tip {tip}");
    assert!(growth < 0.03, "volume {growth}");
}

/// Within 3 % again, from the network on: field, isosurface, remesher and shell.
#[test]
fn tip_of_our_own_mesh_moves_like_the_solid_around_it() {
    let network = include_str!("../../examples/networks/basic_bend.toml").parse().unwrap();
    let meshing = MeshSettings { edge: 2.0, ..Default::default() };
    let compiled = CompiledNetwork::new(&network);
    let field = CappedField::new(compiled, DesignBox::default(), meshing.rim_radius).unwrap();
    let mesh = shell_of_field(&field, &meshing, &ShellSettings::default()).unwrap();
    let [tip, growth] = errors(&mesh, Vec3::new(-10.6102, -0.0204, 0.6845), 984.3);
    assert!(tip < 0.03, "tip {tip}");
    assert!(growth < 0.03, "volume {growth}");
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
    let exact = (near - far) / 0.2;
    let force = forces[forces.len() - 1];
    assert!((force / exact - 1.0).abs() < 1e-3, "{force} {exact}");
}

/// The pressure on a closed surface has no resultant: what the clamp bears, which is the residual at its nodes when nothing is
/// held, is what the plane takes; to 1e-6 of it, as Newton's method stops at 1e-9 of a larger scale.
#[test]
fn clamp_bears_what_the_plane_takes() {
    let mesh = shell();
    let (model, points) = walked(&mesh, Backend::Native, Some(5.0));
    let PathPoint { x: u, memory, .. } = points.last().unwrap();
    let plane = model.plane_states(u, memory)[0];
    assert!((plane.force.x + model.plane_force(u)).abs() < 1e-12 * model.plane_force(u));
    assert!(plane.bearing_area > 0.0 && plane.bearing_area <= plane.area);
    let material = Material::NeoHookean(NeoHookean { mu: 1.0 });
    let settings = PlaneSettings::new(Vec3::x(), 5.0, PRESSURE);
    let free = Support::Unknowns(Vec::new());
    let mut free = PartModel::new(&mesh, &material, &free, &vec![settings].into()).unwrap();
    free.set_load(PRESSURE);
    let mut residual = vec![0.0; u.len()];
    free.residual(u, &mut residual).unwrap();
    let held = mesh.held_vertices();
    let reaction: Vec3 =
        held.iter().map(|&v| Vec3::from_fn(|axis, _| residual[3 * v as usize + axis])).sum();
    let size = plane.force.norm();
    assert!((reaction - plane.force).norm() < 1e-6 * size, "{reaction} {}", plane.force);
}

/// Two independent factorisations and Newton loops walk through the same states.
#[cfg(feature = "petsc")]
#[test]
fn petsc_and_native_agree_at_every_step() {
    let mesh = shell();
    for plane in [None, Some(5.0)] {
        let rows = [Backend::Native, Backend::Petsc].map(|backend| {
            let (model, points) = walked(&mesh, backend, plane);
            let rows = observations(&mesh, &model, &points);
            // Steps between samples may hang on one iteration more.
            rows.into_iter().filter(|row| row.is_sample).collect::<Vec<_>>()
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
