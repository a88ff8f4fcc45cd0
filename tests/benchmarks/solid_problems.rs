//! Bodies of quadratic tetrahedra whose deformation is known, for the benchmarks and for the example that prints tables.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_3, PI};

use pneumorph::math::Vec3;
use pneumorph::mesh::{SolidMesh, unit_lattice};
use pneumorph::model::material::{Compressible, Material, NeoHookean, Rubber};
use pneumorph::model::system::System;
use pneumorph::model::{Cut, PartModel, PartSetup, SolidLoads};
use pneumorph::solve::{
    Backend, Ending, NewtonEnding, NewtonSettings, Path, PathPoint, PathSettings, Programme,
    Supply, follow,
};
use pneumorph::surface::TriangleMesh;

/// A body, its supports and its loads.
pub(crate) struct Problem {
    pub(crate) mesh: SolidMesh,
    pub(crate) model: PartModel,
}

/// How a body answers to a change of its volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Volume {
    Incompressible,
    /// With a Poisson's ratio of 0.4999.
    NearlyIncompressible,
}

impl Volume {
    pub(crate) const ALL: [Self; 2] = [Self::Incompressible, Self::NearlyIncompressible];

    /// Neo-Hookean rubber with a shear modulus, MPa.
    pub(crate) fn rubber(self, mu: f64) -> Material {
        let law = NeoHookean { mu };
        match self {
            Self::Incompressible => Material::NeoHookean(law),
            Self::NearlyIncompressible => {
                let nu = 0.4999;
                let bulk_modulus = 2.0 / 3.0 * mu * (1.0 + nu) / (1.0 - 2.0 * nu);
                Material::Compressible(Compressible { law: Rubber::NeoHookean(law), bulk_modulus })
            }
        }
    }
}

/// Rounding of a coordinate of a lattice, mm.
const ROUNDING: f64 = 1e-9;

fn is_at(value: f64, place: f64) -> bool {
    (value - place).abs() < ROUNDING
}

/// Unknowns along one axis of the nodes that are wanted.
fn along(mesh: &SolidMesh, axis: u32, is_wanted: impl Fn(&Vec3) -> bool) -> Vec<u32> {
    mesh.nodes_where(is_wanted).iter().map(|node| 3 * node + axis).collect()
}

impl Problem {
    fn new(mesh: SolidMesh, size: f64, material: &Material, held: &[Vec<u32>]) -> Self {
        Self::under(mesh, size, material, &held.concat().into())
    }

    fn under(mesh: SolidMesh, size: f64, material: &Material, loads: &SolidLoads<'_>) -> Self {
        let setup = PartSetup::default();
        let model = PartModel::of_solid(&mesh, size, material, loads, &setup).unwrap();
        // One pressure for each corner, whose pivots are the negative ones of a stable state.
        assert_eq!(model.stable_negative_pivots(), mesh.corners);
        Self { mesh, model }
    }

    /// The path through a programme, all of whose states are stable: under a given volume, which may cure one negative pivot.
    pub(crate) fn walked(
        &mut self,
        backend: Backend,
        programme: impl Into<Programme>,
        steps: usize,
    ) -> Path {
        let mut solver = backend.solver(self.model.pattern()).unwrap();
        let settings = PathSettings { steps, ..PathSettings::default() };
        let path =
            follow(&mut self.model, solver.as_mut(), programme, Vec::new(), &settings).unwrap();
        assert_eq!(path.ending, Ending::Reached);
        assert!(path.points.iter().all(|point| point.is_stable));
        path
    }

    /// The node at a place at rest.
    pub(crate) fn node_at(&self, place: Vec3) -> usize {
        let nodes = self.mesh.nodes_where(|x| (x - place).norm() < 1e3 * ROUNDING);
        assert_eq!(nodes.len(), 1, "nodes at {place:?}");
        nodes[0] as usize
    }
}

/// The inner radius of spheres and tubes, mm.
pub(crate) const INNER_RADIUS: f64 = 10.0;

