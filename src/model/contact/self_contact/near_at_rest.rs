//! Which samples of a wall are neighbours: those that are near at rest, and joined by a short way along the surface that
//! stays near.
//!
//! Ways along edges zigzag: on a lattice they are up to 1.41 times as long as straight ones, so more is allowed for them.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};
use std::sync::OnceLock;

use crate::math::Vec3;

/// For each sample, its neighbours, itself included; found when they are asked for.
#[derive(Clone, Debug)]
pub(super) struct Neighbours {
    positions: Vec<Vec3>,
    /// Samples at the other ends of each sample's edges.
    links: Vec<Vec<u32>>,
    straight: f64,
    distance: f64,
    found: Vec<OnceLock<Box<[u32]>>>,
}

impl Neighbours {
    /// Of samples at `positions` (mm): nearer than `straight`, and nearer than `distance` along `edges` (mm).
    pub(super) fn new(
        positions: &[Vec3],
        edges: impl Iterator<Item = [u32; 2]>,
        straight: f64,
        distance: f64,
    ) -> Self {
        let mut links: Vec<Vec<u32>> = vec![Vec::new(); positions.len()];
        for [a, b] in edges {
            links[a as usize].push(b);
            links[b as usize].push(a);
        }
        let found = vec![OnceLock::new(); positions.len()];
        Self { positions: positions.to_vec(), links, straight, distance, found }
    }

    /// Whether any of `ones` is a neighbour of any of `others`.
    pub(super) fn join(&self, ones: &[u32], others: &[u32]) -> bool {
        ones.iter().any(|&one| {
            let near = self.found[one as usize].get_or_init(|| self.of(one));
            others.iter().any(|other| near.binary_search(other).is_ok())
        })
    }

    /// The neighbours of a sample, ascending: Dijkstra's algorithm as far as the distance.
    fn of(&self, start: u32) -> Box<[u32]> {
        let mut ways = BTreeMap::from([(start, 0.0)]);
        let mut front = BinaryHeap::from([Reverse((0, start))]);
        while let Some(Reverse((way, sample))) = front.pop() {
            // Lengths are not negative, so their bits are ordered as they are.
            let way = f64::from_bits(way);
            if way > ways[&sample] {
                continue;
            }
            for &next in &self.links[sample as usize] {
                let longer = way + self.between(sample, next);
                if longer >= self.distance || self.between(start, next) >= self.straight {
                    continue;
                }
                let known = ways.entry(next).or_insert(f64::INFINITY);
                if longer < *known {
                    *known = longer;
                    front.push(Reverse((longer.to_bits(), next)));
                }
            }
        }
        ways.into_keys().collect()
    }

    fn between(&self, a: u32, b: u32) -> f64 {
        (self.positions[a as usize] - self.positions[b as usize]).norm()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On a line with steps of 1, a distance of 2.5 reaches two steps; a shortcut through space is no way, and a way is none
    /// where the straight one is too long.
    #[test]
    fn ways_lead_along_the_edges() {
        let mut positions: Vec<Vec3> = (0..8).map(|k| Vec3::new(f64::from(k), 0.0, 0.0)).collect();
        positions[7] = Vec3::new(0.1, 0.0, 0.0);
        let edges: Vec<[u32; 2]> = (0..6).map(|k| [k, k + 1]).collect();
        let neighbours = Neighbours::new(&positions, edges.iter().copied(), 2.2, 2.5);
        for a in 0..8_u32 {
            for b in 0..8_u32 {
                let near = a == b || (a.max(b) < 7 && a.abs_diff(b) <= 2);
                assert_eq!(neighbours.join(&[a], &[b]), near, "{a} {b}");
            }
        }
        assert!(neighbours.join(&[7, 0], &[5, 2]) && !neighbours.join(&[0, 1], &[5, 6]));
        let straighter = Neighbours::new(&positions, edges.into_iter(), 1.9, 2.5);
        assert!(!straighter.join(&[0], &[2]) && straighter.join(&[0], &[1]));
    }
}
