//! Parts on planes: what balances, what is uniform, what slides.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{PlaneSettings, PlaneState};
use crate::math::Vec3;
use crate::mesh::{Patch, ShellElement, ShellMesh, ShellSettings};
use crate::model::material::{Material, NeoHookean};
use crate::model::system::{LoadedSystem, Memory, System};
use crate::model::test_shells::difference;
use crate::model::{DeadLoad, EdgeSupport, PartModel, PatchLoads, Support};
use crate::solve::{EquilibriumSolver, NativeSolver, NewtonEnding, NewtonReport, NewtonSettings};
use crate::surface::TriangleMesh;

const MATERIAL: Material = Material::NeoHookean(NeoHookean { mu: 1.0 });
const ELEMENTS: [ShellElement; 2] = [ShellElement::Loop, ShellElement::MidEdge];
/// The default's tolerance. A friction of 10 within a slip of 0.001 mm turns the rounding of positions of 20 mm into forces of
/// 1e-10 of the largest load.
const NEWTON: NewtonSettings = NewtonSettings {
    tolerance: 1e-9,
    max_iterations: 100,
    chord_contraction: 0.0,
    most_shifted: usize::MAX,
};

fn solved(model: &mut PartModel, u: &mut [f64]) -> NewtonReport {
    let mut solver = NativeSolver::new(model.pattern()).unwrap();
    solver.solve(model, u, &NEWTON).unwrap()
}

/// Solves and takes the normal forces, until they stand still; whether they do.
fn settled(model: &mut PartModel, u: &mut [f64]) -> bool {
    for _ in 0..50 {
        if solved(model, u).ending != NewtonEnding::Converged {
            return false;
        }
        if model.refresh(u) < 1e-9 {
            return true;
        }
    }
    false
}

/// A plate of 10 x 8 x 1 mm above a plane, on which a dead load presses it.
struct Block {
    patch: Patch,
    model: PartModel,
    /// The unknowns where it has come down on the plane, a quarter of the rest's gap above it.
    down: Vec<f64>,
}

/// Two along the plane, and its normal.
const AXES: [Vec3; 3] =
    [Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 0.0, 1.0), Vec3::new(0.0, -1.0, 0.0)];

const PRESSURE: f64 = 0.02;
const AREA: f64 = 80.0;

impl Block {
    /// Held against rigid motions along the plane by friction, or else by pins.
    fn new(element: ShellElement, distance: f64, friction: f64) -> Self {
        let surface = |s: f64, t: f64| Vec3::new(20.0, 3.0, -7.0) + s * AXES[0] + t * AXES[1];
        let patch = Patch::new([5, 4], [0.0, 10.0], [0.0, 8.0], 1.0, &surface).unwrap();
        let dead = vec![DeadLoad::Area { per_area: -PRESSURE * AXES[2] }];
        let mut loads = PatchLoads { dead, ..Default::default() };
        if friction == 0.0 {
            let [near, far] = [0.0, 10.0].map(|s| patch.vertex(s, 0.0).unwrap());
            loads.pins = vec![(near, 0), (near, 2), (far, 2)];
        }
        let plane = PlaneSettings::new(AXES[2], distance, loads.mean_pressure(&patch));
        let setup = vec![PlaneSettings { friction, ..plane }].into();
        let mut model = PartModel::of_patch(&patch, element, &MATERIAL, &loads, &setup).unwrap();
        model.set_load(1.0);
        let mut down = vec![0.0; model.unknowns()];
        for u in down.as_chunks_mut().0.iter_mut().take(patch.vertices()) {
            *u = (-0.75 * distance * AXES[2]).into();
        }
        Self { patch, model, down }
    }

    fn state(&self, u: &[f64]) -> PlaneState {
        self.model.plane_states(u, &Memory::default())[0]
    }

    /// Mean displacement of the vertices along the plane, mm.
    fn slid(&self, u: &[f64]) -> f64 {
        let displacements = self.model.vertex_displacements(u);
        displacements.iter().map(|u| u.dot(&AXES[0])).sum::<f64>() / displacements.len() as f64
    }
}

