//! Marching tetrahedra on a body-centred cubic lattice.
//!
//! Lattice nodes are the corners and the centres of equal cubes. Each pair of neighbouring centres
//! forms four tetrahedra with the edges of the face between them; one that changes sign contributes one
//! or two triangles, so the result is a closed, oriented 2-manifold whatever the field. Each vertex lies
//! on the zero level along its lattice edge. Triangles may be thin: `remesh` gives them their shape.
//!
//! Source: Doi and Koide (1991), IEICE Trans. E74(1); Chan and Purisima (1998), Computers & Graphics 22(1)
//! for the body-centred lattice.

use rayon::prelude::*;

use crate::field::ScalarField;
use crate::math::Vec3;

use super::TriangleMesh;

/// The zero level of `field` inside the box from `lower` to `upper` (mm), from cubes of about `step` mm.
///
/// Inside is where the value is negative; points beyond the box count as outside, so that the surface is
/// closed. The result is empty when no sample is inside. Its bits do not depend on the number of threads.
///
/// # Panics
/// When the box is empty, `step` is not a positive number, or the lattice has 2^32 edges or more.
#[must_use]
pub fn isosurface<F: ScalarField + ?Sized>(
    field: &F,
    lower: Vec3,
    upper: Vec3,
    step: f64,
) -> TriangleMesh {
    let lattice = Lattice::sampled(field, lower, upper, step);
    lattice.surface(&|ends, values| zero_between(field, ends, values))
}

/// As [`isosurface`], but with vertices where the zero would be if the field were linear along each lattice edge, as a distance
/// nearly is: no value but those at the lattice nodes is asked for. What comes within a step of the faces of the box is cut off
/// roughly.
///
/// # Panics
/// As [`isosurface`].
#[must_use]
pub fn interpolated_isosurface<F: ScalarField + ?Sized>(
    field: &F,
    lower: Vec3,
    upper: Vec3,
    step: f64,
) -> TriangleMesh {
    let lattice = Lattice::sampled(field, lower, upper, step);
    lattice.surface(&|ends, [a, b]| {
        let share = a / (a - b);
        between(ends, if share.is_finite() { share } else { 0.5 })
    })
}

/// Samples at cube corners and cube centres; `[x][y][z]` with z fastest, as many centres as corners (the
/// last layer of centres, beyond the last cube, is never inside).
struct Lattice {
    /// The first corner, mm.
    first: Vec3,
    /// The edges of a cube, mm.
    step: Vec3,
    /// Corners along each axis.
    nodes: [usize; 3],
    /// Distance in storage of neighbours along each axis.
    strides: [usize; 3],
    corners: Vec<f64>,
    centres: Vec<f64>,
}

/// Where a lattice edge between two points with two values crosses the zero level.
type Zero<'a> = dyn Fn([Vec3; 2], [f64; 2]) -> Vec3 + Sync + 'a;

/// Edges owned by index `p`: three between corners, three between centres, eight from centre to corner.
const EDGES_PER_NODE: usize = 14;
const CENTRE_EDGES: usize = 3;
const DIAGONALS: usize = 6;

/// The sides of the face between two centres: the bits of their corners along the two axes of the face,
/// counter-clockwise seen along the third.
const SIDES: [[[usize; 2]; 2]; 4] =
    [[[0, 0], [1, 0]], [[1, 0], [1, 1]], [[1, 1], [0, 1]], [[0, 1], [0, 0]]];

impl Lattice {
    /// Cubes are stretched by up to half a cube over the length of the box so that each face of the box
    /// lies a quarter of a cube inside a layer of centres: a flat cap never touches a lattice node.
    fn sampled<F: ScalarField + ?Sized>(field: &F, lower: Vec3, upper: Vec3, step: f64) -> Self {
        assert!(step > 0.0 && step.is_finite(), "the step must be a positive number, not {step}");
        assert!((0..3).all(|a| lower[a] < upper[a]), "the box {lower:?} .. {upper:?} is empty");
        let length = upper - lower;
        let cubes = length.map(|l| (l / step - 0.5).round().max(1.0));
        let step = length.zip_map(&cubes, |l, n| l / (n + 0.5));
        let nodes = [0, 1, 2].map(|a| cubes[a] as usize + 3);
        assert!(
            nodes.iter().map(|&n| n as f64).product::<f64>() * 14.0 < f64::from(u32::MAX),
            "a lattice of {nodes:?} nodes is too fine"
        );
        let strides = [nodes[1] * nodes[2], nodes[2], 1];
        let first = lower - 0.75 * step;
        let mut lattice = Self { first, step, nodes, strides, corners: vec![], centres: vec![] };
        lattice.corners = lattice.samples(field, lattice.first, [0, 0, 0]);
        lattice.centres = lattice.samples(field, lattice.first + 0.5 * step, [1, 1, 1]);
        lattice
    }

