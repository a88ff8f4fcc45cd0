//! `deck` and `compare`: files for other solvers, read back as those read them; where `ccx` is installed, its answer.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::process::{Command, Stdio};

use super::parts::{self, Body, Cell};
use super::workshop::Workshop;

type Place = [f64; 3];

/// The published seed in coarse cells, hardly bent.
fn scene() -> String {
    parts::bent(4.0, 0.002, 2) + "[solid]\nedge = 4.0\nlayers = 1\n"
}

/// What CalculiX reads of `solid.inp`.
#[derive(Default)]
struct Deck {
    nodes: BTreeMap<u32, Place>,
    cells: BTreeMap<u32, Vec<u32>>,
    node_sets: HashMap<String, Vec<u32>>,
    cell_sets: HashMap<String, Vec<u32>>,
    /// Set of cells, number of the face, kPa.
    pressures: Vec<(String, usize, f64)>,
    /// The lines of other cards.
    cards: Vec<(String, Vec<String>)>,
}

impl Deck {
    fn read(text: &str) -> Self {
        let mut deck = Self::default();
        let mut card = String::new();
        for line in text.lines().filter(|line| !line.starts_with("**")) {
            let words: Vec<&str> = line.split(',').map(str::trim).collect();
            let named = |key: &str| {
                let values = card.split(',').filter_map(|word| word.trim().split_once('='));
                values.filter(|(name, _)| *name == key).map(|(_, value)| value.to_owned()).next()
            };
            if line.starts_with('*') {
                card = line.to_owned();
                deck.cards.push((card.clone(), Vec::new()));
            } else if card.starts_with("*NODE,") {
                let place = [1, 2, 3].map(|k| words[k].parse().unwrap());
                assert!(words.iter().all(|word| word.len() <= 20), "{line}");
                assert_eq!(deck.nodes.insert(words[0].parse().unwrap(), place), None);
            } else if card.starts_with("*ELEMENT") {
                assert_eq!((words.len(), named("TYPE").as_deref()), (11, Some("C3D10")));
                let numbers: Vec<u32> = words.iter().map(|word| word.parse().unwrap()).collect();
                assert_eq!(deck.cells.insert(numbers[0], numbers[1..].to_vec()), None);
            } else if card.starts_with("*NSET") || card.starts_with("*ELSET") {
                // A line of the program holds 16 items.
                assert!(words.len() <= 16, "{line}");
                let of_nodes = card.starts_with("*NSET");
                let name = named(if of_nodes { "NSET" } else { "ELSET" }).unwrap();
                let sets = if of_nodes { &mut deck.node_sets } else { &mut deck.cell_sets };
                let items = words.iter().map(|word| word.parse::<u32>().unwrap());
                sets.entry(name).or_default().extend(items);
            } else if card.starts_with("*DLOAD") {
                let face = words[1].strip_prefix('P').unwrap().parse().unwrap();
                deck.pressures.push((words[0].to_owned(), face, words[2].parse().unwrap()));
            } else {
                deck.cards.last_mut().unwrap().1.push(line.to_owned());
            }
        }
        deck
    }

    fn card(&self, name: &str) -> &[String] {
        let found = self.cards.iter().find(|(card, _)| card.starts_with(name));
        &found.unwrap_or_else(|| panic!("no {name}")).1
    }

    fn place(&self, node: u32) -> Place {
        self.nodes[&node]
    }
}

/// The faces of a C3D10: three corners, and the midpoints behind each of them, from the manual's table; seen from outside they run
/// clockwise, so that their normals enter the cell as a positive pressure does.
const FACES: [[usize; 6]; 4] =
    [[0, 1, 2, 4, 5, 6], [0, 3, 1, 7, 8, 4], [1, 3, 2, 8, 9, 5], [2, 3, 0, 9, 7, 6]];
const EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];

fn minus(a: Place, b: Place) -> Place {
    [0, 1, 2].map(|k| a[k] - b[k])
}

fn dot(a: Place, b: Place) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn cross(a: Place, b: Place) -> Place {
    [0, 1, 2].map(|k| a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3])
}

fn norm(a: Place) -> f64 {
    dot(a, a).sqrt()
}