/// The plane bears the load and no more, and a plate loaded like that is not bent: every gap is the same. On flat
/// triangles the areas of the samples and of the load agree; Loop's load and samples differ along free edges by a few per
/// cent of an edge triangle's share, and the gap by what that makes of the barrier.
#[test]
fn pressed_plate_lies_flat() {
    for (element, uniform) in ELEMENTS.into_iter().zip([0.2, 1e-8]) {
        for distance in [1e-6, 0.03, 2.0] {
            let mut block = Block::new(element, distance, 0.0);
            let mut u = vec![0.0; block.model.unknowns()];
            let report = solved(&mut block.model, &mut u);
            assert_eq!(report.ending, NewtonEnding::Converged, "{distance}: {report:?}");
            let state = block.state(&u);
            let weight = PRESSURE * AREA;
            let expected = -weight * AXES[2];
            assert!((state.force - expected).norm() < 1e-8 * weight, "{distance}: {}", state.force);
            assert_eq!(state.friction, Vec3::zeros());
            let displacements = block.model.vertex_displacements(&u);
            let heights = displacements.iter().map(|u| u.dot(&AXES[2]));
            let [low, high] = [f64::min, f64::max].map(|f| heights.clone().reduce(f).unwrap());
            // Nearer than 0.002 mm is as far.
            let activation = 0.1_f64.min(0.5 * distance.max(2e-3));
            assert!(high - low < uniform * activation, "{element:?}, {distance}: {:e}", high - low);
            assert!(state.smallest_gap > 0.0 && state.smallest_gap < activation);
            // The centre of the plate, and all of it.
            let positions = &block.patch.surface.positions;
            let centre: Vec3 = positions.iter().sum::<Vec3>() / positions.len() as f64;
            let off = state.centre.unwrap() - centre;
            let along = off - off.dot(&AXES[2]) * AXES[2];
            assert!(along.norm() < 1e-3 && (off.norm() - 0.5 - distance).abs() < 1e-3, "{off}");
            assert!((state.area - AREA).abs() < 1e-9 * AREA);
            assert!((state.bearing_area / AREA - 1.0).abs() < uniform);
        }
    }
}

/// A dead load along the plane is held up to `mu` times the normal force, within the elastic slip, at the same place
/// whatever the number of steps; beyond there is no equilibrium at rest.
#[test]
fn block_slides_at_the_coefficient_of_friction() {
    for friction in [0.4, 10.0] {
        let mut places = Vec::new();
        for steps in [5, 20, 80] {
            let mut block = Block::new(ShellElement::MidEdge, 0.05, friction);
            let normal = block.model.dead_forces_mut().to_vec();
            let mut u = block.down.clone();
            assert_eq!(block.model.refresh(&u), 1.0);
            assert!(settled(&mut block.model, &mut u));
            assert_eq!(block.model.settle(&u), 0.0);
            let (before, start) = (block.slid(&u), u.clone());
            let pull = |model: &mut PartModel, ratio: f64| {
                for (force, normal) in model.dead_forces_mut().iter_mut().zip(&normal) {
                    *force = normal + ratio * normal.norm() * AXES[0];
                }
            };
            let elastic_slip = 1e-3;
            for k in 1..=steps {
                pull(&mut block.model, 0.99 * friction * f64::from(k) / f64::from(steps));
                assert!(settled(&mut block.model, &mut u), "step {k} of {steps}");
                assert_eq!(block.model.settle(&u), 0.0);
            }
            let held = block.state(&u);
            let weight = PRESSURE * AREA;
            let expected = 0.99 * friction * weight * AXES[0];
            assert!((held.friction - expected).norm() < 1e-8 * weight, "{}", held.friction);
            let place = block.slid(&u) - before;
            // f'(y) = 0.99 at y = 0.9 e, in a plate that is stiff.
            assert!((place / (0.9 * elastic_slip) - 1.0).abs() < 0.01, "{place}");
            places.push(place);
            pull(&mut block.model, 1.01 * friction);
            let mut beyond = start;
            let stands = settled(&mut block.model, &mut beyond);
            assert!(!stands || block.slid(&beyond) - before > elastic_slip);
        }
        for place in &places {
            // The state is solved for to 1e-12 of the forces; nothing else depends on the way.
            assert!((place / places[0] - 1.0).abs() < 1e-8, "{places:?}");
        }
    }
}

