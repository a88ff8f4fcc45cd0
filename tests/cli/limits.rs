//! What is said of a material's limits, and of the paths that they end.

use super::workshop::Workshop;

/// A balloon of neo-Hookean rubber, t/R = 0.01; its pressure is never more than 0.0248 MPa, at a stretch of 1.38.
const BALLOON: &str = r#"
[part.sphere]
radius = 10.0
subdivisions = 2

[wall]
thickness = 0.1

[material]
law = "neo-hookean"
mu = 1.0

[solver]
backend = "native"

"#;

/// The pressure of a membrane at the stretch `l`.
fn pressure(l: f64) -> f64 {
    0.02 * (1.0 / l - l.powi(-7))
}

#[test]
fn a_scene_ends_at_its_limit_and_says_where() {
    let workshop = Workshop::new();
    let end = |name: &str, rest: &str| {
        workshop.write("scene.toml", format!("{BALLOON}{rest}"));
        let out = workshop.succeed(&["simulate", "scene.toml", "--out", name]);
        (out, workshop.json(&format!("{name}/summary.json")))
    };
    let (out, summary) = end("stretch", "[limits]\nstretch = 1.2\n[load]\npressure = 0.02\n");
    assert_eq!(summary["ending"], "limit_reached");
    let limit = &summary["limit"];
    assert_eq!((&limit["quantity"], &limit["face"]), (&"stretch".into(), &"inner".into()));
    let share = limit["share"].as_f64().unwrap();
    assert!((1.0 - 1e-4..=1.0).contains(&share), "{limit}");
    let place: Vec<f64> =
        limit["at_rest"].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
    let radius = place.iter().map(|x| x * x).sum::<f64>().sqrt();
    assert!((radius - 10.0).abs() < 0.5, "{limit}");
    // The inner face is stretched by t/R more, and the mesh scatters by 0.3 %, of 20 %.
    let found = summary["pressure"].as_f64().unwrap();
    assert!((found / pressure(1.2) - 1.0).abs() < 0.04, "{found}");
    assert!(out.contains("limit reached near (") && out.contains("a stretch of 1.20"), "{out}");
    assert!(out.contains("of the 1.2 allowed, at the inner face"), "{out}");
    let rows = workshop.column("stretch/path.csv", "pressure_MPa");
    assert_eq!(rows.last(), Some(&found));

    // P = mu (l - l^-5) at the same stretch.
    let stress = 1.2 - 1.2_f64.powi(-5);
    let (out, summary) = end(
        "stress",
        &format!("[limits]\nnominal_stress = {stress:?}\n[load]\nvolume_ratio = 3.0\n"),
    );
    assert_eq!(summary["limit"]["quantity"], "nominal_stress");
    let same = summary["pressure"].as_f64().unwrap();
    assert!((same / found - 1.0).abs() < 0.01, "{same} {found}");
    assert!(out.contains("a nominal stress of 0.79") && out.contains("MPa allowed"), "{out}");

    // Nothing comes to it; what is used of it is told all the same.
    let (out, summary) = end("never", "[limits]\nstretch = 1.3\n[load]\npressure = 0.005\n");
    assert_eq!(summary["ending"], "reached");
    assert!(summary["limit"]["share"].as_f64().unwrap() < 0.5, "{summary}");
    assert!(out.starts_with("reached (a stretch of 1."), "{out}");

    // Behind the maximum of the pressure.
    let (_, summary) = end("late", "[limits]\nstretch = 2.0\n[load]\npressure = 0.03\n");
    assert_eq!(summary["ending"], "ballooning");
    // Without limits nothing is said of any.
    let (out, summary) = end("none", "[load]\npressure = 0.005\n");
    assert!(summary.get("limit").is_none() && !out.contains("allowed"), "{out}");
}

#[test]
fn a_region_is_limited_by_itself() {
    let workshop = Workshop::new();
    let region = "[[region]]\nwhere = \"z\"\nmaterial = { law = \"neo-hookean\", mu = 1.0 }\n\
                  limits = { stretch = 1.1 }\n";
    let load = "[load]\npressure = 0.02\n";
    workshop.write("scene.toml", format!("{BALLOON}{region}{load}"));
    workshop.succeed(&["simulate", "scene.toml", "--out", "out"]);
    let summary = workshop.json("out/summary.json");
    assert_eq!(summary["ending"], "limit_reached");
    assert_eq!(summary["limit"]["material"], 1);
    assert!(summary["limit"]["at_rest"][2].as_f64().unwrap() > 0.0);
}

#[test]
fn what_is_no_limit_is_told() {
    let workshop = Workshop::new();
    let refuse = |limits: &str, said: &[&str]| {
        workshop.refuse_scene(&format!("{BALLOON}{limits}\n[load]\npressure = 0.01\n"), said);
    };
    refuse("[limits]", &["[limits] wants a `stretch` or a `nominal_stress`"]);
    refuse("[limits]\nstretch = 1.0", &["[limits] stretch is 1.0", "between 1.001 and"]);
    refuse("[limits]\nstretch = 8.0", &["[limits] stretch is 8.0", "stretch_bound = 6.0"]);
    refuse("[limits]\nnominal_stress = 0", &["[limits] nominal_stress"]);
    refuse("[limits]\nstrain = 0.5", &["unknown field `strain`", "`stretch`"]);
    refuse(
        "[[region]]\nthickness = 0.2\nlimits = { stretch = 1.2 }",
        &["[[region]] limits wants a `material` beside it"],
    );
    let linear = format!("{BALLOON}[limits]\nstretch = 1.2\n[load]\nlinear = true\n");
    workshop.refuse_scene(&linear, &["[load] linear knows no limit"]);
    workshop.refuse_run("[pattern]\nlimits = { stretch = 1.2 }\n", &["[pattern] wants a"]);
    workshop.refuse_run("[limits]\nstretch = 0.5\n", &["[limits] stretch is 0.5"]);
}

/// A wall that bends past its limit by its weight, five times that on Earth and sideways, before there is any pressure: as a beam it is
/// strained by `rho g L^2 / (E R)`, some 0.7 %.
#[test]
fn a_wall_past_its_limit_at_rest_is_refused() {
    let workshop = Workshop::new();
    let heavy = "[limits]\nstretch = 1.002\n[gravity]\ndensity = 1.1\nacceleration = [50.0, 0.0, 0.0]\n[load]\npressure = 0.01\n";
    workshop.write(
        "scene.toml",
        format!("{}{heavy}", super::parts::bent(5.0, 0.01, 2).split("[load]").next().unwrap()),
    );
    workshop.refuse(
        &["simulate", "scene.toml", "--out", "out"],
        1,
        &["the wall is past its [limits] at rest"],
    );
}
