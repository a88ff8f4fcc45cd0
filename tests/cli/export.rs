//! `export`: files for a printer, and what is said of them.

use super::workshop::Workshop;

/// A workshop with the folder `run` of a search that found the published seed, by hand.
fn with_run() -> Workshop {
    let workshop = Workshop::new();
    std::fs::create_dir_all(workshop.path("run/front/g001-002")).unwrap();
    workshop.write("run/front/g001-002/genome.toml", workshop.read("network.toml"));
    workshop.write("run/run.toml", "[mesh]\nedge = 4.0\n");
    workshop
}

/// The volume that the triangles of a binary STL enclose, mm^3, from the file's bytes alone.
fn enclosed(stl: &[u8]) -> f64 {
    let number = |bytes: &[u8]| f64::from(f32::from_le_bytes(bytes.try_into().unwrap()));
    let below = |triangle: &[u8]| {
        let x: Vec<f64> = triangle[12..48].chunks_exact(4).map(number).collect();
        let cross =
            [x[4] * x[8] - x[5] * x[7], x[5] * x[6] - x[3] * x[8], x[3] * x[7] - x[4] * x[6]];
        (x[0] * cross[0] + x[1] * cross[1] + x[2] * cross[2]) / 6.0
    };
    stl[84..].chunks_exact(50).map(below).sum()
}

/// The least and the greatest x of the triangles of a binary STL, mm.
fn xs(stl: &[u8]) -> [f64; 2] {
    let x = |bytes: &[u8]| f64::from(f32::from_le_bytes(bytes[..4].try_into().unwrap()));
    let all = stl[84..].chunks_exact(50).flat_map(|t| [12, 24, 36].map(|k| x(&t[k..])));
    all.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| [a.min(x), b.max(x)])
}

#[test]
fn a_design_is_exported_with_each_inlet() {
    let workshop = with_run();
    let export = |inlet: &str| {
        let arguments = ["export", "run", "g001-002", "--out", inlet, "--inlet", inlet];
        let words = workshop.succeed(&[&arguments[..], &["--edge", "2"]].concat());
        assert!(words.contains("g001-002 in ninjaflex-c2s") && words.contains("best"), "{words}");
        let report = workshop.json(&format!("{inlet}/printability.json"));
        let stl = std::fs::read(workshop.path(inlet).join("part.stl")).unwrap();
        assert_eq!(stl.len() as u64, 84 + 50 * report["triangles"].as_u64().unwrap());
        let volume = report["volume_mm3"].as_f64().unwrap();
        // Coordinates of 60 mm in 32 bits.
        assert!((enclosed(&stl) / volume - 1.0).abs() < 1e-5, "{volume}");
        assert_eq!(report["airtight"], true);
        assert_eq!(report["chamber_reached"], inlet != "none");
        (volume, report)
    };
    let height = |report: &serde_json::Value| report["size_mm"][2].as_f64().unwrap();
    let (whole, report) = export("none");
    let plain = height(&report);
    let warnings = report["warnings"].as_array().unwrap();
    assert!(warnings.iter().any(|w| w.as_str().unwrap().contains("no inlet")), "{warnings:?}");
    // A bore of 3 mm through 1.6 mm, in a base that ripples by hundredths of a millimetre.
    let bore = 1.5 * 1.5 * std::f64::consts::PI * 1.6;
    assert!(((whole - export("hole").0) / bore - 1.0).abs() < 0.05, "{whole}");
    let (barbed, report) = export("barb");
    assert!(barbed > whole);
    let longer = height(&report) - plain;
    // The barb begins at the lowest point of the part; sums of tenths.
    assert!((longer - 8.0).abs() < 1e-9, "{longer}");

    let again = ["export", "run", "g001-002", "--out", "again", "--inlet", "barb", "--edge", "2"];
    let printed = workshop.succeed(&[&again[..], &["--json"]].concat());
    assert_eq!(serde_json::from_str::<serde_json::Value>(&printed).unwrap(), report);
    let file = |name: &str| std::fs::read(workshop.path(name)).unwrap();
    assert!(file("barb/part.3mf") == file("again/part.3mf"), "a 3MF has other bytes");
    assert!(file("barb/part.stl") == file("again/part.stl"), "an STL has other bytes");
}