/// A tied patch (clamped, mirrored, held, free) before two planes, one of them rough: derivatives are those of the energy, and
/// the longest step keeps every gap.
#[test]
fn ties_pass_contact_on_to_their_leaders() {
    let surface = |s: f64, t: f64| Vec3::new(s, t, 0.05 * (s * s - t * t));
    let patch = Patch::new([3, 3], [0.0, 6.0], [0.0, 6.0], 1.0, &surface).unwrap();
    let mut chance = ChaCha8Rng::seed_from_u64(3);
    for element in ELEMENTS {
        let planes = [(Vec3::z(), 0.4), (Vec3::new(0.0, 0.28, -0.96), 0.0)];
        let planes = planes.map(|(normal, friction)| PlaneSettings {
            friction,
            elastic_slip: 0.05,
            ..PlaneSettings::new(normal, 0.5, 0.1)
        });
        let supports = [
            EdgeSupport::Clamped,
            EdgeSupport::Free,
            EdgeSupport::Symmetry(1),
            EdgeSupport::Held([true, false, false]),
        ];
        let loads = PatchLoads { supports, ..Default::default() };
        let setup = planes.to_vec().into();
        let mut model = PartModel::of_patch(&patch, element, &MATERIAL, &loads, &setup).unwrap();
        let mut push = |model: &PartModel, size: f64| -> Vec<f64> {
            (0..model.unknowns()).map(|_| chance.random_range(-size..size)).collect()
        };
        let u = push(&model, 0.05);
        // The first plane in reach of many samples.
        model.raise_plane(model.smallest_gap(&u) - 0.04);
        assert_eq!(model.refresh(&u), 1.0);
        assert!(model.plane_force(&u) > 0.0);
        let moved: Vec<f64> = u.iter().zip(push(&model, 0.01)).map(|(u, du)| u + du).collect();
        assert!(model.plane_states(&moved, &Memory::default())[0].friction.norm() > 0.0);
        let mut residual = vec![0.0; u.len()];
        model.residual(&moved, &mut residual).unwrap();
        let largest = residual.iter().fold(0.0_f64, |largest, r| largest.max(r.abs()));
        let mut held = vec![0.0; u.len()];
        let mut tangent = vec![0.0; model.pattern().stored()];
        model.tangent(&moved, &mut held, &mut tangent).unwrap();
        assert_eq!(held, residual);
        for unknown in (0..u.len()).filter(|&unknown| residual[unknown] != 0.0) {
            let slope = difference(1e-5, |h| {
                let mut there = moved.clone();
                there[unknown] += h;
                model.energy(&there).unwrap()
            });
            let error = (slope - residual[unknown]).abs();
            // Rounding of an energy of 1 mJ over steps of 1e-5 mm; (1e-5 / 0.04)^4 is less.
            assert!(error < 1e-8 * largest, "{element:?}, {unknown}: {:e}", error / largest);
        }
        for size in [0.01, 1.0, 30.0] {
            let du = push(&model, size);
            let step = model.longest_step(&u, &du);
            let there: Vec<f64> = u.iter().zip(&du).map(|(u, du)| u + step * du).collect();
            assert!(model.smallest_gap(&there) > 0.0);
            let farther: Vec<f64> = u.iter().zip(&du).map(|(u, du)| u + 1.2 * step * du).collect();
            assert!(step == 1.0 || model.smallest_gap(&farther) < 0.0, "{size}: {step}");
        }
    }
}

