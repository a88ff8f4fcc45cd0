//! An indexed triangle surface.

use crate::math::{DisjointSets, Vec3, area_vector};

use super::{HalfEdges, MeshDefect};

/// Triangles over shared vertices, counter-clockwise seen from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriangleMesh {
    /// Vertex positions, mm.
    pub positions: Vec<Vec3>,
    /// Vertex indices of each triangle.
    pub triangles: Vec<[u32; 3]>,
}

impl TriangleMesh {
    /// The three corners of triangle `t`, mm.
    #[must_use]
    pub fn corners(&self, t: usize) -> [Vec3; 3] {
        self.triangles[t].map(|v| self.positions[v as usize])
    }

    /// The enclosed volume, mm^3, positive when the triangles face outward.
    #[must_use]
    pub fn volume(&self) -> f64 {
        (0..self.triangles.len()).map(|t| self.volume_below(t)).sum()
    }

    /// The two faces of a wall of the `thickness` (mm) of each vertex around this middle: the outer face, and the inner one turned round.
    ///
    /// Offset along the vertex normals: where the surface folds tighter than half the thickness, a face crosses itself.
    #[must_use]
    pub fn wall(&self, thickness: impl Fn(u32) -> f64) -> Self {
        let normals = self.vertex_normals();
        let mut positions = Vec::with_capacity(2 * self.positions.len());
        for side in [0.5, -0.5] {
            let middle = (0..).zip(&self.positions).zip(&normals);
            positions.extend(middle.map(|((v, x), n)| x + side * thickness(v) * n));
        }
        let inner = self.positions.len() as u32;
        let turned = self.triangles.iter().map(|&[a, b, c]| [inner + a, inner + c, inner + b]);
        Self { positions, triangles: self.triangles.iter().copied().chain(turned).collect() }
    }

    /// The surface area, mm^2.
    #[must_use]
    pub fn area(&self) -> f64 {
        (0..self.triangles.len()).map(|t| self.area_vector(t).norm()).sum()
    }

    /// The outward normal of triangle `t` times its area, mm^2.
    #[must_use]
    pub fn area_vector(&self, t: usize) -> Vec3 {
        area_vector(self.corners(t))
    }

    /// The area-weighted unit normal at each vertex, `[vertices]`; zero where the areas cancel.
    #[must_use]
    pub fn vertex_normals(&self) -> Vec<Vec3> {
        let mut normals = vec![Vec3::zeros(); self.positions.len()];
        for (t, triangle) in self.triangles.iter().enumerate() {
            for &v in triangle {
                normals[v as usize] += self.area_vector(t);
            }
        }
        for normal in &mut normals {
            *normal = normal.try_normalize(0.0).unwrap_or_default();
        }
        normals
    }

    /// The lower and upper corner of the smallest box around the vertices, mm; `None` without vertices.
    #[must_use]
    pub fn bounding_box(&self) -> Option<(Vec3, Vec3)> {
        let first = *self.positions.first()?;
        let widen = |(lower, upper): (Vec3, Vec3), p: &Vec3| (lower.inf(p), upper.sup(p));
        Some(self.positions.iter().fold((first, first), widen))
    }

    /// The connected component of each triangle, `[triangles]`, numbered in order of appearance.
    ///
    /// Triangles are connected when they share a vertex.
    #[must_use]
    pub fn components(&self) -> Vec<u32> {
        let mut sets = DisjointSets::new(self.positions.len());
        for &[a, b, c] in &self.triangles {
            sets.join(a, b);
            sets.join(a, c);
        }
        sets.numbers(self.triangles.iter().map(|triangle| triangle[0]))
    }

    /// The triangles of both meshes, those of `other` last.
    #[must_use]
    pub fn joined(&self, other: &Self) -> Self {
        let shift = self.positions.len() as u32;
        let shifted = other.triangles.iter().map(|t| t.map(|v| v + shift));
        Self {
            positions: [self.positions.as_slice(), &other.positions].concat(),
            triangles: self.triangles.iter().copied().chain(shifted).collect(),
        }
    }

    /// The triangles of one connected component over its vertices, both in their order.
    #[must_use]
    pub fn component(&self, component: u32) -> Self {
        let of_component =
            |(triangle, number): (&[u32; 3], u32)| (number == component).then_some(*triangle);
        let triangles: Vec<[u32; 3]> =
            self.triangles.iter().zip(self.components()).filter_map(of_component).collect();
        over_used_vertices(&self.positions, &triangles).0
    }

    /// The enclosed volume of each connected component, mm^3; negative for a void.
    #[must_use]
    pub fn component_volumes(&self) -> Vec<f64> {
        let components = self.components();
        let count = components.iter().max().map_or(0, |&last| last as usize + 1);
        let mut volumes = vec![0.0; count];
        for (t, &component) in components.iter().enumerate() {
            volumes[component as usize] += self.volume_below(t);
        }
        volumes
    }

