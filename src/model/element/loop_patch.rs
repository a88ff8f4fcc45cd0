//! Loop's subdivision surface around one triangle, for any valence, without eigen-analysis.
//!
//! After one subdivision the middle child of a triangle has three corners of valence six: a regular
//! box-spline patch whose barycentre is the parent's barycentre. So every quadrature point is a barycentre,
//! reached by subdividing until its patch is regular, and the weights of the coarse control points follow
//! from matrix products alone. They depend on the three valences only.
//!
//! ```text
//! edge point    3/8 (v + q) + 1/8 (left + right)
//! vertex point  (1 - n beta) v + beta sum ring,   beta = (5/8 - (3/8 + cos(2 pi / n) / 4)^2) / n
//! limit point   (1 - n chi) v + chi sum ring,     chi = 1 / (3 / (8 beta) + n)
//! ```
//!
//! Source: Loop (1987); Cirak, Ortiz & Schröder (2000), section 4.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use super::box_spline;
use crate::mesh::Stencil;

/// Subdivisions behind the reference area of an element: 16 barycentres.
/// Five (1,024 points) move the area of a remeshed sphere by less than 0.1 %.
const AREA_LEVELS: usize = 2;

/// The weights of one element's control points, shared by all triangles with the same three valences.
#[derive(Clone, Debug)]
pub struct LoopBasis {
    /// `[,1 ,2 ,11 ,22 ,12]` of each control point at the barycentre.
    pub barycentre: Vec<[f64; 5]>,
    /// The quadrature.
    pub points: Vec<LoopPoint>,
    /// `[,1 ,2]` of each control point at the barycentres of the 16 grandchildren, with the share of
    /// `|x,1 cross x,2|` that each contributes to the area.
    area_points: Vec<(f64, Vec<[f64; 2]>)>,
    /// Limit positions of the corners (0, 1, 2) and of the edge midpoints opposite to them (3, 4, 5).
    pub limit: Vec<[f64; 6]>,
}

/// A point of quadrature of a Loop triangle.
#[derive(Clone, Debug)]
pub struct LoopPoint {
    /// The share of the element's area that it stands for.
    pub share: f64,
    /// Its barycentric weights.
    pub place: [f64; 3],
    /// `[,1 ,2 ,11 ,22 ,12]` of each control point there.
    pub rows: Vec<[f64; 5]>,
}

impl LoopBasis {
    /// The weights for a triangle whose corners have these valences (each at least 3).
    ///
    /// Control points are ordered as in [`Stencil`].
    #[must_use]
    pub fn new(valences: [usize; 3]) -> Self {
        let patch = Patch::coarse(valences);
        let mut area_points = Vec::new();
        patch.visit(AREA_LEVELS, &mut |leaf| {
            let (share, rows) = leaf.barycentre();
            area_points.push((share, transpose(&[&rows[0], &rows[1]])));
        });
        let [r1, r2, r11, r22, r12] = patch.barycentre().1;
        let limit: Vec<Row> =
            (0..3).map(|i| patch.limit_corner(i)).chain(patch.limit_edges()).collect();
        let barycentre = transpose(&[&r1, &r2, &r11, &r22, &r12]);
        Self {
            points: vec![LoopPoint { share: 1.0, place: [1.0 / 3.0; 3], rows: barycentre.clone() }],
            barycentre,
            area_points,
            limit: transpose(&std::array::from_fn::<_, 6, _>(|i| &limit[i])),
        }
    }

    /// The bases of all triangles, computed once for each combination of valences.
    #[must_use]
    pub fn of_stencils(stencils: &[Stencil]) -> Vec<std::rc::Rc<Self>> {
        let mut known = BTreeMap::new();
        let basis = |stencil: &Stencil| {
            known
                .entry(stencil.valences)
                .or_insert_with(|| std::rc::Rc::new(Self::new(stencil.valences)))
                .clone()
        };
        stencils.iter().map(basis).collect()
    }

