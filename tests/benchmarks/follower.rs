//! Cantilever strips under forces that follow them, which have no potential: the inextensible elastica.
//!
//! ```text
//! E I theta'' = -P sin(theta(L) - theta + pi/2)               a force P at the end, normal to it
//! E I theta'' = q (cos theta, sin theta) . int_s^L (-sin theta, cos theta)      a pressure q
//! ```
//!
//! Solved as boundary value problems; at P L^2 / (E I) or q L^3 / (E I), the turn of the end, and its displacement back and
//! aside over L. Walked by plain Newton iterations at given loads: there is no energy to search along.

use pneumorph::math::Vec3;
use pneumorph::mesh::{Patch, ShellElement, Side};
use pneumorph::model::material::{Material, StVenantKirchhoff};
use pneumorph::model::system::{LoadedSystem, System};
use pneumorph::model::{EdgeSupport, FollowerForce, PartModel, PartSetup, PatchLoads};
use pneumorph::solve::{EquilibriumSolver, NativeSolver, solve_unsymmetric};

const TIP_FORCE: [[f64; 4]; 10] = [
    [1.0, 0.495885, 0.064354, 0.320642],
    [2.0, 0.968239, 0.232638, 0.573839],
    [3.0, 1.398656, 0.448335, 0.726685],
    [4.0, 1.776436, 0.657254, 0.786168],
    [5.0, 2.098157, 0.827722, 0.780690],
    [8.0, 2.756554, 1.073863, 0.633592],
    [10.0, 2.992715, 1.092123, 0.546983],
    [15.0, 3.128008, 0.951499, 0.437073],
    [20.0, 2.850580, 0.724290, 0.330158],
    [30.0, 1.690858, 0.523859, -0.201691],
];
const PRESSURE: [[f64; 4]; 11] = [
    [1.0, 0.166543, 0.008896, 0.124444],
    [2.0, 0.332346, 0.035205, 0.245592],
    [4.0, 0.658884, 0.134987, 0.466023],
    [6.0, 0.974347, 0.283727, 0.641986],
    [8.0, 1.274436, 0.460701, 0.763510],
    [10.0, 1.556046, 0.645332, 0.830148],
    [15.0, 2.169491, 1.045627, 0.809246],
    [20.0, 2.654539, 1.291537, 0.652644],
    [25.0, 3.028467, 1.403173, 0.478126],
    [30.0, 3.313901, 1.432543, 0.333050],
    [40.0, 3.697082, 1.388219, 0.150032],
];

const LENGTH: f64 = 10.0;
const THICKNESS: f64 = 0.05;
const YOUNG_MODULUS: f64 = 1.2e6;
/// Of a strip of width 1, N mm^2.
const STIFFNESS: f64 = YOUNG_MODULUS * THICKNESS * THICKNESS * THICKNESS / 12.0;

/// A strip clamped at one end whose sides stay in their planes, or are free as well.
struct Strip {
    model: PartModel,
    cells: usize,
    /// The vertices along it.
    line: Vec<u32>,
}

impl Strip {
    /// Under `loads` times the load factor, which is the dimensionless load.
    fn new(
        cells: [usize; 2],
        element: ShellElement,
        sides: EdgeSupport,
        loads: PatchLoads,
    ) -> Self {
        let plane = |s: f64, t: f64| Vec3::new(s, t, 0.0);
        let width = LENGTH * cells[1] as f64 / cells[0] as f64;
        let patch = Patch::new(cells, [0.0, LENGTH], [0.0, width], THICKNESS, &plane).unwrap();
        let supports = [EdgeSupport::Clamped, EdgeSupport::Free, sides, sides];
        let material = Material::StVenantKirchhoff(StVenantKirchhoff {
            young_modulus: YOUNG_MODULUS,
            poisson_ratio: 0.0,
        });
        let loads = PatchLoads { supports, ..loads };
        let model =
            PartModel::of_patch(&patch, element, &material, &loads, &PartSetup::default()).unwrap();
        let at = |k: usize| patch.vertex(LENGTH * k as f64 / cells[0] as f64, 0.0).unwrap();
        Self { model, cells: cells[0], line: (0..=cells[0]).map(at).collect() }
    }

    /// Turn of the end, and its displacement back and aside over the length.
    fn end(&self, u: &[f64]) -> [f64; 3] {
        let moved = self.model.vertex_displacements(u);
        let step = LENGTH / self.cells as f64;
        let place = |k: usize| Vec3::new(k as f64 * step, 0.0, 0.0) + moved[self.line[k] as usize];
        let chord = |k: usize| place(k + 1) - place(k);
        let mut turn = 0.0;
        for k in 0..self.cells - 1 {
            let [a, b] = [chord(k), chord(k + 1)];
            turn += (a.x * b.z - a.z * b.x).atan2(a.dot(&b));
        }
        let first = chord(0);
        // Half a cell on either end is missing: as much as the neighbour turns, which at the free end is next to nothing.
        let [a, b] = [chord(self.cells - 2), chord(self.cells - 1)];
        let last = (a.x * b.z - a.z * b.x).atan2(a.dot(&b));
        let end = place(self.cells);
        let turn = first.z.atan2(first.x) + turn + 0.25 * last;
        [turn, 1.0 - end.x / LENGTH, end.z / LENGTH]
    }

