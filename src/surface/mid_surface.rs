//! The middle of a wall, and the distance to its two faces.
//!
//! ```text
//! outer face: min_p (|x - p| - t(p)/2) = 0, outside      chamber: the same, inside      p: points of the middle, t: thickness
//! ```
//! The wall is all that balls of the wall's own thickness reach from its middle. Where the thickness is the same everywhere that is
//! the distance to the middle less half of it; where it varies, the faces turn by half its slope, and the thickness that belongs to a
//! point is that of the ball that reaches it first: faces stay closed where folds of unequal thickness meet.
//!
//! Source: Aurenhammer (1987), Power diagrams, SIAM J. Computing 16:78-96, section 1, for distances with weights that are added.

use crate::math::Vec3;

use super::facet_tree::Nearest;
use super::{MeshDefect, SignedDistance, TriangleMesh};

/// A closed surface, the middle of a wall, with the thickness of the wall.
#[derive(Clone, Debug)]
pub struct MidSurface {
    mesh: TriangleMesh,
    distance: SignedDistance,
    half: HalfThickness,
    /// The least and the greatest thickness, mm.
    range: [f64; 2],
}

/// Half the thickness of a wall, mm.
#[derive(Clone, Debug)]
enum HalfThickness {
    Uniform(f64),
    /// At the corners of each facet of the distance's tree, in its order.
    AtCorners(Vec<[f64; 3]>),
}

/// The two faces of a wall.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WallFace {
    /// The face of the chamber.
    Chamber,
    /// The outside.
    Outer,
}

impl WallFace {
    /// 1 outside, -1 in the chamber.
    #[must_use]
    pub fn sign(self) -> f64 {
        match self {
            Self::Chamber => -1.0,
            Self::Outer => 1.0,
        }
    }
}

/// What is known of a point by the face of a wall, or by a level beyond it.
#[derive(Clone, Copy, Debug)]
pub(super) struct ToFace {
    /// From the middle of the wall, mm, negative inside.
    pub(super) from_middle: f64,
    /// From the level, mm, negative in what it encloses.
    pub(super) value: f64,
    /// The value's.
    pub(super) gradient: Vec3,
}

impl MidSurface {
    /// The middle `mesh` of a wall of `thickness` (mm) at its vertices.
    ///
    /// # Errors
    /// [`MeshDefect`] unless the mesh is a closed, outward-oriented 2-manifold.
    ///
    /// # Panics
    /// When there is not one thickness for each vertex, or one is not a positive number.
    pub fn new(mesh: TriangleMesh, thickness: &[f64]) -> Result<Self, MeshDefect> {
        assert_eq!(thickness.len(), mesh.positions.len(), "each vertex has a thickness");
        let first = thickness.first().copied().unwrap_or_default();
        if thickness.iter().all(|t| *t == first) {
            return Self::uniform(mesh, first);
        }
        assert!(thickness.iter().all(|t| is_length(*t)), "a thickness is a positive number");
        let distance = SignedDistance::new(&mesh)?;
        let of_facet = |t: usize| mesh.triangles[t].map(|v| 0.5 * thickness[v as usize]);
        let half = HalfThickness::AtCorners(distance.triangles().map(of_facet).collect());
        let range = thickness.iter().fold([first; 2], |[a, b], &t| [a.min(t), b.max(t)]);
        Ok(Self { mesh, distance, half, range })
    }

    /// The middle `mesh` of a wall that is everywhere of this `thickness`, mm.
    ///
    /// # Errors
    /// [`MeshDefect`] unless the mesh is a closed, outward-oriented 2-manifold.
    ///
    /// # Panics
    /// When the thickness is not a positive number.
    pub fn uniform(mesh: TriangleMesh, thickness: f64) -> Result<Self, MeshDefect> {
        assert!(is_length(thickness), "the thickness must be a positive number, not {thickness}");
        let distance = SignedDistance::new(&mesh)?;
        let half = HalfThickness::Uniform(0.5 * thickness);
        Ok(Self { mesh, distance, half, range: [thickness; 2] })
    }

    /// The surface.
    #[must_use]
    pub fn mesh(&self) -> &TriangleMesh {
        &self.mesh
    }

    /// The distance to it.
    #[must_use]
    pub fn distance(&self) -> &SignedDistance {
        &self.distance
    }

    /// The least and the greatest thickness of the wall, mm.
    #[must_use]
    pub fn thickness_range(&self) -> [f64; 2] {
        self.range
    }

    /// The distance of `point` from the middle over half the thickness there: 1 on the outer face, -1 on the chamber's.
    #[must_use]
    pub fn relative_height(&self, point: Vec3) -> f64 {
        let (distance, _, nearest) = self.distance.nearest(point, f64::INFINITY);
        distance / self.half_at(&nearest)
    }

    /// The distance of `point` from a `face`, mm, negative in what the face encloses, and its gradient.
    ///
    /// Beyond the middle of the wall it is that of the other side: there only its sign is meant.
    #[must_use]
    pub fn from_face(&self, face: WallFace, point: Vec3) -> (f64, Vec3) {
        let ToFace { value, gradient, .. } = self.to_level(face, 0.0, point, f64::INFINITY);
        (value, gradient)
    }

