//! The surface that may touch itself: its triangles with their points and facets, what is neighbour of what, how thick
//! the wall counts, and the search for what is near.
//!
//! # Decisions
//! Points that are less than two thicknesses apart at rest, and less than three along the edges, never touch: a wall cannot
//! fold more tightly, and what is side by side is always near. A triangle never touches itself.
//!
//! Where two parts of the wall touch, their normals oppose each other if the surface is closed: an outer face meets outer
//! faces, an inner face inner ones. So triangles of a closed surface whose normals differ by less than a right angle, before
//! a step and after it, are not compared: nearly all of them are neighbours at rest. An open sheet may roll up, face on back;
//! its triangles are all compared.

use std::cell::{Cell, OnceCell};
use std::collections::BTreeSet;

use super::distance::Closest;
use super::near_at_rest::Neighbours;
use crate::math::{Box3, BoxTree, Vec3, area_vector};
use crate::model::element::{ElementPoints, SampledSurface};

/// Distances at rest below which parts never touch, straight and along the surface, in thicknesses.
const NEIGHBOURHOOD: [f64; 2] = [2.0, 3.0];
/// Share of its distance at rest that the wall may count as thick.
const REST_SHARE: f64 = 0.9;
/// How far a point's surroundings at rest matter, in thicknesses.
const REACH_AT_REST: f64 = 1.5;
/// What is searched for.
#[derive(Clone, Copy)]
pub(super) struct Search {
    /// How near parts are, mm.
    pub(super) reach: f64,
    /// Cosine of the angle between normals beyond which triangles of a closed surface are compared.
    facing: f64,
    has_edges: bool,
}

impl Search {
    /// For all that is nearer than `reach`, mm.
    pub(super) fn within(reach: f64) -> Self {
        Self { reach, facing: 0.0, has_edges: true }
    }

    /// For points nearer than `reach` (mm) to facets.
    fn of_points(reach: f64) -> Self {
        Self { has_edges: false, ..Self::within(reach) }
    }

    /// For touching faces: those that all but oppose each other, and points on facets, which see a face as soon as its edges.
    pub(super) fn for_touch(reach: f64) -> Self {
        Self { reach, facing: -0.5, has_edges: false }
    }
}

/// What is known of a wall before it moves.
#[derive(Clone, Debug)]
pub(super) struct WallSurface {
    /// Nodes and weights of each triangle's six points.
    pub(super) points: Vec<ElementPoints>,
    surface: SampledSurface,
    triangles: Vec<Triangle>,
    is_closed: bool,
    neighbours: Neighbours,
    /// Sorted at rest.
    tree: BoxTree,
    /// The triangle of each leaf of the tree.
    leaves: Vec<u32>,
    /// Samples at rest, mm.
    rest: Vec<Vec3>,
    /// Where the wall is thickest, mm.
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
    /// Edges that triangles before it answer for.
    first_edge: usize,
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
    normals: [Vec<Box3>; 2],
    /// Around each facet.
    facets: Vec<Ball>,
    /// Around the edges that each triangle answers for, in the order of the triangles; once they are wanted.
    edges: OnceCell<Vec<Ball>>,
}

/// All points within a radius of a centre, mm.
#[derive(Clone, Copy)]
struct Ball {
    centre: Vec3,
    radius: f64,
}

