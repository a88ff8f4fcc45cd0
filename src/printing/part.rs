//! The part as it is printed: the wall and its inlet as closed surfaces.
//!
//! ```text
//! without an inlet: outer face + chamber face turned round, two closed surfaces
//! with one:         outer face - disc + surface of revolution + chamber face turned round - disc, a single one
//! ```
//! It is closed and oriented by construction, and checked nevertheless, with what no construction promises: that it does not pass
//! through itself.
//!
//! # Decisions
//! The inlet is cut into the triangles of the faces rather than into a level set of the wall: ridges and rims stay sharp where a
//! lattice would need steps of 0.1 mm, the bore is as wide as asked for, and every triangle away from it is that of the wall.

use std::ops::Range;

use crate::field::{GridSamples, ScalarField};
use crate::math::{Reason, Rejected, Room, Vec3};
use crate::mesh::WallSurfaces;
use crate::surface::{SignedDistance, TriangleMesh, intersecting_pairs};

use super::base::{Base, BaseDisc};
use super::inlet::Inlet;
use super::opening::{Circle, opened};

/// A closed surface around what is printed.
#[derive(Clone, Debug)]
pub struct PrintedPart {
    /// The surface, its normals leaving the material.
    pub surface: TriangleMesh,
    /// The triangles of it that bound the chamber.
    pub chamber: Range<usize>,
    /// A point of the chamber, as deep in it as a grid tells, mm.
    pub chamber_point: Vec3,
    /// The bore of the inlet.
    pub bore: Option<Bore>,
}

/// A vertical bore.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bore {
    /// x and y of the axis, mm.
    pub centre: [f64; 2],
    /// Its radius, mm.
    pub radius: f64,
    /// z where it begins, at the tip of a barb or the lowest point of the base about it, mm.
    pub bottom: f64,
    /// z where it ends, at the highest point of the chamber's floor about it, mm.
    pub top: f64,
}

impl Bore {
    /// Whether `point` (mm) is in the bore.
    #[must_use]
    pub fn contains(&self, point: Vec3) -> bool {
        let [x, y] = self.centre;
        let is_near = (point.x - x).hypot(point.y - y) <= self.radius;
        is_near && (self.bottom..=self.top).contains(&point.z)
    }
}

impl PrintedPart {
    /// The part of a `wall` of `thickness` (mm) with an `inlet` in the middle of its base, which is `base_height` (mm) high: what is clamped.
    ///
    /// # Errors
    /// [`Rejected`] with the reason `no_base` or `base_too_small` when the inlet has no place on the base with the chamber above it
    /// (the violation is the share of its radius that lacks), `base_uneven` when the base cannot be cut there, `defective_surface` or
    /// `self_intersecting` when the result is no closed surface apart from itself.
    pub fn new(
        wall: &WallSurfaces,
        thickness: f64,
        base_height: f64,
        inlet: &Inlet,
    ) -> Result<Self, Rejected> {
        let WallSurfaces { outer, chamber } = wall;
        let (surface, first, bore) = match inlet.bore() {
            None => (outer.joined(&turned(chamber)), outer.triangles.len(), None),
            Some(diameter) => {
                let base = Base { thickness, height: base_height };
                let disc = roomy_base(wall, &base, inlet)?;
                with_inlet(wall, &disc, inlet, 0.5 * diameter)?
            }
        };
        surface.check_closed_manifold()?;
        let crossings = intersecting_pairs(&surface).len();
        if crossings > 0 {
            let detail = format!("{crossings} pairs of triangles of the printed surface cross");
            let share = crossings as f64 / surface.triangles.len() as f64;
            return Err(Rejected::new(Room::Printing, Reason::SelfIntersecting, detail, share));
        }
        let last = surface.triangles.len();
        Ok(Self { surface, chamber: first..last, chamber_point: deepest(chamber)?, bore })
    }
}

/// The mesh with every triangle turned round.
pub(super) fn turned(mesh: &TriangleMesh) -> TriangleMesh {
    let triangles = mesh.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
    TriangleMesh { positions: mesh.positions.clone(), triangles }
}

/// The disc of the base, wide enough for the `inlet`.
fn roomy_base(wall: &WallSurfaces, base: &Base, inlet: &Inlet) -> Result<BaseDisc, Rejected> {
    let disc = base.disc(wall)?;
    let needed = inlet.foot() + MARGIN;
    if disc.radius < needed {
        let detail = format!(
            "the base has room for a disc of radius {:.1} mm, with the chamber above; the inlet wants {needed:.1} mm",
            disc.radius.max(0.0)
        );
        let lack = 1.0 - disc.radius.max(0.0) / needed;
        return Err(Rejected::new(Room::Printing, Reason::BaseTooSmall, detail, lack));
    }
    Ok(disc)
}