/// `1/3 int x . n dA` over a quadratic triangle (corners, then midpoints 0-1, 1-2, 2-0), by Gauss' rule of three points on the
/// square that Duffy's map makes the triangle: exact to degree 4, which the integrand has.
fn volume_below(x: [Place; 6]) -> f64 {
    let reach = 0.15_f64.sqrt();
    let rule = [(0.5 - reach, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.5 + reach, 5.0 / 18.0)];
    let mut sum = 0.0;
    for (u, wu) in rule {
        for (v, wv) in rule {
            let (r, s) = (u, v * (1.0 - u));
            let l = [1.0 - r - s, r, s];
            let shapes = [
                l[0] * (2.0 * l[0] - 1.0),
                l[1] * (2.0 * l[1] - 1.0),
                l[2] * (2.0 * l[2] - 1.0),
                4.0 * l[0] * l[1],
                4.0 * l[1] * l[2],
                4.0 * l[2] * l[0],
            ];
            let by_r = [
                1.0 - 4.0 * l[0],
                4.0 * l[1] - 1.0,
                0.0,
                4.0 * (l[0] - l[1]),
                4.0 * l[2],
                -4.0 * l[2],
            ];
            let by_s = [
                1.0 - 4.0 * l[0],
                0.0,
                4.0 * l[2] - 1.0,
                -4.0 * l[1],
                4.0 * l[1],
                4.0 * (l[0] - l[2]),
            ];
            let at = |weights: [f64; 6]| {
                [0, 1, 2].map(|k| x.iter().zip(weights).map(|(x, w)| w * x[k]).sum::<f64>())
            };
            let normal = cross(at(by_r), at(by_s));
            sum += wu * wv * (1.0 - u) * dot(at(shapes), normal) / 3.0;
        }
    }
    sum
}

/// Every edge of a closed surface is run along once each way.
fn check_closed(faces: &[[u32; 3]]) {
    let mut edges = BTreeSet::new();
    for face in faces {
        for k in 0..3 {
            assert!(edges.insert([face[k], face[(k + 1) % 3]]), "{face:?}");
        }
    }
    assert!(edges.iter().all(|&[a, b]| edges.contains(&[b, a])));
}

/// Nodes, cells and sets of `solid.inp` fit together, midpoints lie where CalculiX takes them to be, and the faces under pressure
/// enclose the chamber; `solid.feb` says the same, and every name in it is that of something.
#[test]
fn decks_hold_the_wall_and_its_chamber() {
    let workshop = Workshop::new();
    workshop.write("scene.toml", scene());
    let said = workshop.succeed(&["deck", "scene.toml", "--out", "deck"]);
    assert!(said.contains("neo-Hooke with a bulk modulus of 49.667 MPa"), "{said}");
    assert!(said.contains("the rubber itself is incompressible"), "{said}");
    let case = workshop.json("deck/case.json");
    let deck = Deck::read(&workshop.read("deck/solid.inp"));
    assert_eq!(deck.nodes.len() as u64, case["nodes"].as_u64().unwrap());
    assert_eq!(deck.cells.len() as u64, case["tetrahedra"].as_u64().unwrap());

    for (cell, nodes) in &deck.cells {
        let x: Vec<Place> = nodes.iter().map(|&node| deck.place(node)).collect();
        let [a, b, c] = [1, 2, 3].map(|k| minus(x[k], x[0]));
        assert!(dot(cross(a, b), c) > 0.0, "cell {cell} is turned inside out");
        for (middle, [a, b]) in x[4..].iter().zip(EDGES) {
            let mean = [0, 1, 2].map(|k| 0.5 * (x[a][k] + x[b][k]));
            // Where an edge is bent onto the wall's face, by a fifth of its length at most.
            let away = norm(minus(*middle, mean)) / norm(minus(x[b], x[a]));
            assert!(away <= 0.2, "cell {cell}, edge {a}-{b}: {away}");
        }
    }

    let (clamp, tip) = (&deck.node_sets["CLAMP"], &deck.node_sets["TIP"]);
    let heights = |nodes: &[u32]| -> Vec<f64> { nodes.iter().map(|v| deck.place(*v)[2]).collect() };
    let highest = heights(clamp).into_iter().fold(f64::NEG_INFINITY, f64::max);
    let lowest = heights(tip).into_iter().fold(f64::INFINITY, f64::min);
    assert!(clamp.len() > 20 && tip.len() > 20 && highest < 5.0 && lowest > 50.0);
    assert_eq!(deck.card("*BOUNDARY"), ["CLAMP, 1, 3"]);
    let law: Vec<f64> =
        deck.card("*HYPERELASTIC")[0].split(',').map(|word| word.parse().unwrap()).collect();
    // mu / 2 and 2 / kappa at kappa = 149/3 mu, kPa; printed with twelve digits.
    assert!((law[0] - 500.0).abs() < 1e-8 && (law[1] - 6e-3 / 149.0).abs() < 1e-15, "{law:?}");

    // A step for each sample, the same faces in each.
    let [half, whole] = deck.pressures.split_at(deck.pressures.len() / 2).into();
    for ((set, face, pressure), before) in whole.iter().zip(half) {
        assert_eq!((set, face, 0.5 * pressure), (&before.0, &before.1, before.2));
        assert_eq!(*pressure, 2.0);
    }
    let mut corners = Vec::new();
    let mut volume = 0.0;
    for (set, face, _) in whole {
        assert!(deck.card("*SURFACE").contains(&format!("{set}, S{face}")));
        for cell in &deck.cell_sets[set] {
            let nodes = FACES[face - 1].map(|k| deck.cells[cell][k]);
            corners.push([nodes[0], nodes[1], nodes[2]]);
            volume += volume_below(nodes.map(|node| deck.place(node)));
        }
    }
    check_closed(&corners);
    let ours = case["chamber_volume"].as_f64().unwrap();
    // Ours is of fourth order in the bend of a face, a percent of its size here.
    assert!(ours > 1e4 && (volume / ours - 1.0).abs() < 1e-4, "{volume} {ours}");

    check_febio(&workshop, &deck, volume);
}

