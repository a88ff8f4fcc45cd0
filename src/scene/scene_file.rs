//! The scene file of `simulate`: one part, its wall, its load, what holds it, and the planes it may touch.

use std::path::Path;

use anyhow::{Context, bail, ensure};
use schemars::JsonSchema;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize};

use super::checks::{check_distance, check_normal, check_shell, check_solver};
use super::gravity::GravitySection;
use super::limits::{LimitsSection, OfMaterial, material_limits};
use super::material::{MaterialSection, positive, within};
use super::mesh_section::{Edge, MeshSection};
use super::part::Part;
use super::pattern::PatternSection;
use super::region::{COORDINATES, PARAMETERS, RegionSection, Regions};
use super::verify_section::{MeshSize, VerifySection};
use super::watch::{WatchSection, Watchable};
use crate::field::DesignBox;
use crate::fitness::{FidelitySettings, LoadSettings, WallPattern};
use crate::io::toml_file;
use crate::math::Vec3;
use crate::mesh::ShellSettings;
use crate::model::contact::{PlaneSettings, SelfContactSettings};
use crate::model::material::Material;
use crate::model::{FoldContact, MaterialLimits, PartSetup};
use crate::scene::part::patch_part::{
    EdgeSection, ForceSection, MomentSection, PatchConditions, PinSection, check_patch_pressure,
};
use crate::scene::part::solid_part::SolidSection;
use crate::solve::{Backend, LinearMethod, PathSettings, Programme, Supply};

/// A scene file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct SceneFile {
    pub part: Part,
    /// For a network: where the chamber may be, mm.
    #[serde(rename = "box", default)]
    pub design_box: DesignBox,
    /// How finely a network, an STL file or an ellipsoid is meshed.
    #[serde(default)]
    pub mesh: MeshSection,
    #[serde(default)]
    pub wall: ShellSettings,
    #[serde(default)]
    pub material: MaterialSection,
    /// What the material may bear: a path that reaches it ends there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limits: Option<LimitsSection>,
    /// For a network that says what its wall is made of: what it may say.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pattern: Option<PatternSection>,
    /// Where the wall is thicker, thinner or of another material; none is listed, it is the same everywhere.
    #[serde(default, rename = "region", skip_serializing_if = "Vec::is_empty")]
    pub regions: Vec<RegionSection>,
    #[serde(default)]
    pub load: LoadSection,
    #[serde(default = "default_solver")]
    pub solver: SolverSection,
    /// Keeps the folds of the wall apart; without it a touch ends the path, unless `[load] may_overlap` lets them pass unseen.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub self_contact: Option<SelfContactSection>,
    /// The weight of the wall, which acts whole from the start, whatever the load.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gravity: Option<GravitySection>,
    /// The wall as a solid, instead of a shell.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub solid: Option<SolidSection>,
    /// Rigid planes; none is listed, none is computed.
    #[serde(default, rename = "plane", skip_serializing_if = "Vec::is_empty")]
    pub planes: Vec<Plane>,
    /// For a patch: its sides; what is not listed is free.
    #[serde(default, rename = "edge", skip_serializing_if = "Vec::is_empty")]
    pub edges: Vec<EdgeSection>,
    /// For a patch: vertices that do not move along some axes.
    #[serde(default, rename = "pin", skip_serializing_if = "Vec::is_empty")]
    pub pins: Vec<PinSection>,
    /// For a patch: forces, with or instead of a pressure.
    #[serde(default, rename = "force", skip_serializing_if = "Vec::is_empty")]
    pub forces: Vec<ForceSection>,
    /// For a patch: dead moments along its sides.
    #[serde(default, rename = "moment", skip_serializing_if = "Vec::is_empty")]
    pub moments: Vec<MomentSection>,
    /// What is followed along the path.
    #[serde(default, rename = "watch", skip_serializing_if = "Vec::is_empty")]
    pub watches: Vec<WatchSection>,
    /// What `verify` compares with; `simulate` reads past it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(skip)]
    pub verify: Option<VerifySection>,
}