/// The single surface of a `wall` with an `inlet` on the disc of its base, the place of the chamber's first triangle, and the bore.
fn with_inlet(
    wall: &WallSurfaces,
    disc: &BaseDisc,
    inlet: &Inlet,
    radius: f64,
) -> Result<(TriangleMesh, usize, Option<Bore>), Rejected> {
    let centre = disc.centre;
    let outer = opened(&wall.outer, &Circle { centre, radius: inlet.foot() })?;
    let chamber = opened(&wall.chamber, &Circle { centre, radius })?;
    let places = |mesh: &TriangleMesh, rim: &[u32]| -> Vec<Vec3> {
        rim.iter().map(|&v| mesh.positions[v as usize]).collect()
    };
    let mut rings = vec![places(&outer.mesh, &outer.rim)];
    rings.extend(inlet.corners().iter().map(|&[radius, depth]| {
        let corners = Circle { centre, radius }.corners();
        corners.map(|[x, y]| Vec3::new(x, y, disc.bottom - depth)).collect()
    }));
    rings.push(places(&chamber.mesh, &chamber.rim));
    let heights = || rings.iter().flatten().map(|p| p.z);
    let bottom = heights().fold(f64::INFINITY, f64::min);
    let top = heights().fold(f64::NEG_INFINITY, f64::max);

    let TriangleMesh { mut positions, mut triangles } = outer.mesh;
    let mut rim = outer.rim;
    for ring in between(&rings) {
        let first = positions.len() as u32;
        let next: Vec<u32> = (first..first + ring.len() as u32).collect();
        positions.extend(ring);
        push_strip(&rim, &next, &mut triangles);
        rim = next;
    }
    let shift = positions.len() as u32;
    let last: Vec<u32> = chamber.rim.iter().map(|v| v + shift).collect();
    push_strip(&rim, &last, &mut triangles);
    let first = triangles.len();
    let surface = TriangleMesh { positions, triangles }.joined(&turned(&chamber.mesh));
    Ok((surface, first, Some(Bore { centre, radius, bottom, top })))
}

/// The `rings` but for the first and the last, and others between them where they are farther than [`LONGEST`] apart.
fn between(rings: &[Vec<Vec3>]) -> Vec<Vec<Vec3>> {
    let mut all = Vec::new();
    for pair in rings.windows(2) {
        let ways = || pair[0].iter().zip(&pair[1]);
        let longest = ways().map(|(from, to)| (to - from).norm()).fold(0.0, f64::max);
        let steps = (longest / LONGEST).ceil().max(1.0) as usize;
        all.extend((1..=steps).map(|step| {
            let share = step as f64 / steps as f64;
            ways().map(|(from, to)| from + share * (to - from)).collect::<Vec<Vec3>>()
        }));
    }
    all.pop();
    all
}

/// Appends the triangles between a rim and the next, both counter-clockwise seen from above; the first has the material outside and
/// below it, as the rim of an opening in a face that looks down.
fn push_strip(rim: &[u32], next: &[u32], triangles: &mut Vec<[u32; 3]>) {
    for k in 0..rim.len() {
        let l = (k + 1) % rim.len();
        triangles.extend([[rim[l], rim[k], next[k]], [rim[l], next[k], next[l]]]);
    }
}

/// The point farthest from the wall of the `chamber`, of those of a grid, mm.
fn deepest(chamber: &TriangleMesh) -> Result<Vec3, Rejected> {
    let distance = SignedDistance::new(chamber)?;
    let (lower, upper) = distance.bounds();
    let step = (upper - lower).max() / GRID;
    let counts = std::array::from_fn(|axis| ((upper - lower)[axis] / step) as usize + 1);
    let start = lower.add_scalar(0.5 * step);
    let samples = GridSamples::of(&distance, start, step, counts);
    let [_, ny, nz] = counts;
    let points = (0..samples.values.len()).map(|k| [k / (ny * nz), k / nz % ny, k % nz]);
    let deepest = points
        .min_by(|&a, &b| {
            samples.values[samples.index(a)].total_cmp(&samples.values[samples.index(b)])
        })
        .map(|index| samples.point(index));
    match deepest.filter(|&point| distance.value(point) < 0.0) {
        Some(point) => Ok(point),
        None => {
            let detail = "the chamber is nowhere deeper than a grid tells".to_owned();
            Err(Rejected::new(Room::Printing, Reason::ChamberClosed, detail, 1.0))
        }
    }
}

