//! Scenes whose wall is not the same everywhere.

use super::parts::bent;
use super::workshop::Workshop;

/// A strip of 12 x 1 mm between planes of symmetry, clamped at x = 0, that bears 1e-6 N/mm at its end; a beam.
const BEAM: &str = r#"
[part.patch]
s = [0, 12]
t = [0, 1]
cells = [48, 4]
x = "s"
y = "t"
z = "0"

[wall]
thickness = 0.5

[material]
law = "st-venant-kirchhoff"
young_modulus = 1000.0
poisson_ratio = 0.0

[solver]
backend = "native"

[load]
linear = true

[[edge]]
side = "s0"
clamped = true

[[edge]]
side = "t0"
symmetry = "y"

[[edge]]
side = "t1"
symmetry = "y"

[[force]]
side = "s1"
per_length = [0.0, 0.0, 1e-6]

[[watch]]
name = "w"
at = [12, 0]
direction = [0, 0, 1]
"#;

/// Euler's beam of a stiff and a soft half, `P L^3 / (24 I) (7 / E_1 + 1 / E_2)`; of a thick and a thin half, with their own `I`.
/// Half the cell at the joint of materials is 3 % (see the benchmarks of sections), the whole one where the thickness steps 5.8 %.
#[test]
fn a_region_has_its_own_wall() {
    let workshop = Workshop::new();
    let end = |name: &str, regions: &str| {
        workshop.write("scene.toml", format!("{BEAM}{regions}"));
        workshop.succeed(&["simulate", "scene.toml", "--out", name]);
        *workshop.column(&format!("{name}/watches.csv"), "value").last().unwrap()
    };
    let inertia = |thickness: f64| thickness.powi(3) / 12.0;
    let exact =
        |first: f64, second: f64| 1e-6 * 12.0_f64.powi(3) / 24.0 * (7.0 / first + 1.0 / second);
    let halves = "\n[[region]]\nwhere = \"s - 6\"\n";
    let cases = [
        ("plain", String::new(), exact(1e3 * inertia(0.5), 1e3 * inertia(0.5)), 1e-3),
        (
            "soft",
            format!(
                "{halves}material = {{ law = \"st-venant-kirchhoff\", young_modulus = 100.0, poisson_ratio = 0.0 }}\n"
            ),
            exact(1e3 * inertia(0.5), 1e2 * inertia(0.5)),
            3e-2,
        ),
        (
            "thin",
            format!("{halves}thickness = 0.25\n"),
            exact(1e3 * inertia(0.5), 1e3 * inertia(0.25)),
            6e-2,
        ),
        // What is said last counts.
        (
            "again",
            format!("{halves}thickness = 0.25\n[[region]]\nthickness = \"0.5 + 0*s\"\n"),
            exact(1e3 * inertia(0.5), 1e3 * inertia(0.5)),
            1e-3,
        ),
    ];
    for (name, regions, exact, tolerance) in cases {
        let error = end(name, &regions) / exact - 1.0;
        assert!(error.abs() < tolerance, "{name}: {error:e}");
    }
}

/// A tube that is stiff on one side lengthens more on the other, and bends towards the stiff side: one way or the other alike, but for
/// a fifth, since triangles of 4 mm divide its ring of 50 mm in unequal halves; and not at all where it is the same everywhere.
#[test]
fn a_stiff_side_bends_the_part_towards_it() {
    let workshop = Workshop::new();
    workshop.write("network.toml", "[[node]]\nname = \"tube\"\nlinks = { r = 1.0 }\nbias = -0.8\n");
    let watch = "[[watch]]\nname = \"x\"\nmeasure = \"tip\"\ndirection = [1, 0, 0]\n";
    let end = |name: &str, regions: &str| {
        workshop.write("scene.toml", format!("{}{regions}{watch}", bent(4.0, 0.02, 1)));
        workshop.succeed(&["simulate", "scene.toml", "--out", name]);
        *workshop.column(&format!("{name}/watches.csv"), "value").last().unwrap()
    };
    let material = "material = { law = \"neo-hookean\", mu = 10.0 }";
    let stiff = |place: &str| format!("[[region]]\nwhere = \"{place}\"\n{material}\n");
    let [plain, back, front] =
        [end("plain", ""), end("back", &stiff("-x")), end("front", &stiff("x"))];
    assert!(back < 0.0 && front > 0.0, "{back} {plain} {front}");
    assert!(plain.abs() < 0.01 * front && (back + front).abs() < 0.2 * front, "{back} {front}");
}

#[test]
fn a_wrong_region_is_told_in_a_line() {
    let workshop = Workshop::new();
    let cases = [
        ("[[region]]\nwhere = \"s\"\n", "wants a `thickness` or a `material`"),
        ("[[region]]\nthickness = \"1 - s\"\n", "[[region]] thickness is 0 at (1.000, 0.000"),
        ("[[region]]\nwhere = \"x\"\nthickness = 1.0\n", "[[region]] where"),
        ("[[region]]\nthickness = true\n", "a number or a formula in quotes"),
        ("[[region]]\nmaterial = { law = \"neo-hookean\" }\n", "mu"),
        ("[[region]]\nthick = 2\n", "thick"),
    ];
    for (region, words) in cases {
        workshop.refuse_scene(&format!("{BEAM}{region}"), &[words]);
    }
    let region = "[[region]]\nthickness = 1.0\n";
    let scene = format!("{}{region}", bent(4.0, 0.01, 1));
    let solid = "[solid]\nedge = 2.0\n";
    workshop.refuse_scene(&format!("{scene}{solid}"), &["a [[region]] is one of shells"]);
    workshop.write("scene.toml", scene);
    workshop.refuse(&["deck", "scene.toml", "--out", "deck"], 1, &["[[region]]"]);
}
