//! The mesh of a shell: a closed mid-surface, its thickness, and the vertices that are held or watched.

use std::collections::BTreeSet;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Ends, Rings, Section, Stencil};
use crate::math::{Reason, Rejected, Room};
use crate::surface::TriangleMesh;

/// The finite element of a shell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ShellElement {
    /// Loop's subdivision surface: the accurate one.
    #[default]
    Loop,
    /// Flat triangles whose normals are averaged across edges: the draft, half the price for each unknown.
    MidEdge,
}

/// How a mid-surface becomes a shell.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ShellSettings {
    /// Wall thickness, mm; the surface is the middle of the wall.
    pub thickness: f64,
    /// Height of the clamp above the lowest vertex, in thicknesses.
    pub clamp_height: f64,
    /// Length of the tip set below the highest vertex, as a fraction of the length along z.
    pub tip_fraction: f64,
    /// The finite element of the wall; by default `loop`, and `mid-edge` for a surface of one's own that has sharp edges.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub element: Option<ShellElement>,
}

impl Default for ShellSettings {
    /// A wall of 1.6 mm clamped over 1.5 thicknesses, as in the public Abaqus decks of the 2022 work.
    fn default() -> Self {
        Self { thickness: 1.6, clamp_height: 1.5, tip_fraction: 0.05, element: None }
    }
}

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
    /// Below this z all is held, mm.
    pub clamp_top: f64,
    /// Vertices that are held.
    pub clamp: Vec<u32>,
    /// Vertices whose mean motion is the motion of the tip.
    pub tip: Vec<u32>,
    /// Lowest vertex along z, mm.
    pub base: f64,
    /// Length along z at rest, mm.
    pub length: f64,
}

impl ShellMesh {
    /// The shell of `surface`.
    ///
    /// # Errors
    /// [`Rejected`] when the surface is no closed manifold, or the clamp holds fewer than three vertices.
    pub fn new(surface: TriangleMesh, settings: &ShellSettings) -> Result<Self, Rejected> {
        let rings = Rings::new(surface.positions.len(), &surface.triangles)?;
        let heights = || surface.positions.iter().map(|p| p.z);
        let ends = Ends::of_middle(heights(), settings);
        let Ends { base, length, clamp_top, .. } = ends;
        let clamp = ends.held(heights());
        if clamp.len() < 3 {
            return Err(Rejected::new(
                Room::Mesh,
                Reason::ClampHoldsNothing,
                format!(
                    "the clamp below z = {clamp_top:.3} mm holds {} vertices, fewer than 3",
                    clamp.len()
                ),
                1.0,
            ));
        }
        let tip = ends.tip(heights());
        let stencils = surface.triangles.iter().map(|&t| Stencil::new(t, &rings)).collect();
        Ok(Self {
            surface,
            sharp_edges: BTreeSet::new(),
            rings,
            stencils,
            section: Section::uniform(settings.thickness),
            element: settings.element.unwrap_or_default(),
            clamp_top,
            clamp,
            tip,
            base,
            length,
        })
    }
}
