//! The two faces of a wall around its middle.
//!
//! ```text
//! outer: d = t / 2      chamber: d = -t / 2      d: signed distance to the mid-surface, t: thickness, where it varies see MidSurface
//! V = A t + t^3 / 12 int K dA                    of one thickness, where no folds meet; int K dA = 4 pi without handles
//! ```
//! Folds that overlap merge, as a printer would merge them: faces of levels never pass through themselves. Where the triangles
//! cannot follow a face, between folds that nearly touch and in the wedge where they begin to merge, the gaps that a small ball
//! cannot enter are filled (a morphological closing), and all else stays at its distance.
//!
//! Source: Steiner (1840) for the volume; Serra (1982), Image analysis and mathematical morphology, for the closing.

use serde::{Deserialize, Serialize};

use super::WallSurfaces;
use super::from_field::{GRID_SHARE, REMESH_ITERATIONS};
use crate::field::{GridSamples, ScalarField};
use crate::math::{Reason, Rejected, Room};
use crate::surface::{
    Filleted, Grading, MidSurface, Offset, RemeshSettings, SignedDistance, TriangleMesh, WallFace,
    interpolated_isosurface, intersecting_pairs, remesh_graded,
};

/// How finely the faces of a wall are meshed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct WallSettings {
    /// Edge length of the triangles, mm.
    pub edge: f64,
    /// Radius of the ball that must enter a gap, mm; half the width of the bead of a fine nozzle. A face that can be meshed
    /// as it is keeps narrower gaps.
    pub fillet: f64,
}

impl Default for WallSettings {
    fn default() -> Self {
        Self { edge: 2.0, fillet: 0.4 }
    }
}

/// The faces of the wall around its `middle`: closed, without self-intersections, apart.
///
/// Pieces of the chamber, and pockets outside that the wall encloses, become solid when they are smaller than 1 % of the
/// volume: air does not reach them, and no printer could clear them. Neither do passages connect that a fillet fills.
///
/// # Decisions
/// Of 300 random valid designs (`examples/walls.rs`, 150 of seed 1 and 150 of seed 2), 296 succeed, 31 of them with
/// fillets; the median takes 0.9 s, the slowest 13 s. One triangle in 2800 has an angle below 30 degrees. A lattice of two thirds
/// of an edge takes half the time, but closes gaps: 46 fillets, and at edges of 4 mm the chambers of `pneunet`. Edges of one length
/// cut off the ridges of sharp folds, whose radius is half the wall, and broke 6 walls of 31. They also fill the notches behind
/// them, and a fold half as thick again hardly bends: the tip of a bellows moved by 74 % of what it should at edges of 2 mm and by
/// 53 % at 3 mm. With edges as short in notches as on ridges it moves by 97 and 92 %, and the tip of `basic_bend` by the same to
/// 0.1 % at edges of 2, 3 and 4 mm. That costs a quarter more triangles. The volume is 0.5 % below Steiner's, by merging.
///
/// # Errors
/// [`Rejected`] with the reason `self_intersecting` when the middle has no inside; `chamber_closed` when it is nowhere
/// as far from its middle as the wall is thick (the violation is the share of that depth that lacks), `chamber_divided` or
/// `enclosed_pocket` when larger pieces are cut off (their share of the volume), `wall_broken` when the triangles' chords leave
/// less than a quarter of the wall on either side of its middle, or the faces pass through each other (the share that lacks);
/// and as `remesh` does when triangles of this edge cannot follow a face.
///
/// # Panics
/// When the edge or the fillet is not a positive number.
pub fn wall_surfaces(
    middle: &MidSurface,
    settings: &WallSettings,
) -> Result<WallSurfaces, Rejected> {
    let WallSettings { edge, fillet } = *settings;
    let is_length = |x: f64| x > 0.0 && x.is_finite();
    assert!(is_length(edge) && is_length(fillet), "{settings:?} must be positive numbers");
    let crossings = intersecting_pairs(middle.mesh()).len();
    if crossings > 0 {
        let detail = format!("{crossings} pairs of triangles of the mid-surface cross");
        let share = crossings as f64 / middle.mesh().triangles.len() as f64;
        return Err(rejected(Reason::SelfIntersecting, detail, share));
    }
    let face = |face| Face { middle, face, edge, fillet };
    let chamber = face(WallFace::Chamber).surface()?;
    let outer = face(WallFace::Outer).surface()?;
    let surfaces = WallSurfaces { outer, chamber };
    check_whole(&surfaces, middle)?;
    Ok(surfaces)
}

