//! Walls for tests, and tetrahedra that fill them without a mesher.

use crate::math::Vec3;
use crate::mesh::{TetMesh, WallSurfaces};
use crate::surface::TriangleMesh;

/// The wall between two spheres of 20 * 4^subdivisions triangles.
pub(crate) fn spheres(outer: f64, chamber: f64, subdivisions: usize) -> WallSurfaces {
    WallSurfaces {
        outer: TriangleMesh::sphere(outer, subdivisions),
        chamber: TriangleMesh::sphere(chamber, subdivisions),
    }
}

/// The tetrahedra of prisms between surfaces with the same triangles, three each.
///
/// The lower-numbered corner of a prism's edge is joined to the higher-numbered one's image, on either side of each face.
pub(crate) fn of_prisms(wall: &WallSurfaces) -> TetMesh {
    assert_eq!(wall.outer.triangles, wall.chamber.triangles);
    let n = wall.chamber.positions.len() as u32;
    let positions: Vec<Vec3> =
        wall.chamber.positions.iter().chain(&wall.outer.positions).copied().collect();
    let tetrahedra: Vec<[u32; 4]> = wall
        .chamber
        .triangles
        .iter()
        .flat_map(|&triangle| {
            let mut corners = triangle;
            corners.sort_unstable();
            let [a, b, c] = corners;
            [[a, b, c, c + n], [a, b, b + n, c + n], [a, a + n, b + n, c + n]]
        })
        .collect();
    let is_chamber = |face: [u32; 3]| face[2] < n;
    TetMesh::of_tetrahedra(&positions, &tetrahedra, is_chamber).unwrap().mesh
}

/// Two spheres of which the inner one sticks out of the outer one.
pub(crate) fn crossing() -> WallSurfaces {
    let mut wall = spheres(10.0, 8.0, 2);
    wall.chamber.positions.iter_mut().for_each(|p| p.x += 4.0);
    wall
}

/// The cells of a grid of cubes of the edge `h` (mm) for which `is_wall`, six tetrahedra each about the cube's diagonal.
pub(crate) fn grid(cells: [usize; 3], h: f64, is_wall: impl Fn([usize; 3]) -> bool) -> TetMesh {
    const ORDERS: [[usize; 3]; 6] =
        [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
    let [_, ny, nz] = cells.map(|n| n + 1);
    let vertex = |[i, j, k]: [usize; 3]| ((i * ny + j) * nz + k) as u32;
    let all = |[nx, ny, nz]: [usize; 3]| {
        (0..nx).flat_map(move |i| (0..ny).flat_map(move |j| (0..nz).map(move |k| [i, j, k])))
    };
    let positions: Vec<Vec3> =
        all(cells.map(|n| n + 1)).map(|place| h * Vec3::from(place.map(|n| n as f64))).collect();
    let of_cell = |cell: [usize; 3]| {
        ORDERS.map(|order| {
            let mut at = cell;
            let mut corners = [vertex(at); 4];
            for (corner, axis) in corners[1..].iter_mut().zip(order) {
                at[axis] += 1;
                *corner = vertex(at);
            }
            corners
        })
    };
    let tetrahedra: Vec<[u32; 4]> =
        all(cells).filter(|&cell| is_wall(cell)).flat_map(of_cell).collect();
    TetMesh::of_tetrahedra(&positions, &tetrahedra, |_| false).unwrap().mesh
}
