//! Folds that touch: a hairpin whose arms are pressed together, and a bellows that is pushed together.
//!
//! Distances are measured here anew, facet by facet and all pairs compared.

use std::f64::consts::PI;

use pneumorph::math::Vec3;
use pneumorph::mesh::{Patch, ShellElement, ShellMesh, ShellSettings, Side};
use pneumorph::model::contact::SelfContactSettings;
use pneumorph::model::material::{Material, NeoHookean};
use pneumorph::model::system::{LimitKind, LoadedSystem, System};
use pneumorph::model::{
    DeadLoad, EdgeSupport, FoldContact, PartModel, PartSetup, PatchLoads, Support,
};
use pneumorph::solve::{Ending, Path, PathSettings};
use pneumorph::surface::TriangleMesh;

use crate::parts::walked;

const MATERIAL: Material = Material::NeoHookean(NeoHookean { mu: 1.0 });

/// A strip bent to a U: one arm below, held at its end, half a circle, and one arm above, pressed down at its end.
struct Hairpin {
    patch: Patch,
    loads: PatchLoads,
}

const ARM: f64 = 6.0;
const RADIUS: f64 = 1.2;
const HAIRPIN_THICKNESS: f64 = 0.4;
const WIDTH: f64 = 2.0;
/// On the end of the upper arm, N/mm.
const PRESS: f64 = 4e-4;

fn hairpin(cells: [usize; 2]) -> Hairpin {
    let strip = |s: f64, t: f64| {
        let bend = (s - ARM) / RADIUS;
        if s < ARM {
            Vec3::new(s, t, 0.0)
        } else if bend < PI {
            Vec3::new(ARM + RADIUS * bend.sin(), t, RADIUS * (1.0 - bend.cos()))
        } else {
            Vec3::new(ARM - (bend - PI) * RADIUS, t, 2.0 * RADIUS)
        }
    };
    let range = [0.0, 2.0 * ARM + PI * RADIUS];
    let patch = Patch::new(cells, range, [0.0, WIDTH], HAIRPIN_THICKNESS, &strip).unwrap();
    let supports = [EdgeSupport::Clamped, EdgeSupport::Free, EdgeSupport::Free, EdgeSupport::Free];
    let down = DeadLoad::Edge { side: Side::S1, per_length: Vec3::new(0.0, 0.0, -PRESS) };
    Hairpin { patch, loads: PatchLoads { supports, dead: vec![down], ..Default::default() } }
}

impl Hairpin {
    fn model(&self, element: ShellElement, folds: FoldContact) -> PartModel {
        PartModel::of_patch(&self.patch, element, &MATERIAL, &self.loads, &among(folds)).unwrap()
    }
}

/// Nothing but the part's own folds.
fn among(folds: FoldContact) -> PartSetup {
    PartSetup { folds: Some(folds), ..PartSetup::default() }
}

fn barrier(thickness: f64, pressure: f64) -> FoldContact {
    FoldContact::Barrier(SelfContactSettings::of_wall(thickness, pressure))
}

/// A quarter of a bellows of two folds between planes of symmetry, its lower end in a plane of symmetry, its upper one pushed
/// down.
fn bellows() -> (Patch, PatchLoads) {
    let round = |s: f64, t: f64| {
        let r = 8.0 + 1.5 * (PI * t / 2.0).cos();
        Vec3::new(r * s.sin(), r * s.cos(), t)
    };
    let patch = Patch::new([2, 20], [0.0, PI / 2.0], [0.0, 6.0], 0.4, &round).unwrap();
    let supports = [
        EdgeSupport::Symmetry(0),
        EdgeSupport::Symmetry(1),
        EdgeSupport::Symmetry(2),
        EdgeSupport::Held([true, true, false]),
    ];
    let down = DeadLoad::Edge { side: Side::T1, per_length: Vec3::new(0.0, 0.0, -0.007) };
    (patch, PatchLoads { supports, dead: vec![down], ..Default::default() })
}

