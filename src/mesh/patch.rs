//! An open surface on a rectangular lattice, for parts that a formula describes.
//!
//! The surface `x(s, t)` is cut into `n x m` cells, and each cell into two triangles along its diagonal, so that every
//! vertex has six neighbours. One layer of nodes beyond the edges completes the neighbourhoods of the edges' own vertices:
//! there the formula is simply evaluated outside its range, which makes the subdivision surface as accurate at an
//! edge as inside.
//!
//! ```text
//! (0,m) - - (n,m)        t ^            vertices (i, j), 0 <= i <= n, 0 <= j <= m
//!   |  T1   |              |            beyond them i = -1, n + 1 or j = -1, m + 1
//!   S0     S1              +--> s       normal = x,s cross x,t
//!   |  T0   |
//! (0,0) - - (n,0)
//! ```

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Rings, Section, Stencil};
use crate::math::{Reason, Rejected, Room, Vec3};
use crate::surface::TriangleMesh;

/// A side of the lattice.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "lowercase")]
pub enum Side {
    /// Where `s` is least.
    S0,
    /// Where `s` is largest.
    S1,
    /// Where `t` is least.
    T0,
    /// Where `t` is largest.
    T1,
}

impl Side {
    /// All four.
    pub const ALL: [Self; 4] = [Self::S0, Self::S1, Self::T0, Self::T1];
}

/// A place on the lattice.
pub type Place = [isize; 2];

/// An edge of a triangle on a side of the patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BoundaryEdge {
    /// The side it lies on.
    pub side: Side,
    /// Its ends, in the order of its triangle.
    pub ends: [u32; 2],
    /// The third corner of its triangle.
    pub apex: u32,
    /// The node beyond it.
    pub beyond: u32,
    /// Its triangle.
    pub triangle: usize,
}

/// Layers of the lattice beyond the edges on which the formula is evaluated: one of nodes, two to fit them.
const LAYERS: isize = 3;

/// An open surface, meshed.
#[derive(Clone, Debug)]
pub struct Patch {
    cells: [usize; 2],
    s: [f64; 2],
    t: [f64; 2],
    /// Points of the surface on the lattice with [`LAYERS`] around it.
    points: Vec<Vec3>,
    /// The vertices and their triangles.
    pub surface: TriangleMesh,
    /// Ordered neighbours of every vertex; nodes beyond the edges have none.
    pub rings: Rings,
    /// The control points of every triangle.
    pub stencils: Vec<Stencil>,
    /// What the wall is made of.
    pub section: Section,
}

