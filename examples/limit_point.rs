//! A balloon gives way: air is let in by volume, and its pressure rises to a limit point and falls.
//!
//! `cargo run --example limit_point`
//!
//! The largest pressure of a thin neo-Hookean balloon is `12 / 7^(7/6) mu h / R`, at the stretch
//! `7^(1/6)`.

#![allow(clippy::print_stdout, reason = "it is a program that prints a table")]

use std::path::Path;

use anyhow::Context;
use pneumorph::scene::{Scene, Unobserved};
use pneumorph::solve::{Backend, Stop};

const SCENE: &str = r#"
[part.sphere]
radius = 10.0
subdivisions = 2

[wall]
thickness = 0.1

[material]
law = "neo-hookean"
mu = 1.0

[load]
volume_ratio = 5.0

[load.path]
steps = 12
"#;

/// The pressure at which stability under a given pressure is lost, MPa: walked, and of the closed
/// form.
pub(crate) fn limit_pressures() -> anyhow::Result<[f64; 2]> {
    let scene = Scene::parse(SCENE, Path::new("balloon.toml"), Some(Backend::Native))?;
    let path = scene.walk(Stop::NEVER, &Unobserved)?.path;
    let walked = path.limit_load().context("the balloon gives way")?;
    Ok([walked, 12.0 / 7.0_f64.powf(7.0 / 6.0) * 0.1 / 10.0])
}

fn main() -> anyhow::Result<()> {
    let [walked, exact] = limit_pressures()?;
    println!("the balloon gives way at {walked:.6} MPa; in closed form at {exact:.6} MPa");
    Ok(())
}
