//! The nearest point of many triangles, found in a tree of boxes around them.
//!
//! Source: Ericson (2005), Real-time collision detection, section 5.1.5.

use crate::math::{Box3, BoxTree, Node, Vec3};

/// Triangles, or segments as triangles with two equal corners, sorted by where they are.
#[derive(Clone, Debug)]
pub(super) struct FacetTree {
    tree: BoxTree,
    /// Around the facets of each node.
    boxes: Vec<Box3>,
    /// The number of each facet, in the order of the leaves.
    pub(super) numbers: Vec<u32>,
    /// Their corners.
    corners: Vec<[Vec3; 3]>,
    /// Normals of each facet's face, edges 01, 12, 20 and corners 0, 1, 2; not of unit length.
    pub(super) normals: Vec<[Vec3; 7]>,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Facet {
    /// By which it is told.
    pub(super) number: u32,
    pub(super) corners: [Vec3; 3],
    pub(super) normals: [Vec3; 7],
}

/// What the nearest point of a facet lies on: the place of its normal.
pub(super) type Feature = usize;
pub(super) const FACE: Feature = 0;
const EDGES: [Feature; 3] = [1, 2, 3];
const CORNERS: [Feature; 3] = [4, 5, 6];

/// The nearest point of the facets.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearest {
    pub(super) squared_distance: f64,
    pub(super) point: Vec3,
    pub(super) facet: usize,
    pub(super) feature: Feature,
}

impl FacetTree {
    /// # Panics
    /// When there is no facet.
    pub(super) fn new(mut facets: Vec<Facet>) -> Self {
        assert!(!facets.is_empty(), "there are facets");
        let tree = BoxTree::new(facets.len(), LEAF_SIZE);
        let mut boxes = vec![Box3::around([]); tree.nodes()];
        let centre =
            |facet: &Facet, axis| facet.corners.iter().map(|corner| corner[axis]).sum::<f64>();
        tree.sort(
            &mut facets,
            &mut |node, facets| {
                let corners = facets.iter().flat_map(|facet| facet.corners);
                boxes[node.index()] = Box3::around(corners);
                boxes[node.index()]
            },
            &|a, b, axis| centre(a, axis).total_cmp(&centre(b, axis)),
        );
        let numbers = facets.iter().map(|facet| facet.number).collect();
        let (corners, normals) =
            facets.into_iter().map(|facet| (facet.corners, facet.normals)).unzip();
        Self { tree, boxes, numbers, corners, normals }
    }

    /// The box around all, mm.
    pub(super) fn bounds(&self) -> Box3 {
        self.boxes[0]
    }

    /// The nearest point among those nearer than `bound`, which must exist.
    pub(super) fn nearest(&self, point: Vec3, bound: f64) -> Nearest {
        let start = (bound * (1.0 + SLACK) + SLACK).powi(2);
        let mut best =
            Nearest { squared_distance: start, point: self.boxes[0].low, facet: 0, feature: FACE };
        let mut open = Vec::with_capacity(DEEPEST);
        let root = self.tree.root().expect("there are facets");
        open.push((root, self.boxes[0].squared_distance(point)));
        while let Some((node, squared_distance)) = open.pop() {
            if squared_distance >= best.squared_distance {
                continue;
            }
            match self.tree.children(node) {
                None => {
                    for facet in node.items() {
                        let (nearest, feature) = nearest_on_triangle(point, self.corners[facet]);
                        let squared_distance = (point - nearest).norm_squared();
                        if squared_distance < best.squared_distance {
                            best = Nearest { squared_distance, point: nearest, facet, feature };
                        }
                    }
                }
                Some(children) => {
                    let away = |child: Node| self.boxes[child.index()].squared_distance(point);
                    let [a, b] =
                        [(children[0], away(children[0])), (children[1], away(children[1]))];
                    // The nearer one is looked at first.
                    let (near, far) = if a.1 <= b.1 { (a, b) } else { (b, a) };
                    if far.1 < best.squared_distance {
                        open.push(far);
                    }
                    if near.1 < best.squared_distance {
                        open.push(near);
                    }
                }
            }
        }
        best
    }

    /// Which ball about a point of the facets reaches nearest to `point`, if by less than `bound` (mm): the way that lacks, and the middle
    /// of the ball. Radii (mm) are given at the `corners` of each facet, linear between them, none above `most`.
    ///
    /// Of each facet the ball about its nearest point is looked at.
    pub(super) fn nearest_ball(
        &self,
        point: Vec3,
        bound: f64,
        corners: &[[f64; 3]],
        most: f64,
    ) -> Option<(f64, Vec3)> {
        let mut best = (bound, None);
        let mut open = Vec::with_capacity(DEEPEST);
        open.extend(self.tree.root());
        while let Some(node) = open.pop() {
            let to_box = self.boxes[node.index()].squared_distance(point).sqrt();
            if to_box - most >= best.0 {
                continue;
            }
            let Some(children) = self.tree.children(node) else {
                for facet in node.items() {
                    let (foot, _) = nearest_on_triangle(point, self.corners[facet]);
                    let way = (point - foot).norm();
                    if way - most < best.0 {
                        let lacks = way - self.at_foot(facet, foot, corners);
                        if lacks < best.0 {
                            best = (lacks, Some(foot));
                        }
                    }
                }
                continue;
            };
            open.extend(children);
        }
        best.1.map(|foot| (best.0, foot))
    }

    /// What is given at the `corners` of each facet, at a point of this one.
    pub(super) fn at_foot(&self, facet: usize, foot: Vec3, corners: &[[f64; 3]]) -> f64 {
        let [a, b, c] = self.corners[facet];
        let area = (b - a).cross(&(c - a));
        let share = |u: Vec3, v: Vec3| (u - foot).cross(&(v - foot)).dot(&area);
        let weights = [share(b, c), share(c, a), share(a, b)];
        let sum: f64 = weights.iter().sum();
        if sum > 0.0 {
            weights.iter().zip(corners[facet]).map(|(w, value)| w / sum * value).sum()
        } else {
            corners[facet].iter().sum::<f64>() / 3.0
        }
    }
}

/// The point of the triangle nearest to `p`, and what it lies on.
pub(super) fn nearest_on_triangle(p: Vec3, [a, b, c]: [Vec3; 3]) -> (Vec3, Feature) {
    let (ab, ac) = (b - a, c - a);
    let along = |from: Vec3| [ab.dot(&(p - from)), ac.dot(&(p - from))];
    let [d1, d2] = along(a);
    if d1 <= 0.0 && d2 <= 0.0 {
        return (a, CORNERS[0]);
    }
    let [d3, d4] = along(b);
    if d3 >= 0.0 && d4 <= d3 {
        return (b, CORNERS[1]);
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return (a + d1 / (d1 - d3) * ab, EDGES[0]);
    }
    let [d5, d6] = along(c);
    if d6 >= 0.0 && d5 <= d6 {
        return (c, CORNERS[2]);
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return (a + d2 / (d2 - d6) * ac, EDGES[2]);
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        let share = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return (b + share * (c - b), EDGES[1]);
    }
    let sum = va + vb + vc;
    (a + vb / sum * ab + vc / sum * ac, FACE)
}

/// Facets of one leaf.
const LEAF_SIZE: usize = 4;
/// Room for the branches that wait: one a level.
const DEEPEST: usize = 32;
/// What rounding may add to a bound, mm and relative.
const SLACK: f64 = 1e-9;
