//! How good are the triangles? The figures that a report prints and `remesh` holds itself to.

use serde::Serialize;

use crate::math::{Vec3, angle_between};

use super::{HalfEdges, MeshDefect, TriangleMesh};

/// Size and shape of the triangles of a closed surface. It says nothing about intersections.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SurfaceQuality {
    /// Number of vertices.
    pub vertices: usize,
    /// Number of triangles.
    pub triangles: usize,
    /// Shortest edge, mm.
    pub edge_min: f64,
    /// Mean edge, mm.
    pub edge_mean: f64,
    /// Longest edge, mm.
    pub edge_max: f64,
    /// Standard deviation of the edge lengths over their mean.
    pub edge_variation: f64,
    /// Smallest radius ratio ([`radius_ratio`]).
    pub radius_ratio_min: f64,
    /// Mean radius ratio.
    pub radius_ratio_mean: f64,
    /// Fewest edges at a vertex.
    pub valence_min: usize,
    /// Most edges at a vertex.
    pub valence_max: usize,
    /// Number of vertices with valence 0, 1, 2, ..., `[valence_max + 1]`.
    pub valence_counts: Vec<usize>,
    /// Largest angle between the normals of neighbouring triangles, degrees.
    pub dihedral_max: f64,
    /// Number of edges whose ends share more than two neighbours: they belong to a neck of three edges.
    pub neck_edges: usize,
    /// Surface area, mm^2.
    pub area: f64,
    /// Enclosed volume, mm^3.
    pub volume: f64,
    /// Number of handles.
    pub genus: usize,
}

impl SurfaceQuality {
    /// The figures of `mesh`.
    ///
    /// # Errors
    /// [`MeshDefect`] unless the triangles form a closed, consistently oriented 2-manifold.
    pub fn of(mesh: &TriangleMesh) -> Result<Self, MeshDefect> {
        let surface = HalfEdges::try_from(mesh)?;
        let position = |v: u32| mesh.positions[v as usize];
        let lengths: Vec<f64> = surface
            .edges()
            .map(|h| (position(surface.destination(h)) - position(surface.origin(h))).norm())
            .collect();
        let edge_mean = mean(&lengths);
        let spread = lengths.iter().map(|l| (l - edge_mean).powi(2)).sum::<f64>();

        let ratios: Vec<f64> =
            (0..mesh.triangles.len()).map(|t| radius_ratio(mesh.corners(t))).collect();
        let bend = |h: u32| {
            let [m, n] = [h, surface.twin(h)].map(|h| mesh.area_vector(h as usize / 3));
            angle_between(m, n).to_degrees()
        };

        let mut valence_counts = vec![];
        for v in 0..mesh.positions.len() as u32 {
            let valence = surface.valence(v);
            valence_counts.resize(valence_counts.len().max(valence + 1), 0);
            valence_counts[valence] += 1;
        }
        Ok(Self {
            vertices: mesh.positions.len(),
            triangles: mesh.triangles.len(),
            edge_min: smallest(&lengths),
            edge_mean,
            edge_max: lengths.iter().copied().fold(0.0, f64::max),
            edge_variation: (spread / lengths.len() as f64).sqrt() / edge_mean,
            radius_ratio_min: smallest(&ratios),
            radius_ratio_mean: mean(&ratios),
            valence_min: valence_counts.iter().position(|&n| n > 0).unwrap_or(0),
            valence_max: valence_counts.len() - 1,
            valence_counts,
            dihedral_max: surface.edges().map(bend).fold(0.0, f64::max),
            neck_edges: surface.edges().filter(|&h| surface.shared_neighbours(h) > 2).count(),
            area: mesh.area(),
            volume: mesh.volume(),
            genus: mesh.genus(),
        })
    }
}

/// Twice the inscribed over the circumscribed radius of a triangle: 1 if equilateral, 0 if degenerate.
///
/// ```text
/// 2 r / R = 16 A^2 / (a b c (a + b + c))
/// ```
#[must_use]
pub fn radius_ratio([p, q, r]: [Vec3; 3]) -> f64 {
    let (a, b, c) = ((q - p).norm(), (r - q).norm(), (p - r).norm());
    let area_vector = (q - p).cross(&(r - p)) / 2.0;
    let bound = a * b * c * (a + b + c);
    if bound > 0.0 { 16.0 * area_vector.norm_squared() / bound } else { 0.0 }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn smallest(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    #[test]
    fn radius_ratio_of_known_triangles() {
        let o = Vec3::zeros();
        let equilateral = [o, Vec3::x(), Vec3::new(0.5, 0.75f64.sqrt(), 0.0)];
        assert_relative_eq!(radius_ratio(equilateral), 1.0, max_relative = 1e-14);
        // Legs 1: r = 1 - sqrt(1/2), R = sqrt(1/2).
        let right = radius_ratio([o, Vec3::x(), Vec3::y()]);
        assert_relative_eq!(right, 2.0 * (2f64.sqrt() - 1.0), max_relative = 1e-14);
        assert_eq!(radius_ratio([o, Vec3::x(), 2.0 * Vec3::x()]), 0.0);
        assert_eq!(radius_ratio([o, o, o]), 0.0);
    }

    #[test]
    fn figures_of_an_octahedron() {
        let positions = [Vec3::x(), Vec3::y(), Vec3::z()];
        let positions: Vec<Vec3> = positions.iter().flat_map(|&e| [2.0 * e, -2.0 * e]).collect();
        let triangles = vec![
            [0, 2, 4],
            [2, 1, 4],
            [1, 3, 4],
            [3, 0, 4],
            [2, 0, 5],
            [1, 2, 5],
            [3, 1, 5],
            [0, 3, 5],
        ];
        let quality = SurfaceQuality::of(&TriangleMesh { positions, triangles }).unwrap();
        assert_eq!(quality.valence_counts, [0, 0, 0, 0, 6]);
        assert_eq!((quality.valence_min, quality.valence_max, quality.genus), (4, 4, 0));
        // Closed forms; the tolerance is a few roundings.
        assert_relative_eq!(quality.edge_min, 8f64.sqrt(), max_relative = 1e-14);
        assert_relative_eq!(quality.edge_max, 8f64.sqrt(), max_relative = 1e-14);
        assert!(quality.edge_variation < 1e-7);
        assert_relative_eq!(quality.radius_ratio_min, 1.0, max_relative = 1e-14);
        assert_relative_eq!(quality.volume, 32.0 / 3.0, max_relative = 1e-14);
        let bend = (1f64 / 3.0).acos().to_degrees();
        assert_relative_eq!(quality.dihedral_max, bend, max_relative = 1e-12);
        assert_eq!(quality.neck_edges, 0);
    }

    #[test]
    fn a_belt_of_three_edges_is_a_neck() {
        let side = |k: f64| Vec3::new((2.1 * k).cos(), (2.1 * k).sin(), 0.0);
        let positions = vec![side(0.0), side(1.0), side(2.0), Vec3::z(), -Vec3::z()];
        let triangles = vec![[0, 1, 3], [1, 2, 3], [2, 0, 3], [1, 0, 4], [2, 1, 4], [0, 2, 4]];
        let quality = SurfaceQuality::of(&TriangleMesh { positions, triangles }).unwrap();
        assert_eq!(quality.neck_edges, 3);
    }
}
