//! Matrices and vectors that are spread over ranks: over the one of this process, and over two under `mpirun`.

use std::process::Command;

use super::*;
use crate::math::Vec3;
use crate::mesh::{SolidMesh, TetMesh};
use crate::model::material::{Material, NeoHookean};
use crate::model::system::{Inadmissible, LoadedSystem};
use crate::model::{PartModel, PartSetup};
use crate::solve::decorator::Decorator;
use crate::solve::petsc::library::Exchange;
use crate::solve::petsc::rows::Rows;
use crate::solve::solver_suite::solver_suite;

/// A solver that shares whatever the size.
fn together(pattern: &SparsityPattern) -> Snes {
    let session = Session::open().unwrap();
    let (rank, ranks) = session.rank();
    let rows = Rows::new(None, pattern.order(), rank, ranks);
    let exchange = Exchange::new(&session, rows).unwrap();
    let plan = Plan::Together { exchange: exchange.into(), layout: None };
    let tangent = Some(Tangent::new(&session, pattern, &plan).unwrap());
    drop(session);
    Snes { plan: Some(plan), tangent, ..Snes::new(pattern).unwrap() }
}

solver_suite!(together);

/// A hollow box of 3 x 3 x 5 cubes of six cells, clamped at its lower end, under pressure.
fn hollow_box() -> PartModel {
    let mut mesh = TetMesh::default();
    for at in (0..4 * 4 * 6).map(|v| [v % 4, v / 4 % 4, v / 16]) {
        mesh.positions.push(Vec3::from(at.map(f64::from)));
    }
    let mut faces = Vec::new();
    for [i, j, k] in (0..3 * 3 * 5).map(|c| [c % 3, c / 3 % 3, c / 9]) {
        if i == 1 && j == 1 && (1..4).contains(&k) {
            continue;
        }
        let [x, y, z] = [1, 4, 16];
        for ([a, b, c], odd) in [
            ([x, y, z], false),
            ([y, z, x], false),
            ([z, x, y], false),
            ([y, x, z], true),
            ([x, z, y], true),
            ([z, y, x], true),
        ] {
            let first = i + 4 * j + 16 * k;
            let mut cell = [first, first + a, first + a + b, first + a + b + c];
            if odd {
                cell.swap(2, 3);
            }
            mesh.tetrahedra.push(cell);
            let [a, b, c, d] = cell;
            faces.extend([[b, c, d], [a, d, c], [a, b, d], [a, c, b]]);
        }
    }
    let sorted = |face: [u32; 3]| {
        let mut sorted = face;
        sorted.sort_unstable();
        sorted
    };
    let mut counts = std::collections::BTreeMap::new();
    faces.iter().for_each(|&face| *counts.entry(sorted(face)).or_insert(0) += 1);
    for &[a, b, c] in faces.iter().filter(|face| counts[&sorted(**face)] == 1) {
        let within = |&v: &u32| {
            let at = mesh.positions[v as usize];
            (1.0..=2.0).contains(&at.x)
                && (1.0..=2.0).contains(&at.y)
                && (1.0..=4.0).contains(&at.z)
        };
        match [a, b, c].iter().all(within) {
            true => mesh.chamber.push([a, c, b]),
            false => mesh.outer.push([a, b, c]),
        }
    }
    let mesh = SolidMesh::straight(&mesh);
    let clamp: Vec<u32> =
        (0..).zip(&mesh.positions).filter(|(_, x)| x.z == 0.0).map(|(v, _)| v).collect();
    let material = Material::NeoHookean(NeoHookean { mu: 0.7 });
    let held = SolidMesh::unknowns_of(&clamp);
    let mut model =
        PartModel::of_solid(&mesh, 1.0, &material, &held.into(), &PartSetup::default()).unwrap();
    model.set_load(0.3);
    model
}

/// A model on springs that push: `-softening u^2 / 2` for each displacement.
struct Softened {
    model: PartModel,
    softening: f64,
}

impl Decorator for Softened {
    type Inner = PartModel;

    fn inner(&self) -> &PartModel {
        &self.model
    }

