//! The mesh of a shell: a closed mid-surface, its thickness, and the vertices that are held or watched.

use std::collections::BTreeSet;

use super::ends::EndSets;
use super::shell_settings::{ShellElement, ShellSettings};
use super::{Rings, Section, Stencil};
use crate::math::{Reason, Rejected, Room};
use crate::surface::TriangleMesh;

/// A closed mid-surface prepared for computation.
#[derive(Clone, Debug)]
pub struct ShellMesh {
    /// The mid-surface; its vertices lie on the limit surface of the element.
    pub surface: TriangleMesh,
    /// Edges whose angle at rest is the part's own, by their vertices, the lesser first; the mid-edge element keeps it.
    pub sharp_edges: BTreeSet<[u32; 2]>,
    /// Ordered neighbours of every vertex.
    pub rings: Rings,
    /// The control points of every triangle.
    pub stencils: Vec<Stencil>,
    /// What the wall is made of.
    pub section: Section,
    /// The finite element.
    pub element: ShellElement,
    /// Where it is held and watched.
    pub ends: EndSets,
}

impl ShellMesh {
    /// The shell of `surface`.
    ///
    /// # Errors
    /// [`Rejected`] when the surface is no closed manifold, or the clamp holds fewer than three vertices.
    pub fn new(surface: TriangleMesh, settings: &ShellSettings) -> Result<Self, Rejected> {
        let rings = Rings::new(surface.positions.len(), &surface.triangles)?;
        let ends = EndSets::of_shell(&surface, settings);
        if ends.clamp.len() < 3 {
            return Err(Rejected::new(
                Room::Mesh,
                Reason::ClampHoldsNothing,
                format!(
                    "the clamp below z = {:.3} mm holds {} vertices, fewer than 3",
                    ends.heights.clamp_top,
                    ends.clamp.len()
                ),
                1.0,
            ));
        }
        let stencils = surface.triangles.iter().map(|&t| Stencil::new(t, &rings)).collect();
        Ok(Self {
            surface,
            sharp_edges: BTreeSet::new(),
            rings,
            stencils,
            section: Section::uniform(settings.thickness),
            element: settings.element.unwrap_or_default(),
            ends,
        })
    }

    /// The vertices whose control points are held: those of the clamp, and their neighbours, on which the wall between them depends.
    #[must_use]
    pub fn held_vertices(&self) -> BTreeSet<u32> {
        let near = |&v: &u32| self.rings.ring(v).iter().copied().chain([v]);
        self.ends.clamp.iter().flat_map(near).collect()
    }
}
