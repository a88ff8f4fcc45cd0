//! Checks of the scenes under `verify/curves`: paths that lose their stability, turn back, or have no potential, against whole
//! curves of closed form or from tables.

use std::f64::consts::FRAC_1_SQRT_2;
use std::path::Path;

use super::cases::{CURVES, Case, SHELLS, case};
use super::files::BuiltIn;
use crate::mesh::ShellElement;
use crate::model::system::System;
use crate::scene::Unobserved;
use crate::scene::part::patch_part::PatchSection;
use crate::scene::scene_file::SceneFile;
use crate::scene::shape::Shape;
use crate::scene::verify_section::{MeshSize, Reference};
use crate::solve::{Backend, Stop};

fn curve(name: &str) -> Case {
    case(&CURVES, name).unwrap_or_else(|error| panic!("{error:#}"))
}

fn cases() -> Vec<Case> {
    CURVES.names().map(curve).collect()
}

fn shape(scene: &SceneFile) -> Shape {
    let source = scene.part.source(Path::new(""), &BuiltIn).unwrap();
    Shape::new(scene, &source, &Unobserved).unwrap()
}

/// `(load, value)` of a reference.
fn points(reference: &Reference) -> impl Iterator<Item = (f64, f64)> {
    reference.load.iter().copied().zip(reference.value.iter().copied())
}

#[test]
fn every_case_is_complete_and_makes_a_shell() {
    let cases = cases();
    assert!(cases.len() >= 11);
    for Case { name, mut scene, verify, .. } in cases {
        for watch in &scene.watches {
            let compared = verify.reference.iter().filter(|r| r.watch == watch.name).count();
            assert_eq!(compared, 1, "{name}: {}", watch.name);
        }
        assert!(!verify.source.is_empty(), "{name}");
        assert!(verify.limit_load.is_some() || !verify.reference.is_empty(), "{name}");
        for accept in &verify.accept {
            scene.wall.element = Some(accept.element);
            let model = shape(&scene.with_mesh(accept.mesh).unwrap()).model;
            assert_eq!(model.is_conservative(), !name.starts_with("follower"), "{name}");
        }
        let elements = [ShellElement::Loop, ShellElement::MidEdge];
        let accepts = |element| verify.accept.iter().filter(|a| a.element == element).count();
        assert_eq!(elements.map(accepts), [1, 1], "{name}");
    }
}

/// Where stability is lost does not want a curve: the inertia of a path at growing loads tells it.
#[test]
fn buckling_loads_are_those_of_the_closed_forms() {
    for name in ["column_perfect", "ring_external_pressure"] {
        let Case { scene, verify, .. } = curve(name);
        for accept in &verify.accept {
            let mut scene = scene.with_mesh(accept.mesh).unwrap();
            scene.wall.element = Some(accept.element);
            let measured = shape(&scene)
                .measure(&scene, Backend::Native, 0.0, Stop::NEVER, &Unobserved)
                .unwrap();
            let error = 100.0 * (measured.limit_load.unwrap() / verify.limit_load.unwrap() - 1.0);
            let accepted = accept.miss.as_ref().map_or(accept.error, |miss| miss.up_to);
            assert!(error.abs() < accepted, "{name} {:?}: {error} %", accept.element);
        }
    }
}

/// The roofs' curves begin as their tables under `verify/shells` do.
#[test]
fn roofs_begin_as_their_tables() {
    for (name, scale) in [("hinged_roof_thick", 1.0), ("hinged_roof_thin", 4.0)] {
        let [curve, table] = [&CURVES, &SHELLS].map(|folder| case(folder, name).unwrap());
        let points_of = |case: &Case| points(&case.verify.reference[0]).collect::<Vec<_>>();
        let (curve, table) = (points_of(&curve), points_of(&table));
        for (curve, table) in curve.iter().zip(&table) {
            // Five digits, and the table's four.
            assert!((1.1 * curve.0 * scale - table.0).abs() < 1e-4, "{curve:?} {table:?}");
            assert_eq!(curve.1, table.1);
        }
    }
}

