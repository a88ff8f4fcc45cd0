//! Solid walls of a user's own: which triangles of a file are the chamber, and what was found.
//!
//! The chamber is the group that is asked for; or else the group of triangles named `chamber`, in any letter case; or else
//! all pieces of the boundary that the wall surrounds. A chamber's faces are turned by their tetrahedra, away from the air.

use std::collections::HashSet;

use serde::Serialize;

use super::marks::{Group, GroupKey, listed};
use super::raw_solid::RawSolid;
use crate::math::Vec3;
use crate::mesh::tetrahedra::{Numbered, TetDefect, net_edges, turns_around};
use crate::mesh::{SolidMesh, TetMesh};
use crate::surface::turned_outward;

/// Which faces of a file's boundary are the chamber.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ChamberChoice {
    /// The physical group of its triangles.
    pub group: Option<GroupKey>,
    /// Whether the flat openings of the chamber are closed, by lids without stiffness.
    pub close_inlet: bool,
}

/// A solid wall that was read.
#[derive(Clone, Debug, PartialEq)]
pub struct OwnSolid {
    /// The wall.
    pub mesh: SolidMesh,
    /// Where its chamber comes from.
    pub chamber: ChamberFound,
    /// What of the file is not done as it may be meant, a line each.
    pub warnings: Vec<String>,
}

/// The chamber of a solid wall.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct ChamberFound {
    /// The physical group of its triangles; none where it is what the wall surrounds.
    pub group: Option<String>,
    /// Triangles.
    pub faces: usize,
    /// Closed pieces; all have one pressure.
    pub voids: usize,
    /// Openings closed by a lid.
    pub lids: usize,
}

impl ChamberFound {
    /// One line; `volume` in mm^3.
    #[must_use]
    pub fn in_words(&self, volume: f64) -> String {
        let group = self.group.as_ref().map_or_else(
            || "what the wall surrounds".to_owned(),
            |group| format!("the group {group}"),
        );
        let number = |count: usize, what: &str| format!("{count} {what}{}", plural(count));
        let lids = match self.lids {
            0 => String::new(),
            lids => format!(", {}", number(lids, "lid")),
        };
        format!(
            "chamber: {group}, {}, {}{lids}, {volume:.1} mm^3",
            number(self.faces, "triangle"),
            number(self.voids, "void")
        )
    }
}

fn plural(count: usize) -> &'static str {
    if count == 1 { "" } else { "s" }
}

impl RawSolid {
    /// The quadratic mesh, with the file's midpoints where it has them, and the chamber of the `choice`.
    ///
    /// Tetrahedra may overlap each other, as they do in walls made by moving nodes; the chamber is turned one way nonetheless, so that
    /// its pressure has a potential.
    ///
    /// # Errors
    /// One line when the tetrahedra do not fit together, or the chamber is not a closed part of their boundary.
    pub(super) fn solid(&self, choice: &ChamberChoice) -> Result<OwnSolid, String> {
        let groups = self.chamber_groups(choice.group.as_ref())?;
        let marked = self.faces_of(&groups);
        let Numbered { mesh, former } =
            TetMesh::of_tetrahedra(&self.positions, &self.tetrahedra, |face| {
                marked.contains(&face)
            })
            .map_err(|defect| defect.to_string())?;
        if marked.len() != mesh.chamber.len() {
            return Err(format!(
                "{} of the {} triangles marked as the chamber are not on the boundary of the tetrahedra; the air before them must have none",
                marked.len() - mesh.chamber.len(),
                marked.len()
            ));
        }
        let mut mesh = if groups.is_empty() { mesh.with_chamber_found() } else { mesh };
        let is_open = turn_chamber(&mut mesh)?;
        let mut solid = self.quadratic(&mesh, &former)?;
        match (choice.close_inlet, is_open) {
            (false, 0) => {}
            (true, 0) if mesh.chamber.is_empty() => {
                return Err("[part] close_inlet wants to know the chamber's triangles: give their group as [part] chamber".to_owned());
            }
            (true, 0) => {
                return Err("the chamber is closed; take [part] close_inlet away".to_owned());
            }
            (false, edges) => {
                return Err(format!(
                    "the chamber is open along {edges} edges; if that is a flat air inlet, [part] close_inlet = true closes it"
                ));
            }
            (true, _) => solid = solid.with_lids().map_err(|defect| defect.to_string())?,
        }
        let group = (!groups.is_empty())
            .then(|| listed(&groups.iter().map(Group::in_words).collect::<Vec<_>>()));
        check_enclosed(&mesh, &solid, group.as_deref())?;
        let chamber = ChamberFound {
            group,
            faces: mesh.chamber.len(),
            voids: count(&mesh.pieces(&mesh.chamber_from_wall())),
            lids: solid.lids.len(),
        };
        let warnings = self.warnings(&solid, &mesh, &chamber);
        Ok(OwnSolid { mesh: solid, chamber, warnings })
    }

