//! A wall that is not the same everywhere, as its network says: thickness within bounds, one of two materials.

use crate::field::{CompiledNetwork, ScalarField};
use crate::genome::Network;
use crate::math::Vec3;
use crate::mesh::{Section, ShellMesh};
use crate::model::material::Material;

/// What a network may say of its wall; by default nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WallPattern {
    /// The least and the greatest thickness that it may ask for, mm.
    pub thickness: Option<[f64; 2]>,
    /// What the wall is of where the network's node for the material is positive.
    pub material: Option<Material>,
}

impl WallPattern {
    /// The section of the `shell` of `network`: as it was where the network says nothing, or may not.
    ///
    /// The network is asked at the vertices for the thickness, and at the middle of each triangle for the material.
    #[must_use]
    pub fn section(&self, network: &Network, shell: &ShellMesh) -> Section {
        let nodes = network.wall();
        let surface = &shell.surface;
        let mut section = shell.section.clone();
        if let (Some(node), Some([least, most])) = (nodes.thickness, self.thickness) {
            let field = CompiledNetwork::of_node(network, node);
            let thickness = |x: &_| field.value(*x).clamp(least, most);
            section = section.with_thickness(surface.positions.iter().map(thickness).collect());
        }
        if let (Some(node), Some(_)) = (nodes.material, &self.material) {
            let field = CompiledNetwork::of_node(network, node);
            let middle = |t| surface.corners(t).iter().sum::<Vec3>() / 3.0;
            let second = |t| u16::from(field.value(middle(t)) > 0.0);
            section = section.with_materials((0..surface.triangles.len()).map(second).collect());
        }
        section
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::ShellSettings;
    use crate::model::material::NeoHookean;
    use crate::surface::TriangleMesh;

    /// A sphere of 10 mm whose wall is 0.1 mm for each mm of height, plus 1 mm, within bounds; of the second material above its middle.
    #[test]
    fn a_network_says_what_its_wall_is_made_of() {
        let network: Network = "output = \"ball\"\n[wall]\nthickness = \"t\"\nmaterial = \"m\"\n\
             [[node]]\nname = \"ball\"\nlinks = { r = 1.0 }\n\
             [[node]]\nname = \"t\"\nlinks = { z = 1.0 }\nbias = 1.0\n\
             [[node]]\nname = \"m\"\nlinks = { z = 1.0 }\n"
            .parse()
            .unwrap();
        let settings = ShellSettings { thickness: 1.2, ..ShellSettings::default() };
        let shell = ShellMesh::new(TriangleMesh::sphere(10.0, 2), &settings).unwrap();
        let material = Material::NeoHookean(NeoHookean { mu: 1.0 });
        let pattern = WallPattern { thickness: Some([0.5, 1.5]), material: Some(material) };
        let section = pattern.section(&network, &shell);
        for (v, x) in (0..).zip(&shell.surface.positions) {
            let exact = (1.0 + 0.1 * x.z).clamp(0.5, 1.5);
            assert!((section.thickness(v) - exact).abs() < 1e-14, "{x}");
        }
        for (t, corners) in shell.surface.triangles.iter().enumerate() {
            let height: f64 = corners.iter().map(|&v| shell.surface.positions[v as usize].z).sum();
            assert_eq!(section.material(t), u16::from(height > 0.0), "{height}");
        }
        // What a network may not say is as it was.
        assert_eq!(WallPattern::default().section(&network, &shell), shell.section);
    }
}
