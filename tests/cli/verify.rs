//! `verify shells`: its table, its files, and what it answers to wrong names; its cases as scenes of `simulate`.

use std::fs;

use super::workshop::Workshop;

#[test]
fn a_case_leaves_a_table_and_figures() {
    let workshop = Workshop::new();
    let out =
        workshop.succeed(&["verify", "shells", "--quick", "--case", "tube_thick", "--out", "out"]);
    let lines: Vec<&str> = out.lines().collect();
    assert!(lines[0].starts_with("case ") && lines[0].ends_with(" verdict"), "{out}");
    // One mesh of each element, and the sum.
    assert_eq!(lines.len(), 4, "{out}");
    for (line, element) in lines[1..3].iter().zip([" loop ", " mid-edge "]) {
        assert!(line.starts_with("tube_thick ") && line.contains(element), "{line}");
        assert!(line.ends_with(" ok") && line.len() <= 120, "{line}");
    }
    assert_eq!(lines[3], "2 within what is accepted, 0 known to miss it, 0 too far");

    let measured = workshop.column("out/errors.csv", "measured");
    let errors = workshop.column("out/errors.csv", "error");
    assert_eq!((measured.len(), errors.len()), (2, 2));
    let references = workshop.column("out/errors.csv", "reference");
    for ((measured, error), reference) in measured.iter().zip(&errors).zip(&references) {
        // %; of the largest reference, which is not smaller than that at this load.
        let own = 100.0 * (measured / reference - 1.0).abs();
        assert!(*error > 0.0 && *error < 5.0 && *error <= own + 1e-9, "{error} {own}");
    }
    let pointwise = workshop.column("out/errors.csv", "pointwise_error");
    // Of a smaller reference or the same, at its worst load.
    assert!(pointwise.iter().zip(&errors).all(|(point, error)| *point >= error - 1e-9));
    assert!(lines[0].contains(" err% point% "), "{out}");
    assert!(workshop.column("out/errors.csv", "unknowns").iter().all(|n| *n > 100.0));
    for figure in ["tube_thick", "summary"] {
        assert!(workshop.read(&format!("out/{figure}.svg")).starts_with("<svg"));
        let png = fs::read(workshop.path(&format!("out/{figure}.png"))).unwrap();
        assert!(png.starts_with(b"\x89PNG\r\n\x1a\n") && png.len() > 1000);
    }
    // Five files and no more.
    assert_eq!(fs::read_dir(workshop.path("out")).unwrap().count(), 5);
}

/// One element alone, on the coarse mesh of an embedded network: what only a closed part has is watched.
#[test]
fn a_network_is_a_case_too() {
    let workshop = Workshop::new();
    let arguments = [
        "verify",
        "shells",
        "--quick",
        "--case",
        "basic_bend",
        "--element",
        "loop",
        "--out",
        "out",
    ];
    let out = workshop.succeed(&arguments);
    assert!(out.contains("3.0 mm") && out.contains("1 within what is accepted"), "{out}");
    let growth = workshop.column("out/errors.csv", "measured");
    // Tip, mm, and volume growth, mm^3, the worse one first.
    assert!(growth.iter().any(|v| (5.0..15.0).contains(v)), "{growth:?}");
    assert!(growth.iter().any(|v| (900.0..1100.0).contains(v)), "{growth:?}");
}

#[test]
fn every_case_is_listed() {
    for what in ["shells", "curves", "stability"] {
        let out = Workshop::new().succeed(&["verify", what, "--list"]);
        let folder = format!("{}/verify/{what}", env!("CARGO_MANIFEST_DIR"));
        let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        for file in entries.filter(|path| path.is_file()) {
            let name = file.file_stem().unwrap().to_str().unwrap();
            let is_name = |line: &str| line.split(' ').next() == Some(name);
            assert!(out.lines().any(is_name), "{name} in {out}");
        }
    }
}

/// Curves through limit points and back, and a load without a potential, on flat triangles: seconds each.
#[test]
fn whole_curves_are_traced() {
    let workshop = Workshop::new();
    let cases = ["von_mises_truss", "hinged_roof_thin", "follower_tip_force"];
    let mut arguments = vec!["verify", "curves", "--quick", "--element", "mid-edge"];
    cases.iter().for_each(|case| arguments.extend(["--case", case]));
    let out = workshop.succeed(&arguments);
    assert!(out.contains("3 within what is accepted, 0 known to miss it, 0 too far"), "{out}");
}

/// A plate and the same a thousandth of its size, on every solver: a table of one line for each run, and a file of them.
#[test]
fn hard_cases_leave_a_table() {
    let workshop = Workshop::new();
    let arguments = ["verify", "stability", "--case", "plate_in_mm", "--case", "plate_in_um"];
    let out = workshop.succeed(&[&arguments[..], &["--out", "out"]].concat());
    let lines: Vec<&str> = out.lines().collect();
    assert!(lines[0].starts_with("case ") && lines[0].ends_with(" verdict"), "{out}");
    let runs = lines.len() - 2;
    assert!(lines[1..=runs].iter().all(|line| line.ends_with(" ok") && line.contains(" reached ")));
    assert_eq!(lines[runs + 1], format!("{runs} of {runs} runs as expected"));
    let iterations = workshop.column("out/stability.csv", "newton_iterations");
    // Both sizes on one solver, or on two; the last bit of a processor may make one iteration more.
    assert!(iterations.len() == runs && (runs == 2 || runs == 4), "{out}");
    assert!(iterations.iter().all(|n| *n > 5.0), "{iterations:?}");
    // The second size is compared with the first: the same states to the 1e-6 that the case allows.
    let table = workshop.read("out/stability.csv");
    let place = table.lines().next().unwrap().split(',').position(|name| name == "disagreement");
    let of_small = table.lines().filter(|line| line.starts_with("plate_in_um"));
    let differences: Vec<f64> = of_small
        .map(|line| line.split(',').nth(place.unwrap()).unwrap().parse().unwrap())
        .collect();
    assert!(differences.len() == runs / 2 && differences.iter().all(|d| *d < 1e-6), "{table}");
    assert!(workshop.column("out/stability.csv", "load_share").iter().all(|load| *load == 1.0));

    let near = ["there is no case `plate_in_inches`; the nearest is `plate_in_"];
    workshop.refuse(&["verify", "stability", "--case", "plate_in_inches"], 1, &near);
}