/// An eighth of a thick sphere between three planes of symmetry, in `n` cells along a right angle.
pub(crate) fn sphere(
    n: usize,
    layers: usize,
    outer_over_inner: f64,
    material: &Material,
) -> Problem {
    let vertex = |i: usize, j: usize| (j * (2 * n + 3 - j) / 2 + i) as u32;
    let share = |k: usize| k as f64 / n as f64;
    let positions = (0..=n)
        .flat_map(|j| (0..=n - j).map(move |i| Vec3::new(share(n - i - j), share(i), share(j))));
    let upward = (0..n)
        .flat_map(|j| (0..n - j).map(move |i| [vertex(i, j), vertex(i + 1, j), vertex(i, j + 1)]));
    let downward = (1..n)
        .flat_map(|j| (1..=n - j).map(move |i| [vertex(i, j), vertex(i - 1, j), vertex(i, j - 1)]));
    let base = TriangleMesh {
        positions: positions.collect(),
        triangles: upward.chain(downward).collect(),
    };
    let thickness = INNER_RADIUS * (outer_over_inner - 1.0);
    let place = |x: Vec3, height: f64| (INNER_RADIUS + height * thickness) * x.normalize();
    let mesh = SolidMesh::layers(&base, layers, &place);
    let held = [0, 1, 2].map(|axis| along(&mesh, axis, |x| is_at(x[axis as usize], 0.0)));
    Problem::new(mesh, thickness, material, &held)
}

/// A quarter of a thick tube between two planes of symmetry, and two that keep its length; `n` cells around and one along.
pub(crate) fn tube(n: usize, layers: usize, outer_over_inner: f64, material: &Material) -> Problem {
    let thickness = INNER_RADIUS * (outer_over_inner - 1.0);
    let length = INNER_RADIUS * FRAC_PI_2 / n as f64;
    let place = |x: Vec3, height: f64| {
        let radius = INNER_RADIUS + height * thickness;
        let (sin, cos) = (FRAC_PI_2 * x.x).sin_cos();
        Vec3::new(radius * cos, radius * sin, length * x.y)
    };
    let mesh = SolidMesh::layers(&unit_lattice([n, 1]), layers, &place);
    let held = [
        along(&mesh, 0, |x| is_at(x.x, 0.0)),
        along(&mesh, 1, |x| is_at(x.y, 0.0)),
        along(&mesh, 2, |x| is_at(x.z, 0.0) || is_at(x.z, length)),
    ];
    let end =
        Cut { nodes: mesh.nodes_where(|x| is_at(x.z, length)), apex: Vec3::new(0.0, 0.0, length) };
    let loads = SolidLoads { held: held.concat(), cuts: vec![end], ..Default::default() };
    Problem::under(mesh, thickness, material, &loads)
}

/// The largest error of the pressure in a body that is inflated to `growth` times its volume: neo-Hookean of `mu` = 1 MPa,
/// stretched in two directions (sphere) or one (tube).
pub(crate) fn inflation_error(
    problem: &mut Problem,
    directions: i32,
    outer_over_inner: f64,
    growth: f64,
    backend: Backend,
) -> f64 {
    let at_rest = problem.model.volume(&vec![0.0; problem.model.unknowns()]);
    let programme = Programme::Driven { supply: Supply::Conjugate, end: growth * at_rest };
    let path = problem.walked(backend, programme, 8);
    let error = |point: &PathPoint| {
        let stretch = (point.conjugate / at_rest).powf(1.0 / f64::from(directions + 1));
        let exact = exact_pressure(directions, outer_over_inner, stretch);
        (point.load / exact - 1.0).abs()
    };
    path.points[1..].iter().map(error).fold(0.0, f64::max)
}

