//! The passes of remeshing: where to edit the triangulation, and where its vertices move.

use std::collections::BTreeSet;

use crate::field::ScalarField;
use crate::math::{Vec3, area_vector};
use crate::surface::TriangleMesh;
use crate::surface::half_edges::{HalfEdges, NONE, next};
use crate::surface::quality::radius_ratio;

use super::sharp::{Freedom, Original, SharpEdges};
use super::{Grading, LEAST_RADIUS_RATIO, VALENCES};

/// Where the vertices belong.
#[derive(Clone, Copy)]
pub(super) enum Target<'a> {
    /// Near the planes of their neighbours.
    Nearby,
    /// On the zero level of a field.
    Level(&'a dyn ScalarField),
    /// On given triangles.
    Triangles(&'a Original),
}

/// A surface under remeshing; what edits have removed stays in the arrays, marked, until the end.
pub(super) struct Workpiece<'a> {
    surface: HalfEdges,
    positions: Vec<Vec3>,
    /// The edge length wanted at each vertex, mm.
    sizes: Vec<f64>,
    target: Target<'a>,
    sharp: SharpEdges,
    edge: f64,
}

impl<'a> Workpiece<'a> {
    pub(super) fn new(
        surface: HalfEdges,
        positions: &[Vec3],
        target: Target<'a>,
        sharp: SharpEdges,
        edge: f64,
    ) -> Self {
        let sizes = vec![edge; positions.len()];
        Self { surface, positions: positions.to_vec(), sizes, target, sharp, edge }
    }

    /// Sets the edge length wanted at each vertex from the bends of its edges, changing by no more than half the way.
    pub(super) fn grade(&mut self, grading: &Grading) {
        let Grading { shortest, chord_error } = *grading;
        let Target::Level(field) = self.target else { return };
        let vertices: Vec<u32> =
            (0..self.positions.len() as u32).filter(|&v| self.is_used(v)).collect();
        let mut normals = vec![Vec3::zeros(); self.positions.len()];
        for &v in &vertices {
            let gradient = field.value_and_gradient(self.positions[v as usize]).1;
            normals[v as usize] = gradient.try_normalize(0.0).unwrap_or_default();
        }
        for &v in &vertices {
            let bend = |w: u32| {
                let [way, turn] =
                    [&self.positions, &normals].map(|all| all[w as usize] - all[v as usize]);
                turn.dot(&way).abs() / way.norm_squared()
            };
            let curvature = self.surface.ring(v).map(bend).fold(1.0 / self.edge / 1e3, f64::max);
            let chord = (6.0 * chord_error / curvature - 3.0 * chord_error.powi(2)).max(0.0).sqrt();
            self.sizes[v as usize] = chord.clamp(shortest, self.edge);
        }
        for _ in 0..GRADING_PASSES {
            for &v in &vertices {
                let allowed = |w: u32| {
                    let way = (self.positions[w as usize] - self.positions[v as usize]).norm();
                    self.sizes[w as usize] + STEEPEST_GRADING * way
                };
                let least = self.surface.ring(v).map(allowed).fold(f64::INFINITY, f64::min);
                self.sizes[v as usize] = self.sizes[v as usize].min(least);
            }
        }
    }

    /// Halves edges that are too long, until none is left or they have been halved eight times.
    pub(super) fn split_long(&mut self) {
        for _ in 0..8 {
            let before = self.positions.len();
            for h in 0..self.surface.origins.len() as u32 {
                if self.is_edge(h) && self.length(h) > TOO_LONG * self.size(h) {
                    self.split(h);
                }
            }
            if self.positions.len() == before {
                break;
            }
        }
    }

    /// Cuts long edges at planes about an edge apart, so that needles, fans and facets leave pieces of about that size.
    ///
    /// Halving a needle's sides keeps its shape, and makes four of it each time.
    pub(super) fn cut_up(&mut self) {
        let all = |extreme: fn(&Vec3, &Vec3) -> Vec3| {
            self.positions.iter().copied().reduce(|a, b| extreme(&a, &b)).unwrap_or_default()
        };
        let (lower, upper) = (all(Vec3::inf), all(Vec3::sup));
        for axis in 0..3 {
            let planes = ((upper[axis] - lower[axis]) / self.edge).ceil() as usize;
            for k in 0..planes {
                self.cut_at(axis, lower[axis] + (k as f64 + 0.5) * self.edge);
            }
        }
    }

