//! The sections of a mesh file, of either version, in either form.

use std::collections::{HashMap, HashSet};

use super::TET_ORDER;
use super::words::{Form, Words};
use crate::io::raw_solid::RawSolid;
use crate::math::Vec3;

/// The tetrahedra of the `bytes` of a file.
///
/// # Errors
/// One line when they are not a mesh of tetrahedra.
pub(super) fn raw_solid(bytes: &[u8]) -> Result<RawSolid, String> {
    let mut words = Words::new(bytes);
    let mut file = File::default();
    let mut version = None;
    while let Some(line) = words.line() {
        let Some(section) = line.strip_prefix('$') else {
            if line.is_empty() || version.is_some() {
                continue;
            }
            return Err("not a Gmsh mesh: it does not begin with $MeshFormat".to_owned());
        };
        if version.is_none() && section != "MeshFormat" {
            return Err("not a Gmsh mesh: it does not begin with $MeshFormat".to_owned());
        }
        let read = match (section, version) {
            ("MeshFormat", _) => {
                version = Some(format(&mut words)?);
                Some(())
            }
            ("PhysicalNames", _) => file.names(&mut words),
            ("Entities", Some(Version::V4)) => file.entities(&mut words),
            ("Nodes", Some(Version::V2)) => file.nodes_2(&mut words),
            ("Nodes", Some(Version::V4)) => file.nodes_4(&mut words),
            ("Elements", Some(Version::V2)) => file.elements_2(&mut words)?,
            ("Elements", Some(Version::V4)) => file.elements_4(&mut words)?,
            _ => Some(()),
        };
        let cut = || format!("the section ${section} cannot be read to its end");
        read.ok_or_else(cut)?;
        words.skip_to_line(&format!("$End{section}")).ok_or_else(cut)?;
        words.line();
    }
    file.raw_solid()
}

#[derive(Clone, Copy)]
enum Version {
    V2,
    V4,
}

fn format(words: &mut Words<'_>) -> Result<Version, String> {
    let line = words.line().unwrap_or_default();
    let mut parts = line.split_ascii_whitespace();
    let version = match parts.next() {
        Some("2" | "2.1" | "2.2") => Version::V2,
        Some("4.1") => Version::V4,
        other => {
            let found = other.unwrap_or("none");
            return Err(format!(
                "version {found} of Gmsh's format is not read, only 2.2 and 4.1 are"
            ));
        }
    };
    if parts.next() == Some("1") {
        words.form = Form::Binary;
        if parts.next() != Some("8") || words.int() != Some(1) {
            return Err("the binary mesh is not of a little-endian 64-bit machine".to_owned());
        }
    }
    Ok(version)
}

/// What was read of a file so far; nodes by their numbers in the file.
#[derive(Default)]
struct File {
    /// The group that is named `chamber`.
    chamber_group: Option<i64>,
    /// Physical groups of each surface.
    surfaces: HashMap<i64, Vec<i64>>,
    nodes: HashMap<u64, u32>,
    positions: Vec<Vec3>,
    /// Corners of triangles, and their groups.
    triangles: Vec<([u64; 3], Vec<i64>)>,
    tetrahedra: Vec<[u64; 4]>,
    midpoints: Vec<[u64; 6]>,
}

impl File {
    fn names(&mut self, words: &mut Words<'_>) -> Option<()> {
        let count: usize = words.line()?.parse().ok()?;
        for _ in 0..count {
            let line = words.line()?;
            let mut parts = line.splitn(3, ' ');
            let dimension = parts.next()?;
            let group = parts.next()?.parse().ok()?;
            let name = parts.next()?.trim().trim_matches('"');
            if dimension == "2" && name.eq_ignore_ascii_case("chamber") {
                self.chamber_group = Some(group);
            }
        }
        Some(())
    }

    fn entities(&mut self, words: &mut Words<'_>) -> Option<()> {
        let mut counts = [0; 4];
        for count in &mut counts {
            *count = words.size()?;
        }
        for (dimension, count) in counts.into_iter().enumerate() {
            for _ in 0..count {
                let entity = words.int()?;
                for _ in 0..if dimension == 0 { 3 } else { 6 } {
                    words.double()?;
                }
                let groups: Option<Vec<i64>> = (0..words.size()?).map(|_| words.int()).collect();
                let groups = groups?;
                if dimension > 0 {
                    for _ in 0..words.size()? {
                        words.int()?;
                    }
                }
                if dimension == 2 {
                    self.surfaces.insert(entity, groups);
                }
            }
        }
        Some(())
    }

    fn node(&mut self, number: u64, words: &mut Words<'_>) -> Option<()> {
        let position = Vec3::new(words.double()?, words.double()?, words.double()?);
        let index = u32::try_from(self.positions.len()).ok()?;
        self.positions.push(position);
        self.nodes.insert(number, index).is_none().then_some(())
    }

    fn nodes_2(&mut self, words: &mut Words<'_>) -> Option<()> {
        let count: u64 = words.line()?.parse().ok()?;
        for _ in 0..count {
            let number = words.int()?.try_into().ok()?;
            self.node(number, words)?;
        }
        Some(())
    }

    fn nodes_4(&mut self, words: &mut Words<'_>) -> Option<()> {
        let [blocks, ..] = four_sizes(words)?;
        for _ in 0..blocks {
            let dimension = words.int()?;
            words.int()?;
            let has_parameters = words.int()? == 1;
            let numbers: Option<Vec<u64>> = (0..words.size()?).map(|_| words.size()).collect();
            for number in numbers? {
                self.node(number, words)?;
                for _ in 0..if has_parameters { dimension } else { 0 } {
                    words.double()?;
                }
            }
        }
        Some(())
    }