/// What an accepted state remembers brings it back, whatever the block did after it: the same residual, friction and way on.
#[test]
fn a_path_goes_on_from_any_accepted_state() {
    let mut block = Block::new(ShellElement::MidEdge, 0.05, 0.4);
    let normal = block.model.dead_forces_mut().to_vec();
    let mut u = block.down.clone();
    let push = |block: &mut Block, u: &mut [f64], ratio: f64| {
        for (force, normal) in block.model.dead_forces_mut().iter_mut().zip(&normal) {
            *force = normal + ratio * normal.norm() * AXES[0];
        }
        block.model.refresh(u);
        assert!(settled(&mut block.model, u), "{ratio}");
        block.model.settle(u);
        let memory = block.model.memory();
        (block.model.plane_states(u, &memory)[0].friction, memory)
    };
    push(&mut block, &mut u, 0.0);
    let (held, memory) = push(&mut block, &mut u, 0.3);
    let there = u.clone();
    let (back, _) = push(&mut block, &mut u, -0.2);
    assert!((back + 2.0 / 3.0 * held).norm() < 1e-6 * held.norm(), "{held} {back}");
    assert_eq!(block.model.plane_states(&there, &memory)[0].friction, held);

    // From a model that was never there: without the memory, where it stands is where it holds on.
    let mut other = Block::new(ShellElement::MidEdge, 0.05, 0.4);
    let mut forgotten = there.clone();
    other.model.recall(&there, &Memory::default());
    let (_, anew) = push(&mut other, &mut forgotten, 0.3);
    assert_ne!(anew, memory);
    other.model.recall(&there, &memory);
    assert_eq!(other.model.memory(), memory);
    let mut u_other = there.clone();
    let (back_other, _) = push(&mut other, &mut u_other, -0.2);
    assert_eq!((back_other, u_other), (back, u));
}

/// An inflated sphere, held against its rigid motions alone, in a corner of three planes: the planes' forces and those of
/// its pins balance, as the pressure on a closed surface has no resultant.
#[test]
fn free_body_on_planes_is_in_balance() {
    let surface = TriangleMesh::sphere(10.0, 2);
    let farthest = |axis: usize, sign: f64| {
        let height = |v: &u32| sign * surface.positions[*v as usize][axis];
        (0..surface.positions.len() as u32).max_by(|a, b| height(a).total_cmp(&height(b))).unwrap()
    };
    let (top, bottom, side) = (farthest(2, 1.0), farthest(2, -1.0), farthest(0, 1.0));
    let pins = vec![3 * top, 3 * top + 1, 3 * top + 2, 3 * bottom, 3 * bottom + 1, 3 * side + 1];
    for element in ELEMENTS {
        let settings = ShellSettings {
            thickness: 0.5,
            clamp_height: 20.0,
            element: Some(element),
            ..Default::default()
        };
        let mesh = ShellMesh::new(surface.clone(), &settings).unwrap();
        let planes = [(Vec3::z(), 1e-6), (-Vec3::x(), 0.2), (Vec3::new(0.6, 0.64, 0.48), 0.05)]
            .map(|(normal, distance)| PlaneSettings::new(normal, distance, 0.1));
        let model = |held: &[u32]| {
            let support = Support::Unknowns(held.to_vec());
            let mut model =
                PartModel::new(&mesh, &MATERIAL, &support, &planes.to_vec().into()).unwrap();
            model.set_load(0.05);
            model
        };
        let mut held = model(&pins);
        let mut u = vec![0.0; held.unknowns()];
        let report = solved(&mut held, &mut u);
        assert_eq!(report.ending, NewtonEnding::Converged, "{report:?}");
        let states = held.plane_states(&u, &Memory::default());
        let pressed: Vec3 = states.iter().map(|state| state.force).sum();
        let sizes: f64 = states.iter().map(|state| state.force.norm()).sum();
        assert!(states.iter().all(|state| state.force.norm() > 1e-3 && state.smallest_gap > 0.0));
        assert!((held.plane_force(&u) / sizes - 1.0).abs() < 1e-14);
        // With nothing held, the residual is what the pins must bear.
        let mut residual = vec![0.0; u.len()];
        model(&[]).residual(&u, &mut residual).unwrap();
        let reaction: Vec3 =
            pins.iter().map(|&pin| Vec3::ith(pin as usize % 3, residual[pin as usize])).sum();
        // Some hundred residuals of 1e-9 N, and forces of some newtons.
        assert!((reaction - pressed).norm() < 1e-7 * sizes, "{reaction} {pressed}");
    }
}

