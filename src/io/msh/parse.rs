//! The sections of a mesh file, of either version, in either form.

use std::collections::HashMap;

use super::TET_ORDER;
use super::words::{Form, Words};
use crate::io::marks::Marks;
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
            ("Entities", Some(Version::V4)) => file.entities(&mut words, false),
            ("PartitionedEntities", Some(Version::V4)) => file.entities(&mut words, true),
            ("Nodes", Some(Version::V2)) => file.nodes_2(&mut words, false)?,
            ("ParametricNodes", Some(Version::V2)) => file.nodes_2(&mut words, true)?,
            ("Nodes", Some(Version::V4)) => file.nodes_4(&mut words)?,
            ("Elements", Some(Version::V2)) => file.elements_2(&mut words)?,
            ("Elements", Some(Version::V4)) => file.elements_4(&mut words)?,
            _ => Some(()),
        };
        let cut = || format!("the section ${section} cannot be read to its end");
        read.ok_or_else(cut)?;
        words.skip_to(&format!("$End{section}")).ok_or_else(cut)?;
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
    /// Groups of triangles and of tetrahedra.
    marks: [Marks; 2],
    /// In version 4, the groups of each surface and of each volume.
    entities: [HashMap<i64, u32>; 2],
    nodes: HashMap<u64, u32>,
    positions: Vec<Vec3>,
    /// Corners of the triangles of groups, and the set of their groups.
    triangles: Vec<([u64; 3], u32)>,
    tetrahedra: Vec<[u64; 4]>,
    midpoints: Vec<[u64; 6]>,
}

/// Where the groups of a dimension are among [`File::marks`].
fn place_of(dimension: i64) -> Option<usize> {
    matches!(dimension, 2 | 3).then(|| dimension as usize - 2)
}

impl File {
    fn names(&mut self, words: &mut Words<'_>) -> Option<()> {
        let count = words.count_line("1 1".len())?;
        for _ in 0..count {
            let line = words.line()?;
            let (dimension, rest) = line.split_once(char::is_whitespace)?;
            let rest = rest.trim_start();
            let (number, name) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
            if let Some(place) = place_of(dimension.parse().ok()?) {
                let name = name.trim().trim_matches('"');
                self.marks[place].call(number.parse().ok()?, name.to_owned());
            }
        }
        Some(())
    }

    /// The groups of surfaces and volumes; those of a mesh in `parts` have parents, and lists of the parts they belong to.
    fn entities(&mut self, words: &mut Words<'_>, parts: bool) -> Option<()> {
        if parts {
            words.size()?;
            for _ in 0..words.count(2)? {
                words.int()?;
                words.int()?;
            }
        }
        let mut counts = [0; 4];
        for count in &mut counts {
            *count = words.size()?;
        }
        for (dimension, count) in (0..).zip(counts) {
            for _ in 0..count {
                let entity = words.int()?;
                if parts {
                    words.int()?;
                    words.int()?;
                    for _ in 0..words.count(1)? {
                        words.int()?;
                    }
                }
                for _ in 0..if dimension == 0 { 3 } else { 6 } {
                    words.double()?;
                }
                let groups: Option<Vec<i64>> = (0..words.count(1)?).map(|_| words.int()).collect();
                let groups = groups?;
                if dimension > 0 {
                    for _ in 0..words.count(1)? {
                        words.int()?;
                    }
                }
                if let Some(place) = place_of(dimension) {
                    let set = self.marks[place].set(groups);
                    self.entities[place].insert(entity, set);
                }
            }
        }
        Some(())
    }

    /// Takes the place of a node.
    ///
    /// # Errors
    /// One line when there is a node of that number already.
    fn node(&mut self, number: u64, words: &mut Words<'_>) -> Result<Option<()>, String> {
        let [Some(x), Some(y), Some(z)] = [words.double(), words.double(), words.double()] else {
            return Ok(None);
        };
        let Ok(index) = u32::try_from(self.positions.len()) else { return Ok(None) };
        self.positions.push(Vec3::new(x, y, z));
        match self.nodes.insert(number, index) {
            None => Ok(Some(())),
            Some(_) => Err(format!("the node {number} is listed twice")),
        }
    }

    /// The nodes of version 2; with `parameters`, each has the dimension of its entity, its number, and places on it.
    fn nodes_2(&mut self, words: &mut Words<'_>, parameters: bool) -> Result<Option<()>, String> {
        let Some(count) = words.count_line("1 0 0 0".len()) else { return Ok(None) };
        for _ in 0..count {
            let Some(number) = words.int().and_then(|number| number.try_into().ok()) else {
                return Ok(None);
            };
            if self.node(number, words)?.is_none() {
                return Ok(None);
            }
            if parameters {
                let (Some(dimension), Some(_)) = (words.int(), words.int()) else {
                    return Ok(None);
                };
                let places = if dimension == 1 || dimension == 2 { dimension } else { 0 };
                if (0..places).any(|_| words.double().is_none()) {
                    return Ok(None);
                }
            }
        }
        Ok(Some(()))
    }

