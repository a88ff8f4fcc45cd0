//! `[part]`: where a part comes from.

pub(crate) mod closed_part;
pub(crate) mod formula;
pub(crate) mod on_disk;
pub(crate) mod own_surface;
pub(crate) mod patch_part;
pub(crate) mod placement;
pub(crate) mod solid_part;

use std::path::{Path, PathBuf};

use anyhow::{bail, ensure};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use self::patch_part::PatchSection;
use self::placement::{Axis, Placed, bounds, check_size};
use crate::genome::Network;
use crate::io::{ChamberChoice, GroupKey, OwnSolid};
use crate::scene::material::{positive, within};
use crate::surface::TriangleMesh;

/// Where the part comes from; exactly one of them, files relative to the scene file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Part {
    /// A network file; its surface is the middle of the wall.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub network: Option<PathBuf>,
    /// An STL file of a closed mid-surface, mm, z along the part.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stl: Option<PathBuf>,
    /// A Gmsh file (`.msh`) or VTK grid (`.vtu`) of the wall in tetrahedra, mm, z along the part, clamped at its base.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tetrahedra: Option<PathBuf>,
    /// Of tetrahedra: the physical group of the chamber's triangles, by its name or number; by default the group named
    /// `chamber`, or else what the wall surrounds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub chamber: Option<GroupKey>,
    /// Of tetrahedra: whether flat openings of the chamber, as an air inlet, are closed by lids without mass and stiffness.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub close_inlet: bool,
    /// For an STL file or tetrahedra: the direction in the file that is the part's long axis, `x`, `-x`, `y`, `-y`, `z` or `-z`; the
    /// part is turned until it points along z.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub axis: Option<Axis>,
    /// For an STL file or tetrahedra: mm in one unit of the file; 1000 for metres, 25.4 for inches.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<f64>,
    /// An open surface given by formulas.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub patch: Option<PatchSection>,
    /// A closed sphere about the origin, free but for its rigid motions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sphere: Option<SphereSection>,
    /// A closed ellipsoid about the origin, free but for its rigid motions; `[mesh] edge` says how fine.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ellipsoid: Option<EllipsoidSection>,
}

/// A sphere of triangles: an icosahedron whose triangles are quartered again and again.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct SphereSection {
    /// Radius of the mid-surface, mm.
    pub radius: f64,
    /// How often the twenty triangles of an icosahedron are quartered; 3 makes 1280 triangles.
    pub subdivisions: usize,
}

/// An ellipsoid of triangles of one size.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct EllipsoidSection {
    /// Semi-axes of the mid-surface along x, y and z, mm.
    pub semi_axes: [f64; 3],
}

/// Where the files that a part names are read.
pub(crate) trait PartFiles {
    /// The network in the file at `path`.
    fn network(&self, path: &Path) -> anyhow::Result<Network>;
    /// The triangles of the STL file at `path`, mm.
    fn surface(&self, path: &Path) -> anyhow::Result<TriangleMesh>;
    /// The tetrahedra of the file at `path` (`.msh` or `.vtu`), mm, with the chamber of the `choice`.
    fn tetrahedra(&self, path: &Path, choice: &ChamberChoice) -> anyhow::Result<OwnSolid>;
}

/// What a scene's part is made from.
pub(crate) enum PartSource<'a> {
    Network {
        file: PathBuf,
        network: Network,
    },
    Stl {
        file: PathBuf,
        surface: TriangleMesh,
        placed: Placed,
    },
    Tetrahedra {
        file: PathBuf,
        solid: OwnSolid,
        placed: Placed,
    },
    Patch(&'a PatchSection),
    Sphere(SphereSection),
    /// Its semi-axes, mm.
    Ellipsoid([f64; 3]),
}

impl PartSource<'_> {
    /// Whether the part is a shell that is clamped at its base and has a tip.
    pub(crate) fn is_actuator(&self) -> bool {
        matches!(self, Self::Network { .. } | Self::Stl { .. })
    }

    /// Where the file's part was put.
    pub(crate) fn placed(&self) -> Placed {
        match self {
            Self::Stl { placed, .. } | Self::Tetrahedra { placed, .. } => *placed,
            _ => Placed::default(),
        }
    }

    /// Refuses a part of one's own that is no larger than its wall of `thickness` (mm); a line about one that lies on its side.
    pub(crate) fn check_size(&self, part: &Part, thickness: f64) -> anyhow::Result<Option<String>> {
        let (file, positions) = match self {
            Self::Stl { file, surface, .. } => (file, &surface.positions),
            Self::Tetrahedra { file, solid, .. } => (file, &solid.mesh.positions),
            _ => return Ok(None),
        };
        let Some(bounds) = bounds(positions) else { return Ok(None) };
        check_size(&file.display().to_string(), part, bounds, thickness)
    }
}

