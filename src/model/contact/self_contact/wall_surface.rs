//! The surface that may touch itself: its triangles with their points and facets, what is neighbour of what, how thick
//! the wall counts, and the search for what is near.
//!
//! # Decisions
//! Points that are less than two thicknesses apart at rest, and less than three along the edges, never touch: a wall cannot
//! fold more tightly, and what is side by side is always near. A triangle never touches itself.
//!
//! Where two parts of the wall touch, their normals oppose each other if the surface is closed: an outer face meets outer
//! faces, an inner face inner ones. So triangles of a closed surface whose normals agree to within 60 degrees, before a
//! step and after it, are not compared: nearly all of them are neighbours at rest. An open sheet may roll up, face on back;
//! its triangles are all compared.

use std::cell::Cell;
use std::collections::BTreeMap;

use super::distance::Closest;
use super::near_at_rest::Neighbours;
use super::tree::{Box3, Tree};
use crate::math::Vec3;
use crate::model::element::{ElementPoints, SampledSurface};

/// Distances at rest below which parts never touch, straight and along the surface, in thicknesses.
const NEIGHBOURHOOD: [f64; 2] = [2.0, 3.0];
/// Share of its distance at rest that the wall may count as thick.
const REST_SHARE: f64 = 0.9;
/// How far a point's surroundings at rest matter, in thicknesses.
const REACH_AT_REST: f64 = 1.5;
/// Cosine of the angle between normals below which triangles of a closed surface are compared.
const FACING: f64 = 0.5;

/// What is known of a wall before it moves.
#[derive(Clone, Debug)]
pub(super) struct WallSurface {
    /// Nodes and weights of each triangle's six points.
    pub(super) points: Vec<ElementPoints>,
    surface: SampledSurface,
    triangles: Vec<Triangle>,
    is_closed: bool,
    neighbours: Neighbours,
    tree: Tree,
    /// Samples at rest, mm.
    rest: Vec<Vec3>,
    pub(super) thickness: f64,
    /// Share of the reference area of each sample, mm^2.
    pub(super) areas: Vec<f64>,
    /// Distance of each sample from the nearest part of the wall that is no neighbour, at rest, as far as it matters, mm.
    pub(super) room: Vec<f64>,
}

/// The six points of a triangle, and which of them and of the edges between them it answers for.
#[derive(Clone, Debug)]
struct Triangle {
    samples: [u32; 6],
    facets: [Facet; 4],
    own_points: Vec<u8>,
    own_edges: Vec<OwnEdge>,
}

/// A facet among a triangle's six points, and what its sides and corners count (see [`super::pair`]).
#[derive(Clone, Copy, Debug)]
struct Facet {
    corners: [u8; 3],
    sides: [f64; 3],
    tips: [f64; 3],
}

#[derive(Clone, Copy, Debug)]
struct OwnEdge {
    ends: [u8; 2],
    area: f64,
}

/// Two parts of the wall that may touch, by the twelve points of their two triangles.
#[derive(Clone, Copy, Debug)]
pub(super) struct Couple {
    pub(super) points: [u8; 4],
    pub(super) samples: [u32; 4],
    pub(super) kind: Kind,
}

/// Which parts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    /// The first point, and the facet of the others: with what its sides (12, 23, 31) and corners count.
    PointFacet { sides: [f64; 3], tips: [f64; 3] },
    /// The edges of the first two and the last two, with their shares of the reference area, mm^2.
    Edges { areas: [f64; 2] },
}

/// Where the samples are, and how they may move.
pub(super) struct Pose {
    pub(super) samples: Vec<Vec3>,
    /// Where they go; empty at a standstill.
    pub(super) motion: Vec<Vec3>,
    /// The share of their motion that matters; it may shrink during a search.
    pub(super) share: Cell<f64>,
    boxes: Vec<Box3>,
    motion_boxes: Vec<Box3>,
    /// Of each triangle, before and after; none where they do not matter.
    normals: [Vec<Vec3>; 2],
}