/// One face of a wall.
struct Face<'a> {
    middle: &'a MidSurface,
    face: WallFace,
    edge: f64,
    fillet: f64,
}

impl Face<'_> {
    /// The level itself; where triangles cannot follow it, with fillets, then with shorter edges too, then with larger fillets.
    fn surface(&self) -> Result<TriangleMesh, Rejected> {
        let plain = self.meshed(&self.level(0.0), self.edge);
        match plain {
            Err(rejection) if rejection.reason != Reason::ChamberClosed => {}
            plain => return plain,
        }
        let core = self.core(self.fillet)?;
        let filleted = self.filleted(&core, self.fillet);
        self.meshed(&filleted, self.edge)
            .or_else(|_| self.meshed(&filleted, FINER * self.edge))
            .or_else(|rejection| {
                let radius = LARGER * self.fillet;
                let core = self.core(radius).map_err(|_| rejection.clone())?;
                self.meshed(&self.filleted(&core, radius), self.edge).map_err(|_| rejection)
            })
    }

    /// The distance to the level farther from the middle by `radius`.
    fn core(&self, radius: f64) -> Result<SignedDistance, Rejected> {
        let core = self.main_piece(&self.level(radius), radius, CORE_STEP * radius)?;
        Ok(SignedDistance::new(&core)?)
    }

    fn filleted<'b>(&'b self, core: &'b SignedDistance, radius: f64) -> Filleted<'b> {
        let chord_error = CHORD_ERROR * CORE_STEP * radius;
        Filleted { offset: self.level(0.0), core, radius, chord_error }
    }

    /// The level that is `beyond` (mm) farther from the middle than the face.
    fn level(&self, beyond: f64) -> Offset<'_> {
        let Self { middle, face, edge, .. } = *self;
        Offset { middle, face, beyond, band: 2.0 * edge }
    }

    fn meshed(&self, field: &dyn ScalarField, edge: f64) -> Result<TriangleMesh, Rejected> {
        let step = (GRID_SHARE * edge).min(CORE_STEP * self.fillet);
        let coarse = self.main_piece(field, 0.0, step)?;
        let settings = RemeshSettings { edge, iterations: REMESH_ITERATIONS };
        let [thinnest, _] = self.middle.thickness_range();
        let chord_error = CHORD_SHARE * 0.5 * thinnest;
        let grading = Grading { shortest: SHORTEST * edge, chord_error };
        let named =
            |r: Rejected| Rejected { detail: format!("{}: {}", self.name(), r.detail), ..r };
        remesh_graded(&coarse, field, &settings, &grading).map_err(named)
    }

    /// The largest piece of the zero level of `field`, at most `beyond` (mm) farther from the middle than the face, from a lattice of
    /// `step` mm.
    fn main_piece(
        &self,
        field: &dyn ScalarField,
        beyond: f64,
        step: f64,
    ) -> Result<TriangleMesh, Rejected> {
        let (lower, upper) = self.middle.distance().bounds();
        let [thinnest, thickest] = self.middle.thickness_range();
        let grown = match self.face {
            WallFace::Outer => 0.5 * thickest + beyond,
            WallFace::Chamber => -0.5 * thinnest - beyond,
        };
        let (lower, upper) = (lower.add_scalar(-grown), upper.add_scalar(grown));
        if (0..3).any(|axis| lower[axis] >= upper[axis]) {
            return Err(self.closed(beyond));
        }
        let (lower, upper) = (lower.add_scalar(-step), upper.add_scalar(step));
        let pieces = interpolated_isosurface(field, lower, upper, step);
        let volumes = pieces.component_volumes();
        let by_volume = |&a: &usize, &b: &usize| volumes[a].total_cmp(&volumes[b]);
        let Some(main) = (0..volumes.len()).max_by(by_volume) else {
            return Err(self.closed(beyond));
        };
        let lesser = volumes.iter().map(|v| v.abs()).sum::<f64>() - volumes[main];
        let share = lesser / (lesser + volumes[main]);
        if share > MOST_CUT_OFF {
            let reason = match self.face {
                WallFace::Outer => Reason::EnclosedPocket,
                WallFace::Chamber => Reason::ChamberDivided,
            };
            let detail = format!(
                "passages narrower than {:.1} mm cut off {} pieces of the {}, {:.1} % of the volume",
                2.0 * beyond,
                volumes.len() - 1,
                self.name(),
                100.0 * share
            );
            return Err(rejected(reason, detail, share));
        }
        Ok(pieces.component(main as u32))
    }

    fn closed(&self, beyond: f64) -> Rejected {
        let distance = self.middle.distance();
        let (lower, upper) = distance.bounds();
        let step = (upper - lower).max() / DEPTH_SAMPLES;
        let counts = std::array::from_fn(|axis| ((upper - lower)[axis] / step) as usize + 1);
        let samples = GridSamples::of(distance, lower, step, counts);
        let depth = -samples.values.iter().copied().fold(0.0, f64::min);
        let [_, thickest] = self.middle.thickness_range();
        let wanted = 0.5 * thickest + beyond;
        let detail = format!("the middle of the wall is {depth:.2} mm deep, not {wanted:.2} mm");
        rejected(Reason::ChamberClosed, detail, (1.0 - depth / wanted).max(0.0))
    }

    fn name(&self) -> &str {
        match self.face {
            WallFace::Outer => "outside",
            WallFace::Chamber => "chamber",
        }
    }
}