    fn inner_mut(&mut self) -> &mut PartModel {
        &mut self.model
    }

    fn tangent(
        &mut self,
        x: &[f64],
        residual: &mut [f64],
        tangent: &mut [f64],
    ) -> Result<f64, Inadmissible> {
        let energy = self.model.tangent(x, residual, tangent)?;
        let displacements = self.model.multipliers().start;
        for at in self.model.pattern().diagonal().take(displacements) {
            tangent[at] -= self.softening;
        }
        Ok(energy)
    }
}

/// Factorisation and iteration find the same state, solve alike, and count alike what is lost of it.
#[test]
fn solid_by_iteration_is_that_by_factorisation() {
    let mut model = hollow_box();
    let solvers = [
        Snes::with_method(model.pattern(), LinearMethod::Direct).unwrap(),
        together(model.pattern()),
        Snes::with_method(model.pattern(), LinearMethod::Iterative).unwrap(),
    ];
    let (mut states, mut counts) = (Vec::new(), Vec::new());
    for mut solver in solvers {
        let mut x = vec![0.0; model.unknowns()];
        let report = solver.solve(&mut model, &mut x, &NewtonSettings::default()).unwrap();
        assert_eq!(report.ending, NewtonEnding::Converged, "{report:?}");
        let mut count = |softening| {
            let mut system = Softened { model: model.clone(), softening };
            solver.linearize(&mut system, &x).unwrap() - system.multipliers().len()
        };
        counts.push([0.0, 0.004, 0.01, 0.02].map(&mut count));
        let mut direction = vec![0.0; x.len()];
        direction[3 * 100] = 1.0;
        assert_eq!(count(0.0), 0);
        solver.solve_linearized(&mut direction).unwrap();
        x.extend(direction);
        states.push(x);
        assert_eq!(solver.linear_iterations() > 0, states.len() == 3);
    }
    assert!(counts[0][0] == 0 && counts[0][3] > 1, "{counts:?}");
    assert_eq!(counts[1], counts[0]);
    // Of several lost directions an iteration may find fewer, never none.
    for (found, lost) in counts[2].iter().zip(&counts[0]) {
        assert!(found <= lost && (*found > 0) == (*lost > 0), "{counts:?}");
    }
    let largest = states[0].iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    for state in &states[1..] {
        let miss =
            state.iter().zip(&states[0]).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
        // The residual's tolerance is 1e-9, and the softest direction is some hundred times softer than that counts.
        assert!(miss < 1e-6 * largest, "{miss:e} of {largest}");
    }
}

/// All of the above by two ranks that run in step. A panic would end both, so those that want one are left out; threads are not in step.
#[test]
fn two_ranks_pass_the_same_tests() {
    let tests = std::env::current_exe().unwrap();
    let skipped =
        ["refused", "wants_a_tangent", "singular_tangent", "panic", "threads", "two_ranks"];
    // MPI, if a test of this process started it, has left traces that would confuse another.
    let is_ours =
        |(name, _): &(String, String)| !name.starts_with("OMPI") && !name.starts_with("PMIX");
    let ran = Command::new("mpirun")
        .env_clear()
        .envs(std::env::vars().filter(is_ours))
        .args([
            "--oversubscribe",
            "--mca",
            "mpi_yield_when_idle",
            "1",
            "--timeout",
            "600",
            "-n",
            "2",
        ])
        .arg(tests)
        .args(["solve::petsc::snes::together_tests::", "--test-threads=1"])
        .args(skipped.into_iter().flat_map(|name| ["--skip", name]))
        .envs(["OMPI_ALLOW_RUN_AS_ROOT", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM"].map(|name| (name, "1")))
        .output()
        .expect("MPI comes with its launcher `mpirun` (Debian: openmpi-bin)");
    let said = String::from_utf8_lossy(&ran.stdout);
    assert!(ran.status.success(), "{said}\n{}", String::from_utf8_lossy(&ran.stderr));
    assert_eq!(said.matches(" passed; 0 failed").count(), 2, "{said}");
}