/// The least distance between facets of `positions` whose vertices all differ by more than `apart` cells along the strip, mm.
fn least_distance(patch: &Patch, positions: &[Vec3], along: usize, apart: isize) -> f64 {
    let places = patch.node_places();
    let triangles = &patch.surface.triangles;
    let mut least = f64::INFINITY;
    for (k, one) in triangles.iter().enumerate() {
        for other in &triangles[k + 1..] {
            let far = one.iter().all(|&v| {
                other
                    .iter()
                    .all(|&w| (places[v as usize][along] - places[w as usize][along]).abs() > apart)
            });
            let [p, q] = [one, other].map(|it| it.map(|v| positions[v as usize]));
            // The balls around them first.
            let [a, b] = [p, q].map(|x| x.iter().sum::<Vec3>() / 3.0);
            let radius =
                |x: &[Vec3; 3], c: Vec3| x.iter().map(|x| (x - c).norm()).fold(0.0, f64::max);
            if far && (a - b).norm() - radius(&p, a) - radius(&q, b) < least {
                least = least.min(distance_of_facets(&p, &q));
            }
        }
    }
    least
}

fn distance_of_facets(p: &[Vec3; 3], q: &[Vec3; 3]) -> f64 {
    let sides = |x: &[Vec3; 3]| [[x[0], x[1]], [x[1], x[2]], [x[2], x[0]]];
    let mut least = f64::INFINITY;
    for [a, b] in sides(p) {
        for [c, d] in sides(q) {
            least = least.min(distance_of_segments(a, b, c, d));
        }
    }
    for (points, facet) in [(p, q), (q, p)] {
        let normal = (facet[1] - facet[0]).cross(&(facet[2] - facet[0])).normalize();
        for x in points {
            let height = normal.dot(&(x - facet[0]));
            let foot = x - height * normal;
            let inside =
                sides(facet).iter().all(|[a, b]| (b - a).cross(&(foot - a)).dot(&normal) >= 0.0);
            if inside {
                least = least.min(height.abs());
            }
        }
    }
    least
}

