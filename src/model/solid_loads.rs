//! Loads on solids besides the pressure in a closed chamber: dead tractions, and chambers that planes of symmetry cut open.
//!
//! ```text
//! f_i = int N_i t dA        over quadratic faces at rest, by six points: exact to degree 4
//! ```
//!
//! Source of the rule: Dunavant (1985).

use super::element::ElementPoints;
use super::load::{ChamberPressure, Fan, LidFan};
use crate::math::Vec3;
use crate::mesh::SolidMesh;

/// A plane of symmetry that cuts a chamber.
#[derive(Clone, Debug, PartialEq)]
pub struct Cut {
    /// The nodes in it; they do not leave it.
    pub nodes: Vec<u32>,
    /// A point of the plane, in the planes through the origin too that meet it, mm.
    pub apex: Vec3,
}

/// How a solid is held and loaded, and what is shown of it.
#[derive(Clone, Debug, Default)]
pub struct SolidLoads<'a> {
    /// Unknowns that are held, `3 node + axis`.
    pub held: Vec<u32>,
    /// Forces per area at rest (MPa) on faces, as [`SolidMesh::outer`], at a load of 1; they keep their direction.
    pub tractions: Vec<(Vec<[u32; 6]>, Vec3)>,
    /// Planes of symmetry that cut the chamber open and miss the origin.
    pub cuts: Vec<Cut>,
    /// Points at rest whose displacements are shown, mm; `None`: the corners of the boundary.
    pub shown: Option<&'a [Vec3]>,
}

impl From<Vec<u32>> for SolidLoads<'_> {
    /// Held so, with a pressure in its chamber alone.
    fn from(held: Vec<u32>) -> Self {
        Self { held, ..Self::default() }
    }
}

impl SolidLoads<'_> {
    /// The forces of the tractions on each node of `mesh`, N.
    pub(super) fn nodal_forces(&self, mesh: &SolidMesh) -> Vec<Vec3> {
        let mut forces = vec![Vec3::zeros(); mesh.positions.len()];
        for (faces, per_area) in &self.tractions {
            for face in faces {
                let corners = face.map(|node| mesh.positions[node as usize]);
                for (node, area) in face.iter().zip(areas(&corners)) {
                    forces[*node as usize] += area * per_area;
                }
            }
        }
        forces
    }

    /// The chamber of `mesh`, closed across its cuts and by its lids.
    pub(super) fn chamber(&self, mesh: &SolidMesh) -> ChamberPressure {
        let points = |&face: &[u32; 6]| ElementPoints::of_quadratic(face);
        let mut fans = Vec::new();
        for Cut { nodes, apex } in &self.cuts {
            let is_cut = |node: u32| nodes.binary_search(&node).is_ok();
            for face in &mesh.chamber {
                for k in 0..3 {
                    let along = [(k + 1) % 3, 3 + k, (k + 2) % 3];
                    if along.iter().all(|&point| is_cut(face[point])) {
                        fans.push(Fan { points: points(face), along, apex: *apex });
                    }
                }
            }
        }
        let faces: Vec<ElementPoints> = mesh.chamber.iter().map(points).collect();
        let lids = mesh.lids.iter().map(|lid| LidFan::new(&lid.rim, &mesh.positions)).collect();
        ChamberPressure::cut(&faces, fans, Vec3::zeros()).with_lids(lids)
    }
}

/// The shares of a quadratic face's nodes in its area, mm^2.
fn areas(x: &[Vec3; 6]) -> [f64; 6] {
    let mut areas = [0.0; 6];
    for (weight, a) in RULE {
        for k in 0..3 {
            let mut l = [a; 3];
            l[k] = 1.0 - 2.0 * a;
            let (mut by_second, mut by_third) = (Vec3::zeros(), Vec3::zeros());
            for (x, [second, third]) in x.iter().zip(slopes(&l)) {
                by_second += second * x;
                by_third += third * x;
            }
            let area = 0.5 * weight * by_second.cross(&by_third).norm();
            for (sum, value) in areas.iter_mut().zip(shapes(&l)) {
                *sum += value * area;
            }
        }
    }
    areas
}

/// Weight, and the barycentric coordinate of which each of three points has two.
const RULE: [(f64, f64); 2] = [
    (0.223_381_589_678_011_47, 0.445_948_490_915_964_9),
    (0.109_951_743_655_321_87, 0.091_576_213_509_770_74),
];

/// Corners, then midpoints of the edges opposite to them.
fn shapes(l: &[f64; 3]) -> [f64; 6] {
    std::array::from_fn(|k| match k.checked_sub(3) {
        None => l[k] * (2.0 * l[k] - 1.0),
        Some(edge) => 4.0 * l[(edge + 1) % 3] * l[(edge + 2) % 3],
    })
}

