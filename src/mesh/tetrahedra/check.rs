//! Do the tetrahedra fill the wall? Judged from their corners alone, whoever made them.
//!
//! Positive volumes, faces with one tetrahedron on either side, and a boundary that is the wall's two surfaces:
//! then each point of the wall lies in exactly one tetrahedron, unless the surfaces cross themselves or each other.

use super::TetDefect;
use super::boundary::{Boundary, boundary, check_vertices, is_even, is_flat, sorted, volume};
use crate::mesh::{TetMesh, WallSurfaces};
use crate::surface::TriangleMesh;

/// Share by which volumes and areas may differ: a mesher keeps the surfaces, but writes them in decimals.
const TOLERANCE: f64 = 1e-6;

/// Whether `mesh` fills `wall`.
///
/// # Errors
/// The first [`TetDefect`] found.
pub fn check(mesh: &TetMesh, wall: &WallSurfaces) -> Result<(), TetDefect> {
    check_by_itself(mesh)?;
    check_surface("outside", &mesh.outer_surface(), &wall.outer)?;
    check_surface("chamber", &mesh.chamber_surface(), &wall.chamber)
}

/// Whether the tetrahedra of `mesh` meet face to face, between closed surfaces that are listed as such; there may be no chamber.
///
/// # Errors
/// The first [`TetDefect`] found.
pub(super) fn check_by_itself(mesh: &TetMesh) -> Result<(), TetDefect> {
    check_vertices(&mesh.positions, &mesh.tetrahedra)?;
    let corners = || (0..mesh.tetrahedra.len()).map(|t| mesh.corners(t));
    let flat = corners().filter(|&corners| is_flat(corners)).count();
    if flat > 0 {
        return Err(TetDefect::Flat { tetrahedra: flat });
    }
    let inverted = corners().filter(|&corners| volume(corners) < 0.0).count();
    if inverted > 0 {
        return Err(TetDefect::Inverted { tetrahedra: inverted });
    }
    check_listed(mesh)?;
    mesh.outer_surface().check_closed_manifold().map_err(TetDefect::Outer)?;
    if mesh.chamber.is_empty() {
        return Ok(());
    }
    mesh.chamber_surface().check_closed_manifold().map_err(TetDefect::Chamber)
}

fn check_listed(mesh: &TetMesh) -> Result<(), TetDefect> {
    let oriented = |face: [u32; 3]| (sorted(face), is_even(face));
    let Boundary { faces, overlapping } = boundary(&mesh.tetrahedra)?;
    if overlapping > 0 {
        return Err(TetDefect::Overlapping { faces: overlapping });
    }
    let found: Vec<_> = faces.into_iter().map(oriented).collect();
    let chamber = mesh.chamber.iter().map(|&[a, b, c]| oriented([a, c, b]));
    let mut listed: Vec<_> = mesh.outer.iter().copied().map(oriented).chain(chamber).collect();
    listed.sort_unstable();
    if found == listed {
        return Ok(());
    }
    let missing = |these: &[([u32; 3], bool)], those: &[([u32; 3], bool)]| {
        these.iter().filter(|face| those.binary_search(face).is_err()).count()
    };
    // A face listed twice is missing nowhere.
    let faces = (missing(&found, &listed) + missing(&listed, &found)).max(1);
    Err(TetDefect::WrongBoundary { faces })
}

