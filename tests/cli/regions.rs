//! Scenes whose wall is not the same everywhere.

use super::parts::bent;
use super::workshop::Workshop;

/// A tube of 8 mm radius.
const TUBE: &str = "[[node]]\nname = \"tube\"\nlinks = { r = 1.0 }\nbias = -0.8\n";
const TIP: &str = "[[watch]]\nname = \"x\"\nmeasure = \"tip\"\ndirection = [1, 0, 0]\n";

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

/// A tube that is stiff on one side bends towards it: one way or the other alike, but for a fifth, since triangles of 4 mm divide its
/// ring of 50 mm in unequal halves; and by less than a tenth of that where it is the same everywhere.
#[test]
fn a_stiff_side_bends_the_part_towards_it() {
    let workshop = Workshop::new();
    workshop.write("network.toml", TUBE);
    let end = |name: &str, regions: &str| {
        workshop.write("scene.toml", format!("{}{regions}{TIP}", bent(4.0, 0.02, 1)));
        workshop.succeed(&["simulate", "scene.toml", "--out", name]);
        *workshop.column(&format!("{name}/watches.csv"), "value").last().unwrap()
    };
    let material = "material = { law = \"neo-hookean\", mu = 10.0 }";
    let stiff = |place: &str| format!("[[region]]\nwhere = \"{place}\"\n{material}\n");
    let [plain, back, front] =
        [end("plain", ""), end("back", &stiff("-x")), end("front", &stiff("x"))];
    assert!(back < 0.0 && front > 0.0, "{back} {plain} {front}");
    assert!(plain.abs() < 0.1 * front && (back + front).abs() < 0.2 * front, "{back} {front}");
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
    workshop.write("scene.toml", scene);
    workshop.refuse(&["deck", "scene.toml", "--out", "deck"], 1, &["[[region]]"]);
}

/// The tube stiff or thick on one side, as a shell and as a solid: their chambers grow alike to 2 %, as those of plain walls do in
/// cells of 3 mm, and both bend the same way. (How far is of second order in the pressure: a closed thin tube of an incompressible
/// material keeps its length at first order, whatever its sides are made of.)
#[test]
fn a_shell_and_a_solid_of_a_varying_wall_grow_alike() {
    let workshop = Workshop::new();
    workshop.write("network.toml", TUBE);
    let ends = |name: &str, wall: &str| {
        let scene = bent(3.0, 0.02, 1);
        let short = "[box]\nmin = [-10.0, -10.0, 0.0]\nmax = [10.0, 10.0, 40.0]\n";
        workshop.write("scene.toml", format!("{scene}{short}{wall}{TIP}"));
        workshop.succeed(&["simulate", "scene.toml", "--out", name]);
        let volumes = workshop.column(&format!("{name}/path.csv"), "volume_mm3");
        let tip = workshop.column(&format!("{name}/watches.csv"), "value");
        (volumes[1] - volumes[0], tip[1])
    };
    let stiff = "[[region]]\nwhere = \"-x\"\nmaterial = { law = \"neo-hookean\", mu = 5.0 }\n";
    // From 2.4 mm at x = -8 mm to 0.8 mm at 8 mm.
    let thick = "[[region]]\nthickness = \"1.6 - 0.1 * x\"\n";
    for (name, region) in [("stiff", stiff), ("thick", thick)] {
        let (shell, to) = ends(&format!("{name}_shell"), region);
        let (solid, too) =
            ends(&format!("{name}_solid"), &format!("{region}[solid]\nedge = 3.0\n"));
        assert!((solid / shell - 1.0).abs() < 0.02, "{name}: {shell} {solid}");
        assert!(to < 0.0 && too < 0.0, "{name}: {to} {too}");
    }
}

