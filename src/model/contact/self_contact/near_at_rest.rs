//! Which samples of a wall are neighbours: those that a short way along the surface at rest joins.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::math::Vec3;

/// For each sample, the samples within a distance along the edges, itself included; ascending.
#[derive(Clone, Debug)]
pub(super) struct Neighbours {
    starts: Vec<u32>,
    all: Vec<u32>,
}

impl Neighbours {
    /// Along `edges` between samples at `positions` (mm), nearer than `distance` (mm).
    pub(super) fn new(positions: &[Vec3], edges: &[[u32; 2]], distance: f64) -> Self {
        let mut links: Vec<Vec<(u32, f64)>> = vec![Vec::new(); positions.len()];
        for &[a, b] in edges {
            let length = (positions[a as usize] - positions[b as usize]).norm();
            links[a as usize].push((b, length));
            links[b as usize].push((a, length));
        }
        let mut ways = vec![f64::INFINITY; positions.len()];
        let mut front = BinaryHeap::new();
        let (mut starts, mut all) = (vec![0], Vec::new());
        for start in 0..positions.len() as u32 {
            // Dijkstra's algorithm as far as the distance; lengths are not negative, so their bits are ordered as they are.
            let first = all.len();
            ways[start as usize] = 0.0;
            all.push(start);
            front.push(Reverse((0, start)));
            while let Some(Reverse((way, sample))) = front.pop() {
                let way = f64::from_bits(way);
                if way > ways[sample as usize] {
                    continue;
                }
                for &(next, length) in &links[sample as usize] {
                    let longer = way + length;
                    if longer < distance && longer < ways[next as usize] {
                        if ways[next as usize] == f64::INFINITY {
                            all.push(next);
                        }
                        ways[next as usize] = longer;
                        front.push(Reverse((longer.to_bits(), next)));
                    }
                }
            }
            all[first..].iter().for_each(|&sample| ways[sample as usize] = f64::INFINITY);
            all[first..].sort_unstable();
            starts.push(all.len() as u32);
        }
        Self { starts, all }
    }

    /// Whether any of `ones` is a neighbour of any of `others`.
    pub(super) fn join(&self, ones: &[u32], others: &[u32]) -> bool {
        ones.iter().any(|&one| {
            let near = &self.all
                [self.starts[one as usize] as usize..self.starts[one as usize + 1] as usize];
            others.iter().any(|other| near.binary_search(other).is_ok())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On a line with steps of 1, a distance of 2.5 reaches two steps; a shortcut through space is no way.
    #[test]
    fn ways_lead_along_the_edges() {
        let mut positions: Vec<Vec3> = (0..8).map(|k| Vec3::new(f64::from(k), 0.0, 0.0)).collect();
        positions[7] = Vec3::new(0.1, 0.0, 0.0);
        let edges: Vec<[u32; 2]> = (0..6).map(|k| [k, k + 1]).collect();
        let neighbours = Neighbours::new(&positions, &edges, 2.5);
        for a in 0..8_u32 {
            for b in 0..8_u32 {
                let near = a == b || (a.max(b) < 7 && a.abs_diff(b) <= 2);
                assert_eq!(neighbours.join(&[a], &[b]), near, "{a} {b}");
            }
        }
        assert!(neighbours.join(&[7, 0], &[5, 2]) && !neighbours.join(&[0, 1], &[5, 6]));
    }
}
