//! Tetrahedra of one's own: which of their faces are the chamber, and what is said of the rest of the file.

use super::parts::{Body, Cell};
use super::workshop::Workshop;

/// Edge of a cell, mm.
const H: f64 = 5.0;

/// A block of 20 x 20 x 30 mm around a cavity of 10 x 10 x 10 mm.
fn hollow() -> Body {
    let cavity: Vec<Cell> = (0..8).map(|n| [1 + n % 2, 1 + n / 2 % 2, 2 + n / 4]).collect();
    Body::without(H, [4, 4, 6], &cavity)
}

/// A block of 15 x 15 x 25 mm with a hole of 5 x 5 x 15 mm that begins at its base.
fn with_inlet() -> Body {
    Body::without(H, [3, 3, 5], &[[1, 1, 0], [1, 1, 1], [1, 1, 2]])
}

/// A scene with the file `part.msh`; `keys` are those of its part, and may go on with those of its wall.
fn scene(keys: &str) -> String {
    let wall = if keys.contains("[wall]") { "" } else { "[wall]" };
    format!(
        "[part]\ntetrahedra = \"part.msh\"\n{keys}\n{wall}\nthickness = 5.0\n[material]\nlaw = \"neo-hookean\"\nmu = 0.3\n\
         [load]\npressure = 0.02\n[load.path]\nsteps = 1\n[solver]\nbackend = \"native\"\n\
         [[watch]]\nname = \"growth\"\nmeasure = \"volume-growth\"\n"
    )
}

/// What becomes of a mesh with `keys` of its part: the summary, and what was said on both streams.
fn simulated(text: &str, keys: &str) -> (serde_json::Value, String, String) {
    let workshop = Workshop::new();
    workshop.write("part.msh", text);
    workshop.write("scene.toml", scene(keys));
    let said = workshop.run(&["simulate", "scene.toml", "--out", "out"]);
    assert_eq!(said.code, 0, "{}", said.err);
    (workshop.json("out/summary.json"), said.out, said.err)
}

fn refused(text: &str, keys: &str) -> String {
    let workshop = Workshop::new();
    workshop.write("part.msh", text);
    workshop.write("scene.toml", scene(keys));
    let said = workshop.run(&["simulate", "scene.toml", "--out", "out"]);
    assert_eq!((said.code, said.err.lines().count()), (1, 1), "{}", said.err);
    assert!(!workshop.path("out").exists());
    said.err
}

fn growth(summary: &serde_json::Value) -> f64 {
    summary["watches"][0]["value"].as_f64().unwrap()
}

/// One body, whatever its groups are called and numbered, inflates as that without any. A group with number 2 is like others.
#[test]
fn the_chamber_is_the_group_that_is_named() {
    let body = hollow();
    let inner = |group: i64| move |_: [f64; 3], is_outer: bool| if is_outer { 0 } else { group };
    let both = |_: [f64; 3], is_outer: bool| if is_outer { 2 } else { 7 };
    let whole = &|_: Cell| 1;
    let skins = ["2 2 \"outer skin\"", "2 7 \"cavity wall\""];
    let plain = body.text(&[], &|_, _| 0, whole);
    let (summary, said, warned) = simulated(&plain, "");
    assert!(warned.is_empty(), "{warned}");
    // 8 cells of 5 mm, in 6 sides of 4 squares of 2 triangles.
    let line = "chamber: what the wall surrounds, 48 triangles, 1 void, 1000.0 mm^3";
    assert!(said.lines().any(|said| said == line), "{said}");
    assert_eq!(summary["chamber"]["faces"], 48);
    assert_eq!(summary["chamber"]["voids"], 1);
    assert!((summary["chamber"]["volume"].as_f64().unwrap() / 1000.0 - 1.0).abs() < 1e-12);
    let cases = [
        (body.text(&["2 5 \"Chamber\""], &inner(5), whole), "", "\"Chamber\" (5)"),
        (body.text(&skins, &both, whole), "", "none"),
        (body.text(&["2 2 \"skin\""], &|_, _| 2, whole), "", "none"),
        (body.text(&[], &|_, _| 2, whole), "", "none"),
        (body.text(&skins, &both, whole), "chamber = \"cavity wall\"", "\"cavity wall\" (7)"),
        (body.text(&skins, &both, whole), "chamber = \"CAVITY WALL\"", "\"cavity wall\" (7)"),
        (body.text(&skins, &both, whole), "chamber = 7", "\"cavity wall\" (7)"),
        (body.text(&[], &inner(2), whole), "chamber = \"2\"", "2"),
        // The same number of a volume is another group.
        (body.text(&["3 2 \"chamber\""], &|_, _| 2, &|_| 2), "", "none"),
        // A sign says which way a surface is turned.
        (body.text(&["2 5 \"chamber\""], &inner(-5), whole), "", "\"chamber\" (5)"),
    ];
    for (text, keys, group) in cases {
        let (found, _, _) = simulated(&text, keys);
        assert_eq!(found["chamber"]["group"].as_str().unwrap_or("none"), group);
        // The same sums in another order of the faces.
        assert!((growth(&found) / growth(&summary) - 1.0).abs() < 1e-12, "{keys} {group}");
    }
}

