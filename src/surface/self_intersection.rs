//! Where does a surface pass through itself?
//!
//! Triangles are sorted into the cells of a grid; two that share a cell but no vertex intersect when an
//! edge of either passes through the other. Contact in a point, along an edge or in a common plane is
//! not counted: signs of determinants in plain floating point decide.

use crate::math::Vec3;

use super::TriangleMesh;

/// The pairs of triangles of `mesh` without a common vertex that pass through each other, in ascending
/// order.
#[must_use]
pub fn intersecting_pairs(mesh: &TriangleMesh) -> Vec<[u32; 2]> {
    let Some((lower, upper)) = mesh.bounding_box() else { return vec![] };
    let boxes: Vec<(Vec3, Vec3)> = (0..mesh.triangles.len())
        .map(|t| {
            let [a, b, c] = mesh.corners(t);
            (a.inf(&b).inf(&c), a.sup(&b).sup(&c))
        })
        .collect();
    let mean = boxes.iter().map(|(l, u)| (u - l).max()).sum::<f64>() / boxes.len() as f64;
    let cell = (1.5 * mean).max((upper - lower).max() / MOST_CELLS);
    let cell_of = |point: Vec3| -> [u16; 3] { ((point - lower) / cell).map(|x| x as u16).into() };

    let mut entries = Vec::new();
    for (t, &(l, u)) in boxes.iter().enumerate() {
        let (first, last) = (cell_of(l), cell_of(u));
        for i in first[0]..=last[0] {
            for j in first[1]..=last[1] {
                entries.extend((first[2]..=last[2]).map(|k| ([i, j, k], t as u32)));
            }
        }
    }
    entries.sort_unstable();

    let mut pairs = Vec::new();
    for in_cell in entries.chunk_by(|a, b| a.0 == b.0) {
        for (n, &(here, s)) in in_cell.iter().enumerate() {
            for &(_, t) in &in_cell[n + 1..] {
                let ((ls, us), (lt, ut)) = (boxes[s as usize], boxes[t as usize]);
                let (common_lower, common_upper) = (ls.sup(&lt), us.inf(&ut));
                let overlap = (0..3).all(|a| common_lower[a] <= common_upper[a]);
                // Triangles that share several cells are compared in the first.
                if overlap && cell_of(common_lower) == here && intersect(mesh, s, t) {
                    pairs.push([s, t]);
                }
            }
        }
    }
    pairs.sort_unstable();
    pairs
}

fn intersect(mesh: &TriangleMesh, s: u32, t: u32) -> bool {
    let (s, t) = (s as usize, t as usize);
    if mesh.triangles[s].iter().any(|v| mesh.triangles[t].contains(v)) {
        return false;
    }
    let (p, q) = (mesh.corners(s), mesh.corners(t));
    (0..3).any(|k| {
        passes_through([p[k], p[(k + 1) % 3]], q) || passes_through([q[k], q[(k + 1) % 3]], p)
    })
}

/// Whether the segment crosses the interior of the triangle.
fn passes_through([p, q]: [Vec3; 2], [a, b, c]: [Vec3; 3]) -> bool {
    let volume = |a: Vec3, b: Vec3, c: Vec3, d: Vec3| (b - a).cross(&(c - a)).dot(&(d - a));
    let ends = [volume(a, b, c, p), volume(a, b, c, q)];
    if ends[0] * ends[1] >= 0.0 {
        return false;
    }
    let sides = [volume(p, q, a, b), volume(p, q, b, c), volume(p, q, c, a)];
    let crosses = sides.iter().all(|&v| v > 0.0) || sides.iter().all(|&v| v < 0.0);
    // In an oblique plane all five volumes are rounding, and any of their signs are met.
    let size = (b - a).norm() * (c - a).norm() * (p - a).norm().max((q - a).norm());
    crosses && ends.iter().any(|v| v.abs() > ROUNDING * size)
}

/// Of the volume of four points, over the product of three sides; positions are some hundred sides from the origin.
const ROUNDING: f64 = 1e-12;
/// Cells along the longest side of the box, at most.
const MOST_CELLS: f64 = 128.0;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::isosurface;
    use crate::surface::test_fields::sphere;

    fn ball() -> TriangleMesh {
        isosurface(&sphere(3.0), Vec3::repeat(-4.0), Vec3::repeat(4.0), 0.8)
    }

    fn with_copy(mesh: &TriangleMesh, shift: Vec3) -> TriangleMesh {
        let count = mesh.positions.len() as u32;
        let positions =
            mesh.positions.iter().copied().chain(mesh.positions.iter().map(|p| p + shift));
        let copies = mesh.triangles.iter().map(|t| t.map(|v| v + count));
        let triangles = mesh.triangles.iter().copied().chain(copies);
        TriangleMesh { positions: positions.collect(), triangles: triangles.collect() }
    }

    #[test]
    fn overlapping_balls_are_found_and_separate_ones_are_not() {
        let ball = ball();
        assert_eq!(intersecting_pairs(&ball), Vec::<[u32; 2]>::new());
        let apart = with_copy(&ball, Vec3::new(6.1, 0.3, 0.2));
        assert_eq!(intersecting_pairs(&apart), Vec::<[u32; 2]>::new());
        let overlapping = with_copy(&ball, Vec3::new(3.1, 0.3, 0.2));
        let pairs = intersecting_pairs(&overlapping);
        let first_copy = ball.triangles.len() as u32;
        assert!(pairs.iter().all(|&[s, t]| s < first_copy && t >= first_copy));
        assert!(pairs.windows(2).all(|w| w[0] < w[1]), "sorted, each pair once");
        // The reference: every pair compared, without a grid.
        let all = overlapping.triangles.len() as u32;
        let brute: Vec<[u32; 2]> = (0..first_copy)
            .flat_map(|s| (first_copy..all).map(move |t| [s, t]))
            .filter(|&[s, t]| intersect(&overlapping, s, t))
            .collect();
        assert!(brute.len() > 50, "{}", brute.len());
        assert_eq!(pairs, brute);
    }
}
