//! A law of one's own rubber, and the materials that are known by name.

use super::workshop::Workshop;

const TRELOAR: &str = include_str!("../../data/materials/treloar-1944.csv");

/// What is written is what the program reads: the law of Treloar's rubber inflates a sphere.
#[test]
fn a_fitted_law_is_ready_to_use() {
    let workshop = Workshop::new();
    workshop.write("rubber.csv", TRELOAR);
    let words = workshop.succeed(&["material", "fit", "rubber.csv", "--out", "rubber"]);
    for word in [
        "24 uniaxial points",
        "16 equibiaxial points",
        "13 planar points",
        "stretches from 1.000 to 7.600",
        "neo-hookean",
        "mooney-rivlin",
        "yeoh",
        "ogden (3 terms)",
        "[material]",
    ] {
        assert!(words.contains(word), "{word}: {words}");
    }
    for file in ["fit.svg", "fit.png", "fit.pdf"] {
        assert!(workshop.path("rubber").join(file).is_file(), "{file}");
    }
    let laws = workshop.json("rubber/laws.json");
    assert_eq!(laws["points"], 53);
    let best = laws["best"].as_str().unwrap();
    let found = laws["laws"].as_array().unwrap().iter().find(|law| law["form"] == best).unwrap();
    assert!(found["relative"].as_f64().unwrap() < 0.05, "{found}");
    let material = workshop.read("rubber/material.toml");
    assert!(material.starts_with("# ogden") && material.contains("rubber.csv"), "{material}");
    let scene = "[part.sphere]\nradius = 10\nsubdivisions = 1\n[wall]\nthickness = 0.1\n[load]\npressure = 0.001\n[load.path]\nsteps = 1\n";
    workshop.write("scene.toml", format!("{scene}{material}"));
    workshop.succeed(&["simulate", "scene.toml", "--out", "sphere"]);

    // Another time to another folder, and for a program the same as the file.
    workshop.refuse(&["material", "fit", "rubber.csv", "--out", "rubber"], 1, &["rubber exists"]);
    let json = workshop.succeed(&["material", "fit", "rubber.csv", "--out", "again", "--json"]);
    assert_eq!(serde_json::from_str::<serde_json::Value>(&json).unwrap(), laws);
}

#[test]
fn several_files_are_one_rubber() {
    let workshop = Workshop::new();
    workshop.write("a.csv", "strain_percent,cauchy_kpa\n20,105.6\n50,297.5\n100,700\n150,1140\n");
    workshop.write("b.csv", "test,stretch,nominal_mpa\nplanar,1.2,0.1243\nplanar,1.5,0.2407\n");
    let fit = ["material", "fit", "a.csv", "b.csv", "--test", "uniaxial", "--up-to", "2.2"];
    let words = workshop.succeed(&[&fit[..], &["--out", "out"]].concat());
    assert!(words.contains("3 uniaxial points, 2 planar points"), "{words}");
    assert!(words.contains("points are too few for 6 numbers"), "{words}");
}

#[test]
fn wrong_tables_are_refused() {
    let workshop = Workshop::new();
    for (table, words) in [
        ("test,load,stretch\n", "data.csv:1: the column `load` is none of `test`"),
        ("stretch,nominal_mpa\n1.2,0.1\n", "data.csv:1: there is no column `test`"),
        ("test,stretch,nominal_mpa\nuniaxial,1.2,nan\n", "data.csv:2: nominal_mpa is `nan`"),
        ("test,stretch,nominal_mpa\nuniaxial,-1,0\n", "data.csv:2: stretch is -1.0"),
        ("test,stretch,nominal_mpa\nuniaxial,1.2,-0.1\n", "data.csv:2: a stretch of 1.2 with"),
        ("test,stretch,nominal_mpa\nuniaxial,1.2,0.1\n", "data.csv: 1 points; even a law of one"),
        ("test,stretch,nominal_mpa\nplanar,1,0\nplanar,1,0\nplanar,1,0\n", "nothing is stretched"),
        ("", "data.csv"),
    ] {
        workshop.write("data.csv", table);
        workshop.refuse(&["material", "fit", "data.csv", "--out", "out"], 1, &[words]);
    }
    workshop.refuse(&["material", "fit", "none.csv", "--out", "out"], 1, &["none.csv: no such"]);
    let fit = ["material", "fit", "data.csv", "--out", "out"];
    for (arguments, words) in
        [(["--test", "shear"], "`shear` is no kind of test"), (["--up-to", "0.5"], "above 1")]
    {
        workshop.refuse(&[&fit[..], &arguments].concat(), 2, &[words]);
    }
}

/// Each name in the list is one that a scene takes, with a source.
#[test]
fn presets_are_listed() {
    let workshop = Workshop::new();
    let words = workshop.succeed(&["material", "presets"]);
    let json = workshop.succeed(&["material", "presets", "--json"]);
    let records: serde_json::Value = serde_json::from_str(&json).unwrap();
    let unknown = "[part]\nnetwork = \"network.toml\"\n[material]\npreset = \"steel\"\n";
    for record in records.as_array().unwrap() {
        let name = record["name"].as_str().unwrap();
        workshop.refuse_scene(unknown, &[name]);
        assert!(words.contains(name), "{name}");
        assert!(record["source"].as_str().is_some_and(|source| !source.is_empty()), "{record}");
        assert!(record["shear_modulus_mpa"].as_f64().is_some_and(|mu| mu > 0.0), "{record}");
    }
}
