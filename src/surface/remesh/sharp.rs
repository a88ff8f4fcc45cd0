//! The sharp edges of a surface: what remeshing keeps, where they bend, and where they meet.
//!
//! An edge is sharp where its two triangles turn by more than an angle. Sharp edges that hang together over less than two of the
//! edges wanted are what a scanner's noise looks like: they are none. A vertex is a corner where one, three or more sharp edges
//! meet, or two that turn by more than 45 degrees.

use std::collections::{BTreeSet, HashSet};

use crate::math::{DisjointSets, Vec3, angle_between};
use crate::surface::facet_tree::{Facet, FacetTree};
use crate::surface::{HalfEdges, TriangleMesh};

/// Which edges of a triangulation are sharp, by their ends; kept up to date by its edits.
#[derive(Clone, Debug, Default)]
pub(super) struct SharpEdges {
    edges: HashSet<[u32; 2]>,
    /// Of the vertices that the original has.
    is_corner: Vec<bool>,
}

/// How many ways along sharp edges a vertex has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Freedom {
    /// On no sharp edge.
    Surface,
    /// On a sharp line, between these neighbours.
    Line([u32; 2]),
    Corner,
}

impl SharpEdges {
    /// The edges of `mesh` that turn by more than `angle` (degrees) and hang together over at least `length` (mm).
    pub(super) fn of(mesh: &TriangleMesh, surface: &HalfEdges, angle: f64, length: f64) -> Self {
        let turn = |h: u32| {
            let [m, n] = [h, surface.twin(h)].map(|h| mesh.area_vector(h as usize / 3));
            angle_between(m, n).to_degrees()
        };
        let sharp: Vec<[u32; 2]> = surface
            .edges()
            .filter(|&h| turn(h) > angle)
            .map(|h| [surface.origin(h), surface.destination(h)])
            .collect();
        let mut edges = Self::default();
        let at = |v: u32| mesh.positions[v as usize];
        for piece in pieces(&sharp, mesh.positions.len()) {
            let total: f64 = piece.iter().map(|&[a, b]| (at(b) - at(a)).norm()).sum();
            if total >= length {
                edges.edges.extend(piece.into_iter().map(key));
            }
        }
        let mut ends = vec![Vec::new(); mesh.positions.len()];
        for &[a, b] in &sharp {
            if edges.has(a, b) {
                ends[a as usize].push(b);
                ends[b as usize].push(a);
            }
        }
        let is_corner = |(v, ends): (usize, &Vec<u32>)| match ends[..] {
            [] => false,
            [a, b] => {
                let [to, from] = [mesh.positions[v] - at(a), at(b) - mesh.positions[v]];
                to.dot(&from) < STRAIGHTEST_CORNER * to.norm() * from.norm()
            }
            _ => true,
        };
        edges.is_corner = ends.iter().enumerate().map(is_corner).collect();
        edges
    }

    /// The edges by the new `numbers` of their ends, the lesser first.
    pub(super) fn renumbered(&self, numbers: &[u32]) -> BTreeSet<[u32; 2]> {
        self.edges.iter().map(|edge| key(edge.map(|v| numbers[v as usize]))).collect()
    }

    pub(super) fn is_empty(&self) -> bool {
        self.edges.is_empty()
    }

    /// The sharp edges of `mesh` as segments; none where there is no sharp edge.
    pub(super) fn segments(&self, mesh: &TriangleMesh) -> Option<FacetTree> {
        let mut edges: Vec<[u32; 2]> = self.edges.iter().copied().collect();
        edges.sort_unstable();
        let segment = |(number, edge): (u32, [u32; 2])| {
            let [a, b] = edge.map(|v| mesh.positions[v as usize]);
            Facet { number, corners: [a, b, b], normals: [Vec3::zeros(); 7] }
        };
        (!edges.is_empty()).then(|| FacetTree::new((0..).zip(edges).map(segment).collect()))
    }

    pub(super) fn has(&self, a: u32, b: u32) -> bool {
        self.edges.contains(&key([a, b]))
    }