impl WallSurface {
    /// Of a wall with nodes at `reference` (mm) at rest.
    pub(super) fn new(
        points: &[ElementPoints],
        surface: &SampledSurface,
        reference: &[Vec3],
        thickness: f64,
    ) -> Self {
        let rest = surface.at(reference);
        let (triangles, edges, is_closed) = triangles(surface, &rest);
        let mut areas = vec![0.0; rest.len()];
        for facet in &surface.facets {
            for v in facet {
                areas[*v as usize] += area(&rest, *facet) / 3.0;
            }
        }
        let centre = |triangle: &Triangle| {
            triangle.samples.iter().map(|&v| rest[v as usize]).sum::<Vec3>() / 6.0
        };
        let tree = Tree::new(&triangles.iter().map(centre).collect::<Vec<_>>());
        let [straight, along] = NEIGHBOURHOOD.map(|distance| distance * thickness);
        let neighbours = Neighbours::new(&rest, &edges, straight, along);
        let mut made = Self {
            points: points.to_vec(),
            surface: surface.clone(),
            triangles,
            is_closed,
            neighbours,
            tree,
            room: vec![f64::INFINITY; rest.len()],
            rest,
            thickness,
            areas,
        };
        let pose = made.pose(reference, None);
        let reach = REACH_AT_REST * thickness;
        let mut room = std::mem::take(&mut made.room);
        made.visit_near(&pose, reach, &mut |_, couple| {
            if let Kind::PointFacet { .. } = couple.kind {
                let room = &mut room[couple.samples[0] as usize];
                *room = room.min(couple.closest(&pose.samples).distance);
            }
        });
        made.room = room;
        made
    }

    /// The samples where the nodes are at `positions`; of displacements, theirs, mm.
    pub(super) fn samples_at(&self, positions: &[Vec3]) -> Vec<Vec3> {
        self.surface.at(positions)
    }

    /// The samples at the twelve points of two triangles.
    pub(super) fn samples_of(&self, [a, b]: [u32; 2]) -> [u32; 12] {
        let [a, b] = [a, b].map(|t| &self.triangles[t as usize].samples);
        std::array::from_fn(|point| if point < 6 { a[point] } else { b[point - 6] })
    }

    /// Four samples at rest, mm.
    pub(super) fn at_rest(&self, samples: &[u32; 4]) -> [Vec3; 4] {
        samples.map(|v| self.rest[v as usize])
    }

    /// The positions of the samples where the nodes are at `positions`, and their motion where the nodes move by `dx`.
    pub(super) fn pose(&self, positions: &[Vec3], dx: Option<&[Vec3]>) -> Pose {
        let samples = self.surface.at(positions);
        let motion = dx.map(|dx| self.surface.at(dx)).unwrap_or_default();
        let box_around = |x: &[Vec3], triangle: u32| {
            Box3::around(self.triangles[triangle as usize].samples.map(|v| x[v as usize]))
        };
        let boxes = self.tree.boxes(&|triangle| box_around(&samples, triangle));
        let moves = !motion.is_empty();
        let motion_boxes = if moves {
            self.tree.boxes(&|triangle| box_around(&motion, triangle))
        } else {
            Vec::new()
        };
        let normals = if self.is_closed {
            let after = moves.then(|| {
                let there: Vec<Vec3> = samples.iter().zip(&motion).map(|(x, dx)| x + dx).collect();
                self.normals(&there)
            });
            [self.normals(&samples), after.unwrap_or_default()]
        } else {
            Default::default()
        };
        Pose { samples, motion, share: Cell::new(1.0), boxes, motion_boxes, normals }
    }

    /// Calls `visit` with the two triangles of each couple that comes within `reach` (mm) of each other in `pose`, and the
    /// couple; the order is always the same.
    pub(super) fn visit_near(
        &self,
        pose: &Pose,
        reach: f64,
        visit: &mut dyn FnMut([u32; 2], Couple),
    ) {
        let Pose { boxes, motion_boxes, .. } = pose;
        let near = |a: usize, b: usize| {
            let closing =
                if motion_boxes.is_empty() { 0.0 } else { motion_boxes[a].reach(&motion_boxes[b]) };
            boxes[a].gap_squared(&boxes[b]) < (reach + closing).powi(2)
        };
        self.tree.pairs(&near, &mut |a, b| {
            if pose.faces([a, b]) {
                self.visit_couples([a, b], pose, reach, visit);
            }
        });
    }

    /// How thick the wall counts at a sample, mm.
    pub(super) fn thickness_at(&self, sample: u32) -> f64 {
        self.thickness.min(REST_SHARE * self.room[sample as usize])
    }

