//! `deck` and `compare` where the answers have gaps, where CalculiX' cells lock, and where `simulate` reads the same part.

use super::parts::{Body, Cell};
use super::workshop::Workshop;

/// A slab of 8 x 6 x 24 mm in cubes of 2 mm, around a chamber of 4 x 2 x 20 mm.
fn slab() -> String {
    let chamber: Vec<Cell> = (0..20).map(|k| [1 + k % 2, 1, 1 + k / 2]).collect();
    Body::without(2.0, [4, 3, 12], &chamber).plain_text()
}

fn scene(bulk_modulus: f64) -> String {
    format!(
        "[part]\ntetrahedra = \"slab.msh\"\n[wall]\nthickness = 2.0\ntip_fraction = 0.24\n\
         [material]\nlaw = \"neo-hookean\"\nmu = 1.0\nbulk_modulus = {bulk_modulus}\n\
         [load]\npressure = 0.02\n[load.path]\nsteps = 1\n[solver]\nbackend = \"native\"\n\
         [[watch]]\nname = \"tip\"\nmeasure = \"tip\"\ndirection = [0, 0, 1]\n"
    )
}

/// The middle of the wall ends half a thickness below the top, at 23 mm, and its tip begins 0.24 of 22 mm below that: both
/// commands mean the corners above 17.72 mm on the faces, so that their numbers agree to the solver's tolerance.
#[test]
fn deck_and_simulate_read_one_tip() {
    let workshop = Workshop::new();
    workshop.write("slab.msh", slab());
    workshop.write("scene.toml", scene(2.0));
    workshop.succeed(&["deck", "scene.toml", "--out", "deck"]);
    workshop.succeed(&["simulate", "scene.toml", "--out", "simulated"]);
    let last = |file: &str, column: usize| -> f64 {
        let text = workshop.read(file);
        text.lines().last().unwrap().split(',').nth(column).unwrap().parse().unwrap()
    };
    let [ours, theirs] = [
        last("deck/path_solid.csv", 4),
        workshop.json("simulated/summary.json")["watches"][0]["value"].as_f64().unwrap(),
    ];
    // 1e-9 of forces, over a soft part's stiffness.
    assert!(ours.abs() > 1e-3 && (ours / theirs - 1.0).abs() < 1e-6, "{ours} {theirs}");
    let deck = workshop.read("deck/solid.inp");
    let set = deck.split("NSET=TIP\n").nth(1).unwrap().split('*').next().unwrap();
    let tip: Vec<usize> = set
        .split([',', '\n'])
        .filter(|word| !word.is_empty())
        .map(|word| word.parse().unwrap())
        .collect();
    let heights = deck.split("NSET=NALL\n").nth(1).unwrap().lines();
    let heights: Vec<f64> = heights
        .take_while(|line| !line.starts_with('*'))
        .map(|line| line.rsplit(',').next().unwrap().parse().unwrap())
        .collect();
    let lowest = tip.iter().map(|&node| heights[node - 1]).fold(f64::INFINITY, f64::min);
    // Of the corners, which lie at even heights; 0.24 of the whole 24 mm would begin at 18.24 mm.
    assert_eq!(lowest, 18.0);
}

/// Where cells with displacements alone lock, the deck and the program say so; where they do not, neither does.
#[test]
fn locking_is_told_before_it_is_met() {
    let workshop = Workshop::new();
    workshop.write("slab.msh", slab());
    workshop.write("scene.toml", scene(49.667));
    let said = workshop.succeed(&["deck", "scene.toml", "--out", "locking"]);
    let words = "CalculiX' tetrahedra lock at a Poisson's ratio of 0.4900";
    assert!(said.contains(words) && said.contains("a smaller bulk_modulus"), "{said}");
    assert!(workshop.read("locking/solid.inp").contains(words));
    workshop.write("scene.toml", scene(2.0));
    let said = workshop.succeed(&["deck", "scene.toml", "--out", "soft"]);
    assert!(!said.contains("lock") && !workshop.read("soft/solid.inp").contains("lock"), "{said}");
}

const CASE: &str = r#"{ "design": "d", "pressure": 0.2, "poisson_ratio": 0.49 }"#;

fn tip(time: &str, words: &str) -> String {
    format!("\n displacements (vx,vy,vz) for set TIP and time  {time}\n\n         1  {words}\n")
}

/// No `inf`, no `NaN`, no success where nothing was compared: of a tip that does not move, of one that is no number, of a program
/// that was stopped, and of one that gave up.
#[test]
fn what_has_no_difference_is_told() {
    let workshop = Workshop::new();
    std::fs::create_dir(workshop.path("deck")).unwrap();
    workshop.write("deck/case.json", CASE);
    let path = "step,pressure,tip_x,tip_y,tip_z,max_displacement,volume\n0,0,0,0,0,0,1\n";
    let moved = "1,0.1,3.0,0.0,4.0,5.0,110.0\n2,0.2,6.0,0.0,8.0,10.0,120.0\n";
    let still = "1,0.1,0.0,0.0,0.0,0.0,1.0\n2,0.2,0.0,0.0,0.0,0.0,1.0\n";
    let whole = tip("0.5000000E+00", "3.0 0.0 4.0") + &tip("0.1000000E+01", "6.0 0.0 8.0");
    let compared = |rows: &str, answer: &str| {
        workshop.write("deck/path_solid.csv", format!("{path}{rows}"));
        workshop.write("deck/solid.dat", answer);
        let said = workshop.run(&["compare", "deck"]);
        assert!(!said.out.contains("inf") && !said.out.contains("NaN"), "{said:?}");
        assert!(said.err.lines().count() <= 1, "{said:?}");
        said
    };
    let said = compared(moved, &whole);
    assert!(said.code == 0 && said.out.contains("0.000 %"), "{said:?}");
    assert!(said.out.contains("is expected: CalculiX' tetrahedra"), "{said:?}");
    let said = compared(still, &whole);
    assert!(said.code == 1 && said.err.contains("2 of 2 samples cannot be compared"), "{said:?}");
    assert!(said.out.contains('\u{2014}') && said.out.contains("nothing could be compared"));
    let said = compared(moved, &whole.replace("6.0 0.0 8.0", "NaN NaN NaN"));
    assert!(said.code == 1 && said.err.contains("1 of 2 samples"), "{said:?}");

    let half = tip("0.5000000E+00", "3.0 0.0 4.0");
    let said = compared(moved, &half);
    assert!(said.code == 1 && said.out.contains("no answer"), "{said:?}");
    assert!(said.err.contains("ends at 0.1000 of 0.2000 MPa: the rest of the answer is not there"));
    // As the program leaves the file when it is killed, and when it ends by itself.
    workshop.write("deck/solid.frd", "    1C\n");
    let said = compared(moved, &half);
    assert!(said.code == 1 && said.err.contains("was stopped before its end"), "{said:?}");
    workshop.write("deck/solid.frd", "    1C\n 9999\n");
    let said = compared(moved, &half);
    assert!(said.code == 1 && said.err.contains("CalculiX gave up"), "{said:?}");
    let said = compared(moved, "");
    assert!(said.code == 1 && said.err.contains("ends at 0.0000 of 0.2000 MPa"), "{said:?}");
}
