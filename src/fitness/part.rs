//! What can be walked through a scenario: a shell, or the solid of its wall.

use crate::math::Rejected;
use crate::mesh::ShellMesh;
use crate::model::material::Material;
use crate::model::{MaterialLimits, PartModel, PartSetup, Support};

/// A part of one chamber that can be put through scenarios.
pub trait Part {
    /// The shell: what is watched of the part are its vertices.
    fn shell(&self) -> &ShellMesh;

    /// The model of the part among what `setup` lists, held by its clamp.
    ///
    /// # Errors
    /// [`Rejected`] when the part has none.
    fn model(&self, setup: &PartSetup) -> Result<PartModel, Rejected>;

    /// What each of its materials may bear; none of those that are left out.
    fn limits(&self) -> &[MaterialLimits] {
        &[]
    }

    /// Volume of the wall at rest, cm^3.
    fn wall_volume_cm3(&self) -> f64;
}

/// A shell.
#[derive(Clone, Copy, Debug)]
pub struct ShellPart<'a> {
    /// The middle of its wall.
    pub shell: &'a ShellMesh,
    /// The materials that its section names by their places.
    pub materials: &'a [Material],
    /// What these may bear, in their order; none of those that are left out.
    pub limits: &'a [MaterialLimits],
}

impl Part for ShellPart<'_> {
    fn shell(&self) -> &ShellMesh {
        self.shell
    }

    fn model(&self, setup: &PartSetup) -> Result<PartModel, Rejected> {
        PartModel::new(self.shell, self.materials, &Support::Clamp, setup)
    }

    fn limits(&self) -> &[MaterialLimits] {
        self.limits
    }

    fn wall_volume_cm3(&self) -> f64 {
        1e-3 * self.shell.section.volume(&self.shell.surface)
    }
}
