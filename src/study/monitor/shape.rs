//! A design in three dimensions: its shell at rest and at every state of its scenarios.

use serde::Serialize;

use crate::fitness::{CandidateSettings, Observation, Walked, evaluate_network};
use crate::genome::Network;
use crate::math::Vec3;
use crate::mesh::ShellMesh;
use crate::model::material::Material;
use crate::model::{PartModel, membrane_states};
use crate::solve::{Backend, PathPoint};
use crate::surface::TriangleMesh;

/// A shell and how it moves.
#[derive(Serialize)]
pub(crate) struct Shape {
    /// `[3 vertex + axis]`, mm.
    reference: Vec<f64>,
    /// `[3 triangle + corner]`.
    triangles: Vec<u32>,
    /// mm.
    thickness: f64,
    scenarios: Vec<Scenario>,
}

#[derive(Serialize)]
struct Plane {
    normal: [f64; 3],
    /// mm.
    point: [f64; 3],
}

impl Plane {
    /// The plane where `normal . x` is `offset` (mm), by its point next to the middle of a `surface`.
    fn beside(surface: &TriangleMesh, normal: Vec3, offset: f64) -> Self {
        let middle = mean(surface);
        let point = middle + normal * (offset - normal.dot(&middle));
        Self { normal: normal.into(), point: point.into() }
    }
}

#[derive(Serialize)]
struct Scenario {
    name: &'static str,
    ending: &'static str,
    /// What is in the way.
    plane: Option<Plane>,
    rows: Vec<Observation>,
    frames: Vec<Frame>,
}

/// A state of a path.
#[derive(Serialize)]
struct Frame {
    /// MPa.
    pressure: f64,
    /// As the reference.
    positions: Vec<f64>,
    /// Largest principal stretch of the wall's middle `[vertex]`.
    stretch: Vec<f64>,
    /// Largest principal Cauchy stress there, MPa.
    stress: Vec<f64>,
}

/// The shape of a network with these settings, whatever solver they name; none where it is rejected.
pub(crate) fn computed(
    network: &Network,
    settings: CandidateSettings,
) -> anyhow::Result<Option<Shape>> {
    let settings = CandidateSettings { backend: Backend::Native, ..settings };
    let materials = settings.materials();
    let candidate = evaluate_network(network, &settings)?;
    let (Some(mesh), Some(scenarios)) = (candidate.mesh, candidate.scenarios) else {
        return Ok(None);
    };
    let scenario = |(walked, model): (&Walked, &PartModel)| {
        let shown = |point: &PathPoint| {
            frame(&mesh, &materials, point.load, &model.vertex_displacements(&point.x))
        };
        let Walked { scenario, path, rows, .. } = walked;
        let plane = model.plane_places().first().copied().filter(|_| walked.is_obstructed());
        Scenario {
            // The page calls by its name what is in the way, and else by what the part does.
            name: if scenario.branches_off.is_some() { scenario.name } else { scenario.action },
            ending: path.ending.name(),
            plane: plane.map(|(normal, offset)| Plane::beside(&mesh.surface, normal, offset)),
            rows: rows.clone(),
            frames: path.points.iter().map(shown).collect(),
        }
    };
    Ok(Some(Shape {
        reference: flat(&mesh.surface.positions),
        triangles: mesh.surface.triangles.concat(),
        thickness: mesh.section.thickness_range()[1],
        scenarios: scenarios.with_models().map(scenario).collect(),
    }))
}

fn frame(mesh: &ShellMesh, materials: &[Material], pressure: f64, displacements: &[Vec3]) -> Frame {
    let positions: Vec<Vec3> =
        mesh.surface.positions.iter().zip(displacements).map(|(x, u)| x + u).collect();
    let states = membrane_states(
        |t| &materials[usize::from(mesh.section.material(t))],
        &mesh.surface,
        &positions,
    );
    Frame {
        pressure,
        positions: flat(&positions),
        stretch: states.iter().map(|state| rounded(state.stretch)).collect(),
        stress: states.iter().map(|state| rounded(state.stress)).collect(),
    }
}

fn mean(surface: &TriangleMesh) -> Vec3 {
    surface.positions.iter().sum::<Vec3>() / surface.positions.len() as f64
}

fn flat(points: &[Vec3]) -> Vec<f64> {
    points.iter().flat_map(|x| [x.x, x.y, x.z]).map(rounded).collect()
}

/// To four decimals: a picture shows no more, and a long tail of digits triples what is sent.
fn rounded(value: f64) -> f64 {
    (value * 1e4).round() / 1e4
}