    /// How thick the wall counts for `couple`, and its distance at rest, mm.
    pub(super) fn thickness_of(&self, couple: &Couple) -> [f64; 2] {
        match couple.kind {
            Kind::PointFacet { .. } => {
                [self.thickness_at(couple.samples[0]), self.room[couple.samples[0] as usize]]
            }
            Kind::Edges { .. } => {
                let room = couple.closest(&self.rest).distance;
                [self.thickness.min(REST_SHARE * room), room]
            }
        }
    }

    /// The node that moves a sample most.
    pub(super) fn node_of(&self, sample: u32) -> u32 {
        let sample = &self.surface.samples[sample as usize];
        let weights = sample.nodes.iter().zip(&sample.weights);
        weights.max_by(|a, b| a.1.total_cmp(b.1)).map_or(0, |(&node, _)| node)
    }

    fn visit_couples(
        &self,
        [a, b]: [u32; 2],
        pose: &Pose,
        reach: f64,
        visit: &mut dyn FnMut([u32; 2], Couple),
    ) {
        let [one, other] = [a, b].map(|t| &self.triangles[t as usize]);
        let sample = |point: u8| {
            let owner = if point < 6 { one } else { other };
            owner.samples[point as usize % 6]
        };
        let mut offer = |points: [u8; 4], kind: Kind, first: usize| {
            let samples = points.map(sample);
            let couple = Couple { points, samples, kind };
            if pose.may_meet(&samples, first, reach)
                && !self.neighbours.join(&samples[..first], &samples[first..])
                && couple.closest(&pose.samples).distance < reach + pose.closing(&samples, first)
            {
                visit([a, b], couple);
            }
        };
        for (owner, facets, [at, over]) in [(one, other, [0, 6]), (other, one, [6, 0])] {
            for &point in &owner.own_points {
                for &Facet { corners: [i, j, k], sides, tips } in &facets.facets {
                    let points = [at + point, over + i, over + j, over + k];
                    offer(points, Kind::PointFacet { sides, tips }, 1);
                }
            }
        }
        for edge in &one.own_edges {
            for opposite in &other.own_edges {
                let ([i, j], [k, l]) = (edge.ends, opposite.ends);
                let kind = Kind::Edges { areas: [edge.area, opposite.area] };
                offer([i, j, 6 + k, 6 + l], kind, 2);
            }
        }
    }

    /// Unit normals of the triangles; zero where a facet is turned away from it, which then faces everything.
    fn normals(&self, x: &[Vec3]) -> Vec<Vec3> {
        let normal = |facets: &[[u32; 3]]| {
            let normals = facets.iter().map(|facet| area_vector(x, *facet));
            let mean = normals.clone().sum::<Vec3>().normalize();
            let is_flat = normals.clone().all(|normal| normal.dot(&mean) > 0.8 * normal.norm());
            if is_flat { mean } else { Vec3::zeros() }
        };
        self.surface.facets.chunks_exact(4).map(normal).collect()
    }
}

impl Couple {
    /// Its closest points where the samples are at `x`.
    pub(super) fn closest(&self, x: &[Vec3]) -> Closest {
        self.kind.closest(&self.samples.map(|v| x[v as usize]))
    }
}

impl Kind {
    /// How many of the four points are on the first side.
    pub(super) fn first(&self) -> usize {
        match self {
            Self::PointFacet { .. } => 1,
            Self::Edges { .. } => 2,
        }
    }

    /// The closest points of the two parts whose corners are at `x`.
    pub(super) fn closest(&self, x: &[Vec3; 4]) -> Closest {
        match self {
            Self::PointFacet { .. } => Closest::of_point_and_facet(x),
            Self::Edges { .. } => Closest::of_edges(x),
        }
    }
}

impl Pose {
    fn faces(&self, [a, b]: [u32; 2]) -> bool {
        let [before, after] = &self.normals;
        let opposed = |normals: &[Vec3]| {
            normals.is_empty() || normals[a as usize].dot(&normals[b as usize]) < FACING
        };
        opposed(before) || (!after.is_empty() && opposed(after))
    }

