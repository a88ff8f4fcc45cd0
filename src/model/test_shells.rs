//! Closed shells on irregular meshes, deformed at random: what the tests of this room run on.

use std::rc::Rc;

use nalgebra::Matrix3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::element::{ElementPoints, LoopBasis, LoopShell, SampledSurface, fitted_control_points};
use super::material::Material;
use crate::math::Vec3;
use crate::mesh::{Rings, ShellMesh, ShellSettings};
use crate::surface::TriangleMesh;

/// An egg of 42 vertices with valences 4..8, about 20 mm wide, with a wall of 0.8 mm.
pub(super) struct TestShell {
    pub(super) mesh: ShellMesh,
    pub(super) bases: Vec<Rc<LoopBasis>>,
    /// Control points at rest, mm.
    pub(super) reference: Vec<Vec3>,
    /// Control points after a finite deformation, mm.
    pub(super) deformed: Vec<Vec3>,
}

impl TestShell {
    pub(super) fn new(seed: u64) -> Self {
        let mut chance = ChaCha8Rng::seed_from_u64(seed);
        let mesh = egg(&mut chance);
        let bases = LoopBasis::of_stencils(&mesh.stencils);
        let reference = fitted_control_points(&mesh, &bases).unwrap();
        let stretch = Matrix3::identity() + random_matrix(&mut chance, 0.25);
        let bend = random_matrix(&mut chance, 0.015);
        let deform = |x: &Vec3| {
            let jitter = random_matrix(&mut chance, 0.15).column(0).into_owned();
            stretch * x + bend * x.component_mul(x) + jitter
        };
        let deformed = reference.iter().map(deform).collect();
        Self { mesh, bases, reference, deformed }
    }

    pub(super) fn points(&self) -> Vec<ElementPoints> {
        ElementPoints::of_stencils(&self.mesh.stencils, &self.bases)
    }

    pub(super) fn surface(&self) -> SampledSurface {
        let ShellMesh { surface, section, .. } = &self.mesh;
        SampledSurface::new(&surface.triangles, &self.points(), self.reference.len(), section)
    }

    pub(super) fn wall(&self, material: Material) -> LoopShell {
        let mesh = &self.mesh;
        LoopShell::new(&mesh.stencils, &self.bases, &self.reference, &mesh.section, &[material])
            .unwrap()
    }
}

/// An egg on an irregular mesh.
fn egg(chance: &mut ChaCha8Rng) -> ShellMesh {
    let mut surface = irregular_sphere(1, 0, chance);
    for x in &mut surface.positions {
        *x = Vec3::new(10.0 * x.x, 9.0 * x.y, (11.0 + x.z) * x.z);
    }
    assert_eq!(surface.check_closed_manifold(), Ok(()));
    let settings = ShellSettings { thickness: 0.8, clamp_height: 6.0, ..Default::default() };
    ShellMesh::new(surface, &settings).unwrap()
}

/// A unit sphere whose mesh is an icosphere with `flips` edges or more flipped, then evened out: valences 4..8.
pub(super) fn irregular_sphere(
    subdivisions: usize,
    flips: usize,
    chance: &mut ChaCha8Rng,
) -> TriangleMesh {
    let mut surface = TriangleMesh::sphere(1.0, subdivisions);
    flip_edges(&mut surface.triangles, surface.positions.len(), flips, chance);
    let rings = Rings::new(surface.positions.len(), &surface.triangles).unwrap();
    for _ in 0..20 {
        for v in 0..rings.len() {
            let ring = rings.ring(v as u32);
            let sum: Vec3 = ring.iter().map(|&w| surface.positions[w as usize]).sum();
            surface.positions[v] = sum.normalize();
        }
    }
    surface
}

/// Flips `flips` edges or more at random while valences stay in 4..=8, until both extremes are there.
fn flip_edges(triangles: &mut [[u32; 3]], vertices: usize, flips: usize, chance: &mut ChaCha8Rng) {
    let valences = |triangles: &[[u32; 3]]| {
        let mut valences = vec![0; vertices];
        triangles.iter().flatten().for_each(|&v| valences[v as usize] += 1);
        valences
    };
    let mut flipped = 0;
    loop {
        let now = valences(triangles);
        if flipped >= flips && now.contains(&4) && now.contains(&8) {
            return;
        }
        let (t, corner) = (chance.random_range(0..triangles.len()), chance.random_range(0..3));
        let [a, b, left] = [0, 1, 2].map(|k| triangles[t][(corner + k) % 3]);
        let turn = |triangle: &[u32; 3]| {
            (0..3)
                .find(|&k| [triangle[k], triangle[(k + 1) % 3]] == [b, a])
                .map(|k| triangle[(k + 2) % 3])
        };
        let (other, right) =
            triangles.iter().enumerate().find_map(|(o, tri)| Some((o, turn(tri)?))).unwrap();
        let joined = triangles.iter().any(|tri| tri.contains(&left) && tri.contains(&right));
        let valence = |v: u32| now[v as usize];
        if !joined && valence(a).min(valence(b)) > 4 && valence(left).max(valence(right)) < 8 {
            triangles[t] = [a, right, left];
            triangles[other] = [right, b, left];
            flipped += 1;
        }
    }
}

/// A matrix of numbers between `-size` and `size`.
pub(super) fn random_matrix(chance: &mut ChaCha8Rng, size: f64) -> Matrix3<f64> {
    Matrix3::from_fn(|_, _| chance.random_range(-size..size))
}

/// The derivative at 0 of a function of one number, by central differences of fourth order.
pub(super) fn difference<T>(step: f64, mut f: impl FnMut(f64) -> T) -> T
where
    T: std::ops::Sub<Output = T> + std::ops::Mul<f64, Output = T>,
{
    let near = f(step) - f(-step);
    let far = f(2.0 * step) - f(-2.0 * step);
    (near * 8.0 - far) * (1.0 / (12.0 * step))
}