/// The pressure in such a body where it is incompressible and its inside is stretched, MPa: `[2 / l + 1 / (2 l^4)]` from
/// inside to outside of a sphere, `[-ln l + 1 / (2 l^2)]` of a tube.
pub(crate) fn exact_pressure(directions: i32, outer_over_inner: f64, stretch: f64) -> f64 {
    let power = directions + 1;
    // Every shell of the wall keeps its volume.
    let growth = (stretch.powi(power) - 1.0) / outer_over_inner.powi(power);
    let antiderivative = |l: f64| {
        if directions == 2 { 2.0 / l + 0.5 * l.powi(-4) } else { 0.5 * l.powi(-2) - l.ln() }
    };
    antiderivative((1.0 + growth).powf(1.0 / f64::from(power))) - antiderivative(stretch)
}

/// The largest force on [`cook`]'s membrane for each mm of its thickness, N/mm.
pub(crate) const COOK_FORCE: f64 = 100.0;
/// The rise of its upper corner at fifths of it, mm: another program's, extrapolated from 8 to 64 cells. The last is known
/// to 0.005.
pub(crate) const COOK_RISE: [f64; 5] = [1.567, 3.042, 4.424, 5.719, 6.930];

/// The same on our cells.
pub(crate) fn cook_rise(n: usize, volume: Volume, backend: Backend) -> [f64; 5] {
    let mut problem = cook(n, volume);
    let tip = problem.node_at(Vec3::new(48.0, 60.0, 0.0));
    let path = problem.walked(backend, 1.0, 5);
    sampled(&path).map(|point| point.x[3 * tip + 1])
}

/// What stands at the samples of a path, but for its start.
fn sampled<const N: usize>(path: &Path) -> [&PathPoint; N] {
    let samples: Vec<&PathPoint> = path.points[1..].iter().filter(|p| p.is_sample).collect();
    samples.try_into().unwrap()
}

/// Cook's membrane in plane strain, one cell thick; `n` cells along each side, finer towards the singular corner.
pub(crate) fn cook(n: usize, volume: Volume) -> Problem {
    let thickness = 48.0 / n as f64;
    // Cells are straight: the lattice is finer towards the corner, but not within a cell.
    let graded = |x: f64| {
        let cell = (x * n as f64).floor().min(n as f64 - 1.0);
        let [low, high] = [cell, cell + 1.0].map(|k| (k / n as f64).powi(2));
        low + (high - low) * (x * n as f64 - cell)
    };
    let place = |x: Vec3| {
        let (s, t) = (graded(x.x), 1.0 - graded(1.0 - x.y));
        Vec3::new(48.0 * s, 44.0 * s + t * (44.0 - 28.0 * s), thickness * x.z)
    };
    let mesh = SolidMesh::block([n, n, 1], &place);
    let clamped = |x: &Vec3| is_at(x.x, 0.0);
    let held = [along(&mesh, 0, clamped), along(&mesh, 1, clamped), along(&mesh, 2, |_| true)];
    let end = mesh.faces_where(|x| is_at(x.x, 48.0));
    let tractions = vec![(end, COOK_FORCE / 16.0 * Vec3::y())];
    let loads = SolidLoads { held: held.concat(), tractions, ..Default::default() };
    Problem::under(mesh, thickness, &volume.rubber(80.194), &loads)
}

/// The largest nominal pressure on [`compressed_block`], MPa.
pub(crate) const BLOCK_PRESSURE: f64 = 320.0;

/// How far the middle of its top sinks at quarters of it, mm: another program's, at 8 cells, to 0.002.
pub(crate) const BLOCK_SINKING: [f64; 4] = [0.2197, 0.425, 0.586, 0.694];

/// The same on our cells.
pub(crate) fn block_sinking(n: usize, backend: Backend) -> [f64; 4] {
    let mut problem = compressed_block(n);
    let middle = problem.node_at(Vec3::z());
    let path = problem.walked(backend, 1.0, 4);
    sampled(&path).map(|point| -point.x[3 * middle + 2])
}

