//! The nearest point of many triangles, found in a tree of boxes around them.
//!
//! Source: Ericson (2005), Real-time collision detection, section 5.1.5.

use crate::math::Vec3;

/// Triangles, or segments as triangles with two equal corners, sorted by where they are.
#[derive(Clone, Debug)]
pub(super) struct FacetTree {
    /// Boxes in depth-first order: the first child of a branch follows it.
    boxes: Vec<TreeBox>,
    /// Corners of the facets, in the order of the leaves.
    corners: Vec<[Vec3; 3]>,
    /// Normals of each facet's face, edges 01, 12, 20 and corners 0, 1, 2; not of unit length.
    pub(super) normals: Vec<[Vec3; 7]>,
}

/// The box around some facets.
#[derive(Clone, Copy, Debug)]
struct TreeBox {
    lower: Vec3,
    upper: Vec3,
    content: Content,
}

#[derive(Clone, Copy, Debug)]
enum Content {
    /// The place of the second child.
    Branch(u32),
    /// The range of facets.
    Leaf(u32, u32),
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Facet {
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
        let mut boxes = Vec::with_capacity(facets.len());
        grow(&mut facets, 0, &mut boxes);
        let (corners, normals) =
            facets.into_iter().map(|facet| (facet.corners, facet.normals)).unzip();
        Self { boxes, corners, normals }
    }

    /// The lower and upper corner of the box around all, mm.
    pub(super) fn bounds(&self) -> (Vec3, Vec3) {
        (self.boxes[0].lower, self.boxes[0].upper)
    }

    /// The nearest point among those nearer than `bound`, which must exist.
    pub(super) fn nearest(&self, point: Vec3, bound: f64) -> Nearest {
        let start = (bound * (1.0 + SLACK) + SLACK).powi(2);
        let mut best = Nearest {
            squared_distance: start,
            point: self.boxes[0].lower,
            facet: 0,
            feature: FACE,
        };
        let mut open = Vec::with_capacity(DEEPEST);
        open.push((0, self.boxes[0].squared_distance(point)));
        while let Some((at, squared_distance)) = open.pop() {
            if squared_distance >= best.squared_distance {
                continue;
            }
            match self.boxes[at].content {
                Content::Leaf(first, end) => {
                    for facet in first as usize..end as usize {
                        let (nearest, feature) = nearest_on_triangle(point, self.corners[facet]);
                        let squared_distance = (point - nearest).norm_squared();
                        if squared_distance < best.squared_distance {
                            best = Nearest { squared_distance, point: nearest, facet, feature };
                        }
                    }
                }
                Content::Branch(second) => {
                    let children = [at + 1, second as usize]
                        .map(|child| (child, self.boxes[child].squared_distance(point)));
                    let [a, b] = children;
                    open.extend(if a.1 <= b.1 { [b, a] } else { [a, b] });
                }
            }
        }
        best
    }
}

impl TreeBox {
    fn squared_distance(&self, point: Vec3) -> f64 {
        (self.lower - point).sup(&(point - self.upper)).sup(&Vec3::zeros()).norm_squared()
    }
}

/// Sorts `facets`, the first of which is number `first`, into halves along the longer side of their box, and appends the boxes.
fn grow(facets: &mut [Facet], first: u32, boxes: &mut Vec<TreeBox>) {
    let (lower, upper) = facets
        .iter()
        .flat_map(|facet| facet.corners)
        .map(|corner| (corner, corner))
        .reduce(|(lower, upper), (p, _)| (lower.inf(&p), upper.sup(&p)))
        .expect("there are facets");
    let at = boxes.len();
    let leaf = Content::Leaf(first, first + facets.len() as u32);
    boxes.push(TreeBox { lower, upper, content: leaf });
    if facets.len() <= LEAF_SIZE {
        return;
    }
    let axis = (upper - lower).imax();
    let centre = |facet: &Facet| facet.corners.iter().map(|corner| corner[axis]).sum::<f64>();
    let half = facets.len() / 2;
    facets.select_nth_unstable_by(half, |a, b| centre(a).total_cmp(&centre(b)));
    let (left, right) = facets.split_at_mut(half);
    grow(left, first, boxes);
    boxes[at].content = Content::Branch(boxes.len() as u32);
    grow(right, first + half as u32, boxes);
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