    /// Where `v` of the `surface` may go.
    pub(super) fn freedom(&self, surface: &HalfEdges, v: u32) -> Freedom {
        if self.is_empty() {
            return Freedom::Surface;
        }
        let mut along = surface.ring(v).filter(|&w| self.has(v, w));
        match [along.next(), along.next(), along.next()] {
            [None, ..] => Freedom::Surface,
            [Some(a), Some(b), None] if !self.is_corner.get(v as usize).is_some_and(|is| *is) => {
                Freedom::Line([a, b])
            }
            _ => Freedom::Corner,
        }
    }

    /// Whether the origin of `h` may move to its destination: along a sharp line, or off none.
    pub(super) fn may_collapse(&self, surface: &HalfEdges, h: u32) -> bool {
        let (a, b) = (surface.origin(h), surface.destination(h));
        match self.freedom(surface, a) {
            Freedom::Surface => true,
            Freedom::Line(ends) => {
                let apexes = [h, surface.twin(h)].map(|h| surface.apex(h));
                ends.contains(&b) && !apexes.iter().any(|c| ends.contains(c))
            }
            Freedom::Corner => false,
        }
    }

    /// The edge from `a` to `b` is cut in two at `middle`.
    pub(super) fn split(&mut self, [a, b]: [u32; 2], middle: u32) {
        if self.edges.remove(&key([a, b])) {
            self.edges.extend([key([a, middle]), key([middle, b])]);
        }
    }

    /// The `ring` of `a` becomes that of `b`, one of it.
    pub(super) fn collapse(&mut self, a: u32, b: u32, ring: &[u32]) {
        for &w in ring {
            if self.edges.remove(&key([a, w])) && w != b {
                self.edges.insert(key([b, w]));
            }
        }
    }
}

/// What hangs together of the `edges` over `vertices`, in order of appearance.
fn pieces(edges: &[[u32; 2]], vertices: usize) -> Vec<Vec<[u32; 2]>> {
    let mut sets = DisjointSets::new(vertices);
    for &[a, b] in edges {
        sets.join(a, b);
    }
    let mut pieces: Vec<Vec<[u32; 2]>> = Vec::new();
    for (&edge, number) in edges.iter().zip(sets.numbers(edges.iter().map(|edge| edge[0]))) {
        if number as usize == pieces.len() {
            pieces.push(Vec::new());
        }
        pieces[number as usize].push(edge);
    }
    pieces
}