/// Base that must be left about an inlet, mm: a bead of a nozzle of 0.4 mm, and what a grid step hides.
const MARGIN: f64 = 0.5;
/// Between rings of an inlet, mm: triangles of it are at most some three times as long as wide.
const LONGEST: f64 = 0.6;
/// Of the search for the deepest point, along the longest side of the chamber.
const GRID: f64 = 48.0;

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::mesh::{WallSettings, wall_surfaces};
    use crate::printing::test_shapes::{ball, cylinder, polygon_area};
    use crate::surface::MidSurface;

    const THICKNESS: f64 = 1.6;

    fn wall(mid: &TriangleMesh) -> WallSurfaces {
        let settings = WallSettings { edge: 1.5, ..WallSettings::default() };
        wall_surfaces(&MidSurface::uniform(mid.clone(), THICKNESS).unwrap(), &settings).unwrap()
    }

    fn volume(wall: &WallSurfaces) -> f64 {
        wall.outer.volume() - wall.chamber.volume()
    }

    #[test]
    fn without_an_inlet_there_are_two_closed_surfaces() {
        let wall = wall(&ball([0.0; 3], 8.0));
        let part = PrintedPart::new(&wall, THICKNESS, 2.4, &Inlet::None).unwrap();
        let volumes = part.surface.component_volumes();
        // Sums of the same terms in another order.
        assert_relative_eq!(volumes[0], wall.outer.volume(), max_relative = 1e-12);
        assert_relative_eq!(volumes[1], -wall.chamber.volume(), max_relative = 1e-12);
        assert_eq!(part.bore, None);
        // Steps of 14.4 mm / 48.
        assert!(part.chamber_point.norm() < 0.3, "{}", part.chamber_point);
        let inner = part.chamber.clone().map(|t| part.surface.corners(t)[0].norm());
        assert!(inner.fold(0.0, f64::max) < 8.0, "the chamber is within the middle");
    }

    /// A bore takes its polygon times the thickness of the base, and joins both faces to one sphere.
    #[test]
    fn a_hole_takes_its_own_volume() {
        let wall = wall(&cylinder(10.0, 20.0, 1.5));
        let part = PrintedPart::new(&wall, THICKNESS, 2.4, &Inlet::Hole { bore: 3.0 }).unwrap();
        let surface = &part.surface;
        assert_eq!((surface.component_volumes().len(), surface.genus()), (1, 0));
        // Base and floor are flat to 1e-6 of an edge, in a volume 100 times the bore's.
        let taken = volume(&wall) - surface.volume();
        assert_relative_eq!(taken, polygon_area(1.5) * THICKNESS, max_relative = 1e-3);
        let bore = part.bore.unwrap();
        assert!((bore.bottom + 0.8).abs() < 1e-4 && (bore.top - 0.8).abs() < 1e-4, "{bore:?}");
    }

    /// A barb adds frustums of polygons, `h (A + sqrt(A B) + B) / 3`, and its bore takes a prism.
    #[test]
    fn a_barb_adds_its_own_volume() {
        let wall = wall(&cylinder(10.0, 20.0, 1.5));
        let barb = Inlet::Barb { bore: 3.0, tube: 5.0 };
        let part = PrintedPart::new(&wall, THICKNESS, 2.4, &barb).unwrap();
        assert_eq!((part.surface.component_volumes().len(), part.surface.genus()), (1, 0));
        let outline = [[2.5, 0.0], [2.5, 2.0], [3.0, 2.5], [2.5, 5.0], [3.0, 5.5], [2.5, 8.0_f64]];
        let frustum = |pair: &[[f64; 2]]| {
            let [[a, z], [b, next]] = [pair[0], pair[1]];
            (next - z) * (a * a + a * b + b * b) / 3.0
        };
        let whole: f64 = outline.windows(2).map(frustum).sum();
        let added = polygon_area(1.0) * (whole - 1.5 * 1.5 * (8.0 + THICKNESS));
        // As flat as the base, see above.
        assert_relative_eq!(part.surface.volume() - volume(&wall), added, max_relative = 1e-3);
        let (lower, _) = part.surface.bounding_box().unwrap();
        // As flat as the base.
        assert!((lower.z + 8.8).abs() < 1e-4, "{lower}");
    }

    /// Through the round base of a ball a bore of radius a takes `2 pi / 3 (R^3 - (R^2 - a^2)^(3/2))` of the outer ball, less the same
    /// of the chamber.
    #[test]
    fn a_hole_passes_a_round_base() {
        let mid = ball([0.0; 3], 8.0);
        let wall = wall(&mid);
        let part = PrintedPart::new(&wall, THICKNESS, 2.4, &Inlet::Hole { bore: 6.0 }).unwrap();
        assert_eq!((part.surface.component_volumes().len(), part.surface.genus()), (1, 0));
        let below = |radius: f64| radius.powi(3) - (radius * radius - 9.0).powf(1.5);
        let exact = polygon_area(1.0) * 2.0 / 3.0 * (below(8.8) - below(7.2));
        // Facets of 1.5 mm sag by h^2 / 8 R: 0.03 mm outside and 0.04 mm inside, of 1.7 mm.
        assert_relative_eq!(volume(&wall) - part.surface.volume(), exact, max_relative = 0.03);
        let barb = Inlet::Barb { bore: 3.0, tube: 5.0 };
        let part = PrintedPart::new(&wall, THICKNESS, 2.4, &barb).unwrap();
        let (lower, _) = part.surface.bounding_box().unwrap();
        let (bottom, _) = wall.outer.bounding_box().unwrap();
        // Sums of tenths.
        assert_relative_eq!(bottom.z - lower.z, 8.0, max_relative = 1e-12);
    }

    #[test]
    fn an_inlet_without_a_place_is_refused() {
        let wall = wall(&ball([0.0; 3], 8.0));
        let rejection =
            PrintedPart::new(&wall, THICKNESS, 2.4, &Inlet::Hole { bore: 12.0 }).unwrap_err();
        assert_eq!((rejection.room, &rejection.reason), (Room::Printing, &Reason::BaseTooSmall));
        assert!((0.0..1.0).contains(&rejection.violation), "{rejection:?}");
    }
}
