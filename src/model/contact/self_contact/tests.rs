//! What the barriers of a wall against itself do, in every case of closest features.

use std::sync::Arc;

use nalgebra::{DVector, Isometry3, SMatrix, SVector, Translation3, UnitQuaternion};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::SelfContactSettings;
use super::distance::Closest;
use super::pair::{Pair, PairDerivatives, barrier};
use super::pair_term::PairTerm;
use super::wall_contact::WallContact;
use super::wall_surface::{Kind, Search, WallSurface};
use crate::math::Vec3;
use crate::mesh::Section;
use crate::model::element::{ElementPoints, SampledSurface};
use crate::model::local::{LocalDerivatives, Term};
use crate::model::term_suite::{self, Case};
use crate::model::test_shells::{TestShell, difference};

/// Of the differences, mm: edges that are nearly parallel cross within 0.06 mm, other closest points vary over 0.3 mm.
const STEP: f64 = 2e-4;

/// Four points of which the closest parts are as named, about 2 mm apart.
fn features() -> Vec<(&'static str, Kind, [Vec3; 4])> {
    let facet = [[0.0, 0.0, 0.0], [3.0, 0.2, 0.1], [0.3, 2.5, -0.1]].map(Vec3::from);
    let over = |point: [f64; 3]| {
        let kind = Kind::PointFacet { sides: [-0.5, -0.5, 0.0], tips: [0.1, 0.2, 0.0] };
        (kind, [Vec3::from(point), facet[0], facet[1], facet[2]])
    };
    let edges = |ends: [[f64; 3]; 2]| {
        let [c, d] = ends.map(Vec3::from);
        (Kind::Edges { areas: [1.0, 1.5] }, [facet[0], facet[1], c, d])
    };
    let named = [
        ("inside", over([0.9, 0.8, 2.0])),
        ("side", over([1.6, -0.9, 1.7])),
        ("other side", over([2.2, 1.9, 1.5])),
        ("corner", over([-0.8, -0.9, 1.5])),
        ("other corner", over([3.9, 0.3, 1.6])),
        ("crossing", edges([[1.2, -1.0, 1.9], [1.5, 1.3, 2.0]])),
        ("nearly parallel, crossing", edges([[0.5, -0.01, 1.9], [2.5, 0.15, 2.0]])),
        ("end on edge", edges([[1.2, 0.7, 1.8], [1.5, 2.9, 2.0]])),
        ("edge on end", edges([[-0.6, -1.0, 1.9], [-0.5, 1.3, 2.0]])),
        ("end on end", edges([[-0.6, 0.5, 1.9], [-1.5, 1.3, 2.0]])),
    ];
    named.map(|(name, (kind, x))| (name, kind, x)).into()
}

fn moved(x: &[Vec3; 4], unknown: usize, step: f64) -> [Vec3; 4] {
    let mut x = *x;
    x[unknown / 3][unknown % 3] += step;
    x
}

fn pair(kind: Kind, x: &[Vec3; 4]) -> Pair {
    let gap = kind.closest(x).distance;
    Pair::of_kind(kind, 0.7, [0.8 * gap, 0.9 * gap], x)
}

fn derivatives(pair: &Pair, x: &[Vec3; 4]) -> PairDerivatives {
    pair.derivatives(x, true).unwrap().unwrap()
}

/// Every kind of closest points, by central differences of fourth order: their error is (step / length)^4 = 1e-10 or less.
#[test]
fn derivatives_of_pairs_are_differences() {
    for (name, kind, x) in features() {
        let pair = pair(kind, &x);
        let exact = derivatives(&pair, &x);
        assert!(exact.energy != 0.0, "{name}");
        let largest = exact.gradient.iter().map(|g| g.amax()).fold(0.0, f64::max);
        let stiffest = exact.hessian.iter().flatten().map(|h| h.amax()).fold(0.0, f64::max);
        for unknown in 0..12 {
            let slope = difference(STEP, |h| derivatives(&pair, &moved(&x, unknown, h)).energy);
            let error = (slope - exact.gradient[unknown / 3][unknown % 3]).abs() / largest;
            assert!(error < 1e-8, "{name}, gradient {unknown}: {error:e}");
            let column = difference(STEP, |h| {
                let there = derivatives(&pair, &moved(&x, unknown, h));
                SVector::<f64, 12>::from_fn(|i, _| there.gradient[i / 3][i % 3])
            });
            for (row, slope) in column.iter().enumerate() {
                let entry = exact.hessian[row / 3][unknown / 3][(row % 3, unknown % 3)];
                let error = (slope - entry).abs() / stiffest;
                assert!(error < 1e-8, "{name}, Hessian {row} {unknown}: {error:e}");
            }
        }
        let hessian =
            SMatrix::<f64, 12, 12>::from_fn(|i, j| exact.hessian[i / 3][j / 3][(i % 3, j % 3)]);
        assert!((hessian - hessian.transpose()).amax() < 1e-13 * stiffest, "{name}");
        // Without the Hessian the same gradient; four forces without sum and moment.
        let alone = pair.derivatives(&x, false).unwrap().unwrap();
        assert_eq!((alone.energy, alone.gradient), (exact.energy, exact.gradient));
        let force: Vec3 = exact.gradient.iter().sum();
        let moment: Vec3 = exact.gradient.iter().zip(&x).map(|(f, x)| x.cross(f)).sum();
        assert!(force.norm() < 1e-14 * largest && moment.norm() < 1e-13 * largest, "{name}");
    }
}