fn check_febio(workshop: &Workshop, deck: &Deck, volume: f64) {
    let text = workshop.read("deck/solid.feb");
    let document = roxmltree::Document::parse(&text).unwrap();
    let root = document.root_element();
    assert_eq!((root.tag_name().name(), root.attribute("version")), ("febio_spec", Some("4.0")));
    let all = |tag: &'static str| root.descendants().filter(move |node| node.has_tag_name(tag));
    let list = |node: roxmltree::Node<'_, '_>| -> Vec<u32> {
        node.text().unwrap().split(',').map(|word| word.trim().parse().unwrap()).collect()
    };
    let id = |node: roxmltree::Node<'_, '_>| node.attribute("id").unwrap().parse::<u32>().unwrap();
    let nodes: BTreeMap<u32, Place> = all("node")
        .map(|node| {
            let words = node.text().unwrap().split(',').map(|word| word.parse().unwrap());
            (id(node), words.collect::<Vec<f64>>().try_into().unwrap())
        })
        .collect();
    assert_eq!(nodes, deck.nodes);
    let cells: BTreeMap<u32, Vec<u32>> = all("elem").map(|node| (id(node), list(node))).collect();
    assert_eq!(cells, deck.cells);
    let named = |tag: &'static str, name: &str| {
        let found: Vec<_> = all(tag).filter(|node| node.attribute("name") == Some(name)).collect();
        assert_eq!(found.len(), 1, "{tag} {name}");
        found[0]
    };
    for set in ["CLAMP", "TIP"] {
        assert_eq!(list(named("NodeSet", set)), deck.node_sets[set]);
    }
    let one = |tag: &'static str| {
        let found: Vec<_> = all(tag).collect();
        assert_eq!(found.len(), 1, "{tag}");
        found[0]
    };
    let domain = one("SolidDomain");
    named("Elements", domain.attribute("name").unwrap());
    named("material", domain.attribute("mat").unwrap());
    named("NodeSet", one("bc").attribute("node_set").unwrap());
    let load = one("surface_load");
    let surface = named("Surface", load.attribute("surface").unwrap());
    let controller = load.children().find_map(|node| node.attribute("lc")).unwrap();
    assert_eq!(one("load_controller").attribute("id"), Some(controller));
    assert_eq!(list(one("node_data")), deck.node_sets["TIP"]);
    // Its normals leave the body, into the chamber: the volume counts negative.
    let faces = || surface.children().filter(|node| node.has_tag_name("tri6")).map(list);
    let enclosed: f64 = faces()
        .map(|face| {
            let places: Vec<Place> = face.iter().map(|&node| deck.place(node)).collect();
            volume_below(places.try_into().unwrap())
        })
        .sum();
    check_closed(&faces().map(|face| [face[0], face[1], face[2]]).collect::<Vec<_>>());
    // Twelve digits of each place.
    assert!((enclosed / volume + 1.0).abs() < 1e-9, "{enclosed} {volume}");
}

