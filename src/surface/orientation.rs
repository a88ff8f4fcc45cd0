//! Triangles turned the same way, whichever way they were listed.

use std::collections::HashMap;

use crate::math::Vec3;

/// The closed `triangles` over `positions`, turned so that neighbours agree and each piece encloses a positive volume; none where a piece
/// is one-sided.
#[must_use]
pub fn turned_outward(triangles: &[[u32; 3]], positions: &[Vec3]) -> Option<Vec<[u32; 3]>> {
    let edges = |[a, b, c]: [u32; 3]| [[a, b], [b, c], [c, a]];
    let mut of_edge: HashMap<[u32; 2], Vec<usize>> = HashMap::new();
    for (k, &triangle) in triangles.iter().enumerate() {
        for [a, b] in edges(triangle) {
            of_edge.entry([a.min(b), a.max(b)]).or_default().push(k);
        }
    }
    let turned = |[a, b, c]: [u32; 3]| [a, c, b];
    let mut turned_right = triangles.to_vec();
    let mut seen = vec![false; triangles.len()];
    for start in 0..triangles.len() {
        if seen[start] {
            continue;
        }
        seen[start] = true;
        let mut piece = vec![start];
        let mut next = 0;
        while let Some(&k) = piece.get(next) {
            next += 1;
            for [a, b] in edges(turned_right[k]) {
                for &other in of_edge[&[a.min(b), a.max(b)]].iter().filter(|&&other| other != k) {
                    let runs_along = edges(turned_right[other]).contains(&[a, b]);
                    match (seen[other], runs_along) {
                        (true, true) => return None,
                        (true, false) => {}
                        (false, _) => {
                            if runs_along {
                                turned_right[other] = turned(turned_right[other]);
                            }
                            seen[other] = true;
                            piece.push(other);
                        }
                    }
                }
            }
        }
        let volume = |&k: &usize| {
            let [a, b, c] = turned_right[k].map(|v| positions[v as usize]);
            a.dot(&b.cross(&c))
        };
        if piece.iter().map(volume).sum::<f64>() < 0.0 {
            piece.iter().for_each(|&k| turned_right[k] = turned(turned_right[k]));
        }
    }
    Some(turned_right)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::TriangleMesh;

    /// Any triangles of two spheres may be turned: both come out right.
    #[test]
    fn pieces_are_turned_outward() {
        let sphere = TriangleMesh::sphere(2.0, 1);
        let n = sphere.positions.len() as u32;
        let far = sphere.positions.iter().map(|x| x + Vec3::new(9.0, 0.0, 0.0));
        let positions: Vec<Vec3> = sphere.positions.iter().copied().chain(far).collect();
        let second = sphere.triangles.iter().map(|t| t.map(|v| v + n));
        let right: Vec<[u32; 3]> = sphere.triangles.iter().copied().chain(second).collect();
        let mut wrong = right.clone();
        for k in [0, 3, 7, 90, 91] {
            wrong[k].swap(1, 2);
        }
        let found = turned_outward(&wrong, &positions).unwrap();
        let surface = TriangleMesh { positions, triangles: found };
        assert_eq!(surface.check_closed_manifold(), Ok(()));
        assert!(surface.component_volumes().iter().all(|volume| *volume > 0.0));
    }
}
