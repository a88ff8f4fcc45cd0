//! Walls under their own weight.

use pneumorph::math::Vec3;
use pneumorph::mesh::{Patch, ShellElement, ShellMesh, ShellSettings, SolidMesh};
use pneumorph::model::material::{Compressible, Material, NeoHookean, Rubber, StVenantKirchhoff};
use pneumorph::model::system::{LoadedSystem, System};
use pneumorph::model::{EdgeSupport, PartModel, PartSetup, PatchLoads, SolidLoads, Support};
use pneumorph::solve::{EquilibriumSolver, NativeSolver, NewtonEnding, NewtonSettings};
use pneumorph::surface::TriangleMesh;

fn weight(body_force: Vec3) -> PartSetup {
    PartSetup { body_force, ..PartSetup::default() }
}

/// The unknowns in equilibrium under the weight and `load`.
fn solved(model: &mut PartModel, load: f64) -> Vec<f64> {
    model.set_load(load);
    let mut u = vec![0.0; model.unknowns()];
    let mut solver = NativeSolver::new(model.pattern()).unwrap();
    let settings = NewtonSettings { tolerance: 1e-11, ..NewtonSettings::default() };
    let report = solver.solve(model, &mut u, &settings).unwrap();
    assert_eq!(report.ending, NewtonEnding::Converged, "{report:?}");
    u
}

/// A clamped strip between planes of symmetry sags by `b t L^4 / (8 D)`, `D = E t^3 / 12` without Poisson's effect (Timoshenko &
/// Woinowsky-Krieger 1959, section 2). Of second order in the length of cells, a quarter of the wall's thickness at last: 0.04 % for
/// both elements.
#[test]
fn strip_sags_under_its_weight() {
    let (length, thickness, young_modulus): (f64, f64, f64) = (12.0, 0.5, 1000.0);
    let law = StVenantKirchhoff { young_modulus, poisson_ratio: 0.0 };
    let material = Material::StVenantKirchhoff(law);
    let body_force = 1e-8;
    let stiffness = young_modulus * thickness.powi(3) / 12.0;
    let exact = body_force * thickness * length.powi(4) / (8.0 * stiffness);
    let symmetry = EdgeSupport::Symmetry(1);
    let supports = [EdgeSupport::Clamped, EdgeSupport::Free, symmetry, symmetry];
    let loads = PatchLoads { supports, ..PatchLoads::default() };
    for element in [ShellElement::Loop, ShellElement::MidEdge] {
        let errors = [24, 48].map(|cells| {
            let flat = |s: f64, t: f64| Vec3::new(s, t, 0.0);
            let patch =
                Patch::new([cells, 4], [0.0, length], [0.0, 1.0], thickness, &flat).unwrap();
            let setup = weight(-body_force * Vec3::z());
            let mut model =
                PartModel::of_patch(&patch, element, &material, &loads, &setup).unwrap();
            let u = solved(&mut model, 0.0);
            let tip = patch.vertex(length, 0.5).unwrap() as usize;
            (model.vertex_displacements(&u)[tip].z / -exact - 1.0).abs()
        });
        assert!(errors[1] < 1e-3 && errors[1] < errors[0], "{element:?}: {errors:?}");
    }
}

/// A bar that hangs from its upper face is stretched by `b L^2 / (2 E)`, and narrows where it bears more; the linear theory's answer is
/// quadratic, which quadratic cells have exactly (Timoshenko & Goodier 1970, section 97). Strains of 1e-6 leave that of a rubber.
#[test]
fn bar_is_stretched_by_its_weight() {
    let (mu, poisson_ratio) = (1.0, 0.3);
    let young_modulus = 2.0 * mu * (1.0 + poisson_ratio);
    let bulk_modulus = young_modulus / (3.0 * (1.0 - 2.0 * poisson_ratio));
    let law = Rubber::NeoHookean(NeoHookean { mu });
    let material = Material::Compressible(Compressible { law, bulk_modulus });
    let length = 4.0;
    let body_force = 1e-6 * young_modulus / length;
    let mesh = SolidMesh::block([1, 1, 3], &|x| Vec3::new(x.x, x.y, length * x.z));
    let along = |axis: usize| {
        mesh.nodes_where(|x| x[axis] == 0.0).into_iter().map(move |node| 3 * node + axis as u32)
    };
    let origin = mesh.nodes_where(|x| *x == Vec3::zeros())[0];
    let held = along(0).chain(along(1)).chain([3 * origin + 2]).collect();
    // The face at z = 0 is drawn back by what the bar weighs.
    let tractions = vec![(mesh.faces_where(|x| x.z == 0.0), -body_force * length * Vec3::z())];
    let loads = SolidLoads { held, tractions, ..SolidLoads::default() };
    let setup = weight(body_force * Vec3::z());
    let mut model = PartModel::of_solid(&mesh, 1.0, &material, &loads, &setup).unwrap();
    let u = solved(&mut model, 1.0);
    for (x, u) in mesh.positions.iter().zip(u.as_chunks::<3>().0) {
        let narrowing = -poisson_ratio * (length - x.z);
        let across = poisson_ratio * (x.x * x.x + x.y * x.y);
        let rise = length * x.z - 0.5 * (x.z * x.z + across);
        let exact = body_force / young_modulus * Vec3::new(narrowing * x.x, narrowing * x.y, rise);
        let error = (Vec3::from(*u) - exact).norm() * young_modulus / (body_force * length.powi(2));
        // Squares of strains, over a length of four widths.
        assert!(error < 1e-5, "{x}: {error:e}");
    }
}

/// The clamp of a closed shell bears its weight, `4 pi R^2 t b` but for what 642 vertices leave of a sphere; the pressure has no part in
/// it, and its work counts no weight.
#[test]
fn clamp_bears_the_weight() {
    let (radius, thickness) = (10.0, 1.0);
    let settings = ShellSettings { thickness, clamp_height: 2.0, ..ShellSettings::default() };
    let mesh = ShellMesh::new(TriangleMesh::sphere(radius, 3), &settings).unwrap();
    let material = Material::NeoHookean(NeoHookean { mu: 1.0 });
    let body_force = Vec3::new(2e-6, 0.0, -1e-5);
    let model =
        |setup: &PartSetup| PartModel::new(&mesh, &material, &Support::Clamp, setup).unwrap();
    let mut heavy = model(&weight(body_force));
    let exact = 4.0 * std::f64::consts::PI * radius * radius * thickness * body_force;
    for pressure in [0.0, 0.01] {
        let u = solved(&mut heavy, pressure);
        let reaction = heavy.reaction(&u, pressure).unwrap();
        // Of the sphere's area, of fourth order in edges of 1.5 mm; the limit surface is fitted to it.
        assert!((reaction.force + exact).norm() < 1e-3 * exact.norm(), "{}", reaction.force);
    }
    let u: Vec<f64> = (0..heavy.unknowns()).map(|k| 1e-3 * (k % 7) as f64).collect();
    assert_eq!(heavy.conjugate(&u), model(&PartSetup::default()).conjugate(&u));
}