    /// The weights for a triangle with valences of six, with three points of quadrature (exact for quadratics).
    #[must_use]
    pub fn with_three_points() -> Self {
        let third = |v: f64, w: f64| LoopPoint {
            share: 1.0 / 3.0,
            place: [1.0 - v - w, v, w],
            rows: Self::regular(v, w),
        };
        let (near, far) = (1.0 / 6.0, 2.0 / 3.0);
        Self {
            points: vec![third(near, near), third(far, near), third(near, far)],
            ..Self::new([6; 3])
        }
    }

    /// `[,1 ,2 ,11 ,22 ,12]` of each control point of a triangle with valences of six, where the second and the third corner
    /// have the weights `v` and `w`.
    #[must_use]
    pub fn regular(v: f64, w: f64) -> Vec<[f64; 5]> {
        let [r1, r2, r11, r22, r12] = Patch::coarse([6; 3]).regular(v, w);
        transpose(&[&r1, &r2, &r11, &r22, &r12])
    }

    /// The area of the element, mm^2, for control points at `x [n]`.
    #[must_use]
    pub fn area(&self, x: &[crate::math::Vec3]) -> f64 {
        let point_area = |(share, rows): &(f64, Vec<[f64; 2]>)| {
            let mut tangents = [crate::math::Vec3::zeros(); 2];
            for (x, row) in x.iter().zip(rows) {
                tangents[0] += x * row[0];
                tangents[1] += x * row[1];
            }
            share * tangents[0].cross(&tangents[1]).norm()
        };
        self.area_points.iter().map(point_area).sum()
    }
}

/// Weights on the coarse control points.
type Row = Vec<f64>;

/// A triangle of some level with its three ordered one-rings, as weights on the coarse control points.
///
/// `rings[i]` runs counter-clockwise around corner `i`, beginning with corners `i + 1` and `i + 2`.
struct Patch {
    corners: [Row; 3],
    rings: [Vec<Row>; 3],
}

impl Patch {
    fn coarse(valences: [usize; 3]) -> Self {
        let rings = Stencil::local_rings(valences);
        let size = Stencil::local_size(valences);
        let unit = |index: usize| {
            let mut row = vec![0.0; size];
            row[index] = 1.0;
            row
        };
        Self {
            corners: [0, 1, 2].map(unit),
            rings: rings.map(|ring| ring.into_iter().map(unit).collect()),
        }
    }

    fn valence(&self, i: usize) -> usize {
        self.rings[i].len()
    }

    /// The share of `|x,1 cross x,2|` that is the patch's area, and the derivative rows at its barycentre.
    fn barycentre(&self) -> (f64, [Row; 5]) {
        if (0..3).any(|i| self.valence(i) != 6) {
            let (share, rows) = self.middle_child().barycentre();
            return (4.0 * share, rows);
        }
        (0.5, self.regular(1.0 / 3.0, 1.0 / 3.0))
    }

    /// The derivative rows of a patch with valences of six.
    fn regular(&self, v: f64, w: f64) -> [Row; 5] {
        let [r0, r1, r2] = &self.rings;
        let control: [&Row; 12] = [
            &r0[4],
            &r0[3],
            &r0[5],
            &self.corners[0],
            &r0[2],
            &r1[3],
            &self.corners[1],
            &self.corners[2],
            &r2[4],
            &r1[4],
            &r1[5],
            &r2[3],
        ];
        let basis = box_spline::derivatives(v, w);
        let row = |k: usize| {
            combination(control.iter().zip(&basis).map(|(row, weights)| (weights[k], *row)))
        };
        std::array::from_fn(row)
    }

    /// Calls `visit` with the patches of all descendants `levels` down.
    fn visit(&self, levels: usize, visit: &mut impl FnMut(&Self)) {
        if levels == 0 {
            return visit(self);
        }
        self.middle_child().visit(levels - 1, visit);
        for i in 0..3 {
            self.corner_child(i).visit(levels - 1, visit);
        }
    }

    fn middle_child(&self) -> Self {
        Self {
            corners: [0, 1, 2].map(|i| self.edge_midpoint(i)),
            rings: [0, 1, 2].map(|i| self.edge_ring(i)),
        }
    }

