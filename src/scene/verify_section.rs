//! `[verify]` of a scene file: what its watches are compared with, on which meshes, and how near they must come.

use std::fmt;

use anyhow::{Context, ensure};
use serde::{Deserialize, Serialize};

use super::material::positive;
use super::scene_file::SceneFile;
use crate::mesh::ShellElement;

/// What is expected of a scene: references on a ladder of meshes (`verify shells`), or how its path may end (`verify stability`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct VerifySection {
    /// Where the numbers come from.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub source: String,
    /// The share of the load at which the path has its first limit point.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limit_load: Option<f64>,
    /// How the path may end: names of `solve::Ending`, `rejected` where the part makes no shell, `refused` where the scene
    /// is no sensible one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub endings: Vec<String>,
    /// Why it must end like this.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub why: String,
    /// Words that stand in the message, where it is `rejected` or `refused`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub says: Option<String>,
    /// The least and the largest number of snaps.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub snaps: Option<[usize; 2]>,
    /// The least and the largest share of the load at which it may end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ends_between: Option<[f64; 2]>,
    /// By how much the solvers may differ in the load reached and in a watch, as a share of its largest value.
    #[serde(default = "smooth_agreement")]
    pub agreement: f64,
    /// Where a volume or gas is given: the pressure of which loads are shares, MPa.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pressure: Option<f64>,
    /// By how much a watch may miss its reference, % of the largest reference value; for parts on their own mesh.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<f64>,
    /// Another case that has the same answer in other units.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub same_as: Option<SameAs>,
    /// Wall clock of both solvers on one core of 2025, s: a note for who waits.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seconds: Option<f64>,
    /// The ladder of meshes, the coarsest first, instead of the part's own.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub meshes: Vec<MeshSize>,
    /// For each element that is run: the mesh on which its error must be small enough.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub accept: Vec<Accepted>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub reference: Vec<Reference>,
}

/// A case that differs in its units alone.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SameAs {
    pub case: String,
    /// How many times the values of its watches are one's own.
    pub factor: f64,
}

/// How fine a mesh is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub(crate) enum MeshSize {
    /// Of a patch.
    Cells([usize; 2]),
    /// Of a sphere.
    Subdivisions(usize),
    /// Of any other closed part: the edge, mm; it is written with a point.
    Edge(f64),
}

/// The error that is accepted of an element on one mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Accepted {
    pub element: ShellElement,
    pub mesh: MeshSize,
    /// Of the largest reference value, %.
    pub error: f64,
    /// That it is known to be larger.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub miss: Option<KnownMiss>,
}

/// An error that is known to be larger than what is accepted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct KnownMiss {
    /// How large it is at most, as [`Accepted::error`], %.
    pub up_to: f64,
    pub why: String,
}

/// What a watch should show.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Reference {
    pub watch: String,
    /// Whether loads and values are points of a curve that may turn back, of which the distance counts.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub curve: bool,
    /// Shares of the whole load, increasing but on a curve; the whole where none is given.
    #[serde(default = "whole_load")]
    pub load: Vec<f64>,
    pub value: Vec<f64>,
}

/// Both solvers walk through the same iterates; what differs is rounding, times the condition of a thin wall.
fn smooth_agreement() -> f64 {
    1e-6
}

fn whole_load() -> Vec<f64> {
    vec![1.0]
}

impl fmt::Display for MeshSize {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Cells([n, m]) => f.pad(&format!("{n}x{m}")),
            Self::Subdivisions(n) => f.pad(&n.to_string()),
            Self::Edge(edge) => f.pad(&format!("{edge:?} mm")),
        }
    }
}

impl Accepted {
    /// Whether it speaks of this run.
    pub(crate) fn concerns(&self, element: ShellElement, mesh: MeshSize) -> bool {
        self.element == element && self.mesh == mesh
    }
}

impl VerifySection {
    /// Checks it against the scene it belongs to, on every mesh.
    pub(crate) fn check(&self, scene: &SceneFile) -> anyhow::Result<()> {
        for &mesh in &self.meshes {
            let refined = scene.with_mesh(mesh)?;
            refined.check().with_context(|| format!("[verify] mesh {mesh}"))?;
        }
        if let Some(pressure) = self.pressure {
            positive("[verify] pressure", pressure)?;
            ensure!(
                scene.load.pressure.is_none(),
                "[verify] pressure is for scenes in which [load] has none; take it away"
            );
        }
        for accepted in &self.accept {
            positive("[[verify.accept]] error", accepted.error)?;
            ensure!(
                self.meshes.contains(&accepted.mesh),
                "[[verify.accept]] mesh {} is not one of [verify] meshes",
                accepted.mesh
            );
            if let Some(KnownMiss { up_to, why }) = &accepted.miss {
                positive("[[verify.accept]] miss up_to", *up_to)?;
                ensure!(!why.trim().is_empty(), "[[verify.accept]] miss has no `why`");
            }
        }
        for Reference { watch, curve, load, value } in &self.reference {
            let what = format!("[[verify.reference]] {watch}");
            ensure!(
                scene.watches.iter().any(|watched| watched.name == *watch),
                "{what}: no [[watch]] has this name"
            );
            ensure!(
                load.len() == value.len() && !load.is_empty(),
                "{what}: {} loads, but {} values",
                load.len(),
                value.len()
            );
            if *curve {
                ensure!(
                    scene.load.curve || scene.load.volume_ratio.is_some(),
                    "{what}: a curve wants [load] curve or volume_ratio, to be traced"
                );
                ensure!(
                    load.iter().all(|v| v.is_finite()) && load.iter().any(|v| *v != 0.0),
                    "{what}: the loads are not all numbers, or all zero"
                );
            } else {
                ensure!(load.is_sorted_by(|a, b| a < b), "{what}: the loads do not increase");
                ensure!(
                    load.iter().all(|&load| load > 0.0 && load <= 1.0),
                    "{what}: a load is not a share between 0 and 1"
                );
            }
            ensure!(
                value.iter().all(|v| v.is_finite()) && value.iter().any(|v| *v != 0.0),
                "{what}: the values are not all numbers, or all zero"
            );
        }
        Ok(())
    }
}
