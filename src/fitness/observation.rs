//! What is read off an equilibrium: tip, angles, forces.
//!
//! ```text
//! chord angle    atan2(u_r, L + u_z),  u_r = |(u_x, u_y)| of the tip
//! tangent angle  of the area vector of the tip's facets, against the same at rest
//! ```
//!
//! Both lie in [0, 2 pi) and go on past half a turn. At constant curvature the tangent angle is twice the chord's; the literature quotes the tangent angle.

use serde::Serialize;

use super::turning::Turning;
use crate::math::{Vec3, area_vector};
use crate::mesh::{EndSets, ShellMesh};
use crate::model::PartModel;
use crate::solve::PathPoint;
use crate::surface::TriangleMesh;

/// One row of a path.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Observation {
    /// Place on the path, 0 at rest.
    pub step: usize,
    /// Chamber pressure, MPa.
    pub pressure: f64,
    /// Volume inside the mid-surface, mm^3.
    pub volume: f64,
    /// Work of the pressure since rest, mJ.
    pub work: f64,
    /// Energy stored in wall and contact, mJ.
    pub stored_energy: f64,
    /// Mean displacement of the tip set, mm.
    pub tip_x: f64,
    /// As `tip_x`, along y.
    pub tip_y: f64,
    /// As `tip_x`, along z.
    pub tip_z: f64,
    /// Chord angle, degrees.
    pub angle_deg: f64,
    /// Tangent angle, degrees.
    pub tangent_angle_deg: f64,
    /// Largest displacement of a vertex, mm.
    pub max_displacement: f64,
    /// Force on the planes, N.
    pub plane_force: f64,
    /// With self-contact: the smallest gap between faces of the wall, mm; infinite above half a thickness.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wall_gap: Option<f64>,
    /// With self-contact: the force of the wall on itself, N.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub self_contact_force: Option<f64>,
    /// Newton iterations since the row before.
    pub newton_iterations: usize,
    /// Steps given up since the row before.
    pub step_cuts: usize,
    /// Whether it is stable, or was lost on the way from the row before.
    pub stability: Stability,
    /// Whether it stands at a sample of the programme: only such rows are compared between designs.
    pub is_sample: bool,
}

#[cfg(test)]
impl Observation {
    /// A stable sample at which nothing is loaded, moves or touches.
    pub(super) fn at_rest() -> Self {
        Self {
            step: 0,
            pressure: 0.0,
            volume: 0.0,
            work: 0.0,
            stored_energy: 0.0,
            tip_x: 0.0,
            tip_y: 0.0,
            tip_z: 0.0,
            angle_deg: 0.0,
            tangent_angle_deg: 0.0,
            max_displacement: 0.0,
            plane_force: 0.0,
            wall_gap: None,
            self_contact_force: None,
            newton_iterations: 0,
            step_cuts: 0,
            stability: Stability::Stable,
            is_sample: true,
        }
    }
}

/// How a point of a path stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Stability {
    /// No direction is lost.
    Stable,
    /// A direction is lost.
    Unstable,
    /// It is where the part came to rest after it lost its stability.
    Snapped,
}

impl Stability {
    /// That of `point`.
    #[must_use]
    pub fn of(point: &PathPoint) -> Self {
        match point {
            PathPoint { snap: Some(_), .. } => Self::Snapped,
            PathPoint { is_stable: true, .. } => Self::Stable,
            _ => Self::Unstable,
        }
    }

    /// Its name in tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Stable => "stable",
            Self::Unstable => "unstable",
            Self::Snapped => "snapped",
        }
    }
}

/// What is looked at of a clamped part: its surface, and where the tip is.
#[derive(Clone, Copy, Debug)]
pub struct Watched<'a> {
    /// Whose vertices the model shows.
    pub surface: &'a TriangleMesh,
    /// Vertices whose mean motion is the motion of the tip, ascending.
    pub tip: &'a [u32],
    /// Of the part along z at rest, mm.
    pub length: f64,
}

impl<'a> Watched<'a> {
    /// A part whose model shows the vertices of `surface`, with these ends.
    #[must_use]
    pub fn new(surface: &'a TriangleMesh, ends: &'a EndSets) -> Self {
        Self { surface, tip: &ends.tip, length: ends.heights.length }
    }
}