impl Part {
    /// What the part of the scene file at `path` is made from.
    pub(crate) fn source(
        &self,
        path: &Path,
        files: &dyn PartFiles,
    ) -> anyhow::Result<PartSource<'_>> {
        let beside = |file: &PathBuf| path.parent().unwrap_or(Path::new("")).join(file);
        let Self { network, stl, tetrahedra, patch, sphere, ellipsoid, .. } = self;
        let given = [
            network.is_some(),
            stl.is_some(),
            tetrahedra.is_some(),
            patch.is_some(),
            sphere.is_some(),
            ellipsoid.is_some(),
        ];
        let all = "`network`, `stl`, `tetrahedra`, `patch`, `sphere` and `ellipsoid`";
        if given.iter().filter(|given| **given).count() > 1 {
            bail!("{}: [part] has more than one of {all}; give one", path.display());
        }
        if let Some(file) = network {
            let file = beside(file);
            Ok(PartSource::Network { network: files.network(&file)?, file })
        } else if let Some(file) = stl {
            let file = beside(file);
            let mut surface = files.surface(&file)?;
            let placed = Placed::new(self, &mut surface.positions);
            Ok(PartSource::Stl { surface, file, placed })
        } else if let Some(file) = tetrahedra {
            let file = beside(file);
            let choice =
                ChamberChoice { group: self.chamber.clone(), close_inlet: self.close_inlet };
            let mut solid = files.tetrahedra(&file, &choice)?;
            let placed = Placed::new(self, &mut solid.mesh.positions);
            Ok(PartSource::Tetrahedra { solid, file, placed })
        } else if let Some(patch) = patch {
            Ok(PartSource::Patch(patch))
        } else if let Some(sphere) = sphere {
            Ok(PartSource::Sphere(*sphere))
        } else if let Some(ellipsoid) = ellipsoid {
            Ok(PartSource::Ellipsoid(ellipsoid.semi_axes))
        } else {
            bail!("{}: [part] has none of {all}; give one", path.display())
        }
    }

    /// Whether it is free but for its rigid motions.
    pub(crate) fn is_free(&self) -> bool {
        self.sphere.is_some() || self.ellipsoid.is_some()
    }

    /// Checks the shapes that are given by numbers; `edge` (mm) is how finely an ellipsoid is meshed.
    pub(crate) fn check(&self, edge: f64) -> anyhow::Result<()> {
        let of_tetrahedra =
            [("chamber", self.chamber.is_some()), ("close_inlet", self.close_inlet)];
        if let Some((key, _)) = of_tetrahedra.iter().find(|(_, is_given)| *is_given) {
            ensure!(
                self.tetrahedra.is_some(),
                "[part] {key} is for `tetrahedra`, which are not given"
            );
        }
        let is_own = self.stl.is_some() || self.tetrahedra.is_some();
        ensure!(
            is_own || (self.axis.is_none() && self.scale.is_none()),
            "[part] axis and scale are for an `stl` or `tetrahedra`; other parts lie along z, in mm"
        );
        if let Some(scale) = self.scale {
            positive("[part] scale", scale)?;
        }
        if let Some(EllipsoidSection { semi_axes }) = self.ellipsoid {
            for semi_axis in semi_axes {
                positive("[part.ellipsoid] semi_axes", semi_axis)?;
            }
            let shortest = semi_axes.into_iter().fold(f64::INFINITY, f64::min);
            let longest = semi_axes.into_iter().fold(0.0, f64::max);
            // Beyond, its ends are sharper than its triangles; or it has some hundred thousand of them.
            within("[mesh] edge of a [part.ellipsoid]", edge, 0.01 * longest, shortest)?;
        }
        if let Some(sphere) = self.sphere {
            positive("[part.sphere] radius", sphere.radius)?;
            ensure!(
                (1..=MOST_SUBDIVISIONS).contains(&sphere.subdivisions),
                "[part.sphere] subdivisions is {}, but it must lie between 1 and {MOST_SUBDIVISIONS}",
                sphere.subdivisions
            );
        }
        Ok(())
    }
}

/// 6 make some 80 000 triangles.
const MOST_SUBDIVISIONS: usize = 6;
