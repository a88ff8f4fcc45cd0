//! The stability benchmarks: the scene files under `verify/stability`, built into the program.
//!
//! A scene that is no sensible one is a benchmark too: its ending is `refused`, and the program must say why.

use std::path::Path;

use anyhow::{Context, ensure};

use super::files::{SceneFolder, title};
use crate::io::toml_file;
use crate::mesh::ShellElement;
use crate::scene::material::positive;
use crate::scene::scene_file::SceneFile;
use crate::scene::verify_section::{MeshSize, SameAs, VerifySection};

/// A benchmark.
#[derive(Debug)]
pub(crate) struct StabilityCase {
    /// Its file's name without the ending.
    pub name: &'static str,
    /// Its file's path in the repository.
    pub file: String,
    /// What the file's first line says it is.
    pub title: String,
    /// The scene; where it is refused, why.
    pub scene: Result<SceneFile, String>,
    pub verify: VerifySection,
}

/// One way to run a case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Variant {
    /// The scene's own where none.
    pub mesh: Option<MeshSize>,
    pub element: ShellElement,
    /// By how much a watch may miss its reference, % of the largest reference value.
    pub error: Option<f64>,
}

/// How a run may end without a path.
pub(crate) const REJECTED: &str = "rejected";
pub(crate) const REFUSED: &str = "refused";

/// All endings that a file may allow: those of a path, and those without one.
const ENDINGS: [&str; 11] = [
    "reached",
    "snapped_and_continued",
    "limit_point",
    "unstable",
    "ballooning",
    "self_touch",
    "inverted",
    "stalled",
    "budget_spent",
    REJECTED,
    REFUSED,
];

/// The case of a name in [`FOLDER`], read and checked.
pub(crate) fn case(name: &str) -> anyhow::Result<StabilityCase> {
    let (name, file, text) = FOLDER.file(name)?;
    let table: toml::Table = toml_file::parse(text, Path::new(&file))?;
    let verify = table.get("verify").with_context(|| format!("{file} has no [verify]"))?;
    let verify: VerifySection =
        verify.clone().try_into().with_context(|| format!("{file}: [verify]"))?;
    let scene = read(text, &file).map_err(|error| format!("{error:#}"));
    let case = StabilityCase { name, title: title(text), scene, verify, file };
    case.check().with_context(|| case.file.clone())?;
    Ok(case)
}

fn read(text: &str, file: &str) -> anyhow::Result<SceneFile> {
    let scene: SceneFile = toml_file::parse(text, Path::new(file))?;
    scene.check()?;
    Ok(scene)
}

impl StabilityCase {
    /// The ways to run it: those that it accepts, or the one of its scene.
    pub(crate) fn variants(&self) -> Vec<Variant> {
        let VerifySection { accept, error, .. } = &self.verify;
        if accept.is_empty() {
            let element = self.scene.as_ref().ok().and_then(|s| s.wall.element).unwrap_or_default();
            return vec![Variant { mesh: None, element, error: *error }];
        }
        let variant = |mesh, element, error| Variant { mesh: Some(mesh), element, error };
        accept.iter().map(|a| variant(a.mesh, a.element, Some(a.error))).collect()
    }

    fn check(&self) -> anyhow::Result<()> {
        let verify = &self.verify;
        ensure!(!verify.endings.is_empty(), "[verify] names no endings");
        for ending in &verify.endings {
            ensure!(
                ENDINGS.contains(&ending.as_str()),
                "[verify] endings: there is no ending `{ending}`; there are {}",
                ENDINGS.join(", ")
            );
        }
        ensure!(!verify.why.trim().is_empty(), "[verify] has no `why`");
        positive("[verify] agreement", verify.agreement)?;
        positive("[verify] seconds", verify.seconds.context("[verify] has no `seconds`")?)?;
        if let Some(error) = verify.error {
            positive("[verify] error", error)?;
        }
        ensure!(
            verify.snaps.is_none_or(|[least, most]| least <= most),
            "[verify] snaps wants the smaller number first"
        );
        ensure!(
            verify.ends_between.is_none_or(|[least, most]| least < most),
            "[verify] ends_between wants the smaller number first"
        );
        ensure!(
            verify.reference.is_empty() || !verify.source.trim().is_empty(),
            "[verify] has a reference, but no `source`"
        );
        ensure!(
            verify.reference.is_empty() || verify.error.is_some() || !verify.accept.is_empty(),
            "[verify] has a reference, but no `error` that is accepted"
        );
        if let Some(SameAs { case, factor }) = &verify.same_as {
            FOLDER.file(case).context("[verify] same_as")?;
            positive("[verify] same_as factor", *factor)?;
        }
        self.scene.as_ref().map_or(Ok(()), |scene| verify.check(scene))
    }
}

