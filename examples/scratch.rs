#![allow(missing_docs)]
use pneumorph::math::{Vec3, cpu_seconds};
use pneumorph::mesh::{Patch, ShellElement, Side};
use pneumorph::model::material::{Material, NeoHookean};
use pneumorph::model::system::{LoadedSystem, System};
use pneumorph::model::{DeadLoad, EdgeSupport as E, PatchLoads, ShellModel};
use pneumorph::solve::{EquilibriumSolver, NativeSolver};
use std::f64::consts::PI;

fn linear(
    patch: &Patch,
    el: ShellElement,
    mat: &Material,
    loads: &PatchLoads,
) -> Option<(ShellModel, Vec<f64>, f64)> {
    let t0 = cpu_seconds();
    let mut model = match ShellModel::of_patch(patch, el, mat, loads) {
        Ok(m) => m,
        Err(e) => {
            println!("{e}");
            return None;
        }
    };
    let mut solver = NativeSolver::new(model.pattern()).unwrap();
    let u = vec![0.0; model.unknowns()];
    model.set_load(0.0);
    let neg = solver.linearize(&mut model, &u).unwrap();
    if neg > 0 {
        println!("negative pivots {neg}");
    }
    let mut b = vec![0.0; u.len()];
    model.load_direction(&u, &mut b);
    solver.solve_linearized(&mut b).unwrap();
    let t = cpu_seconds() - t0;
    Some((model, b, t))
}

