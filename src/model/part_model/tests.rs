//! Residual, tangent and load direction of whole models against differences.

use std::any::Any;

use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::*;
use crate::mesh::ShellSettings;
use crate::model::contact::{Friction, PlaneContact, PlaneSettings};
use crate::model::material::NeoHookean;
use crate::model::test_shells::{TestShell, difference};
use crate::surface::TriangleMesh;

const MATERIAL: Material = Material::NeoHookean(NeoHookean { mu: 1.3 });
const STEP: f64 = 1e-3;

/// A clamped, pressurised shell near a plane, far from rest; its state; which unknowns are held.
fn loaded(seed: u64) -> (PartModel, Vec<f64>, Vec<bool>) {
    let shell = TestShell::new(seed);
    let plane = PlaneSettings::new(Vec3::new(0.48, -0.6, 0.64), 5.0, 0.01);
    let mut model =
        PartModel::new(&shell.mesh, &MATERIAL, &Support::Clamp, &vec![plane].into()).unwrap();
    let moved = shell.deformed.iter().zip(&shell.reference).map(|(x, rest)| x - rest);
    let mut u: Vec<f64> = moved.flat_map(|u| [u.x, u.y, u.z]).collect();
    let mut held = vec![false; u.len()];
    for v in shell.mesh.held_vertices() {
        for unknown in 3 * v as usize..3 * v as usize + 3 {
            held[unknown] = true;
            u[unknown] = 0.0;
        }
    }
    // A third of the activation, so that the differences are fine enough for the barrier.
    model.raise_plane(model.smallest_gap(&u) - 0.03);
    model.set_load(0.03);
    assert!(held.contains(&true) && held.contains(&false));
    (model, u, held)
}

impl PartModel {
    /// The whole dead forces on the unknowns of each node, N.
    pub(in crate::model) fn dead_forces_mut(&mut self) -> &mut [Vec3] {
        self.term_mut::<DeadForces>().expect("dead forces act").on_unknowns_mut()
    }

    /// Moves the first plane by `distance` towards the part, mm.
    pub(in crate::model) fn raise_plane(&mut self, distance: f64) {
        self.term_mut::<PlaneContact>().expect("there is a plane").raise(distance);
        if let Some(friction) = self.term_mut::<Friction>() {
            friction.raise(distance);
        }
    }

    /// The first term of a kind.
    fn term_mut<T: PartTerm>(&mut self) -> Option<&mut T> {
        self.terms.iter_mut().find_map(|placed| {
            let term: &mut dyn Any = placed.term_mut();
            term.downcast_mut()
        })
    }
}

fn energy_at(model: &mut PartModel, u: &DVector<f64>) -> f64 {
    model.energy(u.as_slice()).unwrap()
}

fn residual_at(model: &mut PartModel, u: &DVector<f64>) -> DVector<f64> {
    let mut residual = DVector::zeros(u.len());
    model.residual(u.as_slice(), residual.as_mut_slice()).unwrap();
    residual
}

fn tangent_at(model: &mut PartModel, u: &DVector<f64>) -> DMatrix<f64> {
    let pattern = model.pattern().clone();
    let mut values = vec![0.0; pattern.stored()];
    let mut residual = DVector::zeros(u.len());
    model.tangent(u.as_slice(), residual.as_mut_slice(), &mut values).unwrap();
    assert_eq!(residual, residual_at(model, u));
    let mut tangent = DMatrix::zeros(u.len(), u.len());
    for column in 0..u.len() {
        let stored = pattern.column_starts[column]..pattern.column_starts[column + 1];
        for entry in stored.map(|entry| entry as usize) {
            let row = pattern.row_indices[entry] as usize;
            if row >= column {
                tangent[(row, column)] = values[entry];
                tangent[(column, row)] = values[entry];
            }
        }
    }
    tangent
}

/// Central differences of fourth order are some 1e-11 wrong, as in the suite of single terms.
#[test]
fn residual_is_the_difference_of_the_energy() {
    let (mut model, u, held) = loaded(0);
    let u = DVector::from_vec(u);
    let residual = residual_at(&mut model, &u);
    for unknown in 0..u.len() {
        if held[unknown] {
            assert_eq!(residual[unknown], 0.0);
            continue;
        }
        let slope = difference(STEP, |h| {
            let mut moved = u.clone();
            moved[unknown] += h;
            energy_at(&mut model, &moved)
        });
        let error = (slope - residual[unknown]).abs();
        assert!(error < 1e-10 * residual.amax(), "{:e}", error / residual.amax());
    }
}