/// What drives the part, and how its path is walked.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct LoadSection {
    /// Largest pressure, MPa, below 0 for a vacuum: in the chamber, or on a patch towards its normal `x,s cross x,t`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pressure: Option<f64>,
    /// Instead of a pressure, for a closed part: the volume at the end, as a multiple of that at rest; the pressure is what it takes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub volume_ratio: Option<f64>,
    /// As `volume_ratio`, but the volume itself, mm^3 (that inside the middle of the wall, of a solid the chamber's).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub volume_mm3: Option<f64>,
    #[serde(skip_serializing)]
    #[schemars(skip)]
    pub volume: Option<FormerVolume>,
    /// Instead of a pressure, for a closed part: gas is let in, and keeps what it is; `gas = { amount = 1.3 }`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gas: Option<GasSection>,
    /// Whether the whole curve of equilibria is traced, stable or not, instead of snapping over what is not.
    pub curve: bool,
    /// The stretch of the wall beyond which the path ends as ballooning.
    pub stretch_bound: f64,
    /// Whether the wall may pass through itself unseen; if not, a touch ends the path where there is no `[self_contact]`.
    pub may_overlap: bool,
    /// Whether the answer is that of the linear theory: one linear solve at rest.
    pub linear: bool,
    pub path: PathSettings,
}

impl Default for LoadSection {
    fn default() -> Self {
        let LoadSettings { stretch_bound, path, .. } = LoadSettings::default();
        Self {
            pressure: None,
            volume_ratio: None,
            volume_mm3: None,
            volume: None,
            gas: None,
            curve: false,
            stretch_bound,
            may_overlap: false,
            linear: false,
            path,
        }
    }
}

/// `volume`, a multiple in earlier versions, which was taken for mm^3: whoever gives it is told its two names.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum FormerVolume {}

impl<'de> Deserialize<'de> for FormerVolume {
    fn deserialize<D: Deserializer<'de>>(_: D) -> Result<Self, D::Error> {
        Err(D::Error::custom(
            "`volume` has no unit; write `volume_ratio`, a multiple of the volume at rest as it was, or `volume_mm3`",
        ))
    }
}

/// An amount of gas that is raised from what the part holds at rest; isothermal.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a section, written gas = { amount = 1.3 }")]
pub(crate) struct GasSection {
    /// The amount at the end, as a multiple of that at rest; 1 seals the chamber.
    pub amount: f64,
    /// Volume of the line that shares the gas, mm^3.
    #[serde(default)]
    pub dead_volume: f64,
    /// Absolute pressure outside, MPa.
    #[serde(default = "standard_atmosphere")]
    pub atmosphere: f64,
}

/// MPa.
fn standard_atmosphere() -> f64 {
    0.101_325
}

/// Contact of the wall with itself.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct SelfContactSection {
    /// Gap at which folds begin to push each other, in thicknesses.
    pub activation: f64,
    /// About how hard they press, MPa; by default the largest pressure, or a hundredth of the shear modulus where there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pressure: Option<f64>,
}

impl Default for SelfContactSection {
    fn default() -> Self {
        Self { activation: 0.2, pressure: None }
    }
}

/// A rigid plane.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Plane {
    /// Direction towards the part.
    pub normal: [f64; 3],
    /// Distance from the outermost point of the outer wall (of a patch: of the nearer face) at rest, mm.
    pub distance: f64,
    /// Coulomb's coefficient; 0 computes none.
    #[serde(default)]
    pub friction: f64,
    /// Slip within which friction is mobilised, in wall thicknesses.
    #[serde(default = "default_elastic_slip")]
    pub elastic_slip: f64,
}

fn default_elastic_slip() -> f64 {
    PlaneSettings::new(Vec3::x(), 1.0, 1.0).elastic_slip
}

/// Which solver finds the equilibria, and how.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct SolverSection {
    /// Which library finds the equilibria; by default PETSc where it is built in.
    #[serde(default = "default_backend")]
    pub backend: Backend,
    /// How linear systems are solved.
    #[serde(default)]
    pub linear: LinearMethod,
}

/// PETSc where it is built in: a single scene has the process to itself.
fn default_backend() -> Backend {
    if Backend::Petsc.is_built_in() { Backend::Petsc } else { Backend::Native }
}

pub(super) fn default_solver() -> SolverSection {
    SolverSection { backend: default_backend(), linear: LinearMethod::Automatic }
}

impl SceneFile {
    /// Reads and checks a scene file.
    pub(crate) fn read(path: &Path, solver: Option<Backend>) -> anyhow::Result<Self> {
        let mut scene: Self = toml_file::read(path)?;
        scene.solver.backend = solver.unwrap_or(scene.solver.backend);
        scene.check().with_context(|| path.display().to_string())?;
        Ok(scene)
    }