    /// Splits the long edges that cross the plane where the coordinate `axis` is `height`, there.
    fn cut_at(&mut self, axis: usize, height: f64) {
        for h in 0..self.surface.origins.len() as u32 {
            if !self.is_edge(h) || self.length(h) <= TOO_LONG * self.size(h) {
                continue;
            }
            let [a, b, _] = self.corners(h);
            let [below, above] = [height - a[axis], b[axis] - height];
            let margin = LEAST_PIECE * self.edge;
            if below * above > 0.0 && below.abs().min(above.abs()) > margin {
                let m = self.split(h);
                self.positions[m as usize] = a + below / (below + above) * (b - a);
            }
        }
    }

    /// Shrinks edges that are too short to one of their ends, where that leaves no edge too long.
    pub(super) fn collapse_short(&mut self) {
        // Around the middle of a fan edges go one by one; what is left goes in the next iteration.
        let passes = if matches!(self.target, Target::Triangles(_)) { 12 } else { usize::MAX };
        for _ in 0..passes {
            let mut collapsed = false;
            for h in 0..self.surface.origins.len() as u32 {
                if self.is_edge(h) && self.length(h) < TOO_SHORT * self.size(h) {
                    collapsed |= self.collapse(h, TOO_LONG * self.size(h));
                }
            }
            if !collapsed {
                break;
            }
        }
    }

    /// Flips edges where that brings the valences of the four vertices nearer to 6.
    pub(super) fn equalise_valence(&mut self) {
        for _ in 0..4 {
            let mut flipped = false;
            for h in 0..self.surface.origins.len() as u32 {
                if self.is_edge(h) && self.flip_gain(h) > 0 && self.may_flip(h) {
                    self.surface.flip(h);
                    flipped = true;
                }
            }
            if !flipped {
                break;
            }
        }
    }

    /// Moves each vertex along the surface to the middle of its neighbours, and onto the zero level.
    pub(super) fn relax(&mut self) {
        for v in 0..self.positions.len() as u32 {
            if !self.is_used(v) {
                continue;
            }
            let old = self.positions[v as usize];
            let freedom = self.sharp.freedom(&self.surface, v);
            let Some(along) = self.way_to_middle(v, freedom) else { continue };
            let worst = self.worst_at(v, old).min(GOOD_RADIUS_RATIO);
            let longest = self.longest_at(v, old).max(LONGEST_REPAIR * self.edge);
            for share in [1.0, 0.5, 0.25, 0.0] {
                let Some(moved) = self.projected(old + share * along, freedom) else { continue };
                let even = self.worst_at(v, moved) >= worst && self.longest_at(v, moved) <= longest;
                if self.keeps_sides(v, moved) && (even || share == 0.0) {
                    self.positions[v as usize] = moved;
                    break;
                }
            }
        }
    }

    /// The way from `v` to the middle of its neighbours along the surface, or along its sharp line; none for a corner.
    fn way_to_middle(&self, v: u32, freedom: Freedom) -> Option<Vec3> {
        let old = self.positions[v as usize];
        match freedom {
            Freedom::Corner => None,
            Freedom::Line(ends) => {
                let [a, b] = ends.map(|w| self.positions[w as usize]);
                Some((a + b) / 2.0 - old)
            }
            Freedom::Surface => {
                let (sum, count) =
                    self.surface.ring(v).fold((Vec3::zeros(), 0.0), |(sum, count), w| {
                        (sum + self.positions[w as usize], count + 1.0)
                    });
                let move_to_middle = sum / count - old;
                let normal = self.normal(v).try_normalize(0.0)?;
                Some(move_to_middle - normal * normal.dot(&move_to_middle))
            }
        }
    }

