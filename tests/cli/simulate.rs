//! `simulate`: what a scene's folder holds, contact, and the agreement of both solvers.

use super::parts::{STRIP, bent};
use super::workshop::Workshop;

/// Under a third of its benchmark's pressure.
fn scene() -> String {
    bent(4.0, 0.012, 4) + "[load.path.newton]\ntolerance = 1e-12\n"
}

/// A plane on the side to which the part bends, near enough to be touched.
const DISTANCE: f64 = 3.0;
const PLANE: &str = "
[[plane]]
normal = [2.0, 0.0, 0.0]
distance = 3.0
";

fn simulated(scene: &str, solver: &str) -> Workshop {
    let workshop = Workshop::new();
    workshop.write("scene.toml", scene);
    let out = workshop.succeed(&["simulate", "scene.toml", "--out", "out", "--solver", solver]);
    assert!(out.starts_with("reached at 0.0120 MPa"), "{out}");
    assert_eq!(out.lines().count(), 2, "{out}");
    workshop
}

/// The vertices of a picture: the first block behind `_`, 64-bit little-endian numbers behind their length in bytes.
fn vertices(workshop: &Workshop, name: &str) -> Vec<[f64; 3]> {
    let bytes = std::fs::read(workshop.path(name)).unwrap();
    let marker = b"<AppendedData encoding=\"raw\">\n_";
    let start =
        bytes.windows(marker.len()).position(|window| window == marker).unwrap() + marker.len();
    let number = |at: usize| <[u8; 8]>::try_from(&bytes[at..at + 8]).unwrap();
    let length = u64::from_le_bytes(number(start)) as usize;
    assert_eq!(length % 24, 0);
    let coordinate = |k: usize| f64::from_le_bytes(number(start + 8 + 8 * k));
    (0..length / 24).map(|v| [3 * v, 3 * v + 1, 3 * v + 2].map(coordinate)).collect()
}

fn leftmost(vertices: &[[f64; 3]]) -> f64 {
    vertices.iter().map(|[x, ..]| *x).fold(f64::INFINITY, f64::min)
}

#[test]
fn the_folder_of_a_scene_holds_what_is_promised() {
    let run = simulated(&scene(), "native");
    let summary = run.json("out/summary.json");
    let number = |key: &str| summary[key].as_f64().unwrap_or_else(|| panic!("{key} in {summary}"));
    let rows = run.column("out/path.csv", "step");
    assert_eq!(rows, [0.0, 1.0, 2.0, 3.0, 4.0]);
    let last = |column: &str| *run.column("out/path.csv", column).last().unwrap();
    for (axis, column) in ["tip_x_mm", "tip_y_mm", "tip_z_mm"].iter().enumerate() {
        assert_eq!(summary["tip"][axis].as_f64(), Some(last(column)), "{column}");
    }
    for (key, column) in [
        ("pressure", "pressure_MPa"),
        ("volume_final", "volume_mm3"),
        ("work", "work_mJ"),
        ("angle_deg", "angle_deg"),
        ("max_displacement", "max_displacement_mm"),
    ] {
        assert_eq!(number(key), last(column), "{key}");
    }
    assert_eq!(number("pressure"), 0.012);
    assert_eq!(number("volume_initial"), run.column("out/path.csv", "volume_mm3")[0]);
    assert_eq!(summary["ending"], "reached");
    let iterations: f64 = run.column("out/path.csv", "newton_iterations").iter().sum();
    assert_eq!(number("newton_iterations"), iterations);
    assert!(number("work") > 0.0);
    // The tip bends to -x and moves less than the part is long.
    assert!(number("volume_final") > number("volume_initial"));
    let tip_x = summary["tip"][0].as_f64().unwrap();
    assert!((-62.8..-1.0).contains(&tip_x), "{tip_x}");
    assert!(number("max_displacement") > tip_x.abs());
    for stage in ["meshing", "assembly", "factorization", "rest"] {
        assert!(summary["cpu_seconds"][stage].as_f64().unwrap() >= 0.0, "{stage}");
    }
    assert_eq!(summary["provenance"]["program"], "pneumorph");

    let header = run.read("out/path.csv").lines().next().unwrap().to_owned();
    assert_eq!(
        header,
        "step,pressure_MPa,volume_mm3,work_mJ,stored_energy_mJ,tip_x_mm,tip_y_mm,tip_z_mm,angle_deg,\
         tangent_angle_deg,max_displacement_mm,reaction_force_x_N,reaction_force_y_N,reaction_force_z_N,\
         reaction_moment_x_Nmm,reaction_moment_y_Nmm,reaction_moment_z_Nmm,newton_iterations,step_cuts,\
         stability,is_sample"
    );
    let series = run.read("out/path.pvd");
    for step in 0..=4 {
        let picture = format!("path_{step:03}.vtu");
        assert!(series.contains(&picture), "{series}");
        // Vertices and midpoints of edges, of which a closed surface has three for each vertex but two.
        let points = vertices(&run, &format!("out/{picture}")).len() as f64;
        assert_eq!(points, 4.0 * number("unknowns") / 3.0 - 6.0);
    }
    assert!(run.path("out/surface.stl").is_file());
}