    /// Of `point`, known to be at most `bound` (mm) from the middle: the same for the level that is `beyond` (mm) farther from the middle
    /// than the `face`.
    pub(super) fn to_level(&self, face: WallFace, beyond: f64, point: Vec3, bound: f64) -> ToFace {
        let side = face.sign();
        let (from_middle, gradient, nearest) = self.distance.nearest(point, bound);
        let half = self.half_at(&nearest);
        let plain = ToFace { from_middle, value: from_middle - side * (half + beyond), gradient };
        match &self.half {
            HalfThickness::AtCorners(corners) if side * from_middle > 0.0 => {
                let start = from_middle.abs() - half;
                let most = 0.5 * self.range[1];
                match self.distance.tree().nearest_ball(point, start, corners, most) {
                    None => plain,
                    Some((reach, foot)) => {
                        let gradient = side * (point - foot).normalize();
                        ToFace { from_middle, value: side * (reach - beyond), gradient }
                    }
                }
            }
            _ => plain,
        }
    }

    fn half_at(&self, nearest: &Nearest) -> f64 {
        match &self.half {
            HalfThickness::Uniform(half) => *half,
            HalfThickness::AtCorners(corners) => {
                self.distance.tree().at_foot(nearest.facet, nearest.point, corners)
            }
        }
    }
}

fn is_length(x: f64) -> bool {
    x > 0.0 && x.is_finite()
}

#[cfg(test)]
mod tests {
    use approx::assert_abs_diff_eq;

    use super::*;

    const RADIUS: f64 = 10.0;

    /// Half the thickness at a height: 0.8 mm at the equator, and 0.05 mm more or less for each mm.
    fn half(z: f64) -> f64 {
        0.8 + 0.05 * z
    }

    fn sphere() -> MidSurface {
        let mesh = TriangleMesh::sphere(RADIUS, 5);
        let thickness: Vec<f64> = mesh.positions.iter().map(|p| 2.0 * half(p.z)).collect();
        MidSurface::new(mesh, &thickness).unwrap()
    }

    /// The envelope of balls of radius `h(s)` about a curve with normal `n` and tangent `t` is `x - h h' t +- h sqrt(1 - h'^2) n`; on a
    /// meridian `h' = -0.05 sin(theta)`.
    #[test]
    fn faces_are_the_envelope_of_balls() {
        let middle = sphere();
        for (face, sign) in [(WallFace::Outer, 1.0), (WallFace::Chamber, -1.0)] {
            for k in 1..20 {
                let (sin, cos) = (0.157 * f64::from(k)).sin_cos();
                let turn = 0.7 * f64::from(k);
                let around = |rho: f64, z: f64| Vec3::new(rho * turn.cos(), rho * turn.sin(), z);
                let (normal, tangent) = (around(sin, cos), around(cos, -sin));
                let (h, slope) = (half(RADIUS * cos), -0.05 * sin);
                let place = RADIUS * normal - h * slope * tangent
                    + sign * h * (1.0 - slope * slope).sqrt() * normal;
                let (value, gradient) = middle.from_face(face, place);
                // Facets of 0.37 mm sag by 0.37^2 / (6 * 10) = 2.3e-3 mm; that of each facet the ball at its nearest point is looked at, and
                // not the one that reaches farthest, costs h h'^2 / 2 = 1e-3 mm.
                assert_abs_diff_eq!(value, 0.0, epsilon = 3.5e-3);
                assert!((gradient.norm() - 1.0).abs() < 1e-12);
                // A step along the gradient is what the value grows by.
                let [before, after] =
                    [-0.1, 0.1].map(|step| middle.from_face(face, place + step * gradient).0);
                assert_abs_diff_eq!(after - before, 0.2, epsilon = 3.5e-3);
            }
        }
    }

    /// Between two spheres with walls of 1 and 3 mm, of which both reach the point halfway, the thicker wall's face is the nearer one,
    /// and no step is where the nearest middle changes.
    #[test]
    fn thick_walls_reach_beyond_the_halfway() {
        let ball = TriangleMesh::sphere(3.0, 4);
        let moved = |x: f64| TriangleMesh {
            positions: ball.positions.iter().map(|p| p + Vec3::new(x, 0.0, 0.0)).collect(),
            triangles: ball.triangles.clone(),
        };
        let mesh = moved(-4.0).joined(&moved(4.0));
        let thickness: Vec<f64> =
            mesh.positions.iter().map(|p| if p.x < 0.0 { 1.0 } else { 3.0 }).collect();
        let middle = MidSurface::new(mesh, &thickness).unwrap();
        assert_eq!(middle.thickness_range(), [1.0, 3.0]);
        let value = |x: f64| middle.from_face(WallFace::Outer, Vec3::new(x, 0.0, 0.0)).0;
        let exact = |x: f64| (x + 4.0 - 3.5).min(4.0 - x - 4.5);
        for k in 0..=18 {
            let x = -0.9 + 0.1 * f64::from(k);
            // Facets sag by 0.4^2 / (8 * 3) mm.
            assert_abs_diff_eq!(value(x), exact(x), epsilon = 8e-3);
        }
        assert_abs_diff_eq!(middle.relative_height(Vec3::new(8.5, 0.0, 0.0)), 1.0, epsilon = 0.01);
    }

    /// A list of equal thicknesses is one thickness, to the bit.
    #[test]
    fn equal_thicknesses_are_one() {
        let mesh = TriangleMesh::sphere(3.0, 2);
        let same = MidSurface::new(mesh.clone(), &vec![1.6; mesh.positions.len()]).unwrap();
        let uniform = MidSurface::uniform(mesh, 1.6).unwrap();
        let point = Vec3::new(1.0, 2.5, 3.0);
        let both = [&same, &uniform].map(|m| m.from_face(WallFace::Outer, point).0.to_bits());
        assert_eq!(both[0], both[1]);
        assert!(matches!(same.half, HalfThickness::Uniform(_)));
    }
}
