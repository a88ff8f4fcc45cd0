//! Which samples of a wall are neighbours: those that are near at rest, and joined by a short way along the surface.
//!
//! Ways along edges zigzag: on a lattice they are up to 1.41 times as long as straight ones, so more is allowed for them.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::math::Vec3;

/// For each sample, its neighbours, itself included; ascending.
#[derive(Clone, Debug)]
pub(super) struct Neighbours {
    starts: Vec<u32>,
    all: Vec<u32>,
}

impl Neighbours {
    /// Of samples at `positions` (mm): nearer than `straight`, and nearer than `distance` along `edges` (mm).
    pub(super) fn new(
        positions: &[Vec3],
        edges: &[[u32; 2]],
        straight: f64,
        distance: f64,
    ) -> Self {
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
            let from = positions[start as usize];
            let near = all.split_off(first).into_iter().filter(|&sample| {
                (positions[sample as usize] - from).norm_squared() < straight * straight
            });
            all.extend(near);
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

    /// On a line with steps of 1, a distance of 2.5 reaches two steps; a shortcut through space is no way, and a way is none
    /// where the straight one is too long.
    #[test]
    fn ways_lead_along_the_edges() {
        let mut positions: Vec<Vec3> = (0..8).map(|k| Vec3::new(f64::from(k), 0.0, 0.0)).collect();
        positions[7] = Vec3::new(0.1, 0.0, 0.0);
        let edges: Vec<[u32; 2]> = (0..6).map(|k| [k, k + 1]).collect();
        let neighbours = Neighbours::new(&positions, &edges, 2.2, 2.5);
        for a in 0..8_u32 {
            for b in 0..8_u32 {
                let near = a == b || (a.max(b) < 7 && a.abs_diff(b) <= 2);
                assert_eq!(neighbours.join(&[a], &[b]), near, "{a} {b}");
            }
        }
        assert!(neighbours.join(&[7, 0], &[5, 2]) && !neighbours.join(&[0, 1], &[5, 6]));
        assert!(!Neighbours::new(&positions, &edges, 1.9, 2.5).join(&[0], &[2]));
    }
}