/// A box of 10 x 8 x 24 mm in cubes of 2 mm around a chamber of 4 x 4 x 20 mm, which lies nearer to one side.
fn box_of_tetrahedra() -> String {
    let chamber: Vec<Cell> = (0..40).map(|k| [1 + k % 2, 1 + k / 2 % 2, 1 + k / 4]).collect();
    Body::without(2.0, [5, 4, 12], &chamber).plain_text()
}

/// CalculiX and we have the same law and mesh, and cells of the same order that do not lock at this Poisson's ratio of 0.3: what
/// differs is their displacements alone against our pressures between. Where nothing else does, in the linear range, that is 1.4 % of
/// the tip on these cubes and 0.5 % on cubes half as long; of single nodes 11 % and 5 %, at the chamber's edges, where stress is
/// singular. A factor of 2 in a coefficient changes the tip by half.
#[test]
#[expect(clippy::print_stderr, reason = "a skipped test says so")]
fn calculix_agrees() {
    if Command::new("ccx").arg("-v").stdout(Stdio::null()).status().is_err() {
        eprintln!("skipped: there is no program `ccx` (Debian package calculix-ccx)");
        return;
    }
    let workshop = Workshop::new();
    workshop.write("box.msh", box_of_tetrahedra());
    let laws = [
        ("neo", "law = \"neo-hookean\"\nmu = 100"),
        ("mooney", "law = \"mooney-rivlin\"\nc1 = 30\nc2 = 20"),
        ("yeoh", "law = \"yeoh\"\nc = [50, -10, 10]"),
        (
            "ogden",
            "law = \"ogden\"\nterms = [{ mu = 2, alpha = 3.2 }, { mu = 40, alpha = -1.9 }, { mu = 58, alpha = 1.3 }]",
        ),
    ];
    for (name, law) in laws {
        workshop.write(
            "scene.toml",
            format!(
                "[part]\ntetrahedra = \"box.msh\"\n[wall]\nthickness = 2.0\n[material]\n{law}\nbulk_modulus = 217\n\
                 [load]\npressure = 10.0\n[load.path]\nsteps = 2\n[solver]\nbackend = \"native\"\n"
            ),
        );
        workshop.succeed(&["deck", "scene.toml", "--out", name]);
        // 4 x 4 x 20 mm, by flat faces.
        let volume = workshop.json(&format!("{name}/case.json"))["chamber_volume"].clone();
        assert!((volume.as_f64().unwrap() - 320.0).abs() < 1e-9, "{volume}");
        workshop.refuse(&["compare", name], 1, &["solid.dat is not there", "ccx solid"]);
        let solved = Command::new("ccx")
            .arg("solid")
            .current_dir(workshop.path(name))
            .env("OMP_NUM_THREADS", "1")
            .stdout(Stdio::null())
            .status()
            .unwrap();
        assert!(solved.success(), "{name}");
        let said = workshop.succeed(&["compare", name, "--json"]);
        let found: serde_json::Value = serde_json::from_str(&said).unwrap();
        assert_eq!(found["samples"].as_array().unwrap().len(), 2);
        let difference = found["largest_difference"].as_f64().unwrap();
        assert!(difference < 0.03, "{name}: {said}");
        let nodes = found["nodes"]["share"].as_f64().unwrap();
        assert!(nodes < 0.2, "{name}: {said}");
    }
}

const CASE: &str = r#"{ "design": "d", "pressure": 0.2 }"#;
const PATH: &str = "step,pressure,tip_x,tip_y,tip_z,max_displacement,volume
0,0.0,0.0,0.0,0.0,0.0,100.0
1,0.1,3.0,0.0,4.0,5.0,110.0
2,0.2,6.0,0.0,8.0,10.0,120.0
";
const HALF: &str = "
 displacements (vx,vy,vz) for set TIP and time  0.5000000E+00

         1  3.000000E+00  5.000000E-02  4.000000E+00
";