    /// The states at increasing loads, in steps of at most `step`, and the most products that a linear system took.
    fn walk(&mut self, loads: impl Iterator<Item = f64>, step: f64) -> (Vec<[f64; 3]>, usize) {
        let mut solver = NativeSolver::new(self.model.pattern()).unwrap();
        let mut u = vec![0.0; self.model.unknowns()];
        let [mut residual, mut direction] = [u.clone(), u.clone()];
        let (mut load, mut products) = (0.0, 0);
        let mut ends = Vec::new();
        let mut solved =
            |model: &PartModel, solver: &mut NativeSolver, u: &[f64], b: &mut [f64]| {
                let report = solve_unsymmetric(model, solver, u, b).unwrap();
                assert!(report.has_converged(), "{report:?}");
                products = products.max(report.iterations);
            };
        for target in loads {
            let steps = ((target - load) / step).ceil();
            let growth = (target - load) / steps;
            for _ in 0..steps as usize {
                solver.linearize(&mut self.model, &u).unwrap();
                self.model.load_direction(&u, &mut direction);
                solved(&self.model, &mut solver, &u, &mut direction);
                u.iter_mut().zip(&direction).for_each(|(u, rate)| *u += growth * rate);
                load += growth;
                self.model.set_load(load);
                let mut iterations = 0;
                loop {
                    self.model.residual(&u, &mut residual).unwrap();
                    let size = residual.iter().map(|r| r * r).sum::<f64>().sqrt();
                    if size <= 1e-9 * self.model.force_scale() {
                        break;
                    }
                    iterations += 1;
                    assert!(iterations < 15, "load {load}: {size:e}");
                    solver.linearize(&mut self.model, &u).unwrap();
                    solved(&self.model, &mut solver, &u, &mut residual);
                    u.iter_mut().zip(&residual).for_each(|(u, r)| *u -= r);
                }
            }
            ends.push(self.end(&u));
        }
        (ends, products)
    }
}

fn tip_force() -> PatchLoads {
    let per_length = Vec3::new(0.0, 0.0, STIFFNESS / LENGTH.powi(2));
    let followers = vec![FollowerForce::Edge { side: Side::S1, per_length }];
    PatchLoads { followers, ..Default::default() }
}

fn pressure() -> PatchLoads {
    PatchLoads { pressure: STIFFNESS / LENGTH.powi(3), ..Default::default() }
}

/// The largest errors of turn, back and aside, each over the largest of the table.
fn errors(table: &[[f64; 4]], ends: &[[f64; 3]]) -> [f64; 3] {
    [0, 1, 2].map(|k| {
        let largest = table.iter().map(|row| row[k + 1].abs()).fold(0.0, f64::max);
        let miss = table.iter().zip(ends).map(|(row, end)| (end[k] - row[k + 1]).abs());
        miss.fold(0.0, f64::max) / largest
    })
}

/// Walks the strip through the table's loads and compares; returns the most products with the circulation.
#[track_caller]
fn compare(strip: &mut Strip, table: &[[f64; 4]], tolerance: f64) -> usize {
    let (ends, products) = strip.walk(table.iter().map(|row| row[0]), 1.0);
    let errors = errors(table, &ends);
    assert!(errors.iter().all(|error| *error < tolerance), "{errors:?}");
    products
}

/// The meshes on which both elements are within 1 % of the largest value of each column; a strip whose sides stay in their planes
/// turns its end about one axis, so that few products are needed.
#[test]
fn strips_between_planes_are_elasticas() {
    for (element, cells) in [(ShellElement::Loop, 32), (ShellElement::MidEdge, 64)] {
        for (table, loads) in [(&TIP_FORCE[..], tip_force()), (&PRESSURE[..], pressure())] {
            let mut strip = Strip::new([cells, 2], element, EdgeSupport::Symmetry(1), loads);
            let products = compare(&mut strip, table, 0.01);
            assert!(products <= 8, "{products}");
        }
    }
}

/// A pressure has a rim along free sides too. Without a Poisson's ratio they change nothing, but for what Loop's surface makes of
/// a corner that is clamped and free, which converges slowly.
#[test]
fn strips_with_free_sides_are_elasticas() {
    for (element, cells, tolerance) in
        [(ShellElement::Loop, 32, 0.02), (ShellElement::MidEdge, 64, 0.01)]
    {
        let mut strip = Strip::new([cells, 2], element, EdgeSupport::Free, pressure());
        let products = compare(&mut strip, &PRESSURE, tolerance);
        assert!(products <= 15, "{products}");
    }
}