/// The closest points are no farther than any others of the two parts, and as far as some.
#[test]
fn distances_are_least() {
    let mut chance = ChaCha8Rng::seed_from_u64(1);
    for _ in 0..300 {
        let x = [0; 4].map(|_| Vec3::from_fn(|_, _| chance.random_range(-1.0..1.0)));
        let mut least = [f64::INFINITY; 2];
        for (i, j) in (0..=40).flat_map(|i| (0..=40).map(move |j| (i, j))) {
            let (s, t) = (f64::from(i) / 40.0, f64::from(j) / 40.0);
            let edges = x[0].lerp(&x[1], s) - x[2].lerp(&x[3], t);
            let facet = x[1] + s * (x[2] - x[1]).lerp(&(x[3] - x[1]), t);
            least = [least[0].min((x[0] - facet).norm()), least[1].min(edges.norm())];
        }
        let found = [Closest::of_point_and_facet(&x), Closest::of_edges(&x)];
        for (found, least) in found.iter().zip(least) {
            // Samples a fortieth of 3 mm apart at most miss the least distance by half of that.
            assert!(found.distance <= least + 1e-12 && least < found.distance + 0.05);
            assert!(found.weights.iter().sum::<f64>().abs() < 1e-12);
        }
    }
}

/// The gradient does not jump where the closest features change, nor where edges become parallel: on the way from one case
/// to another, steps a quarter as long make its largest change less than half as large.
#[test]
fn gradients_are_continuous() {
    let features = features();
    for (name, kind, x) in &features {
        let pair = Pair::of_kind(*kind, 0.7, [0.2, 3.0], x);
        for (other_name, other, goal) in &features {
            let same = matches!(kind, Kind::Edges { .. }) == matches!(other, Kind::Edges { .. });
            if !same || name == other_name {
                continue;
            }
            let gradient = |share: f64| {
                let there = std::array::from_fn(|i| x[i].lerp(&goal[i], share));
                let found = pair.derivatives(&there, false).unwrap().unwrap_or_default();
                SVector::<f64, 12>::from_fn(|i, _| found.gradient[i / 3][i % 3])
            };
            let [coarse, fine] = [1000, 4000].map(|steps: usize| {
                let changes = (0..steps).map(|k| {
                    let [one, next] = [k, k + 1].map(|k| gradient(k as f64 / steps as f64));
                    (one - next).norm()
                });
                changes.fold(0.0, f64::max)
            });
            assert!(fine < 0.5 * coarse, "{name} to {other_name}: {coarse} {fine}");
        }
    }
}

#[test]
fn barrier_starts_smoothly_and_its_derivatives_are_differences() {
    for share in [1e-3, 1e-4] {
        let [value, slope, curvature] = barrier(2.0 * (1.0 - share), 2.0);
        // -(h e)^2 ln(1 - e) to leading order; what is left out is of relative size 2 e.
        let close = |value: f64, leading: f64| (value / leading - 1.0).abs() < 2.0 * share;
        assert!(close(value, share.powi(3) * 4.0) && close(slope, -6.0 * share * share));
        assert!(close(curvature, 6.0 * share));
    }
    for d in [0.2, 1.0, 1.7] {
        let [_, slope, curvature] = barrier(d, 2.0);
        // (step / d)^4 is 6e-10 at the smallest.
        let error = difference(STEP, |h| barrier(d + h, 2.0)[0]) / slope - 1.0;
        assert!(error.abs() < 1e-8, "{error:e}");
        let error = difference(STEP, |h| barrier(d + h, 2.0)[1]) / curvature - 1.0;
        assert!(error.abs() < 1e-8, "{error:e}");
    }
}