    /// The field at `first + index * step`; what lies beyond the box is made positive: the first layer and
    /// the last, and beyond them `missing` layers.
    fn samples<F: ScalarField + ?Sized>(
        &self,
        field: &F,
        first: Vec3,
        missing: [usize; 3],
    ) -> Vec<f64> {
        let [_, ny, nz] = self.nodes;
        let mut samples = vec![0.0; self.nodes.iter().product()];
        samples.par_chunks_mut(nz).enumerate().for_each(|(line, values)| {
            let index = [line / ny, line % ny];
            let beyond = |a: usize, i: usize| i == 0 || i + 1 + missing[a] >= self.nodes[a];
            if beyond(0, index[0]) || beyond(1, index[1]) {
                values.fill(f64::INFINITY);
                return;
            }
            let offset = Vec3::new(index[0] as f64, index[1] as f64, 0.0);
            field.values_along_z(first + offset.component_mul(&self.step), self.step.z, values);
            values[0] = f64::INFINITY;
            values[nz - 1 - missing[2]..].fill(f64::INFINITY);
        });
        samples
    }

    /// The surface whose vertex on a lattice edge with `ends` and `values` of unlike sign is at `zero(ends, values)`.
    fn surface(&self, zero: &Zero) -> TriangleMesh {
        let crossings: Vec<Vec<(u32, Vec3)>> =
            (0..self.nodes[0]).into_par_iter().map(|i| self.crossings(zero, i)).collect();

        let mut vertices = vec![u32::MAX; EDGES_PER_NODE * self.nodes.iter().product::<usize>()];
        let mut positions = Vec::with_capacity(crossings.iter().map(Vec::len).sum());
        for &(edge, position) in crossings.iter().flatten() {
            vertices[edge as usize] = positions.len() as u32;
            positions.push(position);
        }
        let triangles: Vec<Vec<[u32; 3]>> = (0..self.nodes[0])
            .into_par_iter()
            .map(|i| self.triangles(i, &vertices, &positions))
            .collect();
        TriangleMesh { positions, triangles: triangles.concat() }
    }

    fn corner_position(&self, p: usize) -> Vec3 {
        let [i, j, k] = self.index(p).map(|i| i as f64);
        self.first + Vec3::new(i, j, k).component_mul(&self.step)
    }

    fn centre_position(&self, p: usize) -> Vec3 {
        self.corner_position(p) + 0.5 * self.step
    }

    fn index(&self, p: usize) -> [usize; 3] {
        [p / self.strides[0], p / self.strides[1] % self.nodes[1], p % self.nodes[2]]
    }