#[test]
fn wrong_names_and_taken_folders_are_refused() {
    let workshop = Workshop::new();
    fs::create_dir(workshop.path("taken")).unwrap();
    workshop.write("taken/thesis.txt", "years of work");
    let near = ["there is no case `scordelis`; the nearest is `scordelis_lo`"];
    workshop.refuse(&["verify", "shells", "--case", "scordelis", "--out", "out"], 1, &near);
    let case = ["verify", "shells", "--case", "scordelis_lo", "--out", "taken"];
    workshop.refuse(&case, 1, &["output folder", "taken", "exists; choose another"]);
    workshop.refuse(&["verify", "shell"], 2, &["'shell'", "'shells'"]);
    workshop.refuse(&["verify", "shells", "--element", "loops"], 2, &["'loops'", "loop, mid-edge"]);
    let nothing = workshop.run(&["verify"]);
    assert_eq!(nothing.code, 2);
    assert!(nothing.err.contains("shells"), "{nothing:?}");
}

/// A case is a scene: `simulate` ends where the reference does.
#[test]
fn a_case_simulates() {
    let workshop = Workshop::new();
    workshop.write("scene.toml", include_str!("../../verify/shells/cantilever_shear.toml"));
    let out = workshop.succeed(&["simulate", "scene.toml", "--out", "out"]);
    assert!(out.starts_with("reached at load share 1.0000"), "{out}");
    let summary = workshop.json("out/summary.json");
    let watches = summary["watches"].as_array().unwrap();
    for (watch, reference) in watches.iter().zip([3.286, 6.698]) {
        // The mesh of the file, 16 cells: within 3 %.
        let value = watch["value"].as_f64().unwrap();
        assert!((value / reference - 1.0).abs() < 0.03, "{watch}");
    }
    assert_eq!(watches.len(), 2);
}

/// The plate that users copy, against a clamped square plate of the linear theory.
#[test]
fn the_plate_of_the_examples_sags() {
    let workshop = Workshop::new();
    workshop.write("plate.toml", include_str!("../../examples/scenes/plate.toml"));
    workshop.succeed(&["simulate", "plate.toml", "--out", "out"]);
    let sag = workshop.json("out/summary.json")["watches"][0]["value"].as_f64().unwrap();
    let stiffness = 10.0 * 1.6_f64.powi(3) / (12.0 * (1.0 - 0.25));
    // Timoshenko & Woinowsky-Krieger (1959), Table 35 at Poisson's ratio 0.3; with clamped sides it does not matter.
    let linear = 0.001_26 * 0.0005 * 40.0_f64.powi(4) / stiffness;
    // The load makes it sag by a fifth of its thickness: stretching takes off some 2 % there.
    assert!((sag / linear - 1.0).abs() < 0.03, "{sag} {linear}");
}

/// What a scene watches is followed for an actuator too.
#[test]
fn an_actuator_is_watched() {
    let workshop = Workshop::new();
    let watches = "
[[watch]]
name = \"x\"
measure = \"tip\"
direction = [1, 0, 0]
[[watch]]
name = \"angle\"
measure = \"chord-angle\"
[[watch]]
name = \"dV\"
measure = \"volume-growth\"
";
    let scene = "[part]\nnetwork = \"network.toml\"\n[mesh]\nedge = 5.0\n[material]\nlaw = \"neo-hookean\"\nmu = 1.0\n[load]\npressure = 0.002\n[load.path]\nsteps = 1\n";
    workshop.write("scene.toml", format!("{scene}{watches}"));
    workshop.succeed(&["simulate", "scene.toml", "--out", "out"]);
    let last = |column: &str| *workshop.column("out/path.csv", column).last().unwrap();
    let volume = workshop.column("out/path.csv", "volume_mm3");
    let growth = volume[volume.len() - 1] - volume[0];
    let values = workshop.column("out/watches.csv", "value");
    let steps = volume.len();
    let ends: Vec<f64> = values.chunks(steps).map(|watch| watch[steps - 1]).collect();
    // The same sums in another order.
    for (value, exact) in ends.iter().zip([last("tip_x_mm"), last("angle_deg"), growth]) {
        assert!((value - exact).abs() < 1e-9 * exact.abs(), "{value} {exact}");
    }
    assert_eq!(ends.len(), 3);
    let wrong = format!("{scene}[[watch]]\nname = \"w\"\nat = [0, 0]\ndirection = [1, 0, 0]\n");
    fs::remove_dir_all(workshop.path("out")).unwrap();
    workshop.refuse_scene(&wrong, &["[[watch]] w: `at` wants a [part.patch]"]);
}
