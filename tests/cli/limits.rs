//! What is said of a material's limits, and of the paths that they end.

use super::evolve::RESUME;
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
    refuse("[limits]\nstrain = 0.5", &["unknown key `strain`", "`stretch`"]);
    refuse(
        "[[region]]\nthickness = 0.2\nlimits = { stretch = 1.2 }",
        &["[[region]] limits wants a `material` beside it"],
    );
    let linear = format!("{BALLOON}[limits]\nstretch = 1.2\n[load]\nlinear = true\n");
    workshop.refuse_scene(&linear, &["[load] linear knows no limit"]);
    workshop.refuse_run("[pattern]\nlimits = { stretch = 1.2 }\n", &["[pattern]", "`material`"]);
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

/// 8 coarse candidates in 2 generations, each walked to the limit of its material.
const RATED: &str = "
[evolution]
population = 8
generations = 2
seed = 3

[mesh]
edge = 5.0

[limits]
stretch = 1.15

[load]
pressure = \"rated\"
largest_pressure = 0.3
reference_pressure = 0.05

[load.path]
steps = 2
";

/// All of a design is read at one pressure, the least that its paths came to; at the reference pressure besides, where it comes to that.
/// A search that goes on finds the same bytes.
#[test]
fn a_search_rates_each_design() {
    let workshop = Workshop::new();
    workshop.write("run.toml", RATED);
    workshop.succeed(&["evolve", "run.toml", "--out", "out", "--threads", "2"]);
    let lines = workshop.read("out/candidates.jsonl");
    let records: Vec<serde_json::Value> =
        lines.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let evaluated: Vec<_> = records.iter().filter(|it| it["status"] == "evaluated").collect();
    assert!(evaluated.len() > 3, "{lines}");
    let number = |value: &serde_json::Value| value.as_f64().unwrap();
    let mut pressures = Vec::new();
    for record in &evaluated {
        let rated = number(&record["rated_pressure"]);
        let ends = ["bending_pressure", "blocking_pressure"].map(|key| number(&record[key]));
        assert!(rated <= ends[0].min(ends[1]) && rated > 0.0, "{record}");
        if record["bending_ending"] == "limit_reached" {
            assert!(ends[0] < 0.3, "{record}");
            pressures.push(rated);
        }
        let told = &record["at_reference"];
        assert_eq!(told.is_null(), rated < 0.05, "{record}");
        if !told.is_null() {
            // Both are the quotient at one sample: N over N/kPa.
            assert_eq!(number(&told["pressure"]), 0.05);
            let [force, per] = [&told["max_force"], &told["objectives"]["blocking"]].map(number);
            assert!((force - per * 50.0).abs() <= 1e-9 * force.max(1e-9), "{record}");
        }
        let [force, per] = [&record["max_force"], &record["blocking"]].map(number);
        assert!((force - per * 1e3 * rated).abs() <= 1e-9 * force.max(1e-9), "{record}");
    }
    assert!(pressures.len() > 1 && pressures.iter().any(|p| *p != pressures[0]), "{pressures:?}");
    let columns = workshop.read("out/front.csv").lines().next().unwrap().to_owned();
    let end = "rated_pressure,reference_pressure,reference_bending,reference_blocking,\
               reference_figure_of_merit,reference_max_force,reference_angle_deg";
    assert!(columns.ends_with(end), "{columns}");
    let table = workshop.succeed(&["report", "out"]);
    assert!(table.contains("rated pressure") && table.contains("angle at 0.05 MPa"), "{table}");
    assert!(workshop.read("out/report.html").contains("the rated pressure, at which each"));

    // The first generation alone, then the second.
    let other = Workshop::new();
    other.write("run.toml", RATED.replace("generations = 2", "generations = 1"));
    other.succeed(&["evolve", "run.toml", "--out", "out", "--threads", "2"]);
    other.write("run.toml", RATED);
    other.succeed(&RESUME);
    assert_eq!(other.read("out/front.csv"), workshop.read("out/front.csv"));
    assert_eq!(other.read("out/history.csv"), workshop.read("out/history.csv"));
}

#[test]
fn what_is_no_rated_pressure_is_told() {
    let workshop = Workshop::new();
    workshop
        .refuse_run("[load]\npressure = \"rated\"\n", &["[load] pressure = \"rated\"", "[limits]"]);
    workshop.refuse_run(
        "[load]\npressure = \"full\"\n",
        &["run.toml:2", "\"full\"", "a number (MPa) or \"rated\""],
    );
    workshop.refuse_run("[load]\nlargest_pressure = 0.3\n", &["want pressure = \"rated\""]);
    let rated = "[limits]\nstretch = 1.5\n[load]\npressure = \"rated\"\n";
    workshop.refuse_run(&format!("{rated}largest_pressure = -1\n"), &["[load] largest_pressure"]);
    workshop
        .refuse_run(&format!("{rated}reference_pressure = 0\n"), &["[load] reference_pressure"]);
}