    /// The storage positions of slab `x = i` that have a neighbour above along every axis.
    fn slab(&self, i: usize) -> impl Iterator<Item = usize> + '_ {
        let [nx, ny, nz] = self.nodes;
        let rows = if i + 1 < nx { 0..ny - 1 } else { 0..0 };
        rows.flat_map(move |j| {
            let row = i * self.strides[0] + j * self.strides[1];
            row..row + nz - 1
        })
    }

    /// The edges owned by slab `x = i` that change sign, each with its point on the zero level, mm.
    fn crossings(&self, zero: &Zero, i: usize) -> Vec<(u32, Vec3)> {
        let mut crossings = Vec::new();
        for p in self.slab(i) {
            let (corner, centre) = (self.corners[p], self.centres[p]);
            let mut visit = |edge: usize, [(a, fa), (b, fb)]: [(Position, f64); 2]| {
                if (fa < 0.0) != (fb < 0.0) {
                    let ends = [self.position(a), self.position(b)];
                    let point = zero(ends, [fa, fb]);
                    crossings.push(((EDGES_PER_NODE * p + edge) as u32, point));
                }
            };
            for (a, &stride) in self.strides.iter().enumerate() {
                let q = p + stride;
                let corners =
                    [(Position::Corner(p), corner), (Position::Corner(q), self.corners[q])];
                visit(a, corners);
                let centres =
                    [(Position::Centre(p), centre), (Position::Centre(q), self.centres[q])];
                visit(CENTRE_EDGES + a, centres);
            }
            for bits in 0..8 {
                let q = p + self.offset([bits & 1, bits >> 1 & 1, bits >> 2]);
                let ends = [(Position::Centre(p), centre), (Position::Corner(q), self.corners[q])];
                visit(DIAGONALS + bits, ends);
            }
        }
        crossings
    }

    fn position(&self, node: Position) -> Vec3 {
        match node {
            Position::Corner(p) => self.corner_position(p),
            Position::Centre(p) => self.centre_position(p),
        }
    }

    fn offset(&self, bits: [usize; 3]) -> usize {
        (0..3).map(|a| bits[a] * self.strides[a]).sum()
    }

    /// The triangles of the tetrahedra owned by slab `x = i`, over the vertex of each lattice edge.
    fn triangles(&self, i: usize, vertices: &[u32], positions: &[Vec3]) -> Vec<[u32; 3]> {
        let mut triangles = Vec::new();
        for p in self.slab(i) {
            for a in 0..3 {
                let q = p + self.strides[a];
                for side in 0..4 {
                    let inside = |value: f64| value < 0.0;
                    let [c, d] = self.side_corners(p, a, side);
                    let mask = [self.centres[p], self.centres[q], self.corners[c], self.corners[d]]
                        .map(inside);
                    if mask.iter().any(|&m| m != mask[0]) {
                        let edges = self.tetrahedron_edges(p, a, side).map(|e| vertices[e]);
                        push_triangles(mask, edges, positions, &mut triangles);
                    }
                }
            }
        }
        triangles
    }

    fn side_corners(&self, p: usize, axis: usize, side: usize) -> [usize; 2] {
        SIDES[side].map(|bits| p + self.offset(face_bits(axis, 1, bits)))
    }

    /// The edges 01, 02, 03, 12, 13, 23 of the tetrahedron (centre p, next centre along `axis`, side).
    fn tetrahedron_edges(&self, p: usize, axis: usize, side: usize) -> [usize; 6] {
        let q = p + self.strides[axis];
        let [c, d] = SIDES[side];
        let diagonal = |centre: usize, near: usize, corner: [usize; 2]| {
            let [x, y, z] = face_bits(axis, near, corner);
            EDGES_PER_NODE * centre + DIAGONALS + x + 2 * y + 4 * z
        };
        let lower_end = p + self.offset(face_bits(axis, 1, [c[0].min(d[0]), c[1].min(d[1])]));
        let along = if c[0] == d[0] { axis + 2 } else { axis + 1 };
        [
            EDGES_PER_NODE * p + CENTRE_EDGES + axis,
            diagonal(p, 1, c),
            diagonal(p, 1, d),
            diagonal(q, 0, c),
            diagonal(q, 0, d),
            EDGES_PER_NODE * lower_end + along % 3,
        ]
    }
}

#[derive(Clone, Copy)]
enum Position {
    Corner(usize),
    Centre(usize),
}

/// The bits along x, y, z of a corner with bit `near` along `axis` and `bits` along the next two axes.
fn face_bits(axis: usize, near: usize, bits: [usize; 2]) -> [usize; 3] {
    let mut xyz = [near; 3];
    xyz[(axis + 1) % 3] = bits[0];
    xyz[(axis + 2) % 3] = bits[1];
    xyz
}