#[test]
fn tangent_is_the_difference_of_the_residual() {
    let (mut model, u, held) = loaded(1);
    let u = DVector::from_vec(u);
    let tangent = tangent_at(&mut model, &u);
    for unknown in (0..u.len()).filter(|&unknown| held[unknown]) {
        let identity = DVector::from_fn(u.len(), |row, _| f64::from(row == unknown));
        assert_eq!(tangent.column(unknown), identity);
    }
    let mut chance = ChaCha8Rng::seed_from_u64(1);
    for _ in 0..20 {
        let direction = DVector::from_fn(u.len(), |unknown, _| {
            if held[unknown] { 0.0 } else { chance.random_range(-1.0..1.0) }
        });
        let slope = difference(STEP, |h| residual_at(&mut model, &(&u + h * &direction)));
        let exact = &tangent * &direction;
        let error = (slope - &exact).amax() / exact.amax();
        assert!(error < 1e-10, "{error:e}");
    }
}

#[test]
fn load_direction_is_the_difference_of_the_volume() {
    let (model, u, held) = loaded(2);
    let mut direction = vec![0.0; u.len()];
    model.load_direction(&u, &mut direction);
    for unknown in 0..u.len() {
        let slope = difference(1e-2, |h| {
            let mut moved = u.clone();
            moved[unknown] += h;
            model.conjugate(&moved)
        });
        let expected = if held[unknown] { 0.0 } else { slope };
        // A volume of 4,000 mm^3 is rounded to 1e-12, over a step of 1e-2.
        assert!((direction[unknown] - expected).abs() < 1e-9);
    }
}

/// The clamp holds its vertices on the limit surface wherever the rest goes.
#[test]
fn clamped_vertices_stay() {
    let shell = TestShell::new(0);
    let (model, u, _) = loaded(0);
    let moved = model.vertex_displacements(&u);
    assert!(shell.mesh.ends.clamp.iter().all(|&v| moved[v as usize] == Vec3::zeros()));
    assert!(moved.iter().any(|u| u.norm() > 1.0));
    assert!(model.smallest_gap(&u) > 0.0 && model.plane_force(&u) > 0.0);
}

/// A free shell at rest is free of force, and its six rigid motions are the only ones that cost nothing.
#[test]
fn free_shell_has_six_rigid_motions() {
    let settings = ShellSettings { thickness: 0.8, clamp_height: 6.0, ..Default::default() };
    let sphere = ShellMesh::new(TriangleMesh::sphere(10.0, 1), &settings).unwrap();
    let eggs = [0, 1, 2].map(|seed| TestShell::new(seed).mesh);
    for mesh in eggs.iter().chain([&sphere]) {
        let free = Support::Unknowns(Vec::new());
        let mut model = PartModel::new(mesh, &MATERIAL, &free, &PartSetup::default()).unwrap();
        let rest = DVector::zeros(model.unknowns());
        let residual = residual_at(&mut model, &rest).amax();
        assert!(residual < 1e-13 * model.force_scale(), "{residual:e}");
        let tangent = tangent_at(&mut model, &rest);
        let mut eigenvalues = tangent.symmetric_eigenvalues();
        eigenvalues.as_mut_slice().sort_by(f64::total_cmp);
        let stiffest = eigenvalues.amax();
        // Rounding of a matrix of order 126; then the softest bending mode, a hundredth of the stiffest.
        assert!(eigenvalues.rows(0, 6).amax() < 1e-14 * stiffest, "{eigenvalues}");
        assert!(eigenvalues[6] > 5e-3 * stiffest, "{eigenvalues}");
    }
}

/// Whoever has a share finds in it the bits of the whole, and spares itself the rest.
#[test]
fn a_share_has_what_the_whole_has() {
    let (mut model, u, _) = loaded(1);
    let pattern = model.pattern().clone();
    let mut evaluated = |share: Option<&[bool]>| {
        model.set_share(share);
        let (mut residual, mut tangent) = (vec![0.0; u.len()], vec![0.0; pattern.stored()]);
        model.tangent(&u, &mut residual, &mut tangent).unwrap();
        (residual, tangent)
    };
    let whole = evaluated(None);
    let share: Vec<bool> = (0..u.len()).map(|unknown| unknown / 3 % 16 == 5).collect();
    let part = evaluated(Some(&share));
    let mut spared = 0;
    for column in 0..u.len() {
        assert!(!share[column] || part.0[column] == whole.0[column]);
        for at in pattern.column_starts[column]..pattern.column_starts[column + 1] {
            let [row, at] = [pattern.row_indices[at as usize], at].map(|index| index as usize);
            assert!(!(share[column] || share[row]) || part.1[at] == whole.1[at]);
            spared += usize::from(part.1[at] == 0.0 && whole.1[at] != 0.0);
        }
    }
    assert!(spared > 0);
    assert_eq!(evaluated(None), whole);
}