#[test]
fn a_wrong_chamber_is_refused_in_one_line() {
    let body = hollow();
    let both = |_: [f64; 3], is_outer: bool| if is_outer { 2 } else { 7 };
    let names = ["2 2 \"outer skin\"", "2 7 \"cavity wall\"", "2 9 \"chamber\""];
    let text = body.text(&names[..2], &both, &|_| 1);
    let has = |said: String, words: &str| assert!(said.contains(words), "{said}");
    let there = "groups with triangles are \"outer skin\" (2) of 256 triangles, \"cavity wall\" (7) of 48 triangles";
    has(
        refused(&text, "chamber = \"cavity\""),
        &format!("part.msh: [part] chamber is \"cavity\", which no group is; {there}"),
    );
    has(refused(&text, "chamber = 3"), &format!("[part] chamber is 3, which no group is; {there}"));
    has(
        refused(&body.text(&names, &both, &|_| 1), ""),
        &format!("part.msh: the group \"chamber\" (9) has no triangles; {there}"),
    );
    let plain = body.text(&["2 9 \"chamber\""], &|_, _| 0, &|_| 1);
    has(
        refused(&plain, ""),
        "the group \"chamber\" (9) has no triangles; the file has no group with triangles",
    );
    has(
        refused(&text, "chamber = \"outer skin\""),
        "part.msh: the group \"outer skin\" (2) is the outside of the wall, not a chamber",
    );
    let skin = body.text(&["2 2 \"skin\""], &|_, _| 2, &|_| 1);
    has(refused(&skin, "chamber = \"skin\""), "the group \"skin\" (2) is the outside of the wall");
    has(
        refused(&text, "chamber = 7\nclose_inlet = true"),
        "the chamber is closed; take [part] close_inlet away",
    );
    has(refused(&text, "chamber = 7.5"), "the name of a physical group, or its number");
    let solid = Body::without(H, [2, 2, 3], &[]).plain_text();
    has(
        refused(&solid, ""),
        "the wall surrounds no chamber; name the group of its triangles as [part] chamber",
    );
    // A cube that floats in the cavity of another, which is given as the chamber.
    let nested: Vec<Cell> = (0..27)
        .map(|n| [1 + n % 3, 1 + n / 3 % 3, 1 + n / 9])
        .filter(|cell| *cell != [2, 2, 2])
        .collect();
    let nested = Body::without(H, [5, 5, 5], &nested).plain_text();
    has(refused(&nested, ""), "the chamber encloses another piece of the boundary");
}