/// A part from x = -11 to 11 mm whose wall below 0 is of a second material: its bodies fill it, and the report says which file is of which.
#[test]
fn a_part_of_two_materials_has_a_body_for_each() {
    let workshop = Workshop::new();
    let wall = "[wall]\nmaterial = \"side\"\n[[node]]\nname = \"side\"\nlinks = { x = -1.0 }\n";
    let network = workshop.read("network.toml") + wall;
    workshop.write("network.toml", format!("output = \"chamber\"\n{network}"));
    let pattern = "[pattern]\nmaterial = { law = \"neo-hookean\", mu = 10.0 }\n";
    workshop.write("run.toml", format!("[mesh]\nedge = 4.0\n{pattern}"));
    let export = ["export", "network.toml", "--run", "run.toml", "--out", "out", "--edge", "2"];
    let words = workshop.succeed(&export);
    assert!(words.contains("of neo-hookean: part_2.stl"), "{words}");
    let report = workshop.json("out/printability.json");
    assert_eq!(report["material"], "ninjaflex-c2s and neo-hookean");
    let volume = |file: &str| enclosed(&std::fs::read(workshop.path("out").join(file)).unwrap());
    let bodies = report["bodies"].as_array().unwrap();
    for body in bodies {
        let said = body["volume_mm3"].as_f64().unwrap();
        // Coordinates of 60 mm in 32 bits.
        assert!((volume(body["file"].as_str().unwrap()) / said - 1.0).abs() < 1e-5, "{body}");
    }
    let (whole, halves) = (volume("part.stl"), [volume("part_1.stl"), volume("part_2.stl")]);
    assert!(((halves[0] + halves[1]) / whole - 1.0).abs() < 1e-5, "{halves:?} {whole}");
    // A triangle of the shell, of 4 mm, is of one material, and a cell of 2 mm takes that of the nearest.
    let [soft, stiff] =
        [1, 2].map(|k| xs(&std::fs::read(workshop.path(&format!("out/part_{k}.stl"))).unwrap()));
    assert!(soft[0] > -4.0 && stiff[1] < 4.0, "{soft:?} {stiff:?}");
    assert!(soft[1] > 4.0 && stiff[0] < -4.0, "{soft:?} {stiff:?}");
}

#[test]
fn what_cannot_be_exported_is_refused_in_one_line() {
    let workshop = with_run();
    workshop.write("run.toml", "[mesh]\nedge = 4.0\n");
    let network = ["export", "network.toml", "--run", "run.toml", "--out", "out", "--edge", "2"];
    let wide = [&network[..], &["--inlet-diameter", "19"]].concat();
    workshop.refuse(&wide, 1, &["network: Printing: base_too_small", "the inlet wants 10.0 mm"]);
    let thin = [&network[..], &["--inlet", "barb", "--tube", "4"]].concat();
    workshop.refuse(&thin, 1, &["--tube is 4.0", "at least 4.6 mm"]);
    for (flag, value, words) in [
        ("--inlet-diameter", "-3", "--inlet-diameter is -3.0"),
        ("--edge", "0", "--edge is 0.0"),
        ("--voxel", "1", "--voxel, which is to find leaks of the wall, is 1.0"),
        ("--density", "nan", "--density is NaN"),
    ] {
        let network = ["export", "network.toml", "--run", "run.toml", "--out", "out"];
        workshop.refuse(&[&network[..], &[flag, value]].concat(), 1, &[words]);
    }
    for (arguments, code, words) in [
        (&["run", "g001-003"][..], 1, "run has no design g001-003 on its front"),
        (&["run", "../run"], 1, "`../run` does not name an individual"),
        (&["run"], 2, "<ID>"),
        (&["run", "g001-002", "--run", "run.toml"], 2, "cannot be used with"),
        (&["run", "g001-002", "--inlet", "pipe"], 2, "none, hole, barb"),
        (&["nowhere", "g001-002"], 1, "there is no folder nowhere"),
    ] {
        let all = [&["export"], arguments, &["--out", "out"]].concat();
        workshop.refuse(&all, code, &[words]);
    }
    std::fs::create_dir(workshop.path("taken")).unwrap();
    workshop.refuse(&["export", "run", "g001-002", "--out", "taken"], 1, &["taken exists"]);
}
