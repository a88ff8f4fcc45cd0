//! Where a part is held and where it is watched: one rule along z for shells, for solids around a shell's middle, and for
//! tetrahedra of one's own.
//!
//! ```text
//! base      the lowest point of the middle of the wall          top      the highest
//! clamp     z < base + clamp_height * thickness
//! tip       z >= top - tip_fraction * (top - base)
//! ```
//!
//! Tetrahedra alone have no middle: their faces are taken to lie half a thickness beyond it.

use super::shell_settings::ShellSettings;
use super::solid::SolidMesh;
use crate::math::Vec3;
use crate::surface::TriangleMesh;

/// Heights along z at rest, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ends {
    /// Of the lowest point of the middle.
    pub base: f64,
    /// From there to the highest.
    pub length: f64,
    /// Below this all is held.
    pub clamp_top: f64,
    /// From here on it is the tip.
    pub tip_bottom: f64,
}

/// The ends of a meshed part: their heights, and what of the mesh lies there.
#[derive(Clone, Debug, PartialEq)]
pub struct EndSets {
    /// Along z.
    pub heights: Ends,
    /// Held vertices, or nodes of a solid, ascending.
    pub clamp: Vec<u32>,
    /// Vertices of the surface whose mean motion is the motion of the tip, ascending.
    pub tip: Vec<u32>,
}

impl EndSets {
    /// Of a shell whose middle is `middle`.
    #[must_use]
    pub fn of_shell(middle: &TriangleMesh, settings: &ShellSettings) -> Self {
        let heights = Ends::of_middle(middle.positions.iter().map(|x| x.z), settings);
        let clamp = heights.held(middle.positions.iter().map(|x| x.z));
        Self { heights, clamp, tip: heights.tip(middle) }
    }

    /// Of a solid between these heights, whose tip is watched on its `surface`.
    #[must_use]
    pub fn of_solid(mesh: &SolidMesh, heights: Ends, surface: &TriangleMesh) -> Self {
        Self { heights, clamp: heights.held_nodes(mesh), tip: heights.tip(surface) }
    }
}

impl Ends {
    /// Of a solid, from its faces.
    #[must_use]
    pub fn of_solid(mesh: &SolidMesh, settings: &ShellSettings) -> Self {
        Self::of_faces(mesh.positions.iter().map(|x| x.z), settings)
    }

    /// The nodes of a solid that are held, ascending.
    #[must_use]
    pub fn held_nodes(&self, mesh: &SolidMesh) -> Vec<u32> {
        self.held(mesh.positions.iter().map(|x| x.z))
    }

    fn of_middle(heights: impl Iterator<Item = f64>, settings: &ShellSettings) -> Self {
        let [low, high] = extremes(heights);
        Self::between(low, high, settings)
    }

    fn of_faces(heights: impl Iterator<Item = f64>, settings: &ShellSettings) -> Self {
        let [low, high] = extremes(heights);
        Self::between(low + 0.5 * settings.thickness, high - 0.5 * settings.thickness, settings)
    }

    fn between(base: f64, top: f64, settings: &ShellSettings) -> Self {
        let length = top - base;
        Self {
            base,
            length,
            clamp_top: base + settings.clamp_height * settings.thickness,
            tip_bottom: top - settings.tip_fraction * length,
        }
    }

    fn held(&self, heights: impl Iterator<Item = f64>) -> Vec<u32> {
        (0..).zip(heights).filter_map(|(v, z)| (z < self.clamp_top).then_some(v)).collect()
    }

    fn tip(&self, surface: &TriangleMesh) -> Vec<u32> {
        let is_tip = |(v, x): (u32, &Vec3)| (x.z >= self.tip_bottom).then_some(v);
        (0..).zip(&surface.positions).filter_map(is_tip).collect()
    }
}

fn extremes(heights: impl Iterator<Item = f64>) -> [f64; 2] {
    heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], z| [low.min(z), high.max(z)])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A middle from 10 to 110 mm and the faces around it, 9 and 111 mm, are one part: held below 13 mm, its tip above 105 mm.
    #[test]
    fn a_middle_and_its_faces_have_the_same_ends() {
        let settings = ShellSettings { thickness: 2.0, ..ShellSettings::default() };
        let middle = Ends::of_middle([10.0, 60.0, 110.0].into_iter(), &settings);
        let faces = Ends::of_faces([9.0, 11.0, 109.0, 111.0].into_iter(), &settings);
        assert_eq!(middle, faces);
        let expected = Ends { base: 10.0, length: 100.0, clamp_top: 13.0, tip_bottom: 105.0 };
        assert_eq!(middle, expected);
        let heights = [9.0, 12.9, 13.0, 104.9, 105.0, 111.0];
        assert_eq!(middle.held(heights.into_iter()), [0, 1]);
        let positions = heights.map(|z| Vec3::new(0.0, 0.0, z)).to_vec();
        assert_eq!(middle.tip(&TriangleMesh { positions, triangles: Vec::new() }), [4, 5]);
    }
}