/// What the file has and the computation does not use is said, each in a line, and stands in the summary.
#[test]
fn what_is_ignored_is_said() {
    let paper = |[i, _, _]: Cell| if i == 0 { 2 } else { 1 };
    let text = hollow().text(&["3 1 \"silicone\"", "3 2 \"paper\""], &|_, _| 0, &paper);
    let (summary, _, said) = simulated(&text, "");
    let line = "2 volume groups (\"silicone\" (1), \"paper\" (2)): all take [material]";
    assert_eq!(summary["warnings"].as_array().unwrap(), &[line]);
    assert!(said.contains(&format!("part.msh: {line}")), "{said}");

    let cavities = [[1, 1, 2], [1, 2, 2], [3, 1, 2], [3, 2, 2]];
    let two = Body::without(H, [5, 4, 6], &cavities);
    let sides = |[x, _, _]: [f64; 3], is_outer: bool| match is_outer {
        true => 0,
        false => 10 + i64::from(x > 12.4),
    };
    let text = two.text(&["2 10 \"chamber left\"", "2 11 \"chamber right\""], &sides, &|_| 1);
    let (summary, said, _) = simulated(&text, "");
    assert_eq!(summary["warnings"][0], "the chamber is 2 voids: all take one pressure");
    assert!(
        said.contains("chamber: what the wall surrounds, 40 triangles, 2 voids, 500.0 mm^3"),
        "{said}"
    );
    let (left, _, _) = simulated(&text, "chamber = \"chamber left\"");
    assert_eq!(left["chamber"]["voids"], 1);
    assert!(left.get("warnings").is_none());
    // Voids that share an edge alone are two as well.
    let touching = Body::without(H, [4, 4, 6], &[[1, 1, 2], [2, 2, 2]]).plain_text();
    let (summary, _, _) = simulated(&touching, "");
    assert!((summary["chamber"]["volume"].as_f64().unwrap() / 250.0 - 1.0).abs() < 1e-12);
    assert_eq!(summary["chamber"]["voids"], 2);
}

/// A hole that begins at the clamped base: closed by a lid it holds its 15 x 5 x 5 mm, and moves as a cavity does whose floor is clamped.
#[test]
fn an_inlet_is_closed_when_asked() {
    let body = with_inlet();
    let inner = |_: [f64; 3], is_outer: bool| i64::from(!is_outer);
    let text = body.text(&["2 1 \"hole\""], &inner, &|_| 1);
    let open = refused(&text, "chamber = \"hole\"");
    assert!(
        open.contains("part.msh: the chamber is open along 4 edges; if that is a flat air inlet, [part] close_inlet = true closes it"),
        "{open}"
    );
    let blind = refused(&text, "close_inlet = true");
    assert!(blind.contains("give their group as [part] chamber"), "{blind}");
    let keys = "chamber = \"hole\"\nclose_inlet = true";
    // All nodes below 7.5 mm are held: two layers of corners.
    let (summary, said, _) = simulated(&text, &format!("{keys}\n[wall]\nclamp_height = 1.0"));
    let line = "chamber: the group \"hole\" (1), 26 triangles, 1 void, 1 lid, 375.0 mm^3";
    assert!(said.lines().any(|said| said == line), "{said}");
    // The same walls above a floor of one cell, whose nodes are held too: what is free is the same.
    let floored = Body::without(H, [3, 3, 6], &[[1, 1, 1], [1, 1, 2], [1, 1, 3]]);
    let floored = floored.plain_text();
    let (floored, _, _) = simulated(&floored, "[wall]\nclamp_height = 2.0");
    let [with_lid, with_floor] = [&summary, &floored].map(growth);
    // Where Newton's method ends; it is some 1e-9 beyond its tolerance.
    assert!(
        with_lid > 1.0 && (with_lid / with_floor - 1.0).abs() < 1e-7,
        "{with_lid} {with_floor}"
    );

    // A square rim with one corner raised by 0.5 mm: a quarter of it is no tilt of a plane.
    let lines: Vec<String> = text
        .lines()
        .map(|line| match line.split(' ').collect::<Vec<_>>()[..] {
            [number, "5", "5", "0"] => format!("{number} 5 5 0.5"),
            _ => line.to_owned(),
        })
        .collect();
    let bent = refused(&(lines.join("\n") + "\n"), "chamber = \"hole\"\nclose_inlet = true");
    assert!(bent.contains("mm across leaves its plane by 0.125 mm"), "{bent}");
}