fn check_surface(
    surface: &'static str,
    found: &TriangleMesh,
    asked: &TriangleMesh,
) -> Result<(), TetDefect> {
    let differ = |found: f64, asked: f64| (found - asked).abs() > TOLERANCE * asked.abs();
    let (volume, area) = (found.volume(), found.area());
    if differ(volume, asked.volume()) {
        return Err(TetDefect::OtherVolume { surface, found: volume, asked: asked.volume() });
    }
    if differ(area, asked.area()) {
        return Err(TetDefect::OtherArea { surface, found: area, asked: asked.area() });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::mesh::tetrahedra::test_walls::{of_prisms, spheres};

    #[test]
    fn prisms_fill_the_wall_between_their_triangles() {
        let wall = spheres(10.0, 8.0, 2);
        let mesh = of_prisms(&wall);
        check(&mesh, &wall).unwrap();
        assert_eq!(mesh.tetrahedra.len(), 3 * wall.outer.triangles.len());
        // Rounding of 10^3 sums.
        let volume = wall.outer.volume() - wall.chamber.volume();
        assert_relative_eq!(mesh.volume(), volume, max_relative = 1e-12);
        assert_eq!(mesh.chamber_surface().positions, wall.chamber.positions);
    }

    /// Each defect is put into a mesh that has none.
    #[test]
    fn each_defect_is_found() {
        let wall = spheres(10.0, 8.0, 1);
        let found = |change: &dyn Fn(&mut TetMesh)| {
            let mut mesh = of_prisms(&wall);
            change(&mut mesh);
            check(&mesh, &wall).unwrap_err()
        };
        assert_eq!(found(&|mesh| mesh.tetrahedra.clear()), TetDefect::Empty);
        assert_eq!(
            found(&|mesh| mesh.tetrahedra[3][1] = 1000),
            TetDefect::IndexOutOfRange { tetrahedra: 1 }
        );
        assert_eq!(
            found(&|mesh| mesh.positions[3].y = f64::NAN),
            TetDefect::NotFinite { vertices: 1 }
        );
        assert_eq!(
            found(&|mesh| mesh.tetrahedra[5].swap(0, 1)),
            TetDefect::Inverted { tetrahedra: 1 }
        );
        assert_eq!(
            found(&|mesh| mesh.tetrahedra[5][0] = mesh.tetrahedra[5][1]),
            TetDefect::Flat { tetrahedra: 1 }
        );
        let twice = |mesh: &mut TetMesh| mesh.tetrahedra.push(mesh.tetrahedra[0]);
        // A tetrahedron of the prism's end has one face on the boundary.
        assert_eq!(found(&twice), TetDefect::CrowdedFaces { faces: 3 });
        assert_eq!(found(&|mesh| mesh.outer.truncate(70)), TetDefect::WrongBoundary { faces: 10 });
        assert_eq!(found(&|mesh| mesh.outer[4].swap(0, 1)), TetDefect::WrongBoundary { faces: 2 });
        assert_eq!(
            found(&|mesh| mesh.outer.push(mesh.outer[0])),
            TetDefect::WrongBoundary { faces: 1 }
        );
        // Without one tetrahedron the outside has a dent down to a vertex of the chamber, which is closed still.
        let dent = |mesh: &mut TetMesh| {
            mesh.tetrahedra.pop();
            *mesh =
                TetMesh::of_tetrahedra(&mesh.positions, &mesh.tetrahedra, |_| false).unwrap().mesh;
            *mesh = mesh.clone().with_chamber_found();
        };
        assert!(matches!(found(&dent), TetDefect::OtherVolume { surface: "outside", .. }));
        // Its mirror image in one of its faces lies on top of the neighbour there.
        let folded = |mesh: &mut TetMesh| {
            let [apex, b, c, d] = mesh.corners(0);
            let normal = (c - b).cross(&(d - b)).normalize();
            mesh.positions.push(apex - 2.0 * normal.dot(&(apex - b)) * normal);
            let [_, b, c, d] = mesh.tetrahedra[0];
            mesh.tetrahedra[0] = [mesh.positions.len() as u32 - 1, c, b, d];
        };
        assert_eq!(found(&folded), TetDefect::Overlapping { faces: 1 });
        // A step as long as the wall is thick moves a vertex through the tetrahedra above it.
        let through = |mesh: &mut TetMesh| mesh.positions[0] *= 1.3;
        assert!(matches!(found(&through), TetDefect::Inverted { .. }));
        let moved = |mesh: &mut TetMesh| mesh.positions[0] *= 1.01;
        assert!(matches!(found(&moved), TetDefect::OtherVolume { surface: "chamber", .. }));
        let swapped = |mesh: &mut TetMesh| {
            mesh.chamber.iter_mut().chain(&mut mesh.outer).for_each(|face| face.swap(0, 1));
            std::mem::swap(&mut mesh.chamber, &mut mesh.outer);
        };
        assert!(matches!(found(&swapped), TetDefect::Outer(_)));
    }

    #[test]
    fn a_chamber_without_a_mark_is_found() {
        let wall = spheres(10.0, 8.0, 2);
        let mesh = of_prisms(&wall);
        let turned: Vec<[u32; 4]> =
            mesh.tetrahedra.iter().map(|&[a, b, c, d]| [b, a, c, d]).collect();
        let unmarked = TetMesh::of_tetrahedra(&mesh.positions, &turned, |_| false).unwrap().mesh;
        assert!(unmarked.chamber.is_empty());
        check(&unmarked.with_chamber_found(), &wall).unwrap();
    }
}