/// A quarter of a block of 2 x 2 x 1 mm on a smooth plane, pressed on the middle of its top, which keeps its plan.
pub(crate) fn compressed_block(n: usize) -> Problem {
    let mesh = SolidMesh::block([n; 3], &|x| x);
    let top = |x: &Vec3| is_at(x.z, 1.0);
    let held = [
        along(&mesh, 0, |x| is_at(x.x, 0.0) || top(x)),
        along(&mesh, 1, |x| is_at(x.y, 0.0) || top(x)),
        along(&mesh, 2, |x| is_at(x.z, 0.0)),
    ];
    let material = Volume::NearlyIncompressible.rubber(80.194);
    let pressed = |x: &Vec3| top(x) && x.x < 0.5 + ROUNDING && x.y < 0.5 + ROUNDING;
    let tractions = vec![(mesh.faces_where(pressed), -BLOCK_PRESSURE * Vec3::z())];
    let loads = SolidLoads { held: held.concat(), tractions, ..Default::default() };
    Problem::under(mesh, 1.0, &material, &loads)
}

/// The largest load of [`beam`] over `EI / L^2`.
const BEAM_LOAD: f64 = 10.0;

/// Load over `EI / L^2`, and way of the tip sideways and back, over `L`: of the elastica, which does not stretch or shear.
pub(crate) const ELASTICA: [(f64, f64, f64); 7] = [
    (1.0, 0.301721, 0.056433),
    (2.0, 0.493457, 0.160642),
    (3.0, 0.603253, 0.254420),
    (4.0, 0.669964, 0.328941),
    (5.0, 0.713792, 0.387628),
    (7.0, 0.767369, 0.472927),
    (10.0, 0.810609, 0.554996),
];

/// Where the tip of a beam goes under tenths of the load, over its length, mm.
pub(crate) fn beam_tips(n: usize, length: f64, backend: Backend) -> [Vec3; 10] {
    let mut problem = beam(n, length);
    let tip = 3 * problem.node_at(length * Vec3::x());
    let path = problem.walked(backend, 1.0, 10);
    sampled(&path).map(|point| Vec3::from_column_slice(&point.x[tip..tip + 3]) / length)
}

/// The largest distance of the tips from the elastica's, as a share of their way.
pub(crate) fn elastica_error(tips: &[Vec3; 10]) -> f64 {
    let error = |&(load, sideways, back): &(f64, f64, f64)| {
        let exact = Vec3::new(-back, 0.0, sideways);
        (tips[load as usize - 1] - exact).norm() / exact.norm()
    };
    ELASTICA.iter().map(error).fold(0.0, f64::max)
}

/// A strip of 1 x 1 mm and a `length` (mm) in plane strain, `n` cells along and one across: its section keeps plane at one
/// end, and is pulled sideways at the other.
pub(crate) fn beam(n: usize, length: f64) -> Problem {
    let place = |x: Vec3| Vec3::new(length * x.x, x.y, x.z - 0.5);
    let mesh = SolidMesh::block([n, 1, 1], &place);
    let held = [
        along(&mesh, 0, |x| is_at(x.x, 0.0)),
        along(&mesh, 1, |_| true),
        along(&mesh, 2, |x| is_at(x.x, 0.0) && is_at(x.z, 0.0)),
    ];
    let mu = 1.0;
    // The strip cannot narrow: its modulus is E / (1 - nu^2) = 4 mu.
    let bending_stiffness = 4.0 * mu / 12.0;
    let force = BEAM_LOAD * bending_stiffness / length.powi(2);
    let tractions = vec![(mesh.faces_where(|x| is_at(x.x, length)), force * Vec3::z())];
    let loads = SolidLoads { held: held.concat(), tractions, ..Default::default() };
    Problem::under(mesh, 1.0, &Volume::Incompressible.rubber(mu), &loads)
}

