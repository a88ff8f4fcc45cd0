//! Scenes at the edges of the numbers: units, rounding, and what nothing holds.

use crate::workshop::Workshop;

/// A small capsule of a neo-Hookean rubber, whose load stands in `load`.
fn capsule(young_modulus: f64, load: &str) -> String {
    format!(
        "[part.ellipsoid]\nsemi_axes = [12, 6, 20]\n[mesh]\nedge = 6.0\n[wall]\nthickness = 1.0\n\
         [material]\nlaw = \"neo-hookean\"\nyoung_modulus = {young_modulus:?}\npoisson_ratio = 0.5\n\
         [solver]\nbackend = \"native\"\n[load]\n{load}\n[load.path]\nsteps = 4\n\
         [[watch]]\nname = \"growth\"\nmeasure = \"volume-growth\"\n"
    )
}

/// The last growth (mm^3) and stored energy (mJ) of a scene that must reach its load.
fn reached(scene: &str) -> [f64; 2] {
    let workshop = Workshop::new();
    workshop.write("scene.toml", scene);
    workshop.succeed(&["simulate", "scene.toml", "--out", "out"]);
    let summary = workshop.json("out/summary.json");
    assert_eq!(summary["ending"], "reached", "{scene}{summary}");
    let energies = workshop.column("out/path.csv", "stored_energy_mJ");
    assert!(energies.iter().all(|energy| *energy >= 0.0), "{energies:?}");
    [&summary["watches"][0]["value"], &summary["stored_energy"]].map(|v| v.as_f64().unwrap())
}

/// Modulus and pressure in one proportion over 19 orders of magnitude, as far as files go: one shape, and an energy in proportion.
#[test]
fn answers_do_not_depend_on_the_unit_of_pressure() {
    let answer =
        |modulus: f64| reached(&capsule(modulus, &format!("pressure = {:e}", 0.01 * modulus)));
    let [growth, energy] = answer(1.0);
    for modulus in [1e-7, 1e-3, 1e6, 1e12] {
        let [other, stored] = answer(modulus);
        // States solved to 1e-9 of the wall's forces.
        assert!((other / growth - 1.0).abs() < 1e-8, "{modulus:e}: {other} {growth}");
        assert!((stored / modulus / energy - 1.0).abs() < 1e-8, "{modulus:e}: {stored} {energy}");
    }
}

/// A wall that hardly moves stores half the pressure times the growth, though its strains are below what an energy resolves.
#[test]
fn stiff_walls_store_what_the_load_works() {
    let [soft_growth, soft] = reached(&capsule(1e5, "pressure = 0.01"));
    // Linear theory, to strains of some 1e-5 with which a capsule stiffens.
    assert!((soft / (0.5 * 0.01 * soft_growth) - 1.0).abs() < 5e-4, "{soft} {soft_growth}");
    for modulus in [1e9, 1e12] {
        let [_, stored] = reached(&capsule(modulus, "pressure = 0.01"));
        assert!(
            (stored * modulus / (soft * 1e5) - 1.0).abs() < 5e-4,
            "{modulus:e}: {stored} {soft}"
        );
    }
}

/// Programmes that end within rounding of where they start end there.
#[test]
fn drives_within_rounding_of_rest_end() {
    for load in [
        "volume_ratio = 1.0000000000000002",
        "volume_ratio = 0.9999999999999999",
        "volume_ratio = 1.00000000000001",
        "volume_ratio = 1.0000000001",
        "gas = { amount = 1.0000000000000002 }",
        "gas = { amount = 0.999999999999 }",
    ] {
        let [growth, _] = reached(&capsule(1.0, load));
        // Of some 6000 mm^3.
        assert!(growth.abs() < 1e-5, "{load}: {growth}");
    }
}

/// A flat membrane stiffens and does not snap; a ring that only lies on a plane is refused on every mesh.
#[test]
fn flat_membranes_and_parts_that_nothing_holds_have_one_verdict() {
    let workshop = Workshop::new();
    let cases = ["--case", "flat_membrane", "--case", "half_ring_on_plane"];
    let solver = ["verify", "stability", "--solver", "native"];
    let out = workshop.succeed(&[&solver[..], &cases].concat());
    assert!(out.contains("6 of 6 runs as expected"), "{out}");
}