fn main() {
    let which = std::env::args().nth(1).unwrap();
    let nmax: usize = std::env::args().nth(2).map_or(32, |s| s.parse().unwrap());
    // incompressible neo-Hookean only yet: nu = 0.5
    for el in [ShellElement::Loop, ShellElement::MidEdge] {
        let mut n = 4;
        while n <= nmax {
            let d = PI / 180.0;
            let (patch, loads, at, dir, exact, e, nu): (
                Patch,
                PatchLoads,
                [f64; 2],
                Vec3,
                f64,
                f64,
                f64,
            ) = match which.as_str() {
                "plate" => {
                    // clamped square plate, uniform load, quarter: w = 0.00126 q a^4/D
                    let p = Patch::new([n, n], [0.0, 5.0], [0.0, 5.0], 0.01, &|s, t| {
                        Vec3::new(s, t, 0.0)
                    })
                    .unwrap();
                    let dd = 4.0 / 3.0 * 1.0_f64 * 0.01_f64.powi(3) / 4.0;
                    (
                        p,
                        PatchLoads {
                            supports: [E::Symmetry(0), E::Clamped, E::Symmetry(1), E::Clamped],
                            dead: vec![DeadLoad::Area { per_area: Vec3::new(0.0, 0.0, 1e-9) }],
                            ..Default::default()
                        },
                        [0.0, 0.0],
                        Vec3::z(),
                        0.00126532 * 1e-9 * 1e4 / dd,
                        3.0,
                        0.5,
                    )
                }
                "ssplate" => {
                    let p = Patch::new([n, n], [0.0, 5.0], [0.0, 5.0], 0.01, &|s, t| {
                        Vec3::new(s, t, 0.0)
                    })
                    .unwrap();
                    let dd = 4.0 / 3.0 * 1.0_f64 * 0.01_f64.powi(3) / 4.0;
                    (
                        p,
                        PatchLoads {
                            supports: [
                                E::Symmetry(0),
                                E::Held([true; 3]),
                                E::Symmetry(1),
                                E::Held([true; 3]),
                            ],
                            dead: vec![DeadLoad::Area { per_area: Vec3::new(0.0, 0.0, 1e-9) }],
                            ..Default::default()
                        },
                        [0.0, 0.0],
                        Vec3::z(),
                        0.00406235 * 1e-9 * 1e4 / dd,
                        3.0,
                        0.5,
                    )
                }
                "scordelis" => {
                    let p = Patch::new([n, n], [0.0, 25.0], [0.0, 40.0 * d], 0.25, &|s, t| {
                        Vec3::new(25.0 * t.sin(), s, 25.0 * t.cos())
                    })
                    .unwrap();
                    (
                        p,
                        PatchLoads {
                            supports: [
                                E::Symmetry(1),
                                E::Held([true, false, true]),
                                E::Symmetry(0),
                                E::Free,
                            ],
                            dead: vec![DeadLoad::Area { per_area: Vec3::new(0.0, 0.0, -90.0) }],
                            ..Default::default()
                        },
                        [0.0, 40.0 * d],
                        -Vec3::z(),
                        0.3006,
                        4.32e8,
                        0.0,
                    )
                }
                "pinched" => {
                    let p = Patch::new([n, n], [0.0, 300.0], [0.0, 90.0 * d], 3.0, &|s, t| {
                        Vec3::new(300.0 * t.sin(), s, 300.0 * t.cos())
                    })
                    .unwrap();
                    let v = p.vertex(0.0, 0.0).unwrap();
                    (
                        p,
                        PatchLoads {
                            supports: [
                                E::Symmetry(1),
                                E::Held([true, false, true]),
                                E::Symmetry(0),
                                E::Symmetry(2),
                            ],
                            dead: vec![DeadLoad::Point {
                                vertex: v,
                                force: Vec3::new(0.0, 0.0, -0.25),
                            }],
                            ..Default::default()
                        },
                        [0.0, 0.0],
                        -Vec3::z(),
                        1.82488e-5,
                        3e6,
                        0.3,
                    )
                }
                "hemisphere" => {
                    let p = Patch::new([n, n], [0.0, 72.0 * d], [0.0, 90.0 * d], 0.04, &|s, t| {
                        10.0 * Vec3::new(s.cos() * t.cos(), s.cos() * t.sin(), s.sin())
                    })
                    .unwrap();
                    let (a, b) = (p.vertex(0.0, 0.0).unwrap(), p.vertex(0.0, 90.0 * d).unwrap());
                    (
                        p,
                        PatchLoads {
                            supports: [E::Free, E::Free, E::Symmetry(1), E::Symmetry(0)],
                            dead: vec![
                                DeadLoad::Point { vertex: a, force: Vec3::new(1.0, 0.0, 0.0) },
                                DeadLoad::Point { vertex: b, force: Vec3::new(0.0, -1.0, 0.0) },
                            ],
                            ..Default::default()
                        },
                        [0.0, 0.0],
                        Vec3::x(),
                        0.0935,
                        6.825e7,
                        0.3,
                    )
                }
                "hypar" => {
                    let th: f64 = std::env::args().nth(3).unwrap().parse().unwrap();
                    let p = Patch::new([n, n.div_ceil(2)], [-0.5, 0.5], [0.0, 0.5], th, &|s, t| {
                        Vec3::new(s, t, s * s - t * t)
                    })
                    .unwrap();
                    let exact = if th > 5e-3 {
                        9.3355e-5
                    } else if th > 5e-4 {
                        6.3941e-3
                    } else {
                        5.2988e-1
                    };
                    (
                        p,
                        PatchLoads {
                            supports: [E::Clamped, E::Free, E::Symmetry(1), E::Free],
                            dead: vec![DeadLoad::Area {
                                per_area: Vec3::new(0.0, 0.0, -8000.0 * th),
                            }],
                            ..Default::default()
                        },
                        [0.5, 0.0],
                        -Vec3::z(),
                        exact,
                        2e11,
                        0.3,
                    )
                }
                _ => panic!(),
            };
            let mat = material(e, nu);
            if let Some((model, u, t)) = linear(&patch, el, &mat, &loads) {
                let moved = model.vertex_displacements(&u)
                    [patch.vertex(at[0], at[1]).unwrap() as usize]
                    .dot(&dir);
                println!(
                    "{which} {el:?} {n:3}: {moved:.6e} / {exact:.6e} = {:.5}   {} unknowns {t:.3} s",
                    moved / exact,
                    model.free_unknowns()
                );
            }
            n *= 2;
        }
    }
    let _ = Side::S0;
}
fn material(e: f64, nu: f64) -> Material {
    let _ = nu;
    Material::NeoHookean(NeoHookean { mu: e / 3.0 })
}