    /// Checks everything that can be checked without the files it names.
    pub(crate) fn check(&self) -> anyhow::Result<()> {
        check_solver(self.solver.backend)?;
        ensure!(
            self.solver
                != SolverSection { backend: Backend::Native, linear: LinearMethod::Iterative },
            "[solver] linear = \"iterative\" is PETSc's; set backend = \"petsc\""
        );
        check_shell(&self.wall, &self.load_settings())?;
        self.mesh.check(&self.part, self.design_box)?;
        self.materials()?;
        let has_limits = !self.limits()?.is_empty();
        ensure!(
            !has_limits || !self.load.linear,
            "[load] linear knows no limit; take it away, or walk the path without [limits]"
        );
        ensure!(
            self.pattern.is_none() || self.part.network.is_some(),
            "[pattern] wants a [part] with a `network`, which says where the wall is another one; see [[region]]"
        );
        for plane in &self.planes {
            check_normal("[[plane]] normal", plane.normal)?;
            check_distance("[[plane]] distance", plane.distance)?;
            within("[[plane]] friction", plane.friction, 0.0, MOST_FRICTION)?;
            within("[[plane]] elastic_slip", plane.elastic_slip, 1e-6, 1.0)?;
        }
        if let Some(section) = &self.self_contact {
            within("[self_contact] activation", section.activation, 0.01, 0.25)?;
            if let Some(pressure) = section.pressure {
                positive("[self_contact] pressure", pressure)?;
            }
        }
        self.gravity.map_or(Ok(()), GravitySection::check)?;
        ensure!(
            self.gravity.is_none() || !self.load.linear,
            "[load] linear answers to the load alone, without a weight; take it away, or [gravity]"
        );
        if let Some(section) = &self.solid {
            section.check()?;
            ensure!(
                self.part.network.is_some() || self.part.stl.is_some(),
                "[solid] wants a [part] with a `network` or an `stl`"
            );
            ensure!(
                section.coarser.is_none() && section.fidelity == FidelitySettings::default(),
                "[solid] coarser and fidelity are for `certify` and run files; a scene has one solid"
            );
            for material in self.materials()? {
                section.check_material(&material)?;
            }
        }
        let is_solid = self.solid.is_some() || self.part.tetrahedra.is_some();
        ensure!(
            self.part.tetrahedra.is_none() || self.regions.is_empty(),
            "a [[region]] is one of a shell's middle; tetrahedra of your own have none"
        );
        ensure!(
            self.self_contact.is_none() || !is_solid,
            "[self_contact] is modelled between shells alone; take it away, or the solid"
        );
        self.check_conditions()
    }

    /// The materials of the wall: that of `[material]`, that of the pattern, those of the regions.
    pub(crate) fn materials(&self) -> anyhow::Result<Vec<Material>> {
        let mut materials = vec![self.material.material()?];
        materials.extend(self.pattern()?.material);
        Regions::append_materials(&self.regions, &mut materials)?;
        Ok(materials)
    }

    /// What each of its [`Self::materials`] may bear; none where nothing is said of any.
    fn limits(&self) -> anyhow::Result<Vec<MaterialLimits>> {
        let others = self.pattern.iter().map(PatternSection::limited);
        let others = others.chain(self.regions.iter().map(RegionSection::limited));
        let first = OfMaterial::first(&self.material, self.limits.as_ref());
        material_limits(first, others, self.load.stretch_bound)
    }

    /// What its network may say of the wall.
    pub(crate) fn pattern(&self) -> anyhow::Result<WallPattern> {
        self.pattern.as_ref().map_or_else(|| Ok(WallPattern::default()), PatternSection::pattern)
    }

