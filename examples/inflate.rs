//! A sphere of rubber is inflated: its stretch at each pressure, beside the closed form of a thin
//! balloon.
//!
//! `cargo run --example inflate`
//!
//! ```text
//! p = 2 mu h / R (1 / l - 1 / l^7)        stretch l, radius R and wall h at rest, neo-Hookean rubber
//! ```

#![allow(clippy::print_stdout, reason = "it is a program that prints a table")]

use std::path::Path;

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
pressure = 0.01

[load.path]
steps = 5
"#;

/// Stretch, pressure and the closed form's pressure (MPa), of each state after rest.
pub(crate) fn states() -> anyhow::Result<Vec<[f64; 3]>> {
    let scene = Scene::parse(SCENE, Path::new("sphere.toml"), Some(Backend::Native))?;
    let points = scene.walk(Stop::NEVER, &Unobserved)?.path.points;
    // The conjugate of a pressure is the volume that it fills.
    let at_rest = points[0].conjugate;
    let state = |point: &pneumorph::solve::PathPoint| {
        let stretch = (point.conjugate / at_rest).cbrt();
        let exact = 2.0 * 0.1 / 10.0 * (1.0 / stretch - stretch.powi(-7));
        [stretch, point.load, exact]
    };
    Ok(points[1..].iter().map(state).collect())
}

fn main() -> anyhow::Result<()> {
    println!("stretch  pressure, MPa  closed form, MPa");
    for [stretch, pressure, exact] in states()? {
        println!("{stretch:7.4}  {pressure:13.6}  {exact:16.6}");
    }
    Ok(())
}