macro_rules! files {
    ($($name:literal),* $(,)?) => {
        [$(($name, include_str!(concat!("../../verify/stability/", $name, ".toml")))),*]
    };
}

/// The scenes of all cases.
pub(crate) const FOLDER: SceneFolder = SceneFolder { path: "verify/stability", files: &FILES };

const FILES: [(&str, &str); 38] = files![
    "nu_049",
    "nu_0499",
    "nu_04999",
    "strip_1e3",
    "strip_1e4",
    "slivers",
    "valence_10",
    "spiral_touching",
    "spiral_untouchable",
    "bellows_crushed",
    "bellows_untouchable",
    "tube_kink",
    "cushion_round",
    "cushion_square",
    "two_snaps",
    "balloon_pressure",
    "tube_vacuum_untouchable",
    "tube_vacuum",
    "plane_at_hand",
    "friction_0",
    "friction_10",
    "plane_beside",
    "planes_on_both_sides",
    "gas_past_limit",
    "volume_past_limit",
    "plate_in_mm",
    "plate_in_um",
    "plate_in_m",
    "pins_only",
    "foil",
    "thick_sphere",
    "soft",
    "stiff",
    "feather",
    "cap",
    "flat_membrane",
    "half_ring_on_plane",
    "cylinder_crushed",
];

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::scene::part::PartFiles;
    use crate::verify::files::{BuiltIn, NETWORKS, SURFACES};

    fn cases() -> Vec<StabilityCase> {
        FOLDER.names().map(|name| case(name).unwrap_or_else(|error| panic!("{error:#}"))).collect()
    }

    #[test]
    fn every_file_of_the_folder_is_a_case() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/verify/stability");
        let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        let mut files: Vec<String> = entries
            .filter(|path| path.is_file())
            .map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned())
            .collect();
        files.sort();
        let mut listed: Vec<&str> = FOLDER.names().collect();
        listed.sort_unstable();
        assert_eq!(files, listed);
        assert_eq!(cases().len(), listed.len());
    }

    /// A scene is refused only where that is its ending.
    #[test]
    fn scenes_are_read() {
        for case in cases() {
            let Err(message) = &case.scene else { continue };
            let is_meant = case.verify.endings.iter().any(|ending| ending == REFUSED);
            assert!(is_meant, "{}: {message}", case.name);
        }
    }

    /// Whoever is the same as another is run after it, or there is nothing to compare with.
    #[test]
    fn models_come_before_their_likes() {
        let names: Vec<&str> = FOLDER.names().collect();
        for case in cases() {
            let Some(SameAs { case: model, .. }) = &case.verify.same_as else { continue };
            let place = |name: &str| names.iter().position(|known| *known == name).unwrap();
            assert!(place(model) < place(case.name), "{}", case.name);
        }
    }

    /// What a case names is what stands in its place in the repository.
    #[test]
    fn built_in_files_are_those_of_the_repository() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        for (path, text) in NETWORKS {
            assert_eq!(fs::read_to_string(root.join(path)).unwrap(), text);
            BuiltIn.network(Path::new(path)).unwrap();
        }
        for (path, bytes) in SURFACES {
            assert_eq!(fs::read(root.join(path)).unwrap(), bytes);
            let surface = BuiltIn.surface(Path::new(path)).unwrap();
            surface.check_closed_manifold().unwrap();
        }
        let used = |file: &str| {
            let name = file.rsplit('/').next().unwrap();
            FOLDER.files.iter().any(|(_, text)| text.contains(&format!("parts/{name}\"")))
        };
        let own = NETWORKS.iter().map(|(path, _)| *path).chain(SURFACES.map(|(path, _)| path));
        for file in own.filter(|path| path.starts_with(FOLDER.path)) {
            assert!(used(file), "{file}");
        }
    }
}