/// Of the crumpled sheets' wall, mm: barriers then vary over the 0.3 mm that the suite's steps are made for.
const THICKNESS: f64 = 2.0;

/// Two sheets, crumpled as the shell says, about `gap` (mm) apart: with their nodes there.
fn crumpled(shell: &TestShell, gap: f64) -> (Sheets, Vec<Vec3>) {
    let sheets = sheets([4, 3], [12.0, 7.0], 10.0, THICKNESS);
    let mut positions = sheets.lifted(gap - 10.0);
    for (x, chance) in positions.iter_mut().zip(shell.deformed.iter().cycle()) {
        *x += chance.map(|chance| 0.05 * (7.0 * chance).sin());
    }
    (sheets, positions)
}

fn smallest_gap(wall: &WallSurface, positions: &[Vec3]) -> f64 {
    let pose = wall.pose(positions, None);
    let mut smallest = f64::INFINITY;
    wall.visit_near(&pose, Search::within(1.5 * wall.thickness), &mut |_, couple| {
        let [thickness, _] = wall.thickness_of(&couple);
        smallest = smallest.min(couple.closest(&pose.samples).distance - thickness);
    });
    smallest
}

fn touching(shell: &TestShell) -> Case<PairTerm> {
    let (sheets, positions) = crumpled(shell, 0.4);
    let settings = SelfContactSettings { activation: 0.5, stiffness: 3.0 };
    let term = sheets.contact(settings).listed_near(&positions);
    let turn = UnitQuaternion::from_euler_angles(0.3, -0.8, 1.9);
    let motion = Isometry3::from_parts(Translation3::new(0.3, -0.5, 0.2), turn);
    Case { term, positions, motion }
}

/// The suite of terms, but for its differences: some of these hundreds of barriers begin within its steps, where third
/// derivatives jump.
#[test]
fn term_is_one_of_the_assembler() {
    term_suite::stencils_ascend(touching);
    term_suite::derivatives_do_not_depend_on_what_is_asked(touching);
    term_suite::rigid_motion_turns_the_gradient_and_keeps_the_energy(touching);
    term_suite::inactive_stencils_have_no_energy(touching);
}

/// What the pairs' derivatives become on the nodes. Steps of 2e-5 mm seldom meet the beginning of a barrier, and then miss
/// less than 1e-6 of the largest entry; rounding leaves 1e-9.
#[test]
fn derivatives_of_the_term_are_differences() {
    let Case { term, positions, .. } = touching(&TestShell::new(0));
    let (mut compared, step) = (0, 2e-5);
    for (s, stencil) in term.stencils().iter().enumerate() {
        let x: Vec<Vec3> = stencil.iter().map(|&v| positions[v as usize]).collect();
        let derivatives = |x: &[Vec3]| {
            let mut local = LocalDerivatives::default();
            local.reset(x.len(), true);
            term.derivatives(s, x, &mut local).unwrap();
            local
        };
        let exact = derivatives(&x);
        let gradient = |x: &[Vec3]| {
            let local = derivatives(x);
            DVector::from_iterator(3 * x.len(), local.gradient().iter().flatten().copied())
        };
        let largest = gradient(&x).amax();
        // Elsewhere barriers only just begin.
        if largest < 0.1 {
            continue;
        }
        compared += 1;
        let moved = |unknown: usize, h: f64| {
            let mut x = x.clone();
            x[unknown / 3][unknown % 3] += h;
            x
        };
        let block = |row: usize, column: usize| match row / 3 >= column / 3 {
            true => exact.block(row / 3, column / 3)[(row % 3, column % 3)],
            false => exact.block(column / 3, row / 3)[(column % 3, row % 3)],
        };
        let all = || (0..3 * x.len()).flat_map(|i| (0..3 * x.len()).map(move |j| (i, j)));
        let stiffest = all().map(|(i, j)| block(i, j).abs()).fold(0.0, f64::max);
        for unknown in 0..3 * x.len() {
            let slope = difference(step, |h| term.energy(s, &moved(unknown, h)).unwrap());
            let error = (slope - gradient(&x)[unknown]).abs() / largest;
            assert!(error < 1e-6, "{s}, gradient {unknown}: {error:e}");
            let column = difference(step, |h| gradient(&moved(unknown, h)));
            for (row, slope) in column.iter().enumerate() {
                let error = (slope - block(row, unknown)).abs() / stiffest;
                assert!(error < 1e-6, "{s}, Hessian {row} {unknown}: {error:e}");
            }
        }
    }
    assert!(compared > 20, "{compared}");
}

