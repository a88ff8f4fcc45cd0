//! What a wall is made of, point by point of its middle: how thick it is, and of which material.

use crate::surface::TriangleMesh;

/// The section of a shell: thickness at its vertices, linear within its triangles, and the material of each triangle.
///
/// Materials are places in a list that the model is given: a mesh knows no laws.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// Of each vertex, mm.
    thickness: Property<f64>,
    /// Of each triangle.
    material: Property<u16>,
}

/// The wall at one point of its middle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SectionPoint {
    /// Thickness at rest, mm.
    pub thickness: f64,
    /// Place in the list of materials.
    pub material: u16,
}

/// One value for all, or one for each.
#[derive(Clone, Debug, PartialEq)]
enum Property<T> {
    Uniform(T),
    Each(Vec<T>),
}

impl<T: Copy + PartialOrd> Property<T> {
    fn of(&self, item: usize) -> T {
        match self {
            Self::Uniform(value) => *value,
            Self::Each(values) => values[item],
        }
    }

    fn uniform(&self) -> Option<T> {
        match self {
            Self::Uniform(value) => Some(*value),
            Self::Each(_) => None,
        }
    }

    fn values(&self) -> &[T] {
        match self {
            Self::Uniform(value) => std::slice::from_ref(value),
            Self::Each(values) => values,
        }
    }
}

impl Section {
    /// A wall of one `thickness` (mm) and of the first material.
    ///
    /// # Panics
    /// When the thickness is not a positive number.
    #[must_use]
    pub fn uniform(thickness: f64) -> Self {
        assert!(is_length(thickness), "a wall is {thickness} mm thick");
        Self { thickness: Property::Uniform(thickness), material: Property::Uniform(0) }
    }

    /// This section with a thickness for each vertex, mm.
    ///
    /// # Panics
    /// When there is none, or one is not a positive number.
    #[must_use]
    pub fn with_thickness(self, of_vertices: Vec<f64>) -> Self {
        assert!(!of_vertices.is_empty() && of_vertices.iter().all(|t| is_length(*t)));
        Self { thickness: Property::Each(of_vertices), ..self }
    }

    /// This section with a material for each triangle, by its place in the list of materials.
    #[must_use]
    pub fn with_materials(self, of_triangles: Vec<u16>) -> Self {
        Self { material: Property::Each(of_triangles), ..self }
    }

    /// Thickness at a vertex, mm.
    #[must_use]
    pub fn thickness(&self, vertex: u32) -> f64 {
        self.thickness.of(vertex as usize)
    }

    /// The thickness of the whole wall, mm; none where it varies.
    #[must_use]
    pub fn uniform_thickness(&self) -> Option<f64> {
        self.thickness.uniform()
    }

    /// The least and the greatest thickness, mm.
    #[must_use]
    pub fn thickness_range(&self) -> [f64; 2] {
        let empty = [f64::INFINITY, 0.0_f64];
        let values = self.thickness.values().iter();
        values.fold(empty, |[least, most], &t| [least.min(t), most.max(t)])
    }

    /// The place in the list of materials of that of a triangle.
    #[must_use]
    pub fn material(&self, triangle: usize) -> u16 {
        self.material.of(triangle)
    }

    /// The greatest place in the list of materials that occurs.
    #[must_use]
    pub fn last_material(&self) -> u16 {
        self.material.values().iter().copied().max().unwrap_or(0)
    }

    /// The wall at the point of `triangle`, between these `corners`, that has these barycentric `weights`.
    #[must_use]
    pub fn at(&self, triangle: usize, corners: [u32; 3], weights: [f64; 3]) -> SectionPoint {
        let thickness = self.thickness.uniform().unwrap_or_else(|| {
            corners.iter().zip(weights).map(|(&v, w)| w * self.thickness(v)).sum()
        });
        SectionPoint { thickness, material: self.material(triangle) }
    }

    /// Mean thickness of a triangle between these `corners`, mm.
    #[must_use]
    pub fn mean_thickness(&self, corners: [u32; 3]) -> f64 {
        self.at(0, corners, [1.0 / 3.0; 3]).thickness
    }

    /// The volume of the wall about its middle, thickness times area, mm^3.
    #[must_use]
    pub fn volume(&self, middle: &TriangleMesh) -> f64 {
        if let Some(thickness) = self.uniform_thickness() {
            return thickness * middle.area();
        }
        let of_triangle = |(t, &corners): (usize, &[u32; 3])| {
            self.mean_thickness(corners) * middle.area_vector(t).norm()
        };
        middle.triangles.iter().enumerate().map(of_triangle).sum()
    }
}

fn is_length(thickness: f64) -> bool {
    thickness > 0.0 && thickness.is_finite()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;

    /// A right triangle, 3 x 4 mm, 1 mm thick at its corner and 2 and 3 mm at its ends: a mean of 2 mm over 6 mm^2.
    #[test]
    fn thickness_is_linear_in_a_triangle() {
        let middle = TriangleMesh {
            positions: vec![Vec3::zeros(), Vec3::new(3.0, 0.0, 0.0), Vec3::new(0.0, 4.0, 0.0)],
            triangles: vec![[0, 1, 2]],
        };
        let section = Section::uniform(1.0).with_thickness(vec![1.0, 2.0, 3.0]);
        let at = |weights| section.at(0, [0, 1, 2], weights).thickness;
        assert_eq!([at([1.0, 0.0, 0.0]), at([0.0, 0.5, 0.5])], [1.0, 2.5]);
        assert!((section.volume(&middle) - 12.0).abs() < 1e-14);
        assert_eq!(section.thickness_range(), [1.0, 3.0]);
        assert_eq!(section.uniform_thickness(), None);
    }

    #[test]
    fn a_uniform_section_is_the_same_to_the_bit_everywhere() {
        let section = Section::uniform(0.1).with_materials(vec![0, 2]);
        assert_eq!(
            section.at(1, [0, 1, 2], [0.3, 0.3, 0.4]),
            SectionPoint { thickness: 0.1, material: 2 }
        );
        assert_eq!(section.last_material(), 2);
    }
}
