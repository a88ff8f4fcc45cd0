//! Pneumatic soft actuators designed by evolution.
//!
//! A network of a few nodes becomes a field, the field a closed surface, the surface a shell, the
//! shell an energy, the energy an equilibrium path under pressure, the path objectives; NSGA-II
//! keeps the networks that do well.
//!
//! # One part under load
//!
//! A scene file says what a part is, what its wall is made of, and what loads it; [`scene::Scene`]
//! reads and walks it. A thin sphere of neo-Hookean rubber of radius R and wall h carries, at the
//! stretch l, the pressure `p = 2 mu h / R (1 / l - 1 / l^7)`:
//!
//! ```
//! use std::path::Path;
//!
//! use pneumorph::scene::{Scene, Unobserved};
//! use pneumorph::solve::{Backend, Ending, Stop};
//!
//! let text = r#"
//!     [part.sphere]
//!     radius = 10.0
//!     subdivisions = 2
//!     [wall]
//!     thickness = 0.1
//!     [material]
//!     law = "neo-hookean"
//!     mu = 1.0
//!     [load]
//!     pressure = 0.01
//!     [load.path]
//!     steps = 4
//! "#;
//! let scene = Scene::parse(text, Path::new("sphere.toml"), Some(Backend::Native))?;
//! let path = scene.walk(Stop::NEVER, &Unobserved)?.path;
//! assert_eq!(path.ending, Ending::Reached);
//! // The load is the pressure, MPa; its conjugate the enclosed volume, mm^3.
//! for point in &path.points[1..] {
//!     let stretch = (point.conjugate / path.points[0].conjugate).cbrt();
//!     let exact = 2.0 * 1.0 * 0.1 / 10.0 * (1.0 / stretch - stretch.powi(-7));
//!     assert!((point.load / exact - 1.0).abs() < 0.02, "{} {exact}", point.load);
//! }
//! # anyhow::Ok(())
//! ```
//!
//! # A network and what it is worth
//!
//! A run file says how a search goes and what decides the outcome of each candidate.
//! [`fitness::evaluate_network`] evaluates one network as a search does, and the rooms below it are
//! its steps.
//!
//! ```
//! use std::path::Path;
//!
//! use pneumorph::field::{CappedField, CompiledNetwork};
//! use pneumorph::fitness::{Outcome, evaluate_network};
//! use pneumorph::genome::Network;
//! use pneumorph::mesh::shell_of_field;
//! use pneumorph::study::RunFile;
//!
//! let run = RunFile::parse("[mesh]\nedge = 5.0", Path::new("run.toml"), None)?;
//! let settings = run.candidate_settings()?;
//! let network: Network = std::fs::read_to_string("examples/networks/basic_bend.toml")?.parse()?;
//!
//! // From the network to a shell: the chamber is where the field is below 0.
//! let (design_box, rim) = (settings.design_box, settings.mesh.rim_radius);
//! let field = CappedField::new(CompiledNetwork::new(&network), design_box, rim)?;
//! let shell = shell_of_field(&field, &settings.mesh, &settings.wall)
//!     .map_err(|rejected| anyhow::anyhow!("{rejected}"))?;
//! assert!(shell.surface.volume() > 0.0);
//!
//! // From the network to its objectives: the free part bends, and against a plane it pushes.
//! let Outcome::Evaluated(evaluation) = evaluate_network(&network, &settings)?.outcome else {
//!     anyhow::bail!("the network makes no part")
//! };
//! assert!(evaluation.objectives["bending"] > 0.0 && evaluation.objectives["blocking"] > 0.0);
//! # anyhow::Ok(())
//! ```
//!
//! `examples/front.rs` runs a whole search: [`study::search`] evaluates generation after generation
//! in a folder, and returns the front.
//!
//! # The rooms
//!
//! Data moves in one direction, and a room names only rooms to its left:
//! `genome -> field -> surface -> mesh -> model -> solve -> fitness -> batch -> evolve -> printing -> report -> scene -> study`.
//! `verify` and `calibration` name `scene`, and `cli` all. `ARCHITECTURE.md` says what each room answers and what it
//! must never know.
//!
//! # Features
//!
//! Without default features the crate is a library up to [`scene`]: no figures, no command line, no
//! PETSc.
//!
//! | feature | adds |
//! |---|---|
//! | `report` | [`report`], and the rooms that draw figures: [`study`], [`verify`], [`calibration`] |
//! | `cli` | the program `pneumorph`, with `report` |
//! | `monitor` | the web page of a run, with `report` |
//! | `petsc` | PETSc's solvers beside our own |

#![cfg_attr(
    not(feature = "cli"),
    allow(dead_code, reason = "what only commands call is looked at where they are built")
)]

pub mod math;

pub mod genome;

pub mod field;

pub mod surface;

pub mod mesh;

pub mod model;

pub mod solve;

pub mod fitness;

pub mod batch;

pub mod evolve;

pub mod printing;

pub mod io;

#[cfg(feature = "report")]
pub mod report;

#[cfg(feature = "monitor")]
pub mod monitor;

pub mod scene;

#[cfg(feature = "report")]
pub mod study;

#[cfg(feature = "report")]
pub mod verify;

#[cfg(feature = "report")]
pub mod calibration;

#[cfg(feature = "cli")]
pub mod cli;