#[test]
fn json_on_the_terminal_is_the_summary() {
    let workshop = Workshop::new();
    workshop.write(
        "scene.toml",
        scene().replace("steps = 4", "steps = 1").replace("edge = 4", "edge = 5"),
    );
    let out = workshop.succeed(&["simulate", "scene.toml", "--out", "out", "--json"]);
    let printed: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert_eq!(printed, workshop.json("out/summary.json"));
}

#[test]
fn an_stl_simulates_like_the_network_it_was_made_from() {
    let network = simulated(&scene(), "native");
    std::fs::copy(network.path("out/surface.stl"), network.path("part.stl")).unwrap();
    let scene = scene().replace("network = \"network.toml\"", "stl = \"part.stl\"");
    network.write("stl.toml", scene.replace("edge = 4.0", "edge = \"as given\""));
    network.succeed(&["simulate", "stl.toml", "--out", "from_stl"]);
    for column in ["tip_x_mm", "tip_z_mm", "volume_mm3"] {
        let [a, b] =
            ["out", "from_stl"].map(|run| network.column(&format!("{run}/path.csv"), column));
        for (a, b) in a.iter().zip(&b) {
            // The file rounds positions to 32 bits: 1e-7 of them, amplified some tens of times by bending.
            assert!((a - b).abs() <= 1e-5 * a.abs().max(1.0), "{column}: {a} and {b}");
        }
    }
}

/// The outer wall comes within the barrier's reach, a tenth of the thickness, and never through.
#[test]
fn the_outer_wall_stays_before_the_plane_and_presses_on_it() {
    let run = simulated(&(scene() + PLANE), "native");
    let plane = leftmost(&vertices(&run, "out/path_000.vtu")) - DISTANCE;
    let forces = run.column("out/path.csv", "plane_0_force_N");
    for (step, force) in forces.iter().enumerate() {
        let gap = leftmost(&vertices(&run, &format!("out/path_{step:03}.vtu"))) - plane;
        assert!(gap > 0.0, "step {step}: gap {gap}");
        // Contact is sampled at vertices and at edge midpoints: a midpoint may press before a vertex does.
        assert!(*force > 0.0 || gap > 0.1 * 1.6, "step {step}: gap {gap}, force {force}");
    }
    assert_eq!(forces[0], 0.0);
    assert!(*forces.last().unwrap() > 0.0, "{forces:?}");
    assert!(forces.is_sorted(), "{forces:?}");
    let pressed = run.json("out/summary.json")["planes"][0]["force"][0].as_f64();
    assert_eq!(pressed, forces.last().map(|force| -force));

    let rows = run.read("out/contact.csv");
    let header = "step,plane,pressure_MPa,force_x_N,force_y_N,force_z_N,friction_x_N,friction_y_N,\
         friction_z_N,centre_x_mm,centre_y_mm,centre_z_mm,area_mm2,bearing_area_mm2,smallest_gap_mm";
    assert_eq!(rows.lines().next(), Some(header));
    for (pressed, force) in run.column("out/contact.csv", "force_x_N").iter().zip(&forces) {
        assert_eq!(*pressed, -force);
    }
    let summary = run.json("out/summary.json");
    let centre = &summary["planes"][0]["centre"];
    // The plane lies half the thickness beyond the leftmost point, and its distance; midpoints of edges may stand out.
    let lies_at = plane - 0.8;
    assert!((centre[0].as_f64().unwrap() - lies_at).abs() < 0.1, "{centre} {lies_at}");
    assert!(summary["planes"][0]["area"].as_f64() >= summary["planes"][0]["bearing_area"].as_f64());

    let free = simulated(&scene(), "native");
    assert!(!free.path("out/contact.csv").exists());
    assert!(free.json("out/summary.json").get("planes").is_none());
    let reach = |run: &Workshop| leftmost(&vertices(run, "out/path_004.vtu"));
    assert!(reach(&free) < plane, "without the plane the part would pass it");
}