    fn nodes_4(&mut self, words: &mut Words<'_>) -> Result<Option<()>, String> {
        let Some([blocks, ..]) = four_sizes(words) else { return Ok(None) };
        for _ in 0..blocks {
            let head = [words.int(), words.int(), words.int()];
            let ([Some(dimension), Some(_), Some(parameters)], Some(count)) =
                (head, words.count(4))
            else {
                return Ok(None);
            };
            let numbers: Option<Vec<u64>> = (0..count).map(|_| words.size()).collect();
            let Some(numbers) = numbers else { return Ok(None) };
            let places = if parameters == 1 { dimension.clamp(0, 3) } else { 0 };
            for number in numbers {
                if self.node(number, words)?.is_none()
                    || (0..places).any(|_| words.double().is_none())
                {
                    return Ok(None);
                }
            }
        }
        Ok(Some(()))
    }

    fn elements_2(&mut self, words: &mut Words<'_>) -> Result<Option<()>, String> {
        let Some(count) = words.count_line("1 15 0 1".len()) else { return Ok(None) };
        let mut read = 0;
        while read < count {
            // Of binary elements: a kind, how many follow of it, how many tags each has.
            let head = match words.form {
                Form::Text => None,
                Form::Binary => {
                    let head = (words.int(), words.small_count(1), words.small_count(0));
                    let (Some(kind), Some(in_block), Some(tags)) = head else { return Ok(None) };
                    Some((kind, in_block, tags))
                }
            };
            let in_block = head.map_or(1, |(_, in_block, _)| in_block);
            if in_block < 1 {
                return Ok(None);
            }
            for _ in 0..in_block {
                let mut element = || -> Option<(i64, i64)> {
                    words.int()?;
                    let (kind, tags) = match head {
                        Some((kind, _, tags)) => (kind, tags),
                        None => (words.int()?, words.small_count(1)?),
                    };
                    let mut group = 0;
                    for tag in 0..tags {
                        let number = words.int()?;
                        if tag == 0 {
                            group = number;
                        }
                    }
                    Some((kind, group))
                };
                let Some((kind, group)) = element() else { return Ok(None) };
                let set = dimension_of(kind).and_then(place_of);
                let set = set.map_or(0, |place| self.marks[place].set_of(group));
                let number = |words: &mut Words<'_>| words.int()?.try_into().ok();
                if self.element(kind, set, words, number)?.is_none() {
                    return Ok(None);
                }
            }
            read += in_block;
        }
        Ok(Some(()))
    }

    fn elements_4(&mut self, words: &mut Words<'_>) -> Result<Option<()>, String> {
        let Some([blocks, ..]) = four_sizes(words) else { return Ok(None) };
        for _ in 0..blocks {
            let head = [words.int(), words.int(), words.int()];
            let ([Some(dimension), Some(entity), Some(kind)], Some(count)) = (head, words.count(2))
            else {
                return Ok(None);
            };
            let place = place_of(dimension).filter(|_| dimension_of(kind) == Some(dimension));
            let set = place.and_then(|place| self.entities[place].get(&entity).copied());
            let set = set.unwrap_or(0);
            for _ in 0..count {
                if words.size().is_none()
                    || self.element(kind, set, words, |words| words.size())?.is_none()
                {
                    return Ok(None);
                }
            }
        }
        Ok(Some(()))
    }

    /// Takes the nodes of an element of `kind`, of the `set` of groups.
    fn element(
        &mut self,
        kind: i64,
        set: u32,
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
        let mut nodes = [0; 10];
        for node in &mut nodes[..count] {
            match number(words) {
                Some(number) => *node = number,
                None => return Ok(None),
            }
        }
        match kind {
            2 | 9 if set != 0 => {
                self.marks[0].count(set);
                self.triangles.push((std::array::from_fn(|k| nodes[k]), set));
            }
            4 | 11 => {
                self.marks[1].count(set);
                self.tetrahedra.push(std::array::from_fn(|k| nodes[k]));
                if kind == 11 {
                    self.midpoints.push(std::array::from_fn(|k| nodes[TET_ORDER[4 + k]]));
                }
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
        let face = |(corners, set): &([u64; 3], u32)| {
            let mut face = known(corners, node)?;
            face.sort_unstable();
            Ok::<_, String>((face, *set))
        };
        let tetrahedra = self.tetrahedra.iter().map(|corners| known(corners, node));
        let midpoints = self.midpoints.iter().map(|nodes| known(nodes, node));
        let [surfaces, volumes] = self.marks;
        Ok(RawSolid {
            tetrahedra: tetrahedra.collect::<Result<_, _>>()?,
            midpoints: midpoints.collect::<Result<_, _>>()?,
            triangles: self.triangles.iter().map(face).collect::<Result<_, _>>()?,
            positions: self.positions,
            surfaces,
            volumes,
        })
    }
}

/// The dimension of elements of `kind` that may belong to a chamber or a wall.
fn dimension_of(kind: i64) -> Option<i64> {
    match kind {
        2 | 9 => Some(2),
        4 | 11 => Some(3),
        _ => None,
    }
}

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