impl<'a> From<&'a ShellMesh> for Watched<'a> {
    fn from(mesh: &'a ShellMesh) -> Self {
        Self::new(&mesh.surface, &mesh.ends)
    }
}

/// The rows of a path, the first at rest.
#[must_use]
pub fn observations<'a>(
    watched: impl Into<Watched<'a>>,
    model: &PartModel,
    points: &[PathPoint],
) -> Vec<Observation> {
    let watched = watched.into();
    let facets = tip_facets(&watched);
    let tip_normal = area_of_all(&facets, &watched.surface.positions);
    let (mut chord, mut tangent) = (Turning::default(), Turning::default());
    let axis = tip_normal.normalize();
    let has_contact = model.keeps_folds_apart();
    let observe = |(step, point): (usize, &PathPoint)| {
        let displacements = model.vertex_displacements(&point.x);
        let sum: Vec3 = watched.tip.iter().map(|&v| displacements[v as usize]).sum();
        let tip = sum / watched.tip.len() as f64;
        let angle = chord.chord(watched.length, tip);
        let deformed: Vec<Vec3> =
            watched.surface.positions.iter().zip(&displacements).map(|(x, u)| x + u).collect();
        let normal = area_of_all(&facets, &deformed);
        let along = axis.dot(&normal);
        Observation {
            step,
            pressure: point.load,
            volume: point.conjugate,
            work: point.work,
            stored_energy: point.stored_energy,
            tip_x: tip.x,
            tip_y: tip.y,
            tip_z: tip.z,
            angle_deg: angle.to_degrees(),
            tangent_angle_deg: tangent.angle(normal - axis * along, along).to_degrees(),
            max_displacement: displacements.iter().map(|u| u.norm()).fold(0.0, f64::max),
            plane_force: model.plane_force(&point.x),
            wall_gap: has_contact.then(|| model.smallest_wall_gap(&point.x)),
            self_contact_force: has_contact.then(|| model.self_contact_force(&point.x)),
            newton_iterations: point.newton_iterations,
            step_cuts: point.cuts,
            stability: Stability::of(point),
            is_sample: point.is_sample,
        }
    };
    points.iter().enumerate().map(observe).collect()
}

/// The facets whose corners all belong to the tip set; those with one such corner where a tip is so sharp that there are none.
fn tip_facets(watched: &Watched<'_>) -> Vec<[u32; 3]> {
    let in_tip = |v: &u32| watched.tip.binary_search(v).is_ok();
    let triangles = watched.surface.triangles.iter().copied();
    let inner: Vec<_> = triangles.clone().filter(|corners| corners.iter().all(in_tip)).collect();
    if inner.is_empty() {
        return triangles.filter(|corners| corners.iter().any(in_tip)).collect();
    }
    inner
}

/// Sum of the area vectors of `facets`, mm^2.
fn area_of_all(facets: &[[u32; 3]], positions: &[Vec3]) -> Vec3 {
    facets.iter().map(|facet| area_vector(facet.map(|v| positions[v as usize]))).sum()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::mesh::ShellSettings;
    use crate::surface::TriangleMesh;

    /// A tip set of one vertex has no facet of its own; the facets around it still point along the part.
    #[test]
    fn a_sharp_tip_has_a_direction() {
        let tip_of = |tip_fraction| {
            let settings = ShellSettings { tip_fraction, ..ShellSettings::default() };
            let mesh = ShellMesh::new(TriangleMesh::sphere(10.0, 2), &settings).unwrap();
            let facets = tip_facets(&(&mesh).into());
            (mesh.ends.tip.len(), facets.len(), area_of_all(&facets, &mesh.surface.positions))
        };
        let (vertices, facets, direction) = tip_of(1e-9);
        assert!(vertices <= 2 && facets >= 5, "{vertices} vertices, {facets} facets");
        assert!(direction.z > 0.9 * direction.norm(), "{direction}");
        // Half the sphere: a disk's area, less what the coarse triangles lose.
        let (_, _, direction) = tip_of(0.5);
        assert!(direction.z > 0.8 * 100.0 * PI && direction.z < 100.0 * PI, "{direction}");
    }
}