/// By turns the closest point of one segment to the other's: a convex problem.
fn distance_of_segments(a: Vec3, b: Vec3, c: Vec3, d: Vec3) -> f64 {
    let share = |from: Vec3, along: Vec3| (from.dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
    let (mut on_one, mut on_other) = ((a + b) / 2.0, (c + d) / 2.0);
    for _ in 0..60 {
        on_one = a + share(on_other - a, b - a) * (b - a);
        on_other = c + share(on_one - c, d - c) * (d - c);
    }
    (on_one - on_other).norm()
}

fn deformed(patch: &Patch, model: &PartModel, u: &[f64]) -> Vec<Vec3> {
    let moved = model.vertex_displacements(u);
    patch.surface.positions.iter().zip(&moved).map(|(x, u)| x + u).collect()
}

/// Work done is energy stored, step by step, to the tolerance with which paths are walked; but where the part snapped.
#[track_caller]
fn assert_work_is_stored(path: &Path) {
    let mut snaps = 0;
    for step in path.points.windows(2) {
        let work = step[1].work - step[0].work;
        let stored = step[1].stored_energy - step[0].stored_energy;
        let is_kept = (work - stored).abs() <= 1e-3 * step[1].work;
        snaps += usize::from(!is_kept);
        assert!(is_kept || step[1].snap.is_some(), "{work} {stored}");
    }
    assert!(snaps <= 2, "{snaps}");
}

/// Both elements: the arms meet, press on each other with more than half of the load, and stay apart by their thickness less
/// what facets cut off their curves; without contact they would pass.
#[test]
fn arms_of_a_hairpin_keep_apart() {
    for element in [ShellElement::Loop, ShellElement::MidEdge] {
        let hairpin = hairpin([24, 2]);
        let mut model = hairpin.model(element, barrier(HAIRPIN_THICKNESS, 1e-3));
        let path = walked(&mut model, 1.0, &PathSettings::default());
        assert!(path.ending.is_complete(), "{:?}", path.ending);
        assert_work_is_stored(&path);
        for point in &path.points {
            let positions = deformed(&hairpin.patch, &model, &point.x);
            let distance = least_distance(&hairpin.patch, &positions, 0, 7);
            assert!(distance > 0.99 * HAIRPIN_THICKNESS, "{distance}");
            assert!(model.smallest_wall_gap(&point.x) > 0.0);
            assert_eq!(model.passed_limit(&point.x), None);
        }
        let last = path.points.last().unwrap();
        assert!(model.smallest_wall_gap(&last.x) < 0.2 * HAIRPIN_THICKNESS);
        assert!(model.self_contact_force(&last.x) > 0.5 * PRESS * WIDTH);

        // Without contact the path ends where the arms touch, to a smallest step; unwatched, they pass each other.
        let mut watched = hairpin.model(element, FoldContact::Ends);
        let path = walked(&mut watched, 1.0, &PathSettings::default());
        assert_eq!(path.ending, Ending::SelfTouch);
        assert!(path.place.unwrap() < watched.unknowns());
        let gap = watched.smallest_wall_gap(&path.points.last().unwrap().x);
        assert!((0.0..0.3 * HAIRPIN_THICKNESS).contains(&gap), "{gap}");
        let mut unseen = hairpin.model(element, FoldContact::Unseen);
        let path = walked(&mut unseen, 1.0, &PathSettings::default());
        assert!(path.ending.is_complete());
        assert!(unseen.smallest_wall_gap(&path.points.last().unwrap().x) < 0.0);
    }
}

/// The folds of a bellows snap shut under their load, press on each other, and stay apart.
#[test]
fn folds_of_a_bellows_keep_apart() {
    let (patch, loads) = bellows();
    let (element, setup) = (ShellElement::Loop, among(barrier(0.4, 0.01)));
    let mut model = PartModel::of_patch(&patch, element, &MATERIAL, &loads, &setup).unwrap();
    let settings = PathSettings { steps: 8, halvings: 3, ..Default::default() };
    let path = walked(&mut model, 1.0, &settings);
    assert!(path.ending.is_complete(), "{:?}", path.ending);
    assert_work_is_stored(&path);
    for point in &path.points {
        let positions = deformed(&patch, &model, &point.x);
        let distance = least_distance(&patch, &positions, 1, 3);
        assert!(distance > 0.99 * 0.4, "{distance}");
    }
    let last = path.points.last().unwrap();
    assert!(model.self_contact_force(&last.x) > 0.0);
}

/// Folds that stay far apart change nothing, to the bit.
#[test]
fn far_folds_change_nothing() {
    let hairpin = hairpin([16, 2]);
    let settings = PathSettings { steps: 3, ..Default::default() };
    let paths = [FoldContact::Unseen, barrier(HAIRPIN_THICKNESS, 1e-3)].map(|folds| {
        let mut model = hairpin.model(ShellElement::Loop, folds);
        let path = walked(&mut model, 0.1, &settings);
        assert!(model.smallest_wall_gap(&path.points.last().unwrap().x) > 0.1);
        path
    });
    assert_eq!(paths[0].ending, Ending::Reached);
    assert_eq!(paths[0], paths[1]);
}

/// A sphere pressed flat: watched unless told otherwise, and not where its folds are kept apart.
#[test]
fn closed_parts_are_watched() {
    let surface = TriangleMesh::sphere(10.0, 3);
    let settings = ShellSettings { clamp_height: 1.0, ..Default::default() };
    let mesh = ShellMesh::new(surface, &settings).unwrap();
    let model =
        |setup: &PartSetup| PartModel::new(&mesh, &MATERIAL, &Support::Clamp, setup).unwrap();
    let watched = model(&PartSetup::default());
    let dented = |share: f64| -> Vec<f64> {
        let dent = |x: &Vec3| {
            let beside = (x.x * x.x + x.y * x.y) / 100.0;
            [0.0, 0.0, x.z * ((share + beside).min(1.0) - 1.0)]
        };
        mesh.surface.positions.iter().flat_map(dent).collect()
    };
    let rest = vec![0.0; watched.unknowns()];
    assert_eq!(watched.passed_limit(&rest), None);
    assert_eq!(watched.smallest_wall_gap(&rest), f64::INFINITY);
    // The poles' faces are 2 share 10 mm - thickness apart, and rounded a little by the limit surface.
    let near = dented(0.1);
    assert_eq!(watched.passed_limit(&near), None);
    let gap = watched.smallest_wall_gap(&near);
    assert!((0.2..0.8).contains(&gap), "{gap}");
    let past = dented(0.05);
    let limit = watched.passed_limit(&past).unwrap();
    let node = limit.unknown / 3;
    let x = mesh.surface.positions[node];
    assert!(limit.kind == LimitKind::SelfTouch && x.x.hypot(x.y) < 4.0, "{x}");
    assert_eq!(model(&among(FoldContact::Unseen)).passed_limit(&past), None);
    let mut apart = model(&among(barrier(mesh.section.thickness(0), 0.01)));
    assert_eq!(apart.passed_limit(&past), None);
    assert!(apart.energy(&past).is_err() && apart.energy(&near).is_ok());
}
