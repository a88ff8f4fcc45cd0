//! Incremental isotropic remeshing: triangles of one edge length on the zero level of a field, or on given triangles.
//!
//! ```text
//! repeat: split edges > 4/3 h, collapse edges < 4/5 h, flip towards valence 6,
//!         move each vertex to the middle of its neighbours along the surface, project it on the level
//! ```
//! The number of handles never changes. Sharp rims of a level are not kept as features: they are rounded within
//! about an edge length. Those of given triangles are: their vertices move along them alone. What the edge length cannot resolve is
//! refused, not approximated.
//!
//! Source: Botsch and Kobbelt (2004), A remeshing approach to multiresolution modeling, SGP, section 4.

mod edits;
mod passes;
mod sharp;

use std::collections::BTreeSet;

use crate::field::ScalarField;
use crate::math::{Reason, Rejected, Room};

use super::{HalfEdges, SurfaceQuality, TriangleMesh, intersecting_pairs};
use passes::{Target, Workpiece};
use sharp::{Original, SharpEdges};

/// The target of remeshing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RemeshSettings {
    /// The edge length wanted, mm.
    pub edge: f64,
    /// How often the passes are repeated; 10 is usual.
    pub iterations: usize,
}

/// How triangles become smaller where the surface bends, so that their chords stay near it.
///
/// ```text
/// L = sqrt(6 e / k - 3 e^2), between the shortest edge and the one wanted; k: the curvature, e: the chord error
/// ```
/// Source: Dunyach, Vanderhaeghe, Barthe and Botsch (2013), Adaptive remeshing for real-time mesh deformation, Eurographics.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grading {
    /// The shortest edge wanted, mm.
    pub shortest: f64,
    /// The distance wanted between a triangle and the surface, mm.
    pub chord_error: f64,
}

/// `mesh`, a closed manifold, in triangles of edge `settings.edge` with its vertices on the zero level of
/// `field`; without a field the vertices stay near their tangent planes, and flat detail is lost slowly.
///
/// # Errors
/// [`Rejected`] with the reason `defective_surface` when `mesh` is no closed manifold, `too_many_triangles`
/// when its area needs more than two million, `unresolved_surface` when the triangles miss the limits on
/// valence, shape, length, fold, necks or volume (the violation is the sum of the relative misses), and
/// `self_intersecting` when they pass through each other (the violation is the share that do).
///
/// # Panics
/// When the edge length is not a positive number.
pub fn remesh(
    mesh: &TriangleMesh,
    field: Option<&dyn ScalarField>,
    settings: &RemeshSettings,
) -> Result<TriangleMesh, Rejected> {
    let target = field.map_or(Target::Nearby, Target::Level);
    remeshed(mesh, target, SharpEdges::default(), settings, None).map(|(mesh, _)| mesh)
}

