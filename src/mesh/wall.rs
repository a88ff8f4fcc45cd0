//! The two faces of a wall of constant thickness around its middle.
//!
//! ```text
//! outer: d = t / 2      chamber: d = -t / 2      d: signed distance to the mid-surface
//! ```
//! Folds that overlap merge, as a printer would merge them.

use serde::{Deserialize, Serialize};

use super::WallSurfaces;
use super::from_field::{GRID_SHARE, REMESH_ITERATIONS};
use crate::field::ScalarField;
use crate::math::{Rejected, Room, Vec3};
use crate::surface::{
    Filleted, Offset, RemeshSettings, SignedDistance, TriangleMesh, intersecting_pairs, isosurface, remesh_with_necks,
};

/// How finely the faces of a wall are meshed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct WallSettings {
    /// Edge length of their triangles, mm.
    pub edge: f64,
}

impl Default for WallSettings {
    fn default() -> Self {
        Self { edge: 2.0 }
    }
}

/// The faces of the wall of `thickness` (mm) around `mid`, a closed surface.
pub fn wall_surfaces(
    mid: &TriangleMesh,
    thickness: f64,
    settings: &WallSettings,
) -> Result<WallSurfaces, Rejected> {
    let distance = SignedDistance::new(mid)?;
    let outer = face(&distance, 0.5 * thickness, settings.edge)?;
    let chamber = face(&distance, -0.5 * thickness, settings.edge)?;
    Ok(WallSurfaces { outer, chamber })
}

fn var(name: &str, default: f64) -> f64 {
    std::env::var(name).map_or(default, |s| s.parse().unwrap())
}

fn face(distance: &SignedDistance, offset: f64, edge: f64) -> Result<TriangleMesh, Rejected> {
    let name = if offset > 0.0 { "outer" } else { "chamber" };
    let tag = |r: Rejected| Rejected { reason: format!("{name}_{}", r.reason), ..r };
    let plain = Offset { distance, offset, band: 2.0 * edge };
    let step = var("STEP", GRID_SHARE * edge);
    let settings = RemeshSettings { edge, iterations: REMESH_ITERATIONS };
    let coarse = largest_piece(&level(&plain, &plain, step), offset)?;
    let even = remesh_with_necks(&coarse, Some(&plain), &settings);
    let mut last = match even { Err(e) => e, Ok(even) => return Ok(even) };
    for rung in 0..2 {
        eprintln!("   {name} {last}");
        let radius = [var("R1", 0.4), var("R2", 0.8)][rung];
        let step = var("FINE", 0.6);
        let beyond = Offset { distance, offset: offset + radius.copysign(offset), band: 2.0 * edge };
        let core = largest_piece(&level(&beyond, &beyond, step), offset)?;
        let core = SignedDistance::new(&core)?;
        let field = Filleted { offset: plain, core: &core, radius, chord_error: 0.05 * step };
        let coarse = largest_piece(&level(&field, &plain, step), offset)?;
        last = match remesh_with_necks(&coarse, Some(&field), &settings) {
            Ok(even) => { eprintln!("   cured"); return Ok(even) }
            Err(e) => e,
        };
    }
    Err(tag(last))
}

fn level(field: &dyn ScalarField, offset: &Offset, step: f64) -> TriangleMesh {
    let (lower, upper) = offset.distance.bounds();
    let margin = Vec3::repeat(offset.offset);
    isosurface(field, lower - margin, upper + margin, step)
}

fn largest_piece(mesh: &TriangleMesh, offset: f64) -> Result<TriangleMesh, Rejected> {
    let volumes = mesh.component_volumes();
    let Some(largest) = (0..volumes.len()).max_by(|&a, &b| volumes[a].total_cmp(&volumes[b])) else {
        return Err(Rejected::new(Room::Mesh, "chamber_closed", String::new(), 1.0));
    };
    let rest: f64 = volumes.iter().map(|v| v.abs()).sum::<f64>() - volumes[largest];
    let share = rest / volumes[largest];
    if share > 0.01 {
        let reason = if offset > 0. { "enclosed_pocket" } else { "chamber_divided" };
        return Err(Rejected::new(Room::Mesh, reason, String::new(), share));
    }
    Ok(mesh.component(largest as u32))
}