fn key([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// The triangles of a surface as they were given: where the vertices of new ones are put.
pub(super) struct Original {
    surface: FacetTree,
    /// None where nothing is sharp.
    lines: Option<FacetTree>,
}

impl Original {
    pub(super) fn new(mesh: &TriangleMesh, sharp: &SharpEdges) -> Self {
        let facet = |t: usize| Facet {
            number: t as u32,
            corners: mesh.corners(t),
            normals: [Vec3::zeros(); 7],
        };
        let surface = FacetTree::new((0..mesh.triangles.len()).map(facet).collect());
        Self { surface, lines: sharp.segments(mesh) }
    }

    /// The nearest point to `point` of the surface, or, of a vertex on a sharp line, of those lines.
    pub(super) fn nearest(&self, point: Vec3, freedom: Freedom) -> Vec3 {
        let tree = match (freedom, &self.lines) {
            (Freedom::Line(_), Some(lines)) => lines,
            _ => &self.surface,
        };
        tree.nearest(point, f64::INFINITY).point
    }

    /// The largest distance from the middles and corners of the triangles of `mesh` to the surface, mm.
    pub(super) fn farthest(&self, mesh: &TriangleMesh) -> f64 {
        let middles = (0..mesh.triangles.len()).map(|t| mesh.corners(t).iter().sum::<Vec3>() / 3.0);
        let distance = |p: Vec3| (self.nearest(p, Freedom::Surface) - p).norm();
        mesh.positions.iter().copied().chain(middles).map(distance).fold(0.0, f64::max)
    }
}

/// The cosine of 45 degrees.
const STRAIGHTEST_CORNER: f64 = std::f64::consts::FRAC_1_SQRT_2;

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, TAU};

    use super::*;
    use crate::surface::{RemeshSettings, SurfaceQuality, remesh_triangles};

    const SETTINGS: RemeshSettings = RemeshSettings { edge: 2.0, iterations: 10 };

    /// A prism of `n` sides between fans, radius 8 mm and 40 mm long, in `4 n` triangles.
    fn prism(n: u32) -> TriangleMesh {
        let corner = |k: u32| {
            let angle = TAU * f64::from(k / 2) / f64::from(n);
            Vec3::new(8.0 * angle.cos(), 8.0 * angle.sin(), 40.0 * f64::from(k % 2))
        };
        let positions = (0..2 * n).map(corner).chain([Vec3::zeros(), Vec3::z() * 40.0]).collect();
        let triangles = (0..n)
            .flat_map(|k| {
                let [a, b] = [2 * k, 2 * ((k + 1) % n)];
                [[a, b, b + 1], [a, b + 1, a + 1], [2 * n, b, a], [2 * n + 1, a + 1, b + 1]]
            })
            .collect();
        TriangleMesh { positions, triangles }
    }

    /// A square prism keeps its planes, edges and corners to the last digits, so its volume is exact.
    #[test]
    fn edges_and_corners_stay() {
        let given = prism(4);
        let mesh = remesh_triangles(&given, &SETTINGS, 40.0).unwrap().0;
        assert!((mesh.volume() / given.volume() - 1.0).abs() < 1e-12, "{}", mesh.volume());
        for corner in &given.positions[..8] {
            assert!(mesh.positions.contains(corner), "{corner}");
        }
        let quality = SurfaceQuality::of(&mesh).unwrap();
        assert!((0.9..1.1).contains(&(quality.edge_mean / 2.0)), "{quality:?}");
        // The remesher itself refuses valences other than 4..9 and radius ratios below 0.3.
        assert!(quality.radius_ratio_mean > 0.85, "{quality:?}");
        assert!((quality.area / given.area() - 1.0).abs() < 1e-12);
    }

    /// 48 needles of 40 x 1.05 mm: they leave no trace, and the rims are circles still.
    #[test]
    fn needles_and_fans_become_even() {
        let given = prism(48);
        let mesh = remesh_triangles(&given, &SETTINGS, 40.0).unwrap().0;
        assert_eq!(mesh.check_closed_manifold(), Ok(()));
        let quality = SurfaceQuality::of(&mesh).unwrap();
        assert!(quality.radius_ratio_mean > 0.85 && quality.edge_max < 4.0, "{quality:?}");
        // Chords of 2 mm around a radius of 8 mm take (h / R)^2 / 6 = 1.0 % of the section at most.
        let volume = PI * 64.0 * 40.0;
        assert!((0.985..1.0).contains(&(mesh.volume() / volume)), "{}", mesh.volume());
        let on_rim = |p: &&Vec3| (p.z == 0.0 || p.z == 40.0) && p.x.hypot(p.y) > 7.95;
        // Two rims of 50 mm in edges of 1.6 to 2.7 mm.
        let rim = mesh.positions.iter().filter(on_rim).count();
        assert!((37..=62).contains(&rim), "{rim}");
    }

    /// What turns sharply over less than two edges is noise.
    #[test]
    fn noise_has_no_sharp_lines() {
        let mut ball = TriangleMesh::sphere(8.0, 3);
        let surface = HalfEdges::try_from(&ball).unwrap();
        assert!(SharpEdges::of(&ball, &surface, 40.0, 4.0).is_empty());
        // One vertex pushed in: the edges about it turn sharply, over less than two edges of 8 mm.
        ball.positions[100] *= 0.85;
        let edges = |length| SharpEdges::of(&ball, &surface, 40.0, length);
        assert!(!edges(1.0).is_empty() && edges(16.0).is_empty());
    }
}