/// `mesh`, a closed manifold of triangles of any shape, in triangles of edge `settings.edge` with their corners on the given ones.
///
/// Edges that turn by more than `sharp` (degrees) stay edges, which are returned too (by their vertices, the lesser first), and where
/// they meet stay corners. A needle, a fan or a facet that
/// is longer than `settings.edge` leaves no trace.
///
/// # Errors
/// As [`remesh`], `too_many_triangles` too for a part of more than 2000 edges' length, and `unresolved_surface` too where the new triangles leave the given ones by more than half an edge, or
/// are left by them by more than an edge (the violation is by how much more, over it).
///
/// # Panics
/// When the edge length is not a positive number.
pub fn remesh_triangles(
    mesh: &TriangleMesh,
    settings: &RemeshSettings,
    sharp: f64,
) -> Result<(TriangleMesh, BTreeSet<[u32; 2]>), Rejected> {
    let longest = mesh.bounding_box().map_or(0.0, |(lower, upper)| (upper - lower).max());
    let share = longest / (MOST_EDGES * settings.edge);
    if share > 1.0 {
        let detail = format!(
            "it is {longest:.0} mm long, {:.0} edges of {} mm where {MOST_EDGES:.0} are allowed",
            longest / settings.edge,
            settings.edge
        );
        return Err(Rejected::new(Room::Surface, Reason::TooManyTriangles, detail, share - 1.0));
    }
    let edges =
        SharpEdges::of(mesh, &HalfEdges::try_from(mesh)?, sharp, SHORTEST_LINE * settings.edge);
    let original = Original::new(mesh, &edges);
    let (remeshed, sharp) = remeshed(mesh, Target::Triangles(&original), edges, settings, None)?;
    let new = Original::new(&remeshed, &SharpEdges::default());
    let shares = [
        original.farthest(&remeshed) / (MOST_DEPARTURE * settings.edge),
        new.farthest(mesh) / (MOST_LOSS * settings.edge),
    ];
    let share = shares.into_iter().fold(0.0, f64::max);
    if share > 1.0 {
        let detail = format!(
            "with edges of {} mm: the new triangles leave the given ones by {:.2} mm, and are left by {:.2} mm",
            settings.edge,
            shares[0] * MOST_DEPARTURE * settings.edge,
            shares[1] * MOST_LOSS * settings.edge
        );
        return Err(Rejected::new(Room::Surface, Reason::UnresolvedSurface, detail, share - 1.0));
    }
    Ok((remeshed, sharp))
}

/// The edges of `mesh`, a closed manifold, that turn by more than `sharp` (degrees) and hang together over two of its mean edges or
/// more, the lesser vertex first.
///
/// # Errors
/// [`Rejected`] when it is no closed manifold.
pub fn sharp_edges(mesh: &TriangleMesh, sharp: f64) -> Result<BTreeSet<[u32; 2]>, Rejected> {
    let surface = HalfEdges::try_from(mesh)?;
    let mean = SurfaceQuality::of(mesh)?.edge_mean;
    let numbers: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    Ok(SharpEdges::of(mesh, &surface, sharp, SHORTEST_LINE * mean).renumbered(&numbers))
}

/// The zero level of `field` in triangles that are smaller where it bends; `mesh` is near it, a closed manifold.
///
/// Necks of three edges may remain: tetrahedra can fill what no subdivision element stands on.
///
/// # Errors
/// As [`remesh`].
///
/// # Panics
/// When a length is not a positive number.
pub fn remesh_graded(
    mesh: &TriangleMesh,
    field: &dyn ScalarField,
    settings: &RemeshSettings,
    grading: &Grading,
) -> Result<TriangleMesh, Rejected> {
    let Grading { shortest, chord_error, .. } = *grading;
    let is_length = |x: f64| x > 0.0 && x.is_finite();
    assert!(is_length(shortest) && is_length(chord_error), "{grading:?} must be positive numbers");
    remeshed(mesh, Target::Level(field), SharpEdges::default(), settings, Some(grading))
        .map(|(mesh, _)| mesh)
}