    /// Where the wall is another one.
    pub(crate) fn regions(&self) -> anyhow::Result<Regions<'_>> {
        let variables = if self.part.patch.is_some() { PARAMETERS } else { COORDINATES };
        let first = 1 + u16::from(self.pattern()?.material.is_some());
        Regions::new(&self.regions, variables, first)
    }

    /// The barrier between folds of the wall, if they are kept apart.
    fn self_contact(&self) -> anyhow::Result<Option<SelfContactSettings>> {
        let Some(section) = self.self_contact else { return Ok(None) };
        let of_load = || match (&self.part.patch, self.load.pressure) {
            (Some(_), pressure) => self.pressing(pressure.unwrap_or(0.0)),
            (None, _) => self.pressing(self.load_settings().pressure),
        };
        let pressure = section.pressure.map_or_else(of_load, anyhow::Ok)?;
        let activation = section.activation * self.wall.thickness;
        Ok(Some(SelfContactSettings::beginning_at(activation, pressure)))
    }

    /// What the part stands among, under about this `pressure` (MPa): its planes, its folds, the bound on its stretch.
    pub(crate) fn setup(&self, pressure: f64) -> anyhow::Result<PartSetup> {
        let folds = match self.self_contact()? {
            Some(settings) => FoldContact::Barrier(settings),
            None if self.load.may_overlap => FoldContact::Unseen,
            None => FoldContact::Ends,
        };
        Ok(PartSetup {
            planes: self.plane_settings(pressure)?,
            folds: Some(folds),
            stretch_bound: self.load_settings().stretch_bound,
            limits: self.limits()?,
            body_force: self.gravity.map_or(Vec3::zeros(), GravitySection::body_force),
        })
    }

    /// Checks that supports, loads and watches fit the part.
    fn check_conditions(&self) -> anyhow::Result<()> {
        let conditions = PatchConditions {
            edges: &self.edges,
            pins: &self.pins,
            forces: &self.forces,
            moments: &self.moments,
            watches: &self.watches,
        };
        let patch = &self.part.patch;
        let watchable = match patch {
            Some(_) => Watchable::Patch,
            None if self.part.is_free() => Watchable::FreeBody,
            None => Watchable::Actuator,
        };
        for (i, watch) in self.watches.iter().enumerate() {
            watch.check(watchable)?;
            ensure!(
                self.watches[..i].iter().all(|before| before.name != watch.name),
                "[[watch]] lists the name {:?} twice",
                watch.name
            );
        }
        ensure!(
            !self.load.linear || self.planes.is_empty(),
            "[load] linear knows no contact; take the [[plane]] away, or walk the path"
        );
        ensure!(
            watchable != Watchable::Actuator || !self.load.linear,
            "[load] linear wants a patch, a sphere or an ellipsoid"
        );
        match self.load.pressure {
            // No pressure at all: what else loads or deforms the part is asked for.
            Some(0.0) | None => {}
            Some(pressure) if patch.is_some() => check_patch_pressure(pressure)?,
            Some(pressure) => drop(positive("[load] pressure", pressure.abs())?),
        }
        if let Some(patch) = patch {
            patch.check()?;
            conditions.check(patch)?;
        } else {
            let listed = [
                ("edge", self.edges.is_empty()),
                ("pin", self.pins.is_empty()),
                ("force", self.forces.is_empty()),
                ("moment", self.moments.is_empty()),
            ];
            if let Some((name, _)) = listed.iter().find(|(_, is_empty)| !is_empty) {
                bail!("[[{name}]] wants a [part.patch], which alone has sides, `s` and `t`");
            }
        }
        self.check_supply()?;
        self.part.check(self.mesh.settings().edge)?;
        ensure!(
            self.part.patch.is_none() || self.has_load() || self.is_only_heavy(),
            "a [part.patch] wants a load other than zero: [load] pressure, [[force]] or [[moment]], or [gravity] without a curve"
        );
        Ok(())
    }

    /// Whether it has a weight and is driven by a load that may be zero.
    fn is_only_heavy(&self) -> bool {
        self.gravity.is_some() && !self.load.curve
    }

    /// Checks the keys of `[load]` that say what is given.
    fn check_supply(&self) -> anyhow::Result<()> {
        let LoadSection { pressure, volume_ratio, volume_mm3, gas, curve, linear, .. } = self.load;
        let supplies = [
            ("pressure", pressure.is_some()),
            ("volume_ratio", volume_ratio.is_some()),
            ("volume_mm3", volume_mm3.is_some()),
            ("gas", gas.is_some()),
        ];
        let manners = [("curve", curve), ("linear", linear)];
        let given = |keys: &[(&'static str, bool)]| -> Vec<&'static str> {
            keys.iter().filter(|(_, given)| *given).map(|(key, _)| *key).collect()
        };
        let (supplies, manners) = (given(&supplies), given(&manners));
        ensure!(
            supplies.len() <= 1,
            "[load] has both `{}`, but one of them follows from the other; give one",
            supplies.join("` and `")
        );
        // Both are ways in which a pressure, or the loads of a patch, are applied.
        let [first, second] = [supplies.first(), manners.first()].map(|key| key.copied());
        if let (Some(supply @ ("volume_ratio" | "volume_mm3" | "gas")), Some(manner)) =
            (first, second)
        {
            bail!("[load] has both `{supply}` and `{manner}`, which wants a `pressure`; give one");
        }
        ensure!(manners.len() <= 1, "[load] has both `curve` and `linear`; give one");
        let is_driven = volume_ratio.is_some() || volume_mm3.is_some() || gas.is_some();
        ensure!(
            self.part.patch.is_none() || !is_driven,
            "[load] volume_ratio, volume_mm3 and gas want a closed part; a [part.patch] encloses nothing"
        );
        if let Some(ratio) = volume_ratio {
            within("[load] volume_ratio", ratio, LEAST_RATIO, LARGEST_RATIO)?;
        }
        if let Some(volume) = volume_mm3 {
            positive("[load] volume_mm3", volume)?;
        }
        if let Some(GasSection { amount, dead_volume, atmosphere }) = gas {
            within("[load] gas amount", amount, LEAST_RATIO, LARGEST_RATIO)?;
            within("[load] gas dead_volume", dead_volume, 0.0, 1e12)?;
            positive("[load] gas atmosphere", atmosphere)?;
        }
        Ok(())
    }

    /// The same scene on another mesh of its part.
    pub(crate) fn with_mesh(&self, mesh: MeshSize) -> anyhow::Result<Self> {
        let mut scene = self.clone();
        match (mesh, &mut scene.part) {
            (MeshSize::Cells(cells), Part { patch: Some(patch), .. }) => patch.cells = cells,
            (MeshSize::Subdivisions(n), Part { sphere: Some(sphere), .. }) => {
                sphere.subdivisions = n;
            }
            (MeshSize::Edge(edge), Part { patch: None, sphere: None, .. }) => {
                scene.mesh.edge = Some(Edge::Length(edge));
            }
            _ => bail!(
                "[verify] mesh {mesh} fits no part here: a patch wants [n, m], a sphere a whole number, other parts an edge in mm as 3.0"
            ),
        }
        Ok(scene)
    }

    fn has_load(&self) -> bool {
        // A moment is refused where it is zero.
        self.load.pressure.is_some_and(|pressure| pressure != 0.0)
            || !self.moments.is_empty()
            || self.forces.iter().any(ForceSection::acts)
    }

    /// The largest load and how its path is walked; the load of a patch is the share of all its loads, 1 at most.
    pub(crate) fn load_settings(&self) -> LoadSettings {
        let of_verify = || self.verify.as_ref().and_then(|verify| verify.pressure);
        let given = self.load.pressure.or_else(of_verify);
        let pressure = given.unwrap_or(LoadSettings::default().pressure);
        let largest = if self.part.patch.is_some() { 1.0 } else { pressure };
        LoadSettings {
            pressure: largest,
            rated: None,
            stretch_bound: self.load.stretch_bound,
            path: self.load.path,
        }
    }

    /// What the path is driven through, for a part that encloses `volume_at_rest` (mm^3).
    ///
    /// # Errors
    /// When the volume at the end is none that the part can have.
    pub(crate) fn programme(&self, volume_at_rest: f64) -> anyhow::Result<Programme> {
        let driven = |supply, end| Programme::Driven { supply, end };
        let LoadSection { volume_ratio, volume_mm3, gas, curve, .. } = self.load;
        if let Some(ratio) = volume_ratio {
            return Ok(driven(Supply::Conjugate, ratio * volume_at_rest));
        }
        if let Some(volume) = volume_mm3 {
            let ratio = volume / volume_at_rest;
            ensure!(
                (LEAST_RATIO..=LARGEST_RATIO).contains(&ratio),
                "[load] volume_mm3 is {volume:?}, but the part encloses {volume_at_rest:.4} mm^3 at rest"
            );
            return Ok(driven(Supply::Conjugate, volume));
        }
        Ok(match gas {
            Some(GasSection { amount, dead_volume, atmosphere }) => {
                driven(Supply::Gas { atmosphere, dead_volume, volume_at_rest }, amount)
            }
            None if curve => Programme::Curve { end: self.load_settings().pressure },
            None => self.load_settings().pressure.into(),
        })
    }

    /// The planes, their barriers fit for a `pressure` of this size (MPa), or for the material where there is none.
    fn plane_settings(&self, pressure: f64) -> anyhow::Result<Vec<PlaneSettings>> {
        let pressure = self.pressing(pressure)?;
        let settings = |plane: &Plane| PlaneSettings {
            friction: plane.friction,
            elastic_slip: plane.elastic_slip,
            ..PlaneSettings::new(Vec3::from(plane.normal).normalize(), plane.distance, pressure)
        };
        Ok(self.planes.iter().map(settings).collect())
    }

    /// About how hard surfaces press under this `pressure`, MPa.
    fn pressing(&self, pressure: f64) -> anyhow::Result<f64> {
        if pressure == 0.0 {
            return Ok(SHARE_OF_STIFFNESS * self.material.material()?.shear_modulus());
        }
        Ok(pressure.abs())
    }
}

/// Multiples of a volume or an amount of gas at rest that a part may be driven to.
const LEAST_RATIO: f64 = 1e-3;
const LARGEST_RATIO: f64 = 1e6;

/// Beyond, nothing slides.
const MOST_FRICTION: f64 = 100.0;

/// Pressure between folds that no pressure presses together, as a share of the shear modulus.
const SHARE_OF_STIFFNESS: f64 = 0.01;