impl Patch {
    /// The surface `x(s, t)` over the ranges `s` and `t`, in `cells` along each.
    ///
    /// # Errors
    /// [`Rejected`] when `surface` is not finite somewhere, or a triangle has no area.
    ///
    /// # Panics
    /// When there is no cell, or a range is empty.
    pub fn new(
        cells: [usize; 2],
        s: [f64; 2],
        t: [f64; 2],
        thickness: f64,
        surface: &dyn Fn(f64, f64) -> Vec3,
    ) -> Result<Self, Rejected> {
        assert!(cells[0] > 0 && cells[1] > 0 && s[0] != s[1] && t[0] != t[1]);
        let mut patch = Self {
            cells,
            s,
            t,
            points: Vec::new(),
            surface: TriangleMesh { positions: Vec::new(), triangles: Vec::new() },
            rings: Rings::default(),
            stencils: Vec::new(),
            section: Section::uniform(thickness),
        };
        let at = |range: [f64; 2], k: isize, n: usize| {
            range[0] + (range[1] - range[0]) * k as f64 / n as f64
        };
        patch.points = patch
            .places(LAYERS)
            .map(|[i, j]| surface(at(s, i, cells[0]), at(t, j, cells[1])))
            .collect();
        if !patch.points.iter().all(|x| x.iter().all(|x| x.is_finite())) {
            return Err(rejected(
                "the formula is not finite on the patch, or just beyond its edges".into(),
            ));
        }
        patch.surface.positions = patch.places(0).map(|place| patch.point(place)).collect();
        let [n, m] = cells.map(|cells| cells as isize);
        for [i, j] in (0..m).flat_map(|j| (0..n).map(move |i| [i, j])) {
            let corner = |i: isize, j: isize| patch.node([i, j]);
            let [a, b, c, d] =
                [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
            patch.surface.triangles.extend([[a, b, c], [a, c, d]]);
        }
        for &triangle in &patch.surface.triangles {
            let [a, b, c] = triangle.map(|v| patch.surface.positions[v as usize]);
            let edges = [b - a, c - b, a - c].map(|edge| edge.norm());
            let longest = edges.into_iter().fold(0.0, f64::max);
            if (b - a).cross(&(c - a)).norm() <= 1e-9 * longest * longest {
                return Err(rejected(format!("a triangle at {a:.4?} has no area")));
            }
        }
        let ring = |[i, j]: Place| {
            NEIGHBOURS.iter().map(|[di, dj]| patch.node([i + di, j + dj])).collect()
        };
        patch.rings = Rings::from_ordered(patch.places(0).map(ring).collect());
        patch.stencils =
            patch.surface.triangles.iter().map(|&t| Stencil::new(t, &patch.rings)).collect();
        Ok(patch)
    }

    /// Cells along `s` and along `t`.
    #[must_use]
    pub fn cells(&self) -> [usize; 2] {
        self.cells
    }

    /// The number of vertices; their nodes come first.
    #[must_use]
    pub fn vertices(&self) -> usize {
        (self.cells[0] + 1) * (self.cells[1] + 1)
    }

    /// The number of nodes: vertices, and the layer beyond the edges.
    #[must_use]
    pub fn nodes(&self) -> usize {
        (self.cells[0] + 3) * (self.cells[1] + 3)
    }

    /// The vertex at `(s, t)`, where there is one.
    #[must_use]
    pub fn vertex(&self, s: f64, t: f64) -> Option<u32> {
        let index = |value: f64, range: [f64; 2], cells: usize| {
            let place = (value - range[0]) / (range[1] - range[0]) * cells as f64;
            let nearest = place.round();
            ((place - nearest).abs() < 1e-6 && (0.0..=cells as f64).contains(&nearest))
                .then_some(nearest as isize)
        };
        let place = [index(s, self.s, self.cells[0])?, index(t, self.t, self.cells[1])?];
        Some(self.node(place))
    }

    /// `s` and `t` of a vertex.
    ///
    /// # Panics
    /// When there is no such vertex.
    #[must_use]
    pub fn parameters(&self, vertex: u32) -> [f64; 2] {
        let vertex = vertex as usize;
        assert!(vertex < self.vertices(), "vertex {vertex} of {}", self.vertices());
        let columns = self.cells[0] + 1;
        let place = [vertex % columns, vertex / columns];
        let ranges = [self.s, self.t];
        std::array::from_fn(|k| {
            let [low, high] = ranges[k];
            low + (high - low) * place[k] as f64 / self.cells[k] as f64
        })
    }

    /// The node at a place on the lattice or one beyond it.
    ///
    /// # Panics
    /// When the place is further out.
    #[must_use]
    pub fn node(&self, [i, j]: Place) -> u32 {
        let [n, m] = self.cells.map(|cells| cells as isize);
        assert!((-1..=n + 1).contains(&i) && (-1..=m + 1).contains(&j));
        let index = if (0..=n).contains(&i) && (0..=m).contains(&j) {
            j * (n + 1) + i
        } else {
            // Around the lattice: below, above, left, right.
            let vertices = (n + 1) * (m + 1);
            match j {
                -1 => vertices + i + 1,
                _ if j == m + 1 => vertices + (n + 3) + i + 1,
                _ if i == -1 => vertices + 2 * (n + 3) + j,
                _ => vertices + 2 * (n + 3) + (m + 1) + j,
            }
        };
        index as u32
    }

    /// The places of all nodes, in the order of the nodes.
    #[must_use]
    pub fn node_places(&self) -> Vec<Place> {
        let mut places = vec![[0; 2]; self.nodes()];
        for place in self.places(1) {
            places[self.node(place) as usize] = place;
        }
        places
    }

    /// The point of the surface at a place on the lattice or one beyond it, mm.
    #[must_use]
    pub fn point(&self, place: Place) -> Vec3 {
        self.points[self.index(place, LAYERS)]
    }

    /// Unit normal of the surface at a place on the lattice, by central differences.
    #[must_use]
    pub fn normal(&self, [i, j]: Place) -> Vec3 {
        let along_s = self.point([i + 1, j]) - self.point([i - 1, j]);
        let along_t = self.point([i, j + 1]) - self.point([i, j - 1]);
        along_s.cross(&along_t).normalize()
    }

    /// Control points of all nodes whose subdivision surface passes through the vertices, mm.
    ///
    /// The limit is `L X = X / 2 + sum ring / 12`; with `D = 1 - L` the inverse is `1 + D + D^2 + ...`, of which the
    /// terms left out miss the surface by the sixth power of a cell's width.
    #[must_use]
    pub fn control_points(&self) -> Vec<Vec3> {
        let mut control = self.points.clone();
        let mut correction = self.points.clone();
        for layers in (1..LAYERS).rev() {
            let mut next = vec![Vec3::zeros(); correction.len()];
            for place in self.places(layers) {
                let at = |[di, dj]: &Place| {
                    correction[self.index([place[0] + di, place[1] + dj], LAYERS)]
                };
                let index = self.index(place, LAYERS);
                next[index] =
                    0.5 * correction[index] - NEIGHBOURS.iter().map(at).sum::<Vec3>() / 12.0;
                control[index] += next[index];
            }
            correction = next;
        }
        self.node_places().into_iter().map(|place| control[self.index(place, LAYERS)]).collect()
    }

    /// The edges on the sides.
    #[must_use]
    pub fn boundary_edges(&self) -> Vec<BoundaryEdge> {
        let [n, m] = self.cells.map(|cells| cells as isize);
        let mut edges = Vec::new();
        let mut push = |side, ends: [Place; 2], [i, j]: Place, triangle: isize| {
            let [a, b] = ends;
            let beyond = [a[0] + b[0] - i, a[1] + b[1] - j];
            edges.push(BoundaryEdge {
                side,
                ends: ends.map(|place| self.node(place)),
                apex: self.node([i, j]),
                beyond: self.node(beyond),
                triangle: triangle as usize,
            });
        };
        for j in 0..m {
            push(Side::S0, [[0, j + 1], [0, j]], [1, j + 1], 2 * j * n + 1);
            push(Side::S1, [[n, j], [n, j + 1]], [n - 1, j], 2 * (j * n + n - 1));
        }
        for i in 0..n {
            push(Side::T0, [[i, 0], [i + 1, 0]], [i + 1, 1], 2 * i);
            push(Side::T1, [[i + 1, m], [i, m]], [i, m - 1], 2 * ((m - 1) * n + i) + 1);
        }
        edges
    }

    /// Places with so many layers around the lattice, rows of `s` first.
    fn places(&self, layers: isize) -> impl Iterator<Item = Place> + use<> {
        let [n, m] = self.cells.map(|cells| cells as isize);
        (-layers..=m + layers).flat_map(move |j| (-layers..=n + layers).map(move |i| [i, j]))
    }

    fn index(&self, [i, j]: Place, layers: isize) -> usize {
        let width = self.cells[0] as isize + 1 + 2 * layers;
        ((j + layers) * width + i + layers) as usize
    }
}

/// Steps to the neighbours of a vertex, counter-clockwise.
const NEIGHBOURS: [Place; 6] = [[1, 0], [1, 1], [0, 1], [-1, 0], [-1, -1], [0, -1]];

fn rejected(detail: String) -> Rejected {
    Rejected::new(Room::Mesh, Reason::NoPatch, detail, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cylinder(cells: [usize; 2]) -> Patch {
        let surface = |s: f64, t: f64| Vec3::new(5.0 * t.cos(), 5.0 * t.sin(), s);
        Patch::new(cells, [0.0, 4.0], [0.0, 1.0], 0.1, &surface).unwrap()
    }

    #[test]
    fn nodes_are_numbered_once() {
        let patch = cylinder([3, 5]);
        let places = patch.node_places();
        assert_eq!(places.len(), patch.nodes());
        for (node, place) in places.iter().enumerate() {
            assert_eq!(patch.node(*place) as usize, node);
        }
        assert_eq!(patch.vertex(4.0, 0.4), Some(patch.node([3, 2])));
        assert_eq!(patch.parameters(patch.node([3, 2])), [4.0, 0.4]);
        assert_eq!(patch.vertex(1.0, 0.4), None);
        assert_eq!(patch.surface.positions[patch.node([1, 2]) as usize], patch.point([1, 2]));
    }

    #[test]
    fn boundary_edges_belong_to_their_triangles() {
        let patch = cylinder([3, 5]);
        let edges = patch.boundary_edges();
        assert_eq!(edges.len(), 2 * (3 + 5));
        for edge in edges {
            let triangle = patch.surface.triangles[edge.triangle];
            let turned = |k: usize| [0, 1, 2].map(|i| triangle[(k + i) % 3]);
            let [a, b] = edge.ends;
            assert!((0..3).any(|k| turned(k) == [a, b, edge.apex]), "{edge:?}");
            assert!(edge.beyond as usize >= patch.vertices());
        }
    }

    /// The limit surface misses the cylinder's vertices by the sixth power of the cells.
    #[test]
    fn limit_surface_passes_through_the_vertices() {
        let misses = [4, 8].map(|m| {
            let patch = cylinder([2, m]);
            let control = patch.control_points();
            let limit = |v: usize| {
                let ring = patch.rings.ring(v as u32).iter().map(|&w| control[w as usize]);
                0.5 * control[v] + ring.sum::<Vec3>() / 12.0
            };
            let miss = |v: usize| (limit(v) - patch.surface.positions[v]).norm();
            (0..patch.vertices()).map(miss).fold(0.0, f64::max)
        });
        let order = (misses[0] / misses[1]).log2();
        assert!((5.8..6.2).contains(&order), "{misses:?}");
    }
}
