//! A strip is bent by a force at its end: the deflection of the linear theory, beside that of a
//! beam.
//!
//! `cargo run --example cantilever`
//!
//! ```text
//! w = F L^3 / (3 E I),   I = b h^3 / 12
//! ```

#![allow(clippy::print_stdout, reason = "it is a program that prints a line")]

use std::path::Path;

use anyhow::Context;
use pneumorph::scene::{Scene, Unobserved};
use pneumorph::solve::{Backend, Stop};

const SCENE: &str = r#"
[part.patch]
s = [0, 10]
t = [0, 1]
cells = [32, 4]
x = "s"
y = "t"
z = "0"

[wall]
thickness = 0.1

[material]
law = "st-venant-kirchhoff"
young_modulus = 1.2e6
poisson_ratio = 0.0

[load]
linear = true

[[edge]]
side = "s0"
clamped = true

[[force]]
side = "s1"
per_length = [0, 0, 4]

[[watch]]
name = "w"
at = [10, 0]
direction = [0, 0, 1]
"#;

/// The deflection of the end, mm: of the strip, and of the beam.
pub(crate) fn deflections() -> anyhow::Result<[f64; 2]> {
    let scene = Scene::parse(SCENE, Path::new("strip.toml"), Some(Backend::Native))?;
    let walk = scene.walk(Stop::NEVER, &Unobserved)?;
    let (_, values) = walk.watches.first().context("the scene has one watch")?;
    let strip = *values.last().context("the strip is stable at rest")?;
    let inertia = 0.1_f64.powi(3) / 12.0;
    Ok([strip, 4.0 * 10.0_f64.powi(3) / (3.0 * 1.2e6 * inertia)])
}

fn main() -> anyhow::Result<()> {
    let [strip, beam] = deflections()?;
    println!("the strip's end moves by {strip:.4} mm, a beam's by {beam:.4} mm");
    Ok(())
}