/// Two flat sheets of squares one above the other, the lower one larger: the wall, its nodes at rest, how many of them
/// (and of the samples) are the lower sheet's.
fn sheets(cells: [usize; 2], sizes: [f64; 2], rest_gap: f64, thickness: f64) -> Sheets {
    let (mut nodes, mut triangles) = (Vec::new(), Vec::new());
    let mut lower_nodes = 0;
    for (sheet, (cells, size)) in cells.into_iter().zip(sizes).enumerate() {
        let first = nodes.len() as u32;
        lower_nodes = if sheet == 1 { nodes.len() } else { 0 };
        let z = (thickness + rest_gap) * sheet as f64;
        let step = size / cells as f64;
        let turn = 0.4 * sheet as f64;
        for (i, j) in (0..=cells).flat_map(|j| (0..=cells).map(move |i| (i, j))) {
            let [x, y] = [i, j].map(|k| step * k as f64 - size / 2.0);
            let turned = [x * turn.cos() - y * turn.sin(), x * turn.sin() + y * turn.cos()];
            nodes.push(Vec3::new(turned[0], turned[1], z));
        }
        let corner = |i: usize, j: usize| first + (j * (cells + 1) + i) as u32;
        for (i, j) in (0..cells).flat_map(|j| (0..cells).map(move |i| (i, j))) {
            let [a, b, c, d] =
                [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    let points: Vec<ElementPoints> =
        triangles.iter().map(|&triangle| ElementPoints::of_facet(triangle)).collect();
    let section = Section::uniform(thickness);
    let surface = SampledSurface::new(&triangles, &points, nodes.len(), &section);
    let wall = WallSurface::new(&points, &surface, &nodes);
    Sheets { wall: Arc::new(wall), nodes, lower_nodes }
}

struct Sheets {
    wall: Arc<WallSurface>,
    nodes: Vec<Vec3>,
    lower_nodes: usize,
}

impl Sheets {
    /// The nodes with the upper sheet lifted by `lift`, mm.
    fn lifted(&self, lift: f64) -> Vec<Vec3> {
        let mut nodes = self.nodes.clone();
        nodes[self.lower_nodes..].iter_mut().for_each(|x| x.z += lift);
        nodes
    }

    fn contact(&self, settings: SelfContactSettings) -> WallContact {
        WallContact::new(self.wall.clone(), settings)
    }
}

/// The points of a sheet carry the pressure of the gap, exactly, whatever the meshes; edges add no more than a quarter.
#[test]
fn pressure_does_not_depend_on_the_meshes() {
    let settings = SelfContactSettings { activation: 0.2, stiffness: 5.0 };
    let (thickness, gap) = (1.0, 0.1);
    for cells in [[4, 2], [8, 5], [11, 16]] {
        let sheets = sheets(cells, [12.0, 5.0], 10.0, thickness);
        let positions = sheets.lifted(gap - 10.0);
        let contact = sheets.contact(settings);
        let samples = sheets.wall.samples_at(&positions);
        let (mut of_upper, mut of_lower, mut of_edges) = (0.0, 0.0, 0.0);
        for (numbers, pair) in contact.listed_near(&positions).pairs() {
            let numbers = pair.points.map(|point| numbers[point as usize]);
            let x = numbers.map(|v| samples[v as usize]);
            let Some(found) = pair.derivatives(&x, false).unwrap() else { continue };
            let pushed: Vec3 = found.gradient[..pair.first()].iter().sum();
            match (pair.first(), x[0].z > 0.5) {
                (1, true) => of_upper -= pushed.z,
                (1, false) => of_lower += pushed.z,
                _ => of_edges += pushed.z.abs(),
            }
        }
        let exact = 5.0 * -barrier(gap, 0.2)[1] * 25.0;
        // Some hundred barriers cancel in each sum.
        assert!((2.0 * of_upper / exact - 1.0).abs() < 1e-10, "{cells:?}: {of_upper} {exact}");
        // The lower points' share of the upper sheet's area is theirs to within half a cell around its rim.
        let cell = 12.0 / cells[0] as f64 / 2.0;
        assert!((2.0 * of_lower / exact - 1.0).abs() < 2.0 * cell / 5.0, "{of_lower} {exact}");
        assert!(of_edges < 0.25 * exact, "{of_edges} {exact}");
        let force = contact.force(&positions);
        let sum = of_upper + of_lower + of_edges;
        // Forces on the lower points at the upper sheet's rim are not all upright.
        assert!((force / sum - 1.0).abs() < 0.02, "{force} {sum}");
    }
}

/// Faces that stand a twentieth of the thickness apart at rest, or nearly touch, store nothing and push when pressed.
#[test]
fn near_walls_store_nothing_at_rest() {
    let settings = SelfContactSettings { activation: 0.2, stiffness: 5.0 };
    for rest_gap in [0.05, 0.001, -0.3] {
        let sheets = sheets([6, 4], [12.0, 5.0], rest_gap, 1.0);
        let mut contact = sheets.contact(settings);
        let energy = |contact: &mut WallContact, lift: f64| {
            let nodes = sheets.lifted(lift);
            contact.list(&nodes);
            let term: &dyn Term = contact;
            let of_stencil = |s: usize| {
                let x: Vec<Vec3> = term.stencils()[s].iter().map(|&v| nodes[v as usize]).collect();
                term.energy(s, &x)
            };
            (0..term.stencils().len()).map(of_stencil).sum::<Result<f64, _>>()
        };
        assert_eq!(energy(&mut contact, 0.0), Ok(0.0));
        let tenth = 0.1 * (1.0 + rest_gap);
        let near = energy(&mut contact, -0.8 * tenth.max(rest_gap)).unwrap();
        assert!(near > 0.0, "{rest_gap}: {near}");
        assert!(energy(&mut contact, -1.01 * tenth.max(rest_gap)).is_err());
    }
}

/// The longest step leaves gaps open all the way, for motions small and large, and shortens those that close one.
#[test]
fn longest_step_keeps_all_gaps_open() {
    let (sheets, positions) = crumpled(&TestShell::new(1), 0.4);
    let settings = SelfContactSettings { activation: 0.5, stiffness: 5.0 };
    let mut contact = sheets.contact(settings);
    contact.list(&positions);
    let mut chance = ChaCha8Rng::seed_from_u64(2);
    for (size, is_whole) in [(0.02, true), (0.25, false), (4.0, false)] {
        for _ in 0..3 {
            let mut pushed = |node: usize| {
                let chance = Vec3::from_fn(|_, _| chance.random_range(-0.3..0.3));
                let way = if node < sheets.lower_nodes { 1.0 } else { -1.0 };
                size * (chance + way * Vec3::z())
            };
            let dx: Vec<Vec3> = (0..positions.len()).map(&mut pushed).collect();
            let step = contact.longest_part(&positions, &dx);
            assert!(0.0 < step && (step == 1.0) == is_whole, "{size}: {step}");
            for k in 0..=20 {
                let share = step * f64::from(k) / 20.0;
                let there: Vec<Vec3> =
                    positions.iter().zip(&dx).map(|(x, dx)| x + share * dx).collect();
                assert!(smallest_gap(&sheets.wall, &there) > 0.0, "{size}");
            }
            // As a search of the whole motion finds it without a list.
            let searched = sheets.contact(settings).longest_part(&positions, &dx);
            assert!(is_whole || (searched / step - 1.0).abs() < 0.5, "{searched} {step}");
        }
    }
}

/// A list made elsewhere gives the same bits as one made here, and none is made while nothing has moved far.
#[test]
fn energy_does_not_depend_on_when_pairs_were_listed() {
    let (sheets, near) = crumpled(&TestShell::new(2), 0.4);
    let (_, nearer) = crumpled(&TestShell::new(2), 0.35);
    let settings = SelfContactSettings { activation: 0.5, stiffness: 5.0 };
    let (mut one, mut other) = (sheets.contact(settings), sheets.contact(settings));
    assert!(one.list(&near) && !one.list(&nearer) && other.list(&nearer));
    let energies = |contact: &WallContact| -> Vec<f64> {
        let term: &dyn Term = contact;
        let energy = |s: usize| {
            let x: Vec<Vec3> = term.stencils()[s].iter().map(|&v| nearer[v as usize]).collect();
            term.energy(s, &x).unwrap()
        };
        let active = (0..term.stencils().len()).filter(|&s| term.is_active(s, &nearer));
        active.map(energy).filter(|energy| *energy != 0.0).collect()
    };
    assert_eq!(energies(&one), energies(&other));
    assert!(!energies(&one).is_empty());
    assert_eq!(one.force(&nearer), other.force(&nearer));
    // Far apart nothing is listed, and no room is wanted.
    let mut far = sheets.contact(settings);
    assert!(!far.list(&sheets.nodes) && far.make_room().is_none());
    assert!(far.stencils().is_empty() && far.force(&sheets.nodes) == 0.0);
    // There is room for what is listed, until all of it is far too much.
    assert!(one.make_room().is_some_and(|room| room.len() >= one.stencils().len()));
    assert!(one.make_room().is_none());
}
