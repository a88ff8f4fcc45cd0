//! The published actuator of a small network is bent: how its tip moves, beside a solid of
//! quadratic tetrahedra.
//!
//! `cargo run --release --example bend`
//!
//! The reference is CalculiX' answer of `tests/benchmarks/basic_bend.rs`, around our own
//! mid-surface.

#![allow(clippy::print_stdout, reason = "it is a program that prints a line")]

use std::path::Path;

use anyhow::Context;
use pneumorph::math::Vec3;
use pneumorph::scene::{Scene, Unobserved};
use pneumorph::solve::{Backend, Stop};

const SCENE: &str = r#"
[part]
network = "basic_bend.toml"

[mesh]
edge = 3.0

[material]
law = "neo-hookean"
mu = 1.0

[load]
pressure = 0.012
"#;

/// The displacement of the tip, mm: of the shell, and of the solid.
pub(crate) fn tips() -> anyhow::Result<[Vec3; 2]> {
    // The network lies beside the scene.
    let place = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/networks/scene.toml");
    let scene = Scene::parse(SCENE, Path::new(place), Some(Backend::Native))?;
    let walk = scene.walk(Stop::NEVER, &Unobserved)?;
    let last = walk.observations.last().context("the part is stable at rest")?;
    Ok([Vec3::new(last.tip_x, last.tip_y, last.tip_z), Vec3::new(-10.6102, -0.0204, 0.6845)])
}

fn main() -> anyhow::Result<()> {
    let [shell, solid] = tips()?;
    println!("the tip of the shell moves by {:.2} mm", shell.transpose());
    println!("the tip of the solid moves by {:.2} mm", solid.transpose());
    Ok(())
}
