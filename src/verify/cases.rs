//! The benchmarks: the scene files under `verify/shells` and `verify/curves`, built into the program.

use std::path::Path;

use anyhow::{Context, ensure};

use super::files::{SceneFolder, title};
use crate::io::toml_file;
use crate::scene::scene_file::SceneFile;
use crate::scene::verify_section::VerifySection;

/// A benchmark.
#[derive(Debug)]
pub(crate) struct Case {
    /// Its file's name without the ending.
    pub name: &'static str,
    /// What the file's first line says it is.
    pub title: String,
    pub scene: SceneFile,
    pub verify: VerifySection,
}

/// Textbook shells.
pub const SHELLS: SceneFolder = SceneFolder { path: "verify/shells", files: &SHELL_FILES };

/// Paths that lose their stability, turn back, or have no potential.
pub const CURVES: SceneFolder = SceneFolder { path: "verify/curves", files: &CURVE_FILES };

/// The case of a name in `folder`, read and checked.
pub(crate) fn case(folder: &SceneFolder, name: &str) -> anyhow::Result<Case> {
    let (name, file, text) = folder.file(name)?;
    let scene: SceneFile = toml_file::parse(text, Path::new(&file))?;
    scene.check().with_context(|| file.clone())?;
    let verify = scene.verify.clone().with_context(|| format!("{file} has no [verify]"))?;
    ensure!(!verify.meshes.is_empty(), "{file}: [verify] meshes is empty");
    ensure!(!verify.accept.is_empty(), "{file}: [verify] accepts nothing");
    verify.check(&scene).with_context(|| file.clone())?;
    Ok(Case { name, title: title(text), scene, verify })
}

macro_rules! files {
    ($folder:literal: $($name:literal),* $(,)?) => {
        [$(($name, include_str!(concat!("../../verify/", $folder, "/", $name, ".toml")))),*]
    };
}

const CURVE_FILES: [(&str, &str); 11] = files!["curves":
    "balloon_neo_hookean",
    "balloon_mooney_rivlin",
    "hinged_roof_thick",
    "hinged_roof_thin",
    "von_mises_truss",
    "pinned_arch",
    "column_perfect",
    "column_elastica",
    "ring_external_pressure",
    "follower_tip_force",
    "follower_pressure",
];