    /// Edits the surroundings of vertices and triangles beyond the limits; whether there was any.
    pub(super) fn repair(&mut self) -> bool {
        let mut found = false;
        for v in 0..self.positions.len() as u32 {
            if !self.is_used(v) {
                continue;
            }
            let valence = self.surface.valence(v);
            if VALENCES.contains(&valence) {
                continue;
            }
            found = true;
            let spokes: Vec<u32> = self.surface.spokes(v).collect();
            if valence < *VALENCES.start() {
                let longest = LONGEST_REPAIR * self.edge;
                if !spokes.iter().any(|&h| self.collapse(h, longest)) {
                    // At the tip of a spike no spoke can go; an edge from the middle opposite can come.
                    self.split(next(spokes[0]));
                }
            } else if let Some(h) = spokes.into_iter().find(|&h| self.may_flip(h)) {
                self.surface.flip(h);
            }
        }
        for t in 0..self.surface.origins.len() as u32 / 3 {
            if !self.surface.is_live(3 * t) || self.ratio(3 * t) >= LEAST_RADIUS_RATIO {
                continue;
            }
            found = true;
            let mut sides = [3 * t, 3 * t + 1, 3 * t + 2];
            sides.sort_by(|&g, &h| self.length(g).total_cmp(&self.length(h)));
            if self.may_flip(sides[2]) && self.flip_improves(sides[2]) {
                self.surface.flip(sides[2]);
            } else {
                self.collapse(sides[0], LONGEST_REPAIR * self.edge);
            }
        }
        found
    }

    /// The live triangles over the live vertices, both in their old order.
    /// The triangles that are left, and their sharp edges.
    pub(super) fn into_mesh(self) -> (TriangleMesh, BTreeSet<[u32; 2]>) {
        let mut numbers = vec![NONE; self.positions.len()];
        let mut positions = Vec::new();
        for (v, &position) in self.positions.iter().enumerate() {
            if self.surface.outgoing[v] != NONE {
                numbers[v] = positions.len() as u32;
                positions.push(position);
            }
        }
        let live = self.surface.origins.chunks_exact(3).filter(|t| t[0] != NONE);
        let triangles = live.map(|t| [t[0], t[1], t[2]].map(|v| numbers[v as usize])).collect();
        (TriangleMesh { positions, triangles }, self.sharp.renumbered(&numbers))
    }

    /// Whether `h` is live and stands for its edge.
    fn is_edge(&self, h: u32) -> bool {
        self.surface.is_live(h) && h < self.surface.twin(h)
    }

    fn is_used(&self, v: u32) -> bool {
        self.surface.outgoing[v as usize] != NONE
    }

    /// The edge length wanted at `h`.
    fn size(&self, h: u32) -> f64 {
        let ends = [self.surface.origin(h), self.surface.destination(h)];
        let [a, b] = ends.map(|v| self.sizes[v as usize]);
        a.min(b)
    }

    fn length(&self, h: u32) -> f64 {
        let (a, b) = (self.surface.origin(h), self.surface.destination(h));
        (self.positions[b as usize] - self.positions[a as usize]).norm()
    }

    fn corners(&self, h: u32) -> [Vec3; 3] {
        [self.surface.origin(h), self.surface.destination(h), self.surface.apex(h)]
            .map(|v| self.positions[v as usize])
    }

    fn ratio(&self, h: u32) -> f64 {
        radius_ratio(self.corners(h))
    }

    fn normal(&self, v: u32) -> Vec3 {
        self.surface.spokes(v).map(|h| area_vector(self.corners(h))).sum()
    }

    /// Halves the edge of `h` at a new vertex, which is returned.
    fn split(&mut self, h: u32) -> u32 {
        let [a, b, _] = self.corners(h);
        let ends = [self.surface.origin(h), self.surface.destination(h)];
        self.sizes.push(self.size(h));
        let middle = self.surface.split(h);
        self.sharp.split(ends, middle);
        self.positions.push((a + b) / 2.0);
        middle
    }

    /// Collapses the edge of `h` to either end, if allowed; whether it did.
    fn collapse(&mut self, h: u32, longest: f64) -> bool {
        let (a, b) = (self.surface.origin(h), self.surface.destination(h));
        // First, because of a fan's middle the rest looks at all pairs of spokes.
        let is_crowded = self.surface.valence(a) + self.surface.valence(b) - 4 > *VALENCES.end();
        if is_crowded || !self.surface.can_collapse(h) {
            return false;
        }
        let ends = [h, self.surface.twin(h)];
        let allowed = ends.into_iter().find(|&h| self.collapse_keeps_shape(h, longest));
        if let Some(h) = allowed {
            if !self.sharp.is_empty() {
                let (a, b) = (self.surface.origin(h), self.surface.destination(h));
                let ring: Vec<u32> = self.surface.ring(a).collect();
                self.sharp.collapse(a, b, &ring);
            }
            self.surface.collapse(h);
        }
        allowed.is_some()
    }

