//! What a scene may say of its load, what holds a part, and what is said of a number without a unit.

use super::parts::{STRIP, bent};
use super::workshop::Workshop;

/// A balloon of neo-Hookean rubber, t/R = 0.01, in a few triangles.
const BALLOON: &str = r#"
[part.sphere]
radius = 10.0
subdivisions = 1

[wall]
thickness = 0.1

[material]
law = "neo-hookean"
mu = 1.0

[solver]
backend = "native"

[load.path]
steps = 2

[load]
"#;

/// A number of mm^3 and a multiple that mean the same end at the same state; nothing is taken for the other.
#[test]
fn a_volume_has_its_unit() {
    let workshop = Workshop::new();
    let ends = |name: &str, load: &str| {
        workshop.write("scene.toml", format!("{BALLOON}{load}"));
        workshop.succeed(&["simulate", "scene.toml", "--out", name]);
        let [volumes, pressures] = ["volume_mm3", "pressure_MPa"]
            .map(|it| workshop.column(&format!("{name}/path.csv"), it));
        (volumes, pressures)
    };
    let (volumes, pressures) = ends("ratio", "volume_ratio = 1.1");
    assert!((volumes[2] / volumes[0] - 1.1).abs() < 1e-12, "{volumes:?}");
    let (same, pressures_too) = ends("mm3", &format!("volume_mm3 = {:?}", 1.1 * volumes[0]));
    assert!((same[2] / volumes[2] - 1.0).abs() < 1e-12);
    assert!(
        (pressures_too[2] / pressures[2] - 1.0).abs() < 1e-6,
        "{pressures:?} {pressures_too:?}"
    );
    // A membrane's 2 mu t / R (1/l - 1/l^7) at a stretch of the cube root; icosahedra quartered once are spheres to 2 %.
    let stretch = 1.1_f64.cbrt();
    let exact = 2.0 * 0.1 / 10.0 * (1.0 / stretch - stretch.powi(-7));
    assert!((pressures[2] / exact - 1.0).abs() < 0.05, "{pressures:?} {exact}");

    // Closed off: the same gas, and nothing that would move the wall.
    let (volumes, pressures) = ends("sealed", "gas = { amount = 1.0 }");
    assert_eq!(pressures.last(), Some(&0.0));
    assert_eq!(volumes.first(), volumes.last());
    let (_, pressures) = ends("nothing", "pressure = 0.0");
    assert_eq!(pressures, [0.0]);
}

#[test]
fn a_load_is_said_once_and_with_its_unit() {
    let workshop = Workshop::new();
    let refuse = |load: &str, said: &[&str]| {
        workshop.write("scene.toml", format!("{BALLOON}{load}\n"));
        workshop.refuse(&["simulate", "scene.toml", "--out", "out"], 1, said);
        assert!(!workshop.path("out").exists());
    };
    refuse(
        "volume = 60000",
        &["scene.toml:20: `volume` has no unit", "`volume_ratio`", "`volume_mm3`"],
    );
    refuse(
        "gas = 1.3",
        &["scene.toml:20: invalid type: floating point `1.3`", "written gas = { amount = 1.3 }"],
    );
    refuse("gas = { amount = \"much\" }", &["scene.toml:20:", "expected a number"]);
    refuse(
        "pressure = 0.1\nvolume_ratio = 1.3",
        &["has both `pressure` and `volume_ratio`", "give one"],
    );
    refuse("pressure = 0.1\ngas = { amount = 1.3 }", &["has both `pressure` and `gas`"]);
    refuse("volume_mm3 = 5.0\nvolume_ratio = 1.3", &["has both `volume_ratio` and `volume_mm3`"]);
    refuse("volume_ratio = 1.3\ncurve = true", &["has both `volume_ratio` and `curve`"]);
    refuse("volume_mm3 = -5.0", &["[load] volume_mm3 is -5.0, but it must be a positive number"]);
    refuse(
        "volume_mm3 = 0.5",
        &["[load] volume_mm3 is 0.5, but the part encloses", "mm^3 at rest"],
    );
    for section in ["wall = 3", "load = 0.1", "part = \"a.stl\"", "solid = true"] {
        workshop.write("scene.toml", format!("{section}\n"));
        let said = workshop.run(&["simulate", "scene.toml", "--out", "out"]).err;
        assert!(said.contains("scene.toml:1: ") && said.contains("section, [name]"), "{said}");
        assert!(!said.contains("struct") && !said.contains("Section"), "{said}");
    }
}