/// Their derivatives by the second and the third coordinate, the first being the rest to 1.
fn slopes(l: &[f64; 3]) -> [[f64; 2]; 6] {
    let rates = [[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]];
    std::array::from_fn(|k| match k.checked_sub(3) {
        None => rates[k].map(|rate| (4.0 * l[k] - 1.0) * rate),
        Some(edge) => {
            let [a, b] = [(edge + 1) % 3, (edge + 2) % 3];
            std::array::from_fn(|axis| 4.0 * (l[a] * rates[b][axis] + l[b] * rates[a][axis]))
        }
    })
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use approx::assert_relative_eq;

    use super::*;
    use crate::mesh::unit_lattice;
    use crate::model::material::{Material, NeoHookean};
    use crate::model::system::LoadedSystem;
    use crate::model::{PartModel, PartSetup};

    fn model(mesh: &SolidMesh, loads: &SolidLoads<'_>) -> PartModel {
        let material = Material::NeoHookean(NeoHookean { mu: 1.3 });
        PartModel::of_solid(mesh, 0.5, &material, loads, &PartSetup::default()).unwrap()
    }

    /// A uniform traction on a flat face: nothing on its corners, a third of each triangle on midpoints; its work is
    /// traction, area and way.
    #[test]
    fn flat_faces_share_their_traction() {
        let sides = Vec3::new(3.0, 2.0, 1.0);
        let mesh = SolidMesh::block([2, 2, 1], &|x| x.component_mul(&sides));
        let traction = Vec3::new(0.1, -0.4, 0.7);
        let tractions = vec![(mesh.faces_where(|x| x.z == 1.0), traction)];
        let loads = SolidLoads { tractions, ..Default::default() };
        let forces = loads.nodal_forces(&mesh);
        let total: Vec3 = forces.iter().sum();
        assert_relative_eq!(total, 6.0 * traction, max_relative = 1e-14);
        let model = model(&mesh, &loads);
        assert!(forces[..mesh.corners].iter().all(|force| force.norm() < 1e-15));
        let way = Vec3::new(-0.2, 0.3, 0.5);
        let u: Vec<f64> = (0..model.unknowns())
            .map(|k| if k < 3 * mesh.positions.len() { way[k % 3] } else { 0.0 })
            .collect();
        assert_relative_eq!(model.conjugate(&u), 6.0 * traction.dot(&way), max_relative = 1e-13);
    }

    /// A curved face has its curved area: an eighth of a cylinder in arcs of 1/16 of a right angle, to their fourth order.
    #[test]
    fn curved_faces_have_their_area() {
        let tube = |x: Vec3| {
            let angle = 0.5 * FRAC_PI_2 * x.x;
            (5.0 + x.z) * Vec3::new(angle.cos(), angle.sin(), 0.0) + 3.0 * x.y * Vec3::z()
        };
        let mesh = SolidMesh::block([8, 2, 1], &tube);
        let tractions = vec![(mesh.faces_where(|x| x.xy().norm() > 5.99), Vec3::x())];
        let loads = SolidLoads { tractions, ..Default::default() };
        let total: Vec3 = loads.nodal_forces(&mesh).iter().sum();
        assert_relative_eq!(total.x, 2.0 * PI * 6.0 / 8.0 * 3.0, max_relative = 1e-6);
    }

    /// A quarter of a tube between planes of symmetry holds its quarter of the volume, and the pressure has the same
    /// forces in the plane that misses the origin as in that through it.
    #[test]
    fn cut_chamber_is_closed_by_its_planes() {
        let place = |x: Vec3, height: f64| {
            let angle = FRAC_PI_2 * x.x;
            (5.0 + height) * Vec3::new(angle.cos(), angle.sin(), 0.0) + 3.0 * x.y * Vec3::z()
        };
        let mesh = SolidMesh::layers(&unit_lattice([6, 2]), 1, &place);
        let end = mesh.nodes_where(|x| (x.z - 3.0).abs() < 1e-12);
        let cuts = vec![Cut { nodes: end, apex: Vec3::new(0.0, 0.0, 3.0) }];
        let model = model(&mesh, &SolidLoads { cuts, ..Default::default() });
        let rest = vec![0.0; model.unknowns()];
        let exact = 25.0 * FRAC_PI_2 * 0.5 * 3.0;
        assert_relative_eq!(model.volume(&rest), exact, max_relative = 1e-5);
        let mut direction = rest.clone();
        model.load_direction(&rest, &mut direction);
        // A half turn about x = y, z = 1.5 mm takes the lattice to itself, and one end to the other.
        let node = |degrees: f64, height: f64| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let place = Vec3::new(5.0 * cos, 5.0 * sin, height);
            3 * mesh.nodes_where(|x| (x - place).norm() < 1e-9)[0] as usize
        };
        let (near, far) = (node(37.5, 0.0), node(52.5, 3.0));
        for axis in 0..2 {
            let (near, far) = (direction[near + axis], direction[far + 1 - axis]);
            assert!(near > 0.1);
            assert_relative_eq!(near, far, max_relative = 1e-12);
        }
    }
}
