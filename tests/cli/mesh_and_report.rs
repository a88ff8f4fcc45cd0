//! `mesh` and `report` where all is well, and the printed defaults of `evolve`.

use super::workshop::Workshop;

#[test]
fn mesh_writes_surface_picture_and_quality() {
    let workshop = Workshop::new();
    let words = workshop.succeed(&["mesh", "network.toml", "--out", "out", "--edge", "4"]);
    assert!(words.contains("genus 0") && words.contains("results in out"), "{words}");
    assert!(workshop.path("out/surface.vtu").is_file());
    let quality = workshop.json("out/quality.json");
    let triangles = quality["triangles"].as_u64().unwrap();
    // Binary STL: 84 bytes, and 50 for each triangle.
    assert_eq!(workshop.path("out/surface.stl").metadata().unwrap().len(), 84 + 50 * triangles);
    let mean = quality["edge_mean"].as_f64().unwrap();
    assert!((3.0..5.0).contains(&mean), "{mean}");

    let printed =
        workshop.succeed(&["mesh", "network.toml", "--out", "again", "--edge", "4", "--json"]);
    assert_eq!(serde_json::from_str::<serde_json::Value>(&printed).unwrap(), quality);
}

#[test]
fn report_draws_again_what_the_run_wrote() {
    let workshop = Workshop::new();
    workshop.write(
        "run.toml",
        "[evolution]\npopulation = 4\ngenerations = 1\n[mesh]\nedge = 5.0\n[load.path]\nsteps = 1\n",
    );
    workshop.succeed(&["evolve", "run.toml", "--out", "out"]);
    let written = workshop.files();
    for name in [
        "front.svg",
        "front.png",
        "history.svg",
        "history.png",
        "front.csv",
        "history.csv",
        "outcomes.png",
        "outcomes.csv",
    ] {
        std::fs::remove_file(workshop.path("out").join(name)).unwrap();
    }
    let out = workshop.succeed(&["report", "out"]);
    assert!(out.contains("out/front.svg"), "{out}");
    assert!(workshop.files() == written, "report does not draw what evolve drew");
}

/// `evolve` reads its run file before it looks at the folder: the refusal of the folder is the proof.
#[test]
fn printed_defaults_are_a_run_file() {
    let workshop = Workshop::new();
    let defaults = workshop.succeed(&["evolve", "--print-defaults"]);
    for key in ["population = ", "[genes]", "w11 = ", "[load.path.newton]"] {
        assert!(defaults.contains(key), "{key}");
    }
    workshop.write("run.toml", defaults);
    std::fs::create_dir(workshop.path("taken")).unwrap();
    workshop.refuse(
        &["evolve", "run.toml", "--out", "taken"],
        1,
        &["output folder taken exists", "--resume"],
    );
}