/// The triangles of one positively oriented tetrahedron; `edges` holds the vertices on 01 02 03 12 13 23.
fn push_triangles(
    inside: [bool; 4],
    edges: [u32; 6],
    positions: &[Vec3],
    triangles: &mut Vec<[u32; 3]>,
) {
    let [e01, e02, e03, e12, e13, e23] = edges;
    let triangle = |inside_is_one: bool, [a, b, c]: [u32; 3]| {
        if inside_is_one { [a, b, c] } else { [a, c, b] }
    };
    let quad = match inside.map(u8::from) {
        [1, 0, 0, 0] | [0, 1, 1, 1] => {
            return triangles.push(triangle(inside[0], [e01, e02, e03]));
        }
        [0, 1, 0, 0] | [1, 0, 1, 1] => {
            return triangles.push(triangle(inside[1], [e01, e13, e12]));
        }
        [0, 0, 1, 0] | [1, 1, 0, 1] => {
            return triangles.push(triangle(inside[2], [e23, e02, e12]));
        }
        [0, 0, 0, 1] | [1, 1, 1, 0] => {
            return triangles.push(triangle(inside[3], [e23, e13, e03]));
        }
        [1, 1, 0, 0] => [e02, e03, e13, e12],
        [1, 0, 1, 0] => [e03, e01, e12, e23],
        [1, 0, 0, 1] => [e01, e02, e23, e13],
        [0, 1, 1, 0] => [e01, e13, e23, e02],
        [0, 1, 0, 1] => [e12, e01, e03, e23],
        [0, 0, 1, 1] => [e02, e12, e13, e03],
        _ => return,
    };
    let [a, b, c, d] = quad;
    let length = |v: u32, w: u32| (positions[v as usize] - positions[w as usize]).norm_squared();
    if length(a, c) <= length(b, d) {
        triangles.extend([[a, b, c], [a, c, d]]);
    } else {
        triangles.extend([[a, b, d], [b, c, d]]);
    }
}

/// A point of the zero level between `ends`, where the field has the values `values` of unlike sign:
/// regula falsi (Illinois), with a bisection in every third trial for fields that jump.
fn zero_between<F: ScalarField + ?Sized>(field: &F, ends: [Vec3; 2], values: [f64; 2]) -> Vec3 {
    let at = |t: f64| ends[0] + t * (ends[1] - ends[0]);
    let mut bracket = [(0.0, values[0]), (1.0, values[1])];
    let small = CLOSE_ENOUGH * values[0].min(values[1]).abs();
    let mut guess = 0.5;
    let mut replaced = None;
    for trial in 0..MOST_TRIALS {
        let [(s, fs), (t, ft)] = bracket;
        let secant = s - fs * (t - s) / (ft - fs);
        guess = if trial % 3 == 2 || !secant.is_finite() { 0.5 * (s + t) } else { secant };
        let value = field.value(at(guess));
        if value.abs() <= small || t - s < CLOSE_ENOUGH {
            break;
        }
        let end = usize::from((value < 0.0) != (fs < 0.0));
        bracket[end] = (guess, value);
        if replaced == Some(end) {
            bracket[1 - end].1 *= 0.5;
        }
        replaced = Some(end);
    }
    between(ends, guess)
}

/// The point at `share` of the way from end to end, but not at a node.
fn between(ends: [Vec3; 2], share: f64) -> Vec3 {
    ends[0] + share.clamp(NEAREST_TO_NODE, 1.0 - NEAREST_TO_NODE) * (ends[1] - ends[0])
}