    fn elements_2(&mut self, words: &mut Words<'_>) -> Result<Option<()>, String> {
        let Some(count) = words.line().and_then(|line| line.parse::<u64>().ok()) else {
            return Ok(None);
        };
        let mut read = 0;
        while read < count {
            let head = if words.form == Form::Binary {
                // A kind, how many follow of it, how many tags each has.
                [words.int(), words.int(), words.int()]
            } else {
                [Some(0), Some(1), Some(0)]
            };
            let [Some(kind), Some(in_block), Some(tags)] = head else { return Ok(None) };
            if in_block < 1 {
                return Ok(None);
            }
            for _ in 0..in_block {
                let mut element = || -> Option<(i64, Vec<i64>)> {
                    words.int()?;
                    let (kind, tags) = if words.form == Form::Binary {
                        (kind, tags)
                    } else {
                        (words.int()?, words.int()?)
                    };
                    let tags: Option<Vec<i64>> = (0..tags).map(|_| words.int()).collect();
                    Some((kind, tags?))
                };
                let Some((kind, tags)) = element() else { return Ok(None) };
                let groups: Vec<i64> = tags.first().copied().into_iter().collect();
                let number = |words: &mut Words<'_>| words.int()?.try_into().ok();
                if self.element(kind, &groups, words, number)?.is_none() {
                    return Ok(None);
                }
            }
            read += in_block as u64;
        }
        Ok(Some(()))
    }

    fn elements_4(&mut self, words: &mut Words<'_>) -> Result<Option<()>, String> {
        let Some([blocks, ..]) = four_sizes(words) else { return Ok(None) };
        for _ in 0..blocks {
            let head = [words.int(), words.int(), words.int()];
            let ([Some(dimension), Some(entity), Some(kind)], Some(count)) = (head, words.size())
            else {
                return Ok(None);
            };
            let groups = self.surfaces.get(&entity).filter(|_| dimension == 2);
            let groups = groups.cloned().unwrap_or_default();
            for _ in 0..count {
                if words.size().is_none()
                    || self.element(kind, &groups, words, |words| words.size())?.is_none()
                {
                    return Ok(None);
                }
            }
        }
        Ok(Some(()))
    }

    /// Takes the nodes of an element of `kind`.
    fn element(
        &mut self,
        kind: i64,
        groups: &[i64],
        words: &mut Words<'_>,
        number: impl Fn(&mut Words<'_>) -> Option<u64>,
    ) -> Result<Option<()>, String> {
        let count = match kind {
            15 => 1,
            1 => 2,
            2 | 8 => 3,
            3 | 4 => 4,
            9 => 6,
            10 => 9,
            11 => 10,
            16 => 8,
            _ => {
                return Err(format!(
                    "elements of Gmsh's type {kind} are not read, only tetrahedra of 4 or 10 nodes are"
                ));
            }
        };
        let nodes: Option<Vec<u64>> = (0..count).map(|_| number(words)).collect();
        let Some(nodes) = nodes else { return Ok(None) };
        match kind {
            2 | 9 => self.triangles.push((std::array::from_fn(|k| nodes[k]), groups.to_vec())),
            4 => self.tetrahedra.push(std::array::from_fn(|k| nodes[k])),
            11 => {
                self.tetrahedra.push(std::array::from_fn(|k| nodes[k]));
                self.midpoints.push(std::array::from_fn(|k| nodes[TET_ORDER[4 + k]]));
            }
            _ => {}
        }
        Ok(Some(()))
    }

    fn raw_solid(self) -> Result<RawSolid, String> {
        if self.tetrahedra.is_empty() {
            return Err("the mesh has no tetrahedra".to_owned());
        }
        if !self.midpoints.is_empty() && self.midpoints.len() != self.tetrahedra.len() {
            return Err("the mesh has tetrahedra of 4 nodes beside those of 10".to_owned());
        }
        let unknown = || "an element names a node that is not there".to_owned();
        let node = |number: &u64| self.nodes.get(number).copied().ok_or_else(unknown);
        let group = self.chamber_group.unwrap_or(UNNAMED_CHAMBER);
        let mut chamber = HashSet::new();
        for (corners, groups) in &self.triangles {
            if groups.contains(&group) {
                let mut face = known(corners, node)?;
                face.sort_unstable();
                chamber.insert(face);
            }
        }
        let tetrahedra = self.tetrahedra.iter().map(|corners| known(corners, node));
        let midpoints = self.midpoints.iter().map(|nodes| known(nodes, node));
        Ok(RawSolid {
            tetrahedra: tetrahedra.collect::<Result<_, _>>()?,
            midpoints: midpoints.collect::<Result<_, _>>()?,
            chamber: (!chamber.is_empty()).then_some(chamber),
            positions: self.positions,
        })
    }
}

/// The physical group of the chamber where none has that name.
const UNNAMED_CHAMBER: i64 = 2;

fn known<const N: usize>(
    numbers: &[u64; N],
    node: impl Fn(&u64) -> Result<u32, String>,
) -> Result<[u32; N], String> {
    let mut nodes = [0; N];
    for (known, number) in nodes.iter_mut().zip(numbers) {
        *known = node(number)?;
    }
    Ok(nodes)
}

fn four_sizes(words: &mut Words<'_>) -> Option<[u64; 4]> {
    Some([words.size()?, words.size()?, words.size()?, words.size()?])
}
