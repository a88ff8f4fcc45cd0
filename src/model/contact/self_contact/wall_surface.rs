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
use std::collections::BTreeSet;
use std::f64::consts::PI;

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
/// Angle between normals beyond which facets of a closed surface are compared.
const FACING: f64 = PI / 3.0;

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
    /// Around the nodes of the tree.
    boxes: Vec<Box3>,
    motion_boxes: Vec<Box3>,
    /// Around their normals, before and after; none where normals do not matter.
    cones: [Vec<Cone>; 2],
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
        let edges = edges(surface, &rest);
        let triangles = triangles(surface, &edges);
        let is_closed = edges.iter().all(|edge| !edge.is_rim);
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
        let neighbours = Neighbours::new(&rest, edges.iter().map(|it| it.ends), straight, along);
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
        let boxes_around = |x: &[Vec3]| {
            let of_triangle = |t: u32| self.triangles[t as usize].box_around(x);
            self.tree.fitted(&of_triangle, &Box3::join)
        };
        let boxes = boxes_around(&samples);
        let is_moved = !motion.is_empty();
        let motion_boxes = if is_moved { boxes_around(&motion) } else { Vec::new() };
        let mut cones = <[Vec<Cone>; 2]>::default();
        if self.is_closed {
            cones[0] = self.cones(&samples);
            if is_moved {
                let there: Vec<Vec3> = samples.iter().zip(&motion).map(|(x, dx)| x + dx).collect();
                cones[1] = self.cones(&there);
            }
        }
        Pose { samples, motion, share: Cell::new(1.0), boxes, motion_boxes, cones }
    }

    /// Calls `visit` with the two triangles of each couple that comes within `reach` (mm) of each other in `pose`, and the
    /// couple; the order is always the same.
    pub(super) fn visit_near(
        &self,
        pose: &Pose,
        reach: f64,
        visit: &mut dyn FnMut([u32; 2], Couple),
    ) {
        let near = |a: usize, b: usize| pose.nodes_may_meet(a, b, reach);
        self.tree.pairs(&near, &mut |a, b| self.visit_couples([a, b], pose, reach, visit));
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
        let near_to = |triangle: &Triangle| {
            let around = triangle.box_around(&pose.samples);
            let motion = pose.is_moving().then(|| triangle.box_around(&pose.motion));
            move |samples: &[u32]| pose.may_meet_box(samples, &around, motion.as_ref(), reach)
        };
        let (near_to_one, near_to_other) = (near_to(one), near_to(other));
        for &point in one.own_points.iter().filter(|&&point| near_to_other(&[sample(point)])) {
            for facet in &other.facets {
                let [i, j, k] = facet.corners;
                offer([point, 6 + i, 6 + j, 6 + k], facet.kind(), 1);
            }
        }
        for &point in other.own_points.iter().filter(|&&point| near_to_one(&[sample(6 + point)])) {
            for facet in &one.facets {
                let [i, j, k] = facet.corners;
                offer([6 + point, i, j, k], facet.kind(), 1);
            }
        }
        for edge in &one.own_edges {
            let [i, j] = edge.ends;
            if near_to_other(&[sample(i), sample(j)]) {
                for opposite in &other.own_edges {
                    let [k, l] = opposite.ends.map(|end| 6 + end);
                    let kind = Kind::Edges { areas: [edge.area, opposite.area] };
                    offer([i, j, k, l], kind, 2);
                }
            }
        }
    }

    /// Cones around the normals of the facets.
    fn cones(&self, x: &[Vec3]) -> Vec<Cone> {
        let of_triangle = |triangle: u32| {
            let first = 4 * triangle as usize;
            let normals = [0, 1, 2, 3].map(|k| area_vector(x, self.surface.facets[first + k]));
            let cones = normals.map(|normal| Cone { axis: normal.normalize(), angle: 0.0 });
            cones[1..].iter().fold(cones[0], |cone, other| cone.join(other))
        };
        self.tree.fitted(&of_triangle, &Cone::join)
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
    /// Whether triangles of two nodes of the tree may face each other and come within `reach`.
    fn nodes_may_meet(&self, a: usize, b: usize, reach: f64) -> bool {
        let closing = if self.is_moving() {
            self.share.get() * self.motion_boxes[a].reach(&self.motion_boxes[b])
        } else {
            0.0
        };
        let largest = reach + closing;
        let [before, after] = &self.cones;
        let faces = |cones: &[Cone]| !cones.is_empty() && cones[a].faces(&cones[b]);
        self.boxes[a].gap_squared(&self.boxes[b]) < largest * largest
            && (before.is_empty() || faces(before) || faces(after))
    }

    fn is_moving(&self) -> bool {
        !self.motion.is_empty()
    }

    /// Whether a part with corners at `samples` may come within `reach` of what is in a box.
    fn may_meet_box(
        &self,
        samples: &[u32],
        around: &Box3,
        motion: Option<&Box3>,
        reach: f64,
    ) -> bool {
        let of_samples = |all: &[Vec3]| Box3::around(samples.iter().map(|&v| all[v as usize]));
        let closing = motion.map_or(0.0, |motion| motion.reach(&of_samples(&self.motion)));
        let largest = reach + self.share.get() * closing;
        of_samples(&self.samples).gap_squared(around) < largest * largest
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

    /// By how much at most the `first` samples and the others come closer, mm.
    pub(super) fn closing(&self, samples: &[u32; 4], first: usize) -> f64 {
        if !self.is_moving() {
            return 0.0;
        }
        self.share.get() * closing_speed(&samples.map(|v| self.motion[v as usize]), first)
    }
}

impl Triangle {
    fn box_around(&self, x: &[Vec3]) -> Box3 {
        Box3::around(self.samples.map(|v| x[v as usize]))
    }
}

impl Facet {
    fn kind(&self) -> Kind {
        Kind::PointFacet { sides: self.sides, tips: self.tips }
    }
}

/// Directions within an angle about an axis.
#[derive(Clone, Copy, Debug)]
struct Cone {
    axis: Vec3,
    angle: f64,
}

impl Cone {
    fn join(&self, other: &Self) -> Self {
        let axis = (self.axis + other.axis).normalize();
        let angle = |cone: &Self| cone.angle + axis.dot(&cone.axis).clamp(-1.0, 1.0).acos();
        // Opposite axes have no mean, and no cone that is of use.
        let angle = angle(self).max(angle(other));
        Self { axis, angle: if angle.is_nan() { PI } else { angle } }
    }

    /// Whether directions of both may differ by more than is allowed to neighbours.
    fn faces(&self, other: &Self) -> bool {
        let left = FACING - self.angle - other.angle;
        left <= 0.0 || self.axis.dot(&other.axis) < left.cos()
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

/// An edge between two samples.
#[derive(Clone, Copy)]
struct Edge {
    ends: [u32; 2],
    /// Of its first triangle.
    triangle: u32,
    is_rim: bool,
    /// Share of the reference area, mm^2.
    area: f64,
}

/// The edges of a surface.
fn edges(surface: &SampledSurface, rest: &[Vec3]) -> Vec<Edge> {
    let sides = surface.facets.iter().zip(0_u32..).flat_map(|(&[a, b, c], facet)| {
        [[a, b], [b, c], [c, a]].map(|[a, b]| ([a.min(b), a.max(b)], facet))
    });
    let mut sides: Vec<([u32; 2], u32)> = sides.collect();
    sides.sort_unstable();
    let edge = |at: &[([u32; 2], u32)]| Edge {
        ends: at[0].0,
        triangle: at[0].1 / 4,
        is_rim: at.len() == 1,
        area: at.iter().map(|&(_, facet)| area(rest, surface.facets[facet as usize]) / 3.0).sum(),
    };
    sides.chunk_by(|one, next| one.0 == next.0).map(edge).collect()
}

/// The triangles of a surface with these `edges`.
fn triangles(surface: &SampledSurface, edges: &[Edge]) -> Vec<Triangle> {
    let mut around = vec![0_u32; surface.samples.len()];
    surface.facets.iter().flatten().for_each(|&v| around[v as usize] += 1);
    let mut at_rim = vec![false; surface.samples.len()];
    let rim: BTreeSet<[u32; 2]> = edges.iter().filter(|it| it.is_rim).map(|it| it.ends).collect();
    rim.iter().flatten().for_each(|&v| at_rim[v as usize] = true);
    let mut is_owned = vec![false; surface.samples.len()];
    let triangle = |facets: &[[u32; 3]]| {
        // The corners' facets come first, then the one of the edge midpoints.
        let [a, b, c] = [facets[0][0], facets[1][0], facets[2][0]];
        let [d, e, f] = facets[3];
        let samples = [a, b, c, d, e, f];
        let of_facet = |&corners: &[u32; 3]| {
            let [a, b, c] = corners;
            let side = |[a, b]: [u32; 2]| {
                if rim.contains(&[a.min(b), a.max(b)]) { 0.0 } else { -0.5 }
            };
            let tip = |v: u32| {
                if at_rim[v as usize] { 0.0 } else { 1.0 / f64::from(around[v as usize]) }
            };
            Facet {
                corners: corners.map(|v| place_of(v, &samples)),
                sides: [[a, b], [b, c], [c, a]].map(side),
                tips: corners.map(tip),
            }
        };
        let own_points = (0..6).filter(|&point| {
            let sample = samples[point as usize] as usize;
            !std::mem::replace(&mut is_owned[sample], true)
        });
        Triangle {
            samples,
            facets: [0, 1, 2, 3].map(|k| of_facet(&facets[k])),
            own_points: own_points.collect(),
            own_edges: Vec::new(),
        }
    };
    let mut triangles: Vec<Triangle> = surface.facets.chunks_exact(4).map(triangle).collect();
    for edge in edges {
        let triangle = &mut triangles[edge.triangle as usize];
        let ends = edge.ends.map(|v| place_of(v, &triangle.samples));
        triangle.own_edges.push(OwnEdge { ends, area: edge.area });
    }
    triangles
}

fn place_of(sample: u32, samples: &[u32; 6]) -> u8 {
    let place = samples.iter().position(|&other| other == sample);
    place.expect("a facet's corners are its triangle's points") as u8
}