/// The difference is that of the tips' vectors; a job that stopped early is told, with what it reached.
#[test]
fn answers_are_compared_by_their_tips() {
    let workshop = Workshop::new();
    workshop.refuse(&["compare", "deck"], 1, &["is not the folder of a deck", "pneumorph deck"]);
    std::fs::create_dir(workshop.path("deck")).unwrap();
    workshop.write("deck/case.json", CASE);
    workshop.write("deck/path_solid.csv", PATH);
    workshop.write("deck/solid.dat", HALF);
    let said = workshop.run(&["compare", "deck"]);
    assert!(said.code == 1 && said.err.contains("ends at 0.1000 of 0.2000 MPa"), "{said:?}");
    assert!(said.err.lines().count() == 1 && said.out.contains("1.000 %"), "{said:?}");
    let whole = HALF.to_owned()
        + &HALF.replace("0.5000000E+00", "0.1000000E+01").replace("3.0000", "6.3000");
    workshop.write("deck/solid.dat", whole);
    workshop.write("deck/displacement_solid.csv", "node,x,y,z\n1,6.0,0.0,8.0\n2,0.0,0.0,0.0\n");
    let frd = "  100CL  101 1.00000E+00           2                     0    1           1
 -4  DISP        4    1
 -1         1 6.30000E+00 0.00000E+00 8.40000E+00
 -1         2 0.00000E+00 1.00000E-01 0.00000E+00
 -3
";
    workshop.write("deck/solid.frd", frd);
    let json = workshop.succeed(&["compare", "deck", "--json"]);
    let found: serde_json::Value = serde_json::from_str(&json).unwrap();
    // (0.3, 0.05, -4) of 10, and 0.5 of 10.
    let expected = (0.09_f64 + 0.0025 + 16.0).sqrt() / 10.0;
    assert!((found["largest_difference"].as_f64().unwrap() - expected).abs() < 1e-12, "{json}");
    assert_eq!(found["nodes"]["node"], 1);
    assert!((found["nodes"]["share"].as_f64().unwrap() - 0.05).abs() < 1e-12, "{json}");
    workshop.write("deck/solid.frd", frd.replace(" -1         2", " -1         3"));
    workshop.refuse(&["compare", "deck"], 1, &["node 3"]);
    workshop.write("deck/solid.dat", HALF.replace("3.000000E+00", "NaN and"));
    workshop.refuse(&["compare", "deck"], 1, &["solid.dat:4"]);
}

#[test]
fn what_cannot_be_written_is_told_in_one_line() {
    let workshop = Workshop::new();
    let given = scene();
    let refuse = |scene: &str, flags: &[&str], words: &[&str]| {
        workshop.write("scene.toml", scene);
        workshop.refuse(&[&["deck", "scene.toml", "--out", "none"], flags].concat(), 1, words);
    };
    let neo_hookean = "law = \"neo-hookean\"\nmu = 1.0";
    let plate = "law = \"st-venant-kirchhoff\"\nyoung_modulus = 1.0\npoisson_ratio = 0.3";
    refuse(&given, &["--poisson-ratio", "0.5"], &["--poisson-ratio", "0.4999"]);
    refuse(&given, &["--edge", "-1"], &["--edge"]);
    refuse(&given, &["--pressure", "0"], &["--pressure"]);
    let bulky = given.replace("mu = 1.0", "mu = 1.0\nbulk_modulus = 9.0");
    refuse(&bulky, &["--poisson-ratio", "0.4"], &["--poisson-ratio is for incompressible"]);
    refuse(&given.replace(neo_hookean, plate), &[], &["law of shells alone"]);
    let plane = format!("{given}\n[[plane]]\nnormal = [1.0, 0.0, 0.0]\ndistance = 5.0\n");
    refuse(&plane, &[], &["[[plane]]", "take it away"]);
    let heavy = format!("{given}\n[gravity]\ndensity = 1.1\n");
    refuse(&heavy, &[], &["[gravity]", "take it away"]);
    let sphere = "[part.sphere]\nradius = 10.0\nsubdivisions = 2\n";
    refuse(sphere, &[], &["[part] has no base"]);
    let terms = "law = \"ogden\"\nterms = [{ mu = 1, alpha = 1 }, { mu = 1, alpha = 2 }, { mu = 1, alpha = 3 }, { mu = 1, alpha = 4 }]";
    refuse(&given.replace(neo_hookean, terms), &[], &["CalculiX", "not with 4"]);
    workshop.refuse(&["deck", ".", "--out", "none"], 1, &["name of an individual"]);
    workshop.refuse(&["deck", ".", "g000-000", "--out", "none"], 1, &["has no run.toml"]);
    std::fs::create_dir(workshop.path("run")).unwrap();
    workshop.write("run/run.toml", "");
    workshop.refuse(&["deck", "run", "g000-000", "--out", "none"], 1, &["no individual g000-000"]);
    workshop.refuse(&["deck", "run", "best", "--out", "none"], 1, &["`best`"]);
    workshop.refuse(&["deck", "run", "g000-000", "--out", "run"], 1, &["run exists"]);
}