    /// Whether the balls around the `first` samples and around the others come within `reach`.
    fn may_meet(&self, samples: &[u32; 4], first: usize, reach: f64) -> bool {
        let x = samples.map(|v| self.samples[v as usize]);
        let ball = |x: &[Vec3]| {
            let centre = x.iter().sum::<Vec3>() / x.len() as f64;
            let radius = x.iter().map(|x| (x - centre).norm_squared()).fold(0.0, f64::max);
            (centre, radius.sqrt())
        };
        let ((a, r), (b, s)) = (ball(&x[..first]), ball(&x[first..]));
        (a - b).norm_squared() < (reach + r + s + self.closing(samples, first)).powi(2)
    }

    /// By how much the `first` samples and the others come closer at most, mm.
    pub(super) fn closing(&self, samples: &[u32; 4], first: usize) -> f64 {
        if self.motion.is_empty() {
            return 0.0;
        }
        self.share.get() * closing_speed(&samples.map(|v| self.motion[v as usize]), first)
    }
}

/// The largest rate at which the `first` of four points that move by `dx`, and the others, come closer.
pub(super) fn closing_speed(dx: &[Vec3; 4], first: usize) -> f64 {
    // What moves both alike does not bring them closer.
    let common = dx.iter().sum::<Vec3>() / 4.0;
    let fastest = |dx: &[Vec3]| dx.iter().map(|dx| (dx - common).norm()).fold(0.0, f64::max);
    fastest(&dx[..first]) + fastest(&dx[first..])
}

fn area_vector(x: &[Vec3], facet: [u32; 3]) -> Vec3 {
    let [a, b, c] = facet.map(|v| x[v as usize]);
    (b - a).cross(&(c - a)) / 2.0
}

fn area(x: &[Vec3], facet: [u32; 3]) -> f64 {
    area_vector(x, facet).norm()
}

/// The triangles of a surface, its edges, and whether it is closed.
fn triangles(surface: &SampledSurface, rest: &[Vec3]) -> (Vec<Triangle>, Vec<[u32; 2]>, bool) {
    let sides = |[a, b, c]: [u32; 3]| [[a, b], [b, c], [c, a]].map(|[a, b]| [a.min(b), a.max(b)]);
    // Facets at each edge, with their area; facets and open edges at each sample.
    let mut edges: BTreeMap<[u32; 2], (u32, f64)> = BTreeMap::new();
    let mut around = vec![0_u32; rest.len()];
    for facet in &surface.facets {
        for side in sides(*facet) {
            let (facets, share) = edges.entry(side).or_default();
            *facets += 1;
            *share += area(rest, *facet) / 3.0;
        }
        facet.iter().for_each(|&v| around[v as usize] += 1);
    }
    let mut at_rim = vec![false; rest.len()];
    let rim = edges.iter().filter(|(_, (facets, _))| *facets == 1);
    rim.flat_map(|(ends, _)| ends).for_each(|&v| at_rim[v as usize] = true);
    let is_closed = !at_rim.contains(&true);

    let mut point_is_free = vec![true; rest.len()];
    let mut free_edges = edges.clone();
    let triangle = |facets: &[[u32; 3]]| {
        // The corners' facets come first, then the one of the edge midpoints.
        let [a, b, c] = [facets[0][0], facets[1][0], facets[2][0]];
        let [d, e, f] = facets[3];
        let samples = [a, b, c, d, e, f];
        let local = |v: u32| samples.iter().position(|&w| w == v).map_or(0, |place| place as u8);
        let own_points = (0..6).filter(|&point| {
            std::mem::replace(&mut point_is_free[samples[point as usize] as usize], false)
        });
        let own_points = own_points.collect();
        let mut own_edges = Vec::new();
        let of_facet = |facet: &[u32; 3]| {
            for side in sides(*facet) {
                if let Some((_, area)) = free_edges.remove(&side) {
                    own_edges.push(OwnEdge { ends: side.map(local), area });
                }
            }
            Facet {
                corners: facet.map(local),
                sides: sides(*facet).map(|side| if edges[&side].0 == 1 { 0.0 } else { -0.5 }),
                tips: facet.map(|v| {
                    if at_rim[v as usize] { 0.0 } else { 1.0 / f64::from(around[v as usize]) }
                }),
            }
        };
        let mut of_facet = of_facet;
        let facets = [0, 1, 2, 3].map(|k| of_facet(&facets[k]));
        Triangle { samples, facets, own_points, own_edges }
    };
    let triangles = surface.facets.chunks_exact(4).map(triangle).collect();
    (triangles, edges.into_keys().collect(), is_closed)
}
