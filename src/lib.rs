//! Pneumatic soft actuators designed by evolution.
//!
//! A network of a few nodes becomes a field, the field a closed surface, the surface a shell, the shell an energy, the energy an
//! equilibrium path under pressure, the path objectives; NSGA-II keeps the networks that do well.
//!
//! # One part under load
//!
//! A scene file says what a part is, what its wall is made of, and what loads it; [`scene::Scene`] reads and walks it. A thin sphere of
//! neo-Hookean rubber of radius R and wall h carries, at the stretch l, the pressure `p = 2 mu h / R (1 / l - 1 / l^7)`:
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
//! A run file says how a search goes and what decides the outcome of each candidate. [`study::search`] runs it in a folder, and returns
//! the front; [`fitness::evaluate_network`] evaluates one network as the search does, and the rooms below it are its steps.
//!
//! ```
//! use std::path::Path;
//!
//! use pneumorph::field::{CappedField, CompiledNetwork};
//! use pneumorph::fitness::{Outcome, evaluate_network};
//! use pneumorph::genome::Network;
//! use pneumorph::mesh::shell_of_field;
//! use pneumorph::scene::Unobserved;
//! use pneumorph::study::{Manner, RunFile, Searched, Unlimited, search};
//!
//! let text = "
//!     [evolution]
//!     population = 8
//!     generations = 2
//!     [mesh]
//!     edge = 5.0
//! ";
//! let run = RunFile::parse(text, Path::new("run.toml"), None)?;
//! let settings = run.candidate_settings()?;
//! let network: Network = std::fs::read_to_string("examples/networks/basic_bend.toml")?.parse()?;
//!
//! // From the network to a shell: the chamber is where the field is below 0.
//! let (size, rim) = (settings.design_box, settings.mesh.rim_radius);
//! let field = CappedField::new(CompiledNetwork::new(&network), size, rim)?;
//! let shell = shell_of_field(&field, &settings.mesh, &settings.wall)?;
//! assert!(shell.surface.volume() > 0.0);
//!
//! // From the network to its objectives: free, the part bends; against a plane, it pushes.
//! let Outcome::Evaluated(evaluation) = evaluate_network(&network, &settings)?.outcome else {
//!     panic!("the network makes a part")
//! };
//! assert!(evaluation.objectives["bending"] > 0.0 && evaluation.objectives["blocking"] > 0.0);
//!
//! // All of it, for every candidate of a search, takes a minute.
//! let find = || match search(&run, Path::new("run"), &Manner::default(), &Unlimited, &Unobserved)? {
//!     Searched::Finished(found) => Ok(found.front),
//!     Searched::Stopped | Searched::Served => anyhow::bail!("there are no limits, and one process"),
//! };
//! # let _ = &find;
//! # anyhow::Ok(())
//! ```
//!
//! # The rooms
//!
//! Data moves in one direction, and a room names only rooms to its left:
//! `genome -> field -> surface -> mesh -> model -> solve -> fitness -> batch -> evolve -> printing -> report -> scene -> study`.
//! `verify` names `scene`, and `cli` all. `ARCHITECTURE.md` says what each room answers and what it must never know.

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

pub mod report;

#[cfg(feature = "monitor")]
pub mod monitor;

pub mod scene;

pub mod study;

pub mod verify;

pub mod cli;