    /// The number of handles of a closed surface, summed over its components.
    ///
    /// ```text
    /// genus = components - (V - E + F) / 2,   E = 3 F / 2
    /// ```
    #[must_use]
    pub fn genus(&self) -> usize {
        let components = self.components().iter().max().map_or(0, |&last| last as usize + 1);
        (2 * components + self.triangles.len() / 2).saturating_sub(self.positions.len()) / 2
    }

    /// Whether the triangles are a closed, outward-oriented 2-manifold over finite, used vertices.
    ///
    /// # Errors
    /// The first [`MeshDefect`] found. Intersections of the surface with itself are not looked for.
    pub fn check_closed_manifold(&self) -> Result<(), MeshDefect> {
        HalfEdges::try_from(self)?;
        let not_finite = |p: &&Vec3| !p.iter().all(|x| x.is_finite());
        let vertices = self.positions.iter().filter(not_finite).count();
        if vertices > 0 {
            return Err(MeshDefect::NotFinite { vertices });
        }
        let volume = self.volume();
        if volume <= 0.0 {
            return Err(MeshDefect::FacesInward { volume });
        }
        Ok(())
    }

    /// The signed volume between triangle `t` and the origin, mm^3.
    fn volume_below(&self, t: usize) -> f64 {
        let [a, b, c] = self.corners(t);
        a.dot(&b.cross(&c)) / 6.0
    }
}

/// The triangles over those of the vertices at `positions` that they name, both in their order, and the new number of each of these.
#[must_use]
pub fn over_used_vertices(positions: &[Vec3], triangles: &[[u32; 3]]) -> (TriangleMesh, Vec<u32>) {
    let mut is_used = vec![false; positions.len()];
    triangles.iter().flatten().for_each(|&v| is_used[v as usize] = true);
    let mut used = Vec::new();
    let number = |(&position, &is_used): (&Vec3, &bool)| {
        used.extend(is_used.then_some(position));
        (used.len() as u32).saturating_sub(1)
    };
    let numbers: Vec<u32> = positions.iter().zip(&is_used).map(number).collect();
    let triangles = triangles.iter().map(|t| t.map(|v| numbers[v as usize])).collect();
    (TriangleMesh { positions: used, triangles }, numbers)
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    fn tetrahedron(at: Vec3) -> TriangleMesh {
        TriangleMesh {
            positions: vec![at, at + Vec3::x(), at + Vec3::y(), at + Vec3::z()],
            triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
        }
    }

    #[test]
    fn measures_of_a_corner_tetrahedron() {
        let mesh = tetrahedron(Vec3::new(2.0, -1.0, 0.5));
        // Closed forms; the tolerance is a few roundings.
        assert_relative_eq!(mesh.volume(), 1.0 / 6.0, max_relative = 1e-13);
        assert_relative_eq!(mesh.area(), 1.5 + 3f64.sqrt() / 2.0, max_relative = 1e-13);
        assert_eq!(mesh.genus(), 0);
        assert_eq!(mesh.check_closed_manifold(), Ok(()));
        let (lower, upper) = mesh.bounding_box().unwrap();
        assert_eq!((lower, upper), (Vec3::new(2.0, -1.0, 0.5), Vec3::new(3.0, 0.0, 1.5)));
        let inward = -Vec3::new(1.0, 1.0, 1.0) / 3f64.sqrt();
        assert_relative_eq!(mesh.vertex_normals()[0], inward, epsilon = 1e-15);
    }

    #[test]
    fn islands_are_counted_and_measured() {
        let far = tetrahedron(Vec3::new(9.0, 0.0, 0.0));
        let mut pair = tetrahedron(Vec3::zeros()).joined(&far);
        pair.triangles.swap(1, 6);
        assert_eq!(pair.components(), [0, 1, 0, 0, 1, 1, 0, 1]);
        for volume in pair.component_volumes() {
            assert_relative_eq!(volume, 1.0 / 6.0, max_relative = 1e-13);
        }
        assert_eq!(pair.genus(), 0);
        let second = pair.component(1);
        assert_eq!(second.positions, far.positions);
        assert_eq!(second.triangles, [2, 0, 1, 3].map(|t| far.triangles[t]));
    }

    #[test]
    fn inward_and_infinite_surfaces_are_refused() {
        let mut mesh = tetrahedron(Vec3::zeros());
        mesh.triangles.iter_mut().for_each(|t| t.swap(0, 1));
        assert!(matches!(mesh.check_closed_manifold(), Err(MeshDefect::FacesInward { .. })));
        mesh.positions[2].y = f64::NAN;
        assert_eq!(mesh.check_closed_manifold(), Err(MeshDefect::NotFinite { vertices: 1 }));
    }

    /// The wall of a sphere is a shell between two spheres; a fine sphere's volume is right to 0.4 %.
    #[test]
    fn wall_of_a_sphere_has_the_volume_of_the_shell() {
        let wall = TriangleMesh::sphere(10.0, 4).wall(|_| 2.0);
        let exact = 4.0 / 3.0 * std::f64::consts::PI * (11.0_f64.powi(3) - 9.0_f64.powi(3));
        assert_relative_eq!(wall.volume(), exact, max_relative = 5e-3);
        assert_eq!(wall.components().iter().max(), Some(&1));
    }
}
