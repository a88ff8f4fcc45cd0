//! Chambers that are open at flat ends, closed by lids.

use pneumorph::math::Vec3;
use pneumorph::mesh::tetrahedra::Numbered;
use pneumorph::mesh::{SolidMesh, TetMesh};
use pneumorph::model::material::{Compressible, Material, NeoHookean, Rubber};
use pneumorph::model::system::System;
use pneumorph::model::{PartModel, PartSetup};
use pneumorph::solve::{Backend, Ending, PathSettings, follow};

/// Cells along the tube.
const LENGTH: usize = 3;

/// A square tube of 3 x 3 mm outside, 1 x 1 mm inside, along z, in cubes of 1 mm of six tetrahedra each.
fn tube() -> SolidMesh {
    let vertex = |[i, j, k]: [usize; 3]| ((i * 4 + j) * (LENGTH + 1) + k) as u32;
    let mut positions = Vec::new();
    for i in 0..4 {
        for j in 0..4 {
            positions.extend((0..=LENGTH).map(|k| Vec3::new(i as f64, j as f64, k as f64)));
        }
    }
    let mut tetrahedra = Vec::new();
    let columns = (0..9).filter(|&column| column != 4);
    for (column, k) in columns.flat_map(|column| (0..LENGTH).map(move |k| (column, k))) {
        for order in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
            let mut at = [column / 3, column % 3, k];
            let mut corners = [vertex(at); 4];
            for (corner, axis) in corners[1..].iter_mut().zip(order) {
                at[axis] += 1;
                *corner = vertex(at);
            }
            tetrahedra.push(corners);
        }
    }
    let is_inside = |face: [u32; 3]| {
        let middle = face.map(|v| positions[v as usize]).iter().sum::<Vec3>() / 3.0;
        (middle - Vec3::new(1.5, 1.5, middle.z)).amax() < 0.6
    };
    let Numbered { mesh, .. } = TetMesh::of_tetrahedra(&positions, &tetrahedra, is_inside).unwrap();
    SolidMesh::straight(&mesh).with_lids().unwrap()
}

/// The pressure on a lid pulls at its rim. Averages of the stresses follow from the loads alone (virial theorem), so in a tube of any section
///
/// ```text
/// mean strain along it = p A_bore (1 - 2 nu) / (A_wall E)
/// ```
///
/// for cells that can strain evenly, however coarse; without the pull it is -2 nu in place of 1 - 2 nu.
#[test]
fn lids_pull_at_their_rims() {
    let (mu, nu) = (1.0, 0.3);
    let bulk_modulus = 2.0 * mu * (1.0 + nu) / (3.0 * (1.0 - 2.0 * nu));
    let material = Material::Compressible(Compressible {
        law: Rubber::NeoHookean(NeoHookean { mu }),
        bulk_modulus,
    });
    let mesh = tube();
    let base = mesh.nodes_where(|x| x.z == 0.0);
    let mut held: Vec<u32> = base.iter().map(|node| 3 * node + 2).collect();
    let node = |place: Vec3| mesh.nodes_where(|x| *x == place)[0];
    let (origin, along_x) = (node(Vec3::zeros()), node(Vec3::new(3.0, 0.0, 0.0)));
    held.extend([3 * origin, 3 * origin + 1, 3 * along_x + 1]);
    let top = mesh.faces_where(|x| x.z == LENGTH as f64);
    let pressure = 1e-3;
    let strain = |pressure: f64| {
        let mut model =
            PartModel::of_solid(&mesh, 1.0, &material, &held.clone().into(), &PartSetup::default())
                .unwrap();
        // Sums of exact numbers.
        assert!((model.volume(&vec![0.0; model.unknowns()]) - LENGTH as f64).abs() < 1e-12);
        let mut solver = Backend::Native.solver(model.pattern()).unwrap();
        let settings = PathSettings { steps: 1, ..PathSettings::default() };
        let walked = follow(&mut model, solver.as_mut(), pressure, Vec::new(), &settings).unwrap();
        assert_eq!(walked.ending, Ending::Reached);
        let u = &walked.points.last().unwrap().x;
        // A quadratic field's mean over a triangle is that of its midpoints; all triangles are equal.
        let rises: Vec<f64> =
            top.iter().flat_map(|face| &face[3..]).map(|&v| u[3 * v as usize + 2]).collect();
        rises.iter().sum::<f64>() / rises.len() as f64 / LENGTH as f64
    };
    let young_modulus = 2.0 * mu * (1.0 + nu);
    let exact = pressure / 8.0 * (1.0 - 2.0 * nu) / young_modulus;
    // What is even in the pressure goes; what is of third order is some (p / E)^2, 1e-7 of it, times numbers of order 10.
    let found = 0.5 * (strain(pressure) - strain(-pressure));
    assert!((found / exact - 1.0).abs() < 1e-5, "{found} {exact}");
}