#[test]
fn balloons_are_membranes_of_their_rubbers() {
    for (name, c1, c2, limit) in [
        ("balloon_neo_hookean", 0.5, 0.0, 7.0_f64.powf(1.0 / 6.0)),
        ("balloon_mooney_rivlin", 0.5 / 1.1, 0.05 / 1.1, 1.4760698),
    ] {
        let Case { scene, verify, .. } = curve(name);
        assert_eq!(scene.wall.thickness / scene.part.sphere.unwrap().radius, 0.01);
        let share = |l: f64| {
            let pressure = 0.04 * (1.0 / l - l.powi(-7)) * (c1 + c2 * l * l);
            pressure / scene.load_settings().pressure
        };
        for (load, strain) in points(&verify.reference[0]) {
            assert!((share(1.0 + strain) - load).abs() < 1e-7, "{name}: {strain}");
        }
        // Flat at the limit point, to the square of the stretch's digits.
        assert!((share(limit) - verify.limit_load.unwrap()).abs() < 1e-7, "{name}");
        assert!(share(limit) > share(limit + 1e-3) && share(limit) > share(limit - 1e-3));
        let largest = verify.reference[0].value.iter().fold(0.0, |a: f64, b| a.max(*b));
        assert!((scene.load.volume_ratio.unwrap() - (1.0 + largest).powi(3)).abs() < 1e-12);
    }
}

/// The truss by the derivative of its energy, and no slimmer than the bar that snaps before it buckles.
#[test]
fn truss_is_a_bar_that_stays_straight() {
    let Case { scene, verify, .. } = curve("von_mises_truss");
    let patch: &PatchSection = scene.part.patch.as_ref().unwrap();
    let surface = patch.surface().unwrap();
    let (base, top) = (surface(0.0, 0.0), surface(1.0, 0.0));
    let (square, height) = ((top - base).norm_squared(), top.z - base.z);
    let width = patch.t[1] - patch.t[0];
    let section = scene.wall.thickness * width;
    let force = -width * scene.forces[0].per_length.unwrap()[2];
    let energy = |w: f64| {
        let y = height - w;
        let strain = (y * y - height * height) / (2.0 * square);
        0.5 * scene.material.material().unwrap().young_modulus()
            * section
            * square.sqrt()
            * strain
            * strain
    };
    for (load, w) in points(&verify.reference[0]) {
        let slope = (energy(w + 1e-4) - energy(w - 1e-4)) / 2e-4;
        assert!((slope / force - load).abs() < 1e-6, "{w}: {slope}");
    }
    let euler = (std::f64::consts::PI * scene.wall.thickness).powi(2) / (12.0 * square);
    assert!(height * height / (2.0 * square) < FRAC_1_SQRT_2 * euler);
}

/// The states of Loop's strips, narrow and wide, are those of the bar: its strain is uniform.
#[test]
fn truss_has_the_states_of_its_bar() {
    let Case { scene, verify, .. } = curve("von_mises_truss");
    // In % of the full load. Three points of quadrature miss little of a cubic; one point, which is
    // inside of strips of four cells and more, misses what three beside it do not.
    for (cells, tolerance) in [([8, 2], 0.01), ([16, 4], 0.1), ([8, 8], 0.1)] {
        let mut scene = scene.with_mesh(MeshSize::Cells(cells)).unwrap();
        scene.wall.element = Some(ShellElement::Loop);
        let measured =
            shape(&scene).measure(&scene, Backend::Native, 0.0, Stop::NEVER, &Unobserved).unwrap();
        let points = &measured.curves[0].points;
        assert!(points.last().unwrap().value > 4.0, "{cells:?}");
        for point in points {
            // P ~ y (h^2 - y^2), at most 2 h^3 / (3 sqrt(3)), which is at 0.8 of the load.
            let y = 2.0 - point.value;
            let exact = 0.8 * y * (4.0 - y * y) * 3.0 * 3.0_f64.sqrt() / 16.0;
            let error = 100.0 * (point.load - exact).abs();
            assert!(error < tolerance, "{cells:?} {}: {error} %", point.value);
        }
    }
    assert_eq!(verify.limit_load, Some(0.8));
}

/// Meshes of a ladder are refined in one direction.
#[test]
fn ladders_climb() {
    for Case { name, verify, .. } in cases() {
        let size = |mesh: &MeshSize| match *mesh {
            MeshSize::Cells([n, m]) => (n * m) as f64,
            MeshSize::Subdivisions(n) => n as f64,
            MeshSize::Edge(edge) => 1.0 / edge,
        };
        assert!(verify.meshes.is_sorted_by(|a, b| size(a) < size(b)), "{name}");
    }
}
