//! The published seed `y^2 + x^4 + sin(3.2 z) + cos(theta) - 0.6` bent by 0.012 MPa.
//!
//! Reference: CalculiX 2.20, 17,340 quadratic tetrahedra (two layers of the 1.6 mm wall around the same
//! mid-surface), neo-Hookean mu = 1 MPa, nu = 0.49, clamped below 2.4 mm: the 84 mid-surface vertices above
//! 95 % of the length move by (-9.8628, +0.0319, +1.2438) mm on average, the enclosed volume goes from
//! 14,982.78 to 15,952.80 mm^3. That solid is itself about 1 % stiff.

use std::path::Path;

use pneumorph::io::stl;
use pneumorph::mesh::{ShellMesh, ShellSettings};
use pneumorph::model::material::{Material, NeoHookean};
use pneumorph::model::system::System;
use pneumorph::model::{ShellModel, Support};
use pneumorph::solve::{Ending, EquilibriumSolver, NativeSolver, PathSettings, follow};

#[test]
fn tip_moves_like_the_solid() {
    let surface = stl::read(Path::new("tests/data/basic_bend.stl"), stl::WELD_TOLERANCE).unwrap();
    let mesh = ShellMesh::new(surface, &ShellSettings::default()).unwrap();
    let material = Material::NeoHookean(NeoHookean { mu: 1.0 });
    let mut model = ShellModel::new(&mesh, &material, &Support::Clamp, &[]).unwrap();
    let mut solver = NativeSolver::new(model.pattern()).unwrap();
    let path = follow(&mut model, &mut solver, 0.012, Vec::new(), &PathSettings::default()).unwrap();
    for point in &path.points {
        let u = model.vertex_displacements(&point.x);
        let tip = mesh.tip.iter().map(|&v| u[v as usize]).sum::<pneumorph::math::Vec3>()
            / mesh.tip.len() as f64;
        println!(
            "{:.4} V {:.3} tip {:.5?} its {} shifted {} work {:.6} stored {:.6}",
            point.load, point.conjugate, tip.as_slice(), point.newton_iterations, point.shifted, point.work, point.stored_energy - path.points[0].stored_energy
        );
    }
    println!("{:?} {:?}", path.ending, solver.times());
    assert_eq!(path.ending, Ending::Reached);
}