const SHELL_FILES: [(&str, &str); 32] = files!["shells":
    "scordelis_lo",
    "pinched_cylinder",
    "pinched_cylinder_free",
    "pinched_cylinder_free_thin",
    "hemisphere",
    "hemisphere_hole",
    "twisted_beam_thick_in_plane",
    "twisted_beam_thick_out_of_plane",
    "twisted_beam_thin_in_plane",
    "twisted_beam_thin_out_of_plane",
    "twisted_plate",
    "raasch_hook",
    "hypar_100",
    "hypar_1000",
    "hypar_10000",
    "cantilever_shear",
    "cantilever_elastica",
    "cantilever_moment",
    "slit_annular_plate",
    "hemisphere_hole_large",
    "open_cylinder_pulled",
    "pinched_cylinder_large",
    "pinched_semi_cylinder",
    "hinged_roof_thick",
    "hinged_roof_thin",
    "balloon_thin",
    "balloon_thick",
    "tube_thick",
    "ellipsoid",
    "basic_bend",
    "pneunet",
    "paper",
];

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::math::Vec3;
    use crate::mesh::Side;
    use crate::scene::part::patch_part::{Axis, EdgeSection, PatchSection};
    use crate::scene::verify_section::KnownMiss;
    use crate::scene::watch::Watched;

    fn cases() -> Vec<Case> {
        let read = |name| case(&SHELLS, name).unwrap_or_else(|error| panic!("{error:#}"));
        SHELLS.names().map(read).collect()
    }

    #[test]
    fn every_file_of_the_folder_is_a_case_and_complete() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/verify/shells");
        let mut files: Vec<String> = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        files.sort();
        let mut listed: Vec<String> = SHELLS.names().map(|name| format!("{name}.toml")).collect();
        listed.sort();
        assert_eq!(files, listed);
        for case in cases() {
            let Case { name, scene, verify, .. } = case;
            for watch in &scene.watches {
                let compared = verify.reference.iter().filter(|r| r.watch == watch.name).count();
                assert_eq!(compared, 1, "{name}: {}", watch.name);
            }
            assert!(!verify.source.is_empty() && !verify.accept.is_empty(), "{name}");
            for accepted in &verify.accept {
                let twice = verify.accept.iter().filter(|a| a.element == accepted.element).count();
                assert_eq!(twice, 1, "{name}");
            }
        }
    }

    /// A reason is not given away: the one case that has it has it for both elements, and an empty one is refused.
    #[test]
    fn known_misses_have_a_reason() {
        for case in cases() {
            let misses = case.verify.accept.iter().filter(|accept| accept.miss.is_some()).count();
            let known = if case.name == "pinched_cylinder_large" { 2 } else { 0 };
            assert_eq!(misses, known, "{}", case.name);
        }
        let Case { scene, mut verify, .. } = case(&SHELLS, "pinched_cylinder_large").unwrap();
        verify.accept[0].miss = Some(KnownMiss { up_to: 20.0, why: " ".to_owned() });
        let error = verify.check(&scene).unwrap_err().to_string();
        assert_eq!(error, "[[verify.accept]] miss has no `why`");
    }

    #[test]
    fn an_unknown_case_names_the_nearest() {
        let error = case(&SHELLS, "scordelis").unwrap_err().to_string();
        assert_eq!(
            error,
            "there is no case `scordelis`; the nearest is `scordelis_lo`; --list shows all"
        );
    }

    /// Triangles on every mesh of the ladder have areas, and their normals do not turn over from one to the next.
    #[test]
    fn patches_are_regular() {
        for case in cases() {
            let Some(patch) = &case.scene.part.patch else { continue };
            let surface = patch.surface().unwrap();
            for mesh in &case.verify.meshes {
                let refined = case.scene.with_mesh(*mesh).unwrap();
                let patch = refined.part.patch.as_ref().unwrap();
                let normals = cell_normals(patch, &surface);
                for (before, after) in normals.iter().zip(&normals[1..]) {
                    assert!(before.norm() > 0.0, "{} {mesh}", case.name);
                    assert!(before.dot(after) > 0.0, "{} {mesh}: {before:?} {after:?}", case.name);
                }
            }
        }
    }

    /// Vector areas of the cells, in rows that turn back at their ends.
    fn cell_normals(patch: &PatchSection, surface: &dyn Fn(f64, f64) -> Vec3) -> Vec<Vec3> {
        let [n, m] = patch.cells;
        let at = |i: usize, j: usize| {
            let along = |[low, high]: [f64; 2], i: usize, n: usize| {
                low + (high - low) * i as f64 / n as f64
            };
            surface(along(patch.s, i, n), along(patch.t, j, m))
        };
        let places = (0..m)
            .flat_map(|j| (0..n).map(move |i| if j % 2 == 0 { (i, j) } else { (n - 1 - i, j) }));
        places
            .map(|(i, j)| (at(i + 1, j + 1) - at(i, j)).cross(&(at(i, j + 1) - at(i + 1, j))) * 0.5)
            .collect()
    }

    /// A side of symmetry lies in its plane, and the surface beyond it is the mirror image of that before it.
    #[test]
    fn sides_of_symmetry_are_mirrors() {
        let mut mirrors = 0;
        for case in cases() {
            let Some(patch) = &case.scene.part.patch else { continue };
            let surface = patch.surface().unwrap();
            let size = (surface(patch.s[0], patch.t[0]) - surface(patch.s[1], patch.t[1])).norm();
            for EdgeSection { side, symmetry, .. } in &case.scene.edges {
                let Some(axis) = symmetry else { continue };
                mirrors += 1;
                let ([s0, s1], [t0, t1]) = (patch.s, patch.t);
                for share in [0.0, 0.3, 1.0] {
                    let (s, t) = (s0 + share * (s1 - s0), t0 + share * (t1 - t0));
                    let (ds, dt) = (0.1 * (s1 - s0), 0.1 * (t1 - t0));
                    let around = |sign: f64| match side {
                        Side::S0 => surface(s0 + sign * ds, t),
                        Side::S1 => surface(s1 + sign * ds, t),
                        Side::T0 => surface(s, t0 + sign * dt),
                        Side::T1 => surface(s, t1 + sign * dt),
                    };
                    let mut image = around(-1.0);
                    let height = around(0.0)[*axis as usize];
                    image[*axis as usize] = 2.0 * height - image[*axis as usize];
                    let miss = (image - around(1.0)).norm();
                    assert!(miss < 1e-12 * size, "{} {side:?}: {miss:e}", case.name);
                }
            }
        }
        assert!(mirrors > 20, "{mirrors}");
    }

    /// A force on planes of symmetry pushes along them, and what is watched there moves along them.
    #[test]
    fn forces_and_watches_respect_the_symmetry() {
        for case in cases() {
            let Some(patch) = &case.scene.part.patch else { continue };
            let allowed = |at: [f64; 2], direction: Vec3| {
                let sides = [
                    (Side::S0, at[0] == patch.s[0]),
                    (Side::S1, at[0] == patch.s[1]),
                    (Side::T0, at[1] == patch.t[0]),
                    (Side::T1, at[1] == patch.t[1]),
                ];
                let normals = case.scene.edges.iter().filter_map(|edge| {
                    let is_on = sides.iter().any(|(side, is_on)| *is_on && *side == edge.side);
                    edge.symmetry.filter(|_| is_on)
                });
                normals.into_iter().all(|axis: Axis| direction[axis as usize] == 0.0)
            };
            for force in &case.scene.forces {
                if let (Some(at), Some(force)) = (force.at, force.force) {
                    assert!(allowed(at, Vec3::from(force)), "{}", case.name);
                }
            }
            for watch in &case.scene.watches {
                if let Watched::Vertex { at, direction } = watch.watched().unwrap() {
                    assert!(allowed(at, direction), "{} {}", case.name, watch.name);
                }
            }
        }
    }
}