/// A scene whose network says where its wall is thick and stiff; and what it may not say is told.
#[test]
fn a_network_may_say_what_its_wall_is_made_of() {
    let workshop = Workshop::new();
    let node = "[[node]]\nname = \"side\"\nlinks = { x = -1.0 }\n";
    let of_wall = |wall: &str| format!("output = \"tube\"\n[wall]\n{wall}\n{TUBE}{node}");
    let pattern = "[pattern]\nmaterial = { law = \"neo-hookean\", mu = 10.0 }\n";
    let scene = |pattern: &str| format!("{}{pattern}{TIP}", bent(4.0, 0.02, 1));
    workshop.write("network.toml", of_wall("material = \"side\""));
    workshop.write("scene.toml", scene(pattern));
    workshop.succeed(&["simulate", "scene.toml", "--out", "of_network"]);
    // The same region of a scene; the network's side has x in cm.
    workshop.write("network.toml", TUBE);
    let region = "[[region]]\nwhere = \"-x\"\nmaterial = { law = \"neo-hookean\", mu = 10.0 }\n";
    workshop.write("scene.toml", scene(region));
    workshop.succeed(&["simulate", "scene.toml", "--out", "of_scene"]);
    let value = |name: &str| workshop.column(&format!("{name}/watches.csv"), "value");
    assert_eq!(value("of_network"), value("of_scene"));

    workshop.refuse_scene(&scene(pattern), &["[pattern] material wants a network whose [wall]"]);
    workshop.write("network.toml", of_wall("thickness = \"side\""));
    workshop.refuse_scene(&scene(""), &["network.toml", "[pattern] thickness = [0.8, 2.4]"]);
    workshop.write("run.toml", "[mesh]\nedge = 5.0\n");
    let certify = ["certify", "run.toml", "network.toml", "--out", "certified"];
    workshop.refuse(&certify, 1, &["network: the network's [wall] names a node for the thickness"]);
    workshop
        .refuse_scene(&scene("[pattern]\n"), &["[pattern] wants a `thickness` or a `material`"]);
    let reversed = "[pattern]\nthickness = [2.0, 1.0]\n";
    workshop.refuse_scene(&scene(reversed), &["the smaller one comes first"]);
    workshop.write("network.toml", of_wall("thickness = \"tub\""));
    workshop.refuse_scene(&scene(""), &["did you mean `tube`?"]);
}

/// A search with genes of the wall ends, to the same bytes from a checkpoint, and its designs are read again with what they inherit.
#[test]
fn a_search_evolves_the_wall() {
    let workshop = Workshop::new();
    let run = |generations: usize| {
        format!(
            "[evolution]\npopulation = 6\ngenerations = {generations}\nseed = 3\n[mesh]\nedge = 5.0\n\
             [load]\npressure = 0.02\n[load.path]\nsteps = 2\n[material]\nlaw = \"neo-hookean\"\nmu = 1.0\n\
             [pattern]\nthickness = [1.0, 2.0]\nmaterial = {{ law = \"neo-hookean\", mu = 5.0 }}\n"
        )
    };
    workshop.write("run.toml", run(2));
    workshop.succeed(&["evolve", "run.toml", "--out", "whole"]);
    workshop.write("run.toml", run(1));
    workshop.succeed(&["evolve", "run.toml", "--out", "parts"]);
    workshop.write("run.toml", run(2));
    workshop.succeed(&["evolve", "run.toml", "--out", "parts", "--resume"]);
    assert_eq!(workshop.read("whole/front.csv"), workshop.read("parts/front.csv"));
    let records = workshop.read("whole/candidates.jsonl");
    let record: serde_json::Value = serde_json::from_str(records.lines().next().unwrap()).unwrap();
    assert_eq!(record["genome"].as_array().unwrap().len(), 22 + 4 + 4);
    let front = workshop.read("whole/front.csv");
    let id = front.lines().nth(1).unwrap().split(',').next().unwrap();
    workshop.refuse(&["deck", "whole", id, "--out", "made"], 1, &["[pattern]"]);
    let network = workshop.read(&format!("whole/front/{id}/genome.toml"));
    assert!(
        network.contains("[wall]\nthickness = \"thickness\"\nmaterial = \"side\""),
        "{network}"
    );
}