    /// The child at corner `i`, whose own corner 0 is that corner.
    fn corner_child(&self, i: usize) -> Self {
        let [j, k] = [(i + 1) % 3, (i + 2) % 3];
        // Edge k runs from corner i to corner j, edge j from corner k to corner i.
        let mut around_k = self.edge_ring(k);
        let mut around_j = self.edge_ring(j);
        let start_of = |ring: &[Row], row: &Row| {
            ring.iter().position(|r| r == row).expect("the ring holds its neighbours")
        };
        let corner = self.vertex_point(i);
        let first = start_of(&around_k, &self.edge_midpoint(j));
        around_k.rotate_left(first);
        let first = start_of(&around_j, &corner);
        around_j.rotate_left(first);
        let spokes = (0..self.valence(i)).map(|spoke| self.edge_point(i, spoke)).collect();
        Self {
            corners: [corner, self.edge_midpoint(k), self.edge_midpoint(j)],
            rings: [spokes, around_k, around_j],
        }
    }

    /// The ring of the midpoint of the edge opposite to corner `i`, beginning with the other two midpoints.
    fn edge_ring(&self, i: usize) -> Vec<Row> {
        let [j, k] = [(i + 1) % 3, (i + 2) % 3];
        vec![
            self.edge_midpoint(j),
            self.edge_midpoint(k),
            self.vertex_point(j),
            self.edge_point(j, self.valence(j) - 1),
            self.edge_point(k, 2),
            self.vertex_point(k),
        ]
    }

    /// The new vertex on the edge opposite to corner `i`.
    fn edge_midpoint(&self, i: usize) -> Row {
        self.edge_point((i + 1) % 3, 0)
    }

    /// The new vertex on the edge from corner `i` to the `spoke`-th point of its ring.
    fn edge_point(&self, i: usize, spoke: usize) -> Row {
        let ring = &self.rings[i];
        let n = ring.len();
        combination([
            (0.375, &self.corners[i]),
            (0.375, &ring[spoke]),
            (0.125, &ring[(spoke + n - 1) % n]),
            (0.125, &ring[(spoke + 1) % n]),
        ])
    }

    fn vertex_point(&self, i: usize) -> Row {
        self.ring_average(i, beta(self.valence(i)))
    }

    fn limit_corner(&self, i: usize) -> Row {
        self.ring_average(i, limit_weight(self.valence(i)))
    }

    fn limit_edges(&self) -> [Row; 3] {
        let child = self.middle_child();
        [0, 1, 2].map(|i| child.limit_corner(i))
    }

    fn ring_average(&self, i: usize, weight: f64) -> Row {
        let n = self.valence(i) as f64;
        let ring = self.rings[i].iter().map(|row| (weight, row));
        combination(std::iter::once((1.0 - n * weight, &self.corners[i])).chain(ring))
    }
}

/// Loop's weight of each neighbour in a vertex point of valence `n`.
fn beta(n: usize) -> f64 {
    let n = n as f64;
    (0.625 - (0.375 + 0.25 * (TAU / n).cos()).powi(2)) / n
}

/// The weight of each neighbour in the limit position of a vertex of valence `n`.
#[must_use]
pub(super) fn limit_weight(n: usize) -> f64 {
    1.0 / (0.375 / beta(n) + n as f64)
}

fn combination<'a>(terms: impl IntoIterator<Item = (f64, &'a Row)>) -> Row {
    let mut sum = Row::new();
    for (weight, row) in terms {
        sum.resize(row.len(), 0.0);
        for (sum, value) in sum.iter_mut().zip(row) {
            *sum += weight * value;
        }
    }
    sum
}

fn transpose<const N: usize>(rows: &[&Row; N]) -> Vec<[f64; N]> {
    (0..rows[0].len()).map(|i| std::array::from_fn(|k| rows[k][i])).collect()
}