/// Relative to the value at the inner end of a lattice edge, and to its length.
const CLOSE_ENOUGH: f64 = 1e-7;
/// A jump of the field is located by bisection to 2^-8 of an edge.
const MOST_TRIALS: usize = 24;
/// Keeps triangles from shrinking to a point at a lattice node, as a share of the lattice edge.
const NEAREST_TO_NODE: f64 = 0.01;

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::surface::test_fields::{Analytic, Ripples, capped, sphere, torus};

    fn in_box(field: &impl ScalarField, half: f64, step: f64) -> TriangleMesh {
        isosurface(field, Vec3::repeat(-half), Vec3::repeat(half), step)
    }

    #[test]
    fn sphere_converges_with_second_order() {
        let errors = |step| {
            let mesh = in_box(&sphere(10.0), 12.3, step);
            assert_eq!(mesh.check_closed_manifold(), Ok(()));
            assert_eq!(mesh.genus(), 0);
            let pi = std::f64::consts::PI;
            [1.0 - mesh.volume() / (4000.0 / 3.0 * pi), 1.0 - mesh.area() / (400.0 * pi)]
        };
        let (coarse, fine) = (errors(2.0), errors(1.0));
        for k in 0..2 {
            // Inscribed triangles: the error is positive; 3.5 leaves 13 % for the changing cut of the lattice.
            assert!(fine[k] > 0.0 && coarse[k] / fine[k] > 3.5, "{coarse:?} -> {fine:?}");
        }
    }

    #[test]
    fn vertices_lie_on_the_zero_level() {
        let field = torus(10.0, 4.0);
        let mesh = in_box(&field, 15.0, 1.1);
        assert_eq!(mesh.check_closed_manifold(), Ok(()));
        assert_eq!(mesh.genus(), 1);
        let off = |p: &&Vec3| field.value(**p).abs() > 1e-5;
        // Only vertices kept away from a lattice node, 1 % of an edge at either end, are off the level.
        let kept_away = mesh.positions.iter().filter(off).count();
        assert!(kept_away < mesh.positions.len() / 25, "{kept_away} of {}", mesh.positions.len());
        // 1 % of the longest lattice edge, the one between cube corners.
        let farthest = mesh.positions.iter().map(|&p| field.value(p).abs()).fold(0.0, f64::max);
        assert!(farthest < 0.012, "{farthest}");
    }

    #[test]
    fn interpolated_vertices_of_a_distance_are_near_its_level() {
        let field = sphere(10.0);
        let mesh = interpolated_isosurface(&field, Vec3::repeat(-12.0), Vec3::repeat(12.0), 1.0);
        assert_eq!(mesh.check_closed_manifold(), Ok(()));
        let farthest = mesh.positions.iter().map(|&p| field.value(p).abs()).fold(0.0, f64::max);
        // A distance bends by less than 1 / R across an edge of 1.05 mm: h^2 / 8 R; and 1 % of an edge at the nodes.
        assert!(farthest < 1.05_f64.powi(2) / 80.0 + 0.0105, "{farthest}");
    }

    #[test]
    fn caps_are_flat_at_the_box() {
        let tube = Analytic(|p: Vec3| p.x.hypot(p.y) - 4.0);
        let (lower, upper) = (Vec3::new(-6.0, -6.0, 0.0), Vec3::new(6.0, 6.0, 20.0));
        let mesh = isosurface(&capped(tube, lower, upper), lower, upper, 1.0);
        assert_eq!(mesh.check_closed_manifold(), Ok(()));
        let (low, high) = mesh.bounding_box().unwrap();
        assert!(low.z.abs() < 1e-6 && (high.z - 20.0).abs() < 1e-6, "{low:?} {high:?}");
    }

    #[test]
    fn open_fields_and_jumps_are_closed_too() {
        let everywhere = Analytic(|_| -1.0);
        let filled = in_box(&everywhere, 5.0, 1.0);
        assert_eq!(filled.check_closed_manifold(), Ok(()));
        let nowhere = Analytic(|_| f64::NAN);
        assert_eq!(in_box(&nowhere, 5.0, 1.0), TriangleMesh::default());
        let jump = Analytic(|p: Vec3| if p.norm() < 3.0 { -1e-3 } else { 1e3 });
        let ball = in_box(&jump, 5.0, 0.5);
        assert_eq!(ball.check_closed_manifold(), Ok(()));
        let farthest = ball.positions.iter().map(|p| (p.norm() - 3.0).abs()).fold(0.0, f64::max);
        assert!(farthest < 0.01 * 0.5, "{farthest}");
    }

    #[test]
    fn threads_do_not_change_a_bit() {
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| in_box(&Ripples::new(7, 9.0), 8.0, 0.7))
        };
        assert_eq!(on(1), on(2));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]
        #[test]
        fn rough_fields_give_closed_manifolds(seed: u64, waves in 3.0..14.0) {
            let mesh = in_box(&Ripples::new(seed, waves), 8.0, 1.0);
            prop_assert_eq!(mesh.check_closed_manifold(), Ok(()));
            let smallest = (0..mesh.triangles.len())
                .map(|t| mesh.area_vector(t).norm())
                .fold(f64::INFINITY, f64::min);
            // Edges are cut no nearer to a node than 1 %: half the product of two such cuts.
            prop_assert!(smallest > 1e-5, "smallest triangle {}", smallest);
        }
    }
}