/// A strip between two planes is pressed on the lower one by its load.
#[test]
fn a_patch_lies_on_its_plane() {
    let workshop = Workshop::new();
    workshop.write("scene.toml", format!("{STRIP}{PLATE}"));
    let out = workshop.succeed(&["simulate", "scene.toml", "--out", "out"]);
    assert!(out.starts_with("reached at load share 1.0000"), "{out}");
    let summary = workshop.json("out/summary.json");
    let vector = |plane: usize, key: &str| -> Vec<f64> {
        let numbers = summary["planes"][plane][key].as_array().unwrap();
        numbers.iter().map(|number| number.as_f64().unwrap()).collect()
    };
    // A strip of 20 x 4 mm under 0.001 MPa: the middle lies on the plane and leaves a part of the load to the clamps.
    let force = vector(0, "force");
    assert!(force[0] == 0.0 && force[1] == 0.0, "{force:?}");
    assert!((-0.08..-0.02).contains(&force[2]), "{force:?}");
    assert_eq!(vector(1, "force"), [0.0; 3]);
    assert_eq!(summary["planes"][1]["centre"], serde_json::Value::Null);
    assert!((vector(0, "centre")[0] - 10.0).abs() < 0.1);
    let gaps = workshop.column("out/contact.csv", "smallest_gap_mm");
    assert!(gaps.iter().all(|gap| *gap > 0.0));
}

const PLATE: &str = r#"
[[edge]]
side = "s1"
clamped = true

[wall]
thickness = 0.5

[[force]]
per_area = [0, 0, -0.001]

[[plane]]
normal = [0, 0, 1]
distance = 0.1
friction = 0.5

[[plane]]
normal = [0, 0, -1]
distance = 0.1

[load.path]
steps = 4
"#;

/// Newton stops at 1e-12 of the force scale, so that 1e-8 of the displacement has a margin.
#[cfg(feature = "petsc")]
#[test]
fn petsc_and_native_walk_through_the_same_tips() {
    for scene in [scene(), scene() + PLANE] {
        let [native, petsc] = ["native", "petsc"].map(|solver| simulated(&scene, solver));
        assert_eq!(petsc.json("out/summary.json")["solver"], "petsc");
        let mut columns = vec!["tip_x_mm", "tip_y_mm", "tip_z_mm"];
        columns.extend(scene.contains("[[plane]]").then_some("plane_0_force_N"));
        for column in columns {
            let [a, b] = [&native, &petsc].map(|run| run.column("out/path.csv", column));
            // Rest, four samples, and perhaps halved steps where the plane is met: the same for both.
            assert!(a.len() >= 5 && a.len() == b.len(), "{} and {} rows", a.len(), b.len());
            for (step, (a, b)) in a.iter().zip(&b).enumerate() {
                assert!((a - b).abs() <= 1e-8 * a.abs(), "{column} at step {step}: {a} and {b}");
            }
        }
    }
}

#[test]
fn printed_defaults_are_a_scene() {
    let workshop = Workshop::new();
    let defaults = workshop.succeed(&["simulate", "--print-defaults"]);
    let uncommented = |first: &str| {
        let lines = defaults.lines().skip_while(|line| *line != format!("# {first}"));
        let block: Vec<&str> = lines.map_while(|line| line.strip_prefix("# ")).collect();
        assert!(block.len() > 2, "{first} in {defaults}");
        block.join("\n") + "\n"
    };
    // The commented plane and watch belong to it; the commented patch is a scene by itself.
    let scene = defaults.clone() + &uncommented("[[plane]]") + &uncommented("[[watch]]");
    let coarse = scene.replace("edge = 3.0", "edge = 5.0").replace("steps = 10", "steps = 1");
    assert_ne!(coarse, scene);
    workshop.write("scene.toml", coarse);
    workshop.succeed(&["simulate", "scene.toml", "--out", "out"]);
    let patch = uncommented("[part.patch]");
    workshop.write("patch.toml", patch.clone() + &uncommented("[self_contact]"));
    workshop.succeed(&["simulate", "patch.toml", "--out", "patch"]);
    let rows = workshop.read("patch/path.csv");
    assert!(rows.lines().next().is_some_and(|names| names.contains("wall_gap_mm")), "{rows}");
}