fn remeshed(
    mesh: &TriangleMesh,
    target: Target<'_>,
    sharp: SharpEdges,
    settings: &RemeshSettings,
    grading: Option<&Grading>,
) -> Result<(TriangleMesh, BTreeSet<[u32; 2]>), Rejected> {
    let edge = settings.edge;
    assert!(edge > 0.0 && edge.is_finite(), "the edge must be a positive number, not {edge}");
    mesh.check_closed_manifold()?;
    let needed = mesh.area() / (0.75f64.sqrt() / 2.0 * edge * edge);
    if needed > MOST_TRIANGLES {
        let detail =
            format!("edges of {edge} mm need {needed:.0} triangles, {MOST_TRIANGLES} at most");
        let excess = needed / MOST_TRIANGLES - 1.0;
        return Err(Rejected::new(Room::Surface, Reason::TooManyTriangles, detail, excess));
    }
    let mut work = Workpiece::new(HalfEdges::try_from(mesh)?, &mesh.positions, target, sharp, edge);
    if matches!(target, Target::Triangles(_)) {
        work.cut_up();
    }
    for _ in 0..settings.iterations {
        if let Some(grading) = grading {
            work.grade(grading);
        }
        work.split_long();
        work.collapse_short();
        work.equalise_valence();
        work.relax();
    }
    for _ in 0..MOST_REPAIRS {
        if !work.repair() {
            break;
        }
        work.equalise_valence();
        work.relax();
    }
    let (remeshed, sharp) = work.into_mesh();
    let quality = SurfaceQuality::of(&remeshed)?;
    let limits = match grading {
        None => Limits { shortest: SHORTEST * edge, sharpest: SHARPEST_FOLD, necks: 0 },
        Some(grading) => Limits {
            shortest: SHORTEST * grading.shortest,
            sharpest: SHARPEST_WEDGE,
            necks: usize::MAX,
        },
    };
    check_resolved(&quality, mesh, edge, &limits)?;
    check_apart(&remeshed)?;
    Ok((remeshed, sharp))
}

/// What differs between what shells and tetrahedra can stand.
struct Limits {
    /// Edge, mm.
    shortest: f64,
    /// Angle between neighbouring normals, degrees.
    sharpest: f64,
    /// Edges on necks of three.
    necks: usize,
}

fn check_resolved(
    quality: &SurfaceQuality,
    original: &TriangleMesh,
    edge: f64,
    limits: &Limits,
) -> Result<(), Rejected> {
    let neck_edges = quality.neck_edges.saturating_sub(limits.necks);
    let volume_change = quality.volume / original.volume() - 1.0;
    let below = |value: f64, limit: f64| (1.0 - value / limit).max(0.0);
    let above = |value: f64, limit: f64| (value / limit - 1.0).max(0.0);
    let violation = below(quality.valence_min as f64, *VALENCES.start() as f64)
        + above(quality.valence_max as f64, *VALENCES.end() as f64)
        + below(quality.radius_ratio_min, LEAST_RADIUS_RATIO)
        + below(quality.edge_min, limits.shortest)
        + above(quality.edge_max, LONGEST * edge)
        + above(quality.dihedral_max, limits.sharpest)
        + above(volume_change.abs(), MOST_VOLUME_CHANGE)
        + neck_edges as f64 / 3.0;
    if violation > 0.0 {
        let detail = format!(
            "with edges of {edge} mm: valence {}..{}, radius ratio from {:.2}, edges {:.2}..{:.2} mm, \
             folds up to {:.0} degrees, {neck_edges} edges on necks of three, volume {:+.1} %",
            quality.valence_min,
            quality.valence_max,
            quality.radius_ratio_min,
            quality.edge_min,
            quality.edge_max,
            quality.dihedral_max,
            100.0 * volume_change,
        );
        return Err(Rejected::new(Room::Surface, Reason::UnresolvedSurface, detail, violation));
    }
    Ok(())
}

fn check_apart(mesh: &TriangleMesh) -> Result<(), Rejected> {
    let pairs = intersecting_pairs(mesh).len();
    if pairs > 0 {
        let detail = format!("{pairs} pairs of triangles pass through each other");
        let share = pairs as f64 / mesh.triangles.len() as f64;
        return Err(Rejected::new(Room::Surface, Reason::SelfIntersecting, detail, share));
    }
    Ok(())
}

/// Along a part: planes at which triangles are cut.
const MOST_EDGES: f64 = 2000.0;
/// Of a sharp line, over the edge wanted.
const SHORTEST_LINE: f64 = 2.0;
/// Of new triangles from given ones, over the edge wanted: the middle of a chord across a right angle is 0.35 away.
const MOST_DEPARTURE: f64 = 0.5;
/// Of given triangles from new ones, over the edge wanted: more is a fin or a pin that was cut off.
const MOST_LOSS: f64 = 1.0;