    /// Whether moving the origin of `h` to its destination turns over or flattens no triangle, and makes
    /// no edge longer than `longest`.
    fn collapse_keeps_shape(&self, h: u32, longest: f64) -> bool {
        let (a, b) = (self.surface.origin(h), self.surface.destination(h));
        let target = self.positions[b as usize];
        self.sharp.may_collapse(&self.surface, h)
            && self.surface.spokes(a).all(|s| {
                let [_, x, y] = self.corners(s);
                let dies = self.surface.destination(s) == b || self.surface.apex(s) == b;
                let old = self.corners(s);
                let new = [target, x, y];
                (target - x).norm() <= longest
                    && (dies
                        || same_side(old, new)
                            && radius_ratio(new) > radius_ratio(old).min(FLAT_RADIUS_RATIO))
            })
    }

    /// By how much a flip lowers the sum of the squared differences of the valences from 6.
    fn flip_gain(&self, h: u32) -> i64 {
        let twin = self.surface.twin(h);
        let excess = |v: u32| self.surface.valence(v) as i64 - 6;
        let [a, b] = [h, twin].map(|h| excess(self.surface.origin(h)));
        let [c, d] = [h, twin].map(|h| excess(self.surface.apex(h)));
        let squares = |excesses: [i64; 4]| excesses.iter().map(|e| e * e).sum::<i64>();
        squares([a, b, c, d]) - squares([a - 1, b - 1, c + 1, d + 1])
    }

    /// Whether a flip keeps the manifold, and the two new triangles face as the old ones and have a shape.
    fn may_flip(&self, h: u32) -> bool {
        let (old, new) = (self.pair(h), self.flipped_pair(h));
        let mean = old.map(area_vector).iter().sum::<Vec3>();
        let faces_alike = |triangle: [Vec3; 3]| {
            let vector = area_vector(triangle);
            vector.dot(&mean) > LEAST_COSINE * vector.norm() * mean.norm()
        };
        let worst = |pair: [[Vec3; 3]; 2]| pair.map(radius_ratio).into_iter().fold(1.0, f64::min);
        let [a, b] = [self.surface.origin(h), self.surface.destination(h)];
        !self.sharp.has(a, b)
            && new.into_iter().all(faces_alike)
            && worst(new) > worst(old).min(LEAST_RADIUS_RATIO)
            && bend(new) < bend(old).max(FLATTEST_CREASE)
            && (new[0][0] - new[0][1]).norm() < LONGEST_REPAIR * self.edge
            && self.surface.can_flip(h)
    }

    fn flip_improves(&self, h: u32) -> bool {
        let worst = |pair: [[Vec3; 3]; 2]| pair.map(radius_ratio).into_iter().fold(1.0, f64::min);
        worst(self.flipped_pair(h)) > worst(self.pair(h))
    }

    fn pair(&self, h: u32) -> [[Vec3; 3]; 2] {
        [self.corners(h), self.corners(self.surface.twin(h))]
    }

    fn flipped_pair(&self, h: u32) -> [[Vec3; 3]; 2] {
        let [[a, b, c], [_, _, d]] = self.pair(h);
        [[d, c, a], [c, d, b]]
    }

    /// The smallest radius ratio around `v` if it were at `point`.
    fn worst_at(&self, v: u32, point: Vec3) -> f64 {
        self.around(v, point).map(|(_, new)| radius_ratio(new)).fold(1.0, f64::min)
    }

    /// The longest edge at `v` if it were at `point`, mm.
    fn longest_at(&self, v: u32, point: Vec3) -> f64 {
        self.around(v, point).map(|(_, [p, x, _])| (x - p).norm()).fold(0.0, f64::max)
    }

    /// Whether no triangle around `v` turns over when it moves to `point`.
    fn keeps_sides(&self, v: u32, point: Vec3) -> bool {
        self.around(v, point).all(|(old, new)| same_side(old, new))
    }