/// A rod of radius 1 mm and length 1 mm, whose ends are held, and the displacement that has them turned by `twist` (1/mm)
/// and drawn apart by `stretch`; `n` cells along a radius and along the rod.
pub(crate) fn twisted_rod(n: usize, twist: f64, stretch: f64) -> (Problem, Vec<f64>) {
    let mut mesh = SolidMesh::layers(&hexagon(n), n, &|x, height| round(x) + height * Vec3::z());
    mesh.outer = mesh.faces().collect();
    mesh.chamber.clear();
    let is_held = |x: &Vec3| is_at(x.z, 0.0) || is_at(x.z, 1.0);
    let held = [0, 1, 2].map(|axis| along(&mesh, axis, is_held));
    let problem = Problem::new(mesh, 1.0, &Volume::Incompressible.rubber(1.0), &held);
    let mut u = vec![0.0; problem.model.unknowns()];
    for (u, x) in u.as_chunks_mut::<3>().0.iter_mut().zip(&problem.mesh.positions) {
        let (sin, cos) = (twist * x.z).sin_cos();
        let turned = Vec3::new(cos * x.x - sin * x.y, sin * x.x + cos * x.y, 0.0);
        *u = (turned / stretch.sqrt() + stretch * x.z * Vec3::z() - x).into();
    }
    (problem, u)
}

/// The energy of [`twisted_rod`] at equilibrium, mJ.
pub(crate) fn twisted_energy(n: usize, twist: f64, stretch: f64, backend: Backend) -> f64 {
    let (mut problem, mut u) = twisted_rod(n, twist, stretch);
    let mut solver = backend.solver(problem.model.pattern()).unwrap();
    let model = &mut problem.model;
    let report = solver.solve(model, &mut u, &NewtonSettings::default()).unwrap();
    assert_eq!(report.ending, NewtonEnding::Converged);
    assert_eq!(solver.linearize(model, &u).unwrap(), problem.mesh.corners);
    problem.model.energy(&u).unwrap()
}

/// `mu/2 int (stretch^2 + 2 / stretch - 3 + twist^2 R^2 / stretch) dV`: sections stay plane, as Rivlin found.
pub(crate) fn exact_twisted_energy(twist: f64, stretch: f64) -> f64 {
    let drawn = stretch * stretch + 2.0 / stretch - 3.0;
    0.5 * PI * (drawn + 0.5 * twist * twist / stretch)
}

/// A hexagon of unit corners in triangles, `n` along a side.
fn hexagon(n: usize) -> TriangleMesh {
    let mut base = TriangleMesh { positions: vec![Vec3::zeros()], triangles: Vec::new() };
    let corner = |k: usize| {
        let (sin, cos) = (FRAC_PI_3 * k as f64).sin_cos();
        Vec3::new(cos, sin, 0.0)
    };
    // Ring r has 6 r vertices; that before it begins with vertex 1 + 3 (r - 1) (r - 2).
    let start = |ring: usize| if ring == 0 { 0 } else { 1 + 3 * ring * (ring - 1) };
    for ring in 1..=n {
        let (inner, count) = (ring - 1, 6 * ring);
        for side in 0..6 {
            for step in 0..ring {
                let share = step as f64 / ring as f64;
                let along = (1.0 - share) * corner(side) + share * corner(side + 1);
                base.positions.push(ring as f64 / n as f64 * along);
                let outer = |step: usize| (start(ring) + (side * ring + step) % count) as u32;
                let within = |step: usize| {
                    (start(inner) + (side * inner + step) % (6 * inner).max(1)) as u32
                };
                base.triangles.push([outer(step), outer(step + 1), within(step)]);
                if step > 0 {
                    base.triangles.push([outer(step), within(step), within(step - 1)]);
                }
            }
        }
    }
    base
}

/// A point of the hexagon on the disc: its distance from the middle is that of the hexagon's side there.
fn round(x: Vec3) -> Vec3 {
    let half_height = 0.5 * 3.0_f64.sqrt();
    let side = (0..6)
        .map(|k| {
            let (sin, cos) = (FRAC_PI_3 * (f64::from(k) + 0.5)).sin_cos();
            (x.x * cos + x.y * sin) / half_height
        })
        .fold(0.0, f64::max);
    if side == 0.0 { x } else { side / x.norm() * x }
}