    /// The groups that are the chamber; none where the file does not say.
    fn chamber_groups(&self, key: Option<&GroupKey>) -> Result<Vec<Group>, String> {
        let groups = self.surfaces.groups();
        let by_default = GroupKey::Name(CHAMBER.to_owned());
        let meant = Group::meant(&groups, key.unwrap_or(&by_default));
        if meant.iter().any(|group| group.elements > 0) || (key.is_none() && meant.is_empty()) {
            return Ok(meant);
        }
        let there: Vec<String> = groups
            .iter()
            .filter(|group| group.elements > 0)
            .map(|group| {
                let triangles = group.elements;
                format!("{} of {triangles} triangle{}", group.in_words(), plural(triangles))
            })
            .collect();
        let there = match there.len() {
            0 => "the file has no group with triangles".to_owned(),
            _ => format!("groups with triangles are {}", listed(&there)),
        };
        Err(match (key, meant.first()) {
            (_, Some(group)) => {
                format!("the group {} has no triangles; {there}", group.in_words())
            }
            (Some(key), None) => {
                format!("[part] chamber is {}, which no group is; {there}", key.in_words())
            }
            (None, None) => unreachable!("nothing was asked for"),
        })
    }

    /// Sorted corners of the triangles of `groups`.
    fn faces_of(&self, groups: &[Group]) -> HashSet<[u32; 3]> {
        if groups.is_empty() {
            return HashSet::new();
        }
        let is_in = self.surfaces.in_groups(groups);
        let triangles = self.triangles.iter();
        triangles.filter(|(_, set)| is_in[*set as usize]).map(|&(face, _)| face).collect()
    }

    /// The mesh with straight edges, its chamber the group of that name.
    ///
    /// # Errors
    /// [`TetDefect`] when the tetrahedra do not fit together.
    pub(super) fn numbered(&self) -> Result<Numbered, TetDefect> {
        let key = GroupKey::Name(CHAMBER.to_owned());
        let chamber = self.faces_of(&Group::meant(&self.surfaces.groups(), &key));
        TetMesh::of_tetrahedra(&self.positions, &self.tetrahedra, |face| chamber.contains(&face))
    }

    fn warnings(&self, solid: &SolidMesh, mesh: &TetMesh, chamber: &ChamberFound) -> Vec<String> {
        let mut warnings = Vec::new();
        let overlapping = solid.overlapping_faces();
        if overlapping > 0 {
            warnings.push(format!(
                "the tetrahedra overlap at {overlapping} faces; each counts in full"
            ));
        }
        let volumes: Vec<Group> =
            self.volumes.groups().into_iter().filter(|group| group.elements > 0).collect();
        let without = self.volumes.without_group();
        if volumes.len() > 1 || (volumes.len() == 1 && without > 0) {
            let names: Vec<String> = volumes.iter().map(Group::in_words).collect();
            let rest = match without {
                0 => String::new(),
                rest => format!(" and {rest} tetrahedra of none"),
            };
            warnings.push(format!(
                "{} volume group{} ({}){rest}: all take [material]",
                volumes.len(),
                plural(volumes.len()),
                listed(&names)
            ));
        }
        if chamber.voids > 1 {
            warnings.push(format!("the chamber is {} voids: all take one pressure", chamber.voids));
        }
        let bodies = mesh.bodies();
        if bodies > 1 {
            warnings.push(format!(
                "the tetrahedra are {bodies} bodies that share no face: nothing holds them together"
            ));
        }
        warnings
    }
}

/// The name of the group that is the chamber where none is asked for.
const CHAMBER: &str = "chamber";

fn count(pieces: &[u32]) -> usize {
    pieces.iter().max().map_or(0, |&last| last as usize + 1)
}

/// Turns the chamber one way where tetrahedra that overlap do not; returns the number of its open edges.
fn turn_chamber(mesh: &mut TetMesh) -> Result<usize, String> {
    let open = net_edges(&mesh.chamber).len();
    let all = [mesh.outer.clone(), mesh.chamber_from_wall()].concat();
    if open == 0 || net_edges(&all).is_empty() {
        return Ok(open);
    }
    mesh.chamber = turned_outward(&mesh.chamber, &mesh.positions)
        .ok_or_else(|| "the chamber has no inside: it is one-sided".to_owned())?;
    Ok(net_edges(&mesh.chamber).len())
}

/// Refuses a chamber that is the outside of the wall, or has another piece of the boundary within.
fn check_enclosed(mesh: &TetMesh, solid: &SolidMesh, group: Option<&str>) -> Result<(), String> {
    let chamber = solid.chamber_and_lids();
    let pieces = match solid.lids.len() {
        0 => mesh.pieces(&mesh.chamber_from_wall()),
        _ => vec![0; chamber.len()],
    };
    // From the air into the wall, normals leave what they enclose, unless that is the wall.
    if mesh.volumes_within(&chamber, &pieces).iter().any(|volume| *volume <= 0.0) {
        let group = group.unwrap_or("of the chamber");
        return Err(format!("the group {group} is the outside of the wall, not a chamber"));
    }
    let place = |v: u32| mesh.positions[v as usize];
    let others = mesh.pieces(&mesh.outer);
    let mut seen = vec![false; count(&others)];
    for (face, &piece) in mesh.outer.iter().zip(&others) {
        if std::mem::replace(&mut seen[piece as usize], true) {
            continue;
        }
        let at = face.iter().map(|&v| place(v)).sum::<Vec3>() / 3.0;
        if turns_around(at, chamber.iter().map(|face| face.map(place))) > 0.5 {
            return Err(format!(
                "the chamber encloses another piece of the boundary, at ({:.3}, {:.3}, {:.3}) mm",
                at.x, at.y, at.z
            ));
        }
    }
    Ok(())
}