    /// The triangles around `v`, as they are and with `v` at `point`.
    fn around(&self, v: u32, point: Vec3) -> impl Iterator<Item = ([Vec3; 3], [Vec3; 3])> + '_ {
        self.surface.spokes(v).map(move |h| {
            let [old, x, y] = self.corners(h);
            ([old, x, y], [point, x, y])
        })
    }

    /// `point` of a vertex of such `freedom` moved to where it belongs; `None` where that is not nearby.
    fn projected(&self, point: Vec3, freedom: Freedom) -> Option<Vec3> {
        match self.target {
            Target::Nearby => Some(point),
            Target::Level(field) => self.on_level(field, point),
            Target::Triangles(original) => {
                let nearest = original.nearest(point, freedom);
                ((nearest - point).norm() < LONGEST_PROJECTION * self.edge).then_some(nearest)
            }
        }
    }

    /// `point` moved along the gradient onto the zero level of `field` by damped Newton steps; itself where the
    /// gradient is unusable, and `None` where the level is not reached nearby.
    fn on_level(&self, field: &dyn ScalarField, mut point: Vec3) -> Option<Vec3> {
        let newton_step = |(value, gradient): (f64, Vec3)| {
            let step = -value / gradient.norm_squared() * gradient;
            step.iter().all(|x| x.is_finite()).then_some(step)
        };
        let mut here = field.value_and_gradient(point);
        let Some(mut step) = newton_step(here) else { return Some(point) };
        for _ in 0..MOST_NEWTON_STEPS {
            let length = step.norm();
            if length < ON_LEVEL * self.edge {
                break;
            }
            let full = (LONGEST_NEWTON_STEP * self.edge / length).min(1.0);
            let trials = [full, full / 2.0, full / 4.0].map(|share| point + share * step);
            let lower = trials.into_iter().find_map(|trial| {
                let there = field.value_and_gradient(trial);
                (there.0.abs() < here.0.abs()).then_some((trial, there))
            });
            let Some(accepted) = lower else { break };
            (point, here) = accepted;
            step = newton_step(here)?;
        }
        (step.norm() < NEAR_LEVEL * self.edge).then_some(point)
    }
}

/// Whether the normal of a triangle turns by less than about 70 degrees.
fn same_side(old: [Vec3; 3], new: [Vec3; 3]) -> bool {
    let (old, new) = (area_vector(old), area_vector(new));
    new.dot(&old) > LEAST_COSINE * old.norm() * new.norm() || old.norm() == 0.0
}

/// 1 - cos of the angle between the normals.
fn bend(pair: [[Vec3; 3]; 2]) -> f64 {
    let [m, n] = pair.map(area_vector);
    1.0 - m.dot(&n) / (m.norm() * n.norm())
}

/// Botsch and Kobbelt's limits, over the edge length wanted: halving or merging brings an edge nearer.
const TOO_LONG: f64 = 4.0 / 3.0;
const TOO_SHORT: f64 = 4.0 / 5.0;
/// Between a cut and the end of an edge, over the edge length wanted.
const LEAST_PIECE: f64 = 0.05;
/// In a repair an edge may be as long as the final check allows, less some for the relaxation.
const LONGEST_REPAIR: f64 = 1.7;
/// Below it a triangle must not get worse by a collapse.
const FLAT_RADIUS_RATIO: f64 = 0.1;
/// Above it a triangle may get worse by a relaxation.
const GOOD_RADIUS_RATIO: f64 = 0.6;
/// Growth of the edge length wanted, over the way.
const STEEPEST_GRADING: f64 = 0.5;
const GRADING_PASSES: usize = 4;
const LEAST_COSINE: f64 = 0.35;
/// A flip may make a crease of up to this 1 - cos.
const FLATTEST_CREASE: f64 = 0.2;
/// Over the edge length wanted: beyond, the nearest point is another fold's.
const LONGEST_PROJECTION: f64 = 0.5;
const MOST_NEWTON_STEPS: usize = 4;
/// Over the edge length wanted.
const LONGEST_NEWTON_STEP: f64 = 0.25;
const ON_LEVEL: f64 = 1e-6;
/// A vertex farther off than this over the edge length is left where it was: at kinks of the field.
const NEAR_LEVEL: f64 = 0.05;