impl WallSurface {
    /// Of a wall with nodes at `reference` (mm) at rest.
    pub(super) fn new(
        points: &[ElementPoints],
        surface: &SampledSurface,
        reference: &[Vec3],
    ) -> Self {
        let thickness = surface.thickest();
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
        let centres: Vec<Vec3> = triangles.iter().map(centre).collect();
        let (tree, leaves) = BoxTree::of_places(&centres);
        let [straight, along] = NEIGHBOURHOOD.map(|distance| distance * thickness);
        let neighbours = Neighbours::new(&rest, edges.iter().map(|it| it.ends), straight, along);
        let mut made = Self {
            points: points.to_vec(),
            surface: surface.clone(),
            triangles,
            is_closed,
            neighbours,
            tree,
            leaves,
            room: vec![f64::INFINITY; rest.len()],
            rest,
            thickness,
            areas,
        };
        let pose = made.pose(reference, None);
        let reach = REACH_AT_REST * thickness;
        let mut room = std::mem::take(&mut made.room);
        made.visit_near(&pose, Search::of_points(reach), &mut |_, couple| {
            let room = &mut room[couple.samples[0] as usize];
            *room = room.min(couple.closest(&pose.samples).distance);
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
        let boxes_around = |x: &[Vec3]| self.fitted(&|t| self.triangles[t].box_around(x));
        let boxes = boxes_around(&samples);
        let is_moved = !motion.is_empty();
        let motion_boxes = if is_moved { boxes_around(&motion) } else { Vec::new() };
        let mut normals = <[Vec<Box3>; 2]>::default();
        if self.is_closed {
            normals[0] = self.normals(&samples);
            if is_moved {
                let there: Vec<Vec3> = samples.iter().zip(&motion).map(|(x, dx)| x + dx).collect();
                normals[1] = self.normals(&there);
            }
        }
        let facet = |facet: &[u32; 3]| Ball::around(&facet.map(|v| samples[v as usize]));
        let facets = self.surface.facets.iter().map(facet).collect();
        let (share, edges) = (Cell::new(1.0), OnceCell::new());
        Pose { samples, motion, share, boxes, motion_boxes, normals, facets, edges }
    }

    /// Calls `visit` with the two triangles of each couple that `search` is for in `pose`, and the couple; the order is
    /// always the same.
    pub(super) fn visit_near(
        &self,
        pose: &Pose,
        search: Search,
        visit: &mut dyn FnMut([u32; 2], Couple),
    ) {
        let near = |a: usize, b: usize| pose.nodes_may_meet(a, b, search);
        self.tree.pairs(&near, &mut |a, b| {
            let [a, b] = [a, b].map(|leaf| self.leaves[leaf.items().start]);
            self.visit_couples([a.min(b), a.max(b)], pose, search, visit);
        });
    }

    /// Half the thickness of the wall where it is thickest among `samples`, mm.
    fn half_thickness(&self, samples: &[u32]) -> f64 {
        let thickness = samples.iter().map(|&v| self.surface.thickness[v as usize]);
        0.5 * thickness.fold(0.0, f64::max)
    }

    /// How thick the wall counts for `couple`, and its distance at rest, mm.
    pub(super) fn thickness_of(&self, couple: &Couple) -> [f64; 2] {
        let room = match couple.kind {
            Kind::PointFacet { .. } => self.room[couple.samples[0] as usize],
            Kind::Edges { .. } => couple.closest(&self.rest).distance,
        };
        let [one, other] = couple.sides().map(|samples| self.half_thickness(samples));
        [(one + other).min(REST_SHARE * room), room]
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
        search: Search,
        visit: &mut dyn FnMut([u32; 2], Couple),
    ) {
        let [one, other] = [a, b].map(|t| &self.triangles[t as usize]);
        let closing = if pose.is_moving() {
            let [one, other] = [one, other].map(|triangle| triangle.box_around(&pose.motion));
            pose.share.get() * one.reach(&other)
        } else {
            0.0
        };
        let far = search.reach + closing;
        let sample = |point: u8| {
            let owner = if point < 6 { one } else { other };
            owner.samples[point as usize % 6]
        };
        let mut offer = |points: [u8; 4], kind: Kind, first: usize| {
            let samples = points.map(sample);
            let couple = Couple { points, samples, kind };
            if !self.neighbours.join(&samples[..first], &samples[first..])
                && couple.closest(&pose.samples).distance
                    < search.reach + pose.closing(&samples, first)
            {
                visit([a, b], couple);
            }
        };
        for (owner, at, facets, over, t) in [(one, 0, other, 6, b), (other, 6, one, 0, a)] {
            for &point in &owner.own_points {
                let point = at + point;
                let ball = Ball { centre: pose.samples[sample(point) as usize], radius: 0.0 };
                for (k, facet) in facets.facets.iter().enumerate() {
                    if ball.is_near(&pose.facets[4 * t as usize + k], far) {
                        let [i, j, k] = facet.corners.map(|corner| over + corner);
                        let kind = Kind::PointFacet { sides: facet.sides, tips: facet.tips };
                        offer([point, i, j, k], kind, 1);
                    }
                }
            }
        }
        if !search.has_edges {
            return;
        }
        let balls = pose.edges.get_or_init(|| self.edge_balls(&pose.samples));
        for (edge, ball) in one.own_edges.iter().zip(&balls[one.first_edge..]) {
            for (opposite, other_ball) in other.own_edges.iter().zip(&balls[other.first_edge..]) {
                if ball.is_near(other_ball, far) {
                    let ([i, j], [k, l]) = (edge.ends, opposite.ends.map(|end| 6 + end));
                    let kind = Kind::Edges { areas: [edge.area, opposite.area] };
                    offer([i, j, k, l], kind, 2);
                }
            }
        }
    }

    fn edge_balls(&self, x: &[Vec3]) -> Vec<Ball> {
        let of_triangle = |triangle: &Triangle| {
            let ends =
                |edge: &OwnEdge| edge.ends.map(|end| x[triangle.samples[end as usize] as usize]);
            triangle.own_edges.iter().map(|edge| Ball::around(&ends(edge))).collect::<Vec<_>>()
        };
        self.triangles.iter().flat_map(of_triangle).collect()
    }

    /// Boxes around the unit normals of the facets.
    fn normals(&self, x: &[Vec3]) -> Vec<Box3> {
        let of_triangle = |triangle: usize| {
            let facets = &self.surface.facets[4 * triangle..4 * triangle + 4];
            // Where a facet has no area anything may be its normal.
            Box3::around(facets.iter().map(|&facet| {
                let vector = area_vector(facet.map(|v| x[v as usize]));
                let length = vector.norm();
                if length > 0.0 { vector / length } else { Vec3::zeros() }
            }))
        };
        self.fitted(&of_triangle)
    }

    /// Boxes around what the nodes of the tree hold, from those of the triangles.
    fn fitted(&self, of_triangle: &dyn Fn(usize) -> Box3) -> Vec<Box3> {
        self.tree.fitted(&|leaf| of_triangle(self.leaves[leaf.start] as usize), &Box3::join)
    }
}

impl Couple {
    /// Its closest points where the samples are at `x`.
    pub(super) fn closest(&self, x: &[Vec3]) -> Closest {
        self.kind.closest(&self.samples.map(|v| x[v as usize]))
    }

    /// The samples of one part and of the other.
    fn sides(&self) -> [&[u32]; 2] {
        let (one, other) = self.samples.split_at(self.kind.first());
        [one, other]
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
    /// Whether triangles of two nodes of the tree may face each other and come within reach.
    fn nodes_may_meet(&self, a: usize, b: usize, search: Search) -> bool {
        let closing = if self.is_moving() {
            self.share.get() * self.motion_boxes[a].reach(&self.motion_boxes[b])
        } else {
            0.0
        };
        let largest = search.reach + closing;
        let [before, after] = &self.normals;
        let faces = |normals: &[Box3]| {
            !normals.is_empty() && normals[a].least_dot(&normals[b]) < search.facing
        };
        self.boxes[a].gap_squared(&self.boxes[b]) < largest * largest
            && (before.is_empty() || faces(before) || faces(after))
    }

    fn is_moving(&self) -> bool {
        !self.motion.is_empty()
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

impl Ball {
    fn around(x: &[Vec3]) -> Self {
        let centre = x.iter().sum::<Vec3>() / x.len() as f64;
        let squares = x.iter().map(|x| (x - centre).norm_squared());
        Self { centre, radius: squares.fold(0.0, f64::max).sqrt() }
    }

    fn is_near(&self, other: &Self, reach: f64) -> bool {
        let largest = reach + self.radius + other.radius;
        (self.centre - other.centre).norm_squared() < largest * largest
    }
}

/// The largest rate at which the `first` of four points that move by `dx`, and the others, come closer.
pub(super) fn closing_speed(dx: &[Vec3; 4], first: usize) -> f64 {
    // What moves both alike does not bring them closer.
    let common = dx.iter().sum::<Vec3>() / 4.0;
    let fastest = |dx: &[Vec3]| dx.iter().map(|dx| (dx - common).norm()).fold(0.0, f64::max);
    fastest(&dx[..first]) + fastest(&dx[first..])
}

fn area(x: &[Vec3], facet: [u32; 3]) -> f64 {
    area_vector(facet.map(|v| x[v as usize])).norm()
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
            first_edge: 0,
        }
    };
    let mut triangles: Vec<Triangle> = surface.facets.chunks_exact(4).map(triangle).collect();
    for edge in edges {
        let triangle = &mut triangles[edge.triangle as usize];
        let ends = edge.ends.map(|v| place_of(v, &triangle.samples));
        triangle.own_edges.push(OwnEdge { ends, area: edge.area });
    }
    let mut first_edge = 0;
    for triangle in &mut triangles {
        triangle.first_edge = first_edge;
        first_edge += triangle.own_edges.len();
    }
    triangles
}

fn place_of(sample: u32, samples: &[u32; 6]) -> u8 {
    let place = samples.iter().position(|&other| other == sample);
    place.expect("a facet's corners are its triangle's points") as u8
}