/// The control points of a regular triangle of edge 1 with corners (0, 0), (1, 0), (1/2, 0.75f64.sqrt()).
#[cfg(test)]
pub(super) fn regular_lattice() -> Vec<crate::math::Vec3> {
    use crate::math::Vec3;

    let direction = |sixths: usize| {
        let angle = TAU * sixths as f64 / 6.0;
        Vec3::new(angle.cos(), angle.sin(), 0.0)
    };
    let mut points = vec![Vec3::zeros(); Stencil::local_size([6; 3])];
    (points[1], points[2]) = (direction(0), direction(1));
    // The ring of corner i begins at corner i + 1, seen in the direction of 120 i degrees.
    for (i, ring) in Stencil::local_rings([6; 3]).iter().enumerate() {
        for (k, &index) in ring.iter().enumerate() {
            points[index] = points[i] + direction(2 * i + k);
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;
    use crate::mesh::{Rings, Section};
    use crate::model::element::{ElementPoints, SampledSurface};
    use crate::model::test_shells::TestShell;

    /// Constant functions are reproduced for all valences: derivatives sum to 0, limit weights to 1.
    #[test]
    fn weights_sum_to_zero_and_one() {
        for valences in (0..343).map(|k| [3 + k % 7, 3 + k / 7 % 7, 3 + k / 49]) {
            let basis = LoopBasis::new(valences);
            // Some fifty products of numbers up to 10.
            for k in 0..5 {
                let sum: f64 = basis.barycentre.iter().map(|row| row[k]).sum();
                assert!(sum.abs() < 1e-13, "{valences:?}: {sum:e}");
            }
            for k in 0..6 {
                let sum: f64 = basis.limit.iter().map(|row| row[k]).sum();
                assert!((sum - 1.0).abs() < 1e-14, "{valences:?}: {sum:e}");
            }
            for (_, rows) in &basis.area_points {
                let sum: f64 = rows.iter().map(|row| row[0] + row[1]).sum();
                assert!(sum.abs() < 1e-13, "{valences:?}: {sum:e}");
            }
        }
    }

    /// A regular flat patch is reproduced as it is.
    #[test]
    fn regular_lattice_is_its_own_limit() {
        let x = regular_lattice();
        let basis = LoopBasis::new([6; 3]);
        let sum = |weight: &dyn Fn(usize) -> f64| -> Vec3 {
            x.iter().enumerate().map(|(i, x)| weight(i) * x).sum()
        };
        let corners = [x[0], x[1], x[2]];
        for k in 0..3 {
            let [a, b, c] = [0, 1, 2].map(|i| corners[(k + i) % 3]);
            assert!((sum(&|i| basis.limit[i][k]) - a).norm() < 1e-15);
            assert!((sum(&|i| basis.limit[i][3 + k]) - (b + c) / 2.0).norm() < 1e-15);
        }
        let edges = [x[1] - x[0], x[2] - x[0]];
        for (k, exact) in edges.into_iter().chain([Vec3::zeros(); 3]).enumerate() {
            assert!((sum(&|i| basis.barycentre[i][k]) - exact).norm() < 1e-14);
        }
        assert!((basis.area(&x) - 0.1875_f64.sqrt()).abs() < 1e-15);
    }

    /// Loop's scheme once, by its textbook masks; the edge points in the order of [`SampledSurface`].
    fn subdivided(triangles: &[[u32; 3]], x: &[Vec3]) -> (Vec<[u32; 3]>, Vec<Vec3>) {
        let rings = Rings::new(x.len(), triangles).unwrap();
        let at = |v: u32| x[v as usize];
        let vertex_point = |v: u32| {
            let ring = rings.ring(v);
            let n = ring.len() as f64;
            let weight = (0.625 - (0.375 + (TAU / n).cos() / 4.0).powi(2)) / n;
            at(v) * (1.0 - n * weight) + weight * ring.iter().map(|&w| at(w)).sum::<Vec3>()
        };
        let mut fine: Vec<Vec3> = (0..x.len() as u32).map(vertex_point).collect();
        let mut edges = BTreeMap::new();
        let mut children = Vec::new();
        for &triangle in triangles {
            let middle: [u32; 3] = std::array::from_fn(|i| {
                let [a, b] = [triangle[(i + 1) % 3], triangle[(i + 2) % 3]];
                *edges.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                    let ring = rings.ring(a);
                    let k = ring.iter().position(|&v| v == b).unwrap();
                    let n = ring.len();
                    let sides = at(ring[(k + 1) % n]) + at(ring[(k + n - 1) % n]);
                    fine.push(0.375 * (at(a) + at(b)) + 0.125 * sides);
                    fine.len() as u32 - 1
                })
            });
            let [a, b, c] = triangle;
            let [bc, ca, ab] = middle;
            children.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], middle]);
        }
        (children, fine)
    }

    fn elements(triangles: &[[u32; 3]], vertices: usize) -> (Vec<Stencil>, Rings) {
        let rings = Rings::new(vertices, triangles).unwrap();
        (triangles.iter().map(|&t| Stencil::new(t, &rings)).collect(), rings)
    }

    fn limit_points(triangles: &[[u32; 3]], x: &[Vec3]) -> Vec<Vec3> {
        let (stencils, _) = elements(triangles, x.len());
        let bases = LoopBasis::of_stencils(&stencils);
        let points = ElementPoints::of_stencils(&stencils, &bases);
        SampledSurface::new(triangles, &points, x.len(), &Section::uniform(1.0)).at(x)
    }

    /// A mesh and its subdivisions have the same limit points, and each vertex comes nearer to its own in powers
    /// of `(3/8 + cos(2 pi / n) / 4)^2`.
    #[test]
    fn limit_points_are_those_of_deep_subdivision() {
        const LEVELS: i32 = 5;
        for seed in 0..2 {
            let shell = TestShell::new(seed);
            let rings = &shell.mesh.rings;
            let (mut triangles, mut x) = (shell.mesh.surface.triangles, shell.deformed.clone());
            let limit = limit_points(&triangles, &x);
            for level in 0..LEVELS {
                (triangles, x) = subdivided(&triangles, &x);
                if level < 2 {
                    let same = limit_points(&triangles, &x);
                    // A few roundings of coordinates of 10 mm.
                    assert!(limit.iter().zip(&same).all(|(a, b)| (a - b).norm() < 1e-13));
                }
            }
            for (v, (start, limit)) in shell.deformed.iter().zip(&limit).enumerate() {
                let n = rings.ring(v as u32).len() as f64;
                let rate = (0.375 + (TAU / n).cos() / 4.0).powi(2 * LEVELS);
                assert!((start - limit).norm() > 0.1);
                assert!((x[v] - limit - rate * (start - limit)).norm() < 1e-13, "vertex {v}");
            }
        }
    }

    /// The middle child of an element has its barycentre; where the element is regular, at half the scale.
    #[test]
    fn derivatives_are_those_of_the_middle_child() {
        let shell = TestShell::new(2);
        let triangles = &shell.mesh.surface.triangles;
        let (children, fine) = subdivided(triangles, &shell.deformed);
        let (stencils, _) = elements(&children, fine.len());
        let derivatives = |stencil: &Stencil, x: &[Vec3]| -> [Vec3; 5] {
            let basis = LoopBasis::new(stencil.valences);
            let pairs = || stencil.nodes.iter().zip(&basis.barycentre);
            std::array::from_fn(|k| pairs().map(|(&v, row)| row[k] * x[v as usize]).sum())
        };
        for (t, stencil) in shell.mesh.stencils.iter().enumerate() {
            let middle = &stencils[4 * t + 3];
            assert_eq!(middle.valences, [6; 3]);
            let scale = if stencil.valences == [6; 3] { -0.5 } else { 1.0 };
            let (whole, part) = (derivatives(stencil, &shell.deformed), derivatives(middle, &fine));
            for (k, (whole, part)) in whole.iter().zip(&part).enumerate() {
                let scale = if k < 2 { scale } else { scale * scale };
                assert!((scale * whole - part).norm() < 1e-13, "element {t}, derivative {k}");
            }
        }
    }
}