/// # Errors
/// [`Rejected`] when the faces touch, or a facet of either is too near the middle of the wall.
fn check_whole(surfaces: &WallSurfaces, middle: &MidSurface) -> Result<(), Rejected> {
    let WallSurfaces { outer, chamber } = surfaces;
    let least = |mesh: &TriangleMesh, face: WallFace| {
        let of_facet = |t| {
            let [a, b, c] = mesh.corners(t);
            let points = [(a + b + c) / 3.0, (a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0];
            points
                .map(|point| face.sign() * middle.relative_height(point))
                .into_iter()
                .fold(f64::INFINITY, f64::min)
        };
        (0..mesh.triangles.len()).map(of_facet).fold(f64::INFINITY, f64::min)
    };
    let share = least(outer, WallFace::Outer).min(least(chamber, WallFace::Chamber));
    if share < LEAST_SHARE {
        let detail = format!(
            "the faces come within {share:.2} half thicknesses of the middle of the wall, {LEAST_SHARE} allowed"
        );
        return Err(rejected(Reason::WallBroken, detail, LEAST_SHARE - share));
    }
    let crossings = intersecting_pairs(&outer.joined(chamber)).len();
    if crossings > 0 {
        let detail = format!("{crossings} pairs of triangles of the two faces cross");
        let share = crossings as f64 / (outer.triangles.len() + chamber.triangles.len()) as f64;
        return Err(rejected(Reason::WallBroken, detail, share));
    }
    Ok(())
}

fn rejected(reason: Reason, detail: String, violation: f64) -> Rejected {
    Rejected::new(Room::Mesh, reason, detail, violation)
}

/// The second trials' edge and fillet, over those wanted.
const FINER: f64 = 0.7;
const LARGER: f64 = 2.0;
/// Lattice step, at most, in radii of a fillet: what the lattice misses of a gap, the ball closes.
const CORE_STEP: f64 = 2.0;
/// Of a core, in lattice steps: the sagitta of a step on a radius of 2.5 steps.
const CHORD_ERROR: f64 = 0.05;
/// Shortest edge wanted where a face bends, over the longest.
const SHORTEST: f64 = 0.35;
/// Chord error wanted, over half the thickness.
const CHORD_SHARE: f64 = 0.2;
/// Along the longest side of the part, where it has no chamber.
const DEPTH_SAMPLES: f64 = 64.0;
/// Share of the volume that may be cut off and becomes solid.
const MOST_CUT_OFF: f64 = 0.01;
/// What must be left of the wall on either side of its middle; a chord of 90 degrees around a rim leaves 0.7.
const LEAST_SHARE: f64 = 0.25;

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use approx::assert_relative_eq;

    use super::*;
    use crate::math::Vec3;
    use crate::surface::isosurface;
    use crate::surface::test_fields::Analytic;

    fn faces(mid: &TriangleMesh, thickness: f64, edge: f64) -> Result<WallSurfaces, Rejected> {
        wall_surfaces(&MidSurface::uniform(mid.clone(), thickness).unwrap(), &settings(edge))
    }

    fn settings(edge: f64) -> WallSettings {
        WallSettings { edge, ..WallSettings::default() }
    }

    fn volume(surfaces: &WallSurfaces) -> f64 {
        surfaces.outer.volume() - surfaces.chamber.volume()
    }

    /// The zero level of a formula in a box of half sides 12 mm.
    fn level(value: impl Fn(Vec3) -> f64 + Sync, step: f64) -> TriangleMesh {
        isosurface(&Analytic(value), Vec3::repeat(-12.0), Vec3::repeat(12.0), step)
    }

    #[test]
    fn faces_of_a_sphere_have_their_radii() {
        let mid = TriangleMesh::sphere(8.0, 4);
        let height = |t| {
            let [a, b, c] = mid.corners(t);
            a.dot(&(b - a).cross(&(c - a)).normalize())
        };
        let sag = 8.0 - (0..mid.triangles.len()).map(height).fold(8.0, f64::min);
        let surfaces = faces(&mid, 1.6, 1.5).unwrap();
        for (mesh, radius) in [(&surfaces.outer, 8.8), (&surfaces.chamber, 7.2)] {
            assert_eq!(mesh.check_closed_manifold(), Ok(()));
            for p in &mesh.positions {
                // The facets of the middle are as far inside the sphere as they sag; faces are projected to 1e-3 of that.
                assert!((p.norm() - radius).abs() < 1.001 * sag, "{} is not {radius}", p.norm());
            }
        }
        // Chords of 1.5 mm take h^2 / 8 R times a half from both faces, which cancels but for a tenth.
        let exact = 4.0 / 3.0 * PI * (8.8_f64.powi(3) - 7.2_f64.powi(3));
        assert_relative_eq!(volume(&surfaces), exact, max_relative = 0.01);
    }

    /// `V = A t + pi t^3 / 3`: of a thick wall the second term is 6 %.
    #[test]
    fn wall_of_an_ellipsoid_has_steiner_s_volume() {
        let mut mid = TriangleMesh::sphere(1.0, 4);
        mid.positions.iter_mut().for_each(|p| p.component_mul_assign(&Vec3::new(9.0, 7.0, 8.0)));
        let thickness: f64 = 6.0;
        let surfaces = faces(&mid, thickness, 1.2).unwrap();
        let second = PI * thickness.powi(3) / 3.0;
        let steiner = mid.area() * thickness + second;
        // A tenth of the second term; chords of 1.2 mm are worth 0.2 % of the volume.
        assert_relative_eq!(volume(&surfaces), steiner, epsilon = 0.1 * second);
    }

    /// The faces of a wall whose thickness varies enclose what the envelopes of its balls do: profiles `(rho, z)` turned about the axis.
    #[test]
    fn a_wall_of_varying_thickness_has_its_volume() {
        let radius = 8.0;
        let mid = TriangleMesh::sphere(radius, 4);
        let half = |z: f64| 0.9 + 0.04 * z;
        let thickness: Vec<f64> = mid.positions.iter().map(|p| 2.0 * half(p.z)).collect();
        let middle = MidSurface::new(mid, &thickness).unwrap();
        let surfaces = wall_surfaces(&middle, &settings(1.2)).unwrap();
        let exact = |sign: f64| {
            let profile = |k: usize| {
                let (sin, cos) = (PI * k as f64 / 4000.0).sin_cos();
                let (h, slope) = (half(radius * cos), -0.04 * sin);
                let out = radius + sign * h * (1.0 - slope * slope).sqrt();
                [out * sin - h * slope * cos, out * cos + h * slope * sin]
            };
            let slice = |k: usize| {
                let ([a, high], [b, low]) = (profile(k), profile(k + 1));
                PI / 3.0 * (a * a + a * b + b * b) * (high - low)
            };
            (0..4000).map(slice).sum::<f64>()
        };
        // Chords of h = 1.2 mm take 3 h^2 / 8 R^2 of a ball: 0.7 % outside and 1.1 % within; those of the middle, of 0.6 mm, 0.2 %.
        assert_relative_eq!(surfaces.outer.volume(), exact(1.0), max_relative = 0.01);
        assert_relative_eq!(surfaces.chamber.volume(), exact(-1.0), max_relative = 0.014);
        // At its ends the wall is as thick as is asked for there.
        for (mesh, sign) in [(&surfaces.outer, 1.0), (&surfaces.chamber, -1.0)] {
            let (lower, upper) = mesh.bounding_box().unwrap();
            for (end, z) in [(upper.z, radius), (-lower.z, -radius)] {
                // A vertex is at most half an edge from the axis, and the sphere is 0.02 mm lower there.
                assert!((end - radius - sign * half(z)).abs() < 0.03, "{end}");
            }
        }
    }

    /// A bellows with folds of 1.8 mm: walls of 1.6 mm fill its grooves. The volume is counted on a grid as well.
    #[test]
    fn folds_that_overlap_merge() {
        let bellows = |p: Vec3| {
            let rho = p.x.hypot(p.y) - 7.0 - 1.5 * (2.0 * PI * p.z / 1.8).cos().clamp(-0.7, 0.7);
            rho.max(p.z.abs() - 4.8)
        };
        let (mid, thickness) = (level(bellows, 0.4), 1.6);
        let distance = SignedDistance::new(&mid).unwrap();
        let surfaces = faces(&mid, thickness, 1.5).unwrap();
        assert!(intersecting_pairs(&surfaces.outer.joined(&surfaces.chamber)).is_empty());
        for p in &surfaces.outer.positions {
            // A vertex may be left where it was when it is within 5 % of an edge.
            assert!(distance.value(*p) > 0.8 - 0.05 * 1.5, "{p} is inside the wall");
        }
        let step = 0.4;
        let samples = GridSamples::of(&distance, Vec3::new(-10.0, -10.0, -6.0), step, [51, 51, 31]);
        let inside = samples.values.iter().filter(|d| d.abs() < 0.5 * thickness).count();
        let counted = inside as f64 * step.powi(3);
        // Fillets of 0.4 mm in the notches, and chords, are worth some percent; two walls for each fold, a tenth and more.
        assert_relative_eq!(volume(&surfaces), counted, max_relative = 0.04);
        assert!(volume(&surfaces) < 0.9 * mid.area() * thickness);
    }

    #[test]
    fn each_failure_has_its_reason_and_size() {
        let ball = |p: Vec3, x: f64, radius: f64| (p - Vec3::new(x, 0.0, 0.0)).norm() - radius;
        let tube = |p: Vec3, radius: f64| p.y.hypot(p.z) - radius;
        let rejected = |mid: &TriangleMesh, thickness, reason: Reason, violation: f64| {
            let rejection = faces(mid, thickness, 1.5).unwrap_err();
            assert_eq!(rejection.reason, reason, "{rejection}");
            // Gaps are judged where the middle of a ball of 0.4 mm can be: 1.2 mm from the mid-surface. The lattice of 0.6 mm loses
            // up to 4 % of a small ball's radius.
            assert_relative_eq!(rejection.violation, violation, max_relative = 0.15);
        };
        rejected(&TriangleMesh::sphere(2.0, 3), 5.0, Reason::ChamberClosed, 1.0 - 2.0 / 2.5);
        let dumbbell = |p| {
            let channel = tube(p, 0.6).max(p.x.abs() - 6.0);
            ball(p, -6.0, 4.0).min(ball(p, 6.0, 3.0)).min(channel)
        };
        let ratio = (1.8_f64 / 2.8).powi(3);
        rejected(&level(dumbbell, 0.6), 1.6, Reason::ChamberDivided, ratio / (1.0 + ratio));
        let bottle = |p| {
            let channel = tube(p, 0.6).max(-p.x);
            ball(p, 0.0, 10.0).max(-ball(p, 0.0, 5.0).min(channel))
        };
        let ratio = (3.8_f64 / 11.2).powi(3);
        rejected(&level(bottle, 0.6), 1.6, Reason::EnclosedPocket, ratio / (1.0 + ratio));
        let balls = TriangleMesh::sphere(5.0, 3);
        let mut moved = balls.clone();
        moved.positions.iter_mut().for_each(|p| p.x += 7.0);
        let rejection = faces(&balls.joined(&moved), 1.6, 1.5).unwrap_err();
        assert_eq!(rejection.reason, Reason::SelfIntersecting);
    }
}