/// The valences that a shell of subdivision elements is integrated for.
const VALENCES: std::ops::RangeInclusive<usize> = 4..=9;
const LEAST_RADIUS_RATIO: f64 = 0.3;
/// Limits of the edge length, over the one wanted.
const SHORTEST: f64 = 0.3;
const LONGEST: f64 = 2.0;
/// Between neighbouring normals, degrees; a cap on a wall that leans out by 45 degrees makes 135.
const SHARPEST_FOLD: f64 = 150.0;
/// A wedge of air of ten degrees is no harm to the wall around it.
const SHARPEST_WEDGE: f64 = 170.0;
/// Rounding the rims of a tube of 20 mm with edges of 4 mm costs 10 % of its volume.
const MOST_VOLUME_CHANGE: f64 = 0.2;
const MOST_REPAIRS: usize = 10;
const MOST_TRIANGLES: f64 = 2e6;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;
    use crate::surface::isosurface;
    use crate::surface::test_fields::{Analytic, Ripples, capped, sphere, torus};

    fn rough(field: &impl ScalarField, half: f64, step: f64) -> TriangleMesh {
        isosurface(field, Vec3::repeat(-half), Vec3::repeat(half), step)
    }

    fn settings(edge: f64) -> RemeshSettings {
        RemeshSettings { edge, iterations: 10 }
    }

    /// Botsch and Kobbelt's figures for smooth surfaces: nearly all valences 5..7, ratios above 0.7.
    fn assert_even(quality: &SurfaceQuality, edge: f64) {
        assert!(quality.valence_min >= 4 && quality.valence_max <= 8, "{quality:?}");
        assert!(quality.radius_ratio_min > 0.6 && quality.radius_ratio_mean > 0.95, "{quality:?}");
        assert!(quality.edge_variation < 0.15, "{quality:?}");
        assert!((0.9..1.1).contains(&(quality.edge_mean / edge)), "{quality:?}");
    }

    #[test]
    fn sphere_becomes_even_and_stays_on_the_level() {
        let field = sphere(10.0);
        let mesh = remesh(&rough(&field, 12.0, 0.9), Some(&field), &settings(1.5)).unwrap();
        assert_eq!(mesh.check_closed_manifold(), Ok(()));
        let quality = SurfaceQuality::of(&mesh).unwrap();
        assert_even(&quality, 1.5);
        assert_eq!(quality.genus, 0);
        let farthest = mesh.positions.iter().map(|&p| field.value(p).abs()).fold(0.0, f64::max);
        assert!(
            farthest < 2.0 * 1e-6 * 1.5,
            "Newton stops below 1e-6 of an edge, not at {farthest}"
        );
        // The sagitta of an edge is h^2 / 8 R: the volume between chords and sphere is below 3 / R times it.
        let volume = 4000.0 / 3.0 * std::f64::consts::PI;
        assert!((1.0 - mesh.volume() / volume).abs() < 3.0 / 10.0 * 1.5f64.powi(2) / 80.0);
    }

    #[test]
    fn torus_keeps_its_hole_and_coarse_triangles_are_refined() {
        let field = torus(10.0, 4.0);
        for step in [0.8, 4.0] {
            let mesh = remesh(&rough(&field, 15.0, step), Some(&field), &settings(1.5)).unwrap();
            assert_eq!(mesh.check_closed_manifold(), Ok(()));
            let quality = SurfaceQuality::of(&mesh).unwrap();
            assert_even(&quality, 1.5);
            assert_eq!(quality.genus, 1);
            let area = 4.0 * std::f64::consts::PI.powi(2) * 40.0;
            // Chords of 1.5 mm around a tube of radius 4 mm lose 0.6 % of its length.
            assert!((1.0 - quality.area / area).abs() < 0.012, "{}", quality.area);
        }
    }

    /// A winding, capped bellows as a typical candidate.
    fn bellows() -> (impl ScalarField, Vec3, Vec3) {
        let (lower, upper) = (Vec3::new(-20.0, -20.0, 0.0), Vec3::new(20.0, 20.0, 62.8));
        let wall =
            |p: Vec3| (p.x - 3.0 * (0.15 * p.z).sin()).hypot(p.y) - 9.0 - 1.5 * (0.5 * p.z).cos();
        (capped(Analytic(wall), lower, upper), lower, upper)
    }

    #[test]
    fn capped_bellows_with_the_same_bits_on_any_number_of_threads() {
        let (field, lower, upper) = bellows();
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let remeshed =
                || remesh(&isosurface(&field, lower, upper, 2.0), Some(&field), &settings(3.0));
            pool.install(remeshed).unwrap()
        };
        let mesh = on(1);
        assert_eq!(mesh, on(2));
        let quality = SurfaceQuality::of(&mesh).unwrap();
        assert_even(&quality, 3.0);
        assert_eq!(quality.genus, 0);
        let (low, high) = mesh.bounding_box().unwrap();
        assert!(low.z.abs() < 1e-5 && (high.z - 62.8).abs() < 1e-5, "the caps stay: {low} {high}");
        // Closed form of the tube (the waves' cross terms vanish to 0.1 %); chords and rims take 3 %.
        let exact = std::f64::consts::PI * 62.8 * (81.0 + 1.5f64.powi(2) / 2.0);
        assert!((0.96..1.0).contains(&(quality.volume / exact)), "{}", quality.volume / exact);
    }

    #[test]
    fn without_a_field_the_shape_is_kept_nearly() {
        let ball = rough(&sphere(10.0), 12.0, 0.9);
        let mesh = remesh(&ball, None, &settings(1.5)).unwrap();
        assert_even(&SurfaceQuality::of(&mesh).unwrap(), 1.5);
        // Ten relaxations along tangent planes, and chords three times as long as the given ones.
        assert!((0.96..1.0).contains(&(mesh.volume() / ball.volume())), "{}", mesh.volume());
    }

    #[test]
    fn random_fields_are_remeshed_or_refused() {
        let mut accepted = 0;
        for seed in 0..6 {
            let (waves, edge) = [(3.0, 1.6), (6.0, 2.0), (12.0, 2.5)][seed as usize % 3];
            let field = Ripples::new(seed, waves);
            let rough = rough(&field, 20.0, 0.6 * edge);
            match remesh(&rough, Some(&field), &settings(edge)) {
                Ok(mesh) => {
                    accepted += 1;
                    assert_eq!(mesh.check_closed_manifold(), Ok(()));
                    assert_eq!(mesh.genus(), rough.genus());
                    let quality = SurfaceQuality::of(&mesh).unwrap();
                    assert!(quality.radius_ratio_min >= 0.3, "{quality:?}");
                }
                Err(rejection) => {
                    assert_eq!(rejection.reason, Reason::UnresolvedSurface);
                    assert!(rejection.violation > 0.0 && waves > 3.0, "{rejection}");
                }
            }
        }
        assert!((2..6).contains(&accepted), "{accepted} of 6, the two smooth ones at least");
    }

    /// A ring of wire around a ball, and a ball with a hollow ring: triangles of 2 mm would cut the wire of 0.8 mm radius away, or
    /// fill the hollow.
    #[test]
    fn graded_triangles_are_small_where_the_surface_bends() {
        let ring = || torus(8.0, 0.8);
        let wire = Analytic(move |p: Vec3| ring().value(p).min(p.norm() - 5.0));
        let hollow = Analytic(move |p: Vec3| (p.norm() - 11.0).max(-ring().value(p)));
        assert_graded(&wire, 1.0, 1.5..1.9);
        // sqrt(6 e r - 3 e^2) = 2.6 mm on the ball are more than wanted.
        assert_graded(&hollow, -1.0, 1.8..2.2);
    }

    /// Of the ring, and of a ball with edges of these lengths (mm); `side` is 1 where chords of the ring cut off what it encloses.
    fn assert_graded(field: &dyn ScalarField, side: f64, on_ball_wanted: std::ops::Range<f64>) {
        let grading = Grading { shortest: 0.5, chord_error: 0.1 };
        let rough = isosurface(field, Vec3::repeat(-12.0), Vec3::repeat(12.0), 0.7);
        let mesh = remesh_graded(&rough, field, &settings(2.0), &grading).unwrap();
        assert_eq!(mesh.check_closed_manifold(), Ok(()));
        let facets: Vec<[Vec3; 3]> = (0..mesh.triangles.len()).map(|t| mesh.corners(t)).collect();
        let (on_ring, on_ball): (Vec<_>, Vec<_>) =
            facets.into_iter().partition(|f| (6.0..10.0).contains(&f[0].norm()));
        let edge = |facets: &[[Vec3; 3]]| {
            facets.iter().map(|[a, b, _]| (b - a).norm()).sum::<f64>() / facets.len() as f64
        };
        // On the ring sqrt(6 e r - 3 e^2) = 0.67 mm, on the smaller ball 1.72 mm; remeshing makes edges of 0.9 to 1.1 times that.
        assert!((0.6..0.75).contains(&edge(&on_ring)), "{}", edge(&on_ring));
        assert!(on_ball_wanted.contains(&edge(&on_ball)), "{}", edge(&on_ball));
        let sag = |[a, b, c]: &[Vec3; 3]| -side * field.value((a + b + c) / 3.0);
        let deepest = on_ring.iter().map(sag).fold(0.0, f64::max);
        // The error wanted is that of an edge of the length wanted; some are 4/3 as long.
        assert!(deepest < 0.1 * 16.0 / 9.0, "{deepest}");
        assert!(remesh(&rough, Some(field), &settings(2.0)).is_err());
    }

    #[test]
    fn necks_finer_than_the_edge_are_refused() {
        let neck = |radius: f64| {
            let balls = |p: Vec3| {
                let p = Vec3::new(p.x, p.y, p.z.abs());
                (p - Vec3::new(0.0, 0.0, 6.0)).norm() - 4.0
            };
            let field = Analytic(move |p: Vec3| {
                balls(p).min((p.x.hypot(p.y) - radius).max(p.z.abs() - 6.0))
            });
            remesh(&rough(&field, 11.0, 0.5), Some(&field), &settings(1.5))
        };
        assert!(neck(2.0).is_ok());
        let rejection = neck(0.5).unwrap_err();
        assert_eq!(rejection.reason, Reason::UnresolvedSurface, "{rejection}");
    }

    #[test]
    fn what_cannot_be_remeshed_is_refused_at_once() {
        let mut ball = rough(&sphere(10.0), 12.0, 2.0);
        let rejection = remesh(&ball, None, &settings(1e-3)).unwrap_err();
        assert_eq!(rejection.reason, Reason::TooManyTriangles);
        ball.triangles.pop();
        let rejection = remesh(&ball, None, &settings(2.0)).unwrap_err();
        assert_eq!(rejection.reason, Reason::DefectiveSurface);
        assert!(rejection.detail.contains("3 edges have only one triangle"), "{rejection}");
    }

    #[test]
    fn surfaces_that_pass_through_each_other_are_refused() {
        let ball = rough(&sphere(5.0), 6.0, 0.9);
        let count = ball.positions.len() as u32;
        let shifted = ball.positions.iter().map(|p| p + Vec3::new(6.0, 0.0, 0.0));
        let copies = ball.triangles.iter().map(|t| t.map(|v| v + count));
        let pair = TriangleMesh {
            positions: ball.positions.iter().copied().chain(shifted).collect(),
            triangles: ball.triangles.iter().copied().chain(copies).collect(),
        };
        let rejection = remesh(&pair, None, &settings(1.5)).unwrap_err();
        assert_eq!(rejection.reason, Reason::SelfIntersecting);
        assert!(rejection.violation > 0.0);
    }
}