/// A spherical cap, so flat that it is shallow and so large that its clamped rim is far, pressed on a plane: force against
/// approach by Marguerre's theory, axisymmetric, as in Updike and Kalnins (1970) and computed by
/// `scripts/references/sphere_on_plane.py`. In `d R / l^2` and `P R / D` the curve is one for all shells; the linear theory,
/// of Kelvin functions, with which the script is checked, is 5 % above it at a tenth of the thickness and 32 % at
/// the last row.
#[test]
fn sphere_is_flattened_on_a_plane() {
    const CURVE: [[f64; 2]; 7] = [
        [0.673650, 4.918435],
        [0.914951, 6.573970],
        [1.134393, 8.102019],
        [1.347047, 9.620667],
        [1.558172, 11.174103],
        [1.770269, 12.785611],
        [2.202458, 16.238565],
    ];
    let curve = |approach: f64| {
        let above = CURVE.iter().position(|row| row[0] > approach).unwrap();
        let [[x, y], [x1, y1]] = [CURVE[above - 1], CURVE[above]];
        y + (y1 - y) * (approach - x) / (x1 - x)
    };
    // E = 3, nu = 1/2: D = E t^3 / 9, l^2 = R t / 3.
    let (radius, thickness) = (2000.0, 1.0);
    let (bending_stiffness, length2) = (1.0 / 3.0, radius * thickness / 3.0);
    let length = f64::sqrt(length2);
    // Cells of 0.1 l in the middle and 3 l at the rim, 20 l away.
    let grading = 4.0;
    let place = |s: f64| 20.0 * length * f64::sinh(grading * s) / f64::sinh(grading);
    let surface = |s: f64, t: f64| {
        let (x, y) = (place(s), place(t));
        Vec3::new(x, y, f64::sqrt(radius * radius - x * x - y * y))
    };
    let patch = Patch::new([24, 24], [0.0, 1.0], [0.0, 1.0], thickness, &surface).unwrap();
    let supports = [
        EdgeSupport::Symmetry(0),
        EdgeSupport::Clamped,
        EdgeSupport::Symmetry(1),
        EdgeSupport::Clamped,
    ];
    let pressure = 0.01 * 3.0 * thickness / (radius * radius) * length2 / radius;
    let distance = 0.005;
    let planes = vec![PlaneSettings::new(-Vec3::z(), distance, pressure)];
    let loads = PatchLoads { supports, ..Default::default() };
    let element = ShellElement::Loop;
    let mut model =
        PartModel::of_patch(&patch, element, &MATERIAL, &loads, &planes.into()).unwrap();
    let nodes = patch.control_points();
    let mut raised = 0.0;
    for approach in [0.8, 2.0] {
        let rise = approach * length2 / radius + distance;
        model.raise_plane(rise - raised);
        raised = rise;
        // The middle goes along with the plane: a guess that does not pass it.
        let mut u = vec![0.0; model.unknowns()];
        for (u, x) in u.as_chunks_mut::<3>().0.iter_mut().zip(&nodes) {
            // Nodes beyond the planes of symmetry follow.
            if x.x > -1e-9 && x.y > -1e-9 {
                u[2] = -rise * f64::exp(-(x.xy().norm() / (3.0 * length)).powi(4));
            }
        }
        let report = solved(&mut model, &mut u);
        assert_eq!(report.ending, NewtonEnding::Converged, "{approach}: {report:?}");
        let apex = -model.vertex_displacements(&u)[0].z * radius / length2;
        let force = 4.0 * model.plane_force(&u) * radius / bending_stiffness;
        let error = force / curve(apex) - 1.0;
        assert!(error.abs() < 0.03, "{apex}: {force}, {error}");
    }
}