/// Pulls the strip down at its other end with 1e-6 N/mm: by 0.09 mm, F L^3 / (3 E I), at a thickness of 0.5 mm.
const CANTILEVER: &str = r#"
[[force]]
side = "s1"
per_length = [0, 0, -1e-6]

[load.path]
steps = 1
"#;

/// The clamp carries the force and its moment `-r cross F`; the tip comes back by 3 w^2 / 5 L, 1e-5 of the length. The lattice's
/// diagonals twist it a little.
#[test]
fn a_cantilever_is_held_by_its_clamp() {
    let workshop = Workshop::new();
    for element in ["loop", "mid-edge"] {
        let wall = format!("[wall]\nthickness = 0.5\nelement = \"{element}\"\n");
        workshop.write("scene.toml", format!("{STRIP}{CANTILEVER}{wall}"));
        workshop.succeed(&["simulate", "scene.toml", "--out", element]);
        let path = format!("{element}/path.csv");
        let last = |column: &str| *workshop.column(&path, column).last().unwrap();
        let force = ["x", "y", "z"].map(|axis| last(&format!("reaction_force_{axis}_N")));
        let moment = ["x", "y", "z"].map(|axis| last(&format!("reaction_moment_{axis}_Nmm")));
        // Newton's tolerance is 1e-9 of the largest load on a node, some 1e-6 N.
        assert!(force[0].abs() < 1e-11 && force[1].abs() < 1e-11, "{element}: {force:?}");
        assert!((force[2] - 4e-6).abs() < 1e-11, "{element}: {force:?}");
        let exact = -20.0 * 4e-6;
        assert!((moment[1] / exact - 1.0).abs() < 1e-4, "{element}: {moment:?}");
        assert!(moment[0].abs().max(moment[2].abs()) < -1e-3 * exact, "{element}: {moment:?}");
        let about = workshop.json(&format!("{element}/summary.json"))["reaction"]["about"].clone();
        assert_eq!(about, serde_json::json!([0.0, 2.0, 0.0]), "{element}");
    }
}

/// A plane on the side to which the part bends, and another that it never meets.
const PLANES: &str = "
[[plane]]
normal = [1.0, 0.0, 0.0]
distance = 3.0

[[plane]]
normal = [-1.0, 0.0, 0.0]
distance = 30.0
";

/// What the clamp gives is what the planes take, in force and in moment; a pressure alone has no resultant.
#[test]
fn a_clamp_balances_the_planes() {
    let workshop = Workshop::new();
    workshop.write("scene.toml", bent(5.0, 0.012, 2) + PLANES);
    let said = workshop.succeed(&["simulate", "scene.toml", "--out", "out"]);
    assert!(said.contains("plane 0 pressed with ") && said.contains("held with ("), "{said}");
    let summary = workshop.json("out/summary.json");
    let vector = |value: &serde_json::Value| -> Vec<f64> {
        value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
    };
    let [force, moment, about] =
        ["force", "moment", "about"].map(|key| vector(&summary["reaction"][key]));
    let pressed = vector(&summary["planes"][0]["force"]);
    let centre = vector(&summary["planes"][0]["centre"]);
    assert!(pressed[0] < -0.1, "{pressed:?}");
    assert_eq!(vector(&summary["planes"][1]["force"]), [0.0, 0.0, 0.0]);
    // Newton's tolerance is 1e-9 of a force scale of some 10 N, at some hundred nodes.
    for axis in 0..3 {
        assert!((force[axis] - pressed[axis]).abs() < 1e-6, "{force:?} {pressed:?}");
    }
    // The part presses at the centre along x: r cross f.
    let arm = [1, 2].map(|axis| centre[axis] - about[axis]);
    let exact = [0.0, arm[1] * pressed[0], -arm[0] * pressed[0]];
    for axis in 0..3 {
        assert!((moment[axis] - exact[axis]).abs() < 1e-4, "{moment:?} {exact:?}");
    }
    let [pressures, near, far, held] =
        ["pressure_MPa", "plane_0_force_N", "plane_1_force_N", "reaction_force_x_N"]
            .map(|column| workshop.column("out/path.csv", column));
    assert!(far.iter().all(|force| *force == 0.0), "{far:?}");
    for (step, ((pressure, near), held)) in pressures.into_iter().zip(near).zip(held).enumerate() {
        assert!((held + near).abs() < 1e-6, "step {step}: {held} {near}");
        assert!(step > 0 || (pressure == 0.0 && held.abs() < 1e-9));
    }
}
